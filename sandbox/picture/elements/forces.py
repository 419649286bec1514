"""Arrows: contact forces, loads, velocities, accelerations and forces of joints; line loads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from sandbox.model.joints import placed, rotated
from sandbox.numeric import Array, Flags, Integers
from sandbox.picture import scales
from sandbox.picture.elements.notes import Place, marked
from sandbox.picture.geometry import shape_points
from sandbox.picture.listing import RunData
from sandbox.picture.scales import ForceScale
from sandbox.picture.subject import Subject
from sandbox.samples.contacts import contacts_on, on_the_other, said_of

FINE, SLIM = [2.4, 10], [3.4, 11]  # shaft and head of arrows of forces, and of loads [points]
SHORTEST, SHORT = 2.5, 5.0  # contact arrows, and others, that are shorter are left out [points]
LABELLED = 0.12  # values of arrows and patches above this share of the reference are written
APART = 4.0  # maximum ratio of loads and contact forces on one scale
LOAD_LENGTH, VECTOR_LENGTH, LENGTH = 0.11, 0.1, 0.07
"""Of loads, vectors, line loads [picture widths]."""


def _add_arrows(s: Subject, layer: str, scale: ForceScale, token: str, unit: str, words: str,
                size: Sequence[float] = FINE, **fields: Any) -> None:
    """Add an item for the table of a layer, and its row of the legend."""
    s.add(layer, "arrows", layer, **{
        "t": layer, "metres": scale.metres, "most": scale.longest, "size": size, "least": SHORT,
        "s": (token, "paper", 2.0), "written": (scale.reference, unit),
        "labelled": LABELLED * scale.reference, "rank": 2, **fields})
    s.arrows[layer] = token, unit, words, size, scale


def add_contacts(s: Subject) -> None:
    """The force of every pair that touches, on one of the two (:func:`contacts_on`)."""
    if "contacts" not in s.layers:
        return
    arrays, bodies = s.run.arrays, s.layers.get("contacts", ())
    on, force = contacts_on(s.run.model, arrays)
    one, two = arrays["contact_body"], arrays["contact_other"]
    kept, other = np.isin(one, bodies) | np.isin(two, bodies), one + two - on
    s.out.tables["contacts"] = np.column_stack([
        arrays["contact_sample"], on * len(s.run.mechanism.bodies) + other,
        arrays["contact_point"], force])[kept]
    if s.force.metres:
        words = said_of(s.run.model, on[kept], other[kept])
        plain = "else" in words or not words.startswith("on the object")
        _add_arrows(s, "contacts", s.force, "force", "N",
                    "contact force" if plain else f"contact force {words}", least=SHORTEST, rank=1)
        # of a live run the largest force is not known
        if not s.out.fixed_columns and (
                s.largest_arrow("contacts") * s.force.metres < SHORTEST * s.point):
            del s.arrows["contacts"]


def add_loads(s: Subject) -> None:
    """The force of each load on each body, from where it acts; of a few with names and values."""
    loads, arrays = s.run.model.loads, s.run.arrays
    some = np.isin(loads.body, s.layers.get("loads", ()))
    found, length = [], LOAD_LENGTH * s.width
    for run in (*s.beside, s.run):  # ``size`` is that of ``s.run`` from here on
        size = np.nan_to_num(np.hypot(*np.moveaxis(run.arrays["load_force"], -1, 0)))
        usual = scales.typical(size.max(axis=1, initial=0.0), run.time)
        alike = s.force.metres > 0 and usual / APART <= s.force.reference <= usual * APART
        found.append(ForceScale() if usual <= scales.rounding(run) else s.force if alike
                      else scales.scale_of(usual, length))
    scale = scales.shared(found)
    if scale.metres == 0 or not size[:, some].max(initial=0.0) > 0:
        return
    at, force = placed(arrays["body_pose"][:, loads.body], loads.at), arrays["load_force"]
    floats = np.array([law is None for law in loads.law])
    # buoyancy acts at the middle of the submerged part
    lift = np.where(floats & (force[..., 1] != 0), force[..., 1], np.inf)
    at[..., 0] += arrays["load_torque"] / lift
    s.out.tables["loads"] = table(at, force, some & (size > 0.02 * scale.reference))
    few = some.sum() <= 6  # numbers of loads are written of at most so many
    _add_arrows(s, "loads", scale, "drive", "N", "load", SLIM, labelled=0.0 if few else np.inf,
                names={i: s.run.mechanism.loads[loads.load[i]].name
                       for i in np.flatnonzero(some).tolist()} if few else None)


def table(at: Array, vectors: Array, some: Flags) -> Array:
    """The rows of ``some`` [n, k] of the vectors at places [n, k, 2], by sample."""
    return np.column_stack([*np.nonzero(some), at[some], vectors[some]])


def point_motion(run: RunData, places: Sequence[Place]) -> tuple[Array, Array]:
    """Velocity v + omega x r, acceleration a + alpha x r - omega^2 r of points, [n, k, 2]."""
    bodies = np.array([body for body, _ in places], dtype=np.intp)
    local = np.array([at for _, at in places]).reshape(-1, 2) - run.arrays["body_centre"][bodies]
    r = rotated(local, run.arrays["body_pose"][:, bodies, 2])
    across = np.stack((-r[..., 1], r[..., 0]), axis=-1)
    v, a = run.arrays["body_velocity"][:, bodies], run.arrays["body_acceleration"][:, bodies]
    omega, alpha = v[..., 2:], a[..., 2:]
    return v[..., :2] + omega * across, a[..., :2] + alpha * across - omega**2 * r


def reactions(run: RunData, bodies: Sequence[int]) -> tuple[list[Place], Array, str]:
    """Forces of the pins, slots and welds of ``bodies``: places, forces [n, k, 2] N, and words."""
    joints = run.model.joints
    found = joints.keeping("point", "groove")
    found = found[np.isin(joints.bodies[found], bodies).any(axis=1)]
    a, b = joints.bodies[found].T
    swapped = on_the_other(run.model, run.arrays, b, a)
    places = [(body, (x, y)) for body, (x, y) in zip(
        b.tolist(), joints.anchor[found, 1].tolist(), strict=True)]
    values = run.arrays["joint_force"][:, found] * np.where(swapped, -1.0, 1.0)[:, None]
    if np.abs(np.nan_to_num(values)).max(initial=0.0) <= scales.rounding(run):
        values = np.zeros_like(values)
    words = said_of(run.model, np.where(swapped, a, b), np.where(swapped, b, a))
    return places, values, f"joint force {words}"


def add_vectors(s: Subject) -> None:
    """Velocities, accelerations and forces of joints."""
    duration = max(float(s.run.time[-1] - s.run.time[0]), 1e-9)
    for order, (layer, unit) in enumerate((
            ("velocity", "m/s"), ("acceleration", "m/s²"), ("reactions", "N"))):
        if layer not in s.layers:
            continue
        if layer == "reactions":
            places, values, words = reactions(s.run, s.layers.get(layer, ()))
            least, token = 0.0, "reaction"
        else:
            places = marked(s.run, s.view, s.patterns(layer))
            values, words = point_motion(s.run, places)[order], layer
            least, token = 1e-6 * s.width / duration**(order + 1), layer
        values = np.nan_to_num(values)
        size = np.hypot(values[..., 0], values[..., 1]).max(axis=1, initial=0.0)
        if (reference := scales.typical(size, s.run.time)) <= least:
            continue
        pose = s.run.arrays["body_pose"][:, [body for body, _ in places]]
        s.out.tables[layer] = table(placed(pose, np.array([at for _, at in places])), values,
                                    np.ones(values.shape[:2], dtype=bool))
        scale = scales.scale_of(reference, VECTOR_LENGTH * s.width)
        _add_arrows(s, layer, scale, token, unit, words)


def spread(total: Array, share: Array, length: Array) -> tuple[Array, Array, Array]:
    """A force at a share (0 to 1) of a length as a linear force per length of equal moment.

    With q from q0 to q1 over a length L, the sum is F = (q0 + q1) L / 2 and the moment about the
    first end is (q0 + 2 q1) L^2 / 6 = F s L; so q0 = (4 - 6 s) F / L, and q1 = (6 s - 2) F / L.
    Where one of them would pull, a triangle is left, three times as long as the resultant is away
    from the other end. Returns begin and end as shares of the length, equal where all of it is in
    one point, and the forces per length there [2, n].
    """
    begin, end = np.clip(3 * share - 2, 0.0, 1.0), np.clip(3 * share, 0.0, 1.0)
    wide = np.where(begin < end, end - begin, np.inf)
    place = (share - begin) / wide  # of the resultant
    return begin, end, total / (wide * length) * np.clip([4 - 6 * place, 6 * place - 2], 0.0, None)


class LineLoads(NamedTuple):
    """Where two bodies touch along a line: k of them, by sample."""

    sample: Integers
    ends: Array  # [k, 2, 2] m
    load: Array  # force per length at either end [k, 2] N/m
    way: Array  # out of the body that it acts on, [k, 2]


def line_loads(run: RunData, bodies: Sequence[int]) -> LineLoads:
    """Line contacts of ``bodies``, and how the force is distributed along them."""
    arrays = run.arrays
    on, force = contacts_on(run.model, arrays)
    rows = np.flatnonzero(np.isin(on, bodies) & (arrays["contact_merged"] > 1))
    low, high = np.repeat([[-np.inf], [np.inf]], len(rows), axis=1)  # of both outlines [m]
    for side in (arrays["contact_body"][rows], arrays["contact_other"][rows]):
        for body in np.unique(side).tolist():
            some = side == body
            which = rows[some]
            corners = shape_points(*run.mechanism.bodies[body].shapes)
            pose = arrays["body_pose"][arrays["contact_sample"][which], body]
            way = placed(pose[:, None], corners) - arrays["contact_point"][which][:, None]
            nx, ny = arrays["contact_normal"][which].T[..., None]
            on_it = np.abs(way[..., 0] * nx + way[..., 1] * ny) <= 2e-3 * float(
                np.ptp(corners, axis=0).max())
            along = way[..., 1] * nx - way[..., 0] * ny
            low[some] = np.maximum(low[some], np.where(on_it, along, np.inf).min(axis=1))
            high[some] = np.minimum(high[some], np.where(on_it, along, -np.inf).max(axis=1))
    flat = (low < 0) & (high > 0)
    rows, low, high = rows[flat], low[flat], high[flat]
    normal, point = arrays["contact_normal"][rows], arrays["contact_point"][rows]
    along = np.stack((-normal[:, 1], normal[:, 0]), axis=1)
    press, length = np.einsum("ij,ij->i", force[rows], normal), high - low
    begin, end, load = spread(np.abs(press), -low / length, length)
    ends = np.stack([point + (low + at * length)[:, None] * along for at in (begin, end)], axis=1)
    # the force pushes into the body that it acts on: out of it is against that
    way = np.where(press > 0, -1.0, 1.0)[:, None] * normal
    return LineLoads(arrays["contact_sample"][rows], ends, load.T, way)


def add_pressure(s: Subject) -> None:
    """A strip along each edge on which two bodies touch, as high as its force per length."""
    if "pressure" not in s.layers:
        return
    found, time = line_loads(s.run, s.layers.get("pressure", ())), s.run.time
    some = np.unique(np.linspace(0, len(time) - 1, 200).astype(np.int64))
    seen, most = np.isin(found.sample, some), found.load.max(axis=1, initial=0.0)
    largest = scales.largest_of(np.searchsorted(some, found.sample[seen]), most[seen], len(some))
    scale = scales.scale_of(scales.typical(largest, time[some]), LENGTH * s.width)
    if scale.metres == 0:
        return
    high = np.minimum(found.load, scale.longest) * scale.metres
    tops = found.ends + high[..., None] * found.way[:, None]
    first = np.searchsorted(found.sample, found.sample)  # they keep their order in each sample
    s.out.tables["pressure"] = np.column_stack([
        found.sample, np.arange(len(first)) - first, found.ends.reshape(-1, 4),
        tops[:, ::-1].reshape(-1, 4), most])
    s.add("pressure", "strips", "pressure", t="pressure", s=("patch", "force", 1.2),
          written=(scale.reference, "N/m"), least=LABELLED * scale.reference)
    s.signs.add("patch")
