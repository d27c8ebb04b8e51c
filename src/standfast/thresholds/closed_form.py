"""The limit of standing in closed form: one falling curve on every plane of ankle × hip."""

import numpy as np

from standfast.stability.springs import critical_ankle_stiffness, critical_hip_stiffness
from standfast.study.study import Study
from standfast.thresholds.planes import PLANE_AXES, Plane, finite


def critical_hips(plane: Plane, ankles: np.ndarray) -> np.ndarray:
    """Return the hip stiffness at which the person just stands, for each ankle stiffness."""
    hips: np.ndarray = critical_hip_stiffness(plane.body, ankles, plane.knee, plane.gravity)
    return hips


def critical_ankles(plane: Plane, hips: np.ndarray) -> np.ndarray:
    """Return the ankle stiffness at which the person just stands, for each hip stiffness."""
    ankles: np.ndarray = critical_ankle_stiffness(plane.body, plane.knee, hips, plane.gravity)
    return ankles


def limit_of_standing(study: Study, plane: Plane) -> tuple[np.ndarray, np.ndarray]:
    """Return the exact limit of standing within the plane: ankle and hip stiffness (N·m/rad).

    The curve is taken at every value of both axes, so that both of its steep ends are followed.
    """
    ankles, hips = (finite(study.axes[name]) for name in PLANE_AXES)
    ankle = np.concatenate([critical_ankles(plane, hips), ankles])
    hip = np.concatenate([hips, critical_hips(plane, ankles)])
    inside = (ankle >= ankles[0]) & (ankle <= ankles[-1]) & (hip >= hips[0]) & (hip <= hips[-1])
    order = np.lexsort((-hip[inside], ankle[inside]))
    return ankle[inside][order], hip[inside][order]
