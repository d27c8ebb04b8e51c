"""Files of populations that are damaged or hostile, and what lies in the place of their study."""

import json
import shutil

import h5py
import numpy as np
import pytest

import standfast as sf
from populations import GOOD, changed, of
from standfast.cli.app import main
from standfast.population.people.study import PopulationStudy
from standfast.population.simulation import simulate
from standfast.population.summary.answers import ANSWERS, fits
from standfast.population.summary.file import open_population
from standfast.run.folder import parts_of, unfinished


@pytest.fixture(scope="module")
def people(tmp_path_factory):
    path = tmp_path_factory.mktemp("people") / "p.h5"
    simulate(of(changed("output.persons", True), size=3000), path)
    return path


@pytest.fixture
def copy(people, tmp_path):
    path = tmp_path / "copy.h5"
    shutil.copy(people, path)
    return path


def _put(name, **storage):
    """Put another dataset into the place of one."""

    def change(file):
        values = storage.pop("data", None)
        values = file[name][...] if values is None else values
        del file[name]
        file.create_dataset(name, data=values, **storage)

    return change


def _link(name, link):
    def change(file):
        del file[name]
        file[name] = link

    return change


def _holes(file):
    del file["person_mass"]
    file.create_dataset("person_mass", (3000,), "f8", chunks=(3000,), compression=1, shuffle=True)


def _virtual(file):
    del file["risk"]
    layout = h5py.VirtualLayout((40, 120), "f8")
    layout[...] = h5py.VirtualSource("/etc/passwd", "x", (40, 120))
    file.create_virtual_dataset("risk", layout)


def _value(name, value):
    def change(file):
        file[name][(0,) * file[name].ndim] = value

    return change


def _answers(change):
    """Change the answers, and write them as they are written."""

    def rewrite(file):
        found = json.loads(bytes(file["summary"][()]))
        change(found)
        text = json.dumps(found, ensure_ascii=False).encode()
        del file["summary"]
        file["summary"] = np.array(text, dtype=f"S{len(text)}")

    return rewrite


def _huge_text(file):
    del file["summary"]
    file.create_dataset("summary", (), "S2000000000")


ALTERATIONS = {
    "missing": lambda file: file.pop("survival"),
    "soft link": _link("risk", h5py.SoftLink("/persons")),
    "external link": _link("risk", h5py.ExternalLink("/etc/passwd", "/x")),
    "group": lambda file: (file.pop("risk"), file.create_group("risk")),
    "shape": _put("survival", data=np.zeros(402)),
    "type": _put("persons", dtype="f8"),
    "chunks": _put("survival", chunks=(401,), compression=1),
    "filter": _put("person_height", chunks=(3000,), compression="lzf"),
    "virtual": _virtual,
    "holes": _holes,
    "huge chunk": _put("person_mass", chunks=(10**7,), maxshape=(None,), compression=1),
    "axis": _value("height", np.nan),
    "share": _value("risk_by_all_multiple", 7.0),
    "no answers": lambda file: file.pop("summary"),
    "huge answers": _huge_text,
    "answer missing": _answers(lambda found: found.pop("drivers")),
    "answer of another kind": _answers(lambda found: found.update(size="many")),
    "answer too many": _answers(lambda found: found.update(more=1)),
    "infinite index": _answers(
        lambda found: found["drivers"]["unstable"]["BMI"].update(first=float("inf"))
    ),
    "answers written otherwise": lambda file: file["summary"].write_direct(
        np.array(
            bytes(file["summary"][()]).replace(b', "size"', b',\n"size"'), file["summary"].dtype
        )
    ),
    "version": lambda file: file.attrs.update(format_version=99),
    "study": lambda file: file.attrs.update(study=np.bytes_(b"{}")),
}


@pytest.mark.parametrize("how", ALTERATIONS)
def test_what_is_not_as_written_is_refused_with_a_sentence(copy, how, capsys):
    with h5py.File(copy, "r+") as file:
        ALTERATIONS[how](file)
    with pytest.raises(sf.InputError) as caught:
        open_population(copy)
    assert str(copy) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert main(["info", str(copy)]) == 2
    assert main(["plot", str(copy), "-o", str(copy.parent)]) == 2
    assert capsys.readouterr().err.count("\n") == 2


def test_arrays_are_those_that_h5py_reads(people):
    found = open_population(people)
    with h5py.File(people, "r") as file:
        assert len(file) > 30
        for name in set(file) - {"person"}:  # a dimension without values
            np.testing.assert_array_equal(found.array(name), file[name][()])


def test_an_array_of_no_study_is_refused(copy):
    with h5py.File(copy, "r+") as file:
        file["more"] = h5py.ExternalLink("/etc/passwd", "/x")
    with pytest.raises(sf.InputError, match="no array that its study promises"):
        open_population(copy).array("more")


@pytest.mark.parametrize("flip", range(12))
def test_a_flipped_bit_anywhere_gets_a_sentence_or_is_read(people, copy, flip):
    content = bytearray(people.read_bytes())
    rng = np.random.default_rng(flip)
    for _ in range(15):
        altered = content.copy()
        altered[rng.integers(len(altered))] ^= 1 << rng.integers(8)
        copy.write_bytes(altered)
        assert main(["info", str(copy)]) in (0, 2)


def paths_in(found, at=()):
    """All places in nested dictionaries and lists."""
    for key, item in found.items() if isinstance(found, dict) else enumerate(found):
        yield (*at, key)
        if isinstance(item, dict | list):
            yield from paths_in(item, (*at, key))


def test_whatever_answer_is_replaced_or_missing_is_noticed(people):
    text = json.dumps(open_population(people).summary)
    assert fits(json.loads(text), ANSWERS)
    for *path, last in paths_in(json.loads(text)):
        for other in ([[]], "", None, 2**70, {"x": 1}, True):
            found = json.loads(text)
            place = found
            for key in path:
                place = place[key]
            old, place[last] = place[last], other
            kinds = {type(old), type(other)}
            if len(kinds) == 2 and type(None) not in kinds and kinds != {int, float}:
                assert not fits(found, ANSWERS) or path[:1] == ["laws"], (path, last, other)


STUDY = of(GOOD, size=100).canonical


@pytest.mark.parametrize("change", [
    lambda study: study.pop("title"),
    lambda study: study.pop("output"),
    lambda study: study["output"].pop("persons"),
    lambda study: study.update(gravity="low"),
    lambda study: study["population"].pop("seed"),
    lambda study: study["population"].update(size="many"),
    lambda study: study["population"].update(size=10**30),
    lambda study: study["population"].update(builtin=[]),
    lambda study: study["stiffness"].update(ankle=5),
    lambda study: study["stiffness"].update(correlation=5),
    lambda study: study["stiffness"]["hip"].pop("low"),
    lambda study: study.update(title="\ud800"),
])  # fmt: skip
def test_what_is_no_study_is_refused_in_a_file_and_in_a_folder(tmp_path, change):
    study = json.loads(STUDY)
    change(study)
    with pytest.raises(sf.InputError, match="the study inside the file cannot be read"):
        PopulationStudy.from_canonical(json.dumps(study))
    folder = parts_of(tmp_path / "p.h5")
    folder.mkdir()
    (folder / "study.json").write_text(json.dumps(study))
    assert unfinished(tmp_path / "p.h5", PopulationStudy) is None
