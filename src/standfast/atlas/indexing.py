"""NumPy's basic indices as boxes: which range of every axis an index touches."""

from typing import Any

import numpy as np


def box_of(index: Any, shape: tuple[int, ...]) -> tuple[slice, ...] | None:
    """Return the range of every axis that an index touches; None if it is not such an index."""
    items = _items(index, len(shape))
    if items is None:
        return None
    box = []
    for item, length in zip(items, shape, strict=True):
        if isinstance(item, slice):
            steps = range(*item.indices(length))
            ends = (min(steps, default=0), max(steps, default=-1))
            box.append(slice(ends[0], ends[1] + 1))
        else:
            at = item + length if item < 0 else item
            if not 0 <= at < length:
                raise IndexError(f"index {item} is outside an axis of length {length}")
            box.append(slice(at, at + 1))
    return tuple(box)


def within_box(index: Any, count: int) -> tuple[Any, ...]:
    """Return the index that picks, inside its box, what the whole index asked for."""
    return tuple(
        slice(None, None, item.step) if isinstance(item, slice) else 0
        for item in _items(index, count) or ()
    )


def listed_axis(index: Any, count: int) -> tuple[list[Any], int]:
    """Return one item for every axis, and which axis has the one list or mask among them."""
    items = _spread(index, count)
    if len(items) > count:
        raise IndexError(f"{len(items)} indices are too many for {count} axes")
    others = [n for n, item in enumerate(items) if not _is_plain(item)]
    if len(items) != count or len(others) != 1 or np.ndim(items[others[0]]) != 1:
        raise IndexError("give integers, slices, and at most one list; or a mask of all values")
    return list(items), others[0]


def _items(index: Any, count: int) -> tuple[Any, ...] | None:
    """Return one slice or integer for every axis; None for any other kind of index."""
    items = _spread(index, count)
    return items if all(map(_is_plain, items)) and len(items) == count else None


def _spread(index: Any, count: int) -> tuple[Any, ...]:
    """Return the items of an index, with a slice for every axis that it leaves out."""
    items = index if isinstance(index, tuple) else (index,)
    at = next((n for n, item in enumerate(items) if item is Ellipsis), None)
    if at is not None:
        items = items[:at] + (slice(None),) * (count - len(items) + 1) + items[at + 1 :]
    return items + (slice(None),) * (count - len(items))


def _is_plain(item: Any) -> bool:
    return isinstance(item, slice | int | np.integer) and not isinstance(item, bool)
