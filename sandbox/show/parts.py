"""What is drawn of a run, as a flat list of plain dicts, back to front: the films' picture.

A part says of which kind it is (``k``: the script has one function for each, by the same name), in
which layer (``l``), and what it shows (``n``: the element's name). A point is ``[body, x, y]`` in
the body's frame [m]; what changes from sample to sample is a column of one of
:mod:`sandbox.show.channels`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

import numpy as np

from sandbox.model.model import Model
from sandbox.picture.bars import bars_of
from sandbox.picture.elements.bodies import (
    ORDER,
    back_to_front,
    far_feet,
    joined_points,
    stalks,
    styles,
)
from sandbox.picture.elements.forces import hinges_of, vector_scale
from sandbox.picture.elements.links import TELLING
from sandbox.picture.geometry import shape_outline, shape_points
from sandbox.picture.marked import Place, round_interval, trace_colours, trace_names, traced
from sandbox.picture.palette import ROLES, Style
from sandbox.picture.run_data import RunData
from sandbox.picture.scales import ForceScale
from sandbox.picture.unions import bare_outlines, united
from sandbox.picture.wheels import WheelPicture, wheel_pictures
from sandbox.scene.bodies import Box, Capsule, Circle, Polygon, Polyline, Shape
from sandbox.scene.geometry import solids
from sandbox.scene.layers import EVERY, LAYERS, PASSES, meant
from sandbox.show.channels import sides_of, vectors_of
from sandbox.show.drives import arrows, belts, drive_marks, load_parts, told_parts
from sandbox.show.fluids import fluid_parts
from sandbox.show.joints import grooves, joint_marks, latches, links, stops
from sandbox.show.lines import cord_wheels, cords, springs
from sandbox.show.points import Part, css, path, point, short
from sandbox.values.planes import depth

FINE = 1e-3
"""How far the lines of an outline without a fill may be from a round one, in sizes of its shape."""
FAR_FOOT = 0.02
"""Share of the picture's width: points that lie farther beside a fixed body get a ground sign."""


def parts_of(run: RunData, scale: ForceScale, width: float) -> list[Part]:
    """Everything that may be drawn of a run, on a picture ``width`` [m] wide."""
    model = run.model
    order, lowest = _order(model)
    joined = joined_points(model)
    rails, cut = grooves(model)
    behind = [i for i in order if _still(model, i) and _depth(model, i) <= lowest]
    front = [i for i in order if i not in set(behind)]
    made: dict[str, Iterable[Part]] = {
        "rails": rails, "stalks": _stalks(model), "links": links(run),
        "bodies": _bodies(model, front, joined), "grooves": cut, "wheels": cord_wheels(model),
        "belts": belts(run), "bars": _bars(run), "traces": _traces(run),
        "fluids": fluid_parts(run), "springs": springs(model), "stops": stops(run),
        "grounds": _grounds(model, FAR_FOOT * width), "marks": drive_marks(run),
        "latches": latches(model), "pins": joint_marks(model), "cords": cords(model),
        "axes": _axes(model), "pressure": _pressure(run, width),
        "contacts": [{"k": "contacts", "l": "contacts"}],
        "loads": load_parts(run, scale, width), **_vectors(run, width),
        "drives": [*told_parts(run), *arrows(run, scale, width)], "body_names": _names(run),
    }
    found = [*_liquids(model), *_bodies(model, behind, joined)]
    depths = list(PASSES)
    found += [part for name in sorted(made, key=depths.index) for part in made[name]]
    found = _asked_for(run, found)
    bands = [part for part in found if part["k"] == "band"]
    for part in bands:
        part["told"] = len(bands) <= TELLING
    return found


def _asked_for(run: RunData, parts: list[Part]) -> list[Part]:
    """Without what the view does not show of single bodies, in layers that it shows of some."""
    bodies = run.mechanism.bodies
    some = {layer: meant(patterns, bodies) for layer, patterns in run.mechanism.view.show.items()
            if patterns and patterns != EVERY and LAYERS[layer].per_body}
    found = []
    for part in parts:
        if part["l"] in some and part["k"] == "contacts":
            part["of"] = some[part["l"]]
        elif part["l"] in some and part["l"] == "reactions":
            chosen = hinges_of(run, some[part["l"]])
            part["of"] = [k for k, joint in enumerate(hinges_of(run, range(len(bodies))))
                          if joint in chosen]
        elif part["l"] in some and part["k"] in ("vectors", "loads"):
            part["of"] = [k for k, at in enumerate(part["at"]) if at[0] in some[part["l"]]]
        elif part["l"] in some and part["k"] not in ("dry", "liquid", "pressure") and (
                _body_of(part) not in some[part["l"]]):
            continue
        found.append(part)
    return found


def _body_of(part: Part) -> int:
    """The body that a part is of."""
    own = part.get("b")
    return own if isinstance(own, int) else int(part["at" if "at" in part else "a"][0])


def fills_of(parts: list[Part]) -> list[list[str]]:
    """The fills and edges that parts name by :class:`Style`; these are numbered in their place."""
    table: dict[tuple[str, str], int] = {}
    for part in parts:
        style = part.get("f")
        if isinstance(style, Style):
            part["f"] = table.setdefault((css(style.fill), css(style.edge)), len(table))
    return [list(pair) for pair in table]


def _depth(model: Model, body: int) -> int:
    return depth(model.mechanism.bodies[body].plane)


def _swelling(model: Model) -> dict[tuple[int, int], int]:
    """Of bodies and the numbers of their circles the drive that sets the radius."""
    drives = model.drives
    return {(int(drives.target[k]), int(drives.shape[k])): k
            for k in drives.giving("radius").tolist()}


def _still(model: Model, body: int) -> bool:
    return bool(model.bodies.fixed[body]) and all(b != body for b, _ in _swelling(model))


def _order(model: Model) -> tuple[list[int], int]:
    """Bodies from back to front, and the lowest plane of one that moves."""
    bodies = model.mechanism.bodies
    order = sorted(range(len(bodies)), key=lambda i: (
        _depth(model, i), ORDER.index(bodies[i].role), i))
    return order, min((_depth(model, i) for i in order if not _still(model, i)), default=0)


def _liquids(model: Model) -> list[Part]:
    level = model.loads.level
    return [{"k": "liquid", "l": "loads", "y": y}
            for y in sorted(set(level[np.isfinite(level)].tolist()), reverse=True)]


def _grounds(model: Model, far: float) -> Iterator[Part]:
    """Signs for what is fixed and has nothing else to show for itself."""
    found = far_feet(model, far)
    found |= {i: points for i, points in joined_points(model, held=True).items()
              if model.bodies.fixed[i] and not model.mechanism.bodies[i].shapes}
    return ({"k": "ground", "l": "joints", "at": point(i, at), "f": ROLES["ground"]}
            for i, points in found.items() for at in points)


def _stalks(model: Model) -> Iterator[Part]:
    return ({"k": "stalk", "l": "bodies", "a": point(body, a), "b": point(body, b),
             "f": ROLES[model.mechanism.bodies[body].role]}
            for body, pairs in stalks(model).items() if not model.bodies.fixed[body]
            for a, b in pairs)


def traces_of(run: RunData) -> list[Place]:
    """The points that are traced: of the bodies that the view traces, of all if it says none."""
    view = run.mechanism.view
    return traced(run, view, view.show.get("traces") or EVERY)


def _traces(run: RunData) -> list[Part]:
    """Ways of points, with a mark ``every`` so many seconds; of several in colours, with names."""
    every = round_interval(float(run.time[-1] - run.time[0]))
    places = traces_of(run)
    bodies = [body for body, _ in places]
    inks = trace_colours(run.model, bodies) if len(bodies) > 1 else []
    return [{"k": "trace", "l": "traces", "w": k, "at": point(body, at), "every": every,
             "name": name, **({"ink": css(inks[k])} if inks else {})}
            for k, ((body, at), name) in enumerate(zip(
                places, trace_names(run.model, bodies), strict=True))]


def _bars(run: RunData) -> Iterator[Part]:
    """Bands between the two pins of bodies; ``j`` is the column of ``bars``."""
    for column, bar in enumerate(bars_of(run, range(len(run.mechanism.bodies)))):
        yield {"k": "band", "l": "bars", "n": run.mechanism.bodies[bar.body].name, "b": bar.body,
               "a": point(bar.body, bar.ends[0]), "e": point(bar.body, bar.ends[1]), "j": column}


def _vectors(run: RunData, width: float) -> dict[str, list[Part]]:
    """Arrows on wish: of each layer one part, its values two columns each of the channel ``v``."""
    found: dict[str, list[Part]] = {}
    for name, (layer, vectors) in vectors_of(run).items():
        scale = vector_scale(vectors, run.time, width)
        if scale.metres > 0:
            found[layer] = [{
                "k": "vectors", "l": layer, "v": name, "unit": vectors.unit,
                "words": vectors.words, "ink": layer.rstrip("s").upper(),
                "metres": short(scale.metres), "most": short(scale.reference),
                "longest": short(scale.longest),
                "at": [point(body, at) for body, at in vectors.places]}]
    return found


def _pressure(run: RunData, width: float) -> Iterator[Part]:
    """Strips along flat sides, as high as the force per length; their corners are ``patches``."""
    scale = sides_of(run).scale(run.time, width)
    if scale.metres > 0:
        yield {"k": "pressure", "l": "pressure", "metres": short(scale.metres),
               "most": short(scale.reference), "longest": short(scale.longest)}


def _axes(model: Model) -> Iterator[Part]:
    """The frames of bodies."""
    return ({"k": "axes", "l": "axes", "b": i} for i in range(len(model.bodies.name)))


def _names(run: RunData) -> Iterator[Part]:
    """Names of bodies at their centres of mass."""
    centres = run.arrays["body_centre"]
    return ({"k": "name", "l": "body_names", "b": i, "n": body.name, "at": point(i, centres[i])}
            for i, body in enumerate(run.mechanism.bodies))


def _bodies(
    model: Model, order: list[int], joined: dict[int, list[tuple[float, float]]],
) -> Iterator[Part]:
    looks, wheels, swelling = styles(model), wheel_pictures(model), _swelling(model)
    for i in order:
        body, fixed = model.mechanism.bodies[i], bool(model.bodies.fixed[i])
        common: Part = {"l": "bodies", "b": i, "n": body.name, "f": looks[i]}
        if fixed:
            common["h"] = 1
        for shape in body.displaces:
            for solid, _ in solids(shape):
                yield {"k": "dry", "l": "loads", "b": i, "r": [path(shape_outline(solid))]}
        changing = {k for owner, k in swelling if owner == i}
        if not body.fill:
            bare = [shape for k, shape in enumerate(body.shapes) if k not in changing]
            error = FINE * max(map(_size, bare), default=0.0)
            for line in bare_outlines(bare, error, turns=not fixed):
                yield {"k": "poly", **common, "h": 0, "r": [], "o": path(line)}
        one = united(body.shapes, changing) if body.fill else []
        if one:
            yield {"k": "poly", **common, **_union([body.shapes[k] for k in one])}
        for k, shape in back_to_front(body.shapes):
            if k in one or not (body.fill or k in changing):
                continue
            if isinstance(shape, Circle):
                yield {"k": "disc", **common, "at": point(i, shape.at), "s": shape.radius,
                       **({"d": swelling[i, k]} if (i, k) in swelling else {})}
            else:
                yield {"k": "poly", **common, **_outline(shape)}
        rail = i in model.joints.bodies[model.joints.grooved, 0]
        if not body.shapes and not fixed and not rail:
            for start, end in pairwise(sorted(joined.get(i, []))):
                if np.hypot(end[0] - start[0], end[1] - start[1]) > 1e-9:
                    yield {"k": "bar", **common, "a": point(i, start), "e": point(i, end)}
        for wheel in wheels.get(i, []):
            plain = body.role == "link" and not fixed
            yield _wheel(wheel, {**common, "f": ROLES["pulley"] if plain else looks[i]})


def _size(shape: Shape) -> float:
    return float(np.ptp(shape_points(shape), axis=0).max())


def _union(shapes: Sequence[Shape]) -> Part:
    """Shapes that touch as one outline, without seams."""
    found: Part = {"m": 1, "c": [], "r": []}
    for shape in shapes:
        if isinstance(shape, Circle):
            found["c"].append([*path((shape.at, shape.at)), shape.radius])
        else:
            for key, outlines in _outline(shape).items():
                found[key] += outlines
    return found


def _outline(shape: Shape) -> Part:
    """Rings ``r``; capsules ``c`` as such, round however large; ``m`` of pieces that are one."""
    if isinstance(shape, Capsule):
        return {"c": [[*path((shape.start, shape.end)), shape.radius]]}
    if isinstance(shape, Polyline):
        pieces = [solid for solid, _ in solids(shape)]
        found: Part = {"c": [[*path((s.start, s.end)), s.radius]
                             for s in pieces if isinstance(s, Capsule)], "m": 1}
        rings = [path(shape_outline(s)) for s in pieces if not isinstance(s, Capsule)]
        return {**found, "r": rings} if rings else found
    if isinstance(shape, Polygon) and not shape.whole:
        return {"r": [path(ring) for ring in (shape.points, *shape.holes)]}
    if isinstance(shape, Box):
        return {"r": [path(shape_points(shape))]}
    return {"r": [path(shape.points)]} if isinstance(shape, Polygon) else {
        "r": [path(shape_points(shape))]}


def _wheel(wheel: WheelPicture, common: Part) -> Part:
    rings = [wheel.outline] if wheel.rim is None else [wheel.rim, wheel.outline]
    found: Part = {"k": "poly", **common, "r": [path(ring + wheel.centre) for ring in rings]}
    if wheel.pitch_line is not None:
        closed = wheel.pitch_line if len(wheel.pitch_line) == 2 else np.concatenate(
            [wheel.pitch_line, wheel.pitch_line[:1]])
        found["p"] = path(closed + wheel.centre)
    if wheel.spoke is not None:
        found["o"] = path(wheel.spoke + wheel.centre)
    return found


