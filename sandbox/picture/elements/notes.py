"""What pictures show besides the mechanism: traces, names, frames of bodies, liquids, a grid."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sandbox.model.model import Model
from sandbox.picture.camera import Camera, Stage, round_length
from sandbox.picture.elements.bodies import colour_of
from sandbox.picture.geometry import shape_points
from sandbox.picture.glyphs import glyph
from sandbox.picture.listing import Item, Listing, short
from sandbox.picture.palette import INK, TRACES, Colour, lighter, mixed
from sandbox.picture.run_data import RunData
from sandbox.picture.subject import BEHIND, Subject
from sandbox.scene.layers import EVERY, meant
from sandbox.scene.settings import View
from sandbox.values.appearance import rgb

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


XY = tuple[float, float]
Place = tuple[int, XY]
DARKER = 0.3
"""How much darker a way is than the body that goes it."""
MOST_NAMED = 6
"""Of no more than so many ways the bodies' names stand at their ends."""
PIECES = 12
"""Between marks of time, at most."""


def fingertip(run: RunData, body: int) -> XY:
    """The point of a finger's last phalanx that is farthest from its first hinge, [m].

    Of one without shapes or hinge it is the body's origin.
    """
    joints = run.model.joints
    hinges = [joints.anchor[k, 1] for k in joints.hinges.tolist() if joints.bodies[k, 1] == body]
    shapes = run.mechanism.bodies[body].shapes
    if not shapes or not hinges:
        return 0.0, 0.0
    points = np.concatenate([shape_points(shape) for shape in shapes])
    # the outline's corners beside the tip are as far from the hinge on either side of it
    far = points[np.hypot(*(points - hinges[0]).T).argmax()]
    return float(far[0]), float(far[1])


def _centre(run: RunData, body: int) -> Place:
    x, y = run.arrays["body_centre"][body].tolist()
    return body, (x, y)


def traced(run: RunData, view: View, patterns: Sequence[str]) -> list[Place]:
    """The points whose ways are drawn of the bodies that the patterns fit.

    Those of ``view.traces``. Of bodies without one the fingertip or the centre of mass, where they
    are named, or where nothing at all is traced; of all bodies, the tips if there are fingers.
    """
    names = [body.name for body in run.mechanism.bodies]
    chosen = set(meant(patterns, run.mechanism.bodies))
    named = [(names.index(trace.body), trace.at) for trace in view.traces]
    found = [place for place in named if place[0] in chosen]
    if tuple(patterns) == EVERY and found:
        return found
    tips = [names.index(group.bodies[-1]) for group in run.mechanism.groups
            if group.kind == "finger" and group.bodies and group.bodies[-1] in names]
    tips = [body for body in tips if body in chosen]
    given = {body for body, _ in found}
    found += [(body, fingertip(run, body)) for body in tips if body not in given]
    if tuple(patterns) == EVERY and found:
        return found
    given |= set(tips)
    return found + [_centre(run, body) for body in sorted(chosen - given) if _moves(run, body)]


def trace_colours(model: Model, bodies: Sequence[int]) -> list[Colour]:
    """What tells the ways of points of some bodies apart.

    The bodies' own colours, darker, where the scene gives each another one; else :data:`TRACES`.
    """
    own = [colour_of(model, model.mechanism.bodies[body]) for body in bodies]
    given = [mixed(rgb(each), INK, DARKER) for each in own if each]
    if len(own) > 1 and len(set(given)) == len(own):
        return given
    return [TRACES[k % len(TRACES)] for k in range(len(own))]


def trace_names(model: Model, bodies: Sequence[int]) -> list[str]:
    """What stands at the ends of ways: names of bodies, of a few different ones; else nothing."""
    alone = len(bodies) < 2 or len(bodies) > MOST_NAMED or len(set(bodies)) < len(bodies)
    return ["" if alone else model.mechanism.bodies[body].name for body in bodies]


def marked(run: RunData, view: View, patterns: Sequence[str]) -> list[Place]:
    """The points whose velocity is shown: of each body that moves those traced, else its centre."""
    names = [body.name for body in run.mechanism.bodies]
    chosen = [body for body in meant(patterns, run.mechanism.bodies) if _moves(run, body)]
    named = [(names.index(trace.body), trace.at) for trace in view.traces]
    given = {body for body, _ in named}
    return [place for place in named if place[0] in chosen] + [
        _centre(run, body) for body in chosen if body not in given]


def _moves(run: RunData, body: int) -> bool:
    return not bool(run.model.bodies.fixed[body])


def round_interval(duration: float) -> float:
    """The time between marks [s]: 1, 2 or 5 times a power of ten, at most :data:`PIECES` in all.

    >>> round_interval(0.5), round_interval(3.0)
    (0.05, 0.5)
    """
    least = duration / PIECES
    if not least > 1e-300:
        return 1.0
    power = 10.0 ** math.floor(math.log10(least))
    return float(next((step * power for step in (1.0, 2.0, 5.0)
                       if step * power >= least * (1 - 1e-9)), 10.0 * power))


def finger_names(model: Model) -> list[tuple[str, int]]:
    """Names of the finger groups with the body each begins with."""
    index = model.names.body
    return [(group.name, index[group.bodies[0]]) for group in model.mechanism.groups
            if group.kind == "finger" and group.bodies and group.bodies[0] in index]
