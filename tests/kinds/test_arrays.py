"""The table of arrays is what recordings hold, to the byte."""

import pytest

from sandbox.engine.simulate import simulate
from sandbox.kinds.arrays import ARRAYS, LATE, LAYOUT, METERS, PER_SAMPLE, sample_bytes
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


FIRST = {
    "time", "body_pose", "body_velocity", "body_acceleration", "joint_angle", "joint_rate",
    "joint_reaction", "joint_stop", "joint_damping", "joint_damping_work", "spring_length",
    "spring_force", "spring_work", "tendon_length", "tendon_tension", "tendon_work",
    "drive_value", "drive_work", "body_centre", "body_mass", "body_inertia", "tendon_initial",
    "tendon_rest", "contact_sample", "contact_body", "contact_other", "contact_point",
    "contact_force", "contact_normal", "contact_gap",
}


def test_every_array_that_the_first_recordings_lack_is_late():
    """Otherwise recordings that were made before it could not be read any more."""
    assert set(LAYOUT) - FIRST == set(LATE)
    assert set(LAYOUT) >= FIRST
