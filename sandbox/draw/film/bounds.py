"""What part of the world a run needs: bodies, cords and forces, over all of its time."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sandbox.draw.film.camera import Rectangle
from sandbox.draw.film.drives import DRIVE_LENGTH, DriveDrawer
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.forces import ContactDrawer
from sandbox.draw.film.geometry import shape_points
from sandbox.draw.film.joints import joined_points
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.scales import ForceScale
from sandbox.draw.film.staying import anchored, groups_of, with_it
from sandbox.draw.film.wheels import wheel_pictures
from sandbox.kinds.layers import meant
from sandbox.numeric import Array, Flags
from sandbox.scene.elements.bodies import Circle
from sandbox.scene.elements.settings import View

MOST_SAMPLES = 200
"""Samples looked at; a motion is smooth enough between them for a margin of 4 %."""
CHARACTER = 8.5 / 800
"""Width of a character as a fraction of the picture's."""


def _samples(run: Filmed) -> NDArray[np.intp]:
    n = len(run.time)
    return np.unique(np.linspace(0, n - 1, min(n, MOST_SAMPLES)).astype(np.intp))


def extents(run: Filmed) -> dict[int, list[Array]]:
    """Points between which each body lies, with its anchors and guides, in its frame [m]."""
    drives, tendons = run.model.drives, run.model.tendons
    found: dict[int, list[Array]] = {}

    def add(body: int, points: Iterable[Iterable[float]]) -> None:
        found.setdefault(body, []).append(np.asarray(points, dtype=float).reshape(-1, 2))

    radii = {(int(drives.target[k]), int(drives.shape[k])):
             float(run.arrays["drive_value"][:, k].max()) for k in drives.giving("radius").tolist()}
    for i, body in enumerate(run.mechanism.bodies):
        for k, shape in enumerate(body.shapes):
            largest = radii.get((i, k), 0.0)
            grow = max(0.0, largest - shape.radius) if isinstance(shape, Circle) else 0.0
            add(i, shape_points(shape, grow))
    for i, points in joined_points(run.model).items():
        add(i, points)
    for body, (x, y), r in zip(tendons.guide_body.tolist(), tendons.guide_at.tolist(),
                               np.abs(tendons.guide_radius).tolist(), strict=True):
        add(body, [(x - r, y), (x + r, y), (x, y - r), (x, y + r)])
    for i, wheels in wheel_pictures(run.model).items():
        for wheel in wheels:
            add(i, (wheel.outline if wheel.rim is None else wheel.rim) + wheel.centre)
    return found


def body_box(run: Filmed, view: View | None = None) -> Rectangle:
    """The box [m] of what a picture has to show of all bodies, anchors and guides in a run.

    Of what leaves the mechanism, up to its leaving (:mod:`sandbox.draw.film.staying`); of the
    bodies that the view names, all of it; traced points always. With a body that is followed it is
    what is tied to that, in a frame that goes with it.
    """
    view, samples = view or run.mechanism.view, _samples(run)
    names = [body.name for body in run.mechanism.bodies]
    pool, where = PointPool(), dict[int, slice]()
    for i, points in sorted(extents(run).items()):
        where[i] = pool.add(i, np.concatenate(points))
    traced = [pool.add(names.index(trace.body), [trace.at]) for trace in view.traces]
    pool.close()
    world = pool.world(run.arrays["body_pose"][samples]) - drift(run, view)[samples, None]
    boxes = np.full((len(samples), len(names), 4), np.nan)
    for i, of in where.items():
        boxes[:, i, :2], boxes[:, i, 2:] = world[:, of].min(axis=1), world[:, of].max(axis=1)
    kept = _wanted(run, view, boxes)
    ways = [world[:, of].reshape(-1, 2) for of in traced]
    corners = boxes[kept].reshape(-1, 2)
    return Rectangle.around(np.concatenate([corners, *ways]))


def _wanted(run: Filmed, view: View, boxes: Array) -> Flags:
    """Which bodies are to be in sight in which samples, [n, nb]."""
    names = [body.name for body in run.mechanism.bodies]
    wanted = np.zeros(boxes.shape[:2], dtype=bool)
    if view.bodies:
        wanted[:, meant(view.bodies, names)] = True
    elif view.follow in names:
        groups = groups_of(run)
        wanted[:, [k for k, group in enumerate(groups)
                   if group == groups[names.index(view.follow)]]] = True
    else:
        wanted = with_it(boxes, anchored(run))
    return wanted


def drift(run: Filmed, view: View) -> Array:
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


def whole_box(run: Filmed, bodies: Rectangle, scale: ForceScale, width: float,
              view: View | None = None) -> Rectangle:
    """``bodies`` with room for every arrow that begins there, drive and drive's label [m].

    For a picture that is ``width`` [m] wide, more or less.
    """
    points = [np.array([[bodies.x0, bodies.y0], [bodies.x1, bodies.y1]])]
    samples = _samples(run)
    gone = drift(run, view or run.mechanism.view)
    if scale.metres > 0:
        contacts = ContactDrawer(run, scale)
        for k in samples:
            tails, tips, _ = contacts.arrows(int(k))
            points.append(tips[_inside(tails - gone[k], bodies)] - gone[k])
    pool = PointPool()
    drives = DriveDrawer(run, pool, DRIVE_LENGTH * width, scale)
    pool.close()
    world = pool.world(run.arrays["body_pose"][samples])
    for k, sample in enumerate(samples):
        for driven, at, tip in drives.ends(world[k], run.arrays["drive_value"][sample]):
            if not _inside(np.array([at]) - gone[sample], bodies)[0]:
                continue
            dx, dy = tip[0] - at[0], tip[1] - at[1]
            text = CHARACTER * width * (len(driven.name) + 8)
            length = max(np.hypot(dx, dy), 1e-12)
            half = text / 2 if abs(dy) > abs(dx) else 0.0
            end = (tip[0] + dx / length * (text if abs(dx) >= abs(dy) else 0.03 * width),
                   tip[1] + dy / length * 0.045 * width)
            points.append(np.array([tip, (end[0] - half, end[1]), (end[0] + half, end[1])])
                          - gone[sample])
    return Rectangle.around(np.concatenate(points))


def _inside(points: Array, box: Rectangle) -> Flags:
    """Which points lie in a box or on its edge, but for rounding."""
    slack = 1e-6 * max(box.width, box.height)
    low, high = np.array([box.x0, box.y0]) - slack, np.array([box.x1, box.y1]) + slack
    return np.asarray(((points >= low) & (points <= high)).all(axis=1))
