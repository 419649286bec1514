"""The pose of a finger that embraces a fixed disc with all its phalanges, in closed form.

A capsule phalanx of radius rho_i touches a disc of radius r where the disc's centre is r + rho_i
from its axis, on the palm side. In the frame of phalanx i the centre is at (k_i, -(r + rho_i)), k_i
the distance of the contact from the near hinge. With the distance D from the next hinge to the
centre,

    k_(i+1) = sqrt(D^2 - (r + rho_(i+1))^2)
    theta_(i+1) = atan2(r + rho_i, k_i - L_i) - atan2(r + rho_(i+1), k_(i+1))
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.chain import hinges, to_world, transforms
from sandbox.mechanics.checks import per_phalanx, points, positive
from sandbox.numeric import Array


class DiscGrasp(NamedTuple):
    """A finger round a disc; n phalanges, from the palm out."""

    theta: Array  #: joint angles [rad], closing positive, shape [n]
    distances: Array  #: k_i of the contacts from the near hinges, along the phalanges [m], [n]
    contacts: Array  #: points of contact in the world [m], shape [n, 2]
    normals: Array  #: directions of the forces on the phalanges, unit, shape [n, 2]
    hinges: Array  #: of the phalanges in the world [m], shape [n, 2]


def disc_centre(theta_1: float, distance: float, disc_radius: float, radius: float) -> Array:
    """Centre [m], shape [2], of the disc of r [m] that the first phalanx touches.

    The phalanx of ``radius`` rho_1 [m] is at ``theta_1`` [rad], its hinge at the origin, the
    contact at the ``distance`` k_1 [m].
    """
    apart = positive("disc_radius", disc_radius, "m") + positive("radius", radius, "m")
    along = positive("distance", distance, "m")
    c, s = np.cos(theta_1), np.sin(theta_1)
    return np.asarray(along * np.array([c, -s]) - apart * np.array([s, c]))


def disc_grasp(
    centre: ArrayLike, disc_radius: float, lengths: ArrayLike, radii: ArrayLike,
) -> DiscGrasp:
    """The pose in which every phalanx touches a fixed disc, without friction.

    The straight finger lies along +x from its first hinge at the origin, palm side at negative y.

    Args:
        centre: of the disc [m], shape [2].
        disc_radius: r [m], > 0.
        lengths: L_i, hinge to hinge [m], > 0, shape [n].
        radii: rho_i of the capsules [m], > 0, shape [n].

    Raises:
        ValueError: a disc over a hinge; a contact beyond its phalanx's ends.
    """
    phalanges = np.atleast_1d(positive("lengths", lengths, "m"))
    n = len(phalanges)
    apart = positive("disc_radius", disc_radius, "m") + positive(
        "radii", per_phalanx("radii", radii, n, "m"), "m")
    at = points("centre", centre)
    theta, along = np.zeros(n), np.zeros(n)
    for i in range(n):
        distance = float(np.hypot(*at))
        if distance <= apart[i]:
            raise ValueError(
                f"centre must be more than {apart[i]:.6g} m from hinge {i + 1}, "
                f"got {distance:.6g} m: the disc lies over it")
        along[i] = np.sqrt((distance - apart[i]) * (distance + apart[i]))
        theta[i] = np.arctan2(-at[1], at[0]) - np.arctan2(apart[i], along[i])
        if along[i] > phalanges[i]:
            raise ValueError(
                f"centre must let phalanx {i + 1} touch within its length of "
                f"{phalanges[i]:.6g} m, got a contact at {along[i]:.6g} m")
        at = np.array([along[i] - phalanges[i], -apart[i]])
    frames = transforms(theta, phalanges)
    surface = np.stack([along, -np.asarray(radii, dtype=np.float64)], axis=-1)
    return DiscGrasp(theta, along, to_world(frames, surface), frames[:, :2, 1], hinges(frames))
