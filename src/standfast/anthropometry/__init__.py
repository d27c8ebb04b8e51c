"""The person's body: mass and geometry, measured or scaled from published tables."""

from standfast.anthropometry.body import (
    BODY_SOURCES,
    REFERENCE_PEOPLE,
    Body,
    ReferencePerson,
    body_of,
    rescaled,
)

__all__ = [
    "BODY_SOURCES",
    "REFERENCE_PEOPLE",
    "Body",
    "ReferencePerson",
    "body_of",
    "rescaled",
]
