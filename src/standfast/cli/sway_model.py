"""The model beside recordings, for ``standfast sway``: what a person in the model would show.

By the definitions of the recordings, of their length and rate; and how far the model is from
falling.
"""

import argparse
import math
from collections.abc import Iterable, Sequence
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, NamedTuple

from standfast.cli.person_options import (
    GivenPerson,
    add_person_options,
    law_in_words,
    names_a_person,
    person_given,
)
from standfast.cli.person_text import fed_back_in_words, person_in_words
from standfast.errors import InputError
from standfast.files import column_name
from standfast.numerics.arrays import TURN
from standfast.parameters import JOINTS, NOISES, PARAMETERS
from standfast.stability.sway.density import LOW_PASS

if TYPE_CHECKING:
    from standfast.recordings.expected import ExpectedSway
    from standfast.recordings.measures import SwayMeasures
    from standfast.recordings.recording import Recording

# What is shown of a recording beside a model, and not else.
RECORDED = ("mean_frequency_ap", "median_frequency_ap")


class ModelBeside(NamedTuple):
    """The person in the model, what follows from it, and what it shows beside each recording."""

    person: GivenPerson
    facts: dict[str, Any]  # with damping and feedback
    shown: "list[ExpectedSway]"
    recorded: list[dict[str, float]]  # of each recording, what MEASURES has not


def add_model_options(parser: argparse.ArgumentParser) -> None:
    """Declare who stands beside the recordings in the model."""
    group = parser.add_argument_group(
        "the model beside recordings, of the person who stands there",
        "as of standfast person: a body (--height and --mass, or segments), and a law, or "
        "stiffness, damping and feedback one by one. Without --noise it is so strong that the SD "
        "of the centre of pressure is that of the recording.",
    )
    words = "a study, whose fixed numbers are taken where no option gives another"
    group.add_argument("--study", dest="start", metavar="STUDY.toml", help=words)
    add_person_options(group)


def model_beside(
    options: argparse.Namespace, recordings: "Sequence[Recording]", low_pass: float | None
) -> ModelBeside | None:
    """Return the model beside recordings; None if no option asks for it.

    Raises
    ------
    InputError
        if the person is not whole, or has no sway that a recording could be like.
    """
    if options.start is None and not names_a_person(options):
        return None
    from standfast.quantities.person_facts import facts_with_feedback, nerves_of, person_of
    from standfast.recordings.expected import expected_sway
    from standfast.recordings.measures import cop_spectrum, mean_and_median

    given = person_given(options, options.start)
    person = person_of(given.parameters)
    damping, late = nerves_of(person)
    noisy = not given.parameters.keys().isdisjoint(NOISES)
    noise = [given.parameters.get(name, 0.0) for name in NOISES] if noisy else None
    shown, recorded = [], []
    for recording in recordings:
        try:
            shown.append(
                expected_sway(
                    recording,
                    person.body,
                    person.stiffness,
                    person.gravity,
                    damping=damping,
                    feedback=late,
                    noise=noise,
                    low_pass=low_pass,
                )
            )
        except InputError as error:
            raise InputError(f"the model beside {recording.name}: {error}") from None
        except ArithmeticError as error:
            raise InputError(f"the model is too near to falling to have a sway: {error}") from None
        spectrum = cop_spectrum(recording, low_pass=low_pass)
        mean, median = mean_and_median(spectrum.frequency, spectrum.ap)
        recorded.append(dict(zip(RECORDED, (mean, median), strict=True)))
    return ModelBeside(given, facts_with_feedback(person), shown, recorded)


def columns_beside(model: ModelBeside, found: "Sequence[SwayMeasures]") -> Iterable[dict[str, Any]]:
    """Yield for each recording its own measures and those of the model, by the title."""
    for measures, more, shown in zip(found, model.recorded, model.shown, strict=True):
        yield {"recording": SimpleNamespace(**measures._asdict(), **more), "model": shown}


def model_in_words(model: ModelBeside, low_pass: float | None) -> str:
    """Say who the model is, what is taken from the recording, and how far it is from falling."""
    given = model.person.parameters
    lines = [law_in_words(model.person), person_in_words(given)]
    lines.append(fed_back_in_words(given, {**model.facts, "stands_with_feedback": True}))
    strength = {max(shown.noise) for shown in model.shown}
    told = (
        f"{min(strength):.4g}"
        if len(strength) == 1
        else f"{min(strength):.4g} to {max(strength):.4g}"
    )
    if given.keys().isdisjoint(NOISES):
        free = [joint for joint in JOINTS if math.isfinite(given[f"{joint}_stiffness"])]
        lines.append(
            f"Its noise, {told} N·m·√s at {' and '.join(free)}, is not given, but that with which "
            "its SD of the\ncentre of pressure is the recording's. Velocity and frequencies are "
            "what it predicts."
        )
    lines.append(
        "–: the model is sagittal, so mediolateral motion, area and path have no value; nor has a "
        "range,\nfor which no formula is known. All else is of the recording's length and rate, "
        f"through a\nlow-pass at {LOW_PASS / TURN if low_pass is None else low_pass:g} Hz."
    )
    return "\n".join(line for line in lines if line)


def model_header() -> list[str]:
    """Return the names of the model's columns in a table of recordings."""
    from standfast.recordings.expected import MODELLED

    recorded = [column_name(n, MODELLED[n].printed) for n in RECORDED]
    shown = [column_name(f"model_{name}", row.printed) for name, row in MODELLED.items()]
    noises = [column_name(f"model_{name}", PARAMETERS[name].unit) for name in NOISES]
    return [*recorded, *shown, *noises, "model_critical_delay_s", "model_delay_margin_s"]


def model_row(model: ModelBeside, place: int) -> list[float]:
    """Return the numbers of a recording under :func:`model_header`; NaN where one is open."""
    from standfast.recordings.expected import MODELLED

    shown = model.shown[place]
    delays = (model.facts[name] for name in ("critical_delay", "delay_margin"))
    return [
        *model.recorded[place].values(),
        *(row.factor * getattr(shown, name) for name, row in MODELLED.items()),
        *shown.noise,
        *(math.nan if delay is None else delay for delay in delays),
    ]


def model_facts(model: ModelBeside, place: int) -> dict[str, Any]:
    """Return what JSON says of the model beside a recording, in SI."""
    from standfast.recordings.expected import MODELLED
    from standfast.study.canonical import json_value

    shown, law = model.shown[place], model.person.law
    noise: dict[str, Any] = dict(zip(NOISES, shown.noise, strict=True))
    facts = {
        "given": model.person.parameters,
        **({} if law is None else {"law": {"name": law.name, "scaled_by": model.person.factor}}),
        "noise": noise,
        "noise_from_recording": model.person.parameters.keys().isdisjoint(NOISES),
        "measures": {name: getattr(shown, name) for name in MODELLED},
        "recorded": model.recorded[place],
        **model.facts,
    }
    told: dict[str, Any] = json_value(facts)
    return told
