"""How the grid of a study is cut: chunks, tiles, shards."""

import math

import pytest

import standfast as sf
from standfast.study import grid
from standfast.study.grid import CHUNK_BYTES, chunk_shape
from studies import several_shards


@pytest.mark.parametrize(
    "shape",
    [(), (1,), (3,), (401, 401, 5), (1000, 1000, 1000), (10**7,), (2, 3, 10**6), (40, 50, 60, 70)],
)
def test_chunks_fit_and_waste_little(shape):
    chunk = chunk_shape(shape, CHUNK_BYTES)
    assert math.prod(chunk) <= CHUNK_BYTES
    assert all(1 <= c <= n for c, n in zip(chunk, shape, strict=True))
    stored = math.prod(-(-n // c) * c for n, c in zip(shape, chunk, strict=True))
    assert stored <= 1.1 * math.prod(shape)


def test_tiles_of_all_shards_cover_every_chunk_once():
    study = sf.Study.from_dict(several_shards())
    tiles = [tile for number in range(len(study.grid.shards)) for tile in study.grid.shard(number)]
    assert len(study.grid.shards) > 5
    assert len(set(tiles)) == len(tiles) == sum(group.tile_count for group in study.grid.groups)
    for tile in tiles:
        assert all(
            0 <= i < n
            for i, n in zip(tile.chunk, study.grid.groups[tile.group].chunks, strict=True)
        )


def test_shards_are_filled_across_groups_and_hold_a_tile_at_least(monkeypatch):
    study = sf.Study.from_dict(several_shards())
    work = [
        sum(study.grid.groups[tile.group].tile_work for tile in study.grid.shard(number))
        for number in range(study.shard_count)
    ]
    assert max(work) <= grid.SHARD_WORK
    assert min(work[:-1]) > grid.SHARD_WORK - max(group.tile_work for group in study.grid.groups)
    assert any(len(groups) > 1 for groups in study.grid.shards)
    monkeypatch.setattr(grid, "SHARD_WORK", 1)  # less than one tile of numbers
    study = sf.Study.from_dict(several_shards())
    assert all(len(study.grid.shard(number)) == 1 for number in range(study.shard_count))
