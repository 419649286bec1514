"""Recorded quantities against time or against another: a panel each unit, or each quantity."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.draw.figure import style
from sandbox.draw.figure.events import MOST as MOST_EVENTS
from sandbox.draw.figure.events import draw_marks, draw_names, marks_of
from sandbox.draw.figure.plane import PathScale, path_scale, seen_as_path
from sandbox.draw.figure.strands import take_apart
from sandbox.draw.figure.style import Shown, SideLabel
from sandbox.errors import OutputError
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.targets import track

LEAST, LABEL, SURROUND, WIDTH = 46.0, 4.2, 16.0, 78.0
"""Height of a panel, of each of its labels, and of what is not panels; width of axes [mm]."""
NUMBERS, NARROW = 12.0, 30.0
"""What an axis' numbers take of a figure's width; axes are no less wide [mm]."""
BESIDE = 0.6
"""Share of the width of a figure narrower than the usual that axes have at least: else names stand
above them and not beside."""
WIDTHS = (50.0, 250.0)
"""Least and largest width of a figure [mm]."""
FRAME = 8.0
"""What of a panel's height is not axes [mm]."""
MOST, MOST_PANELS = 40, 12
"""Curves in a panel: more than these can be told apart by nobody, and a page ends. Panels."""
WORDS = {"rad": "angle", "rad/s": "angular speed", "rad/s^2": "angular acceleration",
         "m": "length", "m/s": "speed", "m/s^2": "acceleration", "N": "force", "N m": "torque",
         "N/m": "stiffness", "N m/rad": "stiffness", "J": "work", "1": "count"}
"""What a unit measures, for the label of its axis."""
BEGIN: dict[str, Any] = {"marker": "o", "markersize": 5, "markerfacecolor": "white"}
EVENT: dict[str, Any] = {"marker": "D", "markersize": 4.5, "markerfacecolor": style.GREY,
                         "markeredgecolor": style.INK, "linestyle": ""}
"""Where a curve that is not over time begins, and where it is at an event."""


@dataclass(frozen=True)
class Plotted:
    """One of the runs of a plot."""

    label: str
    run: Recording
    targets: Mapping[str, Array]
    """Quantity to its target over time, shape [n], SI; drawn dashed."""


@dataclass(frozen=True)
class Window:
    """What of the runs is shown, from and to these times [s]."""

    begin: float = 0.0
    end: float = float("inf")

    def __post_init__(self) -> None:
        """Refuse an end before the beginning.

        Raises:
            OutputError: it is, or at the same time.
        """
        if not self.end > self.begin:
            raise OutputError(f"{self.end:g} s is not after the beginning, {self.begin:g} s",
                              code="bad-time")

    def of(self, time: Array) -> slice:
        """The samples in it."""
        first, last = np.searchsorted(time, [self.begin, self.end])
        return slice(int(first), int(last) + (last < len(time) and time[last] == self.end))


@dataclass(frozen=True)
class _Trail:
    """One quantity of one run."""

    label: str
    hue: str
    dash: Any
    x: Array
    y: Array
    target: Array | None
    events: Array
    """Shape [k, 2]: x and y at the events."""


@dataclass(frozen=True)
class _Across:
    """What the quantities of a figure are drawn against."""

    name: str
    """Of a quantity; empty for time."""
    shown: Shown
    window: Window
    plane: PathScale | None
    """The scale of paths, if there are any."""
    paths: Mapping[str, Array]
    """Of each panel that shows paths in the plane, by its first quantity: all y in it, as shown."""
    columns: int = 0
    """Of the names above a panel; 0 where they stand beside the curves."""

    def height(self, names: Sequence[str]) -> float:
        """Of a panel [mm]."""
        rows = math.ceil(len(names) / self.columns) if self.columns else 0
        if self.plane and names[0] in self.paths:
            return self.plane.height(self.paths[names[0]]) + FRAME + rows * style.NAME
        if self.columns:
            return LEAST + rows * style.NAME
        return max(LEAST, LABEL * len(names) + LEAST / 4)


def draw(runs: Sequence[Plotted], quantities: Sequence[str], *, x: str = "",
         window: Window | None = None, width: float | None = None, titled: bool = True) -> Any:
    """The figure: of one run a panel for each unit, of several one for each quantity.

    Length against length is a path in the plane, and both axes have one scale.

    Args:
        runs: in the order of their colours; of a run that does not have it a quantity is left out.
        quantities: names.
        x: the quantity that they are drawn against; time by default.
        window: what of the runs is shown; all by default.
        width: of the figure [m]; the usual one by default. In one that is narrower the names of
            curves stand above the panels where beside them they would leave too little.
        titled: whether the title of the run stands above.

    Raises:
        OutputError: too few samples, too many curves for one panel, or too many panels.
        UnknownQuantityError: a name that no recording has.
    """
    window = window or Window()
    _refuse_few(runs, window)
    panels = _panels(runs, list(dict.fromkeys(quantities)), x)
    wide = _wide(width)
    across = _across(runs, panels, x, window, wide)
    heights = [across.height(names) for names in panels]
    figure = style.new_figure(sum(heights) + SURROUND, wide)
    grid = list(figure.subplots(len(panels), 1, sharex=True, squeeze=False, gridspec_kw={
        "height_ratios": heights}).ravel())
    for axes, height, names in zip(grid, heights, panels, strict=True):
        _panel(axes, height, runs, names, across)
    free = WIDTH - style.WIDTH + wide + (style.WIDTH - WIDTH - NUMBERS if across.columns else 0)
    notes = _mark_time(grid, heights, runs, window, free) if not x else _mark_ends(runs, window)
    if x:
        grid[-1].set_xlabel(_axis(x, across.shown), fontsize=style.SMALL, color=style.INK)
    _headline(figure, runs, titled=titled)
    if not x and any(name in one.targets for one in runs for name in quantities):
        notes.insert(0, "Dashed: targets.")
    if notes:
        style.footnote(figure, " ".join(notes))
    return figure


def _wide(width: float | None) -> float:
    """Of a figure [mm]."""
    wide = style.WIDTH if width is None else 1e3 * width
    if not WIDTHS[0] <= wide <= WIDTHS[1]:
        raise OutputError(f"a figure cannot be {wide:g} mm wide; allowed: {WIDTHS[0]:g} to "
                          f"{WIDTHS[1]:g} mm", code="bad-picture")
    return wide


def _refuse_few(runs: Sequence[Plotted], window: Window) -> None:
    for one in runs:
        time = one.run.time
        if len(time[window.of(time)]) < 2:
            raise OutputError(
                f"the recording has {len(time)} samples, a plot needs at least 2" if len(time) < 2
                else f"{one.label} has fewer than 2 samples there: the first is at {time[0]:g} s, "
                f"the last at {time[-1]:g} s", code="bad-time")


def _panels(runs: Sequence[Plotted], quantities: Sequence[str], x: str) -> list[list[str]]:
    """The quantities of each panel."""
    by_unit: dict[str, list[str]] = {}
    for name in quantities:
        having = next((one.run for one in runs if name in one.run), runs[0].run)
        unit = having.unit(name)  # says what there is where there is none
        if x and not any(name in one.run and x in one.run for one in runs):
            raise OutputError(f"no run has both {name!r} and {x!r}", code="bad-picture")
        by_unit.setdefault(unit if len(runs) == 1 else name, []).append(name)
    for unit, names in by_unit.items():
        if len(names) > MOST:
            raise OutputError(f"{len(names)} quantities in {unit or '1'} are too many for one "
                              f"panel: at most {MOST}", code="bad-picture")
    if len(by_unit) > MOST_PANELS:
        raise OutputError(f"{len(by_unit)} panels are too many for one figure: at most "
                          f"{MOST_PANELS}; name fewer quantities", code="bad-picture")
    return list(by_unit.values())


def _across(runs: Sequence[Plotted], panels: Sequence[Sequence[str]], x: str,
            window: Window, wide: float) -> _Across:
    columns = _columns(panels, wide) if len(runs) == 1 and wide < style.WIDTH else 0
    if not x:
        return _Across(x, style.shown_as("s"), window, None, {}, columns)
    unit = next((one.run for one in runs if x in one.run), runs[0].run).unit(x)
    along = _values(runs, [x], x, window)
    rows = {names[0]: _values(runs, names, x, window) for names in panels
            if unit == "m" and _unit(runs, names[0]) == "m"}
    rows = {name: row for name, row in rows.items() if seen_as_path(along, row)}
    shown = style.shown_as(unit, along, *rows.values())
    paths = {name: shown.factor * row for name, row in rows.items()}
    scale = path_scale(shown.factor * along, list(paths.values()),
                  _free_width(panels if len(runs) == 1 and not columns else [], wide)
                  ) if paths else None
    return _Across(x, shown, window, scale, paths, columns)


def _columns(panels: Sequence[Sequence[str]], wide: float) -> int:
    """In how many the names stand above panels; 0 where there is room for them beside."""
    letters = max(len(name) for names in panels for name in names)
    beside = letters * style.LETTER * style.SMALL * style.MM_PER_POINT
    free = wide - NUMBERS
    if free - beside >= BESIDE * wide:
        return 0
    return max(1, int(free / (beside + style.SAMPLE)))


def _free_width(panels: Sequence[Sequence[str]], wide: float) -> float:
    """Of axes, where names stand beside those that show several [mm]."""
    letters = max((len(name) for names in panels for name in names if len(names) > 1), default=0)
    beside = letters * style.LETTER * style.SMALL * style.MM_PER_POINT
    return max(wide - NUMBERS - beside, NARROW)


def _values(runs: Sequence[Plotted], names: Sequence[str], x: str, window: Window) -> Array:
    """What the runs that have them have of quantities and of x, SI, one after the other."""
    return np.concatenate([one.run[name][window.of(one.run.time)] for one in runs
                           for name in names if name in one.run and x in one.run])


def _unit(runs: Sequence[Plotted], name: str) -> str:
    return next(one.run.unit(name) for one in runs if name in one.run)


def _panel(axes: Any, height: float, runs: Sequence[Plotted], names: Sequence[str],
           across: _Across) -> None:
    x, along, window = across.name, across.shown, across.window
    curves = [_curve(one, name, i if len(runs) > 1 else j, x, window)
              for i, one in enumerate(runs) for j, name in enumerate(names)
              if name in one.run and (not x or x in one.run)]
    unit = _unit(runs, names[0])
    rows = [row for curve in curves for row in (curve.y, curve.target) if row is not None]
    path = across.paths.get(names[0])
    shown = along if path is not None else style.shown_as(unit, *rows)
    lines = []
    for curve in curves:
        lines += axes.plot(along.factor * curve.x, shown.factor * curve.y, color=curve.hue,
                           linewidth=style.LINE, linestyle=curve.dash)
        if curve.target is not None:
            axes.plot(curve.x, shown.factor * curve.target, color=curve.hue, **style.TARGET)
        if x:
            axes.plot(along.factor * curve.x[0], shown.factor * curve.y[0], color=curve.hue,
                      **BEGIN)
            axes.plot(*(curve.events * [along.factor, shown.factor]).T, **EVENT)
    several, named = len(runs) > 1, bool(x) and len(names) == 1
    style.dress(axes, names[0] if several else "",
                _axis("" if several else names[0] if named else WORDS.get(unit, ""), shown))
    style.powers(axes)
    if across.plane and path is not None:
        across.plane.lay(axes, path)
    else:
        style.roomy(axes, *(shown.factor * row for row in rows))
    take_apart(axes, lines)
    if across.columns and not named:
        style.name_above(axes, [(curve.label, curve.hue, curve.dash) for curve in curves],
                         across.columns)
    elif not several and not named:
        style.label_side(axes, [SideLabel(shown.factor * _last(curve.y), curve.label, curve.hue)
                                for curve in curves], height=height - FRAME)


def _curve(one: Plotted, name: str, place: int, x: str, window: Window) -> _Trail:
    run = one.run
    if x:
        time, value, target = run.time, run[name], None
        across, shown = run[x], window.of(time)
        when = [event.time for event in run.info.marked
                if window.begin <= event.time <= window.end]
        events = np.column_stack([np.interp(when, time, across), np.interp(when, time, value)])
    else:
        time, value, target = track(run, name, one.targets.get(name))
        across, shown, events = time, window.of(time), np.empty((0, 2))
    return _Trail(name, style.hue(place),
                  style.DASHES[place // len(style.COLOURS) % len(style.DASHES)],
                  across[shown], value[shown], None if target is None else target[shown], events)


def _axis(word: str, shown: Shown) -> str:
    return (f"{word} [{shown.unit}]" if shown.unit else word).strip()


def _mark_time(grid: Sequence[Any], heights: Sequence[float], runs: Sequence[Plotted],
               window: Window, width: float) -> list[str]:
    """Time below all panels, and events as lines; what is to be said of these."""
    style.over_time(grid, len(grid), 1, *(one.run for one in runs))
    left, right = grid[0].get_xlim()
    begin, end = max(left, window.begin), min(right, window.end)
    grid[0].set_xlim(begin, end)
    if len(runs) > 1:
        for i, one in enumerate(runs):
            for mark in marks_of(one.run, width=width, begin=begin, end=end):
                for axes in grid:
                    axes.axvline(mark.time, color=style.hue(i), linewidth=0.8, alpha=0.5,
                                 zorder=1.5)
    else:
        marks = marks_of(runs[0].run, width=width, begin=begin, end=end)
        draw_marks(grid, marks)
        draw_names(grid[0], marks, height=heights[0] - FRAME)
    most = max(sum(begin <= event.time <= end for event in one.run.info.marked) for one in runs)
    if most > MOST_EVENTS:
        return [f"{most} events are not marked: up to {MOST_EVENTS} are, in a window of time."]
    return ["Upright lines: events."] if most else []


def _mark_ends(runs: Sequence[Plotted], window: Window) -> list[str]:
    """What is to be said of signs on curves that are not over time."""
    names = list(dict.fromkeys(event.event for one in runs for event in one.run.info.marked
                               if window.begin <= event.time <= window.end))
    return ["Rings: where the curves begin.", *(
        [f"Diamonds: events ({', '.join(map(style.plain, names))})." if len(names) <= MOST_EVENTS
         else "Diamonds: events."] if names else [])]


def _headline(figure: Any, runs: Sequence[Plotted], *, titled: bool) -> None:
    """The title of one run, or the names of several in their colours."""
    if len(runs) == 1:
        mechanism = runs[0].run.mechanism
        style.title(figure, (mechanism.title or mechanism.name) if titled else "")
    else:
        style.name_runs(figure, [one.label for one in runs])


def _last(row: Array) -> float:
    """The last value that is one; 0 if none is, so that the curve still has its name."""
    finite = row[~(row != row)]
    return float(finite[-1]) if len(finite) else 0.0
