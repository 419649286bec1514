"""The elastic element across each hinge: equations (20)-(30), arms, over-centre angle.

A straight spring on the back of the joint runs from M''_(i-1), on phalanx i-1,
to M'_i, on phalanx i. With M'' taken from C_i in the frame of phalanx i-1 (the
paper leaves the frame of (21) open) and M' from C_i in that of phalanx i,

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

Printed otherwise: y_M for y_M' in (20), no sign of x in (22) (the wrong
quadrant: lengths up to 37 mm off), atan2 of a ratio in (22) and (23), rm
squared twice in (26), a mixed formula in (28).

Points (x, y) [m] have shape [..., 2], angles [rad] and lengths [m] the shape
[...] of their triangles, [..., n] where they belong to a whole finger.

The arm is hm = d(lm)/d(theta) = dm rm sin(delta) / lm: a stretched spring opens
the joint while hm > 0. At theta = rho_0 + omega_0 the spring passes over the
hinge, loses its arm, and beyond that closes the joint: it snaps through.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import finite, per_phalanx, points, positive, together
from sandbox.mechanics.triangle import corner, third_side
from sandbox.numeric import Array


def attachment_radius(after: ArrayLike) -> Array:
    """rm_i = |M'_i| [m], equation (20).

    Args:
        after: M'_i from C_i, in the frame of phalanx i [m], shape [..., 2].

    Raises:
        ValueError: an attachment on the hinge, where the spring has no arm.
    """
    return positive("after distance to its hinge",
                    np.linalg.norm(points("after", after), axis=-1), "m")


def attachment_distance(before: ArrayLike) -> Array:
    """dm_i = |M''_(i-1) - C_i| [m], equation (21).

    Args:
        before: M''_(i-1) from C_i, in the frame of phalanx i-1 [m], shape [..., 2].

    Raises:
        ValueError: an attachment on the hinge.
    """
    return positive("before distance to its hinge",
                    np.linalg.norm(points("before", before), axis=-1), "m")


def hinge_angle_before(before: ArrayLike) -> Array:
    """rho_0 [rad] at the hinge, equation (22); argument as in :func:`attachment_distance`.

    Printed as atan2(y / x), in the wrong quadrant for the usual x < 0.
    """
    at = points("before", before)
    return np.asarray(np.arctan2(at[..., 1], -at[..., 0]))


def hinge_angle_after(after: ArrayLike) -> Array:
    """omega_0 [rad] at the hinge, equation (23); argument as in :func:`attachment_radius`.

    Printed as atan2 of a ratio.
    """
    at = points("after", after)
    return np.asarray(np.arctan2(at[..., 1], at[..., 0]))


def angle_at_zero(rho_0: ArrayLike, omega_0: ArrayLike) -> Array:
    """delta_0 = pi - rho_0 - omega_0 [rad] between the two sides at theta = 0, equation (24).

    Args:
        rho_0: of :func:`hinge_angle_before` [rad], shape [...].
        omega_0: of :func:`hinge_angle_after` [rad], shape [...].

    Raises:
        ValueError: arrays of unequal length, a value that is not finite.
    """
    rho, omega = finite("rho_0", rho_0, "rad"), finite("omega_0", omega_0, "rad")
    together(rho_0=rho, omega_0=omega)
    return np.asarray(np.pi - rho - omega)


def spring_length(dm: ArrayLike, rm: ArrayLike, delta: ArrayLike) -> Array:
    """Length lm [m] of a straight spring across the hinge, equations (25), (29), shape [...].

    Args:
        dm: dm_i [m], shape [...].
        rm: rm_i [m], shape [...].
        delta: between them [rad], delta_0 for (25), delta_0 + theta for (29), shape [...].

    Raises:
        ValueError: a side that is not above 0 m, arrays of unequal length; a
            spring whose ends coincide (lm = 0 m).
    """
    before, after = positive("dm", dm, "m"), positive("rm", rm, "m")
    angle = finite("delta", delta, "rad")
    together(dm=before, rm=after, delta=angle)
    return positive("lm", third_side(before, after, angle), "m")


def spring_arm(dm: ArrayLike, rm: ArrayLike, delta: ArrayLike) -> Array:
    """Arm hm = d(lm)/d(theta) = dm rm sin(delta) / lm [m], from (29), shape [...].

    Arguments and errors as in :func:`spring_length`.
    """
    length = spring_length(dm, rm, delta)
    return np.asarray(np.asarray(dm) * np.asarray(rm) * np.sin(np.asarray(delta)) / length)


def end_forces(near: ArrayLike, far: ArrayLike, pull: ArrayLike) -> tuple[Array, Array]:
    """Forces of a straight spring on its two ends [N], shape [..., 2] each: loads for (33).

    Args:
        near: its end M'' [m], shape [..., 2].
        far: its end M', in the same frame [m], shape [..., 2].
        pull: k (lm - rest) [N], positive where it pulls its ends together, shape [...].

    Raises:
        ValueError: ends that coincide, arrays of unequal length.
    """
    here, there, force = points("near", near), points("far", far), finite("pull", pull, "N")
    together(near=here[..., 0], far=there[..., 0], pull=force)
    along = there - here
    length = positive("lm", np.linalg.norm(along, axis=-1), "m")
    on_near = (force / length)[..., None] * along
    return np.asarray(on_near), np.asarray(-on_near)


@dataclass(frozen=True)
class SpringSet:
    """A finger's springs: the constant sides of n triangles. Make it with :func:`spring_set`."""

    dm: Array
    """dm_i [m], shape [n], equation (21)."""
    rm: Array
    """rm_i [m], shape [n], equation (20)."""
    rho_0: Array
    """rho_(i)0 [rad], shape [n], equation (22)."""
    omega_0: Array
    """omega_(i)0 [rad], shape [n], equation (23)."""

    @property
    def over_centre(self) -> Array:
        """rho_0 + omega_0 [rad], shape [n]: the joint angle at which a spring loses its arm."""
        return np.asarray(self.rho_0 + self.omega_0)

    def delta(self, theta: ArrayLike) -> Array:
        """delta_i [rad] at joint angles ``theta`` [rad], shape [..., n], equations (24), (28).

        Raises:
            ValueError: another number of angles.
        """
        turned = per_phalanx("theta", theta, len(self.dm), "rad")
        return angle_at_zero(self.rho_0, self.omega_0) + turned

    def lengths(self, theta: ArrayLike) -> Array:
        """lm_i [m], shape [..., n], equation (29).

        Raises:
            ValueError: a spring whose ends coincide (lm = 0 m).
        """
        return spring_length(self.dm, self.rm, self.delta(theta))

    def elongations(self, theta: ArrayLike) -> Array:
        """Elongations lm - lm_0 [m], shape [..., n], equation (30)."""
        return np.asarray(self.lengths(theta) - self.lengths(np.zeros(len(self.dm))))

    def arms(self, theta: ArrayLike) -> Array:
        """hm_i = d(lm_i)/d(theta_i) [m], shape [..., n]; negative beyond the over-centre angle."""
        return spring_arm(self.dm, self.rm, self.delta(theta))

    def attachment_angles(self, theta: ArrayLike) -> tuple[Array, Array]:
        """Angles rho at M'' and omega at M' [rad], shape [..., n] each, equations (26), (27).

        Of the triangle, so positive on both sides of the over-centre angle.
        """
        length = self.lengths(theta)
        return corner(length, self.dm, self.rm), corner(length, self.rm, self.dm)


def spring_set(before: ArrayLike, after: ArrayLike) -> SpringSet:
    """The triangles of a finger's springs, equations (20)-(23).

    Args:
        before: M''_(i-1) from C_i, in the frame of phalanx i-1 [m], shape [n, 2].
        after: M'_i from C_i, in the frame of phalanx i [m], shape [n, 2].

    Raises:
        ValueError: unequal numbers of points, a point on its hinge.
    """
    near = np.atleast_2d(points("before", before))
    far = points("after", np.atleast_2d(np.asarray(after, dtype=np.float64)), len(near))
    return SpringSet(attachment_distance(near), attachment_radius(far),
                     hinge_angle_before(near), hinge_angle_after(far))
