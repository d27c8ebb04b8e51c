"""The same grid in memory: a study computed into a labelled dataset, without a file."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np

from standfast.atlas.layout import file_attributes, parameter_attributes, quantity_attributes
from standfast.engine.grid import Evaluator
from standfast.engine.own import check_own
from standfast.errors import InputError
from standfast.run.machine import cores
from standfast.run.options import check_threads
from standfast.study.grid import Tile
from standfast.study.study import GivenStudy, Study

if TYPE_CHECKING:
    import xarray


def compute(study: GivenStudy, *, threads: int | None = None) -> "xarray.Dataset":
    """Compute a study in memory, with the values, axes and attributes of its atlas.

    Parameters
    ----------
    study
        what to compute: a study, the path of its file, or its content.
    threads
        how many threads compute (default: as many as cores).

    Returns
    -------
    Dataset with a variable a quantity on its own axes, and scalar coordinates for parameters of
    one value: as ``sweep(study, …).to_xarray()``, loaded.

    Raises
    ------
    InputError
        if threads is no number of them, xarray is not installed (the extra ``standfast[xarray]``),
        or a quantity of one's own is not one number a person.

    Examples
    --------
    >>> import standfast as sf
    >>> study = {
    ...     "body": {"height": 1.66, "mass": 68},
    ...     "stiffness": {"ankle": [800, 900], "knee": 1500, "hip": [300, 400, 500]},
    ...     "output": {"quantities": ["stable", "safety_factor"]},
    ... }
    >>> ds = sf.compute(study)
    >>> ds.stable.values
    array([[0, 0, 1],
           [0, 1, 1]], dtype=uint8)
    >>> float(ds.safety_factor.sel(ankle_stiffness=900, hip_stiffness=400).round(3))
    1.05
    """
    try:
        import xarray  # noqa: PLC0415 - an extra
    except ImportError:
        raise InputError("compute needs xarray: pip install 'standfast[xarray]'") from None
    check_threads(threads)
    study = Study.of(study)
    arrays = arrays_of(study, threads=threads)
    given = {**study.axes, **study.fixed}
    return xarray.Dataset(
        {
            name: (study.axes_of(name), values, quantity_attributes(name))
            for name, values in arrays.items()
        },
        {
            name: ((name,) if name in study.axes else (), value, parameter_attributes(name))
            for name, value in given.items()
        },
        file_attributes(study),
    )


def arrays_of(
    study: Study, *, threads: int | None = None, go_on: Callable[[], object] = lambda: None
) -> dict[str, np.ndarray]:
    """Compute a study in memory: an array a quantity, on the axes that it depends on.

    ``go_on`` is called before each tile; what it raises ends the work.

    Raises
    ------
    InputError
        if a quantity of one's own is not one number a person.
    """
    check_own(study)
    evaluate = Evaluator(study)
    arrays = {
        name: np.empty(group.shape, group.dtype)
        for group in study.grid.groups
        for name in group.quantities
    }

    def fill(tile: Tile) -> None:
        go_on()
        group = study.grid.groups[tile.group]
        inside = group.inside(tile)
        target = tuple(
            slice(first, first + part.stop)
            for first, part in zip(group.start(tile), inside, strict=True)
        )
        for name, values in zip(group.quantities, evaluate(tile), strict=True):
            arrays[name][target] = values[inside]

    with ThreadPoolExecutor(threads or cores()) as pool:
        for number in range(study.shard_count):
            list(pool.map(fill, study.grid.shard(number)))
    return arrays
