"""The tendon across each hinge: equations (8)-(19), arms, wrap angles and friction of guides.

Between phalanx i-1 and phalanx i the tendon runs straight from guide V_(i-1) to guide V_i. With the
hinge C_i these make a triangle whose two sides at C_i are constant:

    rt_i     = |V_i|,  V_i from C_i in the frame of phalanx i           (8)
    dt_(i-1) = |C_i - V_(i-1)|, in the frame of phalanx i-1             (9)

The angle beta_i between them closes with the finger. The angles alpha_h, gamma_h at the hinge are
those between the hinge line and either side at theta_i = 0:

    alpha_h = atan2(y_C - y_V(i-1), x_C - x_V(i-1))                     (10)
    gamma_h = atan2(-y_Vi, x_Vi)                                        (11)
    beta_0  = pi - alpha_h - gamma_h                                    (12)
    beta    = beta_0 - theta                                            (16)
    lt      = sqrt(dt^2 + rt^2 - 2 dt rt cos beta)                      (13), (17)

and the angles at the guides, between the segment and either side, are

    alpha_v = acos((lt^2 + dt^2 - rt^2) / (2 lt dt))                    (14)
    gamma_v = acos((lt^2 + rt^2 - dt^2) / (2 lt rt))                    (15)

The shortening of a segment is lt_0 - lt (18), of the tendon their sum (19). The paper calls both
pairs alpha, gamma; they agree at theta = 0 only where the segment is parallel to the hinge line.
The arm about the hinge is h = -d(lt)/d(theta) = dt rt sin(beta) / lt, positive where the tendon
closes the joint.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import finite, not_negative, per_phalanx, points, positive
from sandbox.numeric import Array

IN_LINE = 1e-12  # A sine of beta below this [1] is rounding: guides and hinge are in line


def third_side(a: Array, b: Array, angle: Array) -> Array:
    """Length sqrt(a^2 + b^2 - 2 a b cos(angle)) opposite ``angle`` [rad].

    As sqrt((a - b)^2 + 4 a b sin^2(angle / 2)), which loses no digits where the two sides nearly
    coincide.
    """
    return np.asarray(np.hypot(a - b, 2 * np.sqrt(a * b) * np.sin(angle / 2)))


def corner(a: Array, b: Array, opposite: Array) -> Array:
    """Angle between sides ``a`` and ``b`` [rad], acos((a^2 + b^2 - opposite^2) / (2 a b))."""
    cosine = np.asarray((a**2 + b**2 - opposite**2) / (2 * a * b))
    if (apart := np.abs(cosine) > 1 + 1e-12).any():
        sides = [float(side[apart].flat[0]) for side in np.broadcast_arrays(a, b, opposite)]
        raise ValueError("the sides must make a triangle, got "
                         + ", ".join(f"{side:.6g} m" for side in sides))
    return np.asarray(np.arccos(np.clip(cosine, -1, 1)))


def segment_length(dt: ArrayLike, rt: ArrayLike, beta: ArrayLike) -> Array:
    """Length lt [m] of the segment across the hinge, equations (13), (17), shape [...].

    ``beta`` [rad] between dt > 0 and rt > 0 [m] is beta_0 for (13), beta_0 - theta for (17), from 0
    to 2 pi without pi, where the segment passes through the hinge.
    """
    before, after = positive("dt", dt, "m"), positive("rt", rt, "m")
    angle = finite("beta", beta, "rad")
    folded = np.asarray((angle <= 0) | (angle >= 2 * np.pi) | (np.abs(np.sin(angle)) < IN_LINE))
    if folded.any():
        raise ValueError("beta must lie between 0 and 2 pi rad and not at pi, where the segment "
                         f"passes through the hinge, got {angle[folded].flat[0]:.6g} rad")
    return third_side(before, after, angle)


def guide_tension(tension: ArrayLike, friction: ArrayLike, wrap: ArrayLike) -> Array:
    """T exp(-mu phi) [N], the tension behind a guide with friction that the tendon moves toward.

    T >= 0 [N] is that on the pulling side, mu >= 0 the friction, phi >= 0 [rad] the wrap.
    """
    mu, phi = not_negative("friction", friction, ""), not_negative("wrap", wrap, "rad")
    pull = not_negative("tension", tension, "N")
    return np.asarray(pull * np.exp(-mu * phi))


def guide_wraps(path: ArrayLike) -> Array:
    """Bend [rad] at inner points of a path of straight pieces [m], [..., m, 2] to [..., m-2]."""
    at = points("path", path)
    if at.ndim < 2 or at.shape[-2] < 2:
        raise ValueError(f"path must have two points in m or more, got shape {at.shape}")
    along = np.diff(at, axis=-2)
    positive("path segment", np.linalg.norm(along, axis=-1), "m")
    before, after = along[..., :-1, :], along[..., 1:, :]
    across = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
    return np.asarray(np.abs(np.arctan2(across, (before * after).sum(axis=-1))))


@dataclass(frozen=True)
class TendonRoute:
    """The triangles of a finger's tendon. Make it with :func:`route`."""

    dt: Array  #: dt_(i-1) [m], shape [n], equation (9)
    rt: Array  #: rt_i [m], shape [n], equation (8)
    beta_0: Array  #: beta_(i)0 [rad], shape [n], equation (12); above pi on the finger's back

    def beta(self, theta: ArrayLike) -> Array:
        """beta_i [rad] at joint angles ``theta`` [rad], shape [..., n], equation (16).

        Raises:
            ValueError: an angle beyond that at which the segment passes through its hinge.
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
        beta = self.beta(theta)
        return np.asarray(self.dt * self.rt * np.sin(beta) / segment_length(self.dt, self.rt, beta))

    def shortenings(self, theta: ArrayLike) -> Array:
        """Local shortening lt_(i)0 - lt_(i) [m], shape [..., n], equation (18)."""
        return np.asarray(self.lengths(np.zeros(len(self.dt))) - self.lengths(theta))

    def shortening(self, theta: ArrayLike) -> Array:
        """Total shortening [m], shape [...], equation (19)."""
        return np.asarray(self.shortenings(theta).sum(axis=-1))

    def guide_angles(self, theta: ArrayLike) -> tuple[Array, Array]:
        """alpha_v at V_(i-1) and gamma_v at V_i [rad], shape [..., n], equations (14), (15)."""
        length = self.lengths(theta)
        return corner(length, self.dt, self.rt), corner(length, self.rt, self.dt)


def route(guides: ArrayLike, lengths: ArrayLike) -> TendonRoute:
    """The triangles of a finger's tendon, equations (8)-(12).

    Args:
        guides: V_0 ... V_n [m], shape [n+1, 2]; V_0 from the first hinge in the palm's frame, V_i
            in the frame of phalanx i (origin at its near hinge, x toward the next, palm side at
            negative y).
        lengths: of the n phalanges, hinge to hinge [m], > 0, shape [n].

    Raises:
        ValueError: a guide on its hinge, a segment through its hinge.
    """
    phalanges = np.atleast_1d(positive("lengths", lengths, "m"))
    eyes = points("guides", guides, len(phalanges) + 1)
    before, after = -eyes[:-1], eyes[1:]
    before[1:, 0] += phalanges[:-1]
    alpha_h = np.arctan2(before[:, 1], before[:, 0])  # (10)
    gamma_h = np.arctan2(-after[:, 1], after[:, 0])  # (11)
    dt, rt = (positive("guide distance to its hinge", np.linalg.norm(side, axis=-1), "m")
              for side in (before, after))
    beta_0 = np.mod(np.pi - alpha_h - gamma_h, 2 * np.pi)
    if (bad := np.abs(np.sin(beta_0)) < IN_LINE).any():
        joint = int(np.argmax(bad))
        raise ValueError(f"guides of joint {joint + 1} must not be in line with its hinge, "
                         f"got beta_0 = {beta_0[joint]:.6g} rad")
    return TendonRoute(dt, rt, np.asarray(beta_0))
