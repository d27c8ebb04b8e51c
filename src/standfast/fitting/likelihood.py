"""How likely measures are of a law's person, as a sum of squares, with derivatives.

    −2 log L(θ) = Q(θ) + log |C(θ)|,  Q = (y − μ)ᵀ C⁻¹ (y − μ) = |ρ|²,  ρ = L⁻¹ (y − μ),  C = L Lᵀ

y are logarithms of the measures, μ and C their expectation and covariance in recordings of this
length (:mod:`.moments`), Gaussian to a good approximation. Of the true person Q is distributed as
χ² of as many degrees of freedom as there are measures. A solver of least squares takes ρ and
√(log |C| + c). dρ = −L⁻¹ dμ − Φ(L⁻¹ dC L⁻ᵀ) ρ with Φ the lower triangle and half of the diagonal;
d log |C| is the trace of L⁻¹ dC L⁻ᵀ.
"""

from typing import NamedTuple

import numpy as np

from standfast.fitting.family import NOISE, Points
from standfast.fitting.moments import FREQUENCY, Moments, moments, readings_of
from standfast.fitting.window import Window
from standfast.numerics.arrays import TURN
from standfast.stability.sway.responses import Matrices, determinant, followed, matrices


class Target(NamedTuple):
    """Measures by name, their logarithms, the window of their recording and its low-pass (Hz)."""

    measures: tuple[str, ...]
    logarithms: np.ndarray
    window: Window
    low_pass: float


# Most that det H⁻¹ may turn between two frequencies of a window (rad): with more a resonance is
# narrower than they show, and its ringing no stationary process within minutes (a decay slower than
# 0.02 1/s in 60 s, than 0.002 1/s in 1,200 s).
MOST_TURN = 1.2
# c a measure: no measure is known better than to 1e-7, whatever it is beside the others.
LEAST = 32.0


class Likelihood:
    """−2 log L of points; the last is kept, since a solver asks for values and slopes apart.

    Of all that were asked for it is kept who stands.
    """

    def __init__(self, points: Points, target: Target) -> None:
        self.points, self.target = points, target
        self._last: tuple[bytes, np.ndarray, np.ndarray] | None = None
        self._stands: dict[bytes, bool] = {}

    def ask(self, points: np.ndarray) -> None:
        """Find who of points, (n, coordinates), stands, before they are looked at one by one.

        Five hundred together take as long as ten one by one.
        """
        verdicts = self.points.stand(points)
        self._stands.update(
            (point.tobytes(), bool(each)) for point, each in zip(points, verdicts, strict=True)
        )

    def residual(self, point: np.ndarray) -> np.ndarray:
        """Return ρ and √(log |C| + c), (measures + 1,); infinite where the person falls."""
        return self._at(point)[0]

    def slope(self, point: np.ndarray) -> np.ndarray:
        """Return the derivatives of the residual, (measures + 1, coordinates)."""
        return self._at(point)[1]

    def size(self, point: np.ndarray) -> float:
        """Return −2 log L, but for a constant."""
        return float((self.residual(point) ** 2).sum())

    def misfit(self, point: np.ndarray) -> float:
        """Return Q."""
        return float((self.residual(point)[:-1] ** 2).sum())

    def over_noise(self, point: np.ndarray) -> tuple[float, float, float]:
        """Return −2 log L at the most likely noise, log σ of that, and its standard error.

        The noise in ``point`` means nothing unless it is not open. Infinite, 0, 0 where the person
        falls.
        """
        found = self.moments(point, slopes=False)
        if found is None:
            return np.inf, 0.0, 0.0
        free = self.points.family.free
        start = point[free.index(NOISE)] if NOISE in free else 0.0
        gap = self.target.logarithms - found.mean
        sign, logarithm = np.linalg.slogdet(found.covariance)
        if not sign > 0.0:
            return np.inf, 0.0, 0.0
        constant = logarithm + LEAST * gap.size
        weighed = np.linalg.solve(found.covariance, np.stack([gap, self.scaled], axis=1))
        if NOISE not in free:
            return float(gap @ weighed[:, 0] + constant), 0.0, 0.0
        information = float(self.scaled @ weighed[:, 1])
        change = float(self.scaled @ weighed[:, 0]) / information
        size = float(gap @ weighed[:, 0]) - information * change**2
        return size + constant, start + change, information**-0.5

    @property
    def scaled(self) -> np.ndarray:
        """Which measures the noise scales, as 1 and 0: all but frequencies."""
        return np.array([name != FREQUENCY for name in self.target.measures], float)

    def moments(self, point: np.ndarray, *, slopes: bool = True) -> Moments | None:
        """Return the moments of the measures, None who falls, or rings too long for the window.

        With ``slopes`` their derivatives along all coordinates.
        """
        if point.tobytes() not in self._stands:
            self.ask(point[None])
        if not self._stands[point.tobytes()]:
            return None
        candidate = self.points.candidate(point, slopes=slopes)
        measures, _, window, low_pass = self.target
        swaying, free = candidate.swaying, self.points.family.free
        known = matrices(swaying, self.points.rigid[:, 0], TURN * window.hertz)
        if rings(known):
            return None
        response, slope = followed(
            known, swaying, readings_of(measures), candidate.changes, TURN * low_pass
        )
        noisy = np.flatnonzero(swaying.noise[:, 0])
        found = moments(
            measures, window, response[:, noisy], slope[:, :, noisy], swaying.noise[noisy, 0]
        )
        # σ scales all readings alike, and so moves logarithms, but neither frequency nor covariance
        mean = found.mean + candidate.noise * self.scaled
        if NOISE not in free or not slopes:
            return found._replace(mean=mean)
        place = free.index(NOISE)
        nothing = np.zeros_like(found.covariance)
        return Moments(
            mean,
            found.covariance,
            np.insert(found.mean_slope, place, self.scaled, axis=0),
            np.insert(found.covariance_slope, place, nothing, axis=0),
        )

    def _at(self, point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        key = point.tobytes()
        if self._last is None or self._last[0] != key:
            self._last = (key, *self._computed(point))
        return self._last[1:]

    def _computed(self, point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        count = len(self.target.measures)
        falls = np.full(count + 1, np.inf), np.zeros((count + 1, point.size))
        found = self.moments(point)
        if found is None or not np.isfinite(found.covariance).all():
            return falls
        try:
            root = np.linalg.cholesky(found.covariance)
        except np.linalg.LinAlgError:  # measures of one motion, as SDs of an angle and of the CoM
            return falls
        rho = np.linalg.solve(root, self.target.logarithms - found.mean)
        logarithm = 2.0 * np.log(np.diagonal(root)).sum()
        last = np.sqrt(max(logarithm + LEAST * count, 1.0))
        below = np.linalg.inv(root)
        inner = below @ found.covariance_slope @ below.T
        half = np.tril(inner)
        half[:, range(count), range(count)] *= 0.5
        of_rho = -found.mean_slope @ below.T - half @ rho
        of_last = 0.5 * np.trace(inner, axis1=1, axis2=2) / last
        return np.append(rho, last), np.column_stack([of_rho, of_last]).T


def rings(known: Matrices) -> bool:
    """Return whether a person has a resonance that evenly spaced frequencies from 0 do not show.

    Slow drift, a pole next to 0, is none: what it adds is far from 0 as smooth as all else.
    """
    found = determinant(known)[1:]
    turned = found[1:] * found[:-1].conj()
    # |angle| > MOST_TURN, which is below a quarter turn
    return bool((turned.real < np.cos(MOST_TURN) * abs(turned)).any())
