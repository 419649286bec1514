"""Fingers without mass that close on fixed discs, many at a time: poses and forces from geometry.

What a tendon pulls shut, springs hold open and hinges damp moves by

    d_i dtheta_i/dt = tau_i(theta_i) + stops - (J^T f)_i,   tau = T h - k (lm - lm_0) hm

with gaps g_c >= 0, forces f_c >= 0 and f_c g_c = 0: the finger of a simulation with its inertia
left out. A capsule phalanx and a disc part by

    g = |c - p| - r - rho,   p the point of the phalanx's axis nearest to the disc's centre c

and dg/dtheta = -J, the Jacobian of :mod:`sandbox.mechanics.statics`. Each step is implicit: tau,
gaps and stops are those of its end, to first order, and its forces solve a complementarity
problem, row by row (Gauss and Seidel). So a step may be long. At rest the forces are those of the
pose, J^-T tau, whatever the way there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sandbox.mechanics.springs import SpringSet
from sandbox.mechanics.tendon import TendonRoute
from sandbox.numeric import Array

STEP, STEPS, ROUNDS = 2.5e-3, 300, 10
"""Of the way [s], and how many; how often a step goes over its rows."""
LONGER, LAST = 8, 100
"""How many times as long the last steps are, and how many there are. Much longer ones, that leave
out the damping, find no rest where a phalanx slides round its disc."""
EXACT = 1e-9
"""Change of a push, in its largest, at which no further round is gone; a torque that is none
[N m]."""
NO_ARM = 1e-12
"""Yield of a row below which nothing that it pushes with turns a joint [rad m/N]."""
NUDGE = 1e-5
"""By which a joint is turned to find how its torque changes [rad]."""
POLISH, NEAR, TOUCH = 6, 0.05, 1e-8
"""Newton's steps at the end; how far they may lead [rad], and phalanges into discs [m]."""
SOFTEST = 1e-2
"""Least stiffness of a step [N m/rad]: where a torque grows as its joint closes, a step that
followed its slope would run away."""


@dataclass(frozen=True)
class ClosingFinger:
    """A finger of n phalanges that is closed by a tendon."""

    tendon: TendonRoute
    springs: SpringSet
    stiffness: Array
    """k_i [N/m], shape [n]; slack at rotation 0."""
    limits: Array
    """Lowest and highest rotation [rad], shape [n, 2]."""
    lengths: Array
    """L_i [m], shape [n]."""
    radii: Array
    """rho_i of the capsules [m], shape [n]."""
    damping: Array
    """d_i of the hinges [N m s/rad], shape [n], above 0."""

    def torques(self, theta: Array, tension: Array) -> Array:
        """tau_i [N m], shape [m, n], at rotations of that shape and tensions [N], shape [m]."""
        back = self.stiffness * self.springs.elongations(theta) * self.springs.arms(theta)
        return np.asarray(tension[:, None] * self.tendon.arms(theta) - back)


class Pull(NamedTuple):
    """What pulls m tendons: forces, or ways by which cords that give are drawn."""

    amount: Array
    """Tensions [N], or how far the cords' ends are drawn [m]; shape [m]."""
    stiffness: float = 0.0
    """Of the cords that are drawn [N/m]; 0 where tensions are given. Drawn by a way, a finger
    rests also where by a tension it would snap shut."""


class Embraced(NamedTuple):
    """m fingers at rest."""

    theta: Array
    """[rad], shape [m, n]."""
    gaps: Array
    """Between phalanges and disc [m], shape [m, n]."""
    distances: Array
    """k_i, from the near hinge to what is nearest to the disc, along the phalanx [m], [m, n]."""
    forces: Array
    """With which each phalanx presses [N], shape [m, n]."""
    tension: Array
    """Of each tendon [N], shape [m]."""
    residual: Array
    """Largest torque that is not balanced [N m], shape [m]; 0 at rest."""


class _Near(NamedTuple):
    gaps: Array
    distances: Array
    jacobian: Array


def near_disc(theta: Array, lengths: Array, radii: Array, centres: Array, discs: Array) -> _Near:
    """Gaps and distances k_i [m], shape [m, n], and J_cj [m], shape [m, n, n].

    Args:
        theta: [rad], shape [m, n].
        lengths: L_i [m], shape [n].
        radii: rho_i [m], shape [n].
        centres: of the discs, the first hinge at the origin [m], shape [m, 2].
        discs: their radii [m], shape [m].
    """
    turned = -np.cumsum(theta, axis=1)
    along = np.stack([np.cos(turned), np.sin(turned)], axis=-1)
    ends = np.cumsum(lengths[:, None] * along, axis=1)
    hinges = np.concatenate([np.zeros_like(ends[:, :1]), ends[:, :-1]], axis=1)
    to = centres[:, None] - hinges
    k = np.clip((to * along).sum(axis=-1), 0.0, lengths)
    off = to - k[..., None] * along
    apart = np.linalg.norm(off, axis=-1)
    normal = -off / apart[..., None]
    lever = (hinges + k[..., None] * along)[:, :, None] - hinges[:, None, :]
    rows = normal[:, :, None, 1] * lever[..., 0] - normal[:, :, None, 0] * lever[..., 1]
    n = len(lengths)
    return _Near(apart - discs[:, None] - radii, k, rows * np.tril(np.ones((n, n))))


def close_on_discs(
    finger: ClosingFinger, centres: Array, discs: Array, pull: Pull, ramp: float,
) -> Embraced:
    """Where fingers come to rest that are closed from straight, and what they press with.

    Args:
        finger: all are alike.
        centres: of the discs, the first hinge at the origin, the straight finger along +x with
            its palm side at -y [m], shape [m, 2].
        discs: their radii [m], shape [m].
        pull: what pulls each in the end.
        ramp: in which time it grows to that, evenly [s].
    """
    n, held = len(finger.lengths), (centres, discs)
    theta, push = np.zeros((len(discs), n)), np.zeros((len(discs), 3 * n + 1))
    for i in range(STEPS + LAST):
        step = STEP if i < STEPS else LONGER * STEP
        share = min(1.0, (i + 1) * STEP / ramp)
        now = Pull(pull.amount * share, pull.stiffness)
        theta, push = _step(finger, theta, push, held, now, step)
    theta, push = _polished(finger, theta, push, held, pull)
    near = near_disc(theta, finger.lengths, finger.radii, *held)
    tension = push[:, -1] if pull.stiffness else pull.amount
    left = np.abs(_balance(finger, theta, push, held, pull)[:, :n]).max(axis=1)
    return Embraced(theta, near.gaps, near.distances, push[:, :n], tension, left)


def _step(
    finger: ClosingFinger, theta: Array, push: Array, held: tuple[Array, Array], pull: Pull,
    step: float,
) -> tuple[Array, Array]:
    """The pose after a step [rad], and what contacts, stops and cord push with, [m, 3 n + 1].

    With K the slope of the torques and D = d / step, the turn x and the pushes p >= 0 solve

        (D + K) x = tau + G^T p,   g + G x + C p >= 0,   p (g + G x + C p) = 0

    where C is the compliance of a cord that is drawn by a way, and 0 elsewhere.
    """
    tau = finger.torques(theta, pull.amount * (not pull.stiffness))
    stiff = _stiffness(finger, theta, push[:, -1] if pull.stiffness else pull.amount, step)
    rows, gaps = _rows(finger, theta, held, pull)
    free = tau / stiff
    yields = np.einsum("mij,mj,mkj->ikm", rows, 1.0 / stiff, rows)
    yields[-1, -1] += 1.0 / pull.stiffness if pull.stiffness else 1.0
    push = _pushes(yields, (gaps + np.einsum("mij,mj->mi", rows, free)).T, push.T).T
    turn = free + np.einsum("mij,mi->mj", rows, push) / stiff
    return np.clip(theta + turn, finger.limits[:, 0], finger.limits[:, 1]), push


def _rows(
    finger: ClosingFinger, theta: Array, held: tuple[Array, Array], pull: Pull,
) -> tuple[Array, Array]:
    """G, shape [m, 3 n + 1, n], and g, shape [m, 3 n + 1]: contacts, both stops, the cord."""
    n, drawn = len(finger.lengths), pull.stiffness > 0
    near = near_disc(theta, finger.lengths, finger.radii, *held)
    unit = np.broadcast_to(np.eye(n), (len(theta), n, n))
    cord = finger.tendon.arms(theta)[:, None] * drawn
    short = finger.tendon.shortening(theta) - pull.amount
    gaps = np.concatenate([near.gaps, theta - finger.limits[:, 0], finger.limits[:, 1] - theta,
                           (short if drawn else np.ones_like(short))[:, None]], axis=1)
    return np.concatenate([-near.jacobian, unit, -unit, cord], axis=1), gaps


def _balance(
    finger: ClosingFinger, theta: Array, push: Array, held: tuple[Array, Array], pull: Pull,
) -> Array:
    """Torques left over, and g + C p of what pushes or p of what does not; [m, n + 3 n + 1]."""
    rows, gaps = _rows(finger, theta, held, pull)
    tau = finger.torques(theta, pull.amount * (not pull.stiffness))
    left = tau + np.einsum("mij,mi->mj", rows, push)
    if pull.stiffness:
        gaps[:, -1] += push[:, -1] / pull.stiffness
    return np.concatenate([left, np.where(push > 0, gaps, push)], axis=1)


def _polished(
    finger: ClosingFinger, theta: Array, push: Array, held: tuple[Array, Array], pull: Pull,
) -> tuple[Array, Array]:
    """Newton's way from what is nearly at rest to rest, with what pushes there; else as it was."""
    n, rows = theta.shape[1], push.shape[1]
    on = push > 0
    at, pushed = theta.copy(), push.copy()
    for _ in range(POLISH):
        left = _balance(finger, at, np.where(on, pushed, 0.0), held, pull)
        slope = np.zeros((len(theta), n + rows, n + rows))
        slope[:, :n, n:] = np.swapaxes(_rows(finger, at, held, pull)[0], 1, 2) * on[:, None]
        slope[:, n:, n:] = np.eye(rows) * ~on[:, None]
        if pull.stiffness:
            slope[:, -1, -1] += on[:, -1] / pull.stiffness
        for j in range(n):
            turn = NUDGE * np.eye(n)[j]
            slope[:, :, j] = (_balance(finger, at + turn, np.where(on, pushed, 0.0), held, pull)
                              - _balance(finger, at - turn, np.where(on, pushed, 0.0), held, pull)
                              ) / (2 * NUDGE)
            slope[:, n:, j] *= on
        # a joint that nothing holds has a slope of 0: a trace of stiffness leaves it where it is
        step = np.linalg.solve(slope + 1e-12 * np.eye(n + rows), -left[..., None])[..., 0]
        at = np.clip(at + step[:, :n], finger.limits[:, 0], finger.limits[:, 1])
        pushed = np.where(on, pushed + step[:, n:], 0.0)
    good = ((pushed >= 0).all(axis=1) & (np.abs(at - theta).max(axis=1) < NEAR)
            & (near_disc(at, finger.lengths, finger.radii, *held).gaps > -TOUCH).all(axis=1))
    good &= np.abs(_balance(finger, at, pushed, held, pull)[:, :n]).max(axis=1) < EXACT
    return np.where(good[:, None], at, theta), np.where(good[:, None], pushed, push)


def _stiffness(finger: ClosingFinger, theta: Array, tension: Array, step: float) -> Array:
    """D + K of every joint [N m/rad], shape [m, n]; K no less than what a step can follow."""
    low = np.clip(theta, finger.limits[:, 0], finger.limits[:, 1] - NUDGE)
    slope = (finger.torques(low, tension) - finger.torques(low + NUDGE, tension)) / NUDGE
    return np.asarray(np.maximum(slope, SOFTEST) + finger.damping / step)


def _pushes(yields: Array, gaps: Array, first: Array) -> Array:
    """Pushes p >= 0 with ``gaps`` + A p >= 0 and one of the two 0 for each row; shape [rows, m].

    Args:
        yields: A, shape [rows, rows, m].
        gaps: where nothing pushes, shape [rows, m].
        first: a guess.
    """
    push = first.copy()
    small = EXACT * max(float(push.max(initial=0.0)), 1.0)
    for _ in range(ROUNDS):
        most = 0.0
        for i, row in enumerate(yields):
            gap = gaps[i] + (row * push).sum(axis=0)
            new = np.maximum(0.0, push[i] - gap / np.maximum(row[i], NO_ARM))
            most = max(most, float(np.abs(new - push[i]).max(initial=0.0)))
            push[i] = new
        if most < small:
            break
    return push
