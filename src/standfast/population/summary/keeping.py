"""The persons that a file keeps one by one: their datasets, and who each of them is.

All lie along the dimension ``person``, which has no values of its own (a netCDF dimension without
a variable), so that xarray and netCDF4 find it by its name.
"""

from collections.abc import Iterable, Mapping

import h5py
import numpy as np

from standfast.atlas.layout import set_attributes
from standfast.parameters import PARAMETERS
from standfast.population.people.records import People
from standfast.population.people.study import PopulationStudy
from standfast.population.people.words import SEXES
from standfast.population.summary.arrays import ages_of, identity_of, kept_type
from standfast.quantities import QUANTITIES

PERSON = "person"
WITHOUT_VALUES = "This is a netCDF dimension but not a netCDF variable."


def new_persons(
    file: h5py.File, study: PopulationStudy, names: Iterable[str], people: People | None
) -> None:
    """Create the datasets of what is kept of every person; ``names`` are quantities."""
    scale = file.create_dataset(PERSON, (study.size,), ">f4")
    scale.make_scale(f"{WITHOUT_VALUES}{study.size:10d}")
    for name in names:
        row = QUANTITIES.get(name) or PARAMETERS[name]
        words = {"long_name": name.replace("_", " "), "comment": row.meaning, "units": row.unit}
        dataset = _new(file, f"person_{name}", study.size, kept_type(name))
        set_attributes(dataset, words | flags(getattr(row, "flags", ())))
    classes = {"person_sex": SEXES, "person_age_class": ages_of(study)}
    for name, dtype in identity_of(study).items():
        dataset = _new(file, name, study.size, _text(people) if dtype is None else dtype)
        attributes = {"long_name": name.removeprefix("person_").replace("_", " ")}
        if name == "person_age":
            attributes["units"] = "years"
        set_attributes(dataset, attributes | flags(classes.get(name, ())))


def flags(words: Iterable[str], dtype: type = np.uint8) -> dict[str, object]:
    """Return the attributes, after CF, of classes that are numbered from 0; none for none.

    ``dtype`` is that of the numbers, as CF wants it.
    """
    words = [word.replace(" ", "_") for word in words]
    values: np.ndarray = np.arange(len(words), dtype=dtype)
    return {"flag_values": values, "flag_meanings": " ".join(words)} if words else {}


def identities(
    study: PopulationStudy,
    strata: tuple[tuple[str, str], ...],
    people: People | None,
    found: Mapping[str, np.ndarray],
) -> dict[str, np.ndarray]:
    """Return who persons are, from the number of their ``stratum`` and of their ``row``."""
    ages = ages_of(study)
    stratum = found["stratum"].astype(np.int64)
    sexes = np.array([SEXES.index(sex) for sex, _ in strata], np.uint8)
    classes = np.array([ages.index(age) for _, age in strata], np.uint8)
    told = {"person_sex": sexes[stratum], "person_age_class": classes[stratum]}
    if people is None:
        return told
    row = found["row"].astype(np.int64)
    ids = np.array([each.encode() for each in people.id], _text(people))
    return {**told, "person_age": people.age[row], "person_id": ids[row]}


def _text(people: People | None) -> np.dtype[np.bytes_]:
    """Return the type of ids: of the longest one's length, which lies in the dataset itself."""
    ids = people.id if people is not None else ()
    found: np.dtype[np.bytes_] = h5py.string_dtype("utf-8", max(len(i.encode()) for i in ids))
    return found


def _new(file: h5py.File, name: str, size: int, dtype: object) -> h5py.Dataset:
    dataset = file.create_dataset(
        name, (size,), dtype, chunks=True, compression="gzip", shuffle=True
    )
    dataset.dims[0].attach_scale(file[PERSON])
    return dataset
