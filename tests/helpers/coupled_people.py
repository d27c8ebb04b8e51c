"""Random persons with coupled joints, and their matrices put together apart from the package."""

import math

import numpy as np

import standfast as sf
from people import random_body, random_gravity
from standfast.parameters import COUPLED_JOINTS, JOINTS


def random_coupled(rng, *, rigid_share=0.2, couplings=1.0):
    """Joints log-uniform from 100 to 10⁴ or rigid, coupled by up to 0.9 of their geometric mean."""
    joints = 10.0 ** rng.uniform(2.0, 4.0, 3)
    share = couplings * rng.uniform(-0.9, 0.9, 3) * (rng.random(3) < 0.8)
    pairs = [(JOINTS.index(one), JOINTS.index(other)) for one, other in COUPLED_JOINTS]
    between = [x * math.sqrt(joints[i] * joints[j]) for x, (i, j) in zip(share, pairs, strict=True)]
    joints[rng.random(3) < rigid_share] = math.inf
    return sf.Stiffness(*joints, *between)


def plain_matrices(body, stiffness, gravity):
    """K, G and A of the joints that are not rigid; K is put together here."""
    ankle, knee, hip, ak, kh, ah = stiffness
    k = np.array([[ankle, ak, ah], [ak, knee, kh], [ah, kh, hip]])
    free = np.flatnonzero(np.isfinite(stiffness.joints))
    keep = np.ix_(free, free)
    load = -sf.stiffness_matrix(body, sf.Stiffness(0.0, 0.0, 0.0), gravity)
    return k[keep], load[keep], sf.inertia_matrix(body)[keep], free


def cases(seed, count, **how):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        yield random_body(rng), random_coupled(rng, **how), random_gravity(rng)


def largest(k, load):
    return np.abs(k).sum() + np.abs(load).sum()
