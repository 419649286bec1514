"""The task of an environment: observations, actions, reward and random values, all checked."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import partial
from typing import Any

import numpy as np

from sandbox.engine.inspect_control import LiveCatalogue, control_problems, unreadable
from sandbox.engine.simulation import Simulation
from sandbox.errors import Problem, SceneError
from sandbox.model.compile import compile_mechanism
from sandbox.model.model import Model
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.load import Loaded, read_scene
from sandbox.sweeps.job import STEP
from sandbox.sweeps.plan import plan_of
from sandbox.sweeps.spec import SweepSpec
from sandbox.sweeps.sweep import study_data
from sandbox.values.numbers import number_from
from sandbox.values.signals import values
from sandbox.values.units import RANGES, UNITS, unfit
from sandbox.wording import WrongValueError, is_pattern, listed, near, quoted, refuse_if

_refuse_if = partial(refuse_if, code="bad-argument")
Span = tuple[float, float]  # minimum and maximum, SI
Reward = Callable[[Simulation], float]
Wanted = str | Sequence[str] | Mapping[str, Sequence[float] | None]
Scene = str | os.PathLike[str] | Mapping[str, Any]
ROUNDING = 1e-6  # tolerance of a whole number of steps, relative to a step
DRAWN = 64  # samples that are checked when the environment is made
INSTANTS = 1001  # instants at which the range of a signal is determined


@dataclass(frozen=True)
class Task:
    """A checked task."""

    scene: Scene
    set: Mapping[str, Any]  # changes of the scene by path, for all episodes
    limits: Limits | None
    mechanism: Mechanism  # the scene with these changes
    observe: Mapping[str, Span]  # range of each observed quantity or expression
    act: Mapping[str, Span]  # values of each drive for actions of -1 and 1, SI
    reward: str | Reward
    every: int  # time steps for each action
    lost: float  # reward of a step in which the simulation diverges
    random: SweepSpec | None  # distributions of the values that are drawn for each episode

    def loaded(self, values: Mapping[str, Any]) -> Mechanism:
        """The scene with other values by path."""
        if not values:
            return self.mechanism
        found = read_scene(self.scene, overrides={**self.set, **values},
                           limits=self.limits).mechanism
        if found.run.step != self.mechanism.run.step:
            raise SceneError([Problem(
                "bad-argument",
                "all episodes have the same step: an action lasts a number of steps",
                STEP, allowed=f"set={{{STEP!r}: …}} when the environment is made")])
        return found


def read_task(
    scene: Scene, *, observe: Wanted, act: Wanted, reward: str | Reward,
    every: str | float = "20 ms", randomise: Mapping[str, Any] | None = None,
    set: Mapping[str, Any] | None = None, lost: float = 0.0, limits: Limits | None = None,
) -> Task:
    """Check the arguments of an environment.

    Args:
        scene: a file, the name of a shipped scene, or a mapping of what a file holds.
        observe: quantities, patterns and expressions (``"=a.x - b.x"``), or a mapping of these to
            (minimum, maximum); None takes the range from the scene.
        act: drives and patterns of drives, or a mapping of these to their values for actions of -1
            and 1, SI; None takes the range from the scene.
        reward: a quantity or an expression, read at the end of a step, or a function of the
            :class:`sandbox.Simulation`.
        every: duration of an action, ``"20 ms"`` or in seconds.
        randomise: values to draw for each episode by path, as ``vary`` of a sweep.
        set: other changes of the scene by path.
        lost: reward of a step in which the simulation diverges.
        limits: the largest scene that is accepted.

    Raises:
        SceneError: every problem of these and of the scene.
    """
    limits = limits or Limits()
    base = read_scene(scene, overrides=set, limits=limits)
    random = _random(scene, randomise, set or {}, limits) if randomise else None
    reader = _Reader(base)
    task = Task(scene, dict(set or {}), limits, base.mechanism, reader.observed(observe),
                reader.acted(act), reader.reward(reward), reader.every(every), reader.lost(lost),
                random)
    if reader.problems:
        raise SceneError(reader.problems, base.name)
    return task


class _Reader:
    """Reads the arguments and collects all problems."""

    def __init__(self, base: Loaded) -> None:
        self.mechanism = base.mechanism
        self.known = LiveCatalogue(self.mechanism)
        self.model = compile_mechanism(self.mechanism)
        self.problems = base.placed(control_problems(self.mechanism))

    @contextmanager
    def _at(self, path: str) -> Iterator[None]:
        """Collect what is refused in this context."""
        try:
            yield
        except WrongValueError as error:
            self.problems.append(Problem.of(error, path))

    def acted(self, wanted: Wanted) -> dict[str, Span]:
        drives = [drive.name for drive in self.mechanism.drives]
        actions: dict[str, Span] = {}
        writers = {drive: event.name for event in self.mechanism.events for drive in event.set}
        writers |= {drive: each.name for each in self.mechanism.controllers
                    for drive in each.written}
        for path, name, given in self._each(wanted, "act"):
            with self._at(path):
                if not (found := [each for each in drives if fnmatchcase(each, name)]):
                    raise WrongValueError(
                        "bad-argument", f"there is no drive named {quoted(name)}",
                        allowed=listed(drives) or "none: the scene has no drives",
                        hint=near(name, drives))
                for drive in found:
                    _refuse_if(drive in writers, f"the drive {quoted(drive)} is set by "
                               f"{quoted(writers.get(drive))}",
                               allowed="a drive that no controller and no event sets")
                    span = drive_range(self.model, drive) if given is None else _span(
                        given, self.known.find(f"{drive}.value").unit)
                    _refuse_if(span is None, f"the scene gives no range for {quoted(drive)}",
                               allowed=f"act={{{drive!r}: (lowest, highest)}}")
                    actions[drive] = span or (0.0, 1.0)
        return actions

    def observed(self, wanted: Wanted) -> dict[str, Span]:
        found: dict[str, Span] = {}
        for path, text, given in self._each(wanted, "observe"):
            with self._at(path):
                names = [text]
                if text.startswith("=") or not is_pattern(text):
                    self.problems += unreadable(text, self.known, path)
                elif not (names := [name for name in self.known.match(text)
                                    if not self.known.late([name])]):
                    hint = self.known.near(text)
                    raise WrongValueError(
                        "bad-argument", "no quantity that can be read during a run fits "
                        f"{quoted(text)}", hint=hint and quoted(hint))
                for name in names:
                    unit = self.known.find(name).unit if name in self.known else ""
                    largest = RANGES[UNITS[unit][1] if unit in UNITS else None].maximum
                    found[name] = _span(given, unit) if given is not None else \
                        self._stops(name) or (-largest, largest)
        return found

    def _stops(self, name: str) -> Span | None:
        """The range of the angle of a joint or a spring."""
        source = self.known.find(name) if name in self.known else None
        if source is None or source.quantity != "angle" or source.kind not in ("joint", "spring"):
            return None
        joint = source.index if source.kind == "joint" else self.model.springs.joint[source.index]
        return _finite(*self.model.joints.stops[joint].tolist())

    def reward(self, wanted: object) -> str | Reward:
        if callable(wanted):
            return wanted
        text = wanted.strip() if isinstance(wanted, str) else ""
        with self._at("reward"):
            _refuse_if(not text, f"{quoted(wanted)} is no reward",
                       allowed="a quantity, an expression of quantities, or a function")
            text = text if text.startswith("=") or text in self.known else f"={text}"
            self.problems += unreadable(text, self.known, "reward")
        return text

    def every(self, wanted: object) -> int:
        step, duration, steps = self.mechanism.run.step, self.mechanism.run.duration, 1
        with self._at("every"):
            seconds = number_from(wanted, "time", {})
            steps = max(1, round(seconds / step))
            _refuse_if(abs(steps * step - seconds) > ROUNDING * step,
                       f"{seconds:g} s is no whole number of steps of {step:g} s",
                       allowed=f"such as {steps * step:g} s")
            _refuse_if(seconds > duration, f"{seconds:g} s is longer than the run",
                       allowed=f"at most {duration:g} s")
        return steps

    def lost(self, wanted: object) -> float:
        with self._at("lost"):
            return float(number_from(wanted, None, {}))
        return 0.0

    def _each(self, wanted: Wanted, what: str) -> Iterator[tuple[str, str, object]]:
        """Path, name and range of each entry."""
        entries: list[tuple[str, Any, object]] = [(what, wanted, None)]
        if isinstance(wanted, Mapping):
            entries = [(f"{what}[{name!r}]", name, span) for name, span in wanted.items()]
        elif isinstance(wanted, Sequence) and not isinstance(wanted, str):
            entries = [(f"{what}[{i}]", name, None) for i, name in enumerate(wanted)]
        for path, name, span in entries or [(what, None, None)]:
            if isinstance(name, str):
                yield path, name, span
            else:
                self.problems.append(Problem(
                    "bad-argument", f"{quoted(name)} is no name" if entries else "it names nothing",
                    path, allowed="a list of names, or a mapping of names to (lowest, highest)"))


def _span(given: object, unit: str) -> Span:
    try:
        low, high = (number_from(one, None, {}) for one in given)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        low, high = 0.0, 0.0
    _refuse_if(not low < high, f"{quoted(given)} is no range", allowed="(lowest, highest), in SI")
    for wrong in (unfit(low, unit), unfit(high, unit)):
        _refuse_if(wrong, f"{wrong}, and this is in {unit}")
    return float(low), float(high)


def _random(
    scene: Scene, randomise: Mapping[str, Any], set: Mapping[str, Any], limits: Limits,
) -> SweepSpec:
    """Check the distributions with :data:`DRAWN` samples of the scene."""
    if not isinstance(randomise, Mapping):
        raise SceneError([Problem(
            "bad-argument", f"{randomise!r} names no range", "randomise",
            allowed='values by path: {"parameters.m": "normal(1 kg, 0.1 kg)"}')])
    group = {"over": dict(randomise), "design": "random", "count": DRAWN}
    try:
        spec = plan_of(study_data(scene, vary=[group], set=set, keep={"t": "=0"}), limits).spec
    except SceneError as error:
        raise SceneError([replace(each, path=re.sub(
            r"^\$(\.vary(\[0\](\.over)?)?)?", "randomise", each.path)) for each in error.problems],
            error.source) from None
    return spec.model_copy(update={"vary": (spec.vary[0].model_copy(update={"count": 1}),)})


def drive_range(model: Model, drive: str) -> Span | None:
    """The range of a drive by its stops, stroke, no-load speed or signal; None if there is none."""
    index = model.names.drive[drive]
    spec, kind = model.mechanism.drives[index], model.drives.kind[index]
    if kind.gives in ("hold", "opening"):  # fractions
        return 0.0, 1.0
    if kind.places:
        joint = int(model.drives.target[index])
        return _finite(*(model.joints.stops if kind.dimension == "angle" else model.joints.reach)
                      [joint].tolist())
    if (no_load := getattr(spec, "no_load", None)) is not None:
        return -float(no_load), float(no_load)
    try:
        found = values(spec.signal(model.mechanism),
                       np.linspace(0.0, model.mechanism.run.duration, INSTANTS),
                       model.mechanism.functions)
    except (ValueError, SceneError):
        return None
    low, high = min(0.0, float(found.min())), max(0.0, float(found.max()))
    return _finite(max(low, kind.floor), high)


def _finite(low: float, high: float) -> Span | None:
    return (low, high) if math.isfinite(low) and math.isfinite(high) and low < high else None
