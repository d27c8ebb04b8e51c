"""What a fit of sway found."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple


class Estimate(NamedTuple):
    """A number with its 95 % interval.

    Attributes
    ----------
    value, low, high
    unit
    open : (bool, bool)
        whether the measures leave the lower and the upper end open: then it is only the limit of
        the search, or, of the proportional gain, of standing.
    """

    value: float
    low: float
    high: float
    unit: str
    open: tuple[bool, bool] = (False, False)


class Fitted(NamedTuple):
    """A measure of the recording beside the model's: the median, and the SD of its logarithm."""

    measured: float
    model: float
    spread: float
    unit: str


@dataclass(frozen=True, eq=False)
class SwayFit:
    """What :func:`standfast.fit_sway` found.

    Attributes
    ----------
    law : its name
    parameters : of what was open, :class:`~standfast.fitting.result.Estimate` by name
        ``noise`` (N·m·√s, σ at each noisy joint), ``proportional_gain`` (N·m/rad) and
        ``derivative_gain`` (N·m·s/rad) of the ankle, with which those of other joints go in the
        law's proportion, and ``feedback_delay`` (s).
    margins : ``critical_delay``, ``delay_margin`` (s), ``decay_rate`` (1/s), ``static_gain_margin``
        the last is by what all springs and proportional gains could be divided, and the person
        just stand statically; with delay the person may fall before. It is not the safety factor
        of a person's stiffness (:func:`standfast.safety_factor`).
    measures : :class:`~standfast.fitting.result.Fitted` by name
    p_value
        how often a recording of a person who follows the law is further off than this one: of χ²
        with as many degrees of freedom as there are more measures than numbers open. None without
        one: as many numbers can nearly always give as many measures, which tests nothing.
    explained
        whether ``p_value`` is 5 % or more. Without one, None where the measures are reached within
        their chance (Q ≤ 3.84), and False where no open number reaches them.
    status : what it comes to, in a few sentences
    person : all arguments of ``sf.is_stable`` and others of the fitted person
    noise : (3,), N·m·√s, for ``sf.sway_covariance(**fit.person, noise=fit.noise)``
    """

    law: str
    parameters: Mapping[str, Estimate]
    margins: Mapping[str, Estimate]
    measures: Mapping[str, Fitted]
    p_value: float | None
    explained: bool | None
    status: str
    person: Mapping[str, Any]
    noise: tuple[float, float, float]
