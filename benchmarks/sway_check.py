"""Covariances of sway of random persons against two other methods each.

Answers: is a covariance right, without and with delay, and near the threshold? Run as
``python benchmarks/sway_check.py [CASES]`` (default 1300 of each kind, of which with delay a
thousand can be compared with both methods; a quarter of an hour); writes
``results/sway/check.md``. What is compared is the largest difference of an entry of the covariance,
over the deviations of its joints.

1. Responses in time (``tests/helpers/sway_responses.py``): Σ = ∫ h S hᵀ dt, by steps of the delay.
2. Without delay Lyapunov's equation (SciPy), with delay the delay Lyapunov matrix
   (``tests/helpers/sway_oracles.py``), whose digits are lost where τ times the fastest rate is
   large: it is compared where that is below 3.
"""

import sys
import time

import numpy as np

from harness import ROOT, machine

sys.path.insert(0, str(ROOT / "tests" / "helpers"))

from noisy_people import VARIANCES, Standing, standing_people
from standfast.stability.delay.persons import all_crossings
from standfast.stability.sway.density import PAIRS
from standfast.stability.sway.integral import integrals
from standfast.stability.sway.person import EXACT
from sway_oracles import fastest, with_delay, without_delay
from sway_responses import by_responses

RESULTS = ROOT / "results" / "sway" / "check.md"
SEED = 1000
DEMANDED = 1e-8
HOLDS = 3.0  # τ times the fastest rate, of the delay Lyapunov matrix
LONGEST = 0.1  # s
SHARE = 3.0  # persons drawn for one that stands without delay; with delay three times as many
NEAR = 100  # persons followed to their critical delay
DISTANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)


def main() -> None:
    """Compare, and write the page."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1300
    began = time.perf_counter()
    rng = np.random.default_rng(SEED)
    without = drawn(rng, count, 0.0)
    late = drawn(rng, count, LONGEST)
    lines = compared("without delay", without, ("responses in time", "Lyapunov's equation"))
    words = f"delays up to {LONGEST} s"
    lines += compared(words, late, ("responses in time", "delay Lyapunov matrix"))
    lines += near_the_threshold(late)
    here = machine()
    minutes = (time.perf_counter() - began) / 60
    page = [
        "# Covariances of sway, checked\n",
        f"Made by `python benchmarks/sway_check.py {count}`, seed {SEED}; {here['processor']}, "
        f"{minutes:.0f} minutes. Random persons who stand (`tests/helpers/noisy_people.py`): one "
        "to three free joints, coupled or not, gains of every kind, noise at all joints. Compared "
        "are all entries of the covariance of the rotations, asked to 1e-10, over the deviations "
        f"of the two joints; {DEMANDED:g} is demanded. The methods are told in the script.\n",
        "| persons | method | compared | worst | of 99 % | above 1e-8 |",
        "|---|---|---|---|---|---|",
        *lines,
        "",
        "Ever nearer to the critical delay the covariance grows beyond bounds, and with it what "
        "rounding does to any method: of a person that near the digits are not there.",
    ]
    RESULTS.parent.mkdir(parents=True, exist_ok=True)
    RESULTS.write_text("\n".join(page) + "\n", encoding="utf-8")
    print("\n".join(lines))


def drawn(rng: np.random.Generator, count: int, longest: float) -> Standing:
    """Return as many persons who stand."""
    standing = standing_people(rng, int(SHARE * (3.0 if longest else 1.0) * count), longest)
    if standing.delay.size < count:
        raise ValueError(f"only {standing.delay.size} of the persons stand; draw more")
    return standing[slice(0, count)]


def covariances(standing: Standing) -> np.ndarray:
    """Return covariances as ``sf.sway_covariance`` finds them, (persons, 3, 3)."""
    swaying = standing.swaying
    variance, sure = integrals(VARIANCES, swaying, accuracy=EXACT)
    deviation = np.sqrt(variance)
    across = tuple(row for row in range(len(PAIRS)) if row not in VARIANCES)
    # of a rigid joint any size will do: what is integrated is 0
    sizes = [deviation[i] * deviation[j] for i, j in (PAIRS[row] for row in across)]
    sizes = np.where(np.stack(sizes) > 0.0, sizes, 1.0)
    covariance, known = integrals(across, swaying, accuracy=EXACT, sizes=sizes)
    if not (sure.all() and known.all()):
        raise ArithmeticError("a covariance is not as accurate as asked")
    found = np.zeros((standing.delay.size, 3, 3))
    for row, values in (
        *zip(VARIANCES, variance, strict=True),
        *zip(across, covariance, strict=True),
    ):
        i, j = PAIRS[row]
        found[:, i, j] = found[:, j, i] = values
    return found


def differences(
    standing: Standing, found: np.ndarray, method: str, chosen: np.ndarray
) -> np.ndarray:
    """Return the largest difference of each person's covariance; NaN where the method fails."""
    apart = np.full(chosen.size, np.nan)
    for place, number in enumerate(chosen):
        free = np.flatnonzero(standing.people.free[:, number])
        matrices, noise = standing.people.matrices(number), standing.noise[free, number]
        delay = standing.delay[number]
        if method == "responses in time":
            exact = by_responses(matrices, noise, delay)
        elif method == "delay Lyapunov matrix":
            exact = with_delay(matrices, noise, delay)
        else:
            exact = without_delay(matrices, noise)
        sizes = np.sqrt(np.outer(exact.diagonal(), exact.diagonal()))
        apart[place] = (abs(found[number][np.ix_(free, free)] - exact) / sizes).max()
    return apart


def compared(what: str, standing: Standing, methods: tuple[str, ...]) -> list[str]:
    """Return rows of the table, a method each."""
    everyone = np.arange(standing.delay.size)
    found = covariances(standing)
    lines = []
    for method in methods:
        chosen = everyone
        if method == "delay Lyapunov matrix":
            chosen = np.flatnonzero(fastest(standing.people) * standing.delay < HOLDS)
        apart = differences(standing, found, method, chosen)
        known = apart[~np.isnan(apart)]
        lines.append(
            f"| {what} | {method} | {known.size} of {everyone.size} | {known.max():.0e} | "
            f"{np.quantile(known, 0.99):.0e} | {int((known > DEMANDED).sum())} |"
        )
        print(lines[-1], flush=True)
    return lines


def near_the_threshold(standing: Standing) -> list[str]:
    """Return rows of the table at delays nearer and nearer to the critical one."""
    people = standing.people
    critical = all_crossings(people.numbers, people.rigid).critical_delay()
    holds = (critical > 0.0) & np.isfinite(critical) & (fastest(people) * critical < HOLDS)
    chosen = np.flatnonzero(holds)[:NEAR]
    some, critical = standing[chosen], critical[chosen]
    lines = []
    for distance in DISTANCES:
        at = some._replace(delay=critical * (1.0 - distance))
        words = f"{distance:g} before the critical delay"
        lines += compared(words, at, ("delay Lyapunov matrix",))
    return lines


if __name__ == "__main__":
    main()
