"""What friction of a cord does to fingers, in closed form.

Euler and Eytelwein: over a bend phi the tension of a cord may fall by e^(-mu phi) before it slides,
and where it slides it falls by just that. A cord that slides towards its actuator has F e^(-mu phi)
behind a bend, one that is drawn back F e^(mu phi), and in between nothing moves. Over hinge i acts
the piece of cord between guides i - 1 and i, so that tau_i = T_i h_i - k dl_i hm_i and
f = J^-T tau.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sandbox.mechanics.chain import to_world, transforms
from sandbox.mechanics.grasp import disc_centre, disc_grasp
from sandbox.mechanics.statics import contact_forces, contact_jacobian
from sandbox.mechanics.tendon import guide_tension, guide_wraps
from sandbox.model.compile import compile_mechanism
from sandbox.numeric import Array
from sandbox.paper.hand_stiffness import free_fingers
from sandbox.scene.document import Scene
from sandbox.scene.expand import expand
from sandbox.scene.parts.finger import Finger


@dataclass(frozen=True)
class SheathedFinger:
    """A finger that wraps its disc without friction of the skin, at the end of a sheath."""

    wraps: Array
    """By how much the cord bends at the guides V_0 to V_(n-1) in this pose [rad], shape [n]."""
    arms: Array
    """h_i of the cord [m], shape [n]."""
    back: Array
    """What the springs turn back with [N m], shape [n]."""
    jacobian: Array
    """Of the contacts, [m], shape [n, n]."""

    def pieces(self, pull: float, bend: float, sheath: float, guides: float) -> Array:
        """Tension over each hinge [N], shape [n], of a cord that slides towards its actuator.

        Args:
            pull: F [N].
            bend: phi of the sheath [rad].
            sheath: mu of the sheath.
            guides: mu of the finger's guides.
        """
        arriving = guide_tension(pull, sheath, bend)
        return np.asarray(arriving * np.exp(-guides * np.cumsum(self.wraps)))

    def forces(self, pieces: Array) -> Array:
        """What the phalanges press with [N], shape [n]; below 0 where one would have to pull."""
        return contact_forces(self.jacobian, pieces * self.arms - self.back)


def sheathed_finger(scene: Scene) -> SheathedFinger:
    """The finger of the scene ``sheathed_finger`` round its disc.

    Raises:
        ValueError: a disc that not every phalanx reaches.
    """
    mechanism = expand(scene)
    free = free_fingers(compile_mechanism(mechanism))["finger"]
    part = next(part for part in scene.parts if isinstance(part, Finger))
    lengths, given = np.array(part.lengths), scene.parameters
    centre = disc_centre(given["knuckle"], given["foot"], given["radius"], part.radii[0])
    grasp = disc_grasp(centre, given["radius"], lengths, part.radii)
    guides = np.array(part.guides)
    path = np.vstack([part.tendon_to[0].at, guides[:1],
                      to_world(transforms(grasp.theta, lengths), guides[1:])])
    stretched = free.springs.elongations(grasp.theta) * free.springs.arms(grasp.theta)
    return SheathedFinger(
        guide_wraps(path), free.tendon.arms(grasp.theta), free.stiffness * stretched,
        contact_jacobian(grasp.theta, lengths, grasp.distances))


def cycle(pulls: Array, loss: float) -> Array:
    """Tension behind a sheath over a rise of the pull and its fall [N], shape [n].

    Behind a sheath of loss = mu phi the tension lies between F e^(-loss) and F e^(loss); within
    these it stays what it was.

    Args:
        pulls: F, one after the other, from 0 [N], shape [n].
        loss: mu phi.
    """
    tension, found = 0.0, []
    for pull in pulls.tolist():
        tension = float(np.clip(tension, pull * np.exp(-loss), pull * np.exp(loss)))
        found.append(tension)
    return np.array(found)


def loop_area(most: float, loss: float) -> float:
    """The area that :func:`cycle` runs round as the pull rises to ``most`` and falls to 0 [N^2].

    most^2 (e^(-loss) - e^(-3 loss)) / 2.
    """
    return float(most**2 * (np.exp(-loss) - np.exp(-3 * loss)) / 2)


def over_pulleys(pull: float, friction: float, count: int) -> Array:
    """Tension of each finger on one cord over pulleys that rub [N], shape [count], the last first.

    Each finger's pulley turns the cord by 180 deg, and so do the two that stand before it:
    F e^(-2 pi mu j) (1 + e^(-pi mu)) of the j-th finger behind the actuator.
    """
    behind = np.exp(-2 * np.pi * friction * np.arange(count))
    return np.asarray(pull * behind * (1 + np.exp(-np.pi * friction)))[::-1]
