"""A run by pymunk's own solver, recorded as any other run.

Forces are the impulses of a step divided by the step. pymunk lacks directions of joint impulses,
work, and means over several steps: these are nan.
"""

from __future__ import annotations

import math
import platform
import time
from collections.abc import Callable, Iterable

import numpy as np
import pymunk

from sandbox import __version__
from sandbox.elements.arrays import Arrays
from sandbox.engine.inputs import Clock, make_clock
from sandbox.engine.pymunk_draft import PymunkDraft, build, time_step
from sandbox.errors import Interrupted, RecordingFull, RunEnded, SimulationDiverged
from sandbox.numeric import Array
from sandbox.recording.builder import RecordingBuilder
from sandbox.recording.recording import Recording
from sandbox.samples.contacts import merge_contacts
from sandbox.samples.outcome import Outcome
from sandbox.scene.mechanism import Mechanism

FARTHEST = 1e6  # beyond this position or speed of a body [m, m/s] a run has diverged


def run_pymunk(
    mechanism: Mechanism, *, progress: Callable[[float], None] | None, recorded_bytes: float,
) -> Recording:
    """Run a mechanism in plain pymunk; arguments and errors as of :func:`sandbox.simulate`."""
    began = time.perf_counter()
    run = _PymunkRun(mechanism)
    built, clock = time.perf_counter(), run.clock
    error: RunEnded | None = None
    try:
        while error is None and run.samples < clock.samples:
            run.sample()
            culprit = next((name for name, body in run.scene.bodies.items() if not all(
                abs(x) < FARTHEST
                for x in (*body.position, *body.velocity, body.angular_velocity))), "")
            if culprit:
                error = SimulationDiverged(run.now, culprit, "its motion has run away; a smaller "
                                           "time step or more iterations may help")
                run.samples -= 1  # it may have no numbers
            elif run.builder.recorded_bytes > recorded_bytes:
                error = RecordingFull(run.now, recorded_bytes)
            if progress is not None:
                progress(run.samples / clock.samples)
    except KeyboardInterrupt:
        error = Interrupted(run.now)
    iterations = mechanism.run.pymunk.iterations
    recording = run.builder.finish(
        clock.force_time(clock.sample_step(np.arange(run.samples))), Outcome(
            complete=error is None, reason=error.outcome.format(error) if error else "",
            step=clock.step, steps=clock.steps, sample_rate=1 / (clock.every * clock.step),
            versions={"sandbox": __version__, "pymunk": pymunk.version,
                      "numpy": np.__version__, "python": platform.python_version()},
            wall={"build": built - began, "simulate": time.perf_counter() - built}, notes=(
                f"computed by pymunk {pymunk.version} with {iterations} iterations in steps of "
                f"{clock.step:g} s, not by the direct solver",)))
    if error is not None:
        error.recording = recording
        raise error
    return recording


class _PymunkRun:
    def __init__(self, mechanism: Mechanism) -> None:
        draft = PymunkDraft(mechanism)
        self.model, self.scene = draft.model, build(mechanism, draft)
        run = mechanism.run
        self.clock: Clock = make_clock(run.duration, time_step(mechanism), run.sample_rate)
        bodies, tendons = self.model.bodies, self.scene.tendons.values()
        self.builder = RecordingBuilder(mechanism, self.clock.samples, {
            "body_centre": bodies.centre, "body_mass": bodies.mass, "body_inertia": bodies.inertia,
            "tendon_initial": np.array([tendon.length for tendon in tendons]),
            "tendon_rest": np.array([tendon.rest for tendon in tendons])}, model=self.model)
        self.bodies = list(self.scene.bodies.values())
        self.numbers = {body: i for i, body in enumerate(self.bodies)}
        self.samples, self._row = 0, self.builder.blank(1)

    @property
    def now(self) -> float:
        """Time of the poses of the last step [s]."""
        return float(self.clock.force_time(self.scene.steps))

    def sample(self) -> None:
        """Make the steps up to the next sample and record it."""
        for _ in range(self.clock.every - 1):
            self.scene.step()
        before = self._velocities()
        self.scene.step()
        after = self._velocities()
        arrays = {key: array[0] for key, array in self._row.items()}
        arrays["body_pose"][:] = [(*body.position, body.angle) for body in self.bodies]
        arrays["body_velocity"][:] = (before + after) / 2
        arrays["body_acceleration"][:] = (after - before) / self.scene.h
        self._record_joints(arrays)
        tendons = self.scene.tendons.values()
        arrays["tendon_length"][:] = [tendon.measure()[0] for tendon in tendons]
        arrays["tendon_tension"][:] = [tendon.tension for tendon in tendons]
        arrays["guide_lifted"][:] = 0.0
        arrays["drive_value"][:] = [self.scene.drives[name] for name in self.model.drives.name]
        self._record_contacts()
        self.builder.put(self.samples, self._row)
        self.samples += 1

    def _velocities(self) -> Array:
        return np.array([(*body.velocity, body.angular_velocity) for body in self.bodies])

    def _force(self, constraint: str) -> float:
        made = self.scene.constraints.get(constraint)
        return 0.0 if made is None else made.impulse / self.scene.h

    def _record_joints(self, arrays: Arrays) -> None:
        joints = self.model.joints
        for j, name in enumerate(joints.name):
            if not isinstance(self.scene.constraints[name], pymunk.GearJoint):  # has no force
                arrays["joint_reaction"][j] = self._force(name)
            a, b = joints.bodies[j]
            if joints.kind[j].line:
                arrays["joint_length"][j], arrays["joint_speed"][j] = self._between(
                    arrays, (a, b), joints.anchor[j])
        a, b = joints.bodies[joints.hinges].T
        sense, angles = joints.sense[joints.hinges], arrays["body_pose"][:, 2]
        arrays["joint_angle"][joints.hinges] = (
            sense * (angles[b] - angles[a]) - joints.zero[joints.hinges])
        rates = arrays["body_velocity"][:, 2]
        arrays["joint_rate"][joints.hinges] = sense * (rates[b] - rates[a])
        for j in joints.hinges.tolist():
            against = -math.copysign(1.0, arrays["joint_rate"][j])
            arrays["joint_damping"][j] = against * (
                self._force(f"{joints.name[j]}.damping") + sum(
                    self._force(f"{self.model.springs.name[i]}.work")
                    for i in np.flatnonzero(self.model.springs.joint == j)))
        for j in joints.stopped.tolist():
            to_low, to_high = np.abs(arrays["joint_angle"][j] - joints.stops[j])
            arrays["joint_stop"][j] = self._force(f"{joints.name[j]}.stop") * (
                1.0 if to_low < to_high else -1.0)
        springs = self.model.springs
        for i, name in enumerate(springs.name):
            if springs.straight[i]:
                arrays["spring_length"][i], _ = self._between(
                    arrays, springs.bodies[i], springs.anchor[i])
                arrays["spring_force"][i] = -self._force(name)
            else:
                j = int(springs.joint[i])
                damping = math.copysign(self._force(f"{name}.work"), arrays["joint_rate"][j])
                arrays["spring_length"][i] = arrays["joint_angle"][j]
                arrays["spring_force"][i] = damping - joints.sense[j] * self._force(name)

    def _between(self, arrays: Arrays, bodies: Iterable[int], points: Array) -> tuple[float, float]:
        """Distance of points of two bodies [m] and its rate [m/s], at a sample."""
        way, velocity = np.zeros(2), np.zeros(2)
        for sign, body, at in zip((-1.0, 1.0), bodies, points, strict=True):
            made = self.bodies[body]
            point = np.array(made.local_to_world(tuple(at)))
            arm = point - made.local_to_world(made.center_of_gravity)
            vx, vy, omega = arrays["body_velocity"][body]
            way += sign * point
            velocity += sign * np.array([vx - omega * arm[1], vy + omega * arm[0]])
        distance = float(np.hypot(*way))
        return distance, float(way @ velocity) / distance if distance else 0.0

    def _record_contacts(self) -> None:
        rows: list[tuple[float, ...]] = []

        def note(arbiter: pymunk.Arbiter) -> None:
            one, other = (self.numbers[body] for body in arbiter.bodies)
            free = self.model.bodies.free
            if free[one] and free[other] and one > other:
                return  # noted for the other body
            raw = arbiter._arbiter  # the public interface has no forces of single points
            to_one = 1.0 if raw.swapped else -1.0  # the normal goes from shape a to shape b
            a, b = (self.bodies[i] for i in ((other, one) if raw.swapped else (one, other)))
            n, from_a, from_b = raw.n, *(
                body.local_to_world(body.center_of_gravity) for body in (a, b))
            for point in (raw.contacts[i] for i in range(raw.count)):
                x, y = from_a.x + point.r1.x, from_a.y + point.r1.y
                gap = (from_b.x + point.r2.x - x) * n.x + (from_b.y + point.r2.y - y) * n.y
                normal, along = point.jnAcc * to_one, point.jtAcc * to_one
                if point.jnAcc > 0.0:
                    rows.append((one, other, x, y, normal * n.x - along * n.y,
                                 normal * n.y + along * n.x, to_one * n.x, to_one * n.y,
                                 point.jnAcc, gap))
        for body in self.bodies:
            if body.body_type == pymunk.Body.DYNAMIC:
                body.each_arbiter(note)
        found = np.array(sorted(rows), dtype=float).reshape(-1, 10)
        pair = found[:, :2].astype(np.int64)
        self.builder.contacts.append(*merge_contacts(
            np.full(len(found), self.samples), pair[:, 0], pair[:, 1], found[:, 2:4],
            found[:, 4:6] / self.scene.h, found[:, 6:8], found[:, 8], found[:, 9],
            np.zeros(len(found))).values())
