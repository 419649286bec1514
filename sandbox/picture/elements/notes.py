"""What pictures show besides the mechanism: traces, names, frames of bodies, liquids, a grid."""

from __future__ import annotations

import math

import numpy as np

from sandbox.picture.camera import Camera, Stage, round_length
from sandbox.picture.glyphs import glyph
from sandbox.picture.listing import Item, Listing, short
from sandbox.picture.marked import finger_names, round_interval, trace_colours, trace_names, traced
from sandbox.picture.palette import lighter
from sandbox.picture.subject import BEHIND, Subject

TRACE, MARK = 1.8, 3.0
"""Width of a trace, radius of its marks of time [points]."""
PITCH = 70.0
"""Least distance of lines of the grid [points]."""
MOST_LINES, FAR = 200, 1e9
"""Lines of the grid along an axis, at most; none are so many steps from the origin."""
WIDE = 1e4
"""Half the width of a liquid, in widths of the picture."""


def add_traces(s: Subject) -> None:
    """The ways of points up to now, with marks of time; of several with names."""
    places = traced(s.run, s.view, s.layers.patterns("traces"))
    if not places or "traces" not in s.layers:
        return
    bodies = [body for body, _ in places]
    named = s.layers.of("body_names")
    every = round_interval(float(s.run.time[-1] - s.run.time[0]))
    for (body, at), colour, name in zip(places, trace_colours(s.run.model, bodies),
                                        trace_names(s.run.model, bodies), strict=True):
        token = s.ink(colour, lighter(colour, 0.5))
        s.trace_inks.append(token)
        point = s.point_on(body, at)
        s.add("traces", "trail", s.run.mechanism.bodies[body].name, at=point, every=every,
              s=s.style(token, token, TRACE), mark=MARK)
        if name and body not in named:
            s.add("traces", "text", name, at=point, words=name, s=s.style("", token), rank=3)
    s.signs.add("trace")


def add_names(s: Subject) -> None:
    """Names of fingers beside their first hinges, and names of bodies."""
    if "names" in s.layers:
        for name, body in finger_names(s.run.model):
            s.add("body_names", "text", name, layer="names", at=[body, 0, 0], words=name,
                  s=s.style("", "faint_ink"), rank=5, clear=12.0)
    for body in s.layers.of("body_names"):
        name = s.run.mechanism.bodies[body].name
        s.add("body_names", "text", name, at=s.point_on(body, s.run.arrays["body_centre"][body]),
              words=name, s=s.style("", "faint_ink"), rank=3)


def add_axes(s: Subject) -> None:
    """The axes x and y of bodies' frames."""
    for body in s.layers.of("axes"):
        s.add("axes", "mark", at=[body, 0, 0], g=glyph(s.out, "axes"),
              turn=s.out.varying(s.run.arrays["body_pose"][:, body, 2]))


def add_liquids(s: Subject) -> None:
    """The area below the level of each liquid."""
    levels = s.run.model.loads.level
    for level in sorted(set(levels[np.isfinite(levels)].tolist()), reverse=True):
        far = WIDE * s.width
        s.add("loads", "path", plane=BEHIND, f=s.out.world, s=s.style("liquid", "liquid_edge", 1.4),
              d=[[short(v) for v in (-far, level, far, level, far, level - far,
                                     -far, level - far)]])


def grid(out: Listing, camera: Camera, stage: Stage, point: float) -> list[Item]:
    """Lines of equal x and equal y as items, with numbers at the left and below.

    ``point`` is pixels per point.
    """
    step = round_length(min(2.5 * PITCH * point / camera.scale, 1e300))
    unit, factor = ("m", 1.0) if step >= 0.1 else ("mm", 1e3)
    corners = np.array([[stage.left, stage.top + stage.height],
                        [stage.left + stage.width, stage.top]])
    (x0, y0), (x1, y1) = camera.to_world(corners).tolist()
    items: list[Item] = []
    for axis, low, high in ((0, x0, x1), (1, y0, y1)):
        if not abs(low) + abs(high) < FAR * step:
            continue
        first, last = math.ceil(low / step), math.floor(high / step)
        for n in range(first, min(last, first + MOST_LINES) + 1):
            at = n * step
            ends = [[at, y0], [at, y1]] if axis == 0 else [[x0, at], [x1, at]]
            style = out.style("", "hairline", 1.8 if n == 0 else 0.9)
            items.append({"k": "line", "l": "coordinates", "s": style,
                          "p": [[out.world, *map(short, end)] for end in ends]})
            word = f"{n * step * factor:.6g}{' ' + unit if n == last else ''}"
            items.append({"k": "text", "l": "coordinates", "words": word, "rank": 6,
                          "at": [out.world, *map(short, ends[0])], "edge": axis,
                          "s": out.style("", "faint_ink")})
    return items
