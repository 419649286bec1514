"""Loads as arrays, each as often as it has bodies; outlines of what a liquid lifts."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sandbox.model.joints import placed, rotated
from sandbox.model.model import Bodies, BodyLoads, Model, columns_of
from sandbox.model.programs import law_of_load
from sandbox.numeric import Array
from sandbox.scene.bodies import Box, Capsule, Circle, Polygon, Shape
from sandbox.scene.geometry import corners
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.outlines.rings import wound

# x, y of its centre, first and last angle, radius; of a straight side its two ends and 0
Arc = tuple[float, float, float, float, float]


def compile_loads(mechanism: Mechanism, bodies: Bodies) -> BodyLoads:
    """The loads of a mechanism whose references are right."""
    laws = [law_of_load(load, tuple(mechanism.tables), mechanism.functions)
            for load in mechanism.loads]
    columns = [load.columns(mechanism) for load in mechanism.loads]
    load, on = np.array(mechanism.loaded, dtype=np.int64).reshape(-1, 2).T.copy()
    law, rows = tuple(laws[i] for i in load), [columns[i] for i in load]
    lifted = [mechanism.bodies[i] for i in on]
    sides = [[side for shape in body.displaces or body.shapes for side in _sides(shape)]
             if its is None else [] for its, body in zip(law, lifted, strict=True)]
    return BodyLoads(
        name=tuple(f"{mechanism.loads[i].name}.{body.name}"
                   for i, body in zip(load, lifted, strict=True)),
        load=load, body=on, law=law,
        at=np.array([row.get("at") or centre for row, centre in zip(
            rows, bodies.centre[on], strict=True)], dtype=float).reshape(-1, 2),
        **columns_of(BodyLoads, [None] * len(rows), rows),
        lift=np.array([row.get("weight", math.nan) * body.thickness
                       for row, body in zip(rows, lifted, strict=True)], dtype=float),
        sides=np.array([side for each in sides for side in each], dtype=float).reshape(-1, 5),
        first=np.cumsum([0, *map(len, sides)], dtype=np.int64))


def _sides(shape: Shape) -> Iterator[Arc]:
    """Sides and arcs around a shape in the body's frame, the liquid that it displaces left."""
    if isinstance(shape, Circle):
        yield *shape.at, 0.0, math.tau, shape.radius
    elif isinstance(shape, Capsule):
        (ax, ay), (bx, by), r = shape.start, shape.end, shape.radius
        turn = math.atan2(by - ay, bx - ax)
        nx, ny = -r * math.sin(turn), r * math.cos(turn)
        yield ax - nx, ay - ny, bx - nx, by - ny, 0.0
        yield bx, by, turn - math.pi / 2, turn + math.pi / 2, r
        yield bx + nx, by + ny, ax + nx, ay + ny, 0.0
        yield ax, ay, turn + math.pi / 2, turn + 3 * math.pi / 2, r
    elif isinstance(shape, Box | Polygon):
        rings = [corners(shape)]
        rings += [list(wound(hole, -1)) for hole in getattr(shape, "holes", ())]
        for ring in rings:
            for (ax, ay), (bx, by) in zip(ring, ring[1:] + ring[:1], strict=True):
                yield ax, ay, bx, by, 0.0


def below(sides: Array, x: Array, y: Array, angle: Array, level: float) -> tuple[Array, Array]:
    """Area of an outline below a level [m^2], and its moment, area times x [m^3]; each [n].

    By Green's theorem, of the part of the outline below the level alone, with d = y - level:

        A = - ∮ d dx          ∬ x dA = - ∮ x d dx

    ``sides`` [k, 5] are in the body's frame, which is at ``x``, ``y``, ``angle`` [m, rad], [n].
    """
    area, moment = np.zeros(len(x)), np.zeros(len(x))
    c, s = np.cos(angle), np.sin(angle)
    for px, py, qx, qy, radius in sides.tolist():
        cx, cd = x + c * px - s * py, y + s * px + c * py - level
        if radius:
            one, two = _arc(cx, cd, radius, qx + angle, qy + angle)
        else:
            one, two = _straight(cx, cd, x + c * qx - s * qy, y + s * qx + c * qy - level)
        area, moment = area - one, moment - two
    return area, moment


def _straight(x1: Array, d1: Array, x2: Array, d2: Array) -> tuple[Array, Array]:
    """∫ d dx and ∫ x d dx along the part of a side below d = 0."""
    with np.errstate(all="ignore"):
        cut = np.where(d1 * d2 < 0, d1 / (d1 - d2), 0.0)
    crossing = x1 + cut * (x2 - x1)
    x1, x2 = (np.where((d > 0) & (d1 * d2 < 0), crossing, x) for x, d in ((x1, d1), (x2, d2)))
    d1, d2 = np.minimum(d1, 0.0), np.minimum(d2, 0.0)
    return ((d1 + d2) / 2 * (x2 - x1),
            (x2 - x1) / 6 * (2 * x1 * d1 + x1 * d2 + x2 * d1 + 2 * x2 * d2))


def _arc(cx: Array, cd: Array, r: float, start: Array, end: Array) -> tuple[Array, Array]:
    """The same along a counter-clockwise arc."""
    half = np.arcsin(np.clip(-cd / r, -1.0, 1.0))
    begin = np.mod(start, math.tau)
    span = end - start
    one, two = np.zeros(len(cx)), np.zeros(len(cx))
    for turn in (-math.tau, 0.0, math.tau):  # below is from pi - half to 2 pi + half
        low = np.maximum(begin, math.pi - half + turn)
        high = np.maximum(np.minimum(begin + span, math.tau + half + turn), low)
        for sign, phi in ((1.0, high), (-1.0, low)):
            si, co = np.sin(phi), np.cos(phi)
            flat = -r * (r * (phi / 2 - si * co / 2) - cd * co)
            one = one + sign * flat
            two = two + sign * (cx * flat - r * r * (cd * si**2 / 2 + r * si**3 / 3))
    return one, two


def motion_of(
    model: Model, load: int, pose: Array, velocity: Array, acceleration: Array, time: Array,
) -> dict[str, Array]:
    """Inputs of the law of a load by name, [n] each, for the motion of the centre of mass [3, n].

    ``pose`` is x, y [m], angle [rad].
    """
    loads = model.loads
    body = int(loads.body[load])
    (x, y, angle), (u, v, w), (a, b, alpha) = pose, velocity, acceleration
    c, s = np.cos(angle), np.sin(angle)
    rx, ry = rotated(loads.at[load] - model.bodies.centre[body], angle).T
    vx, vy = u - w * ry, v + w * rx
    ax, ay = a - alpha * ry - w * w * rx, b + alpha * rx - w * w * ry
    if loads.turning[load]:
        vx, vy = c * vx + s * vy, c * vy - s * vx
        ax, ay = c * ax + s * ay, c * ay - s * ax
    one = np.ones_like(x)
    return {"x": x + rx, "y": y + ry, "angle": angle, "vx": vx, "vy": vy, "omega": w,
            "speed": np.hypot(vx, vy), "ax": ax, "ay": ay, "alpha": alpha, "t": time,
            "mass": model.bodies.mass[body] * one, "inertia": model.bodies.inertia[body] * one}


def load_at(
    model: Model, load: int, pose: Array, velocity: Array, acceleration: Array, time: Array,
) -> Array:
    """Force in the world [N] and torque about the centre of mass [N m] of a load, [3, n]."""
    loads, law = model.loads, model.loads.law[load]
    body = int(loads.body[load])
    if law is None:
        x, y = placed(pose.T, -model.bodies.centre[body]).T
        area, moment = below(loads.outline(load), x, y, pose[2], float(loads.level[load]))
        lift = loads.lift[load]
        return np.stack([np.zeros_like(x), lift * area, lift * (moment - pose[0] * area)])
    fx, fy, torque = law.at(motion_of(model, load, pose, velocity, acceleration, time))
    if loads.per_mass[load]:
        fx, fy = model.bodies.mass[body] * fx, model.bodies.mass[body] * fy
    if loads.turning[load]:
        fx, fy = rotated(np.stack([fx, fy], axis=-1), pose[2]).T
    rx, ry = rotated(loads.at[load] - model.bodies.centre[body], pose[2]).T
    return np.stack([fx, fy, torque + rx * fy - ry * fx])
