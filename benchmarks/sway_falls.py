"""Whether margins of the 163 people tell those who fell in the last twelve months.

Fixed before any of it was computed:

- Person: height and mass, Winter's segments, knee and hip rigid. Law: pasma-2017, the one law of a
  single link whose gains and body both stand in its source, with P, D, K and B as multiples of
  m g h. Data: the median of the three trials with open eyes on firm ground.
- Noise is fitted to the SD of the centre of pressure. In a linear model no margin and no mean
  frequency depends on it, so that it is reported only by being among the predictors.
- One number is fitted to the mean frequency of the centre of pressure (control moments, recordings
  of 60 s, as published): "gain", P with K as published; or "stiffness", K with P as published.
- Margins: safety factor (K + P)/(m g h); critical delay; delay margin, which is the critical delay
  less the law's one delay and so ranks people just alike.
- Who fell: once or more in twelve months. Groups: old (60 and more), which is the question, and
  young, and all. Primary: critical delay, fit of the gain, old.
- Beside them age, area, mean velocity, mean frequency and the fitted noise. A small margin, and a
  large value of all else, is taken to mean a fall. AUC with the interval of DeLong, DeLong &
  Clarke-Pearson (Biometrics 44 (1988) 837). All are reported, and none is corrected for the others.
- Who has a frequency that no value of the fitted number gives is put at the end of the range, and
  counted.

Added when pasma-2017 was found to give no frequency as low as people's at any gain, and before any
AUC was computed: the same with dec-2015, whose frequency as published is that of the young. Its
critical delay, fit of the gain, old, takes the place of the primary one; all stays reported.
"""

from collections.abc import Mapping

import numpy as np

import standfast as sf
from sway_model import deviation, mean_frequency, person_of, recordings

LAWS = ("pasma-2017", "dec-2015")
RATE = 50.0  # Hz: the low-pass leaves 2 % of the amplitude at half of it
SEED = 15
G = 9.81
HEIGHTS = (1.40, 1.65, 1.95)
FITS = ("gain", "stiffness")
MARGINS = ("safety factor", "critical delay", "delay margin")
# of an ellipse of 95 %: area / (π √det S), many samples
ELLIPSE = -2.0 * np.log(0.05) * np.pi


def margins(people: Mapping[str, np.ndarray]) -> tuple[dict[str, np.ndarray], dict[str, int]]:
    """Return all predictors, the larger the more a fall is expected, and who was out of range."""
    found = {
        "age": people["age"],
        "area": people["area"],
        "mean velocity": people["velocity"],
        "mean frequency": people["frequency"],
    }
    out = {}
    spread = np.sqrt(people["area"] / ELLIPSE)
    for law in LAWS:
        for fit in FITS:
            table = _Table(law, fit)
            size, inside = table.size_of(people["height"], people["frequency"])
            out[f"{law}, {fit}"] = int((~inside).sum())
            delays = np.array([
                sf.critical_delay(**person(law, h, m, fit, k))
                for h, m, k in zip(people["height"], people["mass"], size, strict=True)
            ])  # fmt: skip
            delays = delays.round(9)  # equal persons are equal
            found[f"safety factor, {law}, {fit}"] = -(size + table.other)
            found[f"critical delay, {law}, {fit}"] = -delays
            found[f"delay margin, {law}, {fit}"] = -(delays - sf.LAWS[law].delay).round(9)
            if (law, fit) == (LAWS[-1], FITS[0]):
                load = people["mass"] * people["height"]
                found["noise"] = load * spread / table.spread_of(people["height"], size)
    return found, out


def person(name: str, height: float, mass: float, fit: str, size: float) -> dict[str, object]:
    """Return a person under the scaled law, ``size`` the fitted P or K over m g h."""
    law = sf.LAWS[name]
    body = sf.Body.from_height_mass(height, mass)
    scaled, load = law.on(body, G), law.scale(body, G) * law.load
    if fit == "gain":
        return {**scaled, "feedback": scaled["feedback"]._replace(proportional=(size * load, 0, 0))}
    return {**scaled, "stiffness": scaled["stiffness"]._replace(ankle=size * load)}


class _Table:
    """Mean frequency and SD over height and the fitted number, from recordings of one seed."""

    def __init__(self, name: str, fit: str) -> None:
        law = sf.LAWS[name]
        self.other = (law.stiffness.ankle if fit == "gain" else law.feedback[0][0, 0]) / law.load
        # from just above what stands without delay to past where the delay ends it
        sizes = 1.0 + np.geomspace(0.01, 4.0, 60) - self.other
        self.rows = []
        for height in HEIGHTS:
            kept, frequency, spread = [], [], []
            for size in sizes:
                if size < 0.0:
                    continue
                given = person(name, height, 70.0, fit, float(size))
                if not sf.is_stable(**given):
                    continue
                drawn = recordings(person_of(**given), np.ones(1), rate=RATE, seed=SEED)["control"]
                kept.append(size)
                frequency.append(np.median(mean_frequency(drawn, RATE)))
                spread.append(np.median(deviation(drawn)) * 70.0 * height)
            # right at the limit chance decides which of the slowest is slowest
            slowest = int(np.argmin(frequency))
            self.rows.append(tuple(np.array(x[slowest:]) for x in (kept, frequency, spread)))

    def size_of(self, height: np.ndarray, frequency: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the number that gives people's frequencies, and whether there is one."""
        each = [_rising(f, kept, frequency) for kept, f, _ in self.rows]
        low, high = ([row[1][end] for row in self.rows] for end in (0, -1))
        inside = (frequency >= np.interp(height, HEIGHTS, low)) & (
            frequency <= np.interp(height, HEIGHTS, high)
        )
        return self._between(height, each), inside

    def spread_of(self, height: np.ndarray, size: np.ndarray) -> np.ndarray:
        """Return the SD that noise of 1 N·m·√s makes, times mass and height."""
        return self._between(height, [np.interp(size, k, s) for k, _, s in self.rows])

    @staticmethod
    def _between(height: np.ndarray, each: list[np.ndarray]) -> np.ndarray:
        columns = zip(height, np.array(each).T, strict=True)
        return np.array([np.interp(h, HEIGHTS, column) for h, column in columns])


def _rising(x: np.ndarray, y: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Interpolate where x must rise with y; if it does not there is more than one answer."""
    if not (np.diff(x) > 0.0).all():
        raise ArithmeticError("mean frequency does not rise with the fitted number")
    return np.interp(at, x, y)


def auc(predictor: np.ndarray, fell: np.ndarray) -> tuple[float, float, float]:
    """Return the area under the ROC curve with DeLong's 95 % interval."""
    more = predictor[fell][:, None] - predictor[~fell]
    wins = (more > 0.0) + 0.5 * (more == 0.0)
    area = wins.mean()
    error = np.sqrt(
        wins.mean(axis=1).var(ddof=1) / fell.sum() + wins.mean(axis=0).var(ddof=1) / (~fell).sum()
    )
    return float(area), float(area - 1.96 * error), float(area + 1.96 * error)
