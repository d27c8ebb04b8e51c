"""Random bodies and stiffnesses for the tests, always from a seeded generator."""

import math

import numpy as np

import standfast as sf


def random_body(rng: np.random.Generator, model: str | None = None) -> sf.Body:
    """A body of any of the four models, from a small teenager to a tall, heavy adult."""
    model = model or sf.BODY_MODELS[rng.integers(len(sf.BODY_MODELS))]
    return sf.Body.from_height_mass(rng.uniform(1.3, 2.1), rng.uniform(35.0, 160.0), model)


def random_gravity(rng: np.random.Generator) -> float:
    return rng.uniform(1.6, 15.0)


def random_stiffness(rng: np.random.Generator, *, rigid_share: float = 0.0) -> sf.Stiffness:
    """Each joint log-uniform from 10 to 10⁴ N·m/rad, or rigid with the given probability."""
    values = 10.0 ** rng.uniform(1.0, 4.0, 3)
    values[rng.random(3) < rigid_share] = math.inf
    return sf.Stiffness(*values)


def batch(cases: list[tuple[sf.Body, sf.Stiffness, float]]) -> tuple[np.ndarray, ...]:
    """Stack cases leaf by leaf: the body's four arrays, three stiffnesses, gravity."""
    bodies, stiffnesses, gravities = zip(*cases, strict=True)
    return (
        *(np.stack(leaves) for leaves in zip(*bodies, strict=True)),
        *(np.array(joint) for joint in zip(*(one.joints for one in stiffnesses), strict=True)),
        np.array(gravities),
    )


def person_of(*leaves):
    """Take one case of a batch apart again, inside or outside of a trace."""
    *body, ankle, knee, hip, gravity = leaves
    return sf.Body._make(body), sf.Stiffness(ankle, knee, hip), gravity
