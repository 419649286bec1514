"""A scene as an environment: actions set drives, observations are quantities, an episode is a run.

The interface is that of Gymnasium (Towers et al., Gymnasium: A Standard Interface for Reinforcement
Learning Environments, 2024).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from sandbox.engine.inspect_control import Checked
from sandbox.engine.simulation import Simulation
from sandbox.errors import Problem, SandboxError, SceneError, SimulationDiverged
from sandbox.gym.pictures import Pictures
from sandbox.gym.task import Task
from sandbox.model.compile import compile_mechanism
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.wording import listed, quoted

Info = dict[str, Any]
SEEDS = 2**63 - 1


class SceneEnv(gymnasium.Env[Array, Array]):
    """One run of a scene after the other, steered from outside.

    Args:
        task: what is seen and what acts.
        render_mode: ``"rgb_array"`` or None.

    Raises:
        SandboxError: another render mode.
        SceneError: the scene cannot be simulated.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}  # noqa: RUF012  # as its base has it

    def __init__(self, task: Task, *, render_mode: str | None = None) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise SandboxError(f"there is no render_mode {quoted(render_mode)}; "
                               "allowed: 'rgb_array', None")
        self.task, self.render_mode = task, render_mode
        self.metadata = {**self.metadata, "render_fps": max(1, round(
            1 / (task.every * task.clock.step)))}
        self._low, self._high = np.array(list(task.observe.values())).T
        self.observation_space = Box(self._low, self._high, dtype=np.float64)
        self.action_space = Box(-1.0, 1.0, (len(task.act),), dtype=np.float64)
        self._drives = tuple(task.act)
        self._least, most = np.array(list(task.act.values())).T
        self._half = (most - self._least) / 2
        self._values: dict[str, Any] = {}
        self._pictures: Pictures | None = None
        self.simulation = Simulation(Checked(task.mechanism))
        """The run of this episode, to look at; who sets or steps it goes beside the environment."""
        self.simulation.step()  # what has to be compiled is compiled now, and once for all forks
        self._last: Array = self._low
        self._acted: list[Array] = []
        self._over = "no episode has begun"

    # -- episodes -----------------------------------------------------------------------------

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None,
    ) -> tuple[Array, Info]:
        """Begin another episode; the observation at t = 0, and what was drawn for it.

        Args:
            seed: of all that is drawn from now on.
            options: ``{"set": {path: value}}`` changes the scene for this episode alone.

        Raises:
            SceneError: values that make no scene; an option that there is none of.
        """
        super().reset(seed=seed)
        values: dict[str, Any] = {}
        if self.task.draws is not None:
            values |= self.task.draws.drawn(int(self.np_random.integers(SEEDS)))
        values |= _set_of(options)
        if values == self._values:
            self.simulation.restart()
        else:
            self.simulation = Simulation(Checked(self.task.loaded(values)))
            self._values = values
        self._acted, self._over = [], ""
        self._last = self._seen()
        return self._last.copy(), {"time": 0.0, "set": dict(values)}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, Info]:
        """Let an action hold for an interval.

        Args:
            action: for each drive -1 (its lowest value) to 1 (its highest), [na]; what is beyond
                counts as -1 or 1.

        Returns:
            The observation [no], the reward, whether it was ended by an event or a divergence,
            whether the run's time is over, and what else there is to know.

        Raises:
            SandboxError: the episode is over; an action of another shape or without a value; an
                observation or a reward that has no value.
        """
        if self._over:
            raise SandboxError(f"{self._over}: reset() begins one", code="run-ended")
        simulation, chosen = self.simulation, _numbers(action)
        if chosen.shape != self._half.shape or not np.isfinite(chosen).all():
            raise SandboxError(f"{quoted(action)} is no action; allowed: {len(self._half)} finite "
                               f"numbers, -1 to 1, for {listed(self._drives)}")
        wanted = self._least + (np.clip(chosen, -1.0, 1.0) + 1.0) * self._half
        for drive, value in zip(self._drives, wanted.tolist(), strict=True):
            simulation.set(drive, value)
        self._acted.append(wanted)
        try:
            simulation.step(self.task.every)
        except SimulationDiverged as error:
            self._over = f"the episode is over, {error}"
            return self._last.copy(), self.task.lost, True, False, {
                "time": simulation.time, "diverged": str(error)}
        info: Info = {"time": simulation.time}
        self._last = self._seen()
        reward = self._reward()
        stop, over = simulation.stopped, simulation.finished
        if over:
            self._over = f"the episode is over, at t = {simulation.time:.6g} s"
        if stop is not None:
            info |= {"stopped": stop.event, "because": stop.because, "verdict": stop.verdict}
        return self._last.copy(), reward, stop is not None, over and stop is None, info

    def _seen(self) -> Array:
        """The observation now."""
        simulation = self.simulation
        found: Array = np.array([simulation[name] for name in self.task.observe])
        if not np.isfinite(found).all():
            bad = next(name for name, value in zip(self.task.observe, found, strict=True)
                       if not np.isfinite(value))
            raise SandboxError(f"{bad!r} has no value at t = {simulation.time:.6g} s",
                               code="diverged")
        return np.clip(found, self._low, self._high)

    def _reward(self) -> float:
        asked = self.task.reward
        value = float(asked(self.simulation) if callable(asked) else self.simulation[asked])
        if not np.isfinite(value):
            raise SandboxError(f"the reward has no value at t = {self.simulation.time:.6g} s",
                               code="diverged")
        return value

    # -- what came of it ----------------------------------------------------------------------

    def render(self) -> NDArray[np.uint8] | None:
        """The picture now, as films draw it: [height, width, 3], red, green, blue."""
        if self.render_mode is None:
            return None
        if self._pictures is None:
            self._pictures = Pictures(self.task.mechanism)
        return self._pictures.now(self.simulation)

    def recording(self) -> Recording:
        """The run of this episode so far, to plot, to save, to film."""
        return self.simulation.recording()

    def played(self) -> dict[str, Any]:
        """The actions of this episode as values of the scene, by path, for ``--set``.

        With them a run of the scene is this episode, to the last bit. Values of each drive are a
        table of time; what was drawn stands beside them.
        """
        clock, model = self.task.clock, compile_mechanism(self.simulation.mechanism)
        found = {**self.task.set, **self._values}
        for column, name in enumerate(self._drives):
            # between the instants for which the last step before and the first one after ask
            first = 0.25 + float(model.drives.late[model.names.drive[name]])
            found[f"drives[{name}].value"] = {"between": "step", "table": [
                [(k * self.task.every + first) * clock.step, float(row[column])]
                for k, row in enumerate(self._acted)]}
        return found

    def close(self) -> None:
        """Nothing is left open."""
        self._pictures = None


def _numbers(action: object) -> Array:
    """An action as numbers; none where it has no such."""
    try:
        return np.asarray(action, dtype=np.float64)
    except (TypeError, ValueError):
        return np.empty(0)


def _set_of(options: Mapping[str, Any] | None) -> dict[str, Any]:
    """What an episode's options change.

    Raises:
        SceneError: anything else.
    """
    options = options or {}
    if not isinstance(options, Mapping):
        raise SceneError([Problem("bad-argument",
                                  f"{quoted(options)} does not say what is changed", "options",
                                  allowed='{"set": values by path}')])
    if unknown := [name for name in options if name != "set"]:
        raise SceneError([Problem("bad-argument",
                                  f"there is no option {quoted(unknown[0])}", "options",
                                  allowed="'set'")])
    values = options.get("set", {})
    if not isinstance(values, Mapping):
        raise SceneError([Problem("bad-argument",
                                  f"{quoted(values)} does not say what is changed", "options.set",
                                  allowed="values by path")])
    return dict(values)
