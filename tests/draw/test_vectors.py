"""Velocities, accelerations, hinge forces and bars, against closed forms."""

import numpy as np
import pytest

from sandbox.draw.film.bars import bar_tensions, bars_of
from sandbox.draw.film.marked import fingertip, marked, round_interval, traced
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.scales import LONGEST
from sandbox.draw.film.tensions import tensions_of
from sandbox.draw.film.vectors import (
    LENGTH,
    VectorDrawer,
    Vectors,
    moved_with,
    reactions,
    velocities,
)
from sandbox.scene.mechanism import Mechanism

from .conftest import hand, recording

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


@pytest.mark.parametrize("radius", [0.0, 0.1, 0.2, -0.3])
def test_points_of_a_body_that_turns_go_on_circles(radius):
    """r omega across, and r alpha across - r omega^2 out, about the point that rests."""
    run, out, across = on_a_circle()
    v, a = moved_with(run, [(0, (radius, 0.0))])
    assert v[0, 0] == pytest.approx(radius * 3 * across, abs=1e-15)
    assert a[0, 0] == pytest.approx(radius * (2 * across - 9 * out), abs=1e-15)


def test_an_arrow_has_the_length_of_its_value_and_large_ones_are_cut():
    run, _, _ = on_a_circle()
    values = np.array([[[0.5, 0.0], [2.0, 0.0], [0.0, 40.0]]])
    pool = PointPool()
    drawer = VectorDrawer(run, Vectors([(0, (0.0, 0.0))] * 3, values, "m/s", "", (0, 0, 0)),
                          pool, 1.0)
    pool.close()
    assert drawer.scale.reference == 40.0
    tips = drawer.tips(pool.world(np.zeros((1, 3))), 0)
    assert tips == pytest.approx(LENGTH / 40 * values[0])
    many = np.concatenate([values[:, :2]] * 99 + [values[:, 1:]])
    pool = PointPool()
    run.arrays["time"] = np.arange(100.0)
    drawer = VectorDrawer(run, Vectors([(0, (0.0, 0.0))] * 2, many, "m/s", "", (0, 0, 0)),
                          pool, 1.0)
    pool.close()
    assert drawer.scale.reference == 2.0
    assert drawer.tips(pool.world(np.zeros((1, 3))), 99)[1] == pytest.approx([0, LENGTH * LONGEST])


def test_what_stands_still_but_for_rounding_has_no_arrows():
    run, _, _ = on_a_circle()
    run.arrays["body_velocity"] = np.full((1, 1, 3), 1e-12)
    run.arrays["time"] = np.zeros(1)
    pool = PointPool()
    assert VectorDrawer(run, velocities(run, [(0, (0.0, 0.0))]), pool, 1e6).scale.metres == 0


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
    found = reactions(hanging(roles), [1])
    assert found.values.tolist() == [[[3.0 * sign, 4.0 * sign]]] * 2
    assert found.places == [(1, (0.0, 0.0))]
    assert len(reactions(hanging(roles), []).places) == 0


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


def test_a_hinge_that_carries_what_rounding_leaves_has_no_arrow():
    """Of 1 kg that takes 1e-6 m/s^2: less is nothing, however long an arrow of it could be made."""
    run = hanging(("ground", "link"))
    for size, shown in ((1e-13, False), (1e-3, True)):
        force = np.full((2, 1, 2), size)
        some = type(run)(run.mechanism, {**run.arrays, "joint_force": force}, run.info)
        assert bool(reactions(some, [1]).values.any()) == shown


@pytest.mark.parametrize("angle", [0.0, 1.1, -2.5])
def test_a_bar_carries_what_its_pins_pull_it_apart_with(angle):
    """T along it at either end, whatever acts across; pushed it is negative."""
    u, n = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    for tension in (5.0, -5.0):
        run = strut(angle, -tension * u + 2 * n, tension * u - 2 * n)
        bars = bars_of(run, [0, 1])
        assert [bar.body for bar in bars] == [1]
        assert bar_tensions(run, bars) == pytest.approx(np.array([[tension]]))
        assert tensions_of(run, bars).pushes == (tension < 0)
    assert bars_of(run, [0]) == []


def test_a_bar_with_weight_shows_the_mean_of_its_two_ends():
    """Hung up at one end, of weight 8 N: 8 N at the top, nothing at the foot."""
    run = strut(np.pi / 2, np.array([0.0, 0.0]), np.array([0.0, 8.0]))
    assert bar_tensions(run, bars_of(run, [1])) == pytest.approx(np.array([[4.0]]))


def test_what_is_traced_unless_the_view_says_it():
    run = hand(samples=21)
    names = [body.name for body in run.mechanism.bodies]
    tips = [names.index(f"finger{k}.distal") for k in (1, 2, 3, 4)]
    found = traced(run, run.mechanism.view, ("*",))
    assert [body for body, _ in found] == tips
    # a capsule of 21 mm whose radius is 7.5 mm, from its hinge on
    assert found[0][1] == pytest.approx((0.0285, 0.0), abs=1e-12)
    assert fingertip(run, tips[1]) == pytest.approx((0.0285, 0.0), abs=1e-12)
    assert [body for body, _ in traced(run, run.mechanism.view, ("tree.rocker1",))] == [
        names.index("tree.rocker1")]
    assert traced(run, run.mechanism.view, ()) == []


def test_velocities_are_of_traced_points_else_of_centres():
    run = recording(Mechanism.model_validate({
        "bodies": [ARM, {**ARM, "name": "two"}, {"name": "frame", "motion": "fixed"}],
        "view": {"traces": [{"body": "two", "at": [0.2, 0]}]}}), np.zeros(1), np.zeros((1, 3, 3)),
        body_centre=np.array([[0.1, 0.0]] * 3))
    assert marked(run, run.mechanism.view, ("*",)) == [(1, (0.2, 0.0)), (0, (0.1, 0.0))]
    assert marked(run, run.mechanism.view, ("arm",)) == [(0, (0.1, 0.0))]


@pytest.mark.parametrize("duration", [0.013, 0.5, 1.0, 3.0, 7.0, 240.0])
def test_marks_of_time_are_round_and_about_a_dozen_at_most(duration):
    found = round_interval(duration)
    assert 4 <= duration / found <= 12 * (1 + 1e-9)
    assert found / 10.0 ** np.floor(np.log10(found)) == pytest.approx(
        min((1, 2, 5), key=lambda step: abs(found / 10.0 ** np.floor(np.log10(found)) - step)))
