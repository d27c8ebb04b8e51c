"""Which figures a population gets: from the arrays of its file, one file each."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.ticker import PercentFormatter

from standfast import figures
from standfast.parameters import JOINTS
from standfast.population.summary.file import Population

# A cell of the risk map with fewer persons says more of chance than of risk.
FEWEST = 50

# The risk map shows cells of 5 cm by 1 kg/m², two of the stored ones each way.
TOGETHER = 2


def draw(population: Population, stem: Path, formats: Sequence[str] = ("png",)) -> list[Path]:
    """Draw all figures of a population as ``stem``-….png; return the files."""
    drawn = [
        *_risk_map(population, stem, formats),
        *_risk_by_multiple(population, stem, formats),
        *_survival(population, stem, formats),
    ]
    for output, words in (("unstable", "falling"), ("safety_factor", "the safety factor")):
        indices = population.summary["drivers"][output]
        if "remark" not in indices:
            drawn += _drivers(
                indices, words, stem.with_name(f"{stem.name}-drivers-{output}"), formats
            )
    return drawn


def _risk_map(population: Population, stem: Path, formats: Sequence[str]) -> list[Path]:
    persons = _coarser(population.array("persons"))
    with np.errstate(invalid="ignore", divide="ignore"):
        falls = np.nan_to_num(population.array("risk")) * population.array("persons")
        risk = np.where(persons >= FEWEST, _coarser(falls) / persons, np.nan)
    height, bmi = population.array("height"), population.array("bmi")
    with figures.paper_figure(height=2.8) as (figure, (ax,)):
        mesh = figures.risk_map(ax, _middles(height), _middles(bmi), risk)
        bar = figure.colorbar(
            mesh, ax=ax, label="Persons unstable", aspect=30, format=PercentFormatter(1.0)
        )
        bar.outline.set_linewidth(0.4)
        return figures.save(figure, stem.with_name(f"{stem.name}-risk-map"), formats)


def _risk_by_multiple(population: Population, stem: Path, formats: Sequence[str]) -> list[Path]:
    rigid = [
        joint
        for joint, shares in population.summary["required_stiffness"].items()
        if all(each["multiple_interval"] is None for each in shares.values())
    ]
    curves = {
        f"{joint} alone" if joint != "all" else "all joints": population.array(
            f"risk_by_{joint}_multiple"
        )
        for joint in ("all", *JOINTS)
        if joint not in rigid
    }
    with figures.paper_figure(height=2.6) as (figure, (ax,)):
        figures.risk_by_multiple(ax, population.array("multiple"), curves)
        return figures.save(figure, stem.with_name(f"{stem.name}-risk-by-multiple"), formats)


def _survival(population: Population, stem: Path, formats: Sequence[str]) -> list[Path]:
    with figures.paper_figure(height=2.5) as (figure, (ax,)):
        figures.survival_curve(ax, population.array("safety_factor"), population.array("survival"))
        return figures.save(figure, stem.with_name(f"{stem.name}-safety-factor"), formats)


def _drivers(indices: dict[str, Any], words: str, stem: Path, formats: Sequence[str]) -> list[Path]:
    pairs = {
        kind: [(each[kind], *each[f"{kind}_interval"]) for each in indices.values()]
        for kind in ("first", "total")
    }
    with figures.paper_figure(height=1.1 + 0.36 * len(indices)) as (figure, (ax,)):
        figures.sobol_bars(ax, list(indices), pairs["first"], pairs["total"])
        ax.set_title(f"What drives {words}")
        return figures.save(figure, stem, formats)


def _coarser(cells: np.ndarray) -> np.ndarray:
    """Add up TOGETHER × TOGETHER cells."""
    rows, columns = cells.shape
    blocks = cells.reshape(rows // TOGETHER, TOGETHER, columns // TOGETHER, TOGETHER)
    total: np.ndarray = blocks.sum(axis=(1, 3))
    return total


def _middles(values: np.ndarray) -> np.ndarray:
    middles: np.ndarray = values.reshape(-1, TOGETHER).mean(axis=1)
    return middles
