"""Curves and points in labelled panels, one below the other, as PNG, SVG or PDF files.

A curve named ``joint 1, engine`` is what ``engine`` found of ``joint 1``: what stands before the
comma has a colour, what stands behind it a manner of drawing, where several curves share either.
Lines that end at the right have their names there; all else is named above the panel, where it
covers nothing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from sandbox.draw.figure import style
from sandbox.draw.figure.plane import path_scale
from sandbox.draw.figure.strands import take_apart
from sandbox.draw.figure.style import SideLabel
from sandbox.numeric import Array

HEIGHT, KEY, AXES, WIDE = 56.0, 4.6, 42.0, 100.0
"""Of a panel, of a row of names above it, of its axes; how wide these are [mm]."""
ROW, SURROUND = 5.0, 18.0
"""Height of a row, and of what is not rows [mm]."""
KINDS: dict[str, dict[str, Any]] = {
    "line": {"linewidth": style.LINE},
    "dashed": style.TARGET,
    "points": {"linestyle": "", "markersize": 4.0, "markerfacecolor": "white",
               "markeredgewidth": 1.1},
    "ticks": {"linestyle": "", "marker": "|", "markersize": 11},
    "joined": {"linewidth": 1.3, "markersize": 4.5},
}
"""How each kind of curve is drawn."""
MARKERS = "os^Dv"
"""Of points of several kinds."""
LARGER = 1.8
"""Points of one kind are larger than those of the next by so much [pt]: they may coincide."""
THICK, APART = 30, 0.045
"""Of more points than this those are drawn that are so far apart, as a share of the panel."""
READABLE = (1e-3, 1e4)
"""Numbers between these stand at logarithmic axes as they are, not as powers of ten."""
AT_THE_RIGHT = 0.8
"""Of the panel's width: a line that ends beyond has its name at its end."""
FEW = 100
"""Largest over smallest number of a logarithmic axis that has twos and fives, too."""


@dataclass(frozen=True)
class Curve:
    """Points (x, y), shape [n] each."""

    label: str
    """With a comma, what it is of and what found it."""
    x: Array
    y: Array
    kind: Literal["line", "points", "dashed", "joined", "ticks"] = "line"
    """``joined``: points with a line through them; ``ticks``: upright strokes."""


@dataclass(frozen=True)
class Panel:
    """Curves over two labelled axes; labels carry the units."""

    title: str
    x: str
    y: str
    curves: Sequence[Curve]
    scale: Literal["linear", "log", "plane"] = "linear"
    """Of both axes; in the ``plane`` they have one, so that a circle is round."""
    top: float | None = None
    """Highest y shown; peaks beyond are cut off."""
    rows: Sequence[str] = ()
    """Names of the rows y = 0, 1, ... from above, in place of numbers."""
    band: tuple[float, float] | None = None
    """A range of x that is shaded."""


@dataclass(frozen=True)
class _Manner:
    """What a curve is called, and how it is drawn."""

    head: str
    tail: str
    """Empty where its name is one."""
    how: Mapping[str, Any]


def save_panels(path: Path, panels: Sequence[Panel]) -> None:
    """Draw panels into a file, its format by its ending.

    Raises:
        OutputError: it cannot be written.
        ValueError: no panels.
    """
    style.save_figure(draw(panels), path)


def draw(panels: Sequence[Panel]) -> Any:
    """The figure.

    Raises:
        ValueError: no panels.
    """
    if not panels:
        raise ValueError("panels must hold at least one, got none")
    figure, heights = style.new_figure(1.0), [_height(panel) for panel in panels]
    grid = figure.subplots(len(panels), 1, squeeze=False,
                           gridspec_kw={"height_ratios": heights})[:, 0]
    keys = [_fill(axes, panel) for axes, panel in zip(grid, panels, strict=True)]
    above = 0
    for i, (axes, panel, key) in enumerate(zip(grid, panels, keys, strict=True)):
        # what stands above the first panel need not stand above all
        told = [] if i and [name for name, _ in key] == [name for name, _ in keys[0]] else key
        above += _name(axes, panel.title, told)
    figure.set_size_inches(style.WIDTH * style.MM, (sum(heights) + KEY * above) * style.MM)
    return figure


def _height(panel: Panel) -> float:
    if panel.scale == "plane":
        x, y = _values(panel)
        return path_scale(x, [y], WIDE).height(y) + HEIGHT - AXES
    return max(HEIGHT, ROW * len(panel.rows) + SURROUND)


def _values(panel: Panel) -> tuple[Array, Array]:
    return (np.concatenate([curve.x for curve in panel.curves]),
            np.concatenate([curve.y for curve in panel.curves]))


def _fill(axes: Any, panel: Panel) -> list[tuple[str, Any]]:
    """Draw a panel's curves; the names that are left to stand above it, with their samples."""
    looks = _looks(panel.curves)
    for curve, look in zip(panel.curves, looks, strict=True):
        few = {"markevery": APART} if curve.kind == "points" and len(curve.x) > THICK and \
            np.isfinite(curve.x + curve.y).all() else {}
        axes.plot(curve.x, curve.y, **look.how, **few)
    if panel.band is not None:
        axes.axvspan(*panel.band, color=style.BAND, linewidth=0, zorder=0)
    style.dress(axes, "", panel.y, x=panel.x)
    _scale(axes, panel)
    if panel.scale != "plane":
        axes.set(xlim=axes.get_xlim(), ylim=axes.get_ylim())
    heads, tails = _keys(looks)
    aside = _ends(axes, panel.curves, looks)
    if aside:
        axes.set_xlim(right=max(np.nanmax(curve.x) for curve in panel.curves))
        style.label_side(axes, aside, height=AXES)
        named = {label.text for label in aside}
        heads = [(name, how) for name, how in heads if name not in named]
    _take_apart(axes, panel.curves)
    if aside:
        _whole_markers(axes, looks)
    return [(name, how) for name, how in [*heads, *tails] if name]


def _looks(curves: Sequence[Curve]) -> list[_Manner]:
    """How each is drawn: a colour for what it is of, a dash or a marker for what found it."""
    split = [(head, tail.strip()) for head, _, tail in (c.label.partition(",") for c in curves)]
    heads = [head for head, _ in split]
    shared = any(heads.count(head) > 1 for head in heads)
    if not shared:
        split = [(curve.label, "") for curve in curves]
    order = list(dict.fromkeys(head for head, _ in split))
    manners = {kind: list(dict.fromkeys(
        tail if shared else head for curve, (head, tail) in zip(curves, split, strict=True)
        if curve.kind == kind)) for kind in ("line", "points", "joined")}
    looks = []
    for curve, (head, tail) in zip(curves, split, strict=True):
        place = order.index(head)
        how = {**KINDS[curve.kind], "color": style.hue(place)}
        mine = manners.get(curve.kind, [])
        rank = mine.index(tail if shared else head) if mine else 0
        if curve.kind == "line":
            turn = rank if shared else place // len(style.COLOURS)
            how["linestyle"] = style.DASHES[turn % len(style.DASHES)]
        elif curve.kind in ("points", "joined"):
            how["marker"] = MARKERS[rank % len(MARKERS)]
            how["markersize"] += LARGER * (len(mine) - 1 - rank) * (curve.kind == "points")
        looks.append(_Manner(head, tail, how))
    return looks


def _keys(looks: Sequence[_Manner]) -> tuple[list[tuple[str, Any]], list[tuple[str, Any]]]:
    """What is to be named: what curves are of, in its colour; what found them, in none."""
    from matplotlib.lines import Line2D

    heads: dict[str, Any] = {}
    tails: dict[str, Any] = {}
    for look in looks:
        if look.tail and sum(other.head == look.head for other in looks) > 1:
            heads.setdefault(look.head, Line2D([], [], color=look.how["color"], linewidth=3.0))
            tails.setdefault(look.tail, Line2D([], [], **{**look.how, "color": style.INK}))
        else:
            name = f"{look.head}, {look.tail}" if look.tail else look.head
            heads.setdefault(name, Line2D([], [], **look.how))
    return list(heads.items()), list(tails.items())


def _ends(axes: Any, curves: Sequence[Curve], looks: Sequence[_Manner]) -> list[SideLabel]:
    """Names at the ends of lines, if there are several and all end at the right; else none."""
    to_axes = axes.transScale + axes.transLimits
    found: dict[str, SideLabel] = {}
    for curve, look in zip(curves, looks, strict=True):
        finite = np.flatnonzero(np.isfinite(curve.x + curve.y))
        if curve.kind in ("points", "ticks") or not len(finite) or look.head in found:
            continue
        shown = curve.x[finite]
        if np.ptp(shown) == 0:  # upright: at no height in particular
            continue
        last = finite[-1]
        if to_axes.transform((curve.x[last], curve.y[last]))[0] < AT_THE_RIGHT:
            return []
        found[look.head] = SideLabel(float(curve.y[last]), look.head, look.how["color"])
    return list(found.values()) if len(found) > 1 else []


def _take_apart(axes: Any, curves: Sequence[Curve]) -> None:
    """Where lines coincide, draw their colours by turns."""
    take_apart(axes, [line for line, curve in zip(axes.get_lines(), curves, strict=True)
                      if curve.kind == "line"])


def _whole_markers(axes: Any, looks: Sequence[_Manner]) -> None:
    """Those at the right end, where the axes end as well, again: half of each was cut."""
    (left, right), (low, high) = sorted(axes.get_xlim()), sorted(axes.get_ylim())
    for line, look in list(zip(axes.get_lines(), looks, strict=False)):
        x, y = line.get_xydata().T
        last = (x >= right - 1e-9 * (right - left)) & (y >= low) & (y <= high)
        if "marker" in look.how and last.any():
            axes.plot(x[last], y[last], scalex=False, scaley=False, clip_on=False,
                      **{**look.how, "linestyle": ""})


def _name(axes: Any, title: str, key: Sequence[tuple[str, Any]]) -> int:
    """The panel's title, and names under it in rows above the axes; how many rows."""
    rows = 0
    if key:
        longest = max(len(name) for name, _ in key)
        wide = style.LETTER * style.SMALL * style.MM_PER_POINT * longest + style.SAMPLE
        columns = max(1, min(len(key), int((style.WIDTH - 15.0) / wide)))
        rows = math.ceil(len(key) / columns)
        style.legend(axes, [how for _, how in key], [style.plain(name) for name, _ in key],
                     loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, borderpad=0.0,
                     borderaxespad=0.3, labelspacing=0.35, columnspacing=1.4)
    axes.set_title(style.plain(title), fontsize=style.PLAIN, color=style.INK, loc="left",
                   pad=5 + rows * KEY / style.MM_PER_POINT)
    return rows


def _scale(axes: Any, panel: Panel) -> None:
    if panel.rows:
        axes.set_yticks(range(len(panel.rows)), labels=panel.rows)
        axes.invert_yaxis()
    elif panel.scale == "log":
        axes.set_xscale("log")
        axes.set_yscale("log")
        for axis, values in zip((axes.xaxis, axes.yaxis), _values(panel), strict=True):
            known = values[np.isfinite(values)]
            if ((known > READABLE[0]) & (known < READABLE[1])).all():
                axis.set_major_formatter(lambda value, _: style.number(value))
                shown = "25" if len(known) and known.max() <= FEW * known.min() else ""
                axis.set_minor_formatter(
                    lambda value, _, shown=shown: style.number(value)
                    if f"{value:e}"[0] in shown else "")
    elif panel.scale == "plane":
        x, y = _values(panel)
        path_scale(x, [y], WIDE).lay(axes, y)
    else:
        style.powers(axes)
        if all((np.mod(curve.x, 1) == 0).all() for curve in panel.curves):  # what is counted
            axes.xaxis.get_major_locator().set_params(integer=True)
    if panel.top is not None:
        axes.set_ylim(-0.05 * panel.top, panel.top)
