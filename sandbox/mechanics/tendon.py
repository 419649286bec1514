"""The tendon across each hinge: equations (8)-(19), arms, tensions past a rough guide.

Between phalanx i-1 and phalanx i the tendon runs straight from guide V_(i-1)
to guide V_i. With the hinge C_i these make a triangle whose two sides at C_i
never change:

    rt_i     = |V_i|,  V_i from C_i in the frame of phalanx i           (8)
    dt_(i-1) = |C_i - V_(i-1)|, in the frame of phalanx i-1             (9)

The angle beta_i between them closes as the finger closes. At theta_i = 0, with
alpha_h and gamma_h the angles *at the hinge* between the hinge line and either
side,

    alpha_h = atan2(y_C - y_V(i-1), x_C - x_V(i-1))                     (10)
    gamma_h = atan2(-y_Vi, x_Vi)                                        (11)
    beta_0  = pi - alpha_h - gamma_h                                    (12)
    beta    = beta_0 - theta                                            (16)
    lt      = sqrt(dt^2 + rt^2 - 2 dt rt cos beta)                      (13), (17)

and the angles *at the guides*, between the segment and either side, are

    alpha_v = acos((lt^2 + dt^2 - rt^2) / (2 lt dt))                    (14)
    gamma_v = acos((lt^2 + rt^2 - dt^2) / (2 lt rt))                    (15)

and the shortenings, of one segment and of the whole tendon,

    shortened_i = lt_i at theta = 0, minus lt_i                         (18)
    shortened   = sum of shortened_i over the n hinges                  (19)

Points (x, y) [m] have shape [..., 2], angles [rad] and lengths [m] the shape
[...] of their triangles, [..., n] where they belong to a whole finger.

The paper calls both pairs alpha, gamma; they agree at theta = 0 only when the
segment is parallel to the hinge line. It prints atan2 of a ratio in (10), (11),
dt_(i) for dt_(i-1) in (15), and |y_Vi| in (11), which is -y_Vi for a guide on
the palm side; the sign matters for guides on the back of the finger.

The arm about the hinge is h = -d(lt)/d(theta) = dt rt sin(beta) / lt, positive
where the tendon closes the joint. As a load in (33) the tendon gives every
point it passes T (u_before + u_after), u the unit vectors to its neighbours.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import finite, not_negative, per_phalanx, points, positive, together
from sandbox.mechanics.triangle import corner, third_side
from sandbox.numeric import Array

IN_LINE = 1e-12
"""A sine of beta below this [1] is rounding: guides and hinge are in line."""


def guide_radius(guide: ArrayLike) -> Array:
    """rt_i = |V_i| [m], equation (8).

    Args:
        guide: V_i from C_i, in the frame of phalanx i [m], shape [..., 2].

    Raises:
        ValueError: a guide on its hinge, where the tendon would have no arm.
    """
    return positive("guide distance to its hinge",
                    np.linalg.norm(points("guide", guide), axis=-1), "m")


def guide_distance(guide_before: ArrayLike, hinge: ArrayLike) -> Array:
    """dt_(i-1) = |C_i - V_(i-1)| [m], equation (9).

    Args:
        guide_before: V_(i-1), in the frame of phalanx i-1 [m], shape [..., 2].
        hinge: C_i, in the same frame [m], shape [..., 2].

    Raises:
        ValueError: a guide on its hinge.
    """
    apart = _from_guide(guide_before, hinge)
    return positive("guide_before distance to its hinge", np.linalg.norm(apart, axis=-1), "m")


def hinge_angle_before(guide_before: ArrayLike, hinge: ArrayLike) -> Array:
    """alpha_h [rad] at the hinge, equation (10); arguments as in :func:`guide_distance`.

    Printed as atan2 of a ratio, and under the name of the angle of (14).
    """
    apart = _from_guide(guide_before, hinge)
    return np.asarray(np.arctan2(apart[..., 1], apart[..., 0]))


def hinge_angle_after(guide: ArrayLike) -> Array:
    """gamma_h [rad] at the hinge, equation (11); argument as in :func:`guide_radius`.

    Printed as atan2 of a ratio with |y_V|: right only for guides on the palm side.
    """
    at = points("guide", guide)
    return np.asarray(np.arctan2(-at[..., 1], at[..., 0]))


def angle_at_zero(alpha_h: ArrayLike, gamma_h: ArrayLike) -> Array:
    """beta_0 = pi - alpha_h - gamma_h [rad] between the two sides at theta = 0, equation (12).

    Args:
        alpha_h: of :func:`hinge_angle_before` [rad], shape [...].
        gamma_h: of :func:`hinge_angle_after` [rad], shape [...].

    Raises:
        ValueError: arrays of unequal length, a value that is not finite.
    """
    alpha, gamma = finite("alpha_h", alpha_h, "rad"), finite("gamma_h", gamma_h, "rad")
    together(alpha_h=alpha, gamma_h=gamma)
    return np.asarray(np.pi - alpha - gamma)


def segment_length(dt: ArrayLike, rt: ArrayLike, beta: ArrayLike) -> Array:
    """Length lt [m] of the segment across the hinge, equations (13), (17), shape [...].

    Args:
        dt: dt_(i-1) [m], shape [...].
        rt: rt_i [m], shape [...].
        beta: between them [rad], beta_0 for (13), beta_0 - theta for (17), shape [...].

    Raises:
        ValueError: a side that is not above 0 m, arrays of unequal length; a beta
            not between 0 and 2 pi, or at pi, where the segment passes through
            the hinge.
    """
    before, after = positive("dt", dt, "m"), positive("rt", rt, "m")
    angle = finite("beta", beta, "rad")
    together(dt=before, rt=after, beta=angle)
    folded = np.asarray(
        (angle <= 0) | (angle >= 2 * np.pi) | (np.abs(np.sin(angle)) < IN_LINE))
    if folded.any():
        raise ValueError("beta must lie between 0 and 2 pi rad and not at pi, where the segment "
                         f"passes through the hinge, got {angle[folded].flat[0]:.6g} rad")
    return third_side(before, after, angle)


def guide_angle_before(lt: ArrayLike, dt: ArrayLike, rt: ArrayLike) -> Array:
    """alpha_v [rad] at guide V_(i-1), between the segment and the hinge, equation (14).

    Args:
        lt: length of the segment [m], shape [...].
        dt: dt_(i-1) [m], shape [...].
        rt: rt_i [m], shape [...].

    Raises:
        ValueError: a side that is not above 0 m, three sides that make no
            triangle, arrays of unequal length.
    """
    sides = _sides(lt, dt, rt)
    return corner(sides[0], sides[1], sides[2])


def guide_angle_after(lt: ArrayLike, dt: ArrayLike, rt: ArrayLike) -> Array:
    """gamma_v [rad] at guide V_i, between the segment and the hinge, equation (15).

    Printed with dt_(i) for dt_(i-1). Arguments as in :func:`guide_angle_before`.

    Raises:
        ValueError: a side that is not above 0 m, three sides that make no
            triangle, arrays of unequal length.
    """
    sides = _sides(lt, dt, rt)
    return corner(sides[0], sides[2], sides[1])


def segment_arm(dt: ArrayLike, rt: ArrayLike, beta: ArrayLike) -> Array:
    """Arm h = -d(lt)/d(theta) = dt rt sin(beta) / lt [m], from (17), shape [...].

    Arguments and errors as in :func:`segment_length`.
    """
    length = segment_length(dt, rt, beta)
    return np.asarray(np.asarray(dt) * np.asarray(rt) * np.sin(np.asarray(beta)) / length)


def guide_tension(tension: ArrayLike, friction: ArrayLike, wrap: ArrayLike) -> Array:
    """T exp(-mu phi) [N]: what is left behind a rough guide that the tendon runs toward.

    Args:
        tension: T on the pulling side [N].
        friction: mu of the guide.
        wrap: phi by which the guide turns the tendon [rad].

    Raises:
        ValueError: a value below 0.
    """
    rough, turned = not_negative("friction", friction, ""), not_negative("wrap", wrap, "rad")
    pulled = not_negative("tension", tension, "N")
    together(tension=pulled, friction=rough, wrap=turned)
    return np.asarray(pulled * np.exp(-rough * turned))


def guide_wraps(path: ArrayLike) -> Array:
    """Angle phi [rad] by which a tendon bends at each inner point of its path, [..., m-2].

    Args:
        path: the points the tendon runs straight between, in one frame [m], shape [..., m, 2].

    Raises:
        ValueError: fewer than two points, points that coincide.
    """
    at = points("path", path)
    if at.ndim < 2 or at.shape[-2] < 2:
        raise ValueError(f"path must have two points in m or more, got shape {at.shape}")
    along = np.diff(at, axis=-2)
    positive("path segment", np.linalg.norm(along, axis=-1), "m")
    before, after = along[..., :-1, :], along[..., 1:, :]
    across = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
    return np.asarray(np.abs(np.arctan2(across, (before * after).sum(axis=-1))))


def guide_forces(path: ArrayLike, tension: ArrayLike) -> Array:
    """T_before u_before + T_after u_after [N] on every point of a tendon, shape [..., m, 2].

    The loads that (33) asks for: at its two ends the tendon pulls toward the one
    neighbour, at a guide toward both. They sum to 0 over all points.

    Args:
        path: the points the tendon runs straight between, from the actuator's
            side to the end, in one frame [m], shape [..., m, 2].
        tension: T [N], of every segment, shape [..., m-1], or one for all, [...]
            being [..., 1] or a number.

    Raises:
        ValueError: fewer than two points, points that coincide, a tension below
            0, arrays of unequal length.
    """
    at, pulled = points("path", path), not_negative("tension", tension, "N")
    if at.ndim < 2 or at.shape[-2] < 2:
        raise ValueError(f"path must have two points in m or more, got shape {at.shape}")
    along = np.diff(at, axis=-2)
    length = positive("path segment", np.linalg.norm(along, axis=-1), "m")
    shape = together(tension=pulled, segments=length)
    forward = (pulled / length)[..., None] * along
    forces = np.zeros((*shape[:-1], at.shape[-2], 2))
    forces[..., :-1, :] += forward
    forces[..., 1:, :] -= forward
    return forces


def _from_guide(guide_before: ArrayLike, hinge: ArrayLike) -> Array:
    at, guide = points("hinge", hinge), points("guide_before", guide_before)
    together(hinge=at, guide_before=guide)
    return np.asarray(at - guide)


def _sides(lt: ArrayLike, dt: ArrayLike, rt: ArrayLike) -> tuple[Array, Array, Array]:
    length, before = positive("lt", lt, "m"), positive("dt", dt, "m")
    after = positive("rt", rt, "m")
    together(lt=length, dt=before, rt=after)
    return length, before, after


@dataclass(frozen=True)
class TendonRoute:
    """A finger's tendon: the constant sides of its n triangles. Make it with :func:`route`."""

    dt: Array
    """dt_(i-1) [m], shape [n], equation (9)."""
    rt: Array
    """rt_i [m], shape [n], equation (8)."""
    beta_0: Array
    """beta_(i)0 [rad], shape [n], equation (12), in (0, 2 pi); above pi on the finger's back."""

    def beta(self, theta: ArrayLike) -> Array:
        """beta_i [rad] at joint angles ``theta`` [rad], shape [..., n], equation (16).

        Raises:
            ValueError: another number of angles; a joint turned so far that the
                segment passes through its hinge (beta at 0, pi or 2 pi), where
                the straight segment is no model of a cord any more.
        """
        turned = per_phalanx("theta", theta, len(self.beta_0), "rad")
        beta = self.beta_0 - turned
        lowest = np.where(self.beta_0 < np.pi, 0.0, np.pi)
        if (bad := (beta <= lowest) | (beta >= lowest + np.pi)).any():
            joint = int(np.argwhere(bad)[0][-1])
            least, most = (self.beta_0 - lowest - np.pi)[joint], (self.beta_0 - lowest)[joint]
            raise ValueError(
                f"theta of joint {joint + 1} must lie between {least:.6g} and {most:.6g} rad, "
                "where the tendon passes through the hinge, "
                f"got {turned[bad].flat[0]:.6g} rad")
        return np.asarray(beta)

    def lengths(self, theta: ArrayLike) -> Array:
        """lt_i [m], shape [..., n], equation (17)."""
        return segment_length(self.dt, self.rt, self.beta(theta))

    def arms(self, theta: ArrayLike) -> Array:
        """h_i [m], shape [..., n]; each depends on its own joint alone."""
        return segment_arm(self.dt, self.rt, self.beta(theta))

    def shortenings(self, theta: ArrayLike) -> Array:
        """Local shortening lt_(i)0 - lt_(i) [m], shape [..., n], equation (18)."""
        return np.asarray(self.lengths(np.zeros(len(self.dt))) - self.lengths(theta))

    def shortening(self, theta: ArrayLike) -> Array:
        """Total shortening [m], shape [...], equation (19)."""
        return np.asarray(self.shortenings(theta).sum(axis=-1))


def route(guides: ArrayLike, lengths: ArrayLike) -> TendonRoute:
    """The triangles of a finger's tendon, equations (8)-(12).

    Args:
        guides: V_0 ... V_n [m], shape [n+1, 2]; V_0 from the first hinge in the
            palm's frame, V_i in the frame of phalanx i (origin at its near
            hinge, x toward the next, palm side at negative y).
        lengths: of the n phalanges, hinge to hinge [m], shape [n].

    Raises:
        ValueError: numbers of guides and phalanges that do not belong together,
            a length not above 0, a guide on its hinge, a segment through its hinge.
    """
    phalanges = np.atleast_1d(positive("lengths", lengths, "m"))
    eyes = points("guides", guides, len(phalanges) + 1)
    hinges = np.zeros((len(phalanges), 2))
    hinges[1:, 0] = phalanges[:-1]
    before, after = eyes[:-1], eyes[1:]
    beta_0 = np.mod(angle_at_zero(hinge_angle_before(before, hinges), hinge_angle_after(after)),
                    2 * np.pi)
    if (bad := np.abs(np.sin(beta_0)) < IN_LINE).any():
        joint = int(np.argmax(bad))
        raise ValueError(f"guides of joint {joint + 1} must not be in line with its hinge, "
                         f"got beta_0 = {beta_0[joint]:.6g} rad")
    return TendonRoute(guide_distance(before, hinges), guide_radius(after), np.asarray(beta_0))
