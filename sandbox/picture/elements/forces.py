"""Arrows: contact forces, loads, velocities, accelerations and forces of joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.numeric import Array, Integers
from sandbox.picture.marked import Place, marked
from sandbox.picture.run_data import RunData
from sandbox.picture.scales import ForceScale, prefixed, rounding, shared, typical
from sandbox.picture.subject import NO_SCALE, Subject
from sandbox.samples.acted import contacts_on, on_the_other, said_of

FINE, SLIM = [2.4, 10], [3.4, 11]
"""Shaft's and head's width of arrows of contact forces and vectors, and of loads [points]."""
SHORTEST, SHORT = 2.5, 5.0
"""Contact arrows, and others, that are shorter are left out [points]."""
LABELLED = 0.12
"""Values of arrows above this share of the reference are written."""
TELLING = 6
"""Numbers of loads are written of at most so many."""
APART = 4.0
"""Loads have the scale of contact forces if one is at most so many times as large as the other."""
LOAD_LENGTH, VECTOR_LENGTH = 0.11, 0.1
"""Length of an arrow of the reference size as a fraction of the picture's width."""
FAINT = 0.02
"""Loads below this share of the reference are left out."""
STANDING = 1e-6
"""Points that go no farther than this share of the picture's width in a run stand still."""


def add_contacts(s: Subject) -> None:
    """The force of every pair that touches, on one of the two (:func:`contacts_on`)."""
    if "contacts" not in s.layers:
        return
    arrays, bodies = s.run.arrays, s.layers.of("contacts")
    on, force = contacts_on(s.run.model, arrays)
    one, two = arrays["contact_body"], arrays["contact_other"]
    kept = np.isin(one, bodies) | np.isin(two, bodies)
    other = one + two - on
    s.contacts_on = said_of(s.run.model, on[kept], other[kept])
    key = on * len(s.run.mechanism.bodies) + other
    s.out.tables["contacts"] = np.column_stack([
        arrays["contact_sample"], key, arrays["contact_point"], force])[kept]
    if s.force.metres == 0:
        return
    factor, unit, decimals = prefixed(s.force.reference, "N")
    s.add("contacts", "arrows", "contacts", t="contacts", metres=s.force.metres,
          most=s.force.longest, size=FINE, least=SHORTEST, s=s.style("force", "paper", 2.0),
          factor=factor, unit=unit, decimals=decimals, told=LABELLED * s.force.reference, rank=1)


def add_loads(s: Subject) -> None:
    """The force of each load on each body, from where it acts; of a few with names and values."""
    loads, arrays = s.run.model.loads, s.run.arrays
    some = np.flatnonzero(np.isin(loads.body, s.layers.of("loads"))).tolist()
    scale = shared(load_scale(run, LOAD_LENGTH * s.width, s.force) for run in (s.run, *s.beside))
    size = np.nan_to_num(np.hypot(*arrays["load_force"].reshape(-1, 2).T)).reshape(
        arrays["load_force"].shape[:2])
    if scale.metres == 0 or not size[:, some].max(initial=0.0) > 0:
        return
    s.loads, rows = scale, []
    for i in some:
        at, force = s.out.place([int(loads.body[i]), *loads.at[i]]), arrays["load_force"][:, i]
        if loads.law[i] is None:  # buoyancy acts at the middle of what is under the level
            lift = np.where(force[:, 1] == 0, np.inf, force[:, 1])
            at = at + np.column_stack([arrays["load_torque"][:, i] / lift, np.zeros(len(at))])
        there = np.flatnonzero(size[:, i] > FAINT * scale.reference)
        rows.append(np.column_stack([there, np.full(len(there), i), at[there], force[there]]))
    s.out.tables["loads"] = sort_rows(rows)
    factor, unit, decimals = prefixed(scale.reference, "N")
    few = len(some) <= TELLING
    s.add("loads", "arrows", "loads", t="loads", metres=scale.metres, most=scale.longest,
          size=SLIM, least=SHORT, s=s.style("drive", "paper", 2.0), factor=factor, unit=unit,
          decimals=decimals, told=0.0 if few else np.inf, rank=2,
          names={i: s.run.mechanism.loads[loads.load[i]].name for i in some} if few else None)


def load_scale(run: RunData, length: float, scale: ForceScale) -> ForceScale:
    """The scale of loads: that of contact forces where these are about as large, else their own.

    ``length`` is that of a typical arrow where loads have their own scale [m].
    """
    force = run.arrays["load_force"]
    size = np.nan_to_num(np.hypot(force[..., 0], force[..., 1]))
    usual = typical(size.max(axis=1, initial=0.0), run.time)
    if usual <= rounding(run):
        return NO_SCALE
    alike = usual / APART <= scale.reference <= usual * APART
    return scale if scale.metres > 0 and alike else ForceScale(length / usual, usual)


def sort_rows(tables: Sequence[Array]) -> Array:
    """Rows of several tables, sorted by their sample."""
    rows = np.concatenate(tables) if tables else np.zeros((0, 6))
    return np.asarray(rows[np.argsort(rows[:, 0], kind="stable")])


@dataclass(frozen=True)
class Vectors:
    """Arrows of one kind: their tails and their values in every sample."""

    places: Sequence[Place]
    values: Array
    """[n, k, 2], in the world."""
    unit: str
    words: str
    token: str
    least: float = 0.0
    """Smaller values are left by rounding, in widths of the picture [unit / m]."""


def point_motion(run: RunData, places: Sequence[Place]) -> tuple[Array, Array]:
    """Velocity [m/s] and acceleration [m/s^2] of points of bodies, [n, k, 2] each.

    Of rigid bodies: v + omega x r and a + alpha x r - omega^2 r, with r from the centre of mass.
    """
    bodies = np.array([body for body, _ in places], dtype=np.intp)
    local = np.array([at for _, at in places]).reshape(-1, 2) - run.arrays["body_centre"][bodies]
    angle = run.arrays["body_pose"][:, bodies, 2]
    c, s = np.cos(angle), np.sin(angle)
    r = np.stack((c * local[:, 0] - s * local[:, 1], s * local[:, 0] + c * local[:, 1]), axis=-1)
    across = np.stack((-r[..., 1], r[..., 0]), axis=-1)
    v, a = run.arrays["body_velocity"][:, bodies], run.arrays["body_acceleration"][:, bodies]
    omega, alpha = v[..., 2:], a[..., 2:]
    return v[..., :2] + omega * across, a[..., :2] + alpha * across - omega**2 * r


def _duration(run: RunData) -> float:
    return max(float(run.time[-1] - run.time[0]), 1e-9)


def velocities(run: RunData, places: Sequence[Place]) -> Vectors:
    """Velocities of points."""
    return Vectors(places, point_motion(run, places)[0], "m/s", "velocity", "velocity",
                   STANDING / _duration(run))


def accelerations(run: RunData, places: Sequence[Place]) -> Vectors:
    """Accelerations of points."""
    return Vectors(places, point_motion(run, places)[1], "m/s²", "acceleration", "acceleration",
                   STANDING / _duration(run) ** 2)


def hinges_of(run: RunData, bodies: Sequence[int]) -> list[int]:
    """The pins, slots and welds that join one of ``bodies`` to another."""
    joints = run.model.joints
    return [k for k, kind in enumerate(joints.kind) if kind.keeps in ("point", "groove")
            and set(joints.bodies[k].tolist()) & set(bodies)]


def reactions(run: RunData, bodies: Sequence[int]) -> Vectors:
    """Forces of :func:`hinges_of` some bodies, on the object, else on the body that moves more."""
    joints = run.model.joints
    found: Integers = np.array(hinges_of(run, bodies), dtype=np.intp)
    a, b = joints.bodies[found].T if len(found) else np.zeros((2, 0), dtype=np.intp)
    swapped = on_the_other(run.model, run.arrays, b, a)
    places = [(int(joints.bodies[k, 1]), (float(x), float(y)))
              for k, (x, y) in zip(found, joints.anchor[found, 1], strict=True)]
    values = run.arrays["joint_force"][:, found] * np.where(swapped, -1.0, 1.0)[None, :, None]
    if np.abs(np.nan_to_num(values)).max(initial=0.0) <= rounding(run):
        values = np.zeros_like(values)
    on, by = np.where(swapped, a, b), np.where(swapped, b, a)
    return Vectors(places, values, "N", f"joint force {said_of(run.model, on, by)}", "reaction")


def vector_scale(vectors: Vectors, time: Array, width: float) -> ForceScale:
    """The scale of arrows of one kind on a picture ``width`` [m] wide; ``time`` [n] s."""
    values = np.nan_to_num(vectors.values)
    size = np.hypot(values[..., 0], values[..., 1])
    reference = typical(size.max(axis=1, initial=0.0), time)
    if reference <= vectors.least * width:
        return NO_SCALE
    return ForceScale(VECTOR_LENGTH * width / reference, reference)


def add_vectors(s: Subject) -> None:
    """Velocities, accelerations and forces of joints, if the view shows them."""
    for layer, made in (("velocity", velocities), ("acceleration", accelerations)):
        if layer in s.layers:
            places = marked(s.run, s.view, s.layers.patterns(layer))
            _add_vectors(s, layer, made(s.run, places))
    if "reactions" in s.layers:
        _add_vectors(s, "reactions", reactions(s.run, s.layers.of("reactions")))


def _add_vectors(s: Subject, layer: str, vectors: Vectors) -> None:
    scale = vector_scale(vectors, s.run.time, s.width)
    if scale.metres == 0:
        return
    samples = np.arange(len(s.run.time))
    s.out.tables[layer] = sort_rows([
        np.column_stack([samples, np.full(len(samples), k), s.out.place([body, *at]),
                         np.nan_to_num(vectors.values[:, k])])
        for k, (body, at) in enumerate(vectors.places)])
    factor, unit, decimals = prefixed(scale.reference, vectors.unit)
    s.add(layer, "arrows", layer, t=layer, metres=scale.metres, most=scale.longest, size=FINE,
          least=SHORT, s=s.style(vectors.token, "paper", 2.0), factor=factor, unit=unit,
          decimals=decimals, told=LABELLED * scale.reference, rank=2)
    s.vectors.append((vectors.token, vectors.unit, vectors.words, scale))
