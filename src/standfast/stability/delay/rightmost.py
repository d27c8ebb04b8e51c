"""The rightmost characteristic root at a delay, of many persons at once, proven to be it.

1. Candidates: the roots without delay, and of each crossing of the axis where the root has gone
   since, s ≈ iω + (ds/dτ)(τ − τk); Newton's method takes each to a root.
2. The proof: no root lies right of the best. Roots right of Re s = σ are the unstable roots of the
   matrices shifted by σ, A, B + 2σA, C + σB + σ²A, (P + σD) e^(−στ), D e^(−στ), which are counted
   as all others, from their crossings.
3. Where roots do lie there, the shifted crossings give candidates nearer to them; from where none
   is better, the line is moved by bisection.

notation: A inertia, B damping, C stiffness less gravity, P and D gains, τ delay, s root (1/s).
"""

import numpy as np

from standfast.numerics.arrays import TURN, Array, Scalar, namespace
from standfast.numerics.polynomials import all_roots
from standfast.stability.delay.characteristic import undelayed
from standfast.stability.delay.crossings import crossings_of
from standfast.stability.delay.problem import Apply, Problem, directly, highest, prepared
from standfast.stability.delay.resultant import slopes
from standfast.stability.delay.table import Crossings

NEWTON_STEPS = 6  # in one call
MOST_CALLS = 3
CONVERGED = 1e-11  # of the last step relative to the root
RIGHT_OF = 1e-9  # how far right of a root, in 1/s and relative, none may lie
ROUNDS = 60
CHAIN = 5  # turns of a crossing that are followed, the last first


def newton(problem: Problem, coefficients: Array, delay: Scalar, re: Scalar, im: Scalar) -> Array:
    """Return real part, imaginary part and last step of candidates after steps of Newton's."""
    quasi = problem.quasi(coefficients)
    xp = namespace(delay, re, im)
    s, step = re + 1j * im, 0.0 * re
    for _ in range(NEWTON_STEPS):
        z = xp.exp(-s * delay)
        at, by_s, by_z = slopes(quasi, s, z)
        change = at / (by_s - delay * z * by_z)
        s, step = s - change, abs(change)
    return xp.stack([s.real, s.imag, step])


def shifted(numbers: np.ndarray, delay: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """Return the matrices whose unstable roots are those right of Re s = shift, less the shift."""
    a, b, c, p, d = numbers
    late = np.exp(-shift * delay)
    return np.stack(
        [a, b + 2.0 * shift * a, c + shift * (b + shift * a), (p + shift * d) * late, d * late]
    )


def rightmost_roots(
    problem: Problem, numbers: np.ndarray, delay: np.ndarray, *, apply: Apply = directly
) -> tuple[np.ndarray, np.ndarray]:
    """Return each person's rightmost root (1/s), imaginary part ≥ 0, and whether it is proven."""
    coefficients = np.asarray(apply(prepared, problem, numbers))
    bound = np.asarray(apply(highest, problem, numbers))
    search = _Search(problem, numbers, delay, coefficients, np.sqrt(bound), apply)
    everyone = np.arange(delay.size)
    if problem.rank == 0:  # the roots of a polynomial are all there are
        search.try_limits(everyone)
        return search.root, np.isfinite(search.root)
    table = crossings_of(problem, numbers, boxes=False, apply=apply)
    unstable = table.unstable_each(delay)
    search.high[(unstable == 0) & ~table.uncertain] = 0.0
    search.try_from(everyone, table, np.zeros(delay.size))
    search.try_limits(everyone)
    for _ in range(ROUNDS):
        open_ = np.flatnonzero(~search.proven)
        if not open_.size:
            break
        search.round(open_)
    return search.root, search.proven


class _Search:
    """What is known of each person's rightmost root: the best root, and lines beside it."""

    def __init__(
        self,
        problem: Problem,
        numbers: np.ndarray,
        delay: np.ndarray,
        coefficients: np.ndarray,
        highest: np.ndarray,
        apply: Apply,
    ) -> None:
        self.problem, self.numbers, self.delay = problem, numbers, delay
        self.coefficients, self.apply = coefficients, apply
        self.root = np.full(delay.size, -np.inf, complex)
        self.low = np.full(delay.size, -1e3)  # roots lie right of it
        self.high = highest * (1.0 + 1e-6)  # none lies right of it
        self.allowance = np.full(delay.size, RIGHT_OF)
        self.step = np.full(delay.size, 1.0)
        self.proven = np.zeros(delay.size, bool)

    def round(self, persons: np.ndarray) -> None:
        """Count the roots right of a line: just right of the best root, or between the lines."""
        root, low, high = self.root[persons], self.low[persons], self.high[persons]
        beside = root.real > low
        allowed = self.allowance[persons] * (1.0 + abs(root))
        stepped = low + self.step[persons]
        middle = 0.5 * (low + high)
        line = np.where(beside, root.real + allowed, np.where(stepped < middle, stepped, middle))
        self.step[persons[~beside]] *= 2.0
        # Beside a root there are pairs of crossings that no box tells apart either: whom the cells
        # leave open gets another line.
        table = crossings_of(
            self.problem,
            shifted(self.numbers[..., persons], self.delay[persons], line),
            boxes=False,
            apply=self.apply,
        )
        count = table.unstable_each(self.delay[persons])
        none = (count == 0) & ~table.uncertain
        self.proven[persons[none & beside]] = True
        self.high[persons[none & ~beside]] = line[none & ~beside]
        self.allowance[persons[table.uncertain]] *= 8.0
        more = (count > 0) & ~table.uncertain
        self.low[persons[more]] = np.maximum(line, low)[more]
        self.try_from(persons, table, line)

    def try_from(self, persons: np.ndarray, table: Crossings, line: np.ndarray) -> None:
        """Follow each crossing of Re s = line to the delay, and take the best root found.

        A crossing that was passed several times has left a chain of roots, one a turn, of which any
        may be the rightmost: each starts from where it has gone since, and from where its phase
        says that it is now.
        """
        whose = persons[table.person]
        passed = np.floor((self.delay[whose] * table.frequency - table.angle) / TURN)
        back = np.arange(CHAIN)[:, None]
        turn = np.maximum(passed, 0.0) - back + np.where(passed < 0.0, 0.0, 1.0)
        number = np.broadcast_to(np.arange(whose.size), turn.shape)[turn >= 0.0]
        turn, whose = turn[turn >= 0.0], whose[number]
        delay, phase = self.delay[whose], table.angle[number] + TURN * turn
        crossed = phase / table.frequency[number]
        s = line[table.person[number]] + 1j * table.frequency[number]
        with np.errstate(all="ignore"):
            z = np.exp(-s * crossed)
            _, by_s, by_z = slopes(self.problem.quasi(self.coefficients[:, whose]), s, z)
            since = s + s * z * by_z / (by_s - crossed * z * by_z) * (delay - crossed)
            now = s.real + 1j * phase / delay
        self._improve(np.concatenate([whose, whose]), np.concatenate([since, now]))

    def try_limits(self, persons: np.ndarray) -> None:
        """Start from the roots without delay, and from those without feedback.

        Fast falls are over before the feedback arrives, and so are near the latter.
        """
        quasi = self.problem.quasi(self.coefficients[:, persons])
        for polynomial in (undelayed(quasi), quasi[0]):
            roots = all_roots(np.array(polynomial))
            self._improve(np.repeat(persons, roots.shape[1]), roots.ravel())

    def _improve(self, whose: np.ndarray, s: np.ndarray) -> None:
        """Take candidates to roots by Newton's method; keep each person's rightmost."""
        above = np.isfinite(s) & (s.imag >= 0.0)
        whose, s = whose[above], s[above]
        re, im = s.real.copy(), s.imag.copy()
        step = np.full(s.size, np.inf)
        active = np.arange(s.size)
        for _ in range(MOST_CALLS):
            if not active.size:
                break
            people = whose[active]
            found = np.asarray(
                self.apply(
                    newton,
                    self.problem,
                    self.coefficients[:, people],
                    self.delay[people],
                    re[active],
                    im[active],
                )
            )
            re[active], im[active], step[active] = found
            size = np.hypot(re[active], im[active])
            active = active[~(found[2] < CONVERGED * (1.0 + size)) & np.isfinite(size)]
        good = step < CONVERGED * (1.0 + np.hypot(re, im))
        whose, re, im = whose[good], re[good], abs(im[good])
        order = np.lexsort((re, whose))
        whose, re, im = whose[order], re[order], im[order]
        last = np.append(whose[1:] != whose[:-1], True) if whose.size else np.zeros(0, bool)
        whose, best = whose[last], re[last] + 1j * im[last]
        better = best.real > self.root[whose].real
        self.root[whose[better]] = best[better]
