"""Energy between samples, and a fault in one of them."""

from __future__ import annotations

import numpy as np

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene


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
