"""What part of the world a run needs: bodies, cords and forces, over all of its time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sandbox.model.model import NONE
from sandbox.model.supports import components
from sandbox.numeric import Array, Flags
from sandbox.picture.camera import Rectangle
from sandbox.picture.elements.bodies import joined_points
from sandbox.picture.geometry import PointPool, shape_points
from sandbox.picture.listing import Listing
from sandbox.picture.run_data import RunData
from sandbox.picture.wheels import wheel_pictures
from sandbox.scene.bodies import Circle
from sandbox.scene.layers import meant
from sandbox.scene.settings import View

MOST_SAMPLES = 200
"""Samples looked at; a motion is smooth enough between them for a margin of 4 %."""
SCENERY = ("link", "ground")
"""Roles of fixed bodies of which a picture shows what is near the rest."""
BESIDE = 0.5
"""How far beside the rest, in sizes of it, what is fixed and still larger is shown."""
GROWN = 2.5
"""How many times as large a picture may be for the ways of traced points."""


def _samples(run: RunData, moments: Sequence[float] | None) -> NDArray[np.intp]:
    """Those that are looked at: of all of the run, or the nearest to a few moments [s]."""
    n = len(run.time)
    if moments is not None:
        return np.unique([np.argmin(np.abs(run.time - t)) for t in moments])
    return np.unique(np.linspace(0, n - 1, min(n, MOST_SAMPLES)).astype(np.intp))


def extents(run: RunData, *, scenery: bool = True, outlines: bool = False,
            ) -> dict[int, list[Array]]:
    """Points between which each body lies, with its anchors and guides, in its frame [m].

    Without ``scenery`` fixed bodies that are no part of a hand and no object have their anchors,
    guides and wheels only: a floor may be far larger than what stands on it. By ``outlines`` what
    has shapes or wheels has these only: a cord may be held far beside its body.
    """
    drives, tendons = run.model.drives, run.model.tendons
    found: dict[int, list[Array]] = {}

    def add(body: int, points: Iterable[Iterable[float]]) -> None:
        found.setdefault(body, []).append(np.asarray(points, dtype=float).reshape(-1, 2))

    radii = {(int(drives.target[k]), int(drives.shape[k])):
             float(run.arrays["drive_value"][:, k].max()) for k in drives.giving("radius").tolist()}
    for i, body in enumerate(run.mechanism.bodies):
        left = body.motion == "fixed" and body.role in SCENERY and not scenery
        for k, shape in enumerate(() if left else body.shapes):
            largest = radii.get((i, k), 0.0)
            grow = max(0.0, largest - shape.radius) if isinstance(shape, Circle) else 0.0
            add(i, shape_points(shape, grow))
    for i, wheels in wheel_pictures(run.model).items():
        for wheel in wheels:
            add(i, (wheel.outline if wheel.rim is None else wheel.rim) + wheel.centre)
    outlined = set(found) if outlines else set[int]()
    for i, points in joined_points(run.model).items():
        if i not in outlined:
            add(i, points)
    for body, (x, y), r in zip(tendons.guide_body.tolist(), tendons.guide_at.tolist(),
                               np.abs(tendons.guide_radius).tolist(), strict=True):
        if body not in outlined:
            add(body, [(x - r, y), (x + r, y), (x, y - r), (x, y + r)])
    return found


def body_box(run: RunData, view: View | None = None,
             moments: Sequence[float] | None = None) -> Rectangle:
    """The box [m] of what a picture has to show of all bodies, anchors and guides in a run.

    Of what leaves the mechanism, up to its leaving (:mod:`sandbox.picture.bounds`); of fixed
    floors and frames that are far larger than the rest, what is near it; a traced point counts as
    its body. With a body that is followed it is the same in a frame that goes with it; what is tied
    to that body and near it, where it goes far in its machine; what is tied to it alone, where it
    is free of all that stays. Of the bodies that the view names it is these and their traced points
    and nothing else, in the ``moments`` [s] that are drawn, or in all of the run.
    """
    view = view or run.mechanism.view
    if (few := chosen(run, view)) is not None:
        asked = _boxes(run, view, _samples(run, moments), outlines=True)[:, few]
        return Rectangle.around(np.concatenate([
            asked.reshape(-1, 2), _ways(run, view, _samples(run, moments), few).reshape(-1, 2)]))
    samples, tied = _samples(run, None), _tied_to_followed(run, view)
    ways = _ways(run, view, samples).reshape(-1, 2)
    if view.bodies:
        return Rectangle.around(np.concatenate([
            _boxes(run, view, samples).reshape(-1, 2), ways]))
    if tied is None:
        return _machine(run, view, samples)
    group = Rectangle.around(np.concatenate(
        [_boxes(run, view, samples)[:, tied].reshape(-1, 2), ways]))
    if not anchored(run)[tied].any():
        return group
    still = view.model_copy(update={"follow": None})
    machine = _machine(run, still, samples)
    gone = np.ptp(drift(run, view)[samples], axis=0).max()
    if gone <= BESIDE * max(machine.width, machine.height):
        return _machine(run, view, samples)
    return _near(run, view, samples, group)


def _machine(run: RunData, view: View, samples: NDArray[np.intp]) -> Rectangle:
    """The box [m] of what stays with the mechanism, and of what is near it of large scenery.

    What stays is told in the world, and shown where the view has it. Of a traced point it is the
    way that its body makes with the mechanism.
    """
    whole, own = _boxes(run, view, samples), _boxes(run, view, samples, scenery=False)
    stays = anchored(run)
    gone = np.tile(drift(run, view)[samples, None], 2)
    home = (own if np.isfinite(own[:, stays]).any() else whole) + gone
    near = with_it(home, stays)
    ways = _ways(run, view, samples)[near[:, [body for body, _ in _traced(run, view)]]]
    core = Rectangle.around(np.concatenate([own[near].reshape(-1, 2), ways]))
    reach = BESIDE * max(core.width, core.height)
    if not reach > 0:
        return Rectangle.around(np.concatenate([whole[near].reshape(-1, 2), ways]))
    low, high = np.array([core.x0, core.y0]), np.array([core.x1, core.y1])
    fixed = whole[:, run.model.bodies.fixed].reshape(-1, 2, 2)
    wide = np.ptp(fixed, axis=1) > (1 + 2 * BESIDE) * max(core.width, core.height)
    cut = np.clip(fixed, low - reach, high + reach)
    shown = np.where(wide[:, None], cut, fixed).reshape(-1, 2)
    return Rectangle.around(np.concatenate([np.array([low, high]), shown]))


def _near(run: RunData, view: View, samples: NDArray[np.intp], group: Rectangle) -> Rectangle:
    """``group`` with as much beside it as is there [m], for a body that goes far in its machine."""
    boxes = _boxes(run, view, samples).reshape(-1, 2, 2)
    reach = BESIDE * max(group.width, group.height)
    low = np.array([group.x0, group.y0]) - reach
    high = np.array([group.x1, group.y1]) + reach
    meets = ((boxes[:, 0] <= high) & (boxes[:, 1] >= low)).all(axis=1)
    return Rectangle.around(np.concatenate([
        np.clip(boxes[meets], low, high).reshape(-1, 2),
        np.array([[group.x0, group.y0], [group.x1, group.y1]])]))


def _boxes(run: RunData, view: View, samples: NDArray[np.intp], *, scenery: bool = True,
           outlines: bool = False) -> Array:
    """Left, bottom, right and top of every body's :func:`extents` in samples, [n, nb, 4] m."""
    pool, where = PointPool(), dict[int, slice]()
    for i, points in sorted(extents(run, scenery=scenery, outlines=outlines).items()):
        where[i] = pool.add(i, np.concatenate(points))
    pool.close()
    world = pool.world(run.arrays["body_pose"][samples]) - drift(run, view)[samples, None]
    boxes = np.full((len(samples), len(run.mechanism.bodies), 4), np.nan)
    for i, of in where.items():
        boxes[:, i, :2], boxes[:, i, 2:] = world[:, of].min(axis=1), world[:, of].max(axis=1)
    return boxes


def _ways(run: RunData, view: View, samples: NDArray[np.intp],
          few: Sequence[int] | None = None) -> Array:
    """Where the points are that the view traces, of all bodies or of a few, [n, k, 2] m."""
    pool = PointPool()
    for body, at in _traced(run, view):
        if few is None or body in few:
            pool.add(body, [at])
    pool.close()
    world = pool.world(run.arrays["body_pose"][samples]) - drift(run, view)[samples, None]
    return np.asarray(world)


def _traced(run: RunData, view: View) -> list[tuple[int, tuple[float, float]]]:
    """The bodies of the points that the view traces, and where on them."""
    names = [body.name for body in run.mechanism.bodies]
    return [(names.index(trace.body), trace.at) for trace in view.traces]


def chosen(run: RunData, view: View) -> list[int] | None:
    """The bodies that the view asks for, where these are not simply all."""
    found = meant(view.bodies, run.mechanism.bodies, run.mechanism.groups)
    return found if view.bodies and len(found) < len(run.mechanism.bodies) else None


def _tied_to_followed(run: RunData, view: View) -> list[int] | None:
    """The bodies that are tied to the one that the view follows."""
    names = [body.name for body in run.mechanism.bodies]
    if view.bodies or view.follow not in names:
        return None
    groups = groups_of(run)
    own = groups[names.index(view.follow)]
    return [k for k, group in enumerate(groups) if group == own]


def drift(run: RunData, view: View) -> Array:
    """How far the picture has gone since t = 0 with the body that it follows, [n, 2] m."""
    names = [body.name for body in run.mechanism.bodies]
    if view.follow not in names:
        return np.zeros((len(run.time), 2))
    body = names.index(view.follow)
    pool = PointPool()
    pool.add(body, run.arrays["body_centre"][body])
    pool.close()
    way = pool.world(run.arrays["body_pose"])[:, 0]
    return np.asarray(way - way[0])


def whole_box(out: Listing, run: RunData, bodies: Rectangle, view: View,
              moments: Sequence[float] | None = None) -> Rectangle:
    """``bodies`` with room for arrows that begin there, and for the ways of traced points [m].

    Ways that would make the picture much larger are not counted. Where the view names bodies, only
    contact forces on these count, in the ``moments`` [s] that are painted.
    """
    points = [np.array([[bodies.x0, bodies.y0], [bodies.x1, bodies.y1]])]
    few, gone = chosen(run, view), drift(run, view)
    samples = _samples(run, None if few is None else moments)
    for item in out.items:
        if item["k"] == "arrows" and item["l"] in ("contacts", "drives", "loads"):
            rows = out.tables[item["t"]]
            rows = rows[np.isin(rows[:, 0], samples)]
            if few is not None:
                pairs = divmod(rows[:, 1], len(run.mechanism.bodies))
                rows = rows[np.isin(pairs[0], few) | np.isin(pairs[1], few)]
                if item["l"] != "contacts":
                    continue
            went = gone[rows[:, 0].astype(int)]
            tails, size = rows[:, 2:4] - went, np.hypot(rows[:, 4], rows[:, 5])
            cut = np.minimum(1.0, item["most"] / np.maximum(size, 1e-30)) * item["metres"]
            points.append((tails + rows[:, 4:6] * cut[:, None])[_inside(tails, bodies)])
    box = Rectangle.around(np.concatenate(points))
    if few is None and not view.follow:
        ways = _ways(run, view, np.arange(len(run.time))).reshape(-1, 2)
        more = Rectangle.around(np.concatenate([*points, ways]))
        if max(more.width, more.height) <= GROWN * max(box.width, box.height):
            return more
    return box


def _inside(points: Array, box: Rectangle) -> Flags:
    """Which points lie in a box or on its edge, but for rounding."""
    slack = 1e-6 * max(box.width, box.height)
    low, high = np.array([box.x0, box.y0]) - slack, np.array([box.x1, box.y1]) + slack
    return np.asarray(((points >= low) & (points <= high)).all(axis=1))


ROOM = 0.25
"""How far beside what stays a body may be and still be with it, in sizes of what stays."""
FLIGHT = 12.0
"""The same where nothing stays, in sizes of what is there at the start: what flies off alone is
seen on its way while it is no speck in the picture."""


def groups_of(run: RunData) -> list[int]:
    """The number of each body's group: of bodies that move, those tied together at the run's end.

    What does not move freely is a group of its own each and ties nothing together.
    """
    still, count = _held(run), len(run.mechanism.bodies)
    pairs = [pair for bodies in _tied(run)
             for pair in pairwise(body for body in bodies if not still[body])]
    return components(count, pairs)


def _held(run: RunData) -> Flags:
    """Which bodies do not move freely."""
    return np.array([body.motion != "dynamic" for body in run.mechanism.bodies], dtype=bool)


def _tied(run: RunData) -> Iterable[set[int]]:
    """Sets of connected bodies, without connections that are released at the end."""
    model, held = run.model, run.arrays["held"]
    joints, springs, tendons, lines = model.joints, model.springs, model.tendons, model.lines

    def holds(tie: int) -> bool:
        return tie == NONE or not len(held) or bool(held[-1, tie])

    for k, pair in enumerate(joints.bodies.tolist()):
        if holds(int(model.ties.joint[k])):
            yield set(pair)
    for k, pair in enumerate(springs.bodies.tolist()):
        if holds(int(model.ties.spring[k])):
            yield set(pair)
    for k in range(len(model.mechanism.tendons)):
        if holds(int(model.ties.tendon[k])):
            yield set(tendons.guide_body[tendons.guides(k)].tolist())
    for pair in lines.bodies[lines.joint == NONE].tolist():
        yield set(pair)


def anchored(run: RunData) -> Flags:
    """Which bodies stay, [nb]: those that are fixed, and what is tied to what does not move freely.

    A scheduled body that holds nothing, such as a shelf that goes away, does not.
    """
    still, groups = _held(run), groups_of(run)
    stays = run.model.bodies.fixed.copy()
    fast = {groups[b] for bodies in _tied(run) if still[list(bodies)].any() for b in bodies}
    stays |= np.isin(groups, list(fast))
    return np.asarray(stays, dtype=bool)


def with_it(boxes: Array, stays: Flags) -> Flags:
    """In which samples each body is with the mechanism, [n, nb].

    A body that stays always is, and so is one that comes near for the first time later on. One
    that goes farther than :data:`ROOM` allows from what stays, and from where all bodies began, has
    left, if it does not come back. Where nothing stays, it may go as far as :data:`FLIGHT` allows.

    Args:
        boxes: left, bottom, right and top of every body in every sample, [n, nb, 4] m; nan of a
            body that has no extent.
        stays: those that stay, [nb].
    """
    n, count = boxes.shape[:2]
    found = np.ones((n, count), dtype=bool)
    home = np.concatenate([boxes[:, stays].reshape(-1, 4), boxes[0]])
    home = home[np.isfinite(home).all(axis=1)]
    if not len(home):
        return found
    low, high = home[:, :2].min(axis=0), home[:, 2:].max(axis=0)
    held = np.isfinite(boxes[:, stays]).any()
    room = (ROOM if held else FLIGHT) * float((high - low).max())
    if not room > 0:
        return found
    near = ((boxes[..., :2] <= high + room) & (boxes[..., 2:] >= low - room)).all(axis=-1)
    for body in np.flatnonzero(~stays):
        there = np.flatnonzero(near[:, body])
        if len(there):
            found[there[-1] + 1:, body] = False
    return found
