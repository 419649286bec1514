"""How long arrows are and how colours are scaled: by what acts most of the time."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.picture.elements.forces import point_motion, reactions
from sandbox.picture.scales import (
    bar_tensions,
    bars_of,
    force_scale,
    largest_tension,
    tensions_of,
    typical,
)
from sandbox.scene.mechanism import Mechanism

from .conftest import recording

TIME = np.arange(1000) / 1000


def test_scales_leave_out_blows_and_the_time_in_which_nothing_acts():
    size = np.full(1000, 2.0)
    size[500:540] = 1e4
    assert typical(size, TIME) == 2.0
    size[500:610] = 1e4  # more than one picture of ten shows it
    assert typical(size, TIME) == 1e4
    size = np.zeros(1000)
    size[100:110] = 7.0
    assert typical(size, TIME) == 7.0


def test_blows_one_after_the_other_do_not_set_the_scale_of_what_presses():
    """Two balls press on a floor with 2 N, in turn one of them is hit with 50 N."""
    discs = [{"name": name, "mass": 1, "shapes": [{"type": "circle", "radius": 0.01}]}
             for name in ("floor", "one", "two")]
    sample = np.repeat(np.arange(20), 2)
    force = np.where(np.arange(40) % 4 == 0, 50.0, 2.0)[:, None] * (0.0, 1.0)
    run = recording(Mechanism.model_validate({"bodies": discs}), TIME[:20], np.zeros((20, 3, 3)),
                    contact_sample=sample, contact_body=np.tile([1, 2], 20), contact_force=force,
                    contact_other=np.zeros(40, dtype=int), contact_gap=np.zeros(40))
    assert force_scale(run, 1.0).reference == 2.0


def test_a_short_spike_does_not_wash_out_what_is_carried_else() -> None:
    """5 % of the run at 100 N, the rest at 1 N: the top is what twice 1 N is rounded up to."""
    tension = np.where(np.arange(1000) < 50, 100.0, 1.0)[:, None]
    assert largest_tension(tension) == 2.0
    assert largest_tension(tension[::-1]) == 100.0  # the last picture is not beyond the scale


ARM = {"name": "arm", "mass": 1, "inertia": 1, "centre": [0.1, 0],
       "shapes": [{"type": "capsule", "end": [0.2, 0], "radius": 0.01}]}


def on_a_circle(omega=3.0, alpha=2.0):
    """An arm that turns about its origin, which rests, at omega and alpha as it lies at 0.7 rad."""
    angle = 0.7
    out = np.array([np.cos(angle), np.sin(angle)])
    across = np.array([-out[1], out[0]])
    pose = np.zeros((1, 1, 3))
    pose[..., 2] = angle
    v, a = 0.1 * omega * across, 0.1 * (alpha * across - omega**2 * out)
    return recording(Mechanism.model_validate({"bodies": [ARM]}), np.zeros(1), pose,
                     body_velocity=np.array([[[*v, omega]]]),
                     body_acceleration=np.array([[[*a, alpha]]]),
                     body_centre=np.array([[0.1, 0.0]])), out, across


@pytest.mark.parametrize("radius", [0.0, 0.2, -0.3])
def test_points_of_a_body_that_turns_go_on_circles(radius):
    """r omega across, and r alpha across - r omega^2 out, about the point that rests."""
    run, out, across = on_a_circle()
    v, a = point_motion(run, [(0, (radius, 0.0))])
    assert v[0, 0] == pytest.approx(radius * 3 * across, abs=1e-15)
    assert a[0, 0] == pytest.approx(radius * (2 * across - 9 * out), abs=1e-15)


def hanging(roles=("ground", "link")):
    """A body on a pin that carries (3, 4) N, on its body b by its body a."""
    mechanism = Mechanism.model_validate({
        "bodies": [{"name": "frame", "motion": "fixed", "role": roles[0]},
                   {**ARM, "role": roles[1]}],
        "joints": [{"type": "pin", "name": "pin", "a": "frame", "b": "arm", "on_b": [0, 0]}]})
    pose = np.zeros((2, 2, 3))
    pose[1, 1, 2] = 0.1
    return recording(mechanism, np.arange(2.0), pose, joint_force=np.full((2, 1, 2), [3.0, 4.0]))


@pytest.mark.parametrize(("roles", "sign"), [(("ground", "link"), 1), (("object", "link"), -1)])
def test_what_a_hinge_carries_acts_on_the_object_else_on_what_moves_more(roles, sign):
    places, values, _ = reactions(hanging(roles), [1])
    assert values.tolist() == [[[3.0 * sign, 4.0 * sign]]] * 2
    assert places == [(1, (0.0, 0.0))]
    assert reactions(hanging(roles), [])[0] == []


def strut(angle, first, second):
    """A bar from (0, 0) to (0.2, 0) of its frame, turned; what its two pins push it with."""
    mechanism = Mechanism.model_validate({
        "bodies": [{"name": "frame", "motion": "fixed"}, ARM],
        "joints": [{"type": "pin", "name": "p", "a": "frame", "b": "arm", "on_b": [0, 0]},
                   {"type": "pin", "name": "q", "a": "arm", "b": "frame", "on_a": [0.2, 0],
                    "on_b": [0.2, 0]}]})
    pose = np.zeros((1, 2, 3))
    pose[0, 1, 2] = angle
    # on its body b: of the second pin the bar is a
    force = np.array([[first, np.negative(second)]])
    return recording(mechanism, np.zeros(1), pose, joint_force=force)


@pytest.mark.parametrize("angle", [0.0, 1.1, -2.5])
def test_a_bar_carries_what_its_pins_pull_it_apart_with(angle):
    """T along it at either end, whatever acts across; pushed it is negative."""
    u, n = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    for tension in (5.0, -5.0):
        run = strut(angle, -tension * u + 2 * n, tension * u - 2 * n)
        bars = bars_of(run, [0, 1])
        assert [bar.body for bar in bars] == [1]
        assert bar_tensions(run, bars) == pytest.approx(np.array([[tension]]))
        assert tensions_of(run, bars).pushing == ({"bars"} if tension < 0 else set())
    assert bars_of(run, [0]) == []
