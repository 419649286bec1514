"""Independent solutions that the engine is held against: numpy and scipy, nothing of the engine.

scipy is needed only where a motion is integrated; it is no dependency of sandbox.

A planar finger of n phalanges in its joint angles q (closing, clockwise,
positive). Everything follows from coordinates: with the world angle of phalanx
i being a_i = -(q_1 + ... + q_i) and u_i = (cos a_i, sin a_i),

    C_i = sum_(m<i) L_m u_m,   c_i = C_i + s_i u_i            (centre of mass)
    J_i = d c_i / d q,         M = sum m_i J_i^T J_i + I_i w_i^T w_i
    M q'' = Q - sum m_i J_i^T b_i,   b_i = the acceleration of c_i at q'' = 0

and Q the generalised forces of tendon (-T dlt/dq), springs (-k (l - l_0) dl/dq),
joint damping (-d q') and weight.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sandbox.numeric import Array
from sandbox.study.reference_fingers import SET_G, FingerSet

RTOL, ATOL = 1e-11, 1e-13


class NotComputed(Exception):
    """Something that cannot be computed here, and why."""


def solve_ivp(*arguments: Any, **more: Any) -> Any:
    """Scipy's integrator.

    Raises:
        NotComputed: scipy is not installed.
    """
    try:
        from scipy import integrate
    except ModuleNotFoundError:
        raise NotComputed("scipy is not installed (pip install scipy)") from None
    return integrate.solve_ivp(*arguments, **more)


@dataclass(frozen=True)
class Solution:
    """Joint angles and rates at the asked times, and the energies along them."""

    time: Array
    """[s], shape [n]."""
    angle: Array
    """[rad], shape [n, joints]."""
    rate: Array
    """[rad/s], shape [n, joints]."""
    kinetic: Array
    """[J], shape [n]."""
    elastic: Array
    """In the springs [J], shape [n]."""
    weight: Array
    """Potential energy [J], 0 at the start, shape [n]."""
    pulled: Array
    """Work of the tendon's tension [J], integrated along the motion."""
    damped: Array
    """Energy lost in the joints [J], integrated along the motion."""


class Chain:
    """The equations of motion of one finger."""

    def __init__(
        self, finger: FingerSet, pull: Callable[[float], float],
        gravity: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        self.finger, self.pull, self.gravity = finger, pull, np.array(gravity)
        self.n = len(finger.lengths)
        self.L, self.m = np.array(finger.lengths), np.array(finger.masses)
        self.s, self.I = self.L / 2, np.array(finger.inertias)
        self.rest = self.spring(np.zeros(self.n))[0]

    def across(self, near: Array, far: Array, q: Array) -> tuple[Array, Array]:
        """Length and its derivative of straight lines over each hinge; points from the hinge."""
        c, s = np.cos(q), np.sin(q)
        x, y = far.T
        line = np.stack([c * x + s * y, -s * x + c * y], axis=1) - near
        across = np.stack([-s * x + c * y, -c * x - s * y], axis=1)
        length = np.hypot(*line.T)
        return length, (line * across).sum(axis=1) / length

    def tendon(self, q: Array) -> tuple[Array, Array]:
        """Lengths of the tendon's segments, and d/dq of each by its own joint."""
        guides = np.array(self.finger.guides)
        near = guides[:-1].copy()
        near[1:, 0] -= self.L[:-1]
        return self.across(near, guides[1:], q)

    def spring(self, q: Array) -> tuple[Array, Array]:
        """Lengths of the springs, and d/dq of each by its own joint."""
        return self.across(np.array(self.finger.before), np.array(self.finger.after), q)

    def kinematics(self, q: Array, v: Array) -> tuple[Array, Array, Array, Array]:
        """Centres [n, 2], their Jacobians [n, 2, joints], bias accelerations [n, 2]."""
        a, w = -np.cumsum(q), -np.cumsum(v)
        u = np.stack([np.cos(a), np.sin(a)], axis=1)
        across = np.stack([-np.sin(a), np.cos(a)], axis=1)
        spin = -np.tril(np.ones((self.n, self.n)))
        reach = np.tril(np.ones((self.n, self.n)), -1) * self.L + np.diag(self.s)
        centre = reach @ u
        jacobian = np.einsum("im,mx,mj->ixj", reach, across, spin)
        bias = reach @ (-(w**2)[:, None] * u)
        return centre, jacobian, bias, spin

    def mass_matrix(self, q: Array) -> Array:
        """M of the joint angles [kg m^2], shape [joints, joints]."""
        _, J, _, spin = self.kinematics(q, np.zeros(self.n))
        return np.asarray(
            np.einsum("i,ixj,ixk->jk", self.m, J, J) + spin.T @ np.diag(self.I) @ spin)

    def acceleration(self, t: float, q: Array, v: Array) -> Array:
        """The joints' q'' [rad/s^2]."""
        _, J, bias, spin = self.kinematics(q, v)
        M = np.einsum("i,ixj,ixk->jk", self.m, J, J) + spin.T @ np.diag(self.I) @ spin
        length, arm = self.spring(q)
        Q = -self.pull(t) * self.tendon(q)[1]
        Q = Q - np.array(self.finger.stiffness) * (length - self.rest) * arm
        Q = Q - np.array(self.finger.damping) * v
        Q = Q + np.einsum("i,ixj,ix->j", self.m, J, self.gravity - bias)
        return np.asarray(np.linalg.solve(M, Q))

    def derivative(self, t: float, state: Array) -> Array:
        """Of angles, rates, work of the tension and energy lost in the joints."""
        q, v = state[:self.n], state[self.n:2 * self.n]
        pulled = -self.pull(t) * (self.tendon(q)[1] @ v)
        damped = np.array(self.finger.damping) @ v**2
        return np.concatenate([v, self.acceleration(t, q, v), [pulled, damped]])


def integrate(
    finger: FingerSet, times: Array, *, pull: float | Callable[[float], float] = 0.0,
    gravity: tuple[float, float] = (0.0, 0.0), start: tuple[float, ...] | None = None,
    rtol: float = RTOL,
) -> Solution:
    """The finger's free motion from rest at ``start``, sampled at ``times`` [s] > 0."""
    force = pull if callable(pull) else lambda _: float(pull)
    chain = Chain(finger, force, gravity)
    q0 = np.zeros(chain.n) if start is None else np.array(start)
    state = np.concatenate([q0, np.zeros(chain.n + 2)])
    found = solve_ivp(chain.derivative, (0.0, float(times[-1])), state, method="DOP853",
                      t_eval=times, rtol=rtol, atol=ATOL)
    if not found.success:
        raise RuntimeError(found.message)
    q, v = found.y[:chain.n].T, found.y[chain.n:2 * chain.n].T
    kinetic = np.array([0.5 * b @ chain.mass_matrix(a) @ b for a, b in zip(q, v, strict=True)])
    stretch = np.array([chain.spring(a)[0] - chain.rest for a in q])
    height = np.array([chain.kinematics(a, a)[0] @ chain.gravity for a in [q0, *q]]) @ chain.m
    return Solution(found.t, q, v, kinetic, 0.5 * stretch**2 @ np.array(finger.stiffness),
                    height[0] - height[1:], found.y[-2], found.y[-1])


def free_closing(
    finger: FingerSet = SET_G, *, pull: float = 3.0, t_end: float = 0.06,
    times: Array | None = None,
) -> Solution:
    """The finger closing freely from straight under a constant tension [N]."""
    return integrate(finger, np.linspace(0, t_end, 61)[1:] if times is None else times, pull=pull)


def pendulum_period(length: float, inertia: float, mass: float, amplitude: float,
                    gravity: float) -> float:
    """T [s] of a body of ``inertia`` about its centre, ``length`` below its pin, any amplitude.

    T = 4 sqrt(I_pin / (m g l)) K(sin^2(amplitude / 2)), K the complete elliptic integral,
    by the arithmetic-geometric mean.
    """
    pivot = inertia + mass * length**2
    # K(k) = pi / 2 / M(1, sqrt(1 - k^2)), M the arithmetic-geometric mean
    a, b = 1.0, np.cos(amplitude / 2)
    while abs(a - b) > 1e-15 * a:
        a, b = (a + b) / 2, np.sqrt(a * b)
    return float(2 * np.pi / a * np.sqrt(pivot / (mass * gravity * length)))


def damped_spring(t: Array, mass: float, stiffness: float, damping: float,
                  start: float) -> Array:
    """The x(t) [m] of m x'' + c x' + k x = 0 from rest at ``start``, under-damped."""
    decay = damping / (2 * mass)
    omega = np.sqrt(stiffness / mass - decay**2)
    swing = np.cos(omega * t) + decay / omega * np.sin(omega * t)
    return np.asarray(start * np.exp(-decay * t) * swing)


def slide(slope: float, friction: float, gravity: float) -> float:
    """Acceleration down a slope [m/s^2], 0 where friction holds: g (sin - mu cos)."""
    return float(max(0.0, gravity * (np.sin(slope) - friction * np.cos(slope))))


def stopping_distance(speed: float, friction: float, gravity: float) -> float:
    """Distance v^2 / (2 mu g) [m] that a block slides on a level plane."""
    return speed**2 / (2 * friction * gravity)


def stick_slip(t: Array, mass: float, stiffness: float, speed: float, static: float,
               sliding: float) -> Array:
    """The place x(t) [m] of a block that a spring drags, whose other end moves at ``speed``.

    At t = 0 the block is at rest and the spring relaxed. The block sticks until the spring's force
    is ``static`` [N]. It then slips against ``sliding`` [N] for 2 (pi - atan(d w / v)) / w, with
    w^2 = k / m and d = (static - sliding) / k; the stretch that is left is sliding / k - d.
    """
    omega, more = np.sqrt(stiffness / mass), (static - sliding) / stiffness
    slips = 2 * (np.pi - np.arctan2(more * omega, speed)) / omega
    period, first = slips + 2 * more / speed, static / stiffness / speed
    u = np.where(t < first, 0.0, (t - first) % period)
    start = np.where(t < first, first, t - u)
    slip = np.minimum(u, slips)
    stretch = (sliding / stiffness + more * np.cos(omega * slip)
               + speed / omega * np.sin(omega * slip))
    return np.asarray(speed * (start + slip) - stretch)


def atwood(mass_1: float, mass_2: float, gravity: float) -> tuple[float, float]:
    """Downward acceleration of mass 1 [m/s^2] and tension [N] over a massless fixed guide."""
    total = mass_1 + mass_2
    return (mass_1 - mass_2) / total * gravity, 2 * mass_1 * mass_2 / total * gravity


def movable_pulley(
    carried: float, hanging: float, gravity: float, wheel: float = 0.0
) -> tuple[float, float]:
    """Downward acceleration of the hanging mass [m/s^2], and tension [N].

    One end of the cord is fixed; it carries a movable pulley (mass ``wheel``
    with its load ``carried``) on two strands, passes a fixed guide and ends at
    the hanging mass: x_load = x / 2, so m (g - a) = T and 2 T - W g = W a / 2.
    """
    load = carried + wheel
    a = (hanging - load / 2) / (hanging + load / 4) * gravity
    return a, hanging * (gravity - a)


def oscillation(t: Array, omega: float, start: float) -> Array:
    """The x(t) = start cos(omega t) of x'' = -omega^2 x from rest at ``start``."""
    return np.asarray(start * np.cos(omega * t))


def slide_and_roll(t: Array, speed: float, friction: float, gravity: float) -> Array:
    """Displacement [m] of a disc set down without spin: it rolls from t = speed / (3 mu g) on."""
    change = speed / (3 * friction * gravity)
    slid = np.minimum(t, change)
    return np.asarray(speed * slid - friction * gravity * slid**2 / 2
                      + 2 * speed / 3 * np.maximum(t - change, 0))


def trajectory(
    times: Array, acceleration: Callable[[float, Array, Array], Array], start: ArrayLike,
    rate: ArrayLike = 0.0,
) -> Array:
    """The x(t) [times, n] of x'' = acceleration(t, x, x') from ``start`` [n] at t = 0.

    Raises:
        NotComputed: scipy is not installed.
    """
    x0 = np.atleast_1d(np.asarray(start, dtype=np.float64))
    n = len(x0)
    state = np.concatenate([x0, np.broadcast_to(rate, n)])

    def derivative(t: float, y: Array) -> Array:
        return np.concatenate([y[n:], acceleration(t, y[:n], y[n:])])

    found = solve_ivp(derivative, (0.0, float(times[-1])), state, method="DOP853",
                      t_eval=times, rtol=RTOL, atol=ATOL)
    if not found.success:
        raise RuntimeError(found.message)
    return np.asarray(found.y[:n].T)
