"""Four-bar linkages of fingers: the angle of one link from the other's, their ratio, joint torques.

Two links of lengths a and c turn about pivots O_1 and O_2 at a distance g; a coupler b connects
their ends A and B. Angles phi [rad] count from the direction O_1 to O_2, all in one sense. With d
the distance of B from O_1,

    phi_1 = atan2(c sin phi_2, g + c cos phi_2) +- acos((a^2 + d^2 - b^2) / (2 a d))

with + where A lies on the side of O_1 B to which angles count, - on the other one. A and B have the
same speed along the coupler, so that with u its direction

    dphi_1 / dphi_2 = (O_2B x u) / (O_1A x u) = h / (h + g)              [1]

h being how far beyond O_2 the coupler's line cuts that of the pivots (Kennedy).

A finger of two phalanges with a crank at its first hinge, a coupler and a horn on the distal
phalanx is such a linkage on the proximal phalanx, g = l_1. The crank turns by d(theta_a) =
d(theta_1) + X d(theta_2), X = h / (h + l_1), and the virtual work of a torque T_a on it gives

    tau_1 = T_a,   tau_2 = X T_a - k (theta_2 - rest)                    [N m]

Without a spring the proximal contact holds where k_2 > h cos(theta_2) (Birglen, Laliberte and
Gosselin, Underactuated Robotic Hands, 2008).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import finite, not_negative, positive
from sandbox.mechanics.grasp_state import Torques
from sandbox.mechanics.tendon import IN_LINE, corner
from sandbox.numeric import Array


@dataclass(frozen=True)
class FourBar:
    """Two links on pivots and the coupler between their ends; lengths [m], > 0."""

    frame: float  #: g, from pivot O_1 to pivot O_2
    first: float  #: a, from O_1 to the coupler
    coupler: float  #: b, from the first link's end to the second's
    second: float  #: c, from O_2 to the coupler
    crossed: bool = False  #: False for the + of phi_1, True for the -

    def __post_init__(self) -> None:
        for name in ("frame", "first", "coupler", "second"):
            positive(name, getattr(self, name), "m")

    def first_angle(self, second_angle: ArrayLike) -> Array:
        """phi_1 [rad] of phi_2 [rad], shape [...] to [...]; both links must reach the coupler."""
        x, y = self._end(finite("second_angle", second_angle, "rad"))
        turn = corner(np.asarray(self.first), np.hypot(x, y), np.asarray(self.coupler))
        return np.asarray(np.arctan2(y, x) + (-turn if self.crossed else turn))

    def ratio(self, second_angle: ArrayLike) -> Array:
        """dphi_1 / dphi_2 = h / (h + g) [1] at phi_2 [rad], shape [...] to [...].

        Raises:
            ValueError: an angle at which the linkage does not close, or at which first link and
                coupler lie in one line: there the second link turns back.
        """
        turned = finite("second_angle", second_angle, "rad")
        x, y = self._end(turned)
        phi = self.first_angle(turned)
        ax, ay = self.first * np.cos(phi), self.first * np.sin(phi)
        across = ax * (y - ay) - ay * (x - ax)
        if (dead := np.abs(across) < IN_LINE * self.first * self.coupler).any():
            at = float(np.broadcast_to(turned, dead.shape)[dead].flat[0])
            raise ValueError("second_angle must not put first link and coupler in one line, "
                             f"got {at:.6g} rad")
        return np.asarray(((x - self.frame) * (y - ay) - y * (x - ax)) / across)

    def cut(self, second_angle: ArrayLike) -> Array:
        """Distance h [m] beyond O_2 where the coupler's line cuts that of the pivots, shape [...].

        Negative on the side of O_1, infinite where the two lines are parallel; see :meth:`ratio`.
        """
        share = self.ratio(second_angle)
        with np.errstate(divide="ignore"):
            return np.asarray(self.frame * share / (1 - share))

    def _end(self, second_angle: Array) -> tuple[Array, Array]:
        """B from O_1, along the frame and across it [m]."""
        return (np.asarray(self.frame + self.second * np.cos(second_angle)),
                np.asarray(self.second * np.sin(second_angle)))


def crank_torques(
    torque: float, linkage: FourBar, horn: float, *, stiffness: float = 0.0, rest: float = 0.0,
) -> Torques:
    """Joint torques of a finger of two phalanges that a crank closes, as a function of the pose.

    For :class:`sandbox.mechanics.grasp_state.TwoPhalanges`.

    Args:
        torque: T_a on the crank by the palm [N m], closing positive.
        linkage: on the proximal phalanx, the crank its first link, the horn its second; angles
            count from the phalanx to its back.
        horn: psi, from the distal phalanx to its horn [rad], towards the back.
        stiffness: k of a spring between the phalanges [N m/rad], >= 0.
        rest: theta_2 at which that gives no torque [rad]; below 0 it is preloaded.
    """
    pull = float(finite("torque", torque, "N m"))
    psi, zero = float(finite("horn", horn, "rad")), float(finite("rest", rest, "rad"))
    k = float(not_negative("stiffness", stiffness, "N m/rad"))

    def torques(theta: Array) -> Array:
        second = pull * linkage.ratio(psi - theta[..., 1]) - k * (theta[..., 1] - zero)
        return np.stack([np.broadcast_to(pull, second.shape), second], axis=-1)

    return torques
