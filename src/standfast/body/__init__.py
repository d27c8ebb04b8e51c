"""The person: mass, geometry and stiffness, from published tables or measured."""

from standfast.body.person import (
    BODY_MODELS,
    REFERENCE_PEOPLE,
    Body,
    Stiffness,
    checked_person,
    checked_scalar,
    rescaled,
)

__all__ = [
    "BODY_MODELS",
    "REFERENCE_PEOPLE",
    "Body",
    "Stiffness",
    "checked_person",
    "checked_scalar",
    "rescaled",
]
