"""A scene as an environment of Gymnasium (Towers et al., Gymnasium, 2024)."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from sandbox.engine.inspect_control import Checked
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.errors import Problem, SandboxError, SceneError, SimulationDiverged
from sandbox.gym.task import Task
from sandbox.model.compile import compile_mechanism
from sandbox.numeric import Array
from sandbox.picture.frame import Picture
from sandbox.picture.frames import Frames
from sandbox.picture.scales import force_scale
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.settings import View
from sandbox.sweeps.spec import points_of
from sandbox.wording import listed, quoted


class SceneEnv(gymnasium.Env[Array, Array]):
    """An environment whose episodes are runs of a scene; :func:`sandbox.gym.make` makes one."""

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}  # noqa: RUF012  # as its base has it

    def __init__(self, task: Task, *, render_mode: str | None = None) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise SandboxError(f"there is no render_mode {quoted(render_mode)}; "
                               "allowed: 'rgb_array', None")
        self.task, self.render_mode = task, render_mode
        self.metadata = {**self.metadata, "render_fps": max(1, round(
            1 / (task.every * task.mechanism.run.step)))}
        self._low, self._high = np.array(list(task.observe.values())).T
        self.observation_space = Box(self._low, self._high, dtype=np.float64)
        self.action_space = Box(-1.0, 1.0, (len(task.act),), dtype=np.float64)
        self._min, maximum = np.array(list(task.act.values())).T
        self._half = (maximum - self._min) / 2
        self._values: dict[str, Any] = {}
        self._view: View | None = None
        self.simulation = Simulation(Checked(task.mechanism))
        """The simulation of this episode, to read; do not set or step it."""
        self.simulation.step()  # compile before any process forks
        self._last: Array = self._low
        self._actions: list[Array] = []
        self._over = "no episode has begun"

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None,
    ) -> tuple[Array, dict[str, Any]]:
        """Begin an episode; return the observation at t = 0 and the values that were drawn.

        Args:
            seed: of the random values from now on.
            options: ``{"set": {path: value}}`` changes the scene for this episode.

        Raises:
            SceneError: invalid values, or an unknown option.
        """
        super().reset(seed=seed)
        for name in options or {}:
            if name != "set":
                raise SceneError([Problem("bad-argument", f"there is no option {quoted(name)}",
                                          "options", allowed='{"set": values by path}')])
        values: dict[str, Any] = {}
        if self.task.random is not None:
            seeded = {"seed": int(self.np_random.integers(2**63 - 1))}
            values |= points_of(self.task.random.model_copy(update=seeded).dimensions())[0]
        values |= (options or {}).get("set", {})
        if values == self._values:
            self.simulation.restart()
        else:
            self.simulation, self._values = Simulation(Checked(self.task.loaded(values))), values
        self._actions, self._over = [], ""
        self._last = self._seen()
        return self._last.copy(), {"time": 0.0, "set": dict(values)}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Apply an action for an interval.

        Args:
            action: -1 (minimum) to 1 (maximum) for each drive, [na]; other values are clipped.

        Returns:
            Observation [no], reward, whether an event or a divergence ended the episode, whether
            its time is over, and a dictionary with details.

        Raises:
            SandboxError: the episode is over, the action has another shape or is not finite, or an
                observation or the reward is not finite.
        """
        if self._over:
            raise SandboxError(f"{self._over}: reset() begins one", code="run-ended")
        simulation, chosen = self.simulation, np.empty(0)
        with suppress(TypeError, ValueError):
            chosen = np.asarray(action, dtype=np.float64)
        if chosen.shape != self._half.shape or not np.isfinite(chosen).all():
            raise SandboxError(f"{quoted(action)} is no action; allowed: {len(self._half)} finite "
                               f"numbers, -1 to 1, for {listed(tuple(self.task.act))}")
        values = self._min + (np.clip(chosen, -1.0, 1.0) + 1.0) * self._half
        for drive, value in zip(self.task.act, values.tolist(), strict=True):
            simulation.set(drive, value)
        self._actions.append(values)
        try:
            simulation.step(self.task.every)
        except SimulationDiverged as error:
            self._over = f"the episode is over, {error}"
            return self._last.copy(), self.task.lost, True, False, {
                "time": simulation.time, "diverged": str(error)}
        info: dict[str, Any] = {"time": simulation.time}
        self._last = self._seen()
        wanted = self.task.reward
        reward = float(wanted(simulation) if callable(wanted) else simulation[wanted])
        if not np.isfinite(reward):
            raise SandboxError(f"the reward has no value at t = {simulation.time:.6g} s",
                               code="diverged")
        if over := simulation.finished:
            self._over = f"the episode is over, at t = {simulation.time:.6g} s"
        if stop := simulation.stopped:
            info |= {"stopped": stop.event, "because": stop.because, "verdict": stop.verdict}
        return self._last.copy(), reward, bool(stop), over and not stop, info

    def _seen(self) -> Array:
        found = {name: self.simulation[name] for name in self.task.observe}
        for name in found:
            if not np.isfinite(found[name]):
                raise SandboxError(f"{name!r} has no value at t = {self.simulation.time:.6g} s",
                                   code="diverged")
        return np.clip([*found.values()], self._low, self._high)

    def render(self) -> NDArray[np.uint8] | None:
        """A picture of the current state, [height, width, 3], RGB, as in films but without text.

        All pictures have one camera, which fits a run of the scene as it is, or the scene's view.
        """
        if self.render_mode is None:
            return None
        self._view = self._view or _fixed_view(self.task.mechanism)
        run = self.simulation.recording() or _first_sample(self.simulation.mechanism)
        picture = Picture(run, view=self._view, bare=True)
        return np.ascontiguousarray(Frames(picture).draw(float(run.time[-1])))

    def recording(self) -> Recording:
        """The recording of this episode so far."""
        return self.simulation.recording()

    def played(self) -> dict[str, Any]:
        """The actions of this episode as tables over time, with the drawn values, by path.

        A run of the scene with these overrides is bit-identical to the episode.
        """
        step, model = self.task.mechanism.run.step, compile_mechanism(self.simulation.mechanism)
        found = {**self.task.set, **self._values}
        for column, name in enumerate(self.task.act):
            # between the last step before and the first step after the change
            first = 0.25 + float(model.drives.late[model.names.drive[name]])
            found[f"drives[{name}].value"] = {"between": "step", "table": [
                [(k * self.task.every + first) * step, float(row[column])]
                for k, row in enumerate(self._actions)]}
        return found


def _fixed_view(mechanism: Mechanism) -> View:
    """A view with the camera and the scale of forces of a run of the scene, without text."""
    view = mechanism.view.model_copy(update={
        "meters": (), "show": {**mechanism.view.show, "names": ()}})
    try:
        run = simulate(Checked(mechanism))
    except SimulationDiverged as error:
        run = error.recording or _first_sample(mechanism)
    camera = Picture(run, view=view, bare=True).camera
    width = view.size[0] / camera.scale
    return view.model_copy(update={
        "centre": camera.centre, "width": width,
        "force_scale": force_scale(run, width, view).metres})


def _first_sample(mechanism: Mechanism) -> Recording:
    simulation = Simulation(Checked(mechanism))
    while not len(run := simulation.recording()):
        simulation.step()
    return run
