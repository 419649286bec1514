"""Contact forces spread along the outline that they act on, as the pressure there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sandbox.numeric import Array, Integers
from sandbox.picture.geometry import shape_points
from sandbox.picture.run_data import RunData
from sandbox.picture.scales import LONGEST, ForceScale, largest_of, prefixed, typical
from sandbox.picture.subject import Subject
from sandbox.samples.acted import contacts_on
from sandbox.scene.elements.bodies import Shape

XY = tuple[float, float]
Patch = tuple[XY, XY, float, float, XY]
"""Where a patch begins and ends [m], the force per length there [N/m], and the way out of the body
that it acts on."""
LENGTH = 0.07
"""Height of a patch that is typical of the large ones, as a fraction of the picture's width."""
LABELLED = 0.12
"""Patches below this share of the reference have no number."""
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
