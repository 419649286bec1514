"""Points of a finger by complex numbers: an independent way to the same geometry."""

from __future__ import annotations

import numpy as np

from tests.support.reference import FingerSet


def frames(lengths: tuple, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Origins and directions of palm and phalanges as complex numbers, shapes [..., n+1].

    Index 0 is the palm, whose origin is the first hinge. No matrices: an
    independent way to the same points.
    """
    theta = np.asarray(theta)
    zero = np.zeros((*theta.shape[:-1], 1))
    direction = np.exp(-1j * np.cumsum(np.concatenate([zero, theta], axis=-1), axis=-1))
    steps = direction[..., 1:-1] * np.asarray(lengths[:-1])
    origin = np.concatenate([zero, zero, np.cumsum(steps, axis=-1)], axis=-1)
    return origin, direction


def straight_lines(
    finger: FingerSet, theta: np.ndarray, before: tuple, after: tuple, *, own_frame: bool,
) -> np.ndarray:
    """Distances [..., n] from points of phalanx i-1 to points of phalanx i in the world.

    ``own_frame``: the points before are given in the frame of phalanx i-1;
    otherwise from hinge i.
    """
    origin, direction = frames(finger.lengths, theta)
    near, far = (np.array(p) @ [1, 1j] for p in (before, after))
    if not own_frame:
        near = near + np.array([0.0, *finger.lengths[:-1]])
    a = origin[..., :-1] + direction[..., :-1] * near
    b = origin[..., 1:] + direction[..., 1:] * far
    return np.abs(b - a)
