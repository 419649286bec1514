"""The table of arrays is what recordings hold, to the byte."""

import pytest

from sandbox.elements.arrays import (
    ARRAYS,
    IMPACT,
    LAYOUT,
    MEAN,
    MEAN_CONTACT,
    METERS,
    PER_SAMPLE,
    row_bytes,
)
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


def test_every_array_has_its_row():
    means = {*MEAN, *MEAN_CONTACT}
    for rate, more in (("1 kHz", means), ("2 kHz", set())):
        run = simulate(load_scene("single_finger", overrides={
            "run.duration": 0.002, "run.step": "0.5 ms", "run.sample_rate": rate}))
        assert set(run.arrays) == {*LAYOUT, *IMPACT, *more}
    assert {row.name for row in ARRAYS} == {*LAYOUT, *IMPACT, *means, METERS}
    assert len({row.name for row in ARRAYS}) == len(ARRAYS)
    assert all(row.about and (row.unit or row.element is not float) for row in ARRAYS)
    assert next(iter(PER_SAMPLE)) == "time"
