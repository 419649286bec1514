"""One time step of a mechanism by dense algebra, written independently of the engine.

Every element is a function of the bodies' poses q (centres of mass). Gaps of joints and limits and
lengths of springs and tendons are differentiated by the complex step, exact to rounding.

    M (v+ - v) = h f + J^T p            with, row by row,
    joints                              gap(q + h v+) = 0
    hinge dampers                       D v+ + D v + 2 p / (h c) = 0
    damped springs and tendons          D v+ + D v + 2 p / (h c) = 2 k (L - L0) / c
    stiff springs and tendons           D v+ + p / (h (c + h k)) = k (L - L0) / (c + h k)
    limits, contacts                    0 <= p,  y = max(gap / h, -fastest) + C v+ >= 0,  p y = 0
    friction                            |p_t| <= mu p_n, against the slip
    motors, brakes                      |p| <= h most, y = D v+ - wanted = 0 or driven against y

The engine's velocities decide which rows are active; the equations are solved for that choice, and
its inequalities are verified.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from sandbox.engine.records import DAMPED, ELASTIC, PULL, STIFF
from sandbox.model.model import Model

FASTEST, FASTEST_TURN = 0.1, 1.0
"""How fast overlaps are undone [m/s, rad/s]."""
LEVER = 0.1
"""Slower in proportion where joints leave less of an impulse's effect than this share."""
Gap = Callable[[np.ndarray], Any]


class Disc(NamedTuple):
    """A disc about a body's origin, over a fixed floor."""

    body: int
    radius: float
    top: float
    friction: float


class Row(NamedTuple):
    """An equation ``J v + compliance p = asked``, or with bounds where it is one of ``choices``."""

    J: np.ndarray
    asked: float
    compliance: float = 0.0


class Answer(NamedTuple):
    """Velocities after the step [nb, 3]."""

    velocity: np.ndarray
    sway: float
    """Largest change of a velocity if every joint's rate is wrong by 1."""


def place(model: Model, q: np.ndarray, body: int, at: Any) -> np.ndarray:
    """A point of a body's frame in the world, [2]."""
    x, y, angle = q[body]
    dx, dy = np.asarray(at) - model.bodies.centre[body]
    c, s = np.cos(angle), np.sin(angle)
    return np.array([x + c * dx - s * dy, y + s * dx + c * dy])


def distance(a: np.ndarray, b: np.ndarray) -> Any:
    return np.sqrt(((b - a) ** 2).sum())


def derivative(of: Gap, q: np.ndarray) -> np.ndarray:
    """By every coordinate, [3 nb]."""
    found = np.zeros(q.size)
    for i in range(q.size):
        moved = q.astype(complex)
        moved.ravel()[i] += 1e-30j
        found[i] = np.imag(of(moved)) / 1e-30
    return found


def joint_gaps(model: Model) -> list[tuple[tuple[str, int], Gap]]:
    """Gaps that joints keep at zero."""
    joints, found = model.joints, []
    for j, kind in enumerate(joints.kind):
        a, b = joints.bodies[j].tolist()
        on_a, on_b = joints.anchor[j]
        turn = model.bodies.pose[b, 2] - model.bodies.pose[a, 2]
        if kind.keeps == "point":
            for axis in range(2):
                found.append(((f"joint{'xy'[axis]}", j), lambda q, a=a, b=b, on_a=on_a, on_b=on_b,
                              axis=axis: (place(model, q, b, on_b)
                                          - place(model, q, a, on_a))[axis]))
        if kind.keeps == "groove":
            found.append((("joint", j), lambda q, j=j: along_groove(model, q, j)[1]))
        if kind.keeps == "distance":
            found.append((("joint", j), lambda q, a=a, b=b, on_a=on_a, on_b=on_b, j=j: distance(
                place(model, q, a, on_a), place(model, q, b, on_b)) - joints.reach[j, 0]))
        if not joints.turns[j]:
            found.append((("turn", j), lambda q, a=a, b=b, turn=turn: q[b, 2] - q[a, 2] - turn))
    return found


def along_groove(model: Model, q: np.ndarray, j: int) -> tuple[Any, Any]:
    """Way of b's point along a groove from its start, and across it to the left."""
    joints = model.joints
    a, b = joints.bodies[j]
    start, end = (place(model, q, a, point) for point in joints.groove[j])
    unit = (end - start) / math.hypot(*(joints.groove[j, 1] - joints.groove[j, 0]))
    off = place(model, q, b, joints.anchor[j, 1]) - start
    return unit @ off, unit[0] * off[1] - unit[1] * off[0]


def limit_gaps(model: Model) -> list[tuple[tuple[Any, ...], Gap, float]]:
    """What limits keep from becoming negative, and how fast they come back."""
    joints, found = model.joints, []
    for j, kind in enumerate(joints.kind):
        a, b = joints.bodies[j].tolist()
        on_a, on_b = joints.anchor[j]
        if np.isfinite(joints.stops[j]).all():
            for sign, bound in ((1, joints.stops[j, 0]), (-1, joints.stops[j, 1])):
                found.append((("stop", j), lambda q, a=a, b=b, j=j, sign=sign, bound=bound: sign * (
                    joints.sense[j] * (q[b, 2] - q[a, 2]) - joints.zero[j] - bound), FASTEST_TURN))
        if kind.keeps == "range":
            for sign, bound in ((1, joints.reach[j, 0]), (-1, joints.reach[j, 1])):
                if math.isfinite(bound):
                    found.append((("line", j), lambda q, a=a, b=b, on_a=on_a, on_b=on_b, sign=sign,
                                  bound=bound: sign * (distance(
                                      place(model, q, a, on_a), place(model, q, b, on_b)) - bound),
                                  FASTEST))
        if kind.keeps == "groove":
            length = math.hypot(*(joints.groove[j, 1] - joints.groove[j, 0]))
            found.append((("line", j), lambda q, j=j: along_groove(model, q, j)[0], FASTEST))
            found.append((("line", j), lambda q, j=j, length=length: (
                length - along_groove(model, q, j)[0]), FASTEST))
    return found


def cord_length(model: Model, q: np.ndarray, t: int) -> Any:
    """Of a cord through eyes."""
    tendons = model.tendons
    points = [place(model, q, tendons.guide_body[g], tendons.guide_at[g])
              for g in range(tendons.first[t], tendons.first[t + 1])]
    return sum(distance(a, b) for a, b in itertools.pairwise(points))


def spring_length(model: Model, q: np.ndarray, s: int) -> Any:
    a, b = model.springs.bodies[s]
    return distance(place(model, q, a, model.springs.anchor[s, 0]),
                    place(model, q, b, model.springs.anchor[s, 1]))


class Step:
    """The equations of one step at poses q [nb, 3] and velocities v [nb, 3], in the model's order.

    ``kinds`` are the engine's choices for tendons and linear springs; ``drive`` the drives' values;
    ``given`` the velocities of bodies that do not move freely.
    """

    def __init__(
        self, model: Model, h: float, q: np.ndarray, v: np.ndarray, *, drive: Any = (),
        given: np.ndarray | None = None, kinds: dict[str, list[int]], discs: tuple[Disc, ...] = (),
    ) -> None:
        self.model, self.h, self.q, self.v = model, h, q, v
        self.free = np.repeat(model.bodies.free, 3)
        self.given = np.zeros(q.size) if given is None else np.asarray(given, dtype=float).ravel()
        bodies = model.bodies
        weights = np.stack([bodies.mass, bodies.mass, bodies.inertia], axis=1).ravel()
        self.mass = np.where(self.free, weights, 0.0)
        self.force = self.mass * np.tile([*model.mechanism.gravity, 0.0], len(q))
        self.soft: dict[tuple[str, int], Row] = {}
        self.joints = [(name, gap, derivative(gap, q)) for name, gap in joint_gaps(model)]
        self.choices: list[tuple[tuple[str, int], Any]] = []
        self._springs(kinds["springs"], drive)
        self._cords(kinds["cords"], drive)
        self._hinges(drive)
        for name, gap, fastest in limit_gaps(model):
            self.choices.append((name, ("limit", derivative(gap, q),
                                        max(np.real(gap(q)) / h, -fastest))))
        for n, disc in enumerate(discs):
            self._contact(n, disc)

    def _springs(self, kinds: list[int], drive: Any) -> None:
        springs = self.model.springs
        for s in np.flatnonzero(springs.straight).tolist():
            def length(q: np.ndarray, s: int = s) -> Any:
                return spring_length(self.model, q, s)

            k = springs.stiffness[s] if springs.drive[s] < 0 else drive[springs.drive[s]]
            self._elastic(("spring", s), length, k, springs.damping[s], springs.rest[s],
                          kinds.pop(0), cord=False)
        for s in np.flatnonzero(~springs.straight).tolist():
            j = springs.joint[s]
            D, angle = self._hinge(j)
            k = springs.stiffness[s] if springs.drive[s] < 0 else drive[springs.drive[s]]
            self.force += D * -k * (angle - springs.rest[s])

    def _cords(self, kinds: list[int], drive: Any) -> None:
        tendons = self.model.tendons
        for t, kind in enumerate(kinds):
            def length(q: np.ndarray, t: int = t) -> Any:
                return cord_length(self.model, q, t)

            if kind == PULL:
                self.force -= derivative(length, self.q) * drive[tendons.drive[t]]
                continue
            rest = cord_length(self.model, com(self.model), t) if np.isnan(
                tendons.rest[t]) else tendons.rest[t]
            setter = tendons.stiffener[t]
            k = tendons.stiffness[t] if setter < 0 else drive[setter]
            self._elastic(("cord", t), length, k, tendons.damping[t],
                          rest + tendons.slack[t], kind, cord=True)

    def _elastic(
        self, name: tuple[str, int], length: Gap, k: float, c: float, rest: float, kind: int, *,
        cord: bool,
    ) -> None:
        stretch, D = np.real(length(self.q)) - rest, -derivative(length, self.q)
        if cord and stretch <= 0:
            return
        if kind == ELASTIC:
            self.force += D * k * stretch
            return
        if kind == DAMPED:
            row = Row(D, 2 * k * stretch / c - D @ self.v.ravel(), 2 / (self.h * c))
        else:
            assert kind == STIFF
            row = Row(D, k * stretch / (c + self.h * k), 1 / (self.h * (c + self.h * k)))
        if cord:
            self.choices.append((name, ("cord", row)))
        else:
            self.soft[name] = row

    def _hinge(self, j: int) -> tuple[np.ndarray, float]:
        """The row of a hinge's rate, and its angle, in its positive sense."""
        joints = self.model.joints
        a, b = joints.bodies[j]
        D = np.zeros(self.q.size)
        D[3 * a + 2], D[3 * b + 2] = -joints.sense[j], joints.sense[j]
        return D, D @ self.q.ravel() - joints.zero[j]

    def _hinges(self, drive: Any) -> None:
        model, h = self.model, self.h
        strength = model.joints.damping.copy()
        rotary = np.flatnonzero(~model.springs.straight)
        np.add.at(strength, model.springs.joint[rotary], model.springs.damping[rotary])
        for j in np.flatnonzero(strength > 0).tolist():
            D, _ = self._hinge(j)
            self.soft["damper", j] = Row(D, -D @ self.v.ravel(), 2 / (h * strength[j]))
        for d, spec in enumerate(model.mechanism.drives):
            if spec.type == "torque":
                self.force += self._hinge(model.drives.target[d])[0] * drive[d]
            if spec.type == "force":
                body, angle = model.drives.target[d], 0.0
                if model.drives.turning[d]:
                    angle = self.q[body, 2]
                turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
                push = drive[d] * turn @ model.drives.direction[d]
                self.force += push @ np.array([derivative(
                    lambda q, n=n, body=body, d=d: place(model, q, body, model.drives.at[d])[n],
                    self.q) for n in range(2)])
            if spec.type in ("motor", "brake"):
                D, _ = self._hinge(model.drives.target[d])
                motor = spec.type == "motor"
                self.choices.append((("drive", d), (
                    "motor", D, -drive[d] if motor else 0.0,
                    h * (spec.torque if motor else drive[d]))))

    def _contact(self, n: int, disc: Disc) -> None:
        """A disc over a floor: the force acts half way between the two surfaces' points."""
        x, y = place(self.model, self.q, disc.body, (0.0, 0.0))
        gap = y - disc.radius - disc.top
        arm = np.array([x, (y - disc.radius + disc.top) / 2]) - self.q[disc.body, :2]
        up, right = np.zeros(self.q.size), np.zeros(self.q.size)
        up[3 * disc.body:3 * disc.body + 3] = 0.0, 1.0, arm[0]
        right[3 * disc.body:3 * disc.body + 3] = 1.0, 0.0, -arm[1]
        self.choices.append((("contact", n), (
            "contact", up, max(gap / self.h, -FASTEST), right, disc.friction)))

    # -- solving ------------------------------------------------------------------------

    def answer(self, velocity: np.ndarray, tol: float = 1e-8) -> Answer | None:
        """The one in which that rests, sticks and is taut which does so with ``velocity`` [nb, 3].

        None if it breaks a condition: rates to ``tol`` [m/s, rad/s].
        """
        v = velocity.ravel()
        taut = [what[1] for _, what in self.choices
                if what[0] == "cord" and self._mode(what, v, 0.0) == "taut"]
        choices = [(name, self._calm(what, taut)) for name, what in self.choices]
        tried = (self._solve(choices, [self._mode(what, v, still) for _, what in choices], tol)
                 for still in (1e-6, 1e-5, 1e-4, 1e-3))
        return next((found for found in tried if found), None)

    def _calm(self, what: Any, taut: list[Row]) -> Any:
        """A limit or contact that asks an overlap back no faster than what throws no body."""
        if what[0] not in ("limit", "contact") or what[2] >= 0:
            return what
        D, free, mass = what[1], self.free, self.mass[self.free]
        rows = [*(Row(J, 0.0) for *_, J in self.joints), *self.soft.values(), *taut]
        J = np.array([row.J[free] for row in rows]).reshape(len(rows), -1)
        rates = (J / mass) @ D[free]
        kept = np.linalg.lstsq(
            (J / mass) @ J.T + np.diag([row.compliance for row in rows]), rates)[0]
        alone = D[free] @ (D[free] / mass)
        share = (alone - rates @ kept) / alone
        return (*what[:2], what[2] * min(1.0, share / LEVER), *what[3:])

    def _mode(self, what: Any, v: np.ndarray, still: float) -> Any:
        if what[0] == "cord":
            return "taut" if what[1].asked > what[1].J @ v else "slack"
        y = what[1] @ v + what[2]
        if what[0] == "limit":
            return "held" if y < still else "free"
        if what[0] == "motor":
            return "hold" if abs(y) < still else "low" if y > 0 else "high"
        if y > still:
            return "open"
        slip = what[3] @ v
        return "stick" if abs(slip) < still else "left" if slip > 0 else "right"

    def _solve(self, choices: list[Any], chosen: list[str], tol: float) -> Answer | None:
        names = [*self.soft]
        rows, pushes = [*self.soft.values()], [row.J for row in self.soft.values()]
        known = np.zeros(self.q.size)
        for (name, what), mode in zip(choices, chosen, strict=True):
            for label, row, push in self._rows(name, what, mode):
                names.append(label)
                rows.append(row)
                pushes.append(push)
            if what[0] == "motor" and mode != "hold":
                known += what[1] * (what[3] if mode == "high" else -what[3])
        asked = [-np.real(gap(self.q)) / self.h for _, gap, _ in self.joints]
        for closing in range(16):
            every = [Row(J, x) for (_, _, J), x in zip(self.joints, asked, strict=True)] + rows
            labels = [name for name, *_ in self.joints] + names
            v, p, sway = self._linear(every, [J for *_, J in self.joints] + pushes, known)
            if v is None:
                return None
            impulse = dict(zip(labels, p, strict=True))
            if not all(self._holds(name, what, mode, v, impulse, tol if closing else 1.0)
                       for (name, what), mode in zip(choices, chosen, strict=True)):
                return None
            there = self.q + self.h * v.reshape(self.q.shape)
            left = [np.real(gap(there)) / self.h for _, gap, _ in self.joints]
            if closing and max(map(abs, left), default=0.0) * self.h < 1e-15:
                break
            asked = [x - y for x, y in zip(asked, left, strict=True)]
        return Answer(v.reshape(self.q.shape), float(sway.max()))

    def _rows(self, name: Any, what: Any, mode: str) -> list[tuple[Any, Row, np.ndarray]]:
        """The equations that a mode sets, and how their impulses push."""
        if what[0] == "cord" and mode == "taut":
            return [(name, what[1], what[1].J)]
        if what[0] == "limit" and mode == "held":
            return [(name, Row(what[1], -what[2]), what[1])]
        if what[0] == "motor" and mode == "hold":
            return [(name, Row(what[1], -what[2]), what[1])]
        if what[0] == "contact" and mode != "open":
            _, up, want, right, friction = what
            if mode == "stick":
                return [((*name, "n"), Row(up, -want), up), ((*name, "t"), Row(right, 0.0), right)]
            sign = {"left": -1, "right": 1}[mode]
            return [((*name, "n"), Row(up, -want), up + sign * friction * right)]
        return []

    def _linear(
        self, rows: list[Row], pushes: list[np.ndarray], known: np.ndarray,
    ) -> tuple[np.ndarray | None, np.ndarray, np.ndarray]:
        """Velocities and impulses of a set of equations, and how far joints can shift each."""
        n, m, free = int(self.free.sum()), len(rows), self.free
        J = np.array([row.J for row in rows]).reshape(m, -1)
        P = np.array(pushes).reshape(m, -1)
        v = np.where(free, 0.0, self.given)
        A = np.zeros((n + m, n + m))
        A[:n, :n] = np.diag(self.mass[free])
        A[:n, n:] = -P[:, free].T
        A[n:, :n] = J[:, free]
        A[n:, n:] = np.diag([row.compliance for row in rows])
        b = np.concatenate([
            (self.mass * self.v.ravel())[free] + self.h * self.force[free] + known[free],
            np.array([row.asked for row in rows]) - J @ v])
        try:
            inverse = np.linalg.inv(A)
        except np.linalg.LinAlgError:
            return None, np.zeros(0), np.zeros(0)
        x = np.linalg.solve(A, b)
        v[free] = x[:n]
        return v, x[n:], np.abs(inverse[:n, n:n + len(self.joints)]).sum(axis=1)

    def _holds(
        self, name: Any, what: Any, mode: str, v: np.ndarray, impulse: Any, tol: float,
    ) -> bool:
        """Whether the signs of a mode are right, impulses as the rates that they would make."""
        kind, small = what[0], tol * self.mass[self.free].min()
        if kind == "cord":
            row = what[1]
            return bool(impulse[name] >= -small if mode == "taut" else row.asked - row.J @ v <= tol)
        if kind == "limit":
            y = what[1] @ v + what[2]
            return bool(impulse[name] >= -small if mode == "held" else y >= -tol)
        if kind == "motor":
            if mode == "hold":
                return bool(abs(impulse[name]) <= what[3] + small)
            y = what[1] @ v + what[2]
            return bool(y >= -tol if mode == "low" else y <= tol)
        _, up, want, right, friction = what
        if mode == "open":
            return bool(up @ v + want >= -tol)
        normal = impulse[(*name, "n")]
        if mode == "stick":
            return bool(abs(impulse[(*name, "t")]) <= friction * normal + small)
        slip = right @ v
        return bool(normal >= -small and (slip >= -tol if mode == "left" else slip <= tol))


def com(model: Model) -> np.ndarray:
    """Poses of the centres of mass at t = 0, [nb, 3]."""
    pose = model.bodies.pose.copy()
    for body, (cx, cy) in enumerate(model.bodies.centre):
        c, s = math.cos(pose[body, 2]), math.sin(pose[body, 2])
        pose[body, :2] += c * cx - s * cy, s * cx + c * cy
    return pose
