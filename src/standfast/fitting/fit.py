"""Which noise and gains of a law explain a person's sway, and how far from falling that person is.

1. The measures of the sagittal sway of a recording, or of a table: SD, mean velocity and mean
   frequency of the centre of pressure, and optionally other SDs (:mod:`.measured`).
2. A law, on the person's body, has noise and gains open (:mod:`.family`). Of each point the spectra
   are known, and so expectation and covariance of the measures in recordings of this length
   (:mod:`.moments`, :mod:`.likelihood`).
3. The most likely point (:mod:`.search`), and the weights of all persons (:mod:`.ridge`,
   :mod:`.posterior`): the estimates, and intervals of parameters and of margins.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy import stats

from standfast.anthropometry.body import Body
from standfast.errors import InputError, nearest_name, says_its_arguments, shortened
from standfast.fitting.family import (
    DELAY,
    MARGINS,
    NOISE,
    OPEN,
    UNITS,
    Family,
    Points,
    noisy_joints,
    points_of,
)
from standfast.fitting.likelihood import Likelihood
from standfast.fitting.measured import POSSIBLE, Measured, checked_measures, may_be
from standfast.fitting.moments import FREQUENCY
from standfast.fitting.posterior import CONFIDENCE, Posterior, near_limits
from standfast.fitting.result import Estimate, Fitted, SwayFit
from standfast.fitting.ridge import posterior_of
from standfast.fitting.search import coarse_grid, minima_of
from standfast.fitting.words import NAMES, status_of
from standfast.mechanics.feedback import Feedback
from standfast.mechanics.joints import checked_body
from standfast.mechanics.law import Law
from standfast.mechanics.laws import LAWS
from standfast.parameters import JOINTS, PARAMETERS, STANDARD_GRAVITY, checked_number

LEAST_P = 1.0 - CONFIDENCE  # below it the law does not explain the measures
REACHED = float(stats.chi2.ppf(CONFIDENCE, 1))  # of Q: the measures are reached within their chance


@says_its_arguments()
def fit_sway(
    measured: Any,
    law: str | Law,
    body: Body,
    gravity: float = STANDARD_GRAVITY,
    *,
    free: Sequence[str] = OPEN,
    delay: float | None = None,
    noisy: Sequence[str] = JOINTS,
    low_pass: float | None = None,
    duration: float | None = None,
    rate: float | None = None,
) -> SwayFit:
    """Return which noise and gains of a law explain a person's sway, with 95 % intervals.

    Expectation and covariance of the measures in recordings of this length follow from the model's
    spectra. An interval holds 95 % of all persons by their likelihood, all proportional gains above
    the least that holds a person up being taken as equally likely, and all logarithms of the rest.
    As many measures are needed as numbers are open; a recording has three.

    Parameters
    ----------
    measured
        a Recording; or numbers in SI by name: ``sd_ap`` (m), ``mean_velocity_ap`` (m/s) and
        ``mean_frequency_ap`` (Hz) of the centre of pressure, ``sd_com`` (m), ``sd_ankle``,
        ``sd_knee``, ``sd_hip`` (rad).
    law
        a name (``standfast laws`` lists them) or a Law. Its stiffness, damping and gains are scaled
        by m g h from its body to ``body``.
    body
        of whoever was measured.
    free
        what is fitted, of ``noise``, ``proportional_gain``, ``derivative_gain``,
        ``feedback_delay``; all else is the law's, the noise 1 N·m·√s.
    delay : s
        instead of the law's.
    noisy
        the joints with noise, all of one strength.
    low_pass : Hz
        a recording is put through it, as by :func:`sway_measures`, and numbers are of samples
        behind it; left out, samples are as a plate with a low-pass at 10 Hz has them.
    duration, rate : s, Hz
        of the recording that numbers are of; 60 and 100 if left out.

    Raises
    ------
    InputError
        if anything is out of range, measures are fewer than open numbers, or nobody stands so.

    Examples
    --------
    >>> import standfast as sf
    >>> fit = sf.fit_sway({"sd_ap": 0.0045}, "dec-2015", sf.Body.edwards2007(), free=["noise"])
    >>> round(fit.parameters["noise"].value, 2)
    0.63
    """
    family = _checked_family(law, body, gravity, free, delay, noisy)
    given = checked_measures(measured, duration, rate, low_pass, family.law.joints)
    _check_they_tell(family, given)
    return result_of(Likelihood(points_of(family), given.target), given)


def _check_they_tell(family: Family, given: Measured) -> None:
    """Refuse measures that do not depend on the noise, or are fewer than the open numbers.

    Of fewer any interval would be made of chance alone.
    """
    if NOISE in family.free and [*given.values] == [FREQUENCY]:
        raise InputError(
            f"{FREQUENCY} alone does not depend on the noise; give an SD or the velocity too, or "
            "leave noise out of free"
        )
    needed, count = len(family.free), len(given.values)
    if needed <= count:
        return
    joints = family.law.joints
    others = [name for name in POSSIBLE if name not in given.values and may_be(name, joints)]
    one = len(joints) == 1 and {"sd_com", "sd_ankle"} & set(given.values)
    others = [name for name in others if not (one and name in ("sd_com", "sd_ankle"))]
    raise InputError(
        f"free: {', '.join(family.free)} {'is' if needed == 1 else 'are'} {needed} open numbers, "
        f"which need {needed} measures or more, and {count} "
        f"{'is' if count == 1 else 'are'} given; give measures by name, of {', '.join(others)} "
        "too, or leave something out of free"
    )


def result_of(likelihood: Likelihood, given: Measured) -> SwayFit:
    """Return the fit of measures whose likelihood is known.

    Raises
    ------
    InputError
        if nobody stands.
    """
    points, names = likelihood.points, likelihood.target.measures
    family = points.family
    coarse = coarse_grid(likelihood)
    minima = minima_of(likelihood, coarse)
    if not minima:
        raise InputError(_nobody_stands(family))
    posterior, best = posterior_of(likelihood, coarse, minima)
    found = likelihood.moments(best)
    if found is None:
        raise ArithmeticError("the most likely person does not stand")
    parameters, margins = _estimates(points, posterior, best)
    spread = np.sqrt(np.diagonal(found.covariance))
    measures = {
        name: Fitted(given.values[name], float(np.exp(mean)), float(each), POSSIBLE[name][2])
        for name, mean, each in zip(names, found.mean, spread, strict=True)
    }
    p_value, explained = _tested(likelihood.misfit(best), len(measures) - len(family.free))
    sigma = points.factors(best)[NOISE]
    ankle, knee, hip = (sigma * float(one) for one in family.noisy)
    return SwayFit(
        law=family.law.name,
        parameters=parameters,
        margins=margins,
        measures=measures,
        p_value=p_value,
        explained=explained,
        status=status_of(family.law.name, parameters, measures, explained),
        person=_person(points, best),
        noise=(ankle, knee, hip),
    )


def _nobody_stands(family: Family) -> str:
    varied = " and ".join(NAMES[name] for name in family.free if name != NOISE)
    how = f"whatever the {varied}" if varied else "with the law's own gains and this delay"
    late = "" if DELAY in family.free else f" (delay {family.delay:g} s)"
    return f"nobody stands by {family.law.name} on this body{late}, {how}"


def _tested(misfit: float, left: int) -> tuple[float | None, bool | None]:
    """Return p and whether the law explains the measures, with ``left`` degrees of freedom.

    Without any, only measures that no open number reaches speak against the law.
    """
    if left > 0:
        p_value = float(stats.chi2.sf(misfit, left))
        return p_value, p_value >= LEAST_P
    return None, None if misfit <= REACHED else False


def _checked_family(
    law: Any, body: Body, gravity: Any, free: Any, delay: Any, noisy: Any
) -> Family:
    if not isinstance(law, Law):
        if not isinstance(law, str):
            raise InputError(f"law = {shortened(law)} is not the name of a law, or a Law")
        law = LAWS[law]
    checked_body(body)
    gravity = checked_number("gravity", gravity, row=PARAMETERS["gravity"])
    row = PARAMETERS["feedback_delay"]
    late = law.delay if delay is None else checked_number("delay", delay, row=row)
    known = (*OPEN, DELAY)
    for what, given, names in (("free", free, known), ("noisy", noisy, JOINTS)):
        if isinstance(given, str) or not isinstance(given, Sequence) or not given:
            raise InputError(f"{what} = {shortened(given)}; give some of {', '.join(names)}")
        for name in given:
            if name not in names:
                near = nearest_name(name, names)
                raise InputError(f"{what}: {shortened(name)} is none of {', '.join(names)}{near}")
    if not set(noisy) & set(law.joints):
        raise InputError(f"noisy: {law.name} holds the {' and '.join(noisy)} rigid")
    if delay is not None and DELAY in free:
        raise InputError(f"delay = {late:g} s is given, and feedback_delay is to be found")
    ordered = tuple(name for name in known if name in free)
    return Family(law, body, gravity, late, noisy_joints(tuple(noisy)), ordered)


def _estimates(
    points: Points, posterior: Posterior, best: np.ndarray
) -> tuple[dict[str, Estimate], dict[str, Estimate]]:
    """Return parameters and margins with their intervals."""
    free = points.family.free
    names = [name for name in free if name != NOISE]

    def numbers(coordinates: np.ndarray) -> np.ndarray:
        whole = coordinates
        if NOISE in free:
            whole = np.insert(coordinates, free.index(NOISE), 0.0, axis=1)
        values = [[points.values(point)[name] for name in names] for point in whole]
        margins = points.margins(whole)
        return np.column_stack([np.reshape(values, (len(whole), -1)), *margins.values()])

    intervals, open_ends = posterior.intervals(numbers, len(names) + len(MARGINS))
    ends = dict(zip((*names, *MARGINS), intervals, strict=True))
    reach = dict(zip((*names, *MARGINS), open_ends, strict=True))
    if NOISE in free:
        of_noise, reach[NOISE] = posterior.noise_interval()
        ends[NOISE] = np.exp(of_noise)
    # who is most likely at a limit may be beyond it, however little of the weight is there
    for name, at_limit in zip(free, near_limits(best, *points.bounds).T, strict=True):
        reach[name] = np.logical_or(reach[name], at_limit)
    values = points.values(best)
    margins = {name: float(each[0]) for name, each in points.margins(best[None]).items()}

    def of(name: str, value: float) -> Estimate:
        low, high = (float(end) for end in ends[name])
        below, above = (bool(way) for way in reach[name])
        return Estimate(value, min(low, value), max(high, value), UNITS[name], (below, above))

    return (
        {name: of(name, values[name]) for name in free},
        {name: of(name, margins[name]) for name in MARGINS},
    )


def _person(points: Points, best: np.ndarray) -> dict[str, Any]:
    """Return the arguments of a public function of the fitted person."""
    numbers, delay = points.at(best)
    feedback = Feedback(numbers[3, ..., 0], numbers[4, ..., 0], delay)
    return {**points.family.person, "feedback": feedback}
