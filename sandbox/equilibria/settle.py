"""Static equilibrium by a slow load, kinetic damping, then Newton's method.

Kinetic damping: bodies move with the engine's steps until their kinetic energy passes a peak, where
forces balance along the motion and all are stopped.

Constraints (joints, pressing contacts, limits, sticking friction) leave motions Z free. One step of
the engine from rest gives the acceleration a under all forces; the residual along Z is Z^T M a,
since constraint forces do no work there. Everything else has a stiffness K
(:mod:`sandbox.samples.stiffness`). In equilibrium Z^T M a = 0; it is stable if all w^2 of
Z^T K Z z = w^2 Z^T M Z z are positive.

The engine evaluates stiff springs and tendons at the end of the step, dampers at its middle: along
them forces have already dropped by e a, e = h (c + h k) or h c / 2, which is added again.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import eigvalsh, null_space

from sandbox.audit.rest import beyond_joint
from sandbox.engine.records import ELASTIC, EVEN, STIFF
from sandbox.engine.stiffness import spring_kinds, stiff_cables, stiff_servos
from sandbox.engine.still import Still
from sandbox.errors import Problem, SceneError
from sandbox.model.joints import placed
from sandbox.model.model import Model
from sandbox.model.pairs import friction_of
from sandbox.numeric import Array, Integers
from sandbox.recording.recording import Recording
from sandbox.samples.stiffness import NOTHING, Linearization, without_stiffness
from sandbox.scene.geometry import reach_of
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import listed, near, quoted

RANK = 1e-9  # relative size of directions, and of stiffness, that are rounding


class PoseBalance:
    """Residual forces, free motions and stiffness at a pose.

    ``run`` is one step of ``still`` from rest; ``size`` [m] is the length equivalent to 1 rad.
    """

    def __init__(self, still: Still, run: Recording, size: float) -> None:
        self.still, self.run, self.size = still, run, size
        self.linear = Linearization(run, 0, size)
        self.bodies: Integers = (bodies := np.flatnonzero(run.model.bodies.free))
        self.scale = np.tile([1.0, 1.0, 1 / size], len(bodies))
        self.mass = still.mass[bodies].reshape(-1)
        kept = np.array(self.linear.kept).reshape(-1, len(self.mass)) * self.scale
        length = np.linalg.norm(kept, axis=1, keepdims=True)
        self._rows = (kept / np.maximum(length, 1e-300))[length[:, 0] > 0]
        # motions that no constraint forbids, rotations as lengths, orthonormal [n, k]
        self.free: Array = null_space(self._rows, rcond=RANK)
        self.speed = still.speed[bodies].reshape(-1)  # velocities after the step from rest, [n]
        # stiffness of all motions [n, n], and of the free ones [k, k], N/m
        self.whole = np.asarray(self.scale * self.linear.stiffness * self.scale[:, None])
        self.stiffness = self.free.T @ self.whole @ self.free
        self.force = self.scale * self._force()  # residual forces, with constraint forces, [n] N
        self.largest = self.linear.largest  # the largest force on anything [N]
        self.left = self.free.T @ self.force  # residual forces along free motions, [k] N

    def _force(self) -> Array:
        """M a, corrected for forces at the end of the step, [n]."""
        model, h = self.still.model, self.still.step_size
        a = self.speed / h
        force = self.mass * a
        follows_law = [law is not None for law in model.springs.law]
        ways: dict[str, tuple[Any, Integers]] = {  # how the engine solves each element
            "spring": (model.springs, np.where(follows_law, STIFF, spring_kinds(model, h))),
            "tendon": (model.tendons, np.where(stiff_cables(model, h), STIFF, ELASTIC)),
            "drive": (model.drives, np.where(stiff_servos(model, h), STIFF, EVEN))}
        for each in self.linear.elastic():
            elements, kinds = ways[each.kind]
            c, kind = float(elements.damping[each.number]), int(kinds[each.number])
            k = {STIFF: 4.0, EVEN: 1.0, ELASTIC: 0.0}[kind] * each.stiffness / 4
            drop = h * (c * (1.0 if kind == STIFF else 0.5) + h * k)  # e [kg]
            force = force + drop * float(each.pull @ a) * each.pull
        return np.asarray(force)

    def closing(self) -> Array:
        """The motion across free motions that closes gaps of constraints, [n] scaled."""
        gaps = self._rows @ (self.speed / self.scale) * self.still.step_size
        return solve(self._rows, gaps)

    def pose_after(self, pose: Array, motion: Array) -> Array:
        """A pose after a motion [n], scaled, [nb, 3]."""
        after = pose.copy()
        after[self.bodies] += (self.scale * motion).reshape(-1, 3)
        return after

    @cached_property
    def soft(self) -> tuple[Array, Array, float]:
        """Stiffness values in ascending order, their motions, and the value that counts as 0."""
        stiffness = (self.stiffness + self.stiffness.T) / 2
        return (*np.linalg.eigh(stiffness), NOTHING * self.largest / self.size)

    @property
    def stable(self) -> bool:
        """Whether no motion is unstable, up to rounding."""
        values, _, zero = self.soft
        return not len(values) or bool(values[0] >= -zero)

    def modes(self) -> Array:
        """w^2 of small free motions in ascending order [1/s^2]."""
        inertia = self.free.T @ (self.scale**2 * self.mass * self.free.T).T
        return np.asarray(eigvalsh((self.stiffness + self.stiffness.T) / 2, inertia))


def solve(matrix: Array, right: Array) -> Array:
    """The smallest solution, without directions that the matrix hardly affects, [n]."""
    return np.asarray(np.linalg.lstsq(matrix, right, rcond=RANK)[0])


STAGES, FRICTION_STAGES = 40, 200  # stages of a slow load, without and with dry friction
MAX_STEPS = 20_000  # of one relaxation
REST = 1e-12  # motion in a step from rest, relative to the size, of a mechanism at rest
NEAR = (1e-7, 1e-9)  # the same of one that is near enough for Newton's method
BALANCED = 1e-9  # residual along free motions in equilibrium, relative to the largest force
CLOSE = 1e-6  # the same where Newton's method does not converge, as where something just touches
MAX_ITERATIONS = 25  # of Newton's method; near an equilibrium four are enough
EXACT = 1e-11  # motion, relative to the size, at which Newton's method ends; gaps close to 1e-13 m
BLOCK = 4  # steps between two evaluations of the energy
MAX_WAY = 0.02  # longest motion of a point in a step, relative to the size
FAR, TURNS = 10.0, 60.0  # motion of a body that nothing holds: times the size, and [rad]
PUSH = 4e-5  # step of scheduled bodies [m]: the engine removes an overlap at 0.1 m/s
TURN = 0.02  # rotation of a hinge in one step [rad]
CLOSING = 4  # further steps that close a loop
PARTS = {"x": 0, "y": 1, "angle": 2}
Start = Mapping[str, float]  # JOINT.angle, BODY.x, BODY.y, BODY.angle to values [rad, m]


class Unsettled(Exception):
    """A start that does not come to rest, with the reason."""


class Settler:
    """A mechanism with drives and scheduled bodies as at one time [s]; finds equilibria."""

    def __init__(self, mechanism: Mechanism, time: float) -> None:
        self.still, self.time = Still(mechanism), time
        self.model: Model = self.still.model
        self._free = self.model.bodies.free
        if not self._free.any():
            raise SceneError([Problem("no-rest",
                                      "nothing moves freely: there is no equilibrium to find",
                                      "bodies")])
        self.first = self.still.pose  # the pose of the scene, [nb, 3]
        self._reach = _reaches(self.model)
        low = (self.first[self._free, :2] - self._reach[self._free, None]).min(axis=0)
        high = (self.first[self._free, :2] + self._reach[self._free, None]).max(axis=0)
        self.size = float(max((high - low).max(), 1e-6))  # largest extent of what moves [m]
        self._most = min(self.still.margin / 2, MAX_WAY * self.size)
        self.drive, self.places = self.still.driven(time)
        self.steps = 0  # steps of the engine so far
        self.advice = ""  # what to try if the last drives have no equilibrium
        self.remark = ""  # a remark about a slow load that passed no equilibrium
        self.untold = _no_stiffness(self.model)  # why the stiffness is unknown, or empty

    def follow(self, stages: int | None = None) -> None:
        """Apply the drives slowly from the scene's pose, in ``stages`` that come to rest each."""
        self.still.put(self.first)
        model = self.model
        shaped = [i for i, body in enumerate(model.mechanism.bodies) if body.shapes]
        rough = len(model.joints.frictional) or len(model.tendons.grips) or any(
            friction_of(model.mechanism, i, k) > 0 for i in shaped for k in shaped
            if i < k and (model.bodies.free[i] or model.bodies.free[k]))
        stages = stages or (FRICTION_STAGES if rough else STAGES)
        last: Array | None = None
        for time in np.linspace(0.0, self.time, stages + 1):
            drive, places = self.still.driven(float(time))
            moved = np.any(self.still.pose[self.still.scheduled] != places)
            if last is not None and np.array_equal(last, drive) and not moved:
                continue
            self._push(places, drive)
            try:
                self._relax(drive, MAX_STEPS // 4, NEAR[0])
            except Unsettled as why:
                if not self.remark and time < self.time:
                    self.remark = (f"with the drives as at t = {time:.3g} s it does not come to "
                                   f"rest, {why}: what follows depends on more than a slow load")
                    self.advice = f"it rests until t = {time:.3g} s: --at sets the time of " \
                        "the drives" if time else ""
            last = drive

    def start(self, pose: Array) -> None:
        """Put the free bodies at a pose, [nb, 3], with drives as at the time."""
        begin = np.where(self._free[:, None], pose, self.first)
        begin[self.still.scheduled] = self.places
        self.still.put(begin)

    def settle(self) -> PoseBalance | None:
        """Come to rest from the present pose; None where the stiffness is unknown."""
        for rest in NEAR if not self.untold else ():
            self._relax(self.drive, MAX_STEPS, rest)
            pose = self.still.pose
            try:
                found = self.polished()
            except ArithmeticError as error:
                self.untold = str(error)
                break
            if found is not None and found.stable:
                return found
            self.still.put(pose)
        self._relax(self.drive, MAX_STEPS, REST)
        if self.untold:
            return None
        if (found := self.polished()) is not None:
            return found
        found = self.look()
        left = np.abs(found.left).max(initial=0.0)
        return found if left <= CLOSE * found.largest else None

    def polished(self) -> PoseBalance | None:
        """Newton's method from the present pose; None, and the pose unchanged, if it fails."""
        pose, balance = self.still.pose, self.look()
        for _ in range(MAX_ITERATIONS):
            motion = balance.free @ solve(balance.stiffness, balance.left) + balance.closing()
            way = float(np.abs(motion).max(initial=0.0))
            if way <= EXACT * self.size:
                left = np.abs(balance.left).max(initial=0.0)
                if left <= BALANCED * max(balance.largest, 1e-9):
                    return balance
                break
            self.still.put(balance.pose_after(self.still.pose, motion * min(1.0, self._most / way)))
            balance = self.look()
        self.still.put(pose)
        return None

    def look(self) -> PoseBalance:
        """The balance at the present pose, where the bodies are left at rest."""
        pose = self.still.pose
        self.still.put(pose)
        self.still.move(self.drive, kept=True)
        found = PoseBalance(self.still, self.still.recording(), self.size)
        self.still.put(pose)
        return found

    def _relax(self, drive: Array, steps: int, rest: float) -> None:
        """Kinetic damping until steps move less than ``rest``; otherwise :class:`Unsettled`."""
        still, begin = self.still, self.still.pose
        last, fresh, until = 0.0, True, self.steps + steps
        still.slow(0.0)
        while True:
            count = 1 if fresh else BLOCK
            still.move(drive, count=count)
            self.steps += count
            speed = still.speed
            fastest = np.hypot(speed[:, 0], speed[:, 1]) + self._reach * np.abs(speed[:, 2])
            way = still.step_size * np.where(self._free, fastest, 0.0)
            worst = int(np.argmax(way))
            if fresh and way[worst] <= rest * self.size:
                still.slow(0.0)
                return
            x, y, turn = np.abs((still.pose - begin)[worst])
            if self.steps >= until or max(x, y) > FAR * self.size or turn > TURNS:
                still.slow(0.0)
                raise Unsettled(self._still_moving(drive, worst))
            energy = float((still.mass[self._free] * speed[self._free] ** 2).sum() / 2)
            if not fresh and energy < last:
                still.slow(0.0)
                last, fresh = 0.0, True
                continue
            last, fresh = energy, False
            if way[worst] > self._most:
                share = self._most / float(way[worst])
                still.slow(share)
                last *= share * share

    def _still_moving(self, drive: Array, body: int) -> str:
        drives, name = self.model.drives, quoted(self.model.bodies.name[body])
        moved = (self.still.pose - self.first)[body]
        for i, kind in enumerate(drives.kind):
            if kind.unit in ("rad/s", "m/s") and drive[i] != 0:
                return f"the drive {quoted(drives.name[i])} goes on for ever, and {name} with it"
        if (gone := float(np.hypot(*moved[:2]))) > self.size:
            return f"nothing holds {name}: it has gone {gone:.3g} m and goes on"
        if abs(moved[2]) > TURNS:
            return f"nothing holds {name}: it turns on and on"
        return f"{name} still moves after {self.steps} steps"

    def _push(self, places: Array, drive: Array) -> None:
        """Move the scheduled bodies to their places, slowly."""
        on, still = self.still.scheduled, self.still
        begin = still.pose[on]
        way = places - begin
        far = np.abs(way[:, :2]).sum(axis=1) + self._reach[on] * np.abs(way[:, 2])
        count = int(np.ceil(far.max(initial=0.0) / PUSH))
        for k in range(1, count + 1):
            moved = still.pose + still.step_size * still.speed
            moved[on] = begin + way * k / count
            still.put(moved)
            still.move(drive)
        if count:
            pose = still.pose
            pose[on] = places
            still.put(pose)


def _no_stiffness(model: Model) -> str:
    """Why the stiffness of a mechanism is unknown; empty if it is known."""
    if len(model.tendons.grips):
        return "tendons with friction in their guides"
    why = without_stiffness(model)
    if why == "loads by laws" and not any(
            law is None or law.names & {*PARTS} for law in model.loads.law):
        return "teeth" if any(kind.teeth for kind in model.joints.kind) else ""
    return why


def _reaches(model: Model) -> Array:
    """Largest distance of any point of each body from its centre of mass, [nb] m."""
    centre, joints, springs, tendons = (
        model.bodies.centre, model.joints, model.springs, model.tendons)
    found = np.array([reach_of(body, (x, y)) for body, (x, y) in zip(
        model.mechanism.bodies, centre.tolist(), strict=True)])
    for bodies, at in ((joints.bodies, joints.anchor), (springs.bodies, springs.anchor),
                       (tendons.guide_body, tendons.guide_at)):
        np.maximum.at(found, bodies, np.nan_to_num(np.hypot(*(at - centre[bodies]).T).T))
    return found


def angles(model: Model) -> list[str]:
    """The angles of all hinges, by name."""
    return [f"{model.joints.name[j]}.angle" for j in model.joints.hinges.tolist()]


def positions(model: Model, without: Collection[int] = ()) -> list[str]:
    """The positions of all bodies that move freely, by name."""
    return [f"{model.bodies.name[i]}.{part}" for i in np.flatnonzero(model.bodies.free).tolist()
            if i not in without for part in PARTS]


def place_start(settler: Settler, start: Start) -> Array:
    """The pose of a start, [nb, 3] of the centres of mass; joined bodies move along."""
    model, still = settler.model, settler.still
    known = [*angles(model), *positions(model)]
    if wrong := [name for name in start if name not in known]:
        raise SceneError([Problem("name-not-found",
                                  f"{quoted(name)} cannot be given at the start", "from",
                                  allowed=listed(known) or "nothing", hint=near(name, known))
                          for name in wrong])
    still.put(settler.first)
    for name, value in start.items():
        element, _, part = name.rpartition(".")
        joint = model.names.joint.get(element)
        if joint is not None and part == "angle":
            _turn(settler, joint, value)
            continue
        # a body's frame; joints that this opens close as the mechanism comes to rest
        body = model.names.body[element]
        pose, centre = still.pose, model.bodies.centre[body]
        frame = pose[body].copy()
        frame[:2] = placed(pose[body], -centre)
        frame[PARTS[part]] = value
        pose[body, :2], pose[body, 2] = placed(frame, centre), frame[2]
        still.put(pose)
    return still.pose


def _turn(settler: Settler, joint: int, value: float) -> None:
    """Turn the bodies beyond a hinge rigidly; in a loop all joints give way."""
    joints, still = settler.model.joints, settler.still
    sense, (a, b) = float(joints.sense[joint]), joints.bodies[joint].tolist()

    def missing() -> float:
        return value - float(sense * (still.pose[b, 2] - still.pose[a, 2]) - joints.zero[joint])

    way, beyond = missing(), sorted(beyond_joint(settler.model, joint))
    count = max(1, int(np.ceil(abs(way) / TURN)))
    if not beyond:
        for k in range(count + CLOSING):
            balance = settler.look()
            row = np.zeros(len(balance.mass))
            for body, sign in ((a, -sense), (b, sense)):
                row[3 * np.flatnonzero(balance.bodies == body) + 2] += sign
            row = balance.free.T @ (row * balance.scale)
            if row @ row > 0:
                part = missing() / max(1, count - k)
                still.put(balance.pose_after(
                    still.pose, balance.free @ (row * part / (row @ row)) + balance.closing()))
        return
    part = sense * (way if b in beyond else -way) / count
    c, s = np.cos(part), np.sin(part)
    for _ in range(count):
        pose = still.pose
        pivot = placed(pose[b], joints.anchor[joint, 1] - settler.model.bodies.centre[b])
        pose[beyond, :2] = pivot + (pose[beyond, :2] - pivot) @ np.array([[c, s], [-s, c]])
        pose[beyond, 2] += part
        still.put(pose)
        still.move(settler.drive)  # tendons update their paths
        still.put(pose)
