"""What part of the world a run needs: bodies, cords and forces, over all of its time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sandbox.draw.film.camera import Rectangle
from sandbox.draw.film.canvas import Filmed
from sandbox.draw.film.drives import DRIVE_LENGTH, DriveDrawer
from sandbox.draw.film.forces import ContactDrawer, ForceScale
from sandbox.draw.film.geometry import shape_points
from sandbox.draw.film.joints import joined_points
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.wheels import wheel_pictures
from sandbox.scene.elements.bodies import Circle

MOST_SAMPLES = 200
"""Samples looked at; a motion is smooth enough between them for a margin of 4 %."""
CHARACTER = 8.5 / 800
"""Width of a character as a fraction of the picture's."""


def _samples(run: Filmed) -> NDArray[np.intp]:
    n = len(run.time)
    return np.unique(np.linspace(0, n - 1, min(n, MOST_SAMPLES)).astype(np.intp))


def body_box(run: Filmed) -> Rectangle:
    """The box of all bodies, anchors and guides over the whole run [m]."""
    drives, tendons = run.model.drives, run.model.tendons
    pool = PointPool()
    radii = {(int(drives.target[k]), int(drives.shape[k])):
             float(run.arrays["drive_value"][:, k].max()) for k in drives.giving("radius").tolist()}
    for i, body in enumerate(run.mechanism.bodies):
        for k, shape in enumerate(body.shapes):
            largest = radii.get((i, k), 0.0)
            grow = max(0.0, largest - shape.radius) if isinstance(shape, Circle) else 0.0
            pool.add(i, shape_points(shape, grow))
    for i, points in joined_points(run.model).items():
        pool.add(i, points)
    for body, (x, y), r in zip(tendons.guide_body.tolist(), tendons.guide_at.tolist(),
                               np.abs(tendons.guide_radius).tolist(), strict=True):
        pool.add(body, [(x - r, y), (x + r, y), (x, y - r), (x, y + r)])
    for i, wheels in wheel_pictures(run.model).items():
        for wheel in wheels:
            pool.add(i, (wheel.outline if wheel.rim is None else wheel.rim) + wheel.centre)
    names = [body.name for body in run.mechanism.bodies]
    for trace in run.mechanism.view.traces:
        pool.add(names.index(trace.body), [trace.at])
    pool.close()
    return Rectangle.around(pool.world(run.arrays["body_pose"][_samples(run)]).reshape(-1, 2))


def whole_box(run: Filmed, bodies: Rectangle, scale: ForceScale, width: float) -> Rectangle:
    """``bodies`` with room for every force arrow, drive and drive's label [m].

    For a picture that is ``width`` [m] wide, more or less.
    """
    points = [np.array([[bodies.x0, bodies.y0], [bodies.x1, bodies.y1]])]
    samples = _samples(run)
    if scale.metres > 0:
        contacts = ContactDrawer(run, scale)
        points += [contacts.arrows(int(k))[1] for k in samples]
    pool = PointPool()
    drives = DriveDrawer(run, pool, DRIVE_LENGTH * width, scale)
    pool.close()
    world = pool.world(run.arrays["body_pose"][samples])
    for k, sample in enumerate(samples):
        for driven, at, tip in drives.ends(world[k], run.arrays["drive_value"][sample]):
            dx, dy = tip[0] - at[0], tip[1] - at[1]
            text = CHARACTER * width * (len(driven.name) + 8)
            length = max(np.hypot(dx, dy), 1e-12)
            half = text / 2 if abs(dy) > abs(dx) else 0.0
            end = (tip[0] + dx / length * (text if abs(dx) >= abs(dy) else 0.03 * width),
                   tip[1] + dy / length * 0.045 * width)
            points.append(np.array([tip, (end[0] - half, end[1]), (end[0] + half, end[1])]))
    return Rectangle.around(np.concatenate(points))
