import numpy as np
import pytest

from sandbox.errors import SandboxError
from sandbox.model.catalogue import UnknownQuantityError
from sandbox.recording.recording import Recording

from .sample import CONTACTS, DISTAL, INFO, N, arrays, mechanism, recording


@pytest.fixture(scope="module")
def run():
    return recording(contacts=CONTACTS)


@pytest.mark.parametrize(("name", "unit", "read"), [
    ("finger1.distal.x", "m", lambda a: a["body_pose"][:, DISTAL, 0]),
    ("finger1.distal.angle", "rad", lambda a: a["body_pose"][:, DISTAL, 2]),
    ("finger1.distal.vx", "m/s", lambda a: a["body_velocity"][:, DISTAL, 0]),
    ("finger1.distal.omega", "rad/s", lambda a: a["body_velocity"][:, DISTAL, 2]),
    ("finger1.distal.alpha", "rad/s^2", lambda a: a["body_acceleration"][:, DISTAL, 2]),
    ("finger1.pip.rate", "rad/s", lambda a: a["joint_rate"][:, 1]),
    ("leash.reaction", "N", lambda a: a["joint_reaction"][:, 2]),
    ("finger1.mcp.stop", "N m", lambda a: a["joint_stop"][:, 0]),
    ("finger1.mcp.damping", "N m", lambda a: a["joint_damping"][:, 0]),
    ("finger1.mcp.damping_work", "J", lambda a: a["joint_damping_work"][:, 0]),
    ("actuator.work", "J", lambda a: a["drive_work"][:, 0]),
    ("return.force", "N", lambda a: a["spring_force"][:, 0]),
    ("coil.angle", "rad", lambda a: a["spring_length"][:, 1]),
    ("coil.torque", "N m", lambda a: a["spring_force"][:, 1]),
    ("finger1.tendon.length", "m", lambda a: a["tendon_length"][:, 0]),
    ("finger1.tendon.shortening", "m", lambda a: a["tendon_initial"][0] - a["tendon_length"][:, 0]),
    ("finger1.tendon.tension", "N", lambda a: a["tendon_tension"][:, 0]),
    ("swell.value", "m", lambda a: a["drive_value"][:, 3]),
])
def test_each_quantity_is_its_column(run, name, unit, read):
    assert np.array_equal(run[name], read(arrays(run.mechanism)))
    assert run.unit(name) == unit
    assert name in run.names()


def test_every_name_can_be_read_and_is_a_plain_array(run):
    assert len(run.names()) == len(set(run.names())) == 6 * 13 + 7 + 8 + 4 + 6 + 4 + 9 + 2
    for name in run.names():
        assert run[name].shape == (N,)
        assert not run[name].flags.writeable


def test_an_unknown_name_is_a_key_error_with_a_near_miss(run):
    with pytest.raises(UnknownQuantityError) as caught:
        run["finger1.tendon.tensoin"]
    assert isinstance(caught.value, (KeyError, SandboxError))
    assert str(caught.value) == (
        "unknown quantity 'finger1.tendon.tensoin'; did you mean 'finger1.tendon.tension'?")
    with pytest.raises(UnknownQuantityError):
        run.unit("nothing.like.it")
    assert "nothing.like.it" not in run
    assert "disc.x" in run


def test_arrays_are_not_to_be_written(run):
    with pytest.raises(ValueError, match="read-only"):
        run.arrays["time"][0] = 3


def test_arrays_that_do_not_fit_are_refused():
    mech = mechanism()
    with pytest.raises(ValueError, match="'body_pose' is missing"):
        Recording(mech, {k: v for k, v in arrays(mech).items() if k != "body_pose"}, INFO)
    with pytest.raises(ValueError, match=r"'drive_value' has shape \(20, 3\), expected \(20, 4\)"):
        Recording(mech, {**arrays(mech), "drive_value": np.zeros((N, 3))}, INFO)
    wild = arrays(mech, contacts=CONTACTS)
    wild["contact_other"][0] = 6
    with pytest.raises(ValueError, match=r"'contact_other' points outside 0..5"):
        Recording(mech, wild, INFO)


def test_table_puts_a_kind_side_by_side(run):
    table = run.table("tendons")
    assert table.names == ["finger1.tendon.length", "finger1.tendon.shortening",
                           "finger1.tendon.tension", "finger1.tendon.work"]
    assert table.units == ["m", "m", "N", "J"]
    for name, column in zip(table.names, table.values.T, strict=True):
        assert np.array_equal(column, run[name])
    assert run.table("meters").values.shape == (N, 0)


@pytest.mark.parametrize("size", [1, 7, 1000])
def test_pieces_put_together_are_the_whole(size):
    run = recording(contacts=CONTACTS, meters=[{"name": "sum", "value": "=disc.x + t"}])
    for name in [*run.names(), "finger1.distal/disc.normal"]:
        joined = np.concatenate([part[name] for part in run.parts(size)])
        if ".reaction_" in name:  # worked out anew; numpy's sine depends on an array's length
            assert joined == pytest.approx(run[name], rel=1e-12, nan_ok=True), name
            continue
        assert np.array_equal(joined, run[name]), name


def test_a_run_without_samples_or_elements_is_still_a_recording():
    run = recording(n=0)
    assert len(run) == 0
    assert run["disc.contact.normal"].shape == (0,)
    empty = recording(mech=mechanism().model_copy(update={
        key: () for key in ("bodies", "joints", "springs", "tendons", "drives", "groups")}))
    assert empty.names() == []
    assert empty.table("bodies").values.shape == (N, 0)
