"""What pictures tell of forces that are worked out: scales, numbers, marks of what holds."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pygame
import pytest

import sandbox
from sandbox.draw.film.canvas import Label, spots_at
from sandbox.draw.film.drives import DriveDrawer, _tangent
from sandbox.draw.film.fluids import pressure_text
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.labels import place_label
from sandbox.draw.film.latches import LatchDrawer
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.scales import ForceScale
from sandbox.draw.film.tendons import slipping
from sandbox.draw.film.tensions import largest_tension
from sandbox.recording.recording import Recording


def _run(**lists: Any) -> Recording:
    return sandbox.simulate(sandbox.expand(sandbox.load_scene({
        "run": {"duration": 0.1, "step": 1e-3, "sample_rate": 1000}, "gravity": [0, 0],
        "bodies": [{"name": "wall", "motion": "fixed"},
                   {"name": "w", "mass": 1.0, "inertia": 1e-2}],
        "joints": [{"type": "pin", "name": "p", "a": "wall", "b": "w", "on_a": [0, 0]}],
        **lists})))


def test_a_short_spike_does_not_wash_out_what_is_carried_else() -> None:
    """5 % of the run at 100 N, the rest at 1 N: the top is what twice 1 N is rounded up to."""
    tension = np.where(np.arange(1000) < 50, 100.0, 1.0)[:, None]
    assert largest_tension(tension) == 2.0
    assert largest_tension(tension[::-1]) == 100.0  # the last picture is not beyond the scale


def test_what_is_slack_most_of_the_time_is_no_spike_when_it_is_tight() -> None:
    assert largest_tension(np.where(np.arange(1000) < 900, 0.0, 30.0)[:, None]) == 30.0
    assert largest_tension(np.linspace(0.0, 20.0, 1000)[:, None]) == 20.0  # a pull that grows


@pytest.mark.parametrize("radius", [0.3, -0.3])
def test_a_pull_goes_on_along_the_cord_that_leaves_a_wheel(radius: float) -> None:
    """At right angles to the radius where it leaves, with the wheel on the side that it has."""
    way = np.array([0.3, -0.7])
    along = _tangent(way, radius)
    along = along / np.hypot(*along)
    across = along[0] * way[1] - along[1] * way[0]
    assert math.isclose(across, radius, rel_tol=1e-12)  # the centre lies so far right of the way
    assert (_tangent(way, 0.0) == way).all()


def _told(run: Recording) -> list[str]:
    pool = PointPool()
    drawer = DriveDrawer(run, pool, 0.1, ForceScale(0.0, 0.0))
    pool.close()
    return [drawer.words(told, 50) for told in drawer._told]


def test_what_motors_and_actuators_give_is_told_to_three_digits_of_the_largest() -> None:
    motor = {"type": "motor", "name": "m", "joint": "p", "torque": 0.25, "value": 1e3}
    assert _told(_run(drives=[motor])) == ["m 0.250 N m"]
    piston = {"type": "actuator", "name": "c", "a": "wall", "b": "w", "on_a": [0, -1]}
    reach = {"type": "length", "name": "d", "joint": "c", "force": 120, "value": 9.0}
    assert _told(_run(joints=[piston], drives=[reach])) == ["d 120 N"]
    assert _told(_run(drives=[{"type": "torque", "name": "t", "joint": "p", "value": 1}])) == []


def test_a_label_of_what_has_left_the_picture_goes_with_it() -> None:
    stage = pygame.Rect(0, 0, 100, 100)
    inside, cut, gone = (Label("x", spots_at((50.0, y)), required=True)
                         for y in (50.0, 99.0, 130.0))
    placed = [place_label(label, (20, 10), stage, []) for label in (inside, cut, gone)]
    assert placed == [pygame.Rect(40, 45, 20, 10), pygame.Rect(40, 90, 20, 10), None]


def test_a_cord_slips_in_the_samples_in_which_it_has_moved() -> None:
    way = np.array([[0.0, 0.0], [1e-3, 1e-12], [2e-3, 1e-12], [2e-3, 0.0], [2e-3 + 1e-9, 0.0]])
    assert slipping(way).T.tolist() == [[False, True, True, False, False], [False] * 5]
    assert slipping(np.zeros((0, 2))).shape == (0, 2)


def test_what_may_be_let_go_has_its_mark_where_it_holds_on() -> None:
    """Full until the event at 50 ms, hollow after it; a joint that cannot go has none."""
    run = _run(events=[{"name": "e", "at": 0.05, "release": ["p"]}])
    pool = PointPool()
    marks = LatchDrawer(run, pool)._marks
    pool.close()
    assert [(tie, tuple(pool.world(run.arrays["body_pose"][0])[at])) for tie, at in marks] == [
        (0, (0.0, 0.0))]
    renderer = FrameRenderer(run, size=(800, 600), enlarge=1)
    early, late = (renderer.draw(t).copy().astype(int) for t in (0.02, 0.09))
    x, y = (round(float(v)) for v in renderer.camera.to_pixels(np.zeros((1, 2)))[0])
    # left of the pin, within the diamond
    full, hollow = (picture[y, x - 5].sum() for picture in (early, late))
    assert full < 200
    assert hollow > 700
    still = _run()
    assert LatchDrawer(still, PointPool())._marks == []


def test_a_pressure_has_the_unit_and_the_decimals_of_its_scale() -> None:
    assert pressure_text(1.8e4, of=5e4) == "18.0 kPa"
    assert pressure_text(5e3, of=2e6) == "0.01 MPa"
    assert pressure_text(2e5) == "2 bar"
