"""Figures of recorded quantities against time or against another quantity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.errors import OutputError
from sandbox.figure import style
from sandbox.figure.panels import Axis, Curve, Mark, Panel, Upright
from sandbox.figure.panels import draw as draw_panels
from sandbox.figure.style import Shown
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.targets import track

NUMBERS, BESIDE = 12.0, 0.6
"""Width of the numbers of an axis [mm]. In narrow figures, names stand beside the curves only if
the axes keep this share of the width, otherwise above them."""
WIDTHS = (50.0, 250.0)
"""Smallest and largest width of a figure [mm]."""
MAX_CURVES, MAX_PANELS = 40, 12
"""Curves of a panel; panels."""
MAX_EVENTS, MAX_LETTERS = 8, 20
"""Events that are marked; letters of their names."""
WORDS = {"rad": "angle", "rad/s": "angular speed", "rad/s^2": "angular acceleration",
         "m": "length", "m/s": "speed", "m/s^2": "acceleration", "N": "force", "N m": "torque",
         "N/m": "stiffness", "N m/rad": "stiffness", "J": "work", "1": "count"}
"""Labels of axes by unit."""
BEGIN = {"marker": "o", "markersize": 5, "markerfacecolor": "white", "markeredgewidth": 1.5}
EVENT = {"marker": "D", "markersize": 4.5, "markerfacecolor": style.GREY,
         "markeredgecolor": style.INK, "color": style.INK, "markeredgewidth": 1.0}
"""Line properties of the begin of a curve and of its events, where x is not time."""
FLAT = 10.0
"""Lengths against lengths have one scale unless one range exceeds the other by this factor."""


@dataclass(frozen=True)
class Plotted:
    """A run of a plot."""

    label: str
    run: Recording
    targets: Mapping[str, Array]
    """Targets over time by quantity, shape [n], SI; drawn dashed."""


@dataclass(frozen=True)
class Window:
    """The range of time that is shown [s]."""

    begin: float = 0.0
    end: float = float("inf")

    def __post_init__(self) -> None:
        """Check the order.

        Raises:
            OutputError: the end is not after the beginning.
        """
        if not self.end > self.begin:
            raise OutputError(f"{self.end:g} s is not after the beginning, {self.begin:g} s",
                              code="bad-time")

    def of(self, time: Array) -> slice:
        """Samples in the range."""
        first, last = np.searchsorted(time, [self.begin, self.end])
        return slice(int(first), int(last) + (last < len(time) and time[last] == self.end))


@dataclass(frozen=True)
class _Drawing:
    """What all panels of a figure share."""

    runs: Sequence[Plotted]
    x: str
    """Quantity on the x axis; empty for time."""
    along: Shown
    window: Window
    names: Any
    """Place of the names; see :class:`Panel`."""
    paths: frozenset[str]
    """First quantities of the panels that show paths in the plane."""


def draw(runs: Sequence[Plotted], quantities: Sequence[str], *, x: str = "",
         window: Window | None = None, width: float | None = None, titled: bool = True) -> Any:
    """A figure with a panel for each unit of one run, or for each quantity of several runs.

    Length against length is a path in the plane, with one scale on both axes.

    Args:
        runs: in the order of their colours; a run is skipped where it lacks a quantity.
        quantities: names.
        x: the quantity on the x axis; time by default.
        window: range of time; all by default.
        width: of the figure [m]; 120 mm by default. In a narrow figure names stand above the
            panels.
        titled: whether the title of the run stands above.

    Raises:
        OutputError: too few samples, too many curves in a panel, or too many panels.
        UnknownQuantityError: a name that no recording has.
    """
    window, wide = window or Window(), style.WIDTH if width is None else 1e3 * width
    _check(runs, window, wide)
    groups = _groups(runs, list(dict.fromkeys(quantities)), x)
    drawing = _drawing(runs, groups, x, window, wide)
    several, mechanism = len(runs) > 1, runs[0].run.mechanism
    events, notes = ([], _notes_of_ends(runs, window)) if x else _events(runs, window)
    if not x and any(set(one.targets) & set(quantities) for one in runs):
        notes.insert(0, "Dashed: targets.")
    panels = [_panel(drawing, names, events if names is groups[0] else [
        Upright(event.x, look=event.look) for event in events]) for names in groups]
    return draw_panels(
        panels, title="" if several or not titled else mechanism.title or mechanism.name,
        key=[(one.label, {"color": style.hue(i), "linewidth": style.LINE})
             for i, one in enumerate(runs)] if several else (),
        notes=[" ".join(notes)] if notes else (), width=wide, shared=True)


def _check(runs: Sequence[Plotted], window: Window, wide: float) -> None:
    """That the figure can have its width [mm], and that each run has samples."""
    if not WIDTHS[0] <= wide <= WIDTHS[1]:
        raise OutputError(f"a figure cannot be {wide:g} mm wide; allowed: {WIDTHS[0]:g} to "
                          f"{WIDTHS[1]:g} mm", code="bad-picture")
    for one in runs:
        time = one.run.time
        if len(time[window.of(time)]) < 2:
            raise OutputError(
                f"the recording has {len(time)} samples, a plot needs at least 2" if len(time) < 2
                else f"{one.label} has fewer than 2 samples there: the first is at {time[0]:g} s, "
                f"the last at {time[-1]:g} s", code="bad-time")


def _groups(runs: Sequence[Plotted], quantities: Sequence[str], x: str) -> list[list[str]]:
    """The quantities of each panel."""
    by_unit: dict[str, list[str]] = {}
    for name in quantities:
        having = next((one.run for one in runs if name in one.run), runs[0].run)
        unit = having.unit(name)  # raises UnknownQuantityError
        if x and not any(name in one.run and x in one.run for one in runs):
            raise OutputError(f"no run has both {name!r} and {x!r}", code="bad-picture")
        by_unit.setdefault(unit if len(runs) == 1 else name, []).append(name)
    for unit, names in by_unit.items():
        if len(names) > MAX_CURVES:
            raise OutputError(f"{len(names)} quantities in {unit or '1'} are too many for one "
                              f"panel: at most {MAX_CURVES}", code="bad-picture")
    if len(by_unit) > MAX_PANELS:
        raise OutputError(f"{len(by_unit)} panels are too many for one figure: at most "
                          f"{MAX_PANELS}; name fewer quantities", code="bad-picture")
    return list(by_unit.values())


def _drawing(runs: Sequence[Plotted], groups: Sequence[Sequence[str]], x: str,
             window: Window, wide: float) -> _Drawing:
    letters = max(len(name) for names in groups for name in names)
    beside = letters * style.LETTER * style.SMALL * style.MM_PER_POINT
    names = "" if len(runs) > 1 else (
        "side" if wide >= style.WIDTH or wide - NUMBERS - beside >= BESIDE * wide else "above")
    if not x:
        return _Drawing(runs, x, style.shown_as("s"), window, names, frozenset())
    unit, along = _unit(runs, x), _values(runs, [x], x, window)
    rows = {group[0]: _values(runs, group, x, window) for group in groups
            if unit == "m" and _unit(runs, group[0]) == "m"}
    rows = {name: row for name, row in rows.items() if _is_path(along, row)}
    return _Drawing(runs, x, style.shown_as(unit, along, *rows.values()), window, names,
                    frozenset(rows))


def _is_path(x: Array, y: Array) -> bool:
    """Whether one scale shows both coordinates of a path well."""
    finite = np.isfinite(x).any() and np.isfinite(y).any()
    spans = sorted(float(np.nanmax(row) - np.nanmin(row)) for row in (x, y)) if finite else [0, 0]
    return spans[0] > 0 and spans[1] <= FLAT * spans[0]


def _values(runs: Sequence[Plotted], names: Sequence[str], x: str, window: Window) -> Array:
    """Values of quantities in all runs that have them and x, SI, concatenated."""
    return np.concatenate([one.run[name][window.of(one.run.time)] for one in runs
                           for name in names if name in one.run and x in one.run])


def _unit(runs: Sequence[Plotted], name: str) -> str:
    return next((one.run for one in runs if name in one.run), runs[0].run).unit(name)


def _panel(drawing: _Drawing, names: Sequence[str], events: Sequence[Upright]) -> Panel:
    """The panel of quantities."""
    x, along, window = drawing.x, drawing.along, drawing.window
    unit, several = _unit(drawing.runs, names[0]), len(drawing.runs) > 1
    path = names[0] in drawing.paths
    found = [(i if several else j, name, one, track(one.run, name, one.targets.get(name)) if not x
              else (one.run.time, one.run[name], None))
             for i, one in enumerate(drawing.runs) for j, name in enumerate(names)
             if name in one.run and (not x or x in one.run)]
    shown = along if path else style.shown_as(unit, *(
        row[window.of(time)] for _, _, _, (time, value, target) in found
        for row in (value, target) if row is not None))
    marks: list[Mark] = []
    for place, name, one, (time, value, target) in found:
        hue, here = {"color": style.hue(place)}, window.of(time)
        across = along.factor * (one.run[x] if x else time)
        marks.append(Curve("" if several else name, across[here], shown.factor * value[here],
                           look={**hue, "linestyle": style.dash(place)}))
        if target is not None:
            marks.append(Curve("", across[here], shown.factor * target[here], "dashed", hue))
        if x:
            when = [event.time for event in one.run.info.marked
                    if window.begin <= event.time <= window.end]
            marks.append(Curve("", across[here][:1], shown.factor * value[here][:1], "points",
                               {**hue, **BEGIN}))
            if when:
                marks.append(Curve("", np.interp(when, time, across),
                                   shown.factor * np.interp(when, time, value), "points", EVENT))
    named = bool(x) and len(names) == 1 and not several
    word = "" if several else names[0] if named else WORDS.get(unit, "")
    limits = None if x else _limits(drawing.runs, window)
    return Panel(names[0] if several else "", Axis(along.label(x or "time"), limits=limits),
                 Axis(shown.label(word)), [*marks, *events], "" if named else drawing.names,
                 plane=path)


def _limits(runs: Sequence[Plotted], window: Window) -> tuple[float, float]:
    """The range of time that is shown [s]."""
    # a sample belongs to the middle of a step
    end = max(one.run.time[-1] + 0.5 * one.run.mechanism.run.step for one in runs)
    return max(0.0, window.begin), min(float(end), window.end)


def _events(runs: Sequence[Plotted], window: Window) -> tuple[list[Upright], list[str]]:
    """Lines at the events of runs, and the notes on them."""
    begin, end = _limits(runs, window)
    inside = [[event for event in one.run.info.marked if begin <= event.time <= end]
              for one in runs]
    lines = []
    for i, events in enumerate(inside):
        look = {"color": style.hue(i), "linewidth": 0.8, "alpha": 0.5, "zorder": 1.5}
        for event in events if len(events) <= MAX_EVENTS else ():
            name = event.event if len(event.event) <= MAX_LETTERS \
                else f"{event.event[:MAX_LETTERS - 1]}…"
            lines.append(Upright(event.time, name) if len(runs) == 1
                         else Upright(event.time, look=look))
    if (most := max(map(len, inside))) > MAX_EVENTS:
        return lines, [f"{most} events are not marked: up to {MAX_EVENTS} are, in a window of "
                       "time."]
    return lines, ["Vertical lines: events."] if most else []


def _notes_of_ends(runs: Sequence[Plotted], window: Window) -> list[str]:
    """Notes on the markers of curves that are not over time."""
    names = list(dict.fromkeys(event.event for one in runs for event in one.run.info.marked
                               if window.begin <= event.time <= window.end))
    return ["Rings: where the curves begin.", *(
        [f"Diamonds: events ({', '.join(names)})." if len(names) <= MAX_EVENTS
         else "Diamonds: events."] if names else [])]
