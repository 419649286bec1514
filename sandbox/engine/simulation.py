"""A run that can be paused, read and continued.

A run in one go and a run in pieces are the same to the last bit.
"""

from __future__ import annotations

import math
import platform
import time
from collections.abc import Callable, Sequence
from numbers import Integral, Real

import numba
import numpy as np
import pymunk

from sandbox import __version__
from sandbox.elements.controllers.custom import Custom, customs
from sandbox.engine import inspect_elements as of
from sandbox.engine.advance import UNKEPT, advance
from sandbox.engine.bonds import taken_breaks
from sandbox.engine.contacts import rows_for
from sandbox.engine.control import Control
from sandbox.engine.coordinates import rate
from sandbox.engine.divergence import diverged
from sandbox.engine.inputs import Clock, Inputs, make_clock
from sandbox.engine.inspect_control import Checked, Runnable, checked
from sandbox.engine.islands import DAMPING, STIFFNESS, TANGENTIAL
from sandbox.engine.memory import Memory
from sandbox.engine.records import PACED
from sandbox.engine.sampler import Readings, Sampler
from sandbox.engine.tables import Tables, enlarged, make_tables
from sandbox.engine.world import World
from sandbox.errors import (
    ControllerFailed,
    Interrupted,
    Problem,
    RecordingFull,
    RunEnded,
    SandboxError,
    SceneError,
    SimulationDiverged,
)
from sandbox.model.catalogue import Catalogue
from sandbox.model.compile import compile_mechanism
from sandbox.numeric import Array
from sandbox.recording.builder import RECORDED_BYTES, Latest, RecordingBuilder
from sandbox.recording.recording import Recording
from sandbox.samples import outcome
from sandbox.values.expressions import Read
from sandbox.wording import WrongValueError, listed, near, quoted

BLOCK = 256  # maximum number of steps between two looks for Ctrl-C and updates of the progress bar
TRIALS = 3  # of the first step: each multiplies the error of its acceleration by some h
Progress = Callable[[float], None] | None
MAX_CONTACTS = 2000  # in one step; room for twice as many takes up to 4 GB


class Simulation:
    """A simulation of a scene that can be paused, read and continued.

    After k steps poses and forces belong to t = (k - 1/2) h, velocities to t = k h. Forces are
    those of step k; samples that are several steps apart record means.

    Args:
        scene: a scene, an expanded mechanism, or what :func:`sandbox.load_scene` takes; its
            ``run`` says how long and how finely.
        controllers: Python callables that read and write while it runs, after the scene's own.
        recorded_bytes: maximum size of the recording, contacts included.

    Raises:
        SceneError: a controller or an event that reads or writes what the mechanism does
            not have; a joint along a line, or a tendon between guides, that has no direction.
    """

    _keeps_all = True

    def __init__(
        self, scene: Runnable, *, controllers: Sequence[Custom] = (),
        recorded_bytes: float = RECORDED_BYTES,
    ) -> None:
        began = time.perf_counter()
        self._customs = customs(controllers)
        self.mechanism = checked(scene, self._customs)
        run = self.mechanism.run
        if run.solver != "direct":
            raise bad_argument(
                f"the solver {quoted(run.solver)} runs a scene in one go", "run.solver",
                "'direct' in steps; sandbox.simulate, 'sandbox run' and 'sandbox sweep'")
        self._clock: Clock = make_clock(run.duration, run.step, run.sample_rate)
        self._model = compile_mechanism(self.mechanism)
        found = [*of.joint_problems(self._model), *of.tendon_problems(self._model),
                 *of.line_problems(self._model), *of.load_problems(self._model)]
        if blocking := [one for one in found if one.blocks]:
            raise SceneError(blocking)
        self._world = world = World(self._model)
        self._inputs = Inputs(world, self._clock)
        self._tables: Tables = make_tables(world)
        self._first_tables = self._tables
        self._first_values = self._tables.saved()
        self._builder = self._make_builder()
        self._max_bytes = recorded_bytes
        self._sampler = Sampler(world, self._tables, self._builder, self._clock.every)
        self._catalogue = Catalogue(self.mechanism)
        self._readings = Readings(world, self._sampler, self._catalogue)
        self._read: dict[str, Read] = {}
        self._begin(began)

    def _begin(self, began: float) -> None:
        self._control = Control(self._model, self._clock, self._readings, self._customs)
        self._set: list[tuple[int, str, float | None]] = []  # done, drive, value
        self._broke: list[outcome.Happened] = []
        self._done = 0
        self._failed: SandboxError | None = None  # the error that ended it
        self._control.moved(0, self._inputs.rows(1, 1)[0])
        self._wall = {"build": time.perf_counter() - began, "simulate": 0.0}

    @property
    def time(self) -> float:
        """Current simulation time [s]."""
        return self._done * self._clock.step

    @property
    def steps(self) -> int:
        """Steps made so far."""
        return self._done

    @property
    def finished(self) -> bool:
        """Whether the run is over: complete, stopped, or ended by an error."""
        return self._done >= self._clock.steps or self._ended or self._failed is not None

    @property
    def stopped(self) -> outcome.Stop | None:
        """The event or :class:`sandbox.StopRun` that ended the run early, if any."""
        return self._control.stopped if self._ended else None

    @property
    def _ended(self) -> bool:  # by an event; never before the first sample
        return self._control.stopped is not None and self._done >= self._clock.every

    def __getitem__(self, quantity: str) -> float:
        """The current value of a quantity, a meter or an expression (``=a.x - b.x``), in SI.

        Before the first step forces and tensions are 0.

        Raises:
            UnknownQuantityError: not in the catalogue; with a near miss.
            SceneError: a quantity of complete runs only, such as ``work``; or no expression.
        """
        if not isinstance(quantity, str):
            raise bad_argument(f"{quantity!r} is not the name of a quantity", "simulation",
                               "a name such as 'finger.tendon.tension'")
        if quantity not in self._read:
            try:
                self._read[quantity] = self._readings.of(quantity)
            except WrongValueError as error:
                raise SceneError([Problem.of(error, quantity)]) from None
        return self._read[quantity]()

    def step(self, n: int = 1) -> int:
        """Make ``n`` steps, or as many as are left; returns how many were made.

        Raises:
            SandboxError: as :meth:`run`.
        """
        n = _whole(n, "step")
        before = self._done
        self.run(before + n)
        return self._done - before

    def run(self, until: int | None = None, *, progress: Progress = None) -> None:
        """Continue until so many steps are made in all, by default to the end.

        Args:
            until: steps from t = 0.
            progress: called repeatedly with the fraction of the whole run done, 0 to 1.

        Raises:
            SceneError: no whole number of steps, or an input that cannot be computed at some time.
            SimulationDiverged: the motion stopped being finite.
            RecordingFull: the recording became too large.
            ControllerFailed: a controller in Python raised an exception.
            Interrupted: Ctrl-C. This and the three errors above carry the recording so far. A run
                cannot continue after an error.
        """
        if self._failed is not None:
            raise self._failed
        if self.finished:
            return
        steps = self._clock.steps
        until = steps if until is None else min(_whole(until, "run"), steps)
        began = time.perf_counter()
        try:
            try:
                self._loop(until, progress)
            finally:
                self._wall["simulate"] += time.perf_counter() - began
        except (SimulationDiverged, RecordingFull, ControllerFailed, KeyboardInterrupt) as error:
            ended = Interrupted(self.time) if isinstance(error, KeyboardInterrupt) else error
            self._failed = ended
            ended.recording = self.recording()  # the run is over: it shares the memory
            raise ended from error.__cause__
        except BaseException as error:
            self._failed = SandboxError(f"this simulation ended at t = {self.time:.6g} s: "
                                        f"{type(error).__name__}: {error}", code="run-ended")
            raise

    def _loop(self, until: int, progress: Progress) -> None:
        clock, inputs, control, sampler = self._clock, self._inputs, self._control, self._sampler
        maximum, every = min(BLOCK, inputs.at_once), clock.every
        controlled, drives, done = bool(control), control.drives, self._done
        while done < until:
            count = min(maximum, until - done)
            if controlled:
                control.act(done)
                if self._ended:
                    break
                count = min(count, control.ahead(done))
                if control.stopped is not None:  # only to the first sample
                    count = min(count, every - done)
            drive = inputs.rows(done + 1, count)
            count = len(drive)
            drives.overlay(drive)
            inputs.apply(drive[0])
            speeds = inputs.speeds(done + 1, count)
            if done == 0:
                first = inputs.rows(1, 2).copy()
                drives.overlay(first)
            while done == 0 and not start(
                    self._world, self._tables, sampler.memory, first, speeds[:1]):
                found = int(self._world.finder.table[0])
                self._world.renew()  # results must not depend on what pymunk cached in the trial
                self._inputs = inputs = Inputs(self._world, self._clock)
                inputs.apply(drive[0])
                self._enlarge(found)
            made = 0
            while True:
                address, h, _ = sampler.memory
                due = every - (done + made) % every
                new = advance(address, h, drive[made:], speeds[made:], due, every)
                self._broke += taken_breaks(
                    self._tables, self._model.bonds.name, done + made, clock.step)
                sampler.record_impacts(done + made)
                made += new
                if made == count:
                    break
                self._make_room(done + made + 1)
            self._done = done = done + count
            control.moved(done, drive[-1])
            if progress is not None:
                progress(done / clock.steps)

    def _make_room(self, k: int) -> None:
        """Make the room that step ``k`` lacks; if it is not room, raise the error of the run."""
        if self._sampler.kept.taken[2]:  # first: a step that is half made may have to be kept, too
            self._sampler.make_room()
            if self._builder.recorded_bytes > self._max_bytes:
                raise RecordingFull(float(self._clock.force_time(k)), self._max_bytes)
        elif self._tables.state.touching[1]:
            self._enlarge()
        else:
            raise diverged(float(self._clock.force_time(k)), self._world, self._tables,
                           self._control)

    def _enlarge(self, found: int | None = None) -> None:
        """Make room for ``found`` contacts, by default those of the unfinished step."""
        world, elements = self._world, self._tables.elements
        found = int(world.finder.table[0]) if found is None else found
        if found > MAX_CONTACTS:
            raise SandboxError(f"{found} contacts at once at t = {self.time:.6g} s, more than the "
                               f"{MAX_CONTACTS} that can be solved together: fewer or simpler "
                               "bodies may help", code="too-complex")
        rows = rows_for(len(elements.limits), len(elements.motors), len(elements.slips),
                        len(elements.dry_friction), found)
        world.enlarge(found, 4 * (rows + 1))
        self._tables = enlarged(self._tables, world.room)
        self._sampler.enlarge(self._tables)

    def set(self, drive: str, value: float | None) -> None:
        """Set a drive from the next step on, in SI; None lets it follow its signal again.

        Raises:
            SceneError: no such drive, a value that is no finite number, a drive that a controller
                or an event of the scene sets, or a run that is over.
        """
        self._check_open("set")
        known = self._model.names.drive
        if drive not in known:
            raise SceneError([Problem(
                "name-not-found", f"there is no drive named {quoted(drive)}", "set",
                allowed=listed(known) or "none: the scene has no drives", hint=near(drive, known))])
        if value is not None and not (isinstance(value, Real) and math.isfinite(value)):
            raise bad_argument(f"{value!r} is not a value for {quoted(drive)}", "set",
                         "a finite number, or None for the drive's signal")
        if owner := self._control.writer(drive):
            raise SceneError([Problem("set-twice",
                                      f"the drive {quoted(drive)} is set by {quoted(owner)}",
                                      "set", allowed="a drive that nothing else sets")])
        self._set.append((self._done, drive, value))
        self._control.drives.set(known[drive], value or 0.0, value is not None)

    def _check_open(self, path: str) -> None:
        if self.finished:
            raise SceneError([Problem("run-ended", self.ending, path)])

    @property
    def ending(self) -> str:
        """Why the run is over; empty during the run."""
        stop = self._control.stopped
        if not self.finished or self._failed is not None:
            return f"the run is over: {self._failed}" if self._failed else ""
        by = f": {quoted(stop.event)} stopped it" if stop else ""
        because = f", {stop.because}" if stop and stop.because else ""
        return f"the run is over, at t = {self.time:.6g} s{by}{because}"

    def restart(self) -> None:
        """Go back to t = 0; drives follow their signals again.

        Results are, to the last bit, those of a new simulation, but it starts faster. Recordings
        that were returned before stay as they are. Python controllers are not reset.
        """
        began = time.perf_counter()
        self._world.renew()
        self._inputs = Inputs(self._world, self._clock)
        for array, value in self._first_values:
            array[...] = value
        self._tables = self._first_tables
        self._builder = self._make_builder()
        self._sampler.restart(self._tables, self._builder)
        self._begin(began)

    def copy(self) -> Simulation:
        """Another simulation in the same state, made by running it again.

        It takes as long as this one took: the state of pymunk's space cannot be copied exactly.
        Python controllers are the same functions, so their results must depend on their readings
        alone.

        Raises:
            SandboxError: the error that ended this one.
        """
        if self._failed is not None:
            raise self._failed
        other = Simulation(Checked(self.mechanism), controllers=self._customs,
                           recorded_bytes=self._max_bytes)
        for done, drive, value in self._set:
            other.run(done)
            other.set(drive, value)
        other.run(self._done)
        if self._ended:  # the event acts before the step that was not made
            other.run(self._done + 1)
        return other

    def recording(self) -> Recording:
        """The samples so far, marked incomplete before the end; further steps do not change it."""
        failed = self._failed
        reason = failed.outcome.format(failed) if isinstance(failed, RunEnded) else ""
        return self.finish(reason, copied=not self.finished)

    def finish(self, reason: str, *, copied: bool = False) -> Recording:
        """The recording so far; unless ``copied`` it shares the memory of further steps."""
        self._sampler.write()
        samples = int(self._sampler.kept.taken[0])
        clock, standing = self._clock, self._tables.state.standing
        steps = clock.sample_step(np.arange(samples))
        return self._builder.finish(clock.force_time(steps), outcome.Outcome(
            complete=not reason and self.finished and self._failed is None, reason=reason,
            step=clock.step, steps=clock.steps,
            sample_rate=1 / (clock.every * clock.step),
            versions={
                "sandbox": __version__, "pymunk": pymunk.version, "numpy": np.__version__,
                "numba": numba.__version__, "python": platform.python_version(),
            },
            wall=dict(self._wall), events=tuple(self._control.happened),
            broke=tuple(self._broke), stopped=self._control.stopped,
            controllers={loop.name: report for loop in self._control.loops
                         if (report := loop.law.report())},
            contact_solver=self._contact_solver(),
            notes=outcome.step_notes(
                self._done, relaxed=int(standing[0]), unordered=int(standing[5]),
                overlapping=int(standing[6])),
        ), copied=copied)

    def _contact_solver(self) -> dict[str, float]:
        (constants, elements, state), h = self._tables[:3], self._clock.step
        if not (len(constants.shapes) or len(elements.limits) or len(elements.motors)):
            return {}
        _, largest, step, piled, coarse, _ = state.accuracy.tolist()
        found = {"residual": largest, "time_s": step * h, "steps_above_1e-8": coarse,
                 "relaxed_steps": float(state.standing[0])}
        return found | ({"compliant_steps": piled, "stiffness": STIFFNESS, "damping": DAMPING,
                         "tangential": TANGENTIAL} if piled else {})

    def _make_builder(self, samples: int | None = None) -> RecordingBuilder:
        bodies = self._model.bodies
        tendons = self._tables.elements.cables[:len(self._model.tendons.name)]
        statics = {"body_centre": bodies.centre, "body_mass": bodies.mass,
                   "body_inertia": bodies.inertia, "tendon_initial": tendons["length"].copy(),
                   "tendon_rest": tendons["rest"].copy()}
        if not self._keeps_all:
            return Latest(self.mechanism, 0, statics, model=self._model)
        return RecordingBuilder(
            self.mechanism, samples or self._clock.samples, statics,
            apart=samples is None and self._clock.every > 1, model=self._model)


def _whole(number: object, path: str) -> int:
    if isinstance(number, Integral) and int(number) >= 0:
        return int(number)
    raise bad_argument(f"{number!r} is no number of steps", path, "a whole number, 0 or more")


def bad_argument(message: str, path: str, allowed: str) -> SceneError:
    """An error about an argument of a Python call."""
    return SceneError([Problem("bad-argument", message, path, allowed=allowed)])


def start(world: World, tables: Tables, memory: Memory, drive: Array, speeds: Array) -> bool:
    """Put the bodies where the first step begins; False if a trial step lacked room.

    Poses belong to t = (k - 1/2) h and velocities to t = k h. With the pose x0, the velocity v0 and
    the acceleration a of t = 0 the first pose is

        x = x0 - h/2 v0 + h^2/8 a

    The first step gives a = (v1 - v0) / h; it is repeated, because joints that are still open
    falsify it. An impact is no acceleration: a body that is hit is not moved, and a motor's speed
    is reduced by its difference from the hinge's in trials.
    """
    first = world.body.copy()
    free = tables.constants.inverse_mass[:, 0] > 0
    saved, trial_drive = tables.saved(), drive[:1].copy()
    joints, motors = tables.elements.joints, tables.elements.motors
    for trial in range(TRIALS):
        advance(memory.address, memory.h, trial_drive, speeds, UNKEPT, UNKEPT)
        if trial == 0:
            kept_speed = ((motors["mode"] == 0) & np.isfinite(motors["maximum"])
                          & np.isnan(motors["slope"]) & (motors["law"] == PACED))
            for motor in motors[kept_speed]:
                speed = motor["sense"] * rate(joints[motor["joint"]], first[:, 3:])
                at_start = (2 * drive[0] - drive[-1])[motor["drive"]]
                trial_drive[0, motor["drive"]] -= at_start - speed
        enough = not tables.state.touching[1]
        gained = memory.h / 8 * (world.velocity - first[:, 3:])
        touches = tables.state.touches[:tables.state.touching[0]]
        hit = (touches["bounce"] + touches["ahead"] * touches["normal"]).any()
        for array, value in saved:
            array[...] = value
        shift = np.where(free[:, None] & np.isfinite(gained) & ~hit, gained, 0.0)
        tables.place(first[:, :3] + shift, first[:, 3:])
        if not enough:
            return False
    return True
