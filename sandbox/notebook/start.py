"""A mechanism as it stands at t = 0, before anything acts: what a picture of a scene shows."""

from __future__ import annotations

import numpy as np

from sandbox.model.anchors import apart
from sandbox.model.compile import compile_mechanism
from sandbox.recording.builder import RecordingBuilder
from sandbox.recording.recording import Recording
from sandbox.samples.cords import lengths_at_start
from sandbox.samples.outcome import Status, planned
from sandbox.samples.targets import initial
from sandbox.scene.mechanism import Mechanism


def at_start(mechanism: Mechanism) -> Recording:
    """One sample, at t = 0, with all that a picture needs: no force acts, cords are taut.

    There are poses, drives, lengths of cords and actuators, and what holds; all else is 0. No step
    is made, so nothing has to be compiled.
    """
    model = compile_mechanism(mechanism)
    lengths = lengths_at_start(model)
    builder = RecordingBuilder(mechanism, 1, {
        "body_centre": model.bodies.centre, "body_mass": model.bodies.mass,
        "body_inertia": model.bodies.inertia, "tendon_initial": lengths, "tendon_rest": lengths,
    }, model=model)
    arrays = {key: np.zeros_like(array) for key, array in builder.blank(1).items()}
    arrays["body_pose"][0] = model.bodies.pose
    arrays["tendon_length"][0] = lengths
    joints = np.arange(len(model.joints.name))
    arrays["joint_length"][0] = np.hypot(*apart(model, joints, model.bodies.pose))
    arrays["held"][0] = [not each.released for each in mechanism.holding
                         if each.name in mechanism.releasable]
    builder.put(0, arrays)
    run = builder.finish(np.zeros(1), planned(mechanism.run, Status.UNFINISHED))
    values = np.array([[initial(run, drive.name) for drive in mechanism.drives]])
    return Recording(mechanism, {**run.arrays, "drive_value": values.reshape(1, -1)}, run.info,
                     model=model)
