"""What an environment is made of: names checked against the scene, with a range for each.

All that can be wrong is told at once, before anything runs.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Any

from sandbox.engine.clock import Clock, make_clock
from sandbox.engine.inspect_control import LiveCatalogue, control_problems, unreadable
from sandbox.engine.simulation import Simulation
from sandbox.errors import Problem, SceneError
from sandbox.gym.draws import Draws, read_draws
from sandbox.gym.spans import Span, acted, observed
from sandbox.model.compile import compile_mechanism
from sandbox.scene.elements.controllers import writes_of
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.load import Loaded, read_scene
from sandbox.scene.values.numbers import number_from
from sandbox.scene.values.units import unfit
from sandbox.sweeps.job import STEP
from sandbox.wording import WrongValueError, is_pattern, listed, near, quoted

Reward = Callable[[Simulation], float]
Asked = str | Sequence[str] | Mapping[str, Sequence[float] | None]
Scene = str | os.PathLike[str] | Mapping[str, Any]
WORTH = 1e-6
"""By how much of a step an interval may miss a whole number of them."""


@dataclass(frozen=True)
class Task:
    """What an environment does, all of it checked."""

    scene: Scene
    set: Mapping[str, Any]
    """What is changed in the scene, in all episodes."""
    limits: Limits | None
    mechanism: Mechanism
    """The scene with that, before anything is drawn."""
    observe: Mapping[str, Span]
    """Quantities and expressions, each with the least and largest value that it is given as."""
    act: Mapping[str, Span]
    """Drives, each with what an action of -1 and of 1 sets it to, in SI."""
    reward: str | Reward
    every: int
    """Steps between two actions."""
    lost: float
    """The reward of the step in which a motion stopped being finite."""
    draws: Draws | None
    """What is drawn anew for each episode."""

    @property
    def clock(self) -> Clock:
        """That of a run of the scene."""
        run = self.mechanism.run
        return make_clock(run.duration, run.step, run.sample_rate)

    def loaded(self, values: Mapping[str, Any]) -> Mechanism:
        """The scene with other values by path.

        Raises:
            SceneError: they make no scene.
        """
        if not values:
            return self.mechanism
        found = read_scene(self.scene, overrides={**self.set, **values},
                           limits=self.limits).mechanism
        if found.run.step != self.mechanism.run.step:
            raise SceneError([same_step()])
        return found


def same_step() -> Problem:
    """What is wrong with episodes that have steps of their own."""
    return Problem("bad-argument",
                   "the step is the same in all episodes: an action holds for a number of steps",
                   STEP, allowed=f"set={{{STEP!r}: …}} when the environment is made")


def read_task(
    scene: Scene, *, observe: Asked, act: Asked, reward: str | Reward,
    every: str | float = "20 ms", randomise: Mapping[str, Any] | None = None,
    set: Mapping[str, Any] | None = None, lost: float = 0.0, limits: Limits | None = None,
) -> Task:
    """Look over what an environment shall be made of.

    Args:
        scene: a file, the name of a shipped scene, or a mapping of what a file holds.
        observe: quantities, patterns and expressions (``"=a.x - b.x"``); or a mapping of such to
            their (least, largest) value, None for what the scene says.
        act: drives and patterns of drives; or a mapping of such to what actions of -1 and 1 set
            them to, in SI, None for what the scene says.
        reward: a quantity or an expression, whose value at a step's end is its reward; or a
            function that is given the :class:`sandbox.Simulation`, which it reads.
        every: how long an action holds, ``"20 ms"`` or in seconds.
        randomise: what paths of the scene are given in each episode, as ``vary`` of a sweep has it.
        set: what else is changed in the scene, by path.
        lost: the reward of the step in which the motion diverged.
        limits: how large the scene may be.

    Raises:
        SceneError: every problem of these and of the scene.
    """
    limits = limits or Limits()
    base: Loaded = read_scene(scene, overrides=set, limits=limits)
    if isinstance(randomise, Mapping) and STEP in randomise:
        raise SceneError([same_step()])
    draws = read_draws(scene, randomise, set or {}, limits) if randomise else None
    reading = _TaskReader(base)
    task = Task(scene, dict(set or {}), limits, base.mechanism,
                reading.observed(observe, reading.acted(act)), reading.actions,
                reading.reward(reward), reading.every(every), reading.number(lost, "lost"), draws)
    reading.refuse()
    return task


@dataclass
class _TaskReader:
    """A task on its way, and what is wrong with it so far."""

    base: Loaded
    problems: list[Problem] = field(default_factory=list)
    actions: dict[str, Span] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.mechanism = self.base.mechanism
        self.known = LiveCatalogue(self.mechanism)
        self.model = compile_mechanism(self.mechanism)
        self.problems += self.base.placed(control_problems(self.mechanism))

    def refuse(self) -> None:
        """Stop here if anything is wrong."""
        if self.problems:
            raise SceneError(self.problems, self.base.name)

    def acted(self, asked: Asked) -> Mapping[str, Span]:
        """Ranges of drives."""
        drives = [drive.name for drive in self.mechanism.drives]
        for path, name, given in self._each(asked, "act"):
            found = _fitting(name, drives)
            if not found:
                self._wrong(f"there is no drive named {quoted(name)}", path,
                            listed(drives) or "none: the scene has no drives", near(name, drives))
            for drive in found:
                if owner := self._writer(drive):
                    self._wrong(f"the drive {quoted(drive)} is set by {quoted(owner)}", path,
                                "a drive that no controller and no event sets")
                span = acted(self.model, drive) if given is None else self._span(
                    given, path, self.known.find(f"{drive}.value").unit)
                if span is None and given is None:
                    self._wrong(f"the scene does not say between which values {quoted(drive)} "
                                "moves", path, f"act={{{drive!r}: (lowest, highest)}}")
                self.actions[drive] = span or (0.0, 1.0)
        if not self.actions and not self.problems:
            self._wrong("nothing acts", "act", "at least one drive")
        return self.actions

    def observed(self, asked: Asked, actions: Mapping[str, Span]) -> dict[str, Span]:
        """Ranges of what is seen."""
        found: dict[str, Span] = {}
        for path, text, given in self._each(asked, "observe"):
            for name in self._quantities(text, path):
                span = observed(self.model, self.known, name, actions) if given is None else \
                    self._span(given, path, self.known.find(name).unit if name in self.known
                               else "")
                found[name] = span or (0.0, 1.0)
        if not found and not self.problems:
            self._wrong("nothing is observed", "observe", "at least one quantity")
        return found

    def _quantities(self, text: str, path: str) -> list[str]:
        if text.startswith("=") or not is_pattern(text):
            return [text] if self._readable(text, path) else []
        names = [name for name in self.known.match(text) if not self.known.late([name])]
        if not names:
            hint = self.known.near(text)
            self._wrong(f"no quantity that can be read while it runs fits {quoted(text)}", path,
                        hint=quoted(hint) if hint else "")
        return names

    def _readable(self, text: str, path: str) -> bool:
        try:
            problems = list(unreadable(text, self.known, path))
        except WrongValueError as error:
            problems = [Problem.of(error, path)]
        self.problems += problems
        return not problems

    def reward(self, asked: object) -> str | Reward:
        """A function, or a text that a simulation can read."""
        if callable(asked):
            return asked
        if not isinstance(asked, str) or not asked.strip():
            self._wrong(f"{quoted(asked)} is no reward", "reward",
                        "a quantity, an expression of quantities, or a function")
            return ""
        text = asked.strip()
        text = text if text.startswith("=") or text in self.known else f"={text}"
        self._readable(text, "reward")
        return text

    def every(self, asked: object) -> int:
        """Steps of an interval."""
        step = self.mechanism.run.step
        try:
            seconds = float(number_from(asked, "time", {}))
        except WrongValueError as error:
            self._wrong(error.message, "every", error.allowed, error.hint)
            return 1
        steps = round(seconds / step)
        if steps < 1 or abs(steps * step - seconds) > WORTH * step:
            self._wrong(f"{seconds:g} s is no whole number of steps of {step:g} s", "every",
                        f"such as {max(1, steps) * step:g} s")
        elif seconds > self.mechanism.run.duration:
            self._wrong(f"{seconds:g} s is longer than the run", "every",
                        f"at most {self.mechanism.run.duration:g} s")
        return max(1, steps)

    def number(self, asked: object, path: str) -> float:
        """A finite number."""
        try:
            return float(number_from(asked, None, {}))
        except WrongValueError as error:
            self._wrong(error.message, path, error.allowed, error.hint)
            return 0.0

    def _span(self, given: object, path: str, unit: str) -> Span | None:
        """The (lowest, highest) that was given, of something in this SI unit."""
        try:
            low, high = (number_from(one, None, {}) for one in given)  # type: ignore[attr-defined]
        except (TypeError, ValueError):
            low, high = 0.0, 0.0
        if not low < high:
            self._wrong(f"{quoted(given)} is no range", path, "(lowest, highest), in SI")
            return None
        for each in (low, high):
            if wrong := unfit(each, unit):
                self._wrong(f"{wrong}, and this is in {unit}", path)
        return float(low), float(high)

    def _each(self, asked: Asked, what: str) -> Iterator[tuple[str, str, object]]:
        """Place, text and range of each of several names."""
        if isinstance(asked, Mapping):
            pairs = [(f"{what}[{name!r}]", name, span) for name, span in asked.items()]
        elif isinstance(asked, str):
            pairs = [(what, asked, None)]
        elif isinstance(asked, Sequence):
            pairs = [(f"{what}[{i}]", name, None) for i, name in enumerate(asked)]
        else:
            pairs = [(what, asked, None)]
        for path, name, span in pairs:
            if isinstance(name, str):
                yield path, name, span
            else:
                self._wrong(f"{quoted(name)} is no name", path, "a list of names, or a mapping "
                            "of names to (lowest, highest)")

    def _writer(self, drive: str) -> str:
        owners = [each.name for each in self.mechanism.controllers if drive in writes_of(each)]
        owners += [event.name for event in self.mechanism.events if drive in event.set]
        return owners[0] if owners else ""

    def _wrong(self, message: str, path: str, allowed: str = "", hint: str = "") -> None:
        self.problems.append(Problem("bad-argument", message, path, allowed=allowed, hint=hint))


def _fitting(text: str, names: Sequence[str]) -> list[str]:
    """The names that are a text, or fit it as a pattern."""
    return [name for name in names if fnmatchcase(name, text)]
