"""Interactive simulations: pushes and settings of drives and targets during the run.

They have no end and keep only their last samples. ``inputs`` are the pushes and settings by steps;
:mod:`sandbox.scene.played` makes a scene of them.

A hand draws a point of a body to a place like a critically damped spring: force = k (place - point)
- c velocity, with k = m w^2, c = 2 m w and w = :data:`QUICK`. The force is constant for T =
:data:`EVERY`: stable for a mass m' at the point while w T m / m' < 1. So m is that of all connected
bodies, but at most :data:`MAX_RATIO` times the effective mass of the body alone at the point.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from numbers import Real

import numpy as np

from sandbox.elements.arrays import Arrays
from sandbox.engine.inspect_control import Checked, checked
from sandbox.engine.simulation import Progress, Simulation, bad_argument
from sandbox.errors import Problem, SceneError
from sandbox.model.compile import compile_mechanism
from sandbox.model.model import Model
from sandbox.model.supports import together
from sandbox.numeric import Array
from sandbox.recording.builder import Latest
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Outcome
from sandbox.scene.check.control import check_control
from sandbox.scene.document import Scene
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.played import PLAYED, Input, Nudge, Setting, played, pushing_drives
from sandbox.scene.settings import Event
from sandbox.values.paths import parse_path
from sandbox.values.units import in_range
from sandbox.wording import WrongValueError, listed, near, quoted

ENDLESS = 1e6  # duration [s] of a run without an end: eleven days


class Live(Simulation):
    """A simulation without an end. Every step is a sample; only the last samples are kept.

    Args:
        scene: a scene or an expanded mechanism; its ``run.duration`` does not count.

    Raises:
        SceneError: as :class:`Simulation`.
    """

    _keeps_all = False

    def __init__(self, scene: Scene | Mechanism | Checked) -> None:
        self.scene = scene = checked(scene, ())  # without the drives of the hand
        self.inputs: list[Input] = []  # pushes and settings so far, in order
        run = scene.run.model_copy(update={"duration": ENDLESS, "sample_rate": 1 / scene.run.step})
        free = [body.name for body in scene.bodies if body.motion == "dynamic"]
        hand = pushing_drives(  # if a body can be pushed
            scene, [Nudge(0, body, (0.0, 0.0), (0.0, 0.0)) for body in free[:1]])
        super().__init__(Checked(scene.model_copy(update={
            "run": run, "drives": (*scene.drives, *hand)})))
        self._grasped: tuple[str, tuple[float, float]] | None = None  # body and point
        self._next_push: tuple[str, tuple[float, float], tuple[float, float]] | None = None
        """Body, point and force from the next step on."""
        self._hand = np.arange(len(self.scene.drives), len(self.mechanism.drives))

    def latest(self) -> Arrays:
        """The samples since the last call, at most some hundreds, as arrays of a recording.

        The next step overwrites them.
        """
        self._sampler.flush()
        builder, clock = self._builder, self._clock
        assert isinstance(builder, Latest)
        steps = clock.sample_step(np.arange(builder.first, builder.first + builder.samples.count))
        return builder.arrays(clock.force_time(steps))

    def finish(self, reason: str, *, copied: bool = False) -> Recording:
        """A recording of :meth:`latest`."""
        arrays, clock = self.latest(), self._clock
        if copied:
            arrays = {key: array.copy() for key, array in arrays.items()}
        return Recording(self.mechanism, arrays, Outcome(
            complete=False, reason=reason,
            step=clock.step, steps=clock.steps, sample_rate=1 / clock.step), model=self._model)

    def unit(self, name: str) -> str:
        """The SI unit of a quantity, as :meth:`Recording.unit`."""
        return self._catalogue.find(name).unit

    def names(self) -> list[str]:
        """The quantities that can be read during the run, without those of pairs."""
        hidden, found = tuple(f"{name}." for name in self._hidden()), []
        for name in self._catalogue.units:
            with suppress(SceneError):  # computed after the run
                self._readings.of(name)
                found.append(name)
        return [name for name in found if not name.startswith(hidden)]

    def set(self, drive: str, value: float | None) -> None:
        """Set a drive from the next step on, in SI; as :meth:`give`.

        Raises:
            SceneError: as :meth:`give`; None, since a drive keeps the last value set.
        """
        self.give(drive, value)

    def give(self, name: str, value: float | None) -> None:
        """Set a drive, a target or a switch from the next step on, as an event does.

        Args:
            name: of a drive, ``<controller>.target`` or ``<controller>.active``.
            value: in SI; 0 or 1 of a switch.

        Raises:
            SceneError: an unknown name; a drive that a controller sets; a number that is not
                finite or out of range; a run that is over.
        """
        self._check_open("give")
        known = {drive.name: drive.kind for drive in self.scene.drives}
        if name in self._hidden():
            raise SceneError([Problem(
                "name-not-found", f"there is nothing named {quoted(name)} to set", "give",
                allowed=listed(known) or "none: there are no drives")])
        if not (isinstance(value, Real) and math.isfinite(value)):
            raise bad_argument(f"{value!r} is not a value for {quoted(name)}", "give",
                               "a finite number")
        try:
            in_range(float(value), (known[name].dimension or None) if name in known else None)
        except WrongValueError as error:
            raise SceneError([Problem.of(
                error, "give", message=f"value of {quoted(name)}: {error.message}")]) from None
        event = Event(name=PLAYED, at=self.time, set={name: float(value)})
        alone = self.scene.model_copy(update={"events": (event,), "run": self.mechanism.run})
        for problem in check_control(alone, lambda name: False):
            if parse_path(problem.path)[:1] == ("events",):
                raise SceneError([replace(problem, path="give", element="")])
        self.inputs.append(Setting(self.steps, name, float(value)))
        self._control.add(event)

    def push(
        self, body: str, at: Sequence[float] = (0.0, 0.0), force: Sequence[float] = (0.0, 0.0),
    ) -> None:
        """Push a body from the next step on, instead of the last push; (0, 0) ends it.

        Args:
            body: the name of a body that moves freely.
            at: a point in the body's frame [m].
            force: in the world [N].

        Raises:
            SceneError: no body of that name that moves freely; numbers that are not finite; a run
                that is over.
        """
        self._check_open("push")
        place, strength = _pair(at, "push.at"), _pair(force, "push.force")
        free = [each.name for each in self.scene.bodies if each.motion == "dynamic"]
        if body not in free:
            raise SceneError([Problem(
                "name-not-found", f"{quoted(body)} is no body that moves freely", "push",
                allowed=listed(free) or "none: all bodies are held", hint=near(body, free))])
        push = Nudge(self.steps, body, place, strength)
        before = self.last_push
        if before is not None and replace(before, step=push.step) == push:
            return  # the same push
        if self.inputs and self.inputs[-1] is before and before.step == push.step:
            self.inputs.pop()  # replaced before the step
        self.inputs.append(push)
        self._next_push = body, place, strength

    @property
    def last_push(self) -> Nudge | None:
        """The last push, of any hand."""
        return next((one for one in reversed(self.inputs) if isinstance(one, Nudge)), None)

    def run(self, until: int | None = None, *, progress: Progress = None) -> None:
        """Continue until so many steps are made in all; as :meth:`Simulation.run`."""
        if self._next_push is not None:
            body, at, force = self._next_push
            self._next_push = None
            if (body, at) != self._grasped:
                index, actions = self._model.names.body[body], self._tables.elements.actions
                rows = np.flatnonzero(np.isin(actions["drive"], self._hand))
                arm: Array = np.array(at) - self._model.bodies.centre[index]
                actions["a"][rows] = self._world.number[index]
                actions["x"][rows], actions["y"][rows] = arm
                if any(force):  # the same force at another point does not repeat the last step
                    self._tables.state.standing[1] = 0
                self._grasped = body, at
            for column, value in zip(self._hand.tolist(), force, strict=True):
                self._control.drives.set(column, value)
        super().run(until, progress=progress)

    def _hidden(self) -> list[str]:
        return [self.mechanism.drives[i].name for i in self._hand.tolist()]

    def restart(self) -> None:
        """Go back to t = 0 without inputs, as :meth:`Simulation.restart`."""
        super().restart()
        self.inputs, self._grasped, self._next_push = [], None, None

    def again(self, steps: int, *, progress: Progress = None) -> Live:
        """Another simulation after so many steps, with the same inputs before.

        It runs from t = 0: the contact search of pymunk starts with the contacts of the last step,
        which cannot be copied, and changes the last digits. An exception of ``progress`` ends it.
        """
        other = Live(Checked(self.scene))
        other._repeat([each for each in self.inputs if each.step < steps], progress)
        other.run(steps, progress=progress)
        return other

    def copy(self) -> Live:
        """Another simulation in the same state, as :meth:`again`, with the inputs since."""
        other = self.again(self.steps)
        other._repeat([each for each in self.inputs if each.step == self.steps])
        return other

    def _repeat(self, inputs: list[Input], progress: Progress = None) -> None:
        for each in inputs:
            self.run(each.step, progress=progress)
            if isinstance(each, Nudge):
                self.push(each.body, each.at, each.force)
            else:
                self.give(each.name, each.value)

    def played(self) -> Mechanism:
        """The inputs so far as a scene of its own."""
        return played(self.scene, self.inputs, self.steps)


def _pair(numbers: Sequence[float], path: str, dimension: str | None = None) -> tuple[float, float]:
    try:
        x, y = (in_range(float(number), dimension) + 0.0 for number in numbers)  # no -0.0
    except (TypeError, ValueError) as error:
        reason, allowed = ((f": {error.message}", error.allowed)
                           if isinstance(error, WrongValueError) else ("", "two finite numbers"))
        raise bad_argument(f"{numbers!r} is not [x, y]{reason}", path, allowed) from None
    return x, y


QUICK = 40.0  # w [1/s]: a tenth of the distance is left after 0.1 s
EVERY = 4e-3  # time between two forces [s]; at least a step
MAX_RATIO = 5.0  # of m to the effective mass at the point: w T times this is 0.8
MAX_WEIGHTS = 50.0  # maximum force, in weights of the connected bodies
FINE = 1e-6  # forces are multiples of about this share of the maximum: at rest they stay the same
GRAVITY = 9.81  # [m/s^2]


class Hand:
    """One hand of a live simulation."""

    def __init__(self, live: Live) -> None:
        self.live = live
        self.model: Model = compile_mechanism(live.scene)
        self.body: str | None = None  # that it holds
        self.at = self.to = self.force = (0.0, 0.0)  # in the body; in the world [m]; [N]
        self._stiffness = self._damping = self._cap = 0.0
        self._digits = 0

    @property
    def every(self) -> int:
        """Steps between two forces; 1 for long steps."""
        return max(1, int(EVERY / self.live.scene.run.step + 1e-9))

    def hold(self, body: str, at: Sequence[float], to: Sequence[float]) -> None:
        """Hold a body at a point of its frame, to draw it to a place in the world [m]."""
        at, to = _pair(at, "drag", "length"), _pair(to, "drag", "length")
        if (body, at) != (self.body, self.at):
            self.drop()
            self.live.push(body, at, (0.0, 0.0))  # which refuses a body that cannot be held
            index, bodies = self.model.names.body[body], self.model.bodies
            groups = (np.unique(self.model.joints.bodies[joints])
                      for joints in together(self.model))
            connected = next((group for group in groups if index in group), np.array([index]))
            whole = float(bodies.mass[connected[bodies.free[connected]]].sum())
            arm = float(np.hypot(*(np.asarray(at, float) - bodies.centre[index])))
            alone = float(1 / (1 / bodies.mass[index] + arm**2 / bodies.inertia[index]))
            longest = max(EVERY, self.live.scene.run.step)
            # a step longer than T sees velocities half a step late
            mass = min(whole, MAX_RATIO * alone * EVERY / (2 * longest - EVERY))
            self._stiffness, self._damping = mass * QUICK**2, 2 * mass * QUICK
            self._cap = MAX_WEIGHTS * GRAVITY * whole
            self._digits = -round(math.log10(FINE * self._cap))
            self.body, self.at = body, at
        self.to = to

    def drop(self) -> None:
        """Release the body."""
        if self.body is not None and not self.live.finished:
            self.live.push(self.body, self.at, (0.0, 0.0))
        self.body, self.force = None, (0.0, 0.0)

    def let_go(self) -> None:
        """End the push of another hand at this instant of the run."""
        last = self.live.last_push
        if last is not None and any(last.force) and not self.live.finished:
            self.live.push(last.body, last.at, (0.0, 0.0))

    def draw(self) -> None:
        """Push with the force of this instant; to be called before every :attr:`every` steps."""
        if self.body is None:
            return
        (x, y), (vx, vy) = self.point()
        fx = self._stiffness * (self.to[0] - x) - self._damping * vx
        fy = self._stiffness * (self.to[1] - y) - self._damping * vy
        share = min(1.0, self._cap / max(math.hypot(fx, fy), 1e-300))
        self.force = round(share * fx, self._digits), round(share * fy, self._digits)
        self.live.push(self.body, self.at, self.force)

    def point(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Position and velocity of the point that it holds [m, m/s]."""
        assert self.body is not None
        x, y, angle, vx, vy, rate = (self.live[f"{self.body}.{name}"] for name in (
            "x", "y", "angle", "vx", "vy", "omega"))
        c, s = math.cos(angle), math.sin(angle)
        (ax, ay), (cx, cy) = self.at, self.model.bodies.centre[self.model.names.body[self.body]]
        rx, ry = c * (ax - cx) - s * (ay - cy), s * (ax - cx) + c * (ay - cy)
        return (x + c * ax - s * ay, y + s * ax + c * ay), (vx - rate * ry, vy + rate * rx)
