"""Coordinates of elements between two bodies: distance, angle, teeth, rolling, paths of slots.

A coordinate q has the rate

    q' = d . (v_b - v_a) + t_a omega_a + t_b omega_b

An effort along it (a force or a torque that is positive where q grows) is the force d on ``b``, the
opposite force on ``a``, and the moments t_a and t_b.

Teeth of gears and racks: an involute flank is met along the common tangent of the base circles, of
radius r cos(pressure angle), as a cable would run that is unwound from one circle and wound on the
other: crossed where the wheels lie side by side, open where one is inside the other. The gap is the
length of such a cable, and teeth push where it would pull. Each of the two tangents is the line of
action of one flank. The line of action of a rack turns with the rack.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.curves import descend, on_span
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.plan import add_to
from sandbox.engine.records import GEAR, GROOVE, POINT, RACK
from sandbox.numeric import Array, Records
from sandbox.scene.outlines import curves

ABSCISSAE, WEIGHTS = tuple(curves.ABSCISSAE.tolist()), tuple(curves.WEIGHTS.tolist())  # arc length


@kernel
def ends(element: Any, body: Array, turn: Array) -> tuple[float, float, float, float, float, float]:
    """Arms of the two points of an element, x and y [m], and the vector from a to b."""
    a, b = element["a"], element["b"]
    ca, sa, cb, sb = turn[a, 0], turn[a, 1], turn[b, 0], turn[b, 1]
    ax, ay = ca * element["ax"] - sa * element["ay"], sa * element["ax"] + ca * element["ay"]
    bx, by = cb * element["bx"] - sb * element["by"], sb * element["bx"] + cb * element["by"]
    return ax, ay, bx, by, body[b, 0] + bx - body[a, 0] - ax, body[b, 1] + by - body[a, 1] - ay


@kernel
def vector_ahead(
    element: Any, h: float, body: Array, velocity: Array, ca: float, sa: float, cb: float,
    sb: float,
) -> tuple[float, float]:
    """The vector between the points where ``velocity`` leads in ``h``, for cosines, sines there."""
    a, b = element["a"], element["b"]
    return (body[b, 0] + h * velocity[b, 0] + cb * element["bx"] - sb * element["by"]
            - body[a, 0] - h * velocity[a, 0] - ca * element["ax"] + sa * element["ay"],
            body[b, 1] + h * velocity[b, 1] + sb * element["bx"] + cb * element["by"]
            - body[a, 1] - h * velocity[a, 1] - sa * element["ax"] - ca * element["ay"])


@kernel
def gaps(joint: Any, x: float, y: float, ca: float, sa: float) -> tuple[float, float]:
    """Gaps [m] of a joint with the vector (x, y) between its points; ca, sa are of ``a``."""
    if joint["keeps"] == POINT:
        return x, y
    if joint["keeps"] == GROOVE:
        return ((ca * joint["gx"] - sa * joint["gy"]) * y
                - (sa * joint["gx"] + ca * joint["gy"]) * x), 0.0
    return math.hypot(x, y) - joint["reach"], 0.0


@kernel
def measure_distance(element: Any, body: Array, turn: Array) -> None:
    """Measure the distance of two points; points that coincide have no direction."""
    ax, ay, bx, by, x, y = ends(element, body, turn)
    length = math.hypot(x, y)
    dx, dy = (x / length, y / length) if length > 0.0 else (0.0, 0.0)
    element["way"], element["dx"], element["dy"] = length, dx, dy
    element["ta"], element["tb"] = ay * dx - ax * dy, bx * dy - by * dx


@kernel
def measure_angle(element: Any, body: Array) -> None:
    """The same of the angle of ``b`` against ``a``."""
    element["way"] = body[element["b"], 2] - body[element["a"], 2]
    element["dx"] = element["dy"] = 0.0
    element["ta"], element["tb"] = -1.0, 1.0


@kernel
def rate(element: Any, velocity: Array) -> float:
    """Rate of a coordinate as its bodies move with ``velocity`` [nb, 3]."""
    a, b = element["a"], element["b"]
    return float(element["dx"] * (velocity[b, 0] - velocity[a, 0])
                 + element["dy"] * (velocity[b, 1] - velocity[a, 1])
                 + element["ta"] * velocity[a, 2] + element["tb"] * velocity[b, 2])


@kernel
def note_rate(joint: Any, body: Array, before: Array) -> None:
    """Note the rate of a hinge or actuator, the mean of those before the step and after it."""
    a, b = joint["a"], joint["b"]
    if joint["hinge"]:
        joint["rate"] = joint["sense"] * (
            body[b, 5] + before[b, 2] - body[a, 5] - before[a, 2]) / 2
    elif joint["line"]:
        joint["rate"] = (
            joint["dx"] * (body[b, 3] + before[b, 0] - body[a, 3] - before[a, 0])
            + joint["dy"] * (body[b, 4] + before[b, 1] - body[a, 4] - before[a, 1])
            + joint["ta"] * (body[a, 5] + before[a, 2])
            + joint["tb"] * (body[b, 5] + before[b, 2])) / 2


@kernel
def set_row(J: Array, entry: int, dx: float, dy: float, ta: float, tb: float) -> None:
    """Set the two entries of a bilateral row on the coordinate with these coefficients."""
    J[entry, 0], J[entry, 1], J[entry, 2] = 0.0 - dx, 0.0 - dy, ta
    J[entry + 1, 0], J[entry + 1, 1], J[entry + 1, 2] = dx, dy, tb


@kernel
def put_row(J: Array, entry: int, element: Any) -> None:
    """The same of a measured coordinate."""
    set_row(J, entry, element["dx"], element["dy"], element["ta"], element["tb"])


@kernel
def add_effort(element: Any, effort: float, force: Array) -> None:
    """Add an effort along a coordinate to forces and torques on the bodies, [nb, 3]."""
    dx, dy = element["dx"] * effort, element["dy"] * effort
    add_to(force, element["a"], -dx, -dy, element["ta"] * effort)
    add_to(force, element["b"], dx, dy, element["tb"] * effort)


@kernel
def ahead(h: float, body: Array, velocity: Array, b: int) -> Any:
    """Pose x, y, angle of a body where ``velocity`` leads in ``h``; cosine, sine of the angle."""
    angle = body[b, 2] + h * velocity[b, 2]
    return (body[b, 0] + h * velocity[b, 0], body[b, 1] + h * velocity[b, 1], angle,
            math.cos(angle), math.sin(angle))


@kernel
def toothed(joint: Any) -> bool:
    """Whether a JOINT keeps teeth together."""
    return bool(joint["keeps"] == GEAR or joint["keeps"] == RACK)


@kernel
def flank(joint: Any, side: float, h: float, body: Array, velocity: Array) -> Any:
    """A flank of teeth after ``h``: gap, direction of the push on b, moments on a and b for 1 N."""
    xa, ya, angle_a, ca, sa = ahead(h, body, velocity, joint["a"])
    xb, yb, angle_b, cb, sb = ahead(h, body, velocity, joint["b"])
    ax, ay = ca * joint["ax"] - sa * joint["ay"], sa * joint["ax"] + ca * joint["ay"]
    bx, by = cb * joint["bx"] - sb * joint["by"], sb * joint["bx"] + cb * joint["by"]
    dx, dy = xb + bx - xa - ax, yb + by - ya - ay
    start = joint["start"] if side > 0.0 else joint["start_back"]
    if joint["keeps"] == RACK:
        gx, gy = cb * joint["gx"] - sb * joint["gy"], sb * joint["gx"] + cb * joint["gy"]
        along, across = side * joint["tilt_c"], joint["tilt_s"]
        ux, uy = along * gx + across * gy, along * gy - across * gx
        r = -side * joint["ra"]
        gap = ux * dx + uy * dy + r * (angle_a - angle_b) - start
        px, py = ax - r * uy, ay + r * ux
        qx, qy = px + xa - xb, py + ya - yb
        return gap, ux, uy, py * ux - px * uy, qx * uy - qy * ux
    ra, rb, push = side * joint["ra"], side * joint["rb"], joint["push"]
    offset = ra - rb
    straight = math.sqrt(max(dx * dx + dy * dy - offset * offset, 1e-24))
    square = straight * straight + offset * offset
    ux, uy = (straight * dx + offset * dy) / square, (straight * dy - offset * dx) / square
    angle = math.atan2(uy, ux)
    gap = straight - ra * (angle - angle_a) + rb * (angle - angle_b) - start
    turn = 2.0 * math.pi * offset
    gap -= turn * math.floor(gap / turn + 0.5)
    px, py, qx, qy = ax - ra * uy, ay + ra * ux, bx - rb * uy, by + rb * ux
    return (push * gap, push * ux, push * uy, push * (py * ux - px * uy),
            push * (qx * uy - qy * ux))


@kernel
def rolled(joint: Any, h: float, body: Array, velocity: Array) -> float:
    """How far two circles are from where they roll to, along them [m]; as :func:`flank`."""
    xa, ya, angle_a, ca, sa = ahead(h, body, velocity, joint["a"])
    xb, yb, angle_b, cb, sb = ahead(h, body, velocity, joint["b"])
    dx = xb + cb * joint["bx"] - sb * joint["by"] - xa - ca * joint["ax"] + sa * joint["ay"]
    dy = yb + sb * joint["bx"] + cb * joint["by"] - ya - sa * joint["ax"] - ca * joint["ay"]
    ra, rb = joint["ra"], joint["rb"]
    way = ra * angle_a + rb * angle_b - (ra + rb) * math.atan2(dy, dx) - joint["start"]
    turn = 2.0 * math.pi * (ra + rb)
    return float(way - turn * math.floor(way / turn + 0.5))


@kernel
def on_path(spans: Records, start: int, x: float, y: float) -> Any:
    """Nearest place on a path: span, arc length, unit tangent, distance to the left, curvature."""
    k, w, end = descend(spans, start, True, x, y)
    px, py, dx, dy, ddx, ddy = on_span(spans[k], w)
    speed = math.hypot(dx, dy)
    tx, ty = dx / speed, dy / speed
    place, bend = spans[k]["start"], (dx * ddy - dy * ddx) / speed ** 3
    for i in range(len(ABSCISSAE)):
        _, _, dx, dy, _, _ = on_span(spans[k], w * (ABSCISSAE[i] + 1.0) / 2.0)
        place += w / 2.0 * WEIGHTS[i] * math.hypot(dx, dy)
    if end:
        place += tx * (x - px) + ty * (y - py)
        bend = 0.0
    return k, place, tx, ty, tx * (y - py) - ty * (x - px), bend


@entry_point("paths")
def path_gap(table: int, h: float, k: int) -> float:
    """Distance [m] of the point of slot ``k`` to the left of its path one step on."""
    joint, body, velocity = at.joints(table)[k], at.body(table), at.velocity(table)
    xa, ya, _, ca, sa = ahead(h, body, velocity, joint["a"])
    xb, yb, _, cb, sb = ahead(h, body, velocity, joint["b"])
    qx = xb + cb * joint["bx"] - sb * joint["by"] - xa
    qy = yb + sb * joint["bx"] + cb * joint["by"] - ya
    return float(on_path(at.spans(table), joint["on"], ca * qx + sa * qy, ca * qy - sa * qx)[4])
