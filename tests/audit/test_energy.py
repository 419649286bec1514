"""Energy: what is summed up, with which sign, and how much of it may be left over.

Where nothing moves that could err by a step: 1e-9 of what was turned over.
"""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene
from tests.audit.still import block, figures, machine, still, turns

ALLOWED, M = 1e-9, 0.2
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


def test_a_faulty_velocity_does_not_widen_its_own_tolerance():
    """The beam of the trebuchet is 1e-3 of its largest speed too fast in one sample."""
    run = simulate(load_scene("trebuchet"))
    velocity = run.arrays["body_velocity"].copy()
    beam = [body.name for body in run.mechanism.bodies].index("beam")
    velocity[2465, beam, 1] += 1e-3 * np.abs(velocity[:, beam, 1]).max()
    found = {figure.name: figure for figure in audit(
        Recording(run.mechanism, {**run.arrays, "body_velocity": velocity}, run.info))}
    assert found["energy.created"].verdict == "look"
    assert {figure.verdict for figure in run.audit} == {"pass", "not computed"}
