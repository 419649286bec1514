"""Figures of recorded quantities against time or against another quantity."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from sandbox.errors import OutputError
from sandbox.figure import style
from sandbox.figure.panels import Axis, Curve, Mark, Panel, upright
from sandbox.figure.panels import draw as draw_panels
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.targets import track

WIDTHS = (50.0, 250.0)  # smallest and largest width of a figure [mm]
MAX_CURVES, MAX_PANELS = 40, 12  # curves of a panel; panels
MAX_EVENTS = 8  # events of a run that are marked
WORDS = {"rad": "angle", "rad/s": "angular speed", "rad/s^2": "angular acceleration",
         "m": "length", "m/s": "speed", "m/s^2": "acceleration", "N": "force", "N m": "torque",
         "N/m": "stiffness", "N m/rad": "stiffness", "J": "work", "1": "count"}
"""Labels of axes by unit."""
BEGIN = {"marker": "o", "markersize": 5, "markerfacecolor": "white", "markeredgewidth": 1.5}
"""Line properties of the begin of a curve, where x is not time."""
FLAT = 10.0
"""Lengths against lengths have one scale unless one range exceeds the other by this factor."""
Window = tuple[float, float]  # the range of time that is shown [s]


@dataclass(frozen=True)
class Plotted:
    """A run of a plot."""

    label: str
    run: Recording
    targets: Mapping[str, Array]  # targets over time by quantity, shape [n], SI; drawn dashed


def draw(runs: Sequence[Plotted], quantities: Sequence[str], *, x: str = "",
         window: Window = (0.0, math.inf), width: float | None = None, titled: bool = True) -> Any:
    """A figure with a panel for each unit of one run, or for each quantity of several runs.

    Length against length is a path in the plane, with one scale on both axes. ``x`` is the quantity
    on the x axis, by default time; ``window`` is the range of time [s]; ``width`` is in metres. A
    run is skipped where it lacks a quantity.

    Raises:
        OutputError: too few samples, too many curves in a panel, or too many panels.
        UnknownQuantityError: a name that no recording has.
    """
    wide = style.WIDTH if width is None else 1e3 * width
    _check(runs, window, wide)
    groups = _groups(runs, list(dict.fromkeys(quantities)), x)
    several, mechanism = len(runs) > 1, runs[0].run.mechanism
    units, of_x = [_unit(runs, names[0]) for names in groups], _unit(runs, x) if x else "s"
    found = [_series(runs, names, x, window) for names in groups]
    paths = [bool(x) and of_x == unit == "m" and _is_path(each)
             for unit, each in zip(units, found, strict=True)]
    along = style.shown_as(of_x, *(row for each, path in zip(found, paths, strict=True)
                                   for one in each for row in (one.x, one.y)[:1 + path]))
    events, notes = ([], ["Rings: where the curves begin."]) if x else _events(runs, window)
    if not x and any(set(one.targets) & set(quantities) for one in runs):
        notes.insert(0, "Dashed: targets.")
    panels = []
    for names, unit, each, path in zip(groups, units, found, paths, strict=True):
        shown = along if path else style.shown_as(unit, *(
            row for one in each for row in (one.y, one.target) if row is not None))
        marks: list[Mark] = []
        for one in each:
            hue, across, up = {"color": style.hue(one.place)}, along.factor * one.x, one.y
            marks.append(Curve("" if several else one.name, across, shown.factor * up,
                               look={**hue, "linestyle": style.dash(one.place)}))
            if one.target is not None:
                marks.append(Curve("", across, shown.factor * one.target, "dashed", hue))
            if x:
                marks.append(Curve("", across[:1], shown.factor * up[:1], "points",
                                   {**hue, **BEGIN}))
        alone = several or len(names) == 1
        title = names[0] if several or (alone and not x) else ""
        word = "" if several else names[0] if alone and x else WORDS.get(unit, "")
        marks += events
        panels.append(Panel(
            title, Axis(along.label(x or "time"), limits=None if x else _limits(runs, window)),
            Axis(shown.label(word)), marks, "" if alone else "above", plane=path))
    return draw_panels(
        panels, title="" if several or not titled else mechanism.title or mechanism.name,
        key=[(one.label, {"color": style.hue(i), "linewidth": style.LINE})
             for i, one in enumerate(runs)] if several else (),
        notes=[" ".join(notes)] if notes else (), width=wide, shared=not any(paths))


def _check(runs: Sequence[Plotted], window: Window, wide: float) -> None:
    """Check the window, the width of the figure [mm], and that each run has samples."""
    if not window[1] > window[0]:
        raise OutputError(f"{window[1]:g} s is not after the beginning, {window[0]:g} s",
                          code="bad-time")
    if not WIDTHS[0] <= wide <= WIDTHS[1]:
        raise OutputError(f"a figure cannot be {wide:g} mm wide; allowed: {WIDTHS[0]:g} to "
                          f"{WIDTHS[1]:g} mm", code="bad-picture")
    for one in runs:
        time = one.run.time
        if len(time[_inside(time, window)]) < 2:
            raise OutputError(
                f"the recording has {len(time)} samples, a plot needs at least 2" if len(time) < 2
                else f"{one.label} has fewer than 2 samples there: the first is at {time[0]:g} s, "
                f"the last at {time[-1]:g} s", code="bad-time")


def _groups(runs: Sequence[Plotted], quantities: Sequence[str], x: str) -> list[list[str]]:
    by_unit: dict[str, list[str]] = {}
    for name in quantities:
        unit = _unit(runs, name)
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


def _unit(runs: Sequence[Plotted], name: str) -> str:
    return next((one.run for one in runs if name in one.run), runs[0].run).unit(name)


class _Series(NamedTuple):
    """A curve of a run, SI."""

    place: int  # of its colour
    name: str
    x: Array
    y: Array
    target: Array | None


def _series(runs: Sequence[Plotted], names: Sequence[str], x: str, window: Window) -> list[_Series]:
    """The curves of a panel, of the runs that have them and x."""
    found = []
    for i, one in enumerate(runs):
        for j, name in enumerate(names):
            if name in one.run and (not x or x in one.run):
                time, value, target = (one.run.time, one.run[name], None) if x else track(
                    one.run, name, one.targets.get(name))
                here = _inside(time, window)
                found.append(_Series(
                    i if len(runs) > 1 else j, name, (one.run[x] if x else time)[here],
                    value[here], None if target is None else target[here]))
    return found


def _inside(time: Array, window: Window) -> slice:
    """The samples of a window."""
    return slice(int(np.searchsorted(time, window[0])),
                 int(np.searchsorted(time, window[1], side="right")))


def _is_path(curves: Sequence[_Series]) -> bool:
    """Whether one scale shows both coordinates of a path well."""
    spans = []
    for row in (np.concatenate(each) for each in zip(*((c.x, c.y) for c in curves), strict=True)):
        spans.append(float(np.nanmax(row) - np.nanmin(row)) if np.isfinite(row).any() else 0.0)
    return min(spans) > 0 and max(spans) <= FLAT * min(spans)


def _limits(runs: Sequence[Plotted], window: Window) -> tuple[float, float]:
    """The range of time that is shown [s]."""
    # a sample belongs to the middle of a step
    end = max(one.run.time[-1] + 0.5 * one.run.mechanism.run.step for one in runs)
    return max(0.0, window[0]), min(float(end), window[1])


def _events(runs: Sequence[Plotted], window: Window) -> tuple[list[Mark], list[str]]:
    """Lines at the events of runs, and the notes on them."""
    begin, end = _limits(runs, window)
    found = [(i, event) for i, one in enumerate(runs) for event in one.run.info.marked
             if begin <= event.time <= end]
    most = max(np.bincount([i for i, _ in found]), default=0)
    if most > MAX_EVENTS:
        return [], [f"{most} events are not marked: up to {MAX_EVENTS} are, in a window of time."]
    one = len(runs) == 1
    words = ", ".join(f"{event.event} at {event.time:.4g} s" for _, event in found if one)
    return [upright(event.time, **({} if one else {"color": style.hue(i), "alpha": 0.5}))
            for i, event in found], [f"Vertical lines: {words or 'events'}."] if found else []
