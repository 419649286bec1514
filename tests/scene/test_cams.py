"""Cams from a lift table: the spline, the envelope, undercut."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from sandbox.engine.inspect import inspect
from sandbox.errors import SceneError
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene

TURNS = np.arange(0.0, math.tau, math.pi / 12)


def cam(lift, **keys):
    table = [[float(a), float(s)] for a, s in zip(TURNS, lift, strict=True)]
    shape = {"type": "cam", "base": 0.03, "lift": table, **keys}
    scene = load_scene({"bodies": [{"name": "cam", "motion": "fixed", "shapes": [shape]}]})
    return np.array(scene.bodies[0].shapes[0].points)


def refused(lift, **keys) -> str:
    with pytest.raises(SceneError) as raised:
        cam(lift, **keys)
    return str(raised.value)


# --- the envelope


# --- what cannot be


def test_a_flat_follower_needs_a_base_above_what_bends_the_lift_most():
    """b > -min(s + s''): for s = e (1 - cos 2a), s + s'' = e (1 + 3 cos 2a) is at least -2 e.

    A spline's second derivative misses by h^2 / 12 max |s''''|, 16 e h^2 / 12 = 0.09 e.
    """
    lift = 0.005 * (1 - np.cos(2 * TURNS))
    text = refused(lift, follower="flat", base=0.009)
    assert "undercut at a turn of" in text
    wanted = float(re.search(r"base radius of at least ([\d.]+) m", text)[1])
    assert 0.01 < wanted <= 0.0105  # rounded up to three digits
    assert len(cam(lift, follower="flat", base=wanted)) > 24


@pytest.mark.parametrize(("lift", "keys", "words"), [
    (0 * TURNS, {}, "'roller' is missing"),
    (0 * TURNS, {"follower": "flat", "roller": 0.01}, "a flat follower has no 'roller'"),
    (0 * TURNS - 0.04, {"roller": 0.01}, "Allowed: a base radius above 0.04 m"),
    (0.01 * np.sin(TURNS), {"roller": 0.01, "tolerance": 1e-9}, "Allowed: a tolerance of"),
])
def test_what_is_no_cam_is_told(lift, keys, words):
    text = refused(lift, **keys)
    assert "$.bodies[0].shapes[0]" in text
    assert words in text


@pytest.mark.parametrize(("dwell", "warned"), [([210, 330], True), (range(180, 360, 15), False)])
def test_a_lift_that_swings_beyond_its_entries_is_warned_of(dwell, warned):
    """A rise and return of 10 mm with a dwell of two entries, and of twelve."""
    turns = np.radians([*range(0, 180, 15), *dwell])
    lift = np.where(turns < 3.0, 0.005 * (1 - np.cos(2 * turns)), 0.0)
    scene = load_scene({"bodies": [{"name": "cam", "motion": "fixed", "shapes": [
        {"type": "cam", "base": 0.1, "follower": "flat", "lift": np.stack([turns, lift], 1)
         .tolist()}]}]})
    spline = CubicSpline([*turns, math.tau], [*lift, lift[0]], bc_type="periodic")
    lowest = 1e3 * spline(np.linspace(0, math.tau, 36_001)).min()
    text = "".join(str(problem) for problem in inspect(expand(scene)))
    found = re.findall(r"the lift of its cam swings to (\S+) mm", text)
    assert list(map(float, found)) == pytest.approx([lowest] * warned, rel=1e-3)
