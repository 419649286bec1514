"""An interactive run of a scene: executes messages, advances the time, makes frames.

It has no transport: see :mod:`sandbox.web.server`.
"""

from __future__ import annotations

import contextlib
import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from sandbox.engine.inspect_control import Checked
from sandbox.engine.live import Hand, Live
from sandbox.engine.simulate import simulate
from sandbox.errors import SandboxError, SceneError
from sandbox.model.catalogue import UnknownQuantityError
from sandbox.scene.expand import to_json
from sandbox.scene.read.load import Loaded
from sandbox.values.expressions import is_expression
from sandbox.values.units import dimension_of, units_of
from sandbox.web.controls import PARAMETER, Spans, changes, controls, read_value
from sandbox.web.frames import AT_ONCE, LOOK, LiveFrames, looked_at
from sandbox.wording import WrongValueError, listed, near, quoted, refuse_if

FRAME = 1 / 60  # seconds from frame to frame
BUDGET = 0.012  # seconds that the steps of a frame may take; motion is slower if they take longer
MIN_SPEED, MAX_SPEED = 0.01, 4.0  # seconds of motion per second
MAX_METERS, FIRST_METERS = 12, 4
"""Meters of a live view that run at once; of usual quantities at first."""
QUICK_LOOK = 0.2
"""Seconds of the trial run after a parameter was set, so that a slider is not held up."""
ACTIONS = ("run", "pause", "step", "back", "reset")
Answer = dict[str, Any]


class Found(NamedTuple):
    """A scene that was read."""

    loaded: Loaded
    warnings: Sequence[str] = ()  # of the check of the scene, a line each


Read = Callable[[Mapping[str, Any]], Found]


class Session:
    """One scene that runs and is changed by messages.

    ``read`` reads the scene with values that replace those of its file (``overrides`` at first); it
    is called again when a file or a parameter changes. ``place`` gives the directory for a run of
    some name. Raises SceneError if the scene cannot be used.
    """

    def __init__(
        self, read: Read, overrides: Mapping[str, Any], place: Callable[[str], Path],
    ) -> None:
        self._read, self._place = read, place
        self.overrides = dict(overrides)
        self.playing = True
        self.trouble = ""  # the error that ended the run, or that of the scene's file
        self.rate = 0.0  # recent seconds of motion per second
        self.seq = self.ack = 0
        self.closed: Callable[[], bool] = bool
        """Whether the page was closed: long work is then given up."""
        self._watched: list[str] | None = None
        self._layers: set[str] | None = None
        self._spans: Spans = {}
        self._open(read(self.overrides))
        self.speed = min(max(self.scene.view.speed, MIN_SPEED), MAX_SPEED)

    def _open(self, found: Found, look: float = LOOK) -> None:
        """Begin with a scene that was read; ``look`` are seconds of the trial run."""
        scene = Checked(found.loaded.mechanism)
        look_at = looked_at(scene, look)
        self.loaded, self.warnings = found
        self.scene, self._look = self.loaded.mechanism, look_at
        self._before: list[tuple[int, Found, dict[str, Any]]] = []
        """Steps, scene and overrides before each parameter that was set during the run."""
        self._begin(Live(scene))

    def _begin(self, live: Live) -> None:
        """Continue with another run of the scene."""
        self.live, self.hand, self.frames = live, Hand(live), LiveFrames(live, self._look)
        self.trouble, self._due = "", 0.0
        self._end = round(live.scene.run.duration / live.scene.run.step)
        """Steps to the end of the scene, where it pauses once."""
        if self._layers is not None:
            self.frames.layers = self._layers
        watched = self._watched
        if watched is None:  # at first the view's meters, else the usual quantities
            shown = dict.fromkeys(name for meter in self.frames.meters for name in meter["names"])
            usual = ([name for name in names if name in self.frames.units]
                     for names in self._look.catalogue.usual.values())
            watched = [*shown][:MAX_METERS] or next(filter(None, usual), [])[:FIRST_METERS]
        self.frames.watched = [name for name in watched if name in self.frames.units or (
            "/" in name and name in self._look.catalogue)]

    # -- answers ---------------------------------------------------------------------------

    def head(self) -> Answer:
        """All data that a page needs before the first frame."""
        return {"head": {**self.frames.drawing(), **self._controls(),
                         "watched": self.frames.watched}}

    def status(self) -> Answer:
        """The texts beside the picture: whether it runs, how fast, errors."""
        note = ""
        if not self.playing and self.live.steps == self._end:
            note = (f"The scene ends at {self.scene.run.duration:.6g} s. "
                    "Press run to continue, or reset to go back to the start.")
        # without the folder of the scene's file, which the user knows
        trouble, *warnings = (text.replace(self.loaded.name, Path(self.loaded.name).name)
                              for text in (self.trouble or self.live.ending, *self.warnings))
        return {"status": {"playing": self.playing, "speed": self.speed, "note": note,
                           "trouble": trouble, "warnings": warnings,
                           "left_out": self.frames.left_out}}

    def relisted(self) -> list[Answer]:
        """The display list, if it differs from that of the page; to be sent before the frame."""
        found = self.frames.relisted()
        return [{"relisted": found}] if found else []

    def frame(self) -> bytes:
        """The present instant; see :mod:`sandbox.web.frames`."""
        self.seq += 1
        hand, held = self.hand, self.hand.body
        place = hand.point()[0] if held is not None else (0.0, 0.0)
        return self.frames.frame((
            self.seq, self.ack, self.live.time, self.rate,
            -1 if held is None else hand.model.names.body[held], *place, *hand.force))

    # -- time -------------------------------------------------------------------------------

    def advance(self, seconds: float, budget: float = BUDGET) -> None:
        """Advance by some seconds, or as far as the budget allows [s of the clock]."""
        step = self.scene.run.step
        self._due += seconds * self.speed / step
        wanted, made = int(self._due), 0
        self._due -= wanted
        left = self._end - self.live.steps
        wanted = min(wanted, left) if left > 0 else wanted
        began = time.perf_counter()
        while made < wanted and not self.live.finished and time.perf_counter() - began <= budget:
            made += self._go(min(wanted - made, AT_ONCE))
        self.rate += 0.1 * (made * step / seconds - self.rate)
        if self.live.finished or 0 < left <= made:
            self.playing = False

    def _go(self, steps: int) -> int:
        """Make up to some steps; an error ends the run and is reported."""
        try:
            self.hand.draw()
            return self.live.step(steps if self.hand.body is None else min(steps, self.hand.every))
        except SandboxError as error:
            self.trouble, self.playing = str(error), False
            return steps

    def reload(self) -> bool:
        """Read the scene's file again with the present values of the parameters that it still has.

        Returns whether it can be used; if not, the run continues, and the problem is reported.
        """
        others = {name: value for name, value in self.overrides.items()
                  if not name.startswith(PARAMETER)}
        try:
            known = self._read(others).loaded.scene.parameters
            values = {name: value for name, value in self.overrides.items()
                      if name in others or name.removeprefix(PARAMETER) in known}
            self._open(self._read(values))
        except SandboxError as error:
            self.trouble = str(error)
            return False
        self.overrides, self._spans = values, {}
        return True

    # -- messages ---------------------------------------------------------------------------

    def handle(self, text: str | bytes) -> Sequence[Answer | Callable[[], Answer]]:
        """Execute a message and return the answers; no message raises an error.

        An answer that takes long is a function, which may be called in a thread.
        """
        answers: Sequence[Answer | Callable[[], Answer]]
        message: Any = None
        with contextlib.suppress(ValueError, RecursionError):
            message = json.loads(text)
        if not isinstance(message, dict):
            return [{"error": "a message is a JSON object"}]
        try:
            answers = self._answers(message)
        except SceneError as error:
            answers = [{"error": "; ".join(
                f"{problem.path}: " * problem.path.startswith("$.") + str(WrongValueError(
                    problem.code, problem.message, allowed=problem.allowed, hint=problem.hint))
                for problem in error.problems)}]
        except (SandboxError, WrongValueError) as error:
            answers = [{"error": str(error)}]
        except Exception as error:  # the run goes on, whatever was sent
            answers = [{"error": f"the message cannot be handled: {error!r}"}]
        number = message.get("id")
        if isinstance(number, int) and 0 <= number < 1 << 24:  # exact in a frame
            self.ack = max(self.ack, number)
        return answers

    def _answers(self, message: dict[str, Any]) -> Sequence[Answer | Callable[[], Answer]]:
        match message:
            case {"set": str(name), "value": value}:
                return self._set(name, value) if name.startswith(PARAMETER) else \
                    self._give(name, value)
            case {"drag": [str(body), x, y], "to": [to_x, to_y]}:
                self.hand.hold(body, (x, y), (to_x, to_y))
                return []
            case {"drop": _}:
                self.hand.drop()
                return []
            case {"watch": list(names)}:
                return self._watch(names)
            case {"layers": list(names)}:
                self._layers = self.frames.layers = set(map(str, names))
                return []
            case {"speed": int() | float() as speed} if speed is not True:
                self.speed = min(MAX_SPEED, max(MIN_SPEED, speed))
            case {"save": "scene"}:
                made = self.live.played()
                changed = "".join(f' --set "{path}={value}"'
                                  for path, value in self.overrides.items())
                return [{"file": f"{made.name}.json", "text": to_json(made), "said": changed and (
                    f"with these parameters it begins by: sandbox view {self.loaded.name}"
                    f"{changed}")}]
            case {"save": "run"}:
                return [{"said": "running it again, to save it"}, self._saver()]
            case {"do": "run"}:
                self.playing = not self.live.finished
            case {"do": "pause"}:
                self.playing = False
            case {"do": "step"}:  # by one frame
                self.playing = False
                for _ in range(self._of_frame()):
                    self._go(1)
            case {"do": "back"}:
                return self._back()
            case {"do": "reset"}:  # with the parameters as they are
                self.scene, self._before = self.loaded.mechanism, []
                self._begin(Live(Checked(self.scene)))
                return [self.status(), self._controls()]
            case {"do": str(name)}:
                raise WrongValueError(
                    "bad-argument", f"there is nothing to do called {quoted(name)}",
                    allowed=listed(ACTIONS), hint=near(name, ACTIONS))
            case _:
                raise WrongValueError(
                    "bad-argument", f"there is nothing to do for {quoted(sorted(message))}",
                    allowed="set, drag, drop, watch, layers, speed, save or do")
        return [self.status()]

    def _back(self) -> list[Answer]:
        """Go back by one frame: run again from t = 0 with the earlier actions."""
        def check_open(_share: float) -> None:
            if self.closed():
                raise SandboxError("the page was closed", code="interrupted")

        self.playing = False
        self._begin(self.live.again(max(self.live.steps - self._of_frame(), 1),
                                    progress=check_open))
        self.hand.let_go()
        while self._before and self._before[-1][0] >= self.live.steps:  # as `again` does it
            _, (self.loaded, self.warnings), self.overrides = self._before.pop()
        return [self.status(), self._controls()]

    def _of_frame(self) -> int:
        return max(1, round(FRAME * min(self.speed, 1.0) / self.scene.run.step))

    def _controls(self) -> Answer:
        return {"controls": controls(self.loaded, self.live, self._spans)}

    def _set(self, name: str, value: Any) -> list[Answer]:
        """Set a parameter: at once if only drives and targets depend on it, else begin again."""
        known = [f"{PARAMETER}{each}" for each in self.loaded.scene.parameters]
        if name not in known:
            raise WrongValueError("name-not-found", f"there is no parameter {quoted(name)}",
                                  allowed=listed(known), hint=near(name, known))
        wanted = {**self.overrides, name: value}
        found = self._read(wanted)
        loaded, key = found.loaded, name.removeprefix(PARAMETER)
        was, now = (getattr(each.scene.parameters[key], "unit", "")
                    for each in (self.loaded, loaded))
        if was and now and dimension_of(was) != dimension_of(now):
            raise WrongValueError("wrong-unit", f"{quoted(key)} is no {dimension_of(now)}",
                                  allowed=listed(units_of(dimension_of(was))))
        given = changes(self.loaded.mechanism, loaded.mechanism, self.live.time)
        if given is None or self.live.finished:
            self._open(found, QUICK_LOOK)
            self.overrides = wanted  # now that it can be played with
            return [self.head(), self.status()]
        for each, new in given.items():
            self.live.give(each, new)
        self._before.append((self.live.steps, Found(self.loaded, self.warnings), self.overrides))
        (self.loaded, self.warnings), self.overrides = found, wanted
        return [self.status(), self._controls()]

    def _give(self, name: str, value: Any) -> list[Answer]:
        """Set a drive, a target or a switch; the SI value of a text is the answer."""
        number = read_value(name, value, self.loaded.mechanism, self.live) if isinstance(
            value, str) else value
        self.live.give(name, number)
        return [{"given": {"name": name, "value": number}}] if number is not value else []

    def _watch(self, names: list[Any]) -> list[Answer]:
        known, found = self._look.catalogue, list[str]()
        for name in map(str, names):  # of pairs, those that match a name or a pattern
            pair = "/" in name and not is_expression(name)
            found += known.match(name)[:MAX_METERS + 1] if pair else [name]
            if pair and not known.match(name):
                raise UnknownQuantityError(name, known.near(name))
        names = list(dict.fromkeys(found))
        refuse_if(len(names) > MAX_METERS, f"no more than {MAX_METERS} meters run at once",
                  "limit-exceeded")
        units = self.frames.units
        for name in names:
            refuse_if(not math.isfinite(self.live[name]) and name not in units,
                      f"{quoted(name)} has no value", "bad-argument")
        self._watched = self.frames.watched = names
        return [{"watched": [{"name": name, "unit": units[name] if name in units
                              else self.live.unit(name)} for name in names]}]

    def _saver(self) -> Callable[[], Answer]:
        """A function that runs the scene again as it was played, and saves the run."""
        made = self.live.played()
        place = self._place(made.name)

        def save() -> Answer:
            try:
                simulate(Checked(made)).save(place)
            except SandboxError as error:
                return {"error": str(error)}
            return {"said": f"the run is in {place}"}

        return save
