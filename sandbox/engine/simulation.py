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
from sandbox.engine.advance import advance
from sandbox.engine.bonds import taken_breaks
from sandbox.engine.divergence import diverged
from sandbox.engine.inputs import Clock, Inputs, make_clock
from sandbox.engine.inspect_control import Checked, Runnable, checked
from sandbox.engine.inspect_elements import line_problems, load_problems, tendon_problems
from sandbox.engine.inspect_joints import joint_problems
from sandbox.engine.islands import DAMPING, STIFFNESS, TANGENTIAL
from sandbox.engine.readings import Readings
from sandbox.engine.sampler import Sampler
from sandbox.engine.start import Beginning, start
from sandbox.engine.steering import Steering
from sandbox.engine.tables import Tables, enlarged, make_tables
from sandbox.engine.touching import rows_for
from sandbox.engine.world import World
from sandbox.errors import (
    ControllerFailed,
    Interrupted,
    Problem,
    RecordingFull,
    SandboxError,
    SceneError,
    SimulationDiverged,
)
from sandbox.model.catalogue import Catalogue, UnknownQuantityError
from sandbox.model.compile import compile_mechanism
from sandbox.numeric import Array
from sandbox.recording.builder import RECORDED_BYTES, RecordingBuilder
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import (
    FAILED,
    INTERRUPTED,
    LIMITED,
    Happened,
    Outcome,
    Stop,
    step_notes,
)
from sandbox.values.expressions import Read
from sandbox.wording import WrongValueError, listed, near, quoted

BLOCK = 256
"""Most steps made in one go, so that Ctrl-C and the progress bar are never far."""
MOST_CONTACTS = 2000
"""In one step; room for twice as many takes up to 4 GB."""


class Simulation:
    """One run of a scene, from t = 0 to its end, as far as it was asked for.

    After k steps poses and forces belong to t = (k - 1/2) h, velocities to t = k h. The forces
    that are read are those of step k; where samples are several steps apart, they record means.

    Args:
        scene: a scene, an expanded mechanism, or what :func:`sandbox.load_scene` takes; its
            ``run`` says how long and how finely.
        controllers: Python callables that read and write while it runs, after the scene's own.
        recorded_bytes: the most that may be recorded, contacts included.

    Raises:
        SceneError: a controller or an event that reads or writes what the mechanism does
            not have; a joint along a line, or a tendon between guides, that has no direction.
    """

    def __init__(
        self, scene: Runnable, *, controllers: Sequence[Custom] = (),
        recorded_bytes: float = RECORDED_BYTES,
    ) -> None:
        began = time.perf_counter()
        self._customs = customs(controllers)
        self.mechanism = checked(scene, self._customs)
        run = self.mechanism.run
        if run.solver != "direct":
            raise _wrong(f"the solver {quoted(run.solver)} runs a scene in one go", "run.solver",
                         "'direct' in steps; sandbox.simulate, 'sandbox run' and 'sandbox sweep'")
        self._clock: Clock = make_clock(run.duration, run.step, run.sample_rate)
        self._model = compile_mechanism(self.mechanism)
        found = [*joint_problems(self._model), *tendon_problems(self._model),
                 *line_problems(self._model), *load_problems(self._model)]
        if blocking := [one for one in found if one.blocks]:
            raise SceneError(blocking)
        self._world = world = World(self._model)
        self._inputs = Inputs(world, self._clock)
        self._tables: Tables = make_tables(world)
        self._beginning = Beginning(self._tables)
        self._builder = self._room()
        self._most = recorded_bytes
        self._sampler = Sampler(world, self._tables, self._builder, self._clock.every)
        self._catalogue = Catalogue(self.mechanism)
        self._readings = Readings(world, self._tables, self._sampler, self._catalogue)
        self._read: dict[str, Read] = {}
        self._begin(began)

    def _begin(self, began: float) -> None:
        self._steering = Steering(self._model, self._clock, self._readings, self._customs)
        self._set: list[tuple[int, str, float | None]] = []
        """What was set from outside: after how many steps, of which drive, to what."""
        self._broke: list[Happened] = []
        self._done = 0
        self._failed: SandboxError | None = None
        """What ended it before its end: there is no going on."""
        self._steering.moved(0, self._inputs.rows(1, 1)[0])
        self._wall = {"build": time.perf_counter() - began, "simulate": 0.0}

    # -- where it stands --------------------------------------------------------------

    @property
    def time(self) -> float:
        """The instant that was come to [s]: the number of steps made, times the step."""
        return self._done * self._clock.step

    @property
    def steps(self) -> int:
        """Steps made so far."""
        return self._done

    @property
    def finished(self) -> bool:
        """Whether it came to its end, or an event or a divergence ended it."""
        return (self._done >= self._clock.steps or self._ended
                or self._failed is not None)

    @property
    def stopped(self) -> Stop | None:
        """What ended it before its time, an event or :class:`sandbox.StopRun`; None if nothing."""
        return self._steering.stopped if self._ended else None

    @property
    def _ended(self) -> bool:
        """Whether an event has stopped it; not before the first sample, to have one to look at."""
        return self._steering.stopped is not None and self._done >= self._clock.every

    def __getitem__(self, quantity: str) -> float:
        """What a quantity, a meter or an expression (``=a.x - b.x``) of them is now, in SI.

        Before the first step forces and tensions are 0.

        Raises:
            UnknownQuantityError: not in the catalogue; with a near miss.
            SceneError: worked out after a run only, such as ``work``; or not an
                expression.
        """
        if not isinstance(quantity, str):
            raise _wrong(f"{quantity!r} is not the name of a quantity", "simulation",
                         "a name such as 'finger.tendon.tension'")
        if quantity not in self._read:
            try:
                self._read[quantity] = self._readings.of(quantity)
            except UnknownQuantityError:
                raise
            except KeyError as error:
                raise SceneError([Problem("quantity-not-live", f"{quoted(error.args[0])} is "
                                          "computed after the run and cannot be read during it",
                                          quantity)]) from None
            except WrongValueError as error:
                raise SceneError([Problem.of(error, quantity)]) from None
        return self._read[quantity]()

    # -- going on ---------------------------------------------------------------------

    def step(self, n: int = 1) -> int:
        """Make ``n`` steps, or as many as are left; how many were made.

        Raises:
            SandboxError: as :meth:`run`.
        """
        n = _whole(n, "step")
        before = self._done
        self.run(before + n)
        return self._done - before

    def run(
        self, until: int | None = None, *, progress: Callable[[float], None] | None = None,
    ) -> None:
        """Go on until so many steps are made in all, by default to the end.

        Args:
            until: steps from t = 0.
            progress: called now and then with the fraction of the whole run done, 0 to 1.

        Raises:
            SceneError: no whole number of steps, or an input that cannot be computed at some time.
            SimulationDiverged: the motion stopped being finite; the error carries the
                recording so far.
            RecordingFull: more than allowed was recorded; it carries the recording, too.
            ControllerFailed: a controller in Python raised an exception; as RecordingFull.
            Interrupted: Ctrl-C; the error carries the recording so far. The step that it fell
                into is half made, so there is no going on after it, nor after any other error.
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
        except (SimulationDiverged, RecordingFull, ControllerFailed) as error:
            self._failed = error
            error.recording = self.recording()  # nothing goes on: it shares the memory
            raise
        except KeyboardInterrupt:
            recording = self.finish(INTERRUPTED)
            last = float(recording.time[-1]) if len(recording) else 0.0
            self._failed = Interrupted(last, recording=recording)
            raise self._failed from None
        except BaseException as error:
            self._failed = SandboxError(f"this simulation ended at t = {self.time:.6g} s: "
                                        f"{type(error).__name__}: {error}", code="run-ended")
            raise

    def _loop(self, until: int, progress: Callable[[float], None] | None) -> None:
        clock, inputs, steering, sampler = self._clock, self._inputs, self._steering, self._sampler
        most, every = min(BLOCK, inputs.at_once), clock.every
        steered, desk, done = bool(steering), steering.desk, self._done
        while done < until:
            count = min(most, until - done)
            if steered:
                steering.act(done)
                if self._ended:
                    break
                count = min(count, steering.ahead(done))
                if steering.stopped is not None:  # only as far as the first sample
                    count = min(count, every - done)
            drive = inputs.rows(done + 1, count)
            count = len(drive)
            desk.overlay(drive)
            inputs.apply(drive[0])
            speeds = inputs.speeds(done + 1, count)
            if done == 0:
                first = inputs.rows(1, 2).copy()
                desk.overlay(first)
            while done == 0 and not start(
                    self._world, self._tables, sampler.memory, first, speeds[:1]):
                found = int(self._world.finder.table[0])
                self._world.renew()  # results must not depend on what pymunk remembers of the try
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
            steering.moved(done, drive[-1])
            if progress is not None:
                progress(done / clock.steps)

    def _make_room(self, k: int) -> None:
        """Let step ``k`` go on, which was not made for want of room; raise what ended the run."""
        if self._sampler.full:  # first: a step that is half made may have to be kept, too
            self._sampler.make_room()
            if self._builder.recorded_bytes > self._most:
                raise RecordingFull(float(self._clock.force_time(k)), self._most)
        elif self._tables.state.touching[1]:
            self._enlarge()
        else:
            raise diverged(float(self._clock.force_time(k)), self._world, self._tables,
                           self._steering)

    def _enlarge(self, found: int | None = None) -> None:
        """Make room for ``found`` contacts, by default those of the step that is half made."""
        world, elements = self._world, self._tables.elements
        found = int(world.finder.table[0]) if found is None else found
        if found > MOST_CONTACTS:
            raise SandboxError(f"{found} contacts at once at t = {self.time:.6g} s, more than the "
                               f"{MOST_CONTACTS} that can be solved together: fewer or simpler "
                               "bodies may help", code="too-complex")
        rows = rows_for(len(elements.limits), len(elements.motors), len(elements.slips),
                        len(elements.dry_friction), found)
        world.enlarge(found, 4 * (rows + 1))
        self._tables = enlarged(self._tables, world.room)
        self._sampler.enlarge(self._tables)
        self._readings.tables = self._tables

    def set(self, drive: str, value: float | None) -> None:
        """Give a drive a value from the next step on, in SI; None lets it follow its signal again.

        Raises:
            SceneError: no such drive, a value that is no finite number, a drive that a controller
                or an event of the scene sets, or a run that is over.
        """
        if self.finished:
            raise SceneError([Problem("run-ended",
                                      f"the run is over, at t = {self.time:.6g} s", "set")])
        known = self._model.names.drive
        if drive not in known:
            raise SceneError([Problem(
                "name-not-found", f"there is no drive named {quoted(drive)}", "set",
                allowed=listed(known) or "none: the scene has no drives", hint=near(drive, known))])
        if value is not None and not (isinstance(value, Real) and math.isfinite(value)):
            raise _wrong(f"{value!r} is not a value for {quoted(drive)}", "set",
                         "a finite number, or None for the drive's signal")
        if owner := self._steering.writer(drive):
            raise SceneError([Problem("set-twice",
                                      f"the drive {quoted(drive)} is set by {quoted(owner)}",
                                      "set", allowed="a drive that nothing else sets")])
        self._set.append((self._done, drive, value))
        column = known[drive]
        self._steering.desk.set(column, value or 0.0, owned=value is not None)

    def restart(self) -> None:
        """Go back to t = 0, to what it was when it was made; drives follow their signals again.

        What follows is, to the last bit, what a new simulation would do, and takes a share of its
        time to begin: only pymunk's space is made anew. Recordings that were given away keep what
        they have. Python controllers are the same functions, as of :meth:`copy`.
        """
        began = time.perf_counter()
        self._world.renew()
        self._inputs = Inputs(self._world, self._clock)
        self._tables = self._beginning.restored()
        self._builder = self._room()
        self._sampler.restart(self._tables, self._builder)
        self._readings.tables = self._tables
        self._begin(began)

    def copy(self) -> Simulation:
        """Another simulation that stands where this one does, made by running it again.

        It takes as long as this one took: the state of pymunk's space cannot be copied to the last
        bit. Python controllers begin anew and are the same functions: they have to do the same when
        they read the same, and one that remembers would remember both runs.

        Raises:
            SandboxError: this one ended with an error, that error.
        """
        if self._failed is not None:
            raise self._failed
        other = Simulation(Checked(self.mechanism), controllers=self._customs,
                           recorded_bytes=self._most)
        for done, drive, value in self._set:
            other.run(done)
            other.set(drive, value)
        other.run(self._done)
        if self._ended:  # what stopped it acts before the step that it did not make
            other.run(self._done + 1)
        return other

    # -- what came of it ----------------------------------------------------------------

    def recording(self) -> Recording:
        """What was sampled so far, marked incomplete before the end; going on leaves it alone."""
        failed = self._failed
        reason = (INTERRUPTED if isinstance(failed, Interrupted)
                  else LIMITED if isinstance(failed, RecordingFull)
                  else f"{FAILED}{failed}" if isinstance(failed, ControllerFailed)
                  else str(failed) if isinstance(failed, SimulationDiverged) else "")
        return self.finish(reason, copied=not self.finished and failed is None)

    def finish(self, reason: str, *, copied: bool = False) -> Recording:
        """The recording of what was sampled so far, and why it ended if not as planned.

        If it is not ``copied`` it shares the memory that further steps would be written to.
        """
        self._sampler.write()
        samples = self._sampler.done + self._sampler.filled
        clock = self._clock
        steps = clock.sample_step(np.arange(samples))
        events, stopped, controllers = self._steering.info()
        complete = not reason and self.finished and self._failed is None
        return self._builder.finish(clock.force_time(steps), Outcome(
            complete=complete, reason=reason,
            step=clock.step, steps=clock.steps,
            sample_rate=1 / (clock.every * clock.step),
            versions={
                "sandbox": __version__, "pymunk": pymunk.version, "numpy": np.__version__,
                "numba": numba.__version__, "python": platform.python_version(),
            },
            wall=dict(self._wall), events=events, broke=tuple(self._broke), stopped=stopped,
            controllers=controllers, contact_solver=self._contact_solver(),
            notes=step_notes(self._done, relaxed=int(self._tables.state.standing[0]),
                             unordered=int(self._tables.state.standing[5])),
        ), copied=copied)

    def _contact_solver(self) -> dict[str, float]:
        """How contacts, limits and friction were solved: see :class:`Outcome`."""
        tables, accuracy = self._tables, self._tables.state.accuracy.tolist()
        if not (len(tables.constants.shapes) or len(tables.elements.limits)
                or len(tables.elements.motors)):
            return {}
        found = {"residual": accuracy[1], "time_s": accuracy[2] * self._clock.step,
                 "steps_above_1e-8": accuracy[4],
                 "relaxed_steps": float(self._tables.state.standing[0])}
        if accuracy[3]:
            found |= {"compliant_steps": accuracy[3], "stiffness": STIFFNESS, "damping": DAMPING,
                      "tangential": TANGENTIAL}
        return found

    def _room(self) -> RecordingBuilder:
        return RecordingBuilder(
            self.mechanism, self._clock.samples, self._statics(), apart=self._clock.every > 1,
            model=self._model)

    def _statics(self) -> dict[str, Array]:
        bodies, tables = self._model.bodies, self._tables
        tendons = len(self._model.tendons.name)
        return {"body_centre": bodies.centre, "body_mass": bodies.mass,
                "body_inertia": bodies.inertia,
                "tendon_initial": tables.elements.cables["length"][:tendons].copy(),
                "tendon_rest": tables.elements.cables["rest"][:tendons].copy()}


def _whole(number: object, path: str) -> int:
    if isinstance(number, Integral) and int(number) >= 0:
        return int(number)
    raise _wrong(f"{number!r} is no number of steps", path, "a whole number, 0 or more")


def _wrong(message: str, path: str, allowed: str) -> SceneError:
    return SceneError([Problem("bad-argument", message, path, allowed=allowed)])
