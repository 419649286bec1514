"""A scene that somebody plays with: what is asked of it, checked; what it does, as frames.

There is no transport in it. Whoever has one hands over what was asked (:meth:`Session.hear`), lets
time pass (:meth:`Session.advance`) and passes on frames and what has to be said.
"""

from __future__ import annotations

import contextlib
import itertools
import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from numbers import Real
from pathlib import Path
from typing import Any, NamedTuple

from sandbox.engine.hand import Hand
from sandbox.engine.inspect_control import Checked
from sandbox.engine.live import Live
from sandbox.engine.simulate import simulate
from sandbox.errors import Problem, SandboxError, SceneError
from sandbox.model.catalogue import Catalogue, UnknownQuantityError
from sandbox.model.meters import is_expression
from sandbox.scene.expand import to_json
from sandbox.scene.read.load import Loaded
from sandbox.values.units import dimension_of, units_of
from sandbox.web.controls import PARAMETER, Spans, changes, controls, read_value
from sandbox.web.frames import LOOK, LiveFrames, Stride, looked_at
from sandbox.wording import listed, near, quoted

FRAME = 1 / 60
"""Seconds from frame to frame."""
BUDGET = 0.012
"""Seconds that the steps of a frame may take; what does not fit is left out: it goes slower."""
SLOWEST, FASTEST = 0.01, 4.0
"""Seconds of motion for each second that can be asked for."""
MOST_METERS, FIRST_METERS = 12, 4
"""Meters of a live view that run at once; of usual quantities at first."""
QUICK_LOOK = 0.2
"""Seconds for that when a parameter was set, so that a slider is not held up."""
Answer = dict[str, Any]
Later = Callable[[], Answer]
"""Work that takes long and gives an answer; may be called in a thread."""


class Found(NamedTuple):
    """What reading a scene gave."""

    loaded: Loaded
    warnings: Sequence[str] = ()
    """What the check of the scene has to say, a line each."""


class Before(NamedTuple):
    """What a parameter was before it was set while a run went on."""

    steps: int
    """Of the run by then."""
    found: Found
    overrides: dict[str, Any]


Read = Callable[[Mapping[str, Any]], Found]
Place = Callable[[str], Path]


class Session:
    """One scene that is played with.

    Args:
        read: reads the scene, with values that replace those of its file; called again when the
            file has changed or a parameter is set.
        overrides: such values.
        place: of a name the directory that a run is saved into.

    Raises:
        SceneError: the scene cannot be used.
    """

    def __init__(self, read: Read, overrides: Mapping[str, Any], place: Place) -> None:
        self._read, self._place = read, place
        self.overrides = dict(overrides)
        self.playing = True
        self.trouble = ""
        """What the run ended with, or what is wrong with the scene's file."""
        self.rate = 0.0
        """Seconds of motion for each second, as of late."""
        self.seq = self.ack = 0
        self.closed: Callable[[], bool] = bool
        """Whether the page was closed: work that takes long is then given up."""
        self._watched: list[str] | None = None
        self._layers: set[str] | None = None
        self._spans: Spans = {}
        self._before: list[Before] = []
        self._open(read(self.overrides))
        self.speed = _possible(self.scene.view.speed)

    def _open(self, found: Found, look: float = LOOK) -> None:
        """Begin with a scene that was read; ``look`` are seconds to look how far it goes."""
        scene = Checked(found.loaded.mechanism)
        look_at = looked_at(scene, look)
        self.loaded, self.warnings = found
        self.scene, self._look, self._before = self.loaded.mechanism, look_at, []
        self._begin(Live(scene))

    def _begin(self, live: Live) -> None:
        """Go on with another run of the scene."""
        self.live, self.hand, self.frames = live, Hand(live), LiveFrames(live, self._look)
        self.trouble, self._due, self._stride = "", 0.0, Stride()
        self._end = round(live.scene.run.duration / live.scene.run.step)
        """Steps to the end of the scene, where it pauses once."""
        self.frames.layers = self._layers
        watched = first_meters(self.frames, self._look.catalogue.usual) \
            if self._watched is None else self._watched
        self.frames.watched = [name for name in watched if self.frames.tells(name)]

    # -- answers ---------------------------------------------------------------------------

    def head(self) -> Answer:
        """All that a page has to know before the first frame."""
        return {"head": {**self.frames.drawing(), **self._controls(),
                         "watched": self.frames.watched}}

    def status(self) -> Answer:
        """What stands beside the picture: whether it runs, how fast, what is wrong."""
        return {"status": {"playing": self.playing, "speed": self.speed,
                           "trouble": self._in_place(self.trouble or self.live.ending),
                           "note": self._note(),
                           "warnings": [self._in_place(text)
                                        for text in self.warnings],
                           "left_out": self.frames.left_out}}

    def _note(self) -> str:
        if self.playing or self.live.steps != self._end:
            return ""
        return (f"The scene ends at {self.scene.run.duration:.6g} s. "
                "Press run to continue, or reset to go back to the start.")

    def _in_place(self, text: str) -> str:
        """A text without the folder of the scene's file, which the page's reader knows."""
        file = Path(self.loaded.name)
        return text.replace(self.loaded.name, file.name) if file.name else text

    def line(self) -> str:
        """The command that begins with today's values of the parameters."""
        said = [f' --set "{path}={value}"' for path, value in self.overrides.items()]
        return f"sandbox view {self.loaded.name}{''.join(said)}"

    def relisted(self) -> list[Answer]:
        """The display list, if the page has another one; to be sent before the next frame."""
        found = self.frames.relisted()
        return [{"relisted": found}] if found else []

    def frame(self) -> bytes:
        """The present instant; see :mod:`sandbox.web.frames`."""
        self.seq += 1
        held, hand = self.hand.body, self.hand
        place = hand.point()[0] if held is not None else (0.0, 0.0)
        return self.frames.frame({
            "seq": self.seq, "ack": self.ack, "t": self.live.time, "rate": self.rate,
            "hand": -1 if held is None else hand.model.names.body[held],
            "from_x": place[0], "from_y": place[1],
            "force_x": hand.force[0], "force_y": hand.force[1]})

    # -- time -------------------------------------------------------------------------------

    def advance(self, seconds: float, budget: float = BUDGET) -> None:
        """Let so much time pass, or as much as fits the budget [s of the clock]."""
        step = self.scene.run.step
        self._due += seconds * self.speed / step
        wanted, made = int(self._due), 0
        self._due -= wanted
        left = self._end - self.live.steps
        if left > 0:
            wanted = min(wanted, left)
        began = time.perf_counter()
        while made < wanted and not self.live.finished:
            with self._stride.of(min(wanted - made, self._stride.fits(budget / 4))) as steps:
                made += self._go(steps)
            if time.perf_counter() - began > budget:
                break
        self.rate += 0.1 * (made * step / seconds - self.rate)
        if self.live.finished or 0 < left <= made:
            self.playing = False

    def _go(self, most: int) -> int:
        """Make some steps, no more than so many; an error ends the run and is reported."""
        count = min(most, self.hand.every) if self.hand.body is not None else most
        try:
            self.hand.draw()
            return self.live.step(count)
        except SandboxError as error:
            self.trouble, self.playing = str(error), False
            return most

    def reload(self) -> bool:
        """Read the scene's file anew, with today's values; whether it can be played with.

        If it cannot, the run continues, and the problem is reported.
        """
        try:
            found, values = self._as_today()
            self._open(found)
        except SandboxError as error:
            self.trouble = str(error)
            return False
        self.overrides, self._spans = values, {}
        return True

    def _as_today(self) -> tuple[Found, dict[str, Any]]:
        """The file anew with today's values, and these: of parameters that it still has.

        Raises:
            SandboxError: it cannot be used.
        """
        try:
            return self._read(self.overrides), self.overrides
        except SceneError:
            others = {name: value for name, value in self.overrides.items()
                      if not name.startswith(PARAMETER)}
            left = self.overrides
            with contextlib.suppress(SceneError):
                known = self._read(others).loaded.scene.parameters
                left = {name: value for name, value in self.overrides.items()
                        if name in others or name.removeprefix(PARAMETER) in known}
            if left == self.overrides:
                raise
            return self._read(left), left

    # -- what is asked ----------------------------------------------------------------------

    def hear(self, text: str | bytes) -> list[Answer | Later]:
        """Do what a message asks and return the answers; no message raises an error."""
        try:
            asked = json.loads(text)
        except (ValueError, RecursionError):
            return [{"error": "a message is a JSON object"}]
        if not isinstance(asked, dict):
            return [{"error": "a message is a JSON object"}]
        found: list[Answer | Later]
        try:
            found = [*self._answers(asked)]
        except SandboxError as error:
            problems = error.problems if isinstance(error, SceneError) else []
            found = [{"error": "; ".join(map(_said, problems)) or str(error)}]
        except Exception as error:  # the run goes on, whatever was sent
            found = [{"error": f"the message cannot be handled: {error!r}"}]
        number = asked.get("id")
        if isinstance(number, int) and 0 <= number < 1 << 24:  # exact in a frame
            self.ack = max(self.ack, number)
        return found

    def _answers(self, asked: dict[str, Any]) -> Sequence[Answer | Later]:
        match asked:
            case {"set": str(name), "value": value}:
                return self._set(name, value)
            case {"drag": [str(body), x, y], "to": [to_x, to_y]}:
                self.hand.hold(body, (_number(x), _number(y)), (_number(to_x), _number(to_y)))
                return []
            case {"drop": _}:
                self.hand.drop()
                return []
            case {"watch": list(names)}:
                return self._watch(names)
            case {"layers": list(names)}:
                self._layers = self.frames.layers = set(map(str, names))
                return []
            case {"speed": speed}:
                self.speed = _possible(_number(speed))
                return [self.status()]
            case {"save": "scene"}:
                return [self._saved_scene()]
            case {"save": "run"}:
                return [{"said": "running it again, to save it"}, self._saver()]
            case {"do": str(what)}:
                return self._do(what)
        raise SceneError([Problem("bad-argument",
                                  f"there is nothing to do for {quoted(sorted(asked))}", "",
                                  allowed="set, drag, drop, watch, layers, speed, save or do")])

    def _do(self, what: str) -> list[Answer]:
        acts = {"run": self._run, "pause": self._pause, "step": self._step, "back": self._back,
                "reset": self._reset}
        if what not in acts:
            raise SceneError([Problem("bad-argument",
                                      f"there is nothing to do called {quoted(what)}", "",
                                      allowed=listed(acts), hint=near(what, acts))])
        return acts[what]()

    def _run(self) -> list[Answer]:
        self.playing = not self.live.finished
        return [self.status()]

    def _pause(self) -> list[Answer]:
        self.playing = False
        return [self.status()]

    def _step(self) -> list[Answer]:
        """On by one frame."""
        self.playing = False
        for _ in range(self._of_frame()):
            self._go(1)
        return [self.status()]

    def _back(self) -> list[Answer]:
        """By one frame: run again from t = 0 with what was done before."""
        self.playing = False
        self._begin(self.live.again(max(self.live.steps - self._of_frame(), 1),
                                    progress=self._wanted))
        self.hand.let_go()
        while self._before and self._before[-1].steps >= self.live.steps:  # as `again` does it
            _, (self.loaded, self.warnings), self.overrides = self._before.pop()
        return [self.status(), self._controls()]

    def _wanted(self, share: float) -> None:
        """Whether to go on with what takes long.

        Raises:
            SandboxError: nobody waits for it any more.
        """
        if self.closed():
            raise SandboxError("the page was closed", code="interrupted")

    def _reset(self) -> list[Answer]:
        """To the beginning, with the parameters as they are."""
        self.scene, self._before = self.loaded.mechanism, []
        self._begin(Live(Checked(self.scene)))
        return [self.status(), self._controls()]

    def _of_frame(self) -> int:
        return max(1, round(FRAME * min(self.speed, 1.0) / self.scene.run.step))

    def _controls(self) -> Answer:
        return {"controls": controls(self.loaded, self.live, self._spans)}

    def _set(self, name: str, value: Any) -> list[Answer]:
        if not name.startswith(PARAMETER):
            return self._give(name, value)
        if not isinstance(value, str | Real) or isinstance(value, bool):
            raise SceneError([Problem("bad-argument",
                                      f"{quoted(value)} is not a value for {quoted(name)}", "")])
        known = [f"{PARAMETER}{each}" for each in self.loaded.scene.parameters]
        if name not in known:
            raise SceneError([Problem("name-not-found", f"there is no parameter {quoted(name)}", "",
                                      allowed=listed(known), hint=near(name, known))])
        wanted = {**self.overrides, name: value}
        found = self._read(wanted)
        loaded = found.loaded
        _same_dimension(name, self.loaded.scene.parameters, loaded.scene.parameters)
        given = changes(self.loaded.mechanism, loaded.mechanism, self.live.time)
        if given is None or self.live.finished:
            self._open(found, QUICK_LOOK)
            self.overrides = wanted  # now that it can be played with
            return [self.head(), self.status()]
        for each, new in given.items():
            self.live.give(each, new)
        self._before.append(
            Before(self.live.steps, Found(self.loaded, self.warnings), self.overrides))
        (self.loaded, self.warnings), self.overrides = found, wanted
        return [self.status(), self._controls()]

    def _give(self, name: str, value: Any) -> list[Answer]:
        """Set a drive, a target or a switch; what a text with a unit is in SI is answered."""
        if not isinstance(value, str):
            self.live.give(name, _number(value))
            return []
        number = read_value(name, value, self.loaded.mechanism, self.live)
        self.live.give(name, number)
        return [{"given": {"name": name, "value": number}}]

    def _watch(self, names: list[Any]) -> list[Answer]:
        known = self._look.catalogue
        names = list(dict.fromkeys(each for name in map(str, names)
                                   for each in _of_pairs(name, known)))
        if len(names) > MOST_METERS:
            raise SceneError([Problem("limit-exceeded",
                                      f"no more than {MOST_METERS} meters run at once", "")])
        for name in names:
            if not math.isfinite(self.live[name]) and name not in self.frames.units:
                raise SceneError([Problem("bad-argument", f"{quoted(name)} has no value", "")])
        self._watched = self.frames.watched = names
        units = self.frames.units
        return [{"watched": [{"name": name, "unit": units[name] if name in units
                              else self.live.unit(name)} for name in names]}]

    # -- what is kept -----------------------------------------------------------------------

    def _saved_scene(self) -> Answer:
        made = self.live.played()
        said = f"with these parameters it begins by: {self.line()}" if self.overrides else ""
        return {"file": f"{made.name}.json", "text": to_json(made), "said": said}

    def _saver(self) -> Later:
        """Run again what was played so far, and save that."""
        made = self.live.played()
        place = self._place(made.name)

        def save() -> Answer:
            try:
                simulate(Checked(made)).save(place)
            except SandboxError as error:
                return {"error": str(error)}
            return {"said": f"the run is in {place}"}

        return save


def _of_pairs(name: str, known: Catalogue) -> list[str]:
    """The quantities of pairs that a name or a pattern fits; what names no pair as it is.

    Raises:
        UnknownQuantityError: none fits.
    """
    if "/" not in name or is_expression(name):
        return [name]
    if not known.fits(name):
        raise UnknownQuantityError(name, known.near(name))
    return list(itertools.islice(known.match(name), MOST_METERS + 1))


def _number(value: object) -> float:
    """A finite number.

    Raises:
        SceneError: it is none.
    """
    if isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    raise SceneError([Problem("bad-argument", f"{quoted(value)} is no finite number", "")])


def _possible(speed: float) -> float:
    """The speed nearest to this one that can be asked for."""
    return min(max(speed, SLOWEST), FASTEST)


def _same_dimension(name: str, old: Mapping[str, float], new: Mapping[str, float]) -> None:
    """Refuse a unit that measures something else than the one before.

    Raises:
        SceneError: it does.
    """
    key = name.removeprefix(PARAMETER)
    was, now = (getattr(values[key], "unit", "") for values in (old, new))
    if was and now and dimension_of(was) != dimension_of(now):
        raise SceneError([Problem("wrong-unit", f"{quoted(key)} is no {dimension_of(now)}", "",
                                  allowed=listed(units_of(dimension_of(was))))])


def _said(problem: Problem) -> str:
    """A problem in one line; of a place only that in the scene."""
    place = f"{problem.path}: " if problem.path.startswith("$.") else ""
    allowed = f"; allowed: {problem.allowed}" if problem.allowed else ""
    hint = f"; did you mean {problem.hint}?" if problem.hint else ""
    return f"{place}{problem.message}{allowed}{hint}"


def first_meters(frames: LiveFrames, usual: Mapping[str, list[str]]) -> list[str]:
    """The quantities that a live view plots at first.

    These are the meters of the scene's view, as many as may run at once; else the meters that the
    scene defines, else the first of the ``usual`` quantities.
    """
    shown: list[str] = []
    for meter in frames.meters:
        both = list(dict.fromkeys([*shown, *meter["names"]]))
        shown = both if len(both) <= MOST_METERS else shown
    if shown:
        return shown
    found = ([name for name in names if name in frames.units] for names in usual.values())
    return next((names[:FIRST_METERS] for names in found if names), [])
