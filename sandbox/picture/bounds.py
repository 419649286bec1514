"""What part of the world a run needs over all of its time, and the camera that shows it.

The camera maps world [m], y up, to picture [pixels], y down. Equal aspect, nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sandbox.model.joints import placed
from sandbox.model.model import NONE
from sandbox.model.supports import components
from sandbox.numeric import Array, Flags, Integers
from sandbox.picture.elements.bodies import joined_points
from sandbox.picture.geometry import shape_points
from sandbox.picture.listing import Listing, RunData, nearest
from sandbox.picture.wheels import wheel_pictures
from sandbox.scene.bodies import Circle
from sandbox.scene.layers import meant
from sandbox.scene.settings import View

MARGIN = 0.04  # fraction of the stage left free on every side of a fitted picture
BESIDE = 0.5  # visible part of larger fixed bodies beside the rest [sizes of the rest]
ROOM = 0.25  # distance from anchored bodies at which a body has left [their size]
FLIGHT = 12.0  # the same if nothing is anchored, in sizes of all at the start


class Rectangle(NamedTuple):
    """A rectangle of the world [m], or of a picture [pixels] with y down from the top."""

    x0: float
    y0: float
    x1: float
    y1: float

    @classmethod
    def around(cls, *sets: Array) -> Rectangle:
        """The smallest box that holds points [..., 2]; non-finite ones are left out."""
        points = np.concatenate([each.reshape(-1, 2) for each in sets])
        points = points[np.isfinite(points).all(axis=1)]
        if not len(points):
            return cls(0.0, 0.0, 0.0, 0.0)
        return cls(*points.min(axis=0).tolist(), *points.max(axis=0).tolist())

    @property
    def corners(self) -> Array:
        """The corners of least and greatest x and y [2, 2]."""
        return np.array(self).reshape(2, 2)

    @property
    def size(self) -> tuple[float, float]:
        """Width and height."""
        return self.x1 - self.x0, self.y1 - self.y0

    @property
    def centre(self) -> tuple[float, float]:
        """Its middle."""
        return (self.x0 + self.x1) / 2, (self.y0 + self.y1) / 2


class Camera(NamedTuple):
    """``pixel = (px, py) + scale * (x - cx, -(y - cy))``."""

    scale: float  # pixels per metre
    centre: tuple[float, float]  # world point [m] that is shown at ``pixel``
    pixel: tuple[float, float]

    def enlarged(self, factor: float) -> Camera:
        """The camera of a picture so many times larger."""
        x, y = self.pixel
        return Camera(self.scale * factor, self.centre, (x * factor, y * factor))

    def to_pixels(self, points: Array) -> Array:
        """Pixels of world points; ``points`` [..., 2] in m."""
        return np.asarray(self.pixel + self.scale * (points - self.centre) * (1.0, -1.0))

    def to_world(self, pixels: Array) -> Array:
        """World points [m] of ``pixels`` [..., 2]; undoes :meth:`to_pixels`."""
        return np.asarray(self.centre + (pixels - self.pixel) / self.scale * (1.0, -1.0))


def width_shown(box: Rectangle, aspect: float, width: float | None = None) -> float:
    """Width of ``box`` in a picture of an ``aspect`` [m], at most the view's ``width``."""
    wide, high = box.size
    return min(max(wide, high * aspect, 1e-3), width or np.inf)


def place_camera(
    box: Rectangle, stage: Rectangle, *, centre: tuple[float, float] | None = None,
    width: float | None = None,
) -> Camera:
    """The camera that shows ``box`` on ``stage``, or the view's ``centre`` and ``width`` [m]."""
    (x, y), (wide, high), pixel = centre or box.centre, stage.size, stage.centre
    if width is not None:
        return Camera(wide / width, (x, y), pixel)
    half_x, half_y = max(box.x1 - x, x - box.x0), max(box.y1 - y, y - box.y0)
    if max(half_x, half_y) < 1e-9:  # a point
        half_x = half_y = 0.05
    return Camera((1 - 2 * MARGIN) * min(
        wide / (2 * max(half_x, 1e-9)), high / (2 * max(half_y, 1e-9))), (x, y), pixel)


class _Motion:
    """Positions of bodies and traced points in some samples, relative to a followed body."""

    def __init__(self, run: RunData, view: View, samples: Integers | slice) -> None:
        self.run, self.samples = run, samples
        self.pose, self.shift = run.arrays["body_pose"][samples], drift(run, view)[samples]
        self.traced = [(run.model.names.body[trace.body], trace.at) for trace in view.traces]

    def ways(self, few: Sequence[int] | None = None) -> Array:
        """Traced points of the view, of all bodies or of a few, [n, k, 2] m."""
        return np.array([placed(self.pose[:, body], np.array(at)) - self.shift
                         for body, at in self.traced if few is None or body in few]).reshape(
                             -1, len(self.pose), 2).swapaxes(0, 1)

    def boxes(self, *, scenery: bool = True, outlines: bool = False) -> Array:
        """Left, bottom, right and top of every body with its anchors and guides, [n, nb, 4] m."""
        run, drives, tendons = self.run, self.run.model.drives, self.run.model.tendons
        largest = {(int(drives.target[k]), int(drives.shape[k])):
                   float(run.arrays["drive_value"][:, k].max())
                   for k in drives.giving("radius").tolist()}
        shapes: list[list[Array]] = [[
            shape_points(shape, grow=max(0.0, largest[i, k] - shape.radius) if (
                i, k) in largest and isinstance(shape, Circle) else 0.0)
            for k, shape in enumerate(body.shapes)
            if scenery or body.motion != "fixed" or body.role not in ("link", "ground")]
            for i, body in enumerate(run.mechanism.bodies)]
        for i, wheels in wheel_pictures(run.model).items():
            shapes[i] += [wheel.rings[0] for wheel in wheels]
        points: list[list[Array]] = [[] for _ in shapes]
        for i, each in joined_points(run.model).items():
            points[i].append(np.array(each))
        for i, at, r in zip(tendons.guide_body.tolist(), tendons.guide_at, tendons.guide_radius,
                            strict=True):
            points[i].append(at + r * np.array([(-1, 0), (1, 0), (0, -1), (0, 1)]))
        boxes = np.full((len(self.pose), len(shapes), 4), np.nan)
        for i, own in enumerate(shapes):
            if sets := own if own and outlines else own + points[i]:
                world = placed(self.pose[:, i, None], np.concatenate(sets)) - self.shift[:, None]
                boxes[:, i, :2], boxes[:, i, 2:] = world.min(axis=1), world.max(axis=1)
        return boxes

    def machine(self) -> Rectangle:
        """The box [m] of bodies that stay with the mechanism, and of large scenery near them."""
        whole, own, stays = self.boxes(), self.boxes(scenery=False), groups_of(self.run)[1]
        home = own if np.isfinite(own[:, stays]).any() else whole
        near = with_it(home + np.tile(self.shift[:, None], 2), stays)
        ways = self.ways()[near[:, [body for body, _ in self.traced]]]
        core = Rectangle.around(own[near], ways)
        size = max(core.size)
        if not size > 0:
            return Rectangle.around(whole[near], ways)
        low, high = core.corners
        fixed = whole[:, self.run.model.bodies.fixed].reshape(-1, 2, 2)
        wide = np.ptp(fixed, axis=1) > (1 + 2 * BESIDE) * size
        cut = np.clip(fixed, low - BESIDE * size, high + BESIDE * size)
        return Rectangle.around(core.corners, np.where(wide[:, None], cut, fixed))


def _samples(run: RunData, moments: Sequence[float] | None) -> Integers:
    """Samples of all of the run, or the nearest to a few moments [s]."""
    if moments is not None:
        return nearest(run.time, moments)
    n = len(run.time)  # a motion is smooth enough between 200 samples for the margin
    return np.unique(np.linspace(0, n - 1, min(n, 200)).astype(np.int64))


def body_box(run: RunData, view: View | None = None,
             moments: Sequence[float] | None = None) -> Rectangle:
    """The box [m] that a picture has to show: bodies with anchors and guides, traced points."""
    view = view or run.mechanism.view
    if (few := chosen(run, view)) is not None:
        motion = _Motion(run, view, _samples(run, moments))
        return Rectangle.around(motion.boxes(outlines=True)[:, few], motion.ways(few))
    motion = _Motion(run, view, _samples(run, None))
    if view.follow:
        still = _Motion(run, view.model_copy(update={"follow": None}), motion.samples)
        if np.ptp(motion.shift, axis=0).max() > BESIDE * max(still.machine().size):
            groups = np.array(groups_of(run)[0])
            own = groups == groups[run.model.names.body[view.follow]]
            return Rectangle.around(motion.boxes()[:, own], motion.ways())
    return motion.machine()


def chosen(run: RunData, view: View) -> list[int] | None:
    """The bodies that the view names; None for all."""
    return meant(view.bodies, run.mechanism.bodies, run.mechanism.groups) if view.bodies else None


def drift(run: RunData, view: View) -> Array:
    """Displacement of the camera with the body that it follows, [n, 2] m."""
    body = run.model.names.body.get(view.follow or "")
    if body is None:
        return np.zeros((len(run.time), 2))
    way = placed(run.arrays["body_pose"][:, body], run.arrays["body_centre"][body])
    return np.asarray(way - way[0])


def whole_box(out: Listing, run: RunData, bodies: Rectangle, view: View,
              moments: Sequence[float] | None = None) -> Rectangle:
    """``bodies`` with arrows that begin there, and paths of traced points unless very large [m]."""
    points, few = [bodies.corners], chosen(run, view)
    samples = _samples(run, None if few is None else moments)
    shift = drift(run, view)
    low, high = bodies.corners + 1e-6 * max(bodies.size) * np.array([[-1], [1]])
    for item in out.items:
        if item["k"] == "arrows" and item["l"] in (
                ("contacts", "drives", "loads") if few is None else ("contacts",)):
            rows = out.tables[item["t"]]
            rows = rows[np.isin(rows[:, 0], samples)]
            if few is not None:
                pairs = divmod(rows[:, 1], len(run.mechanism.bodies))
                rows = rows[np.isin(pairs[0], few) | np.isin(pairs[1], few)]
            tails = rows[:, 2:4] - shift[rows[:, 0].astype(int)]
            size = np.hypot(rows[:, 4], rows[:, 5])
            cut = np.minimum(1.0, item["most"] / np.maximum(size, 1e-30)) * item["metres"]
            inside = ((tails >= low) & (tails <= high)).all(axis=1)
            points.append((tails + rows[:, 4:6] * cut[:, None])[inside])
    box = Rectangle.around(*points)
    if few is None and not view.follow:
        more = Rectangle.around(*points, _Motion(run, view, slice(None)).ways())
        if max(more.size) <= 2.5 * max(box.size):
            return more
    return box


def groups_of(run: RunData) -> tuple[list[int], Flags]:
    """Each body's group (dynamic bodies connected at the end) and whether it is anchored, [nb]."""
    model, held = run.model, run.arrays["held"]
    bonds, tendons, lines = model.bonds, model.tendons, model.lines
    still = np.array([body.motion != "dynamic" for body in run.mechanism.bodies], dtype=bool)
    connected = [*model.joints.bodies.tolist(), *model.springs.bodies.tolist(), *(
        tendons.guide_body[tendons.guides(k)].tolist() for k in range(len(tendons.name)))]
    found = [set(bodies) for bond, bodies in zip(
        np.concatenate([bonds.joint, bonds.spring, bonds.tendon]).tolist(), connected, strict=True)
        if bond == NONE or not len(held) or held[-1, bond]]
    found += map(set, lines.bodies[lines.joint == NONE].tolist())
    groups = components(len(still), [pair for bodies in found for pair in pairwise(
        body for body in bodies if not still[body])])
    fast = {groups[b] for bodies in found if still[list(bodies)].any() for b in bodies}
    return groups, np.asarray(model.bodies.fixed | np.isin(groups, list(fast)), dtype=bool)


def with_it(boxes: Array, stays: Flags) -> Flags:
    """The samples in which each body is with the mechanism [n, nb]; ``boxes`` [n, nb, 4] m."""
    home = Rectangle.around(boxes[:, stays], boxes[0])
    room = (ROOM if np.isfinite(boxes[:, stays]).any() else FLIGHT) * max(home.size)
    low, high = home.corners + np.array([[-room], [room]])
    near = ((boxes[..., :2] <= high) & (boxes[..., 2:] >= low)).all(axis=-1)
    later = np.flip(np.logical_or.accumulate(np.flip(near, axis=0), axis=0), axis=0)
    return np.asarray(later | stays | ~near.any(axis=0) | (room == 0))
