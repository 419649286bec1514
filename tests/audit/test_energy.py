"""Energy: what is summed up, with which sign, and how much of it may be left over.

Where nothing moves that could err by a step: 1e-9 of what was turned over.
"""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.scene.mechanism import Mechanism
from tests.audit.still import H, block, figures, machine, still, turns

ALLOWED, CLOSED = 1e-9, 1.5e-10
M, INERTIA = 0.2, 3e-4
HINGED = {
    "joints": [{"type": "pin", "name": "pin", "a": "wall", "b": "one", "on_b": (0, 0)}],
    "springs": [{"type": "linear", "name": "band", "a": "wall", "b": "one", "stiffness": 200.0,
                 "damping": 1.0}],
    "tendons": [{"name": "cord", "guides": [{"body": "wall"}, {"body": "one", "at": (0.1, 0)}]}],
    "drives": [{"type": "torque", "name": "motor", "joint": "pin", "value": 0},
               {"type": "pull", "name": "pull", "tendon": "cord", "value": 0}],
}
"""Something of each kind that works; the band is damped, so that it has no figure of its own."""


def hinged(**more):
    return machine(block("one", **more), **HINGED)


def flying(**more):
    """A free body that began with 3 m/s and 40 rad/s."""
    return machine(block("one", velocity=(1.8, -2.4), angular_velocity=40.0), **more)


START = (M * 9.0 + INERTIA * 1600.0) / 2


def test_energy_of_motion_is_of_both_components_and_of_turning():
    """m v^2 / 2 + I w^2 / 2; each of the three slower by what takes the share allowed."""
    for k, weight, speed in ((0, M, 1.8), (1, M, -2.4), (2, INERTIA, 40.0)):
        def make(error, k=k, weight=weight, speed=speed):
            def change(a):
                a["body_velocity"][:, 1] = [1.8, -2.4, 40.0]
                kept = speed**2 - 2 * error * START / weight
                a["body_velocity"][2, 1, k] = np.sign(speed) * np.sqrt(kept)
            return still(flying(), change)
        turns("energy.lost", ALLOWED, make, by=1e-3)


@pytest.mark.parametrize(("key", "column", "turned_over"), [
    ("tendon_work", 0, False), ("spring_work", 0, True), ("drive_work", 0, True),
    ("joint_damping_work", 0, False)])
def test_work_of_every_kind_is_taken_off(key, column, turned_over):
    """1 J moved from one kind of work into motion: too much of it, or too little, is seen.

    Motion has 1 J at the end. The work that counts as turned over is there as well, once more.
    """
    scale = 2.0 if turned_over else 1.0

    def make(error):
        def change(a):
            a[key][:, column] = 1.0
            a["body_velocity"][:, 1, 0] = np.sqrt(2 / M * (1.0 - error * scale))
            a["body_velocity"][0, 1, 0] = np.sqrt(2 / M)  # so that the most of it stays 1 J
        return still(hinged(), change)
    turns("energy.lost", ALLOWED, make, by=1e-3)


@pytest.mark.parametrize("down", [1.0, -1.0])
def test_weight_that_is_lifted_or_falls_counts_with_its_size(down):
    """0.2 kg, 4 m/s^2 along y alone, 0.5 m: 0.4 J, which a cord takes or gives."""
    def make(error):
        def change(a):
            a["body_pose"][:, 1, 1] -= 0.5 * down
            a["tendon_work"][:, 0] = down * (-0.4 + 0.4 * error)
        return still(machine(block("one"), tendons=HINGED["tendons"], gravity=(0.0, -4.0)), change,
                     every=2)
    rounding, start = M * 4.0 * 1e-12, H**2 / 8 * M * 4.0**2
    turns("energy.lost", ALLOWED + (rounding + start) / 0.4, make, by=1e-3)


# -- created and lost ------------------------------------------------------------------------


def test_energy_created_is_the_most_that_ever_came_back():
    """From the lowest before: 1 J taken, then error more than that given back, then taken again."""
    def make(error):
        def change(a):
            a["tendon_work"][:, 0] = [0.0, 0.25, 0.25 - 4.0 * error, 0.5]
            a["body_velocity"][1, 1, 0] = 0.0
            a["drive_work"][:, 0] = [0.0, 0.0, 0.0, 4.0]  # what is turned over in all
            a["joint_damping_work"][:, 0] = [0.0, 0.0, 0.0, -4.0]
        return still(hinged(), change)
    turns("energy.created", ALLOWED, make, by=1e-3)


POINT = (0.08, 0.01)
SLIDE = {"name": "one", "mass": M, "inertia": INERTIA, "centre": (0.02, -0.03),
         "shapes": [{"type": "circle", "radius": 0.05}]}


FLOOR = {"name": "floor", "motion": "fixed", "shapes": [{"type": "circle", "radius": 0.05}]}


@pytest.mark.parametrize(("who", "sign", "sample"), [((1, 3), 1.0, 1), ((3, 1), -1.0, 3)])
def test_the_work_of_contacts_is_force_times_way_and_moment_times_turn(who, sign, sample):
    """A force (2, 3) N at an arm of (60, 40) mm, on a body with (0.5, -0.7) m/s and 11 rad/s.

    P = 2 * 0.5 - 3 * 0.7 + (0.06 * 3 - 0.04 * 2) * 11 for one step, up to the middle of each; the
    hinge of another body has a damper that stands for what takes it. The floor turns, and does no
    work: it is not free.
    """
    power = 2.0 * 0.5 - 3.0 * 0.7 + (0.06 * 3.0 - 0.04 * 2.0) * 11.0
    machine_ = machine(SLIDE, block("two"), FLOOR, drives=HINGED["drives"][:1], joints=[
        {"type": "pin", "name": "pin", "a": "wall", "b": "two", "on_b": (0, 0)}])

    def make(error):
        def change(a):
            a["body_velocity"][1, 1] = [0.5, -0.7, 11.0]
            a["body_velocity"][1, 3] = 9.0
            kinetic = (M * (0.25 + 0.49) + INERTIA * 121.0) / 2
            a["drive_work"][:, 0] = [0.0, kinetic, 0.0, 0.0]
            a["joint_damping_work"][:, 0] = np.array([0, -0.5, -1, -1]) * power * H
            a["joint_damping_work"][sample, 0] += error * 2 * kinetic
        return still(machine_, change, touches=[
            (1, *who, (2.0 * sign, 3.0 * sign), (0.0, sign), POINT, -3e-9)])
    scale = M * (0.25 + 0.49) + INERTIA * 121.0
    # what undoing an overlap of 3 nm takes, and 0.15 nm that are always left
    turns("energy.lost", ALLOWED + np.hypot(2.0, 3.0) * (3e-9 + CLOSED) / scale, make, by=1e-3)


def test_the_work_of_a_stop_is_its_torque_times_the_rate():
    machine_ = machine(block("one"), block("two"), **{**HINGED, "joints": [
        {"type": "pin", "name": "pin", "a": "wall", "b": "one", "on_b": (0, 0)},
        {"type": "weld", "name": "weld", "a": "wall", "b": "two", "on_b": (0, 0)}]})

    def make(error):
        def change(a):
            a["joint_stop"][:, 0], a["joint_rate"][:, 0] = [0, -0.3, 0, 0], [5.0, 7.0, 5.0, 5.0]
            a["joint_stop"][:, 1] = a["joint_rate"][:, 1] = np.nan
            a["drive_work"][:, 0] = [0.0, 0.0, 0.0, 1.0]
            a["joint_damping_work"][:, 0] = np.array([0, 0.5, 1, 1]) * 2.1 * H
            a["joint_damping_work"][3, 0] -= 1.0 - error
        return still(machine_, change)
    turns("energy.lost", ALLOWED, make, by=1e-3)


def test_work_of_contacts_that_cannot_be_known_is_said_to_be_so():
    touches = [(1, 1, 0, (0.0, 0.0), (0.0, 1.0), (0.0, 0.0), 0.0)]
    figure = figures(still(hinged(), every=2, touches=touches))["energy.lost"]
    assert figure.verdict == "not computed"
    assert "not every step was recorded" in figure.why
    stopped = figures(still(hinged(), lambda a: a["joint_stop"].__setitem__((1, 0), 0.1),
                            every=2))["energy.lost"]
    assert "not every step was recorded" in stopped.why


def test_a_blow_between_two_samples_is_no_loss_though_nothing_touches():
    """A bob swings against a wall and comes back with half its speed; no sample has the contact."""
    run = simulate(Mechanism.model_validate({
        "run": {"duration": 0.3, "step": 5e-4, "sample_rate": 1000}, "gravity": (0, -9.81),
        "materials": {"hard": {"restitution": 0.5}},
        "bodies": [
            {"name": "wall", "motion": "fixed", "material": "hard",
             "shapes": [{"type": "box", "size": (0.1, 1), "at": (-0.06, -0.3)}]},
            {"name": "frame", "motion": "fixed"},
            {"name": "bob", "mass": 0.1, "at": (0.2, -0.12), "material": "hard",
             "shapes": [{"type": "circle", "radius": 0.01}]}],
        "joints": [{"type": "pin", "name": "pin", "a": "frame", "b": "bob",
                    "on_b": (-0.2, 0.12)}]}))
    assert len(run.arrays["impact_time"]) == 1
    assert len(run.arrays["contact_gap"]) == 0
    found = {figure.name: figure for figure in run.audit}
    assert found["energy.lost"].verdict == "not computed"
    assert "every step" in found["energy.lost"].why
