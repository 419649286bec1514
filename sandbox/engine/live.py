"""A run that is played with: pushed, and its drives and targets set, while it goes on.

It has no end and keeps its last samples only. What was done to it is in ``inputs``, by steps;
:mod:`sandbox.scene.played` makes of these a scene of its own.

A hand takes hold of a body and draws it to a place, as by a spring: force = k (place - point) -
c velocity, critically damped for a mass m: k = m w^2, c = 2 m w, and w = :data:`QUICK`. It is
computed every T = :data:`EVERY` and constant in between: stable for a mass m' at the point while
w T m / m' < 1. So m is that of all connected bodies, but at most :data:`MOST` times the effective
mass of the body alone at the point.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from numbers import Real

import numpy as np

from sandbox.elements.arrays import Arrays
from sandbox.engine.inspect_control import Checked, checked
from sandbox.engine.simulation import Simulation
from sandbox.errors import Problem, SceneError
from sandbox.model.compile import compile_mechanism
from sandbox.model.model import Model
from sandbox.numeric import Array, connected_components
from sandbox.recording.builder import Latest, RecordingBuilder
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

ENDLESS = 1e6
"""As the duration of a run without an end [s]: eleven days."""


class Live(Simulation):
    """A run of a scene without an end, in which every step is a sample; the last ones are kept.

    Args:
        scene: a scene or an expanded mechanism; its ``run.duration`` does not count.

    Raises:
        SceneError: as :class:`Simulation`.
    """

    def __init__(self, scene: Scene | Mechanism | Checked) -> None:
        self.scene = checked(scene, ())
        """What is played with, without the drives of the hand."""
        self.inputs: list[Input] = []
        """What was done so far, in order."""
        super().__init__(Checked(_endless(self.scene)))
        self._grasped: tuple[str, tuple[float, float]] | None = None
        """What the drives of the hand act on."""
        self._wanted: tuple[str, tuple[float, float], tuple[float, float]] | None = None
        """The push that the next step begins with: body, point, force."""
        self._hand = np.arange(len(self.scene.drives), len(self.mechanism.drives))

    def _room(self) -> RecordingBuilder:
        return Latest(self.mechanism, 0, self._statics(), model=self._model)

    def latest(self) -> Arrays:
        """The samples of the last steps, as arrays of a recording that the next step writes over.

        They are those since the last call, or some hundreds of them.
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
        """The quantities that can be read while it goes on, pairs left out."""
        hidden, found = tuple(f"{name}." for name in self._hidden()), []
        for name in self._catalogue.units:
            with suppress(KeyError):  # computed after a run
                self._readings.of(name)
                found.append(name)
        return [name for name in found if not name.startswith(hidden)]

    # -- what may be done to it -------------------------------------------------------------

    def set(self, drive: str, value: float | None) -> None:
        """Give a drive a value from the next step on, in SI; as :meth:`give`.

        Raises:
            SceneError: as :meth:`give`; None, since what is played with keeps its last value.
        """
        if value is None:
            raise SceneError([Problem("bad-argument", f"{quoted(drive)} needs a value", "set",
                                      allowed="a finite number")])
        self.give(drive, value)

    def give(self, name: str, value: float) -> None:
        """Set a drive, a target or a switch from the next step on, as an event does.

        Args:
            name: of a drive, ``<controller>.target`` or ``<controller>.active``.
            value: in SI; 0 or 1 of a switch.

        Raises:
            SceneError: nothing of that name; what a controller sets; no finite number, or one that
                is out of range; a run that is over.
        """
        self._open("give")
        if name in self._hidden():
            known = [drive.name for drive in self.scene.drives]
            raise SceneError([Problem(
                "name-not-found", f"there is nothing named {quoted(name)} to set", "give",
                allowed=listed(known) or "none: there are no drives")])
        if not _finite(value):
            raise SceneError([Problem("bad-argument", f"{value!r} is not a value for "
                                      f"{quoted(name)}", "give", allowed="a finite number")])
        kind = next((drive.kind for drive in self.scene.drives if drive.name == name), None)
        try:
            in_range(float(value), (kind.dimension or None) if kind else None)
        except WrongValueError as error:
            raise SceneError([Problem.of(
                error, "give", message=f"value of {quoted(name)}: {error.message}")]) from None
        event = Event(name=PLAYED, at=self.time, set={name: float(value)})
        alone = self.scene.model_copy(update={"events": (event,), "run": self.mechanism.run})
        wrong = [problem for problem in check_control(alone, lambda name: False)
                 if parse_path(problem.path)[:1] == ("events",)]
        if wrong:
            raise SceneError([Problem(wrong[0].code, wrong[0].message, "give",
                                      allowed=wrong[0].allowed, hint=wrong[0].hint)])
        self.inputs.append(Setting(self.steps, name, float(value)))
        self._steering.add(event)

    def push(
        self, body: str, at: Sequence[float] = (0.0, 0.0), force: Sequence[float] = (0.0, 0.0),
    ) -> None:
        """Push a body from the next step on, in place of the push before; (0, 0) ends it.

        Args:
            body: the name of a body that moves freely.
            at: where, in the body's frame [m]; the point moves with the body.
            force: in the world [N].

        Raises:
            SceneError: no such body, or one that does not move freely; no finite numbers; a run
                that is over.
        """
        self._open("push")
        place, strength = _pair(at, "at"), _pair(force, "force")
        free = [each.name for each in self.scene.bodies if each.motion == "dynamic"]
        if body not in free:
            raise SceneError([Problem(
                "name-not-found", f"{quoted(body)} is no body that moves freely", "push",
                allowed=listed(free) or "none: all bodies are held", hint=near(body, free))])
        push = Nudge(self.steps, body, place, strength)
        before = next((one for one in reversed(self.inputs) if isinstance(one, Nudge)), None)
        if before is not None and replace(before, step=push.step) == push:
            return  # it pushes so already
        if self.inputs and self.inputs[-1] is before and before.step == push.step:
            self.inputs.pop()  # it never pushed
        self.inputs.append(push)
        self._wanted = body, place, strength

    def run(
        self, until: int | None = None, *, progress: Callable[[float], None] | None = None,
    ) -> None:
        """Go on until so many steps are made in all; as :meth:`Simulation.run`."""
        if self._wanted is not None:
            self._apply(*self._wanted)
            self._wanted = None
        super().run(until, progress=progress)

    def _apply(self, body: str, at: tuple[float, float], force: tuple[float, float]) -> None:
        """Let the drives of the hand push."""
        if (body, at) != self._grasped:
            index = self._model.names.body[body]
            actions = self._tables.elements.actions
            rows = np.flatnonzero(np.isin(actions["drive"], self._hand))
            arm: Array = np.array(at) - self._model.bodies.centre[index]
            actions["a"][rows] = self._world.number[index]
            actions["x"][rows], actions["y"][rows] = arm
            if any(force):  # the same force elsewhere is not the last step over again
                self._tables.state.standing[1] = 0
            self._grasped = body, at
        for column, value in zip(self._hand.tolist(), force, strict=True):
            self._steering.desk.set(column, value)

    def _open(self, what: str) -> None:
        if self.finished:
            raise SceneError([Problem("run-ended", self.ending, what)])

    @property
    def ending(self) -> str:
        """What ended it, in words; empty while it goes on."""
        stop = self._steering.stopped
        if not self.finished or self._failed is not None:
            return f"the run is over: {self._failed}" if self._failed else ""
        by = f": {quoted(stop.event)} stopped it" if stop else ""
        because = f", {stop.because}" if stop and stop.because else ""
        return f"the run is over, at t = {self.time:.6g} s{by}{because}"

    def _hidden(self) -> list[str]:
        return [self.mechanism.drives[i].name for i in self._hand.tolist()]

    # -- once more --------------------------------------------------------------------------

    def restart(self) -> None:
        """Go back to t = 0 with nothing done to it, as :meth:`Simulation.restart`."""
        super().restart()
        self.inputs, self._grasped, self._wanted = [], None, None

    def again(
        self, steps: int, *, progress: Callable[[float], None] | None = None,
    ) -> Live:
        """Another run that stands after so many steps, with what was done before these.

        It is run from t = 0: pymunk begins its search for what touches with what it found in the
        step before, which cannot be copied, and other beginnings end in other last bits.

        Args:
            steps: from t = 0.
            progress: as that of :meth:`run`; what it raises ends this, too.
        """
        other = Live(Checked(self.scene))
        for each in self.inputs:
            if each.step < steps:
                other.run(each.step, progress=progress)
                other._repeat(each)
        other.run(steps, progress=progress)
        return other

    def copy(self) -> Live:
        """Another run that stands where this one does, as :meth:`again`.

        What was done since the last step is done to it, too.
        """
        other = self.again(self.steps)
        for each in self.inputs:
            if each.step == self.steps:
                other._repeat(each)
        return other

    def _repeat(self, done: Input) -> None:
        """Do once more what was done to another run that stood here."""
        if isinstance(done, Nudge):
            self.push(done.body, done.at, done.force)
        else:
            self.give(done.name, done.value)

    def played(self) -> Mechanism:
        """What was played so far as a scene of its own."""
        return played(self.scene, self.inputs, self.steps)


def _endless(scene: Mechanism) -> Mechanism:
    """The mechanism without an end, with drives that push, if there is something to push."""
    run = scene.run.model_copy(update={"duration": ENDLESS, "sample_rate": 1 / scene.run.step})
    body = next((body.name for body in scene.bodies if body.motion == "dynamic"), None)
    drives = list(scene.drives)
    if body is not None:
        drives += pushing_drives(scene, [Nudge(0, body, (0.0, 0.0), (0.0, 0.0))])
    return scene.model_copy(update={"run": run, "drives": tuple(drives)})


def _pair(numbers: Sequence[float], what: str) -> tuple[float, float]:
    """Two finite numbers.

    Raises:
        SceneError: they are not.
    """
    found = tuple(numbers) if isinstance(numbers, Sequence | np.ndarray) else ()
    if len(found) != 2 or not all(map(_finite, found)):
        raise SceneError([Problem("bad-argument", f"{numbers!r} is not [x, y]", f"push.{what}",
                                  allowed="two finite numbers")])
    return float(found[0]) + 0.0, float(found[1]) + 0.0  # no -0.0


def _finite(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


QUICK = 40.0
"""How fast it draws, w [1/s]: a tenth of the way is left after 0.1 s."""
EVERY = 4e-3
"""Time between two forces [s], a step at least."""
MOST = 5.0
"""Times the least mass that a point answers with: w T times this is 0.8."""
WEIGHTS = 50.0
"""The most that it draws with, in weights of what is joined to the body."""
FINE = 1e-6
"""Its force goes in steps of about this times the most: what holds still needs no new number."""
GRAVITY = 9.81  # [m/s^2]


class Hand:
    """One hand of a live run; ``force`` is what it draws with [N]."""

    def __init__(self, live: Live) -> None:
        self.live = live
        self.model: Model = compile_mechanism(live.scene)
        self.body: str | None = None
        """What it holds."""
        self.at = self.to = self.force = (0.0, 0.0)
        """The point in the body's frame, the place in the world [m], the force there [N]."""
        self._masses = _joined_masses(self.model)
        self._stiffness = self._damping = self._cap = 0.0
        self._digits = 0

    @property
    def every(self) -> int:
        """Steps between two forces; of steps that are too long for it each one."""
        return max(1, int(EVERY / self.live.scene.run.step + 1e-9))

    def hold(self, body: str, at: Sequence[float], to: Sequence[float]) -> None:
        """Take hold of a body at a point of its frame, to draw it to a place in the world [m]."""
        at, to = _place(at), _place(to)
        if (body, at) != (self.body, self.at):
            self.drop()
            self.live.push(body, at, (0.0, 0.0))  # what cannot be held is refused there
            index = self.model.names.body[body]
            bodies, whole = self.model.bodies, self._masses[index]
            arm = float(np.hypot(*(np.asarray(at, float) - bodies.centre[index])))
            alone = float(1 / (1 / bodies.mass[index] + arm**2 / bodies.inertia[index]))
            longest = max(EVERY, self.live.scene.run.step)
            # a step that is itself longer sees velocities half a step late
            mass = min(whole, MOST * alone * EVERY / (2 * longest - EVERY))
            self._stiffness, self._damping = mass * QUICK**2, 2 * mass * QUICK
            self._cap = WEIGHTS * GRAVITY * whole
            self._digits = -round(math.log10(FINE * self._cap))
            self.body, self.at = body, at
        self.to = to

    def drop(self) -> None:
        """Let go."""
        if self.body is not None and not self.live.finished:
            self.live.push(self.body, self.at, (0.0, 0.0))
        self.body, self.force = None, (0.0, 0.0)

    def let_go(self) -> None:
        """Let go what another hand held when the run was at this instant before."""
        last = next((each for each in reversed(self.live.inputs) if isinstance(each, Nudge)), None)
        if last is not None and any(last.force) and not self.live.finished:
            self.live.push(last.body, last.at, (0.0, 0.0))

    def draw(self) -> None:
        """Push as it has to now; to be called before every :attr:`every` steps."""
        if self.body is None:
            return
        (x, y), (vx, vy) = self.point()
        fx = self._stiffness * (self.to[0] - x) - self._damping * vx
        fy = self._stiffness * (self.to[1] - y) - self._damping * vy
        less = min(1.0, self._cap / max(math.hypot(fx, fy), 1e-300))
        self.force = round(less * fx, self._digits), round(less * fy, self._digits)
        self.live.push(self.body, self.at, self.force)

    def point(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Where the point is that it holds and how it moves [m, m/s]."""
        assert self.body is not None
        live, body = self.live, self.body
        x, y, angle, vx, vy, rate = (
            live[f"{body}.{name}"] for name in ("x", "y", "angle", "vx", "vy", "omega"))
        c, s = math.cos(angle), math.sin(angle)
        (ax, ay), (cx, cy) = self.at, self.model.bodies.centre[self.model.names.body[body]]
        rx, ry = c * (ax - cx) - s * (ay - cy), s * (ax - cx) + c * (ay - cy)
        return ((x + c * ax - s * ay, y + s * ax + c * ay),
                (vx - rate * ry, vy + rate * rx))

def _place(numbers: Sequence[float]) -> tuple[float, float]:
    """Two lengths [m]."""
    try:
        x, y = (in_range(float(number), "length") for number in numbers)
    except (TypeError, ValueError) as error:
        said = error.message if isinstance(error, WrongValueError) else "it has other numbers"
        allowed = error.allowed if isinstance(error, WrongValueError) else "two finite numbers"
        raise SceneError([Problem("bad-argument", f"{tuple(numbers)!r} is no place: {said}", "drag",
                                  allowed=allowed)]) from None
    return x, y


def _joined_masses(model: Model) -> Array:
    """For each body the total mass of the free bodies that joints connect with it, [nb]."""
    mass = np.where(np.isfinite(model.bodies.mass), model.bodies.mass, 0.0)
    pairs = model.joints.bodies[(mass[model.joints.bodies] > 0).all(axis=1)]
    links = np.zeros((len(mass), len(mass)), dtype=bool)
    links[*pairs.T] = links[*pairs[:, ::-1].T] = True
    total = np.zeros(len(mass))
    for group in connected_components(links):
        total[group] = mass[group].sum()
    return total
