"""The linear-quadratic controller of the finger's stiffness, designed for control at 1 kHz.

About a pose that is held, x = (rotations, rates) - target moves as x+ = A x + B u
from one act to the next, u the stiffnesses held in between. To it belong the
integrals z that the law keeps, over straight lines between acts,
z+ = z + h/2 (e + e+) with e = C x. Of all u = -G (x, z) the gains are those that
make the sum over all acts of

    (e / e_max)^2 + (e' / v_max)^2 + (z / z_max)^2 + (u / u_max)^2

least (Franklin, Powell and Workman, *Digital Control of Dynamic Systems*, 9.4,
weights after Bryson): B^T S B + R, with S of the discrete Riccati equation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sandbox.numeric import Array
from sandbox.paper.finger_plant import TARGET, Plant
from sandbox.study.independent import NotComputed

PULL = 14.0
"""T of the better controllers [N]. With springs' arms off by +-20 %, s by 1.44 and 0.64, the
pose is held from T_min 1.44 = 9.8 N to T_max 0.64 = 14.6 N; of these pulls a large one
leaves most for loads that open the finger."""
PERIOD = 1e-3
"""Between two acts [s]."""


@dataclass(frozen=True)
class Weights:
    """What counts as much as what: largest sizes that are still welcome."""

    error: float = 0.1
    """Of a rotation, as a fraction of its target."""
    rate: float = 1e-3
    """Time [s] in which a joint may cross that error."""
    integral: tuple[float, ...] = (0.08, 0.025, 0.01)
    """Times [s] for which the error may stand, from the palm out (found by trying: shorter
    ones are sooner rid of a wrong model and overshoot more)."""
    stiffness: float = 1.0
    """Of a stiffness from what holds the pose, as a fraction of Table 2's."""


WEIGHTS = Weights()


@dataclass(frozen=True)
class Design:
    """u = bias + gains (targets - readings) + integral_gains ∫(targets - readings) dt."""

    gains: Array
    """[N/m per rad] for the angles, then [N/m per rad/s] for the rates, shape [n, 2n]."""
    integral_gains: Array
    """Of the angles [N/m per rad s], shape [n, n]."""
    bias: Array
    """The stiffness that holds the pose [N/m], shape [n]."""
    poles: Array
    """Sizes of the sampled loop's poles, shape [3n]; stable below 1."""


def lqr(
    plant: Plant | None = None, pull: float = PULL, target: ArrayLike = TARGET,
    weights: Weights = WEIGHTS, period: float = PERIOD,
) -> Design:
    """The controller about ``target`` [rad], shape [n], at a pull [N].

    Raises:
        NotComputed: scipy is not installed.
    """
    try:
        from scipy.linalg import expm, solve_discrete_are
    except ModuleNotFoundError:
        raise NotComputed("scipy is not installed (pip install scipy)") from None
    finger, pose = plant or Plant(), np.asarray(target, dtype=float)
    n = len(pose)
    bias = finger.stiffness(pull, pose)
    a, b = finger.linear(pull, bias, pose).state_space()
    sampled = expm(period * np.vstack([np.hstack([a, b]), np.zeros((n, 3 * n))]))
    a, b = sampled[:2 * n, :2 * n], sampled[:2 * n, 2 * n:]
    c = np.eye(n, 2 * n)
    # the integrals of the law: trapezoids of e = C x
    a = np.block([[a, np.zeros((2 * n, n))], [period / 2 * (c + c @ a), np.eye(n)]])
    b = np.vstack([b, period / 2 * c @ b])
    error = weights.error * pose
    sizes = np.concatenate([error, error / weights.rate, error * np.asarray(weights.integral)])
    cost = np.diag(sizes**-2.0)
    effort = np.diag((weights.stiffness * np.asarray(finger.finger.stiffness)) ** -2.0)
    s = solve_discrete_are(a, b, cost, effort)
    gains = np.linalg.solve(effort + b.T @ s @ b, b.T @ s @ a)
    poles = np.linalg.eigvals(a - b @ gains)
    return Design(gains[:, :2 * n], gains[:, 2 * n:], bias, np.abs(poles))
