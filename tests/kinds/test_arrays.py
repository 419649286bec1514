"""The table of arrays is what recordings hold, to the byte."""

import pytest

from sandbox.engine.simulate import simulate
from sandbox.kinds.arrays import ARRAYS, LAYOUT, METERS, PER_SAMPLE, sample_bytes
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene


@pytest.mark.parametrize("scene", ["adaptive_grasp", "finger_joint_locks", "rope_differential"])
def test_bytes_of_a_sample_are_those_of_a_recording(scene):
    mechanism = expand(load_scene(scene, overrides={"run.duration": 0.005}))
    run = simulate(mechanism)
    kept = sum(array.nbytes for key, array in run.arrays.items()
               if len(array) == len(run) and not key.startswith("contact") and key != METERS)
    assert len(run) not in (len(mechanism.bodies), len(mechanism.tendons))
    assert sample_bytes(mechanism) * len(run) == kept


def test_every_array_has_its_row():
    run = simulate(load_scene("single_finger", overrides={"run.duration": 0.002}))
    assert set(run.arrays) == set(LAYOUT)
    assert {row.name for row in ARRAYS} == {*LAYOUT, METERS}
    assert len({row.name for row in ARRAYS}) == len(ARRAYS)
    assert all(row.about and (row.unit or row.element is not float) for row in ARRAYS)
    assert next(iter(PER_SAMPLE)) == "time"
