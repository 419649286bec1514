"""Forces in given poses of a mechanism: steps from given poses, speeds and values of drives."""

from __future__ import annotations

import math

import numpy as np

from sandbox.engine.advance import UNKEPT, advance
from sandbox.engine.divergence import diverged
from sandbox.engine.inspect_control import Checked
from sandbox.engine.simulation import Simulation
from sandbox.errors import SimulationDiverged
from sandbox.numeric import Array, Integers
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Outcome
from sandbox.scene.mechanism import Mechanism

UNDAMPED = 1e-9  # share of the damping of hinges, which only delays the rest


class Still(Simulation):
    """A mechanism without time, controllers and events; bodies have the numbers of the model."""

    def __init__(self, mechanism: Mechanism) -> None:
        bodies = tuple(
            body.model_copy(update={"velocity": (0.0, 0.0), "angular_velocity": 0.0})
            if body.motion == "dynamic" else body for body in mechanism.bodies)
        super().__init__(Checked(mechanism.model_copy(update={
            "bodies": bodies, "controllers": (), "events": (), "expect": ()})))
        self.model = self._model
        springs = self._tables.elements.springs
        springs["c"][springs["number"] < 0] *= UNDAMPED
        self.mass: Array = np.stack(
            [self.model.bodies.mass, self.model.bodies.mass, self.model.bodies.inertia], axis=1)
        """[kg, kg, kg m^2], [nb, 3]; infinite unless free."""

    @property
    def step_size(self) -> float:
        """The scene's step [s]."""
        return self._clock.step

    @property
    def margin(self) -> float:
        """Least distance at which contacts are detected [m]; inf without shapes."""
        return float(self._world.shape_tables.shapes["margin"].min(initial=np.inf))

    @property
    def pose(self) -> Array:
        """x, y [m] of the centres of mass, angles [rad], [nb, 3]."""
        return np.array(self._world.body[self._world.number, :3])

    @property
    def speed(self) -> Array:
        """Their rates after the last step, [nb, 3]."""
        return np.array(self._world.body[self._world.number, 3:])

    def put(self, pose: Array) -> None:
        """Put all bodies to a pose, at rest."""
        self._tables.place(pose[self._world.order], np.zeros_like(pose))
        self._tables.state.standing[1] = 0

    def slow(self, share: float) -> None:
        """Multiply the speeds of the bodies by a share."""
        self._world.velocity[:] = share * self._world.body[:, 3:]
        self._tables.state.standing[1] = 0

    def driven(self, time: float) -> tuple[Array, Array]:
        """Values of the drives at a time [nd], and where scheduled bodies are then, [ns, 3]."""
        step = min(max(1, math.ceil(time / self._clock.step)), self._clock.steps)
        return np.array(self._inputs.rows(step, 1)[0]), self._inputs.places(step)

    @property
    def scheduled(self) -> Integers:
        """Numbers of the bodies that move as the scene says, in the order of :meth:`driven`."""
        return self._world.order[self._tables.constants.scheduled]

    def move(self, drive: Array, *, count: int = 1, kept: bool = False) -> None:
        """Make steps with constant drives [nd], in which scheduled bodies do not move."""
        self._inputs.apply(drive)
        rows = np.tile(drive, (count, 1))
        after = np.zeros((count, len(self.scheduled), 3))
        if kept:
            self._sampler.kept.taken[:] = 0
        made = 0
        while True:
            address, h, _ = self._sampler.memory
            due = count - made if kept else UNKEPT
            made += advance(address, h, rows[made:], after[made:], due, 1)
            if made == count:
                return
            if not self._tables.state.touching[1]:
                found = diverged(0.0, self._world, self._tables, self._control)
                raise SimulationDiverged(0.0, found.culprit, found.reason.partition("; ")[0])
            self._enlarge()

    def recording(self) -> Recording:
        """The sample of the last step that was ``kept``."""
        self._sampler.builder = builder = self._make_builder(1)
        self._sampler.write()
        clock = self._clock
        return builder.finish(np.array([float(clock.force_time(clock.steps))]), Outcome(
            step=clock.step, steps=clock.steps, sample_rate=1 / clock.step))
