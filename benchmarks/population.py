"""How fast are persons drawn, judged and counted, beside drawing their random numbers alone.

And beside the same population in plain NumPy and with OpenTURNS' random numbers, with the same
fraction unstable. Run as ``python benchmarks/population.py`` (about a minute).
"""

import math
import os
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from harness import Demand, Report, Row, in_turn, ratio
from standfast.population.cohort.cohort import Cohort, cohort_of
from standfast.population.cohort.counting import Block, Counts, count_block, histogram_shapes
from standfast.population.cohort.histograms import Histograms
from standfast.population.people.study import PopulationStudy
from standfast.study.toml import read_toml

SIZE = 10**8
PLAIN_SIZE = 2**20
ROUNDS = 3
STUDY = Path(__file__).with_name("population.toml")


def main() -> None:
    """Measure, check that the fractions agree, and write the report."""
    study = PopulationStudy.from_toml(STUDY)
    cohort = cohort_of(study, None)
    threads = os.cpu_count() or 1
    fractions: dict[str, tuple[float, int]] = {}

    def ours() -> None:
        together = Histograms.empty(*histogram_shapes(cohort))
        for counts in _counted(study, cohort, 2 * threads):
            together.add(counts.histograms)
        classes = together.classes
        fractions["standfast"] = (classes[..., 1].sum() / classes.sum(), study.size)

    def draw(first: int) -> None:
        for block in range(first, study.blocks_per_replicate, threads):
            cohort.sampler.variates(0, block, study.block_size)

    def drawing() -> None:
        workers = [threading.Thread(target=draw, args=(i,)) for i in range(threads)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()

    def plain() -> None:
        random = np.random.Generator(np.random.SFC64(1))
        normal = random.standard_normal((4, PLAIN_SIZE))
        fractions["NumPy"] = (_plain(normal, random.random(PLAIN_SIZE)), PLAIN_SIZE)

    jobs = {"standfast": ours, "drawing": drawing, "NumPy": plain}
    try:
        import openturns as ot  # noqa: PLC0415 - a peer that need not be there

        distribution = ot.JointDistribution(
            [ot.Normal(), ot.Normal(), ot.Normal(), ot.Normal(), ot.Uniform(0.0, 1.0)]
        )

        def with_openturns() -> None:
            sample = np.asarray(distribution.getSample(PLAIN_SIZE)).T
            fractions["OpenTURNS"] = (_plain(sample[:4], sample[4]), PLAIN_SIZE)

        jobs["OpenTURNS"] = with_openturns
    except ImportError:
        pass
    seconds = in_turn(jobs, ROUNDS)
    known, size = fractions["standfast"]
    rows = []
    for name, words, work in (
        ("drawing", "drawing the random numbers alone, same threads", study.size),
        ("standfast", "standfast: drawn, judged, counted", study.size),
        ("NumPy", "plain NumPy, one thread, fraction alone", PLAIN_SIZE),
        ("OpenTURNS", "numbers of OpenTURNS, judged in NumPy, fraction alone", PLAIN_SIZE),
    ):
        if name in seconds:
            accuracy = ""
            if name in fractions:
                share, of = fractions[name]
                errors = abs(share - known) / math.sqrt(known * (1 - known) * (1 / of + 1 / size))
                assert errors < 4.0, f"{name}: {share} is not {known}"  # noqa: S101
                accuracy = f"{100 * share:.3f} % unstable"
            rows.append(Row(words, seconds[name], work, "persons", accuracy))
    report = Report(
        "population",
        "How fast are persons drawn, judged and counted?",
        f"{study.size:,} women of NHANES, normal laws of all three joints, {threads} threads",
        rows,
        [
            Demand(
                "population over drawing its random numbers alone",
                0.7,
                ratio(seconds, "drawing", "standfast"),
            )
        ],
        [
            "Distributions are kept of the first 2²⁰ persons; of so many alone the rate is lower "
            "(next row), because each is then put into eight counts.",
            "Plain NumPy and OpenTURNS compute the fraction unstable alone, by thresholds.",
        ],
    )
    content = read_toml(STUDY)
    content["population"]["size"] = 2**20
    detailed = PopulationStudy.from_dict(content)

    def with_details() -> None:
        list(_counted(detailed, cohort, 2 * threads))

    few = in_turn({"details": with_details}, 5)["details"]
    report.rows.insert(
        2, Row("standfast: the first 2²⁰, with all distributions", few, 2**20, "persons")
    )
    report.write(("openturns",))


def _counted(study: PopulationStudy, cohort: Cohort, threads: int) -> Iterator[Counts]:
    """Count all blocks in threads, as a simulation does: two of them a core."""
    units = [Block(0, number) for number in range(study.blocks_per_replicate)]
    with ThreadPoolExecutor(threads) as pool:
        yield from pool.map(lambda unit: count_block(study, cohort, unit), units)


def _plain(normal: np.ndarray, uniform: np.ndarray) -> float:
    """Return the fraction unstable as a NumPy user writes it: thresholds from the top down."""
    height = 1.61008 + 0.06866 * normal[0]
    r = -0.0515
    log = 2.88009 + 0.40285 * (r * normal[0] + math.sqrt(1.0 - r**2) * normal[1])
    bmi = 10.5831 + np.exp(log)
    weight = 9.81 * bmi * height**2 * height
    upper = weight * 0.678 * 0.626 * 0.288
    thigh = weight * (0.2 * 0.567 * 0.245 + 0.678 * 0.245)
    shank = weight * (0.093 * 0.567 * 0.246 + 0.878 * 0.246)
    g3, g2 = upper, upper + thigh
    g1 = g2 + shank
    ankle = np.maximum(1.8 + 0.3 * normal[2], 0.0) * g1
    knee = np.maximum(3.0 + 0.6 * normal[3], 0.0) * g2
    hip = (1.5 + 3.0 * uniform) * g3
    with np.errstate(divide="ignore", invalid="ignore"):
        at_knee = np.where(hip > upper, thigh + upper * hip / (hip - upper), np.inf)
        at_ankle = np.where(knee > at_knee, shank + at_knee * knee / (knee - at_knee), np.inf)
    return float(1.0 - (ankle > at_ankle).mean())


if __name__ == "__main__":
    main()
