"""Wheels in pictures: teeth of one size that stand in one another's gaps, and are not too many."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.model.compile import compile_mechanism
from sandbox.model.joints import meeting
from sandbox.model.model import Model
from sandbox.picture.wheels import WheelPicture, wheel_pictures


def compiled(scene: Any) -> Model:
    return compile_mechanism(sandbox.expand(sandbox.load_scene(scene)))


def in_world(model: Model, body: int, picture: WheelPicture) -> np.ndarray:
    """Its outline at t = 0, closed, [n, 2]."""
    x, y, angle = model.bodies.pose[body]
    c, s = math.cos(angle), math.sin(angle)
    path = np.concatenate([picture.outline, picture.outline[:1]]) + picture.centre
    return np.stack([x + c * path[:, 0] - s * path[:, 1], y + s * path[:, 0] + c * path[:, 1]], 1)


def across(path: np.ndarray, through: np.ndarray, along: np.ndarray) -> float:
    """How far along a line an outline crosses it, nearest to where it begins [m]."""
    d = path - through
    off, way = along[0] * d[:, 1] - along[1] * d[:, 0], d @ along
    k = np.flatnonzero(off[:-1] * off[1:] <= 0)
    share = off[k] / (off[k] - off[k + 1])
    found = way[k] + share * (way[k + 1] - way[k])
    return float(found[np.argmin(np.abs(found))])


@pytest.mark.parametrize("scene", ["gear_pair", "planetary"])
def test_teeth_stand_in_gaps(scene: str) -> None:
    """Where they meet and a quarter of a pitch beside, one outline ends before the other."""
    model = compiled(scene)
    pictures = wheel_pictures(model)
    for j in model.joints.keeping("gear", "rack").tolist():
        at = np.array([float(v) for v in meeting(model, j, model.bodies.pose)])
        ends = []
        for end in (0, 1):
            body, radius = int(model.joints.bodies[j, end]), model.joints.radii[j, end]
            one = next(p for p in pictures[body] if not np.isfinite(radius) or (
                p.pitch_line is not None and np.isclose(np.hypot(*p.pitch_line[0]), radius)))
            ends.append(in_world(model, body, one))
        a = model.bodies.pose[model.joints.bodies[j, 0], :2]
        b = model.bodies.pose[model.joints.bodies[j, 1], :2]
        line = at - (a if np.hypot(*(at - a)) > 1e-9 else b)
        line /= np.hypot(*line)
        side = np.array([-line[1], line[0]])
        pitch = 2 * math.pi * model.joints.radii[j, 0] / _teeth_of(pictures, model, j)
        for beside in (0.0, 0.25 * pitch, -0.25 * pitch):
            reach_a, reach_b = (across(path, at + beside * side, line) for path in ends)
            depth = reach_a - reach_b
            if model.joints.inside[j] and model.joints.radii[j, 0] > model.joints.radii[j, 1]:
                depth = -depth
            assert depth < 0.1 * pitch, (model.joints.name[j], beside)


def _teeth_of(pictures: dict[int, list[WheelPicture]], model: Model, j: int) -> float:
    """Of the first wheel of a joint."""
    radius = model.joints.radii[j, 0]
    one = next(p for p in pictures[int(model.joints.bodies[j, 0])] if p.pitch_line is not None
               and np.isclose(np.hypot(*p.pitch_line[0]), radius))
    return len(one.outline) / 4


def test_numbers_of_teeth_are_as_the_radii() -> None:
    model = compiled("planetary")
    count = {model.bodies.name[body]: len(wheels[0].outline) // 4
             for body, wheels in wheel_pictures(model).items()}
    assert count == {"ring": 56, "sun": 28, "planet0": 14, "planet1": 14, "planet2": 14}
