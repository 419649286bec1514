"""The loop: forces, step, sample. Everything of substance is in the modules it calls."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable, Sequence
from typing import Any

import numba
import numpy as np
import pymunk
from numpy.typing import NDArray

from sandbox import __version__
from sandbox.control.custom import Custom
from sandbox.engine.advance import advance
from sandbox.engine.clock import Clock, make_clock
from sandbox.engine.inputs import Inputs
from sandbox.engine.inspect_control import refuse
from sandbox.engine.readings import Readings
from sandbox.engine.sampler import Sampler
from sandbox.engine.steering import Steering
from sandbox.engine.tables import Tables, make_tables
from sandbox.engine.world import World
from sandbox.errors import Interrupted, SimulationDiverged
from sandbox.model.catalogue import Catalogue
from sandbox.recording.builder import RecordingBuilder
from sandbox.recording.recording import Recording
from sandbox.scene.document import Scene
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism

Array = NDArray[np.float64]

BLOCK = 256
"""Most steps made in one go, so that Ctrl-C and the progress bar are never far."""


def simulate(
    scene: Scene | Mechanism, *, progress: Callable[[float], None] | None = None,
    controllers: Sequence[Custom] = (),
) -> Recording:
    """Run a scene from t = 0 and return what it did.

    Args:
        scene: a scene or an expanded mechanism; its ``run`` says how long and how finely.
        progress: called now and then with the share done, 0 to 1.
        controllers: Python callables that read and write while it runs, after the scene's own.

    Raises:
        SceneError: an input that cannot be computed at some time; a controller or an event
            that reads or writes what the mechanism does not have.
        SimulationDiverged: the motion stopped being finite; the error carries the recording.
        Interrupted: Ctrl-C; the error carries the recording.
    """
    mechanism = expand(scene) if isinstance(scene, Scene) else scene
    refuse(mechanism, controllers)
    run = _Run(mechanism, controllers)
    try:
        run.loop(progress)
    except KeyboardInterrupt:
        recording = run.finish("interrupted")
        end = float(recording.time[-1]) if len(recording.time) else 0.0
        raise Interrupted(end, recording) from None
    except SimulationDiverged as error:
        error.recording = run.finish(str(error))
        raise
    return run.finish("")


class _Run:
    """A world, its tables, and what is being recorded of it."""

    def __init__(self, mechanism: Mechanism, controllers: Sequence[Custom]) -> None:
        began = time.perf_counter()
        self.mechanism = mechanism
        self.clock: Clock = make_clock(
            mechanism.run.duration, mechanism.run.step, mechanism.run.sample_rate)
        self.world = World(mechanism)
        self.tables: Tables = make_tables(
            mechanism, self.clock.step, self.world.number, self.world.mass,
            self.world.motor_impulses)
        self.inputs = Inputs(self.world, self.clock)
        self.builder = RecordingBuilder(mechanism, self.clock.samples, self._statics())
        self.sampler = Sampler(self.world, self.tables, self.builder)
        self.before: Array = self.world.state[:, 3:].copy()
        readings = Readings(self.world, self.tables, self.before, self.sampler,
                            Catalogue(mechanism))
        self.steering = Steering(mechanism, self.clock, readings, controllers)
        self.began, self.built = began, time.perf_counter()

    def loop(self, progress: Callable[[float], None] | None) -> None:
        world, clock, before = self.world, self.clock, self.before
        inputs, steering = self.inputs, self.steering
        arguments = self.tables.arguments()
        most = min(BLOCK, inputs.at_once)
        inputs.steer(1)
        steering.moved(0, inputs.rows(1, 1)[0])
        steered, desk, done = bool(steering), steering.desk, 0
        while done < clock.steps:
            count = min(most, clock.every - done % clock.every, clock.steps - done)
            if steered:
                steering.act(done)
                if steering.stopped is not None and done >= clock.every:
                    break  # not before the first sample: there would be nothing to look at
                count = min(count, steering.ahead(done))
            drive = inputs.rows(done + 1, count)
            desk.overlay(drive)
            inputs.apply(drive[0])
            made = advance(
                clock.step, world.addresses, world.reader.count, world.writer.count,
                world.state, before, world.predicted, world.force, drive, *arguments)
            if made < count:
                self._stop(done + made + 1)
            done += count
            inputs.steer(done + 1)
            if done % clock.every == 0:
                self.sampler.sample(before, drive[-1])
            if steered:
                steering.moved(done, drive[-1])
            if progress is not None:
                progress(done / clock.steps)

    def _stop(self, k: int) -> None:
        """Give up after step k, naming the body that is worst and the loop that led there."""
        state = np.abs(self.world.state)
        finite = np.isfinite(state).all(axis=1)
        worst = np.argmin(finite) if not finite.all() else np.argmax(state.max(axis=1))
        reason = ("its motion has run away" if finite.all()
                  else "its motion is no longer a number")
        helps = f"a smaller run.step than {self.clock.step:g} s, or softer springs, may help"
        if loop := self.steering.furthest():
            reason += f", led by {loop}"
            helps = f"gains of the other sign, smaller ones or limits may help; or {helps}"
        raise SimulationDiverged(
            float(self.clock.force_time(k)), self.mechanism.bodies[self.world.order[worst]].name,
            f"{reason}; {helps}",
        )

    def _statics(self) -> dict[str, Array]:
        names = [body.name for body in self.mechanism.bodies]
        mass = self.world.mass
        return {
            "body_centre": np.array(
                [mass[n].centre if n in mass else (0.0, 0.0) for n in names]).reshape(-1, 2),
            "body_mass": np.array([mass[n].mass if n in mass else np.inf for n in names]),
            "body_inertia": np.array([mass[n].inertia if n in mass else np.inf for n in names]),
            "tendon_initial": self.tables.spans["length"].copy(),
            "tendon_rest": self.tables.spans["rest"].copy(),
        }

    def finish(self, reason: str) -> Recording:
        """The recording of what was sampled so far; complete if there is no ``reason``."""
        self.sampler.flush()
        samples = self.sampler.done
        steps = self.clock.sample_step(np.arange(samples))
        self.builder.arrays["time"][:samples] = self.clock.force_time(steps)
        ended = time.perf_counter()
        info: dict[str, Any] = {
            "complete": not reason, "reason": reason,
            "step": self.clock.step, "steps": self.clock.steps, "seed": 0,
            "iterations": self.mechanism.run.iterations,
            "sample_rate": 1 / (self.clock.every * self.clock.step),
            "versions": {
                "sandbox": __version__, "pymunk": pymunk.version, "numpy": np.__version__,
                "numba": numba.__version__, "python": platform.python_version(),
            },
            "wall_s": {"build": self.built - self.began, "simulate": ended - self.built},
            **self.steering.info(),
        }
        return self.builder.finish(samples, info)
