"""Arrows: contact forces, loads, velocities, accelerations and forces of joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.numeric import Array, Integers
from sandbox.picture.elements.notes import Place, marked
from sandbox.picture.geometry import shape_points
from sandbox.picture.run_data import RunData
from sandbox.picture.scales import (
    LONGEST,
    ForceScale,
    largest_of,
    prefixed,
    rounding,
    shared,
    typical,
)
from sandbox.picture.subject import NO_SCALE, Subject
from sandbox.samples.contacts import contacts_on, on_the_other, said_of
from sandbox.scene.bodies import Shape

FINE, SLIM = [2.4, 10], [3.4, 11]
"""Shaft's and head's width of arrows of contact forces and vectors, and of loads [points]."""
SHORTEST, SHORT = 2.5, 5.0
"""Contact arrows, and others, that are shorter are left out [points]."""
LABELLED = 0.12
"""Values of arrows and patches above this share of the reference are written."""
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


XY = tuple[float, float]
Patch = tuple[XY, XY, float, float, XY]
"""Where a patch begins and ends [m], the force per length there [N/m], and the way out of the body
that it acts on."""
LENGTH = 0.07
"""Height of a patch that is typical of the large ones, as a fraction of the picture's width."""
LEVEL = 2e-3
"""Corners of a body this near to a contact's line, in sizes of the body, lie on it."""
MOST_SAMPLES = 200
"""Samples looked at for the scale."""


def _outline(shapes: Sequence[Shape]) -> Array:
    """Corners of shapes [n, 2] m."""
    return np.concatenate([shape_points(shape) for shape in shapes])


def spread(first: float, second: float, length: float) -> tuple[float, float, float, float]:
    """Forces at the two ends of a contact as a force per length that changes evenly along it.

    It has the same sum and the same moment. With q from q0 to q1 over a length L these are
    (q0 + q1) L / 2 and, about the first end, (q0 + 2 q1) L^2 / 6; so q0 = (4 F0 - 2 F1) / L, and q1
    the same the other way round. Where one of them would pull, the contact gapes there: what is
    left is a triangle, three times as long as the resultant is away from the other end.

    Args:
        first: normal force at the first end, 0 or more [N].
        second: that at the second end.
        length: between them [m].

    Returns:
        Where the pressure begins and ends, as shares of the length, and the force per length there
        [N/m]. Nothing, from a place to the same, where all of it is in one point.
    """
    total = first + second
    share = second / total if total > 0 else 0.0
    if share in (0.0, 1.0):  # all of it in one point
        return share, share, 0.0, 0.0
    if share < 1 / 3:
        return 0.0, 3 * share, 2 * total / (3 * share * length), 0.0
    if share > 2 / 3:
        reach = 3 * (1 - share)
        return 1 - reach, 1.0, 0.0, 2 * total / (reach * length)
    return 0.0, 1.0, (4 * first - 2 * second) / length, (4 * second - 2 * first) / length


class FlatSides:
    """Where two bodies touch along a line, and how the force is spread there.

    A recording has the resultant of each pair at its centre of pressure; how far the contact goes
    to either side is what the outlines of the two have in common there.
    """

    def __init__(self, run: RunData, bodies: Sequence[int],
                 shown: tuple[Integers, Array] | None = None) -> None:
        """``bodies`` are those along whose outline it is shown.

        ``shown`` is what :func:`contacts_on` gives, where another rule says whom forces act on.
        """
        self._mechanism, self._arrays = run.mechanism, run.arrays
        on, self._force = shown or contacts_on(run.model, run.arrays)
        self._rows = np.flatnonzero(np.isin(on, bodies) & (run.arrays["contact_merged"] > 1))

    def patches(self, samples: Integers) -> tuple[list[Patch], Integers]:
        """What touches along a line in some samples, and the place in ``samples`` of each."""
        arrays = self._arrays
        of = arrays["contact_sample"][self._rows]
        first, last = (np.searchsorted(of, samples, side=side) for side in ("left", "right"))
        count = last - first
        rows = self._rows[np.arange(count.sum()) + np.repeat(last - np.cumsum(count), count)]
        normal, point = arrays["contact_normal"][rows], arrays["contact_point"][rows]
        along = np.stack((-normal[:, 1], normal[:, 0]), axis=1)
        reach = [self._edges(rows, arrays[which][rows]) for which in
                 ("contact_body", "contact_other")]
        low, high = np.maximum(*(each[:, 0] for each in reach)), np.minimum(
            *(each[:, 1] for each in reach))
        press = np.einsum("ij,ij->i", self._force[rows], normal)
        found, places = [], []
        for k, place in enumerate(np.repeat(np.arange(len(samples)), count).tolist()):
            if not low[k] < 0 < high[k]:
                continue
            length, size = float(high[k] - low[k]), abs(float(press[k]))
            share = -float(low[k]) / length
            start, end, q0, q1 = spread(size * (1 - share), size * share, length)
            a, b = (point[k] + (low[k] + at * length) * along[k] for at in (start, end))
            # the force pushes into the body that it acts on: out of it is against that
            way = -normal[k] if press[k] > 0 else normal[k]
            found.append(((float(a[0]), float(a[1])), (float(b[0]), float(b[1])), q0, q1,
                          (float(way[0]), float(way[1]))))
            places.append(place)
        return found, np.array(places, dtype=np.int64)

    def _edges(self, rows: Integers, bodies: Integers) -> Array:
        """From where to where outlines lie on contacts' lines, from their points on [k, 2] m."""
        arrays, found = self._arrays, np.zeros((len(rows), 2))
        for body in np.unique(bodies).tolist():
            some = np.flatnonzero(bodies == body)
            which = rows[some]
            corners = _outline(self._mechanism.bodies[body].shapes)
            x, y, angle = arrays["body_pose"][arrays["contact_sample"][which], body].T[..., None]
            c, s = np.cos(angle), np.sin(angle)
            point, normal = arrays["contact_point"][which], arrays["contact_normal"][which]
            dx = x + c * corners[:, 0] - s * corners[:, 1] - point[:, :1]
            dy = y + s * corners[:, 0] + c * corners[:, 1] - point[:, 1:]
            size = float(np.ptp(corners, axis=0).max())
            on_it = np.abs(dx * normal[:, :1] + dy * normal[:, 1:]) <= LEVEL * size
            along = dy * normal[:, :1] - dx * normal[:, 1:]
            any_on_it = on_it.any(axis=1)
            found[some, 0] = np.where(
                any_on_it, np.where(on_it, along, np.inf).min(axis=1, initial=np.inf), 0.0)
            found[some, 1] = np.where(
                any_on_it, np.where(on_it, along, -np.inf).max(axis=1, initial=-np.inf), 0.0)
        return found

    def scale(self, time: Array, width: float) -> ForceScale:
        """How high patches are on a picture ``width`` [m] wide; ``time`` [n] s."""
        samples = np.unique(np.linspace(0, len(time) - 1, MOST_SAMPLES).astype(np.int64))
        patches, places = self.patches(samples)
        largest = largest_of(places, np.array([max(patch[2:4]) for patch in patches]),
                             len(samples))
        reference = typical(largest, time[samples])
        return ForceScale(LENGTH * width / reference if reference > 0 else 0.0, reference)


def add_pressure(s: Subject) -> None:
    """A strip along each edge on which two bodies touch, as high as its force per length."""
    if "pressure" not in s.layers:
        return
    sides = FlatSides(s.run, s.layers.of("pressure"))
    scale = sides.scale(s.run.time, s.width)
    s.pressure = scale
    if scale.metres == 0:
        return
    patches, places = sides.patches(np.arange(len(s.run.time)))
    rows = np.zeros((len(patches), 11))
    for row, sample, (start, end, first, second, way) in zip(rows, places, patches, strict=True):
        high = np.minimum([second, first], LONGEST * scale.reference) * scale.metres
        corners = [start, end, *(np.array(at) + size * np.array(way)
                                 for at, size in zip((end, start), high, strict=True))]
        row[:] = [sample, 0, *np.ravel(corners), max(first, second)]
    for sample in np.unique(places):  # patches keep their order from sample to sample
        there = places == sample
        rows[there, 1] = np.arange(there.sum())
    s.out.tables["pressure"] = rows
    factor, unit, decimals = prefixed(scale.reference, "N/m")
    s.add("pressure", "strips", "pressure", t="pressure", s=s.style("patch", "force", 1.2),
          factor=factor, unit=unit, decimals=decimals, least=LABELLED * scale.reference)
    s.signs.add("patch")
