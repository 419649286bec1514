"""Where to put the guides, in closed form: f = J^-T (T h - k dl hm) of a finger round a disc.

The pose of a frictionless finger round a fixed disc is geometry. So with h the arms of the cord,
which its guides make, and the springs' stiffness k the forces are linear in both the pull and k:

    f = T a(guides) - B k

A design that is to press alike with all phalanges at every pull needs a, h through J^-T, alike,
and B k alike, too; at one pull the difference of the two is enough.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.mechanics.grasp import disc_centre, disc_grasp
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.statics import contact_jacobian
from sandbox.mechanics.tendon import route
from sandbox.numeric import Array
from sandbox.study.reference_fingers import SET_G

TOUCH, LEAN = 31e-3, float(np.radians(35.0))
"""Where the proximal phalanx touches from its hinge [m], and how far it leans [rad]."""
SPRINGS = spring_set(SET_G.before, SET_G.after)


@dataclass(frozen=True)
class GuideDesign:
    """Guides and springs of the finger."""

    guides: Array
    """V_0 in the palm, from the first hinge, V_1 ... V_3 in their phalanges [m], shape [4, 2]."""
    stiffness: Array
    """[N/m], shape [3]."""

    def travel(self, theta: Array) -> Array:
        """Cord that is taken up from straight to angles [m], shape [..., 3] to [...]."""
        return np.asarray(route(self.guides, SET_G.lengths).shortening(theta))

    @property
    def free(self) -> Array:
        """Angle per pull at which each joint of the free finger begins to close [rad/N], [3]."""
        return np.asarray(route(self.guides, SET_G.lengths).arms(np.zeros(3))
                          / (self.stiffness * SPRINGS.arms(np.zeros(3))**2))


@dataclass(frozen=True)
class Poses:
    """The finger round n discs; nothing here hangs on guides, springs or pull."""

    theta: Array
    """[rad], shape [n, 3]."""
    inverse: Array
    """J^-T [1/m], shape [n, 3, 3]."""
    turned: Array
    """dl hm of the springs [m^2], shape [n, 3]."""

    def forces(self, design: GuideDesign, pull: float) -> Array:
        """With what phalanges would press [N], shape [n, 3]; below 0 one lets go."""
        a, b = self.parts(design)
        return pull * a - b

    def parts(self, design: GuideDesign) -> tuple[Array, Array]:
        """Forces per pull, and what the springs take of them [N], shape [n, 3] each."""
        arms = route(design.guides, SET_G.lengths).arms(self.theta)
        return (np.einsum("nij,nj->ni", self.inverse, arms),
                np.einsum("nij,nj->ni", self.inverse, design.stiffness * self.turned))

    def pulls(self, design: GuideDesign) -> tuple[Array, Array]:
        """Between which pulls all three phalanges press [N], shape [n] each; inf for no end."""
        a, b = self.parts(design)
        with np.errstate(divide="ignore", invalid="ignore"):
            edge = b / a
        return (np.where(a > 0, edge, 0.0).max(axis=1).clip(0.0),
                np.where(a < 0, edge, np.inf).min(axis=1))


def poses(radii: Sequence[float] | Array, *, touch: float = TOUCH, lean: float = LEAN) -> Poses:
    """The finger round discs of radii [m].

    Args:
        radii: of the discs [m].
        touch: where the proximal phalanx touches from its hinge [m].
        lean: of that phalanx [rad].

    Raises:
        ValueError: a disc that a phalanx does not reach.
    """
    grasps = [disc_grasp(disc_centre(lean, touch, r, SET_G.radii[0]), r, SET_G.lengths,
                         SET_G.radii) for r in radii]
    theta = np.array([grasp.theta for grasp in grasps])
    jacobians = np.array([contact_jacobian(grasp.theta, SET_G.lengths, grasp.distances)
                          for grasp in grasps])
    return Poses(theta, np.linalg.inv(np.swapaxes(jacobians, 1, 2)),
                 SPRINGS.elongations(theta) * SPRINGS.arms(theta))


def spread(forces: Array) -> Array:
    """Standard deviation over mean of forces [..., 3], those below 0 taken for 0; 2 for none."""
    pressing = np.clip(forces, 0.0, None)
    mean = pressing.mean(axis=-1)
    return np.where(mean > 1e-3, pressing.std(axis=-1) / np.maximum(mean, 1e-3), 2.0)


def mean_spread(design: GuideDesign, found: Poses, pulls: Sequence[float]) -> float:
    """The mean of :func:`spread` over all discs and pulls [N]."""
    return float(np.mean([spread(found.forces(design, pull)) for pull in pulls]))


def best_design(
    start: GuideDesign, low: Array, high: Array, found: Poses, pulls: Sequence[float], *,
    rounds: int = 150,
) -> tuple[GuideDesign, float]:
    """The design of least :func:`mean_spread`, by differential evolution of the closed form.

    Storn and Price, J. Global Optim. 11 (1997) 341; scipy's.

    Args:
        start: is one of the first.
        low: of the numbers of :func:`numbers_of`, SI, shape [9].
        high: the same.
        found: poses.
        pulls: [N].
        rounds: generations, of 54 designs each.
    """
    from scipy.optimize import differential_evolution

    palm = start.guides[0]

    def cost(numbers: Array) -> float:
        try:
            return mean_spread(design_of(palm, numbers), found, pulls)
        except ValueError:  # guides in line with a hinge
            return 2.0

    result = differential_evolution(
        cost, list(zip(low, high, strict=True)), x0=np.clip(numbers_of(start), low, high),
        maxiter=rounds, popsize=6, tol=0.0, rng=1, polish=True)
    return design_of(palm, result.x), float(result.fun)


def numbers_of(design: GuideDesign) -> Array:
    """X and y of the three guides beyond the palm [m], and three stiffnesses [N/m], shape [9]."""
    return np.concatenate([design.guides[1:].ravel(), design.stiffness])


def design_of(palm: Array, numbers: Array) -> GuideDesign:
    """The design of a guide in the palm [m], shape [2], and of :func:`numbers_of`."""
    return GuideDesign(np.vstack([palm, numbers[:6].reshape(3, 2)]), np.asarray(numbers[6:]))
