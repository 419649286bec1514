"""Names of bodies stand on or beside their own bodies, or on a line that ends there."""

import math
from itertools import pairwise

import numpy as np
import pytest

import sandbox
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.geometry import shape_points
from sandbox.draw.film.joints import joined_points
from sandbox.draw.film.options import view_of
from sandbox.draw.film.palette import FAINT_INK
from sandbox.draw.film.sheet import Hair, Text
from sandbox.draw.film.wheels import wheel_pictures
from sandbox.notebook.start import at_start
from sandbox.scene.library import shipped_scenes

from .test_staying import body, world

SHARE = 6
"""Every third of the shipped scenes is looked at in one test."""


def outlines(run):
    """Closed outlines of each body in its frame; its anchors where it has none."""
    found = [[shape_points(shape) for shape in body.shapes] for body in run.mechanism.bodies]
    for k, wheels in wheel_pictures(run.model).items():
        found[k] += [(w.outline if w.rim is None else w.rim) + w.centre for w in wheels]
    for k, points in joined_points(run.model).items():
        found[k] = found[k] or [np.array([point], dtype=float) for point in points]
    return found


def turned(points, pose):
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return points @ np.array([[c, s], [-s, c]]) + pose[:2]


def to_line(at, a, b):
    """Distance from a point to a straight line from a to b."""
    along = b - a
    share = np.clip(np.dot(at - a, along) / max(np.dot(along, along), 1e-12), 0, 1)
    return float(np.hypot(*(a + share * along - at)))


def inside(at, closed):
    """By the turn of the sight of the outline, once round from a point within."""
    angles = np.unwrap(np.arctan2(*(np.vstack((closed, closed[:1])) - at).T[::-1]))
    return abs(angles[-1] - angles[0]) > math.pi


def apart(rect, shapes):
    """From a text to the nearest outline; 0 where its middle is within one, or a line enters it."""
    best, at = math.inf, np.array(rect.center, dtype=float)
    corners = np.array([rect.topleft, rect.topright, rect.bottomright, rect.bottomleft], float)
    for closed in shapes:
        if len(closed) > 2 and inside(at, closed):
            return 0.0
        ring = [*closed, closed[0]]
        for a, b in pairwise(ring):
            if rect.clipline(a.tolist(), b.tolist()) or rect.collidepoint(a):
                return 0.0
            best = min(best, *(to_line(corner, a, b) for corner in corners), *(
                to_line(a, corners[k - 1], corners[k]) for k in range(4)))
    return best


def misplaced(run, t=0.0, size=(800, 600)):
    """Names without a line that are nearer to another body, and lines that end beside theirs."""
    view = view_of(run.mechanism.view, {
        "show": "body_names,-names,-contacts,-loads", "size": size, "meters": []})
    frames = FrameRenderer(run, view=view, enlarge=1)
    sheet = frames.sheet(t)
    pose = run.arrays["body_pose"][int(np.argmin(np.abs(run.time - t)))]
    seen = [[frames.camera.to_pixels(turned(each, pose[k])) for each in closed]
            for k, closed in enumerate(outlines(run))]
    names, found, count = [each.name for each in run.mechanism.bodies], [], 0
    for before, word in pairwise([None, *sheet.words]):
        if not (isinstance(word, Text) and word.face.text in names
                and tuple(word.face.colour) == tuple(FAINT_INK)):
            continue
        count += 1
        own = names.index(word.face.text)
        if isinstance(before, Hair):
            end = np.array(before.end, dtype=float)
            near = min([0.0 if len(c) > 2 and inside(end, c) else min(
                to_line(end, a, b) for a, b in pairwise([*c, c[0]])) for c in seen[own]],
                default=0.0)
            found += [(word.face.text, "line", near)] if near > 5 else []
            continue
        far = apart(word.rect, seen[own])
        other = min((apart(word.rect, each) for k, each in enumerate(seen) if k != own),
                    default=math.inf)
        found += [(word.face.text, far, other)] if far >= other else []
    return found, count


@pytest.mark.parametrize("part", range(SHARE))
def test_names_of_all_shipped_scenes_are_nearest_to_their_own_bodies(part):
    told, count = {}, 0
    for name in sorted(shipped_scenes())[part::SHARE]:
        wrong, seen = misplaced(at_start(sandbox.expand(sandbox.load_scene(name))))
        told |= {name: wrong} if wrong else {}
        count += seen
    assert not told
    assert count > 50


def test_bodies_that_meet_have_a_name_each_and_no_list():
    run = world(body("one", [0, 0.1]), body("two", [0.01, 0.1]), body("three", [0.3, 0.1]))
    wrong, count = misplaced(run)
    assert (wrong, count) == ([], 4)
