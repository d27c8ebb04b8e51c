"""Sway of random persons simulated in time, long, beside what integrals over frequencies say.

Answers: are covariances of rotations, and the variances of the centre of pressure and of its
velocity, those of a stochastic simulation, with delay and without? Run as
``python benchmarks/sway_simulation.py [SECONDS]`` (default 30 of each of 200 paths a person, some
minutes); writes ``results/sway/simulation.md``. A difference is told in standard errors, from the
spread between the paths, which are independent: if nothing is wrong, they are those of a normal
variate.
"""

import sys
import time

import numpy as np

from harness import ROOT, machine

sys.path.insert(0, str(ROOT / "tests" / "helpers"))

from noise_simulation import STEP, recorded
from noisy_people import Standing, standing_people
from standfast.stability.delay.persons import all_rightmost
from standfast.stability.sway.density import COP, COP_VELOCITY, PAIRS
from standfast.stability.sway.integral import integrals

RESULTS = ROOT / "results" / "sway" / "simulation.md"
SEED = 1912
LONGEST = 0.2  # s
PERSONS = 20  # of each kind
PATHS, KEPT = 200, 40  # of a person; of those that record the CoP
SLOWEST = 0.4  # 1/s: who decays more slowly would need longer paths
DRAWN = 2000


def main() -> None:
    """Simulate, compare, and write the page."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 30.0
    began = time.perf_counter()
    rng = np.random.default_rng(SEED)
    lines = []
    for what, longest in (("without delay", 0.0), (f"delays up to {LONGEST} s", LONGEST)):
        standing, decay = settled(rng, longest)
        lines += compared(what, standing, decay, seconds, rng)
        print(*lines, sep="\n", flush=True)
    here = machine()
    page = [
        "# Sway and simulations in time\n",
        f"Made by `python benchmarks/sway_simulation.py {seconds:g}`, seed {SEED}; "
        f"{here['processor']}, {(time.perf_counter() - began) / 60:.0f} minutes. {PERSONS} random "
        f"persons of each kind with three free joints who decay at {SLOWEST:g} 1/s or faster, "
        f"{PATHS} paths of {seconds:g} s each ({KEPT} of them record the CoP), steps of "
        f"{1e3 * STEP:g} ms at most.\n",
        "z is the simulation less the integral, in standard errors of the simulation; of a right "
        "integral its root mean square is 1, and 5 in 100 lie beyond 2. The mean difference is "
        "that of all persons together, relative to the integral (a covariance: to the "
        "deviations), with its standard error.\n",
        "| persons | what | compared | z: rms | beyond 2 | largest | mean difference |",
        "|---|---|---|---|---|---|---|",
        *lines,
    ]
    RESULTS.parent.mkdir(parents=True, exist_ok=True)
    RESULTS.write_text("\n".join(page) + "\n", encoding="utf-8")


def settled(rng: np.random.Generator, longest: float) -> tuple[Standing, np.ndarray]:
    """Return persons who decay fast enough, and their decay rates (1/s)."""
    standing = standing_people(rng, DRAWN, longest, rigid_share=0.0)
    people = standing.people
    root, _ = all_rightmost(people.numbers, people.rigid, standing.delay)
    chosen = np.flatnonzero((-root.real > SLOWEST) & ((standing.delay > STEP) | (longest == 0.0)))
    if chosen.size < PERSONS:
        raise ValueError(f"only {chosen.size} persons decay fast enough; draw more")
    chosen = chosen[:PERSONS]
    return standing[chosen], -root.real[chosen]


def compared(
    what: str, standing: Standing, decay: np.ndarray, seconds: float, rng: np.random.Generator
) -> list[str]:
    """Return rows of the table."""
    found = recorded(rng, standing, decay, seconds, PATHS, KEPT)
    rows = (*range(len(PAIRS)), COP, COP_VELOCITY)
    exact, _ = integrals(rows, standing.swaying)
    deviation = np.sqrt([exact[PAIRS.index((joint, joint))] for joint in range(3)])
    kinds: dict[str, list[tuple[np.ndarray, np.ndarray, np.ndarray]]] = {}
    for row, (i, j) in enumerate(PAIRS):
        kind = "variances of rotations" if i == j else "covariances of rotations"
        sizes = deviation[i] * deviation[j]
        kinds.setdefault(kind, []).append((found.rotations[:, :, i, j], exact[row], sizes))
    kinds["variance of the CoP"] = [(found.pressure, exact[-2], exact[-2])]
    kinds["variance of its velocity"] = [(found.velocity, exact[-1], exact[-1])]
    return [row_of(what, kind, parts) for kind, parts in kinds.items()]


def row_of(what: str, kind: str, parts: list[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> str:
    """Return a row of the table of means of paths, integrals and what they are relative to."""
    paths = np.stack([(of - exact[:, None]) / sizes[:, None] for of, exact, sizes in parts])
    count = paths.shape[-1]
    apart = paths.mean(axis=-1)
    z = apart / (paths.std(axis=-1, ddof=1) / np.sqrt(count))
    # joints of a person go together, persons do not
    of_person = paths.mean(axis=0).std(axis=-1, ddof=1) / np.sqrt(count)
    together = np.sqrt(np.sum(of_person**2)) / of_person.size
    return (
        f"| {what} | {kind} | {z.size} | {np.sqrt(np.mean(z**2)):.2f} | "
        f"{int((abs(z) > 2.0).sum())} | {abs(z).max():.1f} | "
        f"{100.0 * apart.mean():+.2f} ± {100.0 * together:.2f} % |"
    )


if __name__ == "__main__":
    main()
