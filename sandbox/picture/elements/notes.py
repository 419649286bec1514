"""What pictures show besides the mechanism: traces, names, frames of bodies, liquids, a grid."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sandbox.picture.bounds import Camera, Rectangle
from sandbox.picture.elements.bodies import colour_of
from sandbox.picture.geometry import XY, shape_points
from sandbox.picture.listing import Item, Listing, RunData, flat
from sandbox.picture.palette import INK, TRACES, Colour, lighter, mixed
from sandbox.picture.scales import round_length, round_up
from sandbox.picture.subject import BEHIND, Subject
from sandbox.scene.layers import EVERY, meant
from sandbox.scene.settings import View
from sandbox.values.appearance import rgb

Place = tuple[int, XY]
TRACE, MARK = 1.8, 3.0  # width of a trace, radius of its marks of time [points]
MAX_LINES, FAR = 200, 1e9  # lines of the grid along an axis, and steps from the origin
PIECES = 12  # between marks of time, at most


def add_traces(s: Subject) -> None:
    """The paths of points up to now, with marks of time; of several with names."""
    places = traced(s.run, s.view, s.patterns("traces"))
    if not places or "traces" not in s.layers:
        return
    bodies = [body for body, _ in places]
    named = 1 < len(set(bodies)) == len(bodies) <= 6
    every = mark_interval(s.run)
    own = [colour_of(s.run.model, s.run.mechanism.bodies[body]) for body in bodies]
    colours: list[Colour] = [mixed(rgb(each), INK, 0.3) for each in own if each]
    if len(own) == 1 or len(set(colours)) < len(own):  # bodies without different colours
        colours = [TRACES[k % len(TRACES)] for k in range(len(own))]
    for (body, at), colour in zip(places, colours, strict=True):
        token, name = s.ink(colour, lighter(colour, 0.5)), s.run.mechanism.bodies[body].name
        s.trace_ink = s.trace_ink or token
        s.add("traces", "trail", name, at=s.on(body, at), every=every, mark=MARK,
              s=(token, token, TRACE))
        if named and body not in s.layers.get("body_names", ()):
            s.add("traces", "text", name, at=s.on(body, at), words=name, s=("", token), rank=3)


def add_names(s: Subject) -> None:
    """Names of fingers beside their first hinges, and names of bodies."""
    mechanism, index = s.run.mechanism, s.run.model.names.body
    for group in mechanism.groups:
        if group.kind == "finger" and group.bodies and group.bodies[0] in index:
            s.add("body_names", "text", group.name, layer="names", words=group.name, clear=12.0,
                  at=[index[group.bodies[0]], 0, 0], s=("", "faint_ink"), rank=5)
    for body in s.layers.get("body_names", ()):
        name = mechanism.bodies[body].name
        s.add("body_names", "text", name, at=s.on(body, s.run.arrays["body_centre"][body]),
              words=name, s=("", "faint_ink"), rank=3)


def add_axes(s: Subject) -> None:
    """The axes x and y of bodies' frames."""
    for body in s.layers.get("axes", ()):
        s.add("axes", "mark", at=[body, 0, 0], g="axes",
              turn=s.out.varying(s.run.arrays["body_pose"][:, body, 2]))


def add_liquids(s: Subject) -> None:
    """The area below the level of each liquid."""
    levels, far = s.run.model.loads.level, 1e4 * s.width
    for level in sorted(set(levels[np.isfinite(levels)].tolist()), reverse=True):
        s.add("loads", "path", plane=BEHIND, f=s.out.world, s=("liquid", "liquid_edge", 1.4),
              d=[flat((-far, level), (far, level), (far, level - far), (-far, level - far))])


def grid(out: Listing, camera: Camera, stage: Rectangle, point: float) -> list[Item]:
    """Lines of equal x and y with numbers at the edges, as items; ``point`` is pixels per point."""
    step = round_length(min(175.0 * point / camera.scale, 1e300))
    unit, factor = ("m", 1.0) if step >= 0.1 else ("mm", 1e3)
    (x0, y1), (x1, y0) = camera.to_world(stage.corners).tolist()
    items: list[Item] = []
    for axis, low, high in ((0, x0, x1), (1, y0, y1)):
        if not abs(low) + abs(high) < FAR * step:
            continue
        first, last = math.ceil(low / step), math.floor(high / step)
        for n in range(first, min(last, first + MAX_LINES) + 1):
            at = n * step
            ends = [[out.world, *flat(end)] for end in (
                [(at, y0), (at, y1)] if axis == 0 else [(x0, at), (x1, at)])]
            items.append({"k": "line", "l": "coordinates", "p": ends,
                          "s": out.style("", "hairline", 1.8 if n == 0 else 0.9)})
            word = f"{n * step * factor:.6g}{' ' + unit if n == last else ''}"
            items.append({"k": "text", "l": "coordinates", "words": word, "rank": 6,
                          "at": ends[0], "edge": axis, "s": out.style("", "faint_ink")})
    return items


def fingertip(run: RunData, body: int) -> XY:
    """The point of a finger's last phalanx farthest from its first hinge [m], else its origin."""
    joints = run.model.joints
    hinges = [joints.anchor[k, 1] for k in joints.hinges.tolist() if joints.bodies[k, 1] == body]
    shapes = run.mechanism.bodies[body].shapes
    points = shape_points(*shapes) if shapes and hinges else np.zeros((1, 2))
    # the outline's corners beside the tip are as far from the hinge on either side of it
    x, y = points[np.hypot(*(points - (hinges or [0])[0]).T).argmax()].tolist()
    return x, y


def traced(run: RunData, view: View, patterns: Sequence[str], *, tips: bool = True) -> list[Place]:
    """Traced points of the bodies that fit patterns: the view's, then ``tips``, then centres."""
    index, every = run.model.names.body, tips and tuple(patterns) == EVERY
    chosen, found = meant(patterns, run.mechanism.bodies), list[Place]()
    lasts = [index[group.bodies[-1]] for group in run.mechanism.groups if tips
             and group.kind == "finger" and group.bodies and group.bodies[-1] in index]
    centres = [(float(x), float(y)) for x, y in run.arrays["body_centre"]]
    for places in ([(index[trace.body], trace.at) for trace in view.traces],
                   [(body, fingertip(run, body)) for body in lasts],
                   [(body, centres[body]) for body in chosen if not run.model.bodies.fixed[body]]):
        known = {body for body, _ in found}
        if not (every and found):
            found += [place for place in places if place[0] in chosen and place[0] not in known]
    return found


def marked(run: RunData, view: View, patterns: Sequence[str]) -> list[Place]:
    """Points of moving bodies whose velocity is shown: the traced ones, else centres of mass."""
    return [place for place in traced(run, view, patterns, tips=False)
            if not run.model.bodies.fixed[place[0]]]


def mark_interval(run: RunData) -> float:
    """The time between marks [s]: 1, 2 or 5 times a power of ten, at most :data:`PIECES` marks."""
    return round_up(float(run.time[-1] - run.time[0]) / PIECES, (1, 2, 5))
