"""A million random persons with delayed feedback, checked by ways that share no formula.

Answers: is any crossing missing or wrong, any critical delay, any number of unstable roots, and how
many are marked uncertain? Run as ``python benchmarks/feedback_check.py [PERSONS [WORKERS]]``
(default 1000000 in two processes, about half an hour); writes ``results/feedback/README.md``.

1. Each crossing: −L⁻¹F at iω must have the eigenvalue e^(iθ). Right beside a resonance without
   damping the eigenvalue turns so fast with ω that last digits count: such a crossing is compared
   with the one that Newton's method finds from it with 40 digits.
2. Each gap between crossings, and more frequencies at random: as many roots z inside the unit
   circle, by eigenvalues, as the crossings above say. So none is missing and no direction is wrong.
3. Unstable roots by the argument principle with certified steps: without delay, at random delays,
   in later windows, just before and just after the critical delay.
4. Of a sample of stable and unstable persons: crossings by the matrix pencil, rightmost root by
   Chebyshev collocation with Newton's method, to 1e-9.
"""

import os
import sys
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import mpmath
import numpy as np

from harness import ROOT, machine

sys.path.insert(0, str(ROOT / "tests" / "helpers"))

from delay_compiled import apply
from delay_counts import counted, expanded, tops
from delay_oracles import crossings_by_pencil, polished_crossing, rightmost_by_collocation
from delay_people import KINDS, Persons, random_persons
from delay_scans import expected_inside, gaps, inside, inverse_roots
from standfast.stability.delay.persons import all_crossings, all_rightmost
from standfast.stability.delay.table import Crossings

RESULTS = ROOT / "results" / "feedback"
SEED = 2007
BLOCK = 20_000
SAMPLE = 1000  # persons for collocation and pencil, of all blocks
LONGEST, LATER = 0.5, 2.0  # s: random delays, and later windows
LATER_SHARE = 5  # one person in so many
FREQUENCIES = 4  # at random, a person
BESIDE = 1e-6  # of the critical delay: how near it the count is tried
CIRCLE = 1e-6  # distance of the eigenvalue from e^(iθ); the worst seen is a thousandth of it
EQUAL = 1e-9  # relative: crossings and rightmost roots against pencil and collocation


def main() -> None:
    """Check blocks in processes and write what was found."""
    persons = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    workers = int(sys.argv[2]) if len(sys.argv) > 2 else os.cpu_count() or 1
    blocks = max(persons // BLOCK, 1)
    found: Counter[str] = Counter()
    began = time.perf_counter()
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # a process is a thread
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        sizes = [min(BLOCK, persons)] * blocks
        samples = [-(-SAMPLE // blocks)] * blocks
        for number, one in enumerate(pool.map(check, range(blocks), sizes, samples), start=1):
            # what begins with "worst" is a largest value, all else is counted
            for name, value in one.items():
                found[name] = max(found[name], value) if "worst" in name else found[name] + value
            spent = time.perf_counter() - began
            wrong = {name: count for name, count in found.items() if name.startswith("wrong")}
            print(f"{number}/{blocks} blocks, {spent:.0f} s, {dict(wrong)}", flush=True)
    write(found, persons, time.perf_counter() - began)


def check(block: int, size: int, sample: int) -> dict[str, float]:
    """Check one block of persons; return what was counted."""
    rng = np.random.default_rng((SEED, block))
    people = random_persons(rng, size)
    table = all_crossings(people.numbers, people.rigid, apply=apply)
    found: Counter[str] = Counter(
        {"persons": size, "crossings": table.person.size, "marked": int(table.uncertain.sum())}
    )
    for kind in KINDS:
        of_kind = people.kind == kind
        found[f"persons: {kind}"] = int(of_kind.sum())
        found[f"marked: {kind}"] = int(table.uncertain[of_kind].sum())
    _scan(people, table, rng, found)
    _count(people, table, rng, found)
    _compare(people, table, rng.permutation(size)[:sample], rng, found)
    return dict(found)


def _scan(people: Persons, table: Crossings, rng: np.random.Generator, found: Counter[str]) -> None:
    """Crossings and gaps between them, by eigenvalues z."""
    size = people.kind.size
    at_crossing = Persons(*people)[table.person]
    roots = inverse_roots(at_crossing.numbers, at_crossing.rigid, table.frequency)
    away = abs(roots - np.exp(1j * table.angle)[:, None]).min(axis=1, initial=np.inf)
    certain = ~table.uncertain[table.person]
    steep = np.flatnonzero(certain & ~(away <= CIRCLE))
    apart = [_apart_from_exact(people, table, each) for each in steep]
    found["crossings compared with 40 digits"] += steep.size
    found["worst of these"] = max(apart, default=0.0)
    found["wrong: crossings"] += sum(not each <= EQUAL for each in apart)
    found["worst distance of an eigenvalue"] = float(away[certain].max(initial=0.0))
    top = tops(expanded(people.numbers, people.rigid), people.free.sum(axis=0))
    of_gap, in_gap = gaps(table, size, top)
    anyone = np.repeat(np.arange(size), FREQUENCIES)
    anywhere = np.exp(rng.uniform(np.log(1e-2), np.log(top[anyone])))
    person, omega = np.concatenate([of_gap, anyone]), np.concatenate([in_gap, anywhere])
    there = people[person]
    number, sure = inside(there.numbers, there.rigid, omega)
    sure &= ~table.uncertain[person]
    wrong = sure & (number != expected_inside(table, person, omega))
    found["frequencies"] += int(sure.sum())
    found["wrong: frequencies"] += int(wrong.sum())
    found["frequencies left open by the scan"] += int((~sure & ~table.uncertain[person]).sum())


def _apart_from_exact(people: Persons, table: Crossings, number: int) -> float:
    """Return how far a crossing is from that of Newton's method with 40 digits."""
    ours = float(table.frequency[number]), float(table.angle[number])
    a, b, c, p, d = (mpmath.matrix(each.tolist()) for each in people.matrices(table.person[number]))

    def residue(omega: mpmath.mpf, theta: mpmath.mpf) -> list[mpmath.mpf]:
        s = mpmath.mpc(0, omega)
        z = mpmath.exp(mpmath.mpc(0, -theta))
        value = mpmath.det(a * s**2 + b * s + c + (p + d * s) * z)
        return [value.real, value.imag]

    with mpmath.workdps(40):
        omega, theta = mpmath.findroot(residue, ours)
        return _apart(ours, (float(omega), float(theta)))


def _count(
    people: Persons, table: Crossings, rng: np.random.Generator, found: Counter[str]
) -> None:
    """Unstable roots at delays, by the argument principle."""
    size = people.kind.size
    everyone, critical = np.arange(size), table.critical_delay()
    finite = np.flatnonzero((critical > 0.0) & (critical < LATER))
    windows = later_windows(table, LATER)
    some = everyone[::LATER_SHARE]
    found["stable without delay"] = int((critical > 0.0).sum())
    found["stable at every delay"] = int(np.isinf(critical).sum())
    jobs = {
        "without delay": (everyone, np.zeros(size)),
        "at a random delay": (everyone, rng.uniform(0.0, LONGEST, size)),
        "just before the critical delay": (finite, critical[finite] * (1.0 - BESIDE)),
        "just after it": (finite, critical[finite] * (1.0 + BESIDE)),
        "at a later delay": (some, rng.uniform(LONGEST, LATER, some.size)),
        "in a later stable window": windows,
    }
    coefficients = expanded(people.numbers, people.rigid)
    joints = people.free.sum(axis=0)
    for what, (who, delay) in jobs.items():
        number, sure = counted(coefficients[..., who], joints[who], delay)
        each = np.zeros(size)
        each[who] = delay
        said = table.unstable_each(each)[who]
        sure &= ~table.uncertain[who]
        # without damping roots lie on the axis without delay, and neither count says where
        open_ = ~sure & ~table.uncertain[who]
        found[f"counts: {what}"] += int(sure.sum())
        found[f"wrong: counts {what}"] += int((sure & (number != said)).sum())
        found[f"open: counts {what}"] += int(open_.sum())
        if what == "just before the critical delay":
            found["wrong: critical delays"] += int((sure & (number != 0)).sum())
        if what == "just after it":
            found["wrong: critical delays"] += int((sure & (number == 0)).sum())
        if what == "in a later stable window":
            found["wrong: windows"] += int((sure & (number != 0)).sum())


def later_windows(table: Crossings, longest: float) -> tuple[np.ndarray, np.ndarray]:
    """Return who stands again after the critical delay, and the middle of the first such window."""
    events = [(p, d, c) for p, d, c in table.passages(longest)]
    if not events:
        return np.zeros(0, np.intp), np.zeros(0)
    person, delay, change = (np.concatenate(each) for each in zip(*events, strict=True))
    order = np.lexsort((delay, person))
    person, delay, change = person[order], delay[order], change[order]
    first = np.append(True, person[1:] != person[:-1])
    sums = np.cumsum(change)
    before = (sums - change)[first]
    starts = np.repeat(before, np.diff(np.append(np.flatnonzero(first), person.size)))
    level = table.unstable[person] + np.rint(sums - starts)
    until = np.where(np.append(first[1:], True), longest, np.append(delay[1:], longest))
    again = np.flatnonzero((level == 0) & (until > delay * (1.0 + 4.0 * BESIDE)))
    who, index = np.unique(person[again], return_index=True)
    chosen = again[index]
    return who, 0.5 * (delay[chosen] + until[chosen])


def _compare(
    people: Persons,
    table: Crossings,
    chosen: np.ndarray,
    rng: np.random.Generator,
    found: Counter[str],
) -> None:
    """Crossings by the pencil, the rightmost root by collocation, one person after the other."""
    delay = rng.uniform(0.0, LONGEST, chosen.size)
    root, proven = all_rightmost(
        people.numbers[..., chosen], people.rigid[:, chosen], delay, apply=apply
    )
    found["sample"] += chosen.size
    found["marked: rightmost roots"] += int((~proven).sum())
    for number, person in enumerate(chosen):
        matrices = people.matrices(person)
        mine = table.person == person
        ours = sorted(zip(table.frequency[mine], table.angle[mine], strict=True))
        theirs = [polished_crossing(matrices, *each) for each in crossings_by_pencil(matrices)]
        found["compared: crossings"] += len(theirs)
        if len(ours) != len(theirs):
            found["wrong: number of crossings"] += int(not table.uncertain[person])
        else:
            apart = [_apart(a, b) for a, b in zip(ours, theirs, strict=True)]
            found["wrong: crossings by the pencil"] += sum(each > EQUAL for each in apart)
            found["worst crossing by the pencil"] = max(
                found["worst crossing by the pencil"], *apart, 0.0
            )
        best = rightmost_by_collocation(matrices, delay[number])
        apart = abs(root[number] - best) / (1.0 + abs(best))
        found["wrong: rightmost roots"] += int(proven[number] and apart > EQUAL)
        found["worst rightmost root"] = max(found["worst rightmost root"], float(apart))


def _apart(ours: tuple[float, float], theirs: tuple[float, float]) -> float:
    turn = abs(np.angle(np.exp(1j * (ours[1] - theirs[1]))))
    return float(max(abs(ours[0] / theirs[0] - 1.0), turn))


def write(found: Counter[str], persons: int, seconds: float) -> None:
    """Write the page."""
    here = machine()
    wrong = sum(count for name, count in found.items() if name.startswith("wrong"))
    lines = [
        "# Crossings, counts and roots of delayed feedback, checked\n",
        f"Made by `python benchmarks/feedback_check.py {persons}`, seed {SEED}; "
        f"{here['processor']}, {here['cores']} cores, {seconds / 60:.0f} minutes.",
        "Random bodies, springs, coupling, damping, gains and rigid joints "
        "(`tests/helpers/delay_people.py`); the ways are told in the script.\n",
        f"**{wrong:.0f} numbers are wrong; {found['marked']:.0f} of {found['persons']:.0f} persons "
        "are marked uncertain.**\n",
        "| kind of feedback | persons | marked uncertain |",
        "|---|---|---|",
    ]
    lines += [
        f"| {kind} | {found[f'persons: {kind}']:.0f} | {found[f'marked: {kind}']:.0f} |"
        for kind in KINDS
    ]
    lines += ["", "| what | number |", "|---|---|"]
    lines += [
        f"| {name} | {count:.0f} |" if "worst" not in name else f"| {name} | {count:.1e} |"
        for name, count in found.items()
        if not name.startswith(("persons", "marked: "))
    ]
    lines.append(f"| rightmost roots without a proof | {found['marked: rightmost roots']:.0f} |")
    RESULTS.mkdir(parents=True, exist_ok=True)
    path = RESULTS / "README.md"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(path.relative_to(Path(ROOT)), f"{wrong} wrong", sep=": ")


if __name__ == "__main__":
    main()
