"""The size of a sample is that of a recording."""

from __future__ import annotations

import pytest

from sandbox.elements.arrays import MEAN, METERS, PER_SAMPLE, row_bytes
from sandbox.engine.simulate import simulate
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene


@pytest.mark.parametrize("scene", ["adaptive_grasp", "finger_joint_locks", "rope_differential"])
def test_bytes_of_a_sample_are_those_of_a_recording(scene):
    mechanism = expand(load_scene(scene, overrides={"run.duration": 0.005}))
    run = simulate(mechanism)
    kept = sum(array.nbytes for key, array in run.arrays.items()
               if len(array) == len(run) and "_contact" not in f"_{key}" and key != METERS
               and key not in MEAN)
    assert len(run) not in (len(mechanism.bodies), len(mechanism.tendons))
    assert row_bytes(mechanism, PER_SAMPLE) * len(run) == kept
