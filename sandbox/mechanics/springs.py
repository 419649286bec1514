"""The spring across each hinge: equations (20)-(30), arms, over-centre angle.

A straight spring on the back of the joint connects M''_(i-1) on phalanx i-1 to M'_i on phalanx i.
With M'' from C_i in the frame of phalanx i-1 (the paper leaves the frame of (21) open) and M' from
C_i in that of phalanx i,

    rm = |M'_i|                                                    (20)
    dm = |M''_(i-1) - C_i|                                         (21)
    rho_0   = atan2(y'', -x'')                                     (22)
    omega_0 = atan2(y', x')                                        (23)
    delta_0 = pi - rho_0 - omega_0                                 (24)
    delta   = delta_0 + theta                                      (28)
    lm      = sqrt(dm^2 + rm^2 - 2 dm rm cos delta)                (25), (29)
    rho     = acos((lm^2 + dm^2 - rm^2) / (2 lm dm)) at M''        (26)
    omega   = acos((lm^2 + rm^2 - dm^2) / (2 lm rm)) at M'         (27)
    elongation = lm - lm_0                                         (30)

The arm is hm = d(lm)/d(theta) = dm rm sin(delta) / lm: a stretched spring opens the joint while
hm > 0. At theta = rho_0 + omega_0 the spring passes over the hinge; beyond it closes the joint.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import finite, per_phalanx, points, positive
from sandbox.mechanics.tendon import corner, third_side
from sandbox.numeric import Array


def spring_length(dm: ArrayLike, rm: ArrayLike, delta: ArrayLike) -> Array:
    """Length lm [m] of a straight spring across the hinge, equations (25), (29), shape [...].

    ``delta`` [rad] between dm > 0 and rm > 0 [m] is delta_0 for (25), delta_0 + theta for (29).
    """
    before, after = positive("dm", dm, "m"), positive("rm", rm, "m")
    angle = finite("delta", delta, "rad")
    return positive("lm", third_side(before, after, angle), "m")


@dataclass(frozen=True)
class SpringSet:
    """The triangles of a finger's springs. Make it with :func:`spring_set`."""

    dm: Array  #: dm_i [m], shape [n], equation (21)
    rm: Array  #: rm_i [m], shape [n], equation (20)
    rho_0: Array  #: rho_(i)0 [rad], shape [n], equation (22)
    omega_0: Array  #: omega_(i)0 [rad], shape [n], equation (23)

    @property
    def over_centre(self) -> Array:
        """rho_0 + omega_0 [rad], shape [n]: the joint angle at which a spring has no arm."""
        return np.asarray(self.rho_0 + self.omega_0)

    def delta(self, theta: ArrayLike) -> Array:
        """delta_i [rad] at joint angles ``theta`` [rad], shape [..., n], equations (24), (28)."""
        turned = per_phalanx("theta", theta, len(self.dm), "rad")
        return np.asarray(np.pi - self.rho_0 - self.omega_0 + turned)

    def lengths(self, theta: ArrayLike) -> Array:
        """lm_i [m], shape [..., n], equation (29)."""
        return spring_length(self.dm, self.rm, self.delta(theta))

    def elongations(self, theta: ArrayLike) -> Array:
        """Elongations lm - lm_0 [m], shape [..., n], equation (30)."""
        return np.asarray(self.lengths(theta) - self.lengths(np.zeros(len(self.dm))))

    def arms(self, theta: ArrayLike) -> Array:
        """hm_i = d(lm_i)/d(theta_i) [m], shape [..., n]; negative beyond the over-centre angle."""
        return np.asarray(self.dm * self.rm * np.sin(self.delta(theta)) / self.lengths(theta))

    def attachment_angles(self, theta: ArrayLike) -> tuple[Array, Array]:
        """Angles rho at M'' and omega at M' [rad], > 0, shape [..., n], equations (26), (27)."""
        length = self.lengths(theta)
        return corner(length, self.dm, self.rm), corner(length, self.rm, self.dm)


def spring_set(before: ArrayLike, after: ArrayLike) -> SpringSet:
    """The triangles of a finger's springs, equations (20)-(23).

    Args:
        before: M''_(i-1) from C_i, in the frame of phalanx i-1 [m], shape [n, 2].
        after: M'_i from C_i, in the frame of phalanx i [m], shape [n, 2].
    """
    near = np.atleast_2d(points("before", before))
    far = points("after", np.atleast_2d(np.asarray(after, dtype=np.float64)), len(near))
    dm, rm = (positive(f"{name} distance to its hinge", np.linalg.norm(side, axis=-1), "m")
              for name, side in (("before", near), ("after", far)))
    return SpringSet(dm, rm, np.arctan2(near[:, 1], -near[:, 0]), np.arctan2(far[:, 1], far[:, 0]))
