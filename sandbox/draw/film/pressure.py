"""Contact forces spread along the outline that they act on, as the pressure there."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import Canvas, Label, Moment
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.forces import label_spots
from sandbox.draw.film.geometry import shape_points
from sandbox.draw.film.palette import FORCE, lighter
from sandbox.draw.film.scales import LONGEST, ForceScale, number, typical
from sandbox.numeric import Array
from sandbox.samples.acted import contacts_on
from sandbox.scene.elements.bodies import Shape

XY = tuple[float, float]
Patch = tuple[XY, XY, float, float, XY]
"""Where a patch begins and ends [m], the force per length there [N/m], and the way out of the body
that it acts on."""
LENGTH = 0.07
"""Height of a patch that is typical of the large ones, as a fraction of the picture's width."""
LABELLED, MOST_LABELS = 0.12, 12
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


class PressureDrawer:
    """Draws a strip along every edge on which two bodies touch, as high as its pressure.

    A recording has the resultant of each pair at its centre of pressure; how far the contact goes
    to either side is what the outlines of the two have in common there.
    """

    def __init__(self, run: Filmed, bodies: Sequence[int], width: float) -> None:
        """``bodies`` are those along whose outline it is shown; ``width`` of the picture [m]."""
        self._arrays = arrays = run.arrays
        on, self._force = contacts_on(run.model, arrays)
        flat = np.isin(on, bodies) & (arrays["contact_merged"] > 1)
        self._rows = np.flatnonzero(flat)
        self._first = np.searchsorted(arrays["contact_sample"][flat], np.arange(len(run.time) + 1))
        near = set(arrays["contact_body"][flat].tolist())
        near |= set(arrays["contact_other"][flat].tolist())
        self._outlines = {body: _outline(run.mechanism.bodies[body].shapes) for body in near}
        samples = np.unique(np.linspace(0, len(run.time) - 1, MOST_SAMPLES).astype(np.intp))
        largest = np.array([max((max(patch[2:4]) for patch in self.patches(int(k))), default=0.0)
                            for k in samples])
        reference = typical(largest, run.time[samples])
        self.scale = ForceScale(LENGTH * width / reference if reference > 0 else 0.0, reference)

    def patches(self, sample: int) -> list[Patch]:
        """What touches along a line in a sample."""
        arrays, found = self._arrays, []
        for row in self._rows[self._first[sample]:self._first[sample + 1]].tolist():
            point, normal = arrays["contact_point"][row], arrays["contact_normal"][row]
            pair = (int(arrays["contact_body"][row]), int(arrays["contact_other"][row]))
            press = float(self._force[row] @ normal)
            edges = [self._edge(body, arrays["body_pose"][sample, body], point, normal)
                     for body in pair]
            low, high = max(edge[0] for edge in edges), min(edge[1] for edge in edges)
            if not low < 0 < high:
                continue
            along = np.array([-normal[1], normal[0]])
            share = -low / (high - low)
            start, end, q0, q1 = spread(
                abs(press) * (1 - share), abs(press) * share, high - low)
            a, b = (point + (low + at * (high - low)) * along for at in (start, end))
            # the force pushes into the body that it acts on: out of it is against that
            way = -normal if press > 0 else normal
            found.append(((float(a[0]), float(a[1])), (float(b[0]), float(b[1])), q0, q1,
                          (float(way[0]), float(way[1]))))
        return found

    def _edge(self, body: int, pose: Array, point: Array, normal: Array) -> XY:
        """From where to where a body's outline lies on a contact's line, from its point on [m]."""
        c, s = math.cos(pose[2]), math.sin(pose[2])
        corners = self._outlines[body]
        away = np.stack((pose[0] + c * corners[:, 0] - s * corners[:, 1] - point[0],
                         pose[1] + s * corners[:, 0] + c * corners[:, 1] - point[1]), axis=1)
        size = float(np.ptp(corners, axis=0).max())
        on_it = np.abs(away @ normal) <= LEVEL * size
        along = away[on_it] @ np.array([-normal[1], normal[0]])
        return (float(along.min()), float(along.max())) if on_it.any() else (0.0, 0.0)

    def _corners(self, patch: Patch) -> Array:
        """The strip [4, 2] m: along the outline, and back at its height."""
        start, end, q0, q1, way = patch
        high = [min(q, LONGEST * self.scale.reference) * self.scale.metres for q in (q0, q1)]
        return np.array([start, end, (end[0] + high[1] * way[0], end[1] + high[1] * way[1]),
                         (start[0] + high[0] * way[0], start[1] + high[0] * way[1])])

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """The strips with the largest force per length of each."""
        if self.scale.metres == 0:
            return
        patches = sorted(self.patches(moment.sample), key=lambda patch: -max(patch[2:4]))
        for k, patch in enumerate(patches):
            corners = [tuple(at) for at in canvas.camera.to_pixels(self._corners(patch)).tolist()]
            canvas.touch_path([*corners, corners[0]], 2)
            clip.polygon(canvas.surface, lighter(FORCE, 0.6), corners)
            clip.lines(canvas.surface, FORCE, corners, canvas.width(1.2), closed=True)
            largest = max(patch[2:4])
            if k < MOST_LABELS and largest >= LABELLED * self.scale.reference:
                text = f"{number(largest, self.scale.reference)} N/m"
                foot, top = (corners[0], corners[3]) if patch[2] >= patch[3] else (
                    corners[1], corners[2])
                canvas.labels.append(Label(text, label_spots(canvas, foot, top, text), FORCE))


def strip(canvas: Canvas, x: float, y: float, width: float) -> None:
    """For the legend: half a trapezium as high as a line."""
    half = 6 * canvas.unit
    corners = [(x, y + half), (x + width, y + half), (x + width, y), (x, y - half)]
    clip.polygon(canvas.surface, lighter(FORCE, 0.6), corners)
    clip.lines(canvas.surface, FORCE, corners, canvas.width(1.2), closed=True)
