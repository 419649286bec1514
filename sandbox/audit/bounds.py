"""The range of contact forces in one sample that mechanics allows.

With friction, or with more contacts than degrees of freedom, the forces that satisfy m a = sum F
and I alpha = sum M on every free body are a convex set: contacts push within their friction cones,
tendons pull. A linear program gives the minimum and maximum of each component. The largest push on
an object follows with one more unknown: a force at its centre of mass.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from sandbox.audit.contacts import CONE
from sandbox.audit.evidence import EXACT, ROUNDING, SMALLEST_SCALE, STOPPED, Check, Evidence, Worst
from sandbox.audit.laws import carried
from sandbox.audit.outlines import pressed, touched
from sandbox.elements.tendons import RIGID
from sandbox.mechanics.linear_program import LinearProgram
from sandbox.model.joints import flank_of, slot_length
from sandbox.model.model import NONE
from sandbox.model.supports import RANK, about_centres, components, joint_rows
from sandbox.numeric import Array

MANY = 60  # Contacts at the end above which the audit leaves their bounds out
MAX_ROWS = 300  # Largest number of connected rows of balance, three a body


class Unknown(NamedTuple):
    """One force or couple of unknown magnitude."""

    wrench: Array  # Of a unit on every body: force x, y and moment about its centre, [nb, 3]
    free: bool = False  # Whether it may have either sign
    most: float = np.inf  # Largest magnitude [N, N m]
    contact: int = NONE  # The contact row that it belongs to
    normal: float = 0.0  # Contribution of a unit to the normal force of that row
    tangential: float = 0.0  # The same of the tangential force
    below: float = 0.0  # Rounding error below 0 [N] of the recorded force


class Unknowns:
    """The forces of a single sample that only balance determines, and the sum of all others.

    Joints carry any load; contacts push within their friction cones; stops, ends of grooves and
    ropes push back where they are reached; rigid tendons pull if they are taut; motors and brakes
    act up to their limits. All other loads are known.
    """

    def __init__(self, evidence: Evidence) -> None:
        self.evidence, self.model, self.loads = evidence, evidence.model, evidence.loads
        self.arrays, frames = evidence.arrays, evidence.frames
        self.centre = frames.centre[:2, :, 0].T
        tendons, drives = self.model.tendons, self.model.drives
        # with friction at guides tensions depend on the past: they are known
        self.rigid = (tendons.drive == NONE) & (tendons.stiffness >= RIGID) & np.array(
            [not len(tendons.gripped(cable)) for cable in range(len(tendons.name))], dtype=bool)
        found = [one._replace(wrench=one.wrench * self.model.bodies.free[:, None]) for one in (
            *self._joints(), *self._ends(), *self._limited(), *self._contacts())]
        self.all = [one for one in found if one.wrench.any()]
        # sum of the unknown forces: m a and I alpha minus all known loads, [nb, 3]
        self.target = self.loads.weights * self.arrays["body_acceleration"][0]
        limited = np.array([kind.limited for kind in drives.kind], dtype=bool)
        known = {"tendon": ~self.rigid, "drive": ~limited | ~np.isnan(drives.slope),
                 "friction": self.arrays["joint_sticks"][0] == 0.0}  # at its bound while it slips
        for batch in self.loads.batches:
            rows = known[batch.kind][batch.element] if batch.kind in known else np.full(
                len(batch.body), batch.kind != "stop")
            np.subtract.at(self.target, batch.body[rows], batch.wrench[rows, :, 0])

    def _joints(self) -> Iterator[Unknown]:
        pose, model = self.arrays["body_pose"][0], self.model
        for j in np.flatnonzero(self.evidence.holds["joint"][:, 0]).tolist():
            force, flank = self.arrays["joint_force"][0, j], 0
            if model.joints.kind[j].teeth and force.any():  # the flank that pushed
                one, other = (flank_of(model, j, pose, side) for side in (1, -1))
                flank = 1 if (one.x - other.x) * force[0] + (
                    one.y - other.y) * force[1] >= 0 else -1
            for wrench in about_centres(model, pose, joint_rows(model, pose, j, flank=flank)):
                yield Unknown(wrench, free=True)

    def _pair(self, one: int, two: int, at: Array, force: Array, couple: float = 0.0) -> Array:
        """A force at a position in the world, and a couple, on ``one`` by ``two``, [nb, 3]."""
        wrench = np.zeros((len(self.centre), 3))
        for sign, body in ((1.0, one), (-1.0, two)):
            x, y = at - self.centre[body]
            wrench[body] = sign * np.array([*force, x * force[1] - y * force[0] + couple])
        return wrench

    def _ends(self) -> Iterator[Unknown]:
        """Stops, taut ropes, telescopes at their shortest, points at an end of their groove."""
        joints, frames, evidence = self.model.joints, self.loads.frames, self.evidence
        velocity, h = np.abs(evidence.velocity[:, :, 0]), evidence.h
        for j in joints.keeping("range", "groove").tolist():
            a, b = joints.bodies[j].tolist()
            on_a, on_b = (np.array([end.x[j, 0], end.y[j, 0]]) for end in frames.anchors)
            if joints.kind[j].keeps == "groove":
                place, high = frames.place_in_slot(j), slot_length(self.model, j)
                length, way = float(place.along[0]), np.array([place.x[0], place.y[0]])
                low = -math.inf if math.isinf(high) else 0.0
            else:
                low, high = joints.reach[j].tolist()
                length = float(np.hypot(*(on_b - on_a)))
                way = (on_b - on_a) / max(length, ROUNDING)
            moves = sum(velocity[:2, n].sum() + velocity[2, n] * np.hypot(*(on_b - self.centre[n]))
                        for n in (a, b))
            for sign in _reached(length, low, high, STOPPED + 2 * h * float(moves)):
                yield Unknown(self._pair(b, a, on_b, sign * way))
        torques = self.loads.joint_efforts.wrenches(len(joints.name), len(self.centre))
        for j in joints.stopped.tolist():
            rate = np.abs(evidence.rates[j, 0]) + np.abs(evidence.rates_after[j, 0])
            low, high = joints.stops[j].tolist()
            for sign in _reached(float(evidence.angles[j, 0]), low, high,
                                 STOPPED + h * float(rate)):
                yield Unknown(sign * torques[j])

    def _limited(self) -> Iterator[Unknown]:
        """Taut tendons, motors and brakes, and friction of joints that stick."""
        drives, joints, a, loads = self.model.drives, self.model.joints, self.arrays, self.loads
        bodies, count = len(self.centre), len(self.rigid)
        rates = loads.cable_efforts.rates(count, self.evidence.velocity)[:, 0]
        pulls = loads.cable_efforts.wrenches(count, bodies)
        for cable in np.flatnonzero(self.rigid).tolist():
            stretch = float(a["tendon_length"][0, cable] - a["tendon_rest"][cable])
            if stretch + 2 * self.evidence.h * abs(float(rates[cable])) >= -ROUNDING:
                yield Unknown(-pulls[cable])
        efforts = loads.drive_efforts.wrenches(len(drives.kind), bodies)
        for i, kind in enumerate(drives.kind):
            if kind.limited and np.isnan(drives.slope[i]):
                yield Unknown(efforts[i], free=True, most=float(loads.limits[i, 0]))
        efforts = loads.friction_efforts.wrenches(len(joints.name), bodies)
        for j in joints.frictional[a["joint_sticks"][0, joints.frictional] == 1.0].tolist():
            most = joints.friction[j] + joints.coefficient[j] * carried(self.evidence, j)[0]
            yield Unknown(efforts[j], free=True, most=float(joints.static[j] * most))

    def _contacts(self) -> Iterator[Unknown]:
        a = self.arrays
        contacts = self.evidence.run.contacts
        for row, (normal, mu) in enumerate(zip(
                contacts.normal.tolist(), contacts.laws[1].tolist(), strict=True)):
            pair = int(a["contact_body"][row]), int(a["contact_other"][row])
            u = a["contact_normal"][row]
            left = np.array([-u[1], u[0]])
            places = pressed(self.evidence, row)
            if places is None:  # several normals: any resultant is possible
                at = a["contact_point"][row]
                for n, t in ((1.0, 0.0), (0.0, 1.0)):
                    yield Unknown(self._pair(*pair, at, n * u + t * left), free=True, contact=row,
                                  normal=n, tangential=t)
                yield Unknown(self._pair(*pair, at, 0 * u, 1.0), free=True, contact=row)
                continue
            for at in places:
                for t in (mu, -mu) if mu else (0.0,):
                    yield Unknown(self._pair(*pair, at, u + t * left), contact=row, normal=1.0,
                                  tangential=t, below=CONE * abs(normal))


def _reached(place: float, low: float, high: float, near: float) -> list[float]:
    """Signs of the pushes of the ends that are reached."""
    return [1.0] * (place <= low + near) + [-1.0] * (place >= high - near)


class Interval(NamedTuple):
    """A component of a contact force and its range [N]."""

    force: float
    low: float  # -inf without a bound; nan where no forces balance
    high: float
    allowed: tuple[float, float]  # Rounding error of either bound

    @property
    def excess(self) -> tuple[float, float]:
        """Distance below the least and above the largest [N]; 0 inside."""
        below, above = (np.inf if np.isnan(off) else max(off, 0.0)
                        for off in (self.low - self.force, self.force - self.high))
        return below, above

    @property
    def outside(self) -> bool:
        """Whether it exceeds rounding."""
        return any(off > most for off, most in zip(self.excess, self.allowed, strict=True))


class Bounds(NamedTuple):
    """The ranges of one contact row."""

    row: int  # Of the sample; contacts without a force have higher numbers
    body: int
    other: int
    normal: Interval
    tangential: Interval


def contact_bounds(evidence: Evidence, sample: int = -1, near: float | None = None) -> list[Bounds]:
    """Bounds of the contact rows in a sample, and of contacts without a force within ``near``."""
    unknowns = Unknowns(touched(evidence.alone(sample % len(evidence.run), near)))
    return sorted(bounds for bodies, forces in _groups(unknowns) if 3 * len(bodies) <= MAX_ROWS
                  for bounds in Balance(unknowns, bodies, forces, evidence.left_allowed).bounds())


def _groups(unknowns: Unknowns) -> list[tuple[list[int], list[Unknown]]]:
    """Free bodies with contacts that forces connect, and all unknown forces on them."""
    free = unknowns.model.bodies.free
    on = [np.flatnonzero(one.wrench.any(axis=1)).tolist() for one in unknowns.all]
    group = components(len(free), [(first, body) for first, *others in on for body in others])
    of = [group[bodies[0]] for bodies in on]
    return [([body for body in np.flatnonzero(free).tolist() if group[body] == number],
             [one for one, own in zip(unknowns.all, of, strict=True) if own == number])
            for number in sorted({own for one, own in zip(unknowns.all, of, strict=True)
                                  if one.contact >= 0})]


class Balance:
    """The balance of a group as a linear program: W f = target on all bodies.

    Moments count over a length. A force of either sign is p - q with p, q >= 0, limited by p + q +
    rest = most. Rows are the ``motions``, combinations of balances in which forces work.
    """

    def __init__(
        self, unknowns: Unknowns, bodies: list[int], forces: list[Unknown], allowed: Array,
    ) -> None:
        self.unknowns, self.forces = unknowns, forces
        W = np.stack([one.wrench[bodies].ravel() for one in forces], axis=1)
        arms = np.abs(W[2::3][np.hypot(W[0::3], W[1::3]) > 0])
        scale = np.tile([1.0, 1.0, 1 / max(float(arms.max(initial=0.0)), 1e-6)], len(bodies))
        W *= scale[:, None]
        self.unit = np.maximum(np.linalg.norm(W, axis=0), 1e-300)  # of every force
        W /= self.unit
        target = scale * unknowns.target[bodies].ravel()
        rows = [one.contact for one in forces if one.contact >= 0]
        self.size = max(float(np.abs(target).max()), SMALLEST_SCALE, float(np.hypot(
            *unknowns.arrays["contact_force"][rows].T).max()))
        target /= self.size
        self.allowed = scale * allowed[[0, 0, 1]].T[bodies].ravel() / self.size
        self.signed = np.flatnonzero([one.free for one in forces])
        most = np.array([forces[i].most for i in self.signed]) * self.unit[self.signed] / self.size
        limited = np.flatnonzero(np.isfinite(most))
        left, values, _ = np.linalg.svd(W)
        rank = int(np.count_nonzero(values > RANK * values.max(initial=0.0)))
        self.motions, idle = left[:, :rank], left[:, rank:]
        self.idle = np.abs(target @ idle), np.abs(idle).T @ self.allowed
        n, both, k = len(forces), len(forces) + len(self.signed), len(limited)
        A = np.zeros((rank + k, both + k))
        A[:rank, :n] = self.motions.T @ W
        A[:rank, n:both] = -A[:rank, self.signed]
        for row, at in enumerate(limited):
            A[rank + row, [self.signed[at], n + at, both + row]] = 1.0
        self.right, self.most = np.append(self.motions.T @ target, most[limited]), most[limited]
        self.program = LinearProgram(A, self.right)

    def bounds(self) -> Iterator[Bounds]:
        """The bounds of every contact row of the group."""
        a, contacts = self.unknowns.arrays, self.unknowns.evidence.run.contacts
        balanced = self.balanced()
        for row in sorted({one.contact for one in self.forces if one.contact >= 0}):
            parts = []
            for name in ("normal", "tangential"):
                weight = np.array([getattr(one, name) if one.contact == row else 0.0
                                   for one in self.forces]) / self.unit
                force = float(getattr(contacts, name)[row])
                if not balanced:
                    parts.append(Interval(force, np.nan, np.nan, (0.0, 0.0)))
                    continue
                (low, below), (high, above) = self.minimum(weight), self.minimum(-weight)
                parts.append(Interval(force, low, 0.0 - high, (below, above)))
            yield Bounds(row, int(a["contact_body"][row]), int(a["contact_other"][row]), *parts)

    def balanced(self) -> bool:
        """Whether there are forces that balance the sample, to rounding."""
        program, m = self.program, self.motions.shape[1]
        against = np.abs(self.motions @ program.against[:m]) @ self.allowed
        against += np.abs(program.against[m:]) @ (EXACT * self.most) + EXACT
        return bool(program.missing <= against and (self.idle[0] <= self.idle[1] + EXACT).all())

    def minimum(self, weight: Array) -> tuple[float, float]:
        """The minimum of a weighted sum of all forces [N], and its rounding error.

        Forces that balance up to d, and are negative by at most e, have a sum of at least
        y (target + d) - (c - G^T y) e.
        """
        scale = float(np.abs(weight).max())
        if scale == 0.0:  # no friction
            return 0.0, EXACT * self.size
        c, n, m = weight / scale, len(weight), self.motions.shape[1]
        found = self.program.minimum(np.concatenate([c, -c[self.signed], np.zeros(len(self.most))]))
        if np.isinf(found.value):
            return -np.inf, 0.0
        y, below = self.motions @ found.prices[:m], [one.below for one in self.forces] * self.unit
        slack = np.maximum(found.reduced[:n], 0.0) @ below + self.size * (
            np.abs(y) @ self.allowed + np.abs(found.prices) @ np.abs(self.program.b - self.right)
            + EXACT * (1 + np.abs(y).sum()))
        return scale * self.size * found.value, scale * float(slack)


@Check("contact.bounds", "N", "minimum and maximum f with m a = Σ F, |t| <= μ n",
       asks="is each contact force within the range that balance and friction allow?",
       compared="distance of contact forces at the end from the range that balance and friction "
                "allow, {count:component}, worst: {where}",
       none=f"more than {MAX_ROWS // 3} bodies are connected")
def _contact_bounds(evidence: Evidence, worst: Worst) -> None:
    normal, names = evidence.last.run.contacts.normal, evidence.model.bodies.name
    twist, count = np.nan_to_num(evidence.last.arrays["contact_twist"]), len(normal)
    if not count:
        worst.left_out.append("nothing touches at the end")
    elif (np.abs(twist) > ROUNDING * normal).any():
        worst.left_out.append("bodies meet in the last step, away from their pose")
        return
    elif count > MANY:
        worst.left_out.append(f"more than {MANY} contacts at the end, which take minutes; "
                              "`sandbox bounds RUN` computes their ranges")
    for found in contact_bounds(evidence) if 0 < count <= MANY else ():
        for kind, part in (("normal", found.normal), ("tangential", found.tangential)):
            worst.add(f"{names[found.body]}/{names[found.other]}.{kind}",
                      np.array(part.excess), np.maximum(part.allowed, ROUNDING))


def push_limits(
    evidence: Evidence, body: int, directions: Sequence[float], sample: int = -1,
) -> Array:
    """The largest push of a body at its centre of mass that balance allows [N], by direction [rad].

    inf without a bound; nan where no forces balance the sample; 0 where nothing touches the body.
    """
    unknowns, found = Unknowns(touched(evidence.alone(sample % len(evidence.run)))), []
    bodies, forces = next((each for each in _groups(unknowns) if body in each[0]), ([], []))
    for angle in directions if bodies else ():
        push = Unknown(np.zeros_like(unknowns.target))
        push.wrench[body] = np.cos(angle), np.sin(angle), 0.0
        balance = Balance(unknowns, bodies, [*forces, push], evidence.left_allowed)
        weight = np.append(np.zeros(len(forces)), -1.0 / balance.unit[-1])
        lowest, slack = balance.minimum(weight) if balance.balanced() else (np.nan, 0.0)
        found.append(0.0 if abs(lowest) <= slack else -lowest)
    return np.array(found) if bodies else np.zeros(len(directions))
