"""Recordings: names, patterns, parts and tables."""

import csv
import io

import numpy as np
import pytest

import sandbox
from sandbox.errors import SandboxError
from sandbox.model.catalogue import MixedUnitsError, UnknownQuantityError
from sandbox.recording import store
from sandbox.recording.recording import Recording
from sandbox.recording.store import column, contact_rows, rows

from .sample import CONTACTS, INFO, N, S, arrays, mechanism, recording


@pytest.fixture(scope="module")
def run():
    return recording(contacts=CONTACTS)


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


@pytest.mark.parametrize("size", [1, 7, 1000])
def test_pieces_put_together_are_the_whole(size):
    run = recording(contacts=CONTACTS, meters=[{"name": "sum", "value": "=disc.x + t"}])
    for name in [*run.names(), "finger1.distal/disc.normal"]:
        joined = np.concatenate([part[name] for part in (
            run.part(first, first + size) for first in range(0, len(run), size))])
        if ".reaction_" in name:  # worked out anew; numpy's sine depends on an array's length
            assert joined == pytest.approx(run[name], rel=1e-12, nan_ok=True), name
            continue
        assert np.array_equal(joined, run[name]), name


# --- patterns and data frames


@pytest.fixture(scope="module")
def finger_run() -> sandbox.Recording:
    return sandbox.simulate(sandbox.load_scene("single_finger", overrides={"run.duration": 0.05}))


def test_a_pattern_gives_columns(finger_run: sandbox.Recording) -> None:
    names = finger_run.names("finger.*p.angle")
    assert names == ["finger.mcp.angle", "finger.pip.angle", "finger.dip.angle"]
    assert finger_run["finger.*p.angle"].shape == (len(finger_run), 3)
    for i, name in enumerate(names):
        np.testing.assert_array_equal(finger_run["finger.*p.angle"][:, i], finger_run[name])
    assert finger_run.unit("finger.*p.angle") == "rad"
    assert "finger.*p.angle" in finger_run
    assert finger_run["finger.*/disc.normal"].shape[0] == len(finger_run)


def test_a_pattern_that_fits_nothing_or_several_units(finger_run: sandbox.Recording) -> None:
    for ask in (finger_run.__getitem__, finger_run.names, finger_run.unit):
        with pytest.raises(sandbox.SandboxError, match=r"no quantity fits 'finger\.\*\.angel'; did "
                                                       r"you mean 'finger\.\*\.angle'\?"):
            ask("finger.*.angel")
    with pytest.raises(sandbox.SandboxError, match=r"did you mean 'finger\.\*\.angle'\?"):
        finger_run.names("fingr.*.angle")
    assert "finger.*.angel" not in finger_run
    for ask in (finger_run.__getitem__, finger_run.unit):
        with pytest.raises(MixedUnitsError, match=r"'disc\.\*' fits quantities of \d units"):
            ask("disc.*")


def test_with_the_libraries_themselves(finger_run: sandbox.Recording) -> None:
    table = finger_run.to_pandas()
    assert len(table) == len(finger_run)
    assert "finger.tendon.tension" in table
    np.testing.assert_array_equal(table["finger.mcp.angle"], finger_run["finger.mcp.angle"])
    xarray = pytest.importorskip("xarray", reason="xarray is not installed")
    data = finger_run.to_xarray("finger.mcp.angle")
    assert isinstance(data, xarray.Dataset)
    np.testing.assert_array_equal(table["finger.mcp.angle"], data["finger.mcp.angle"])


# --- tables in files


def parsed(pieces):
    head, *body = csv.reader(io.StringIO("".join(pieces)))
    return head, body


@pytest.mark.parametrize(("unit", "spelled"), [
    ("m", "m"), ("N m", "N_m"), ("N·m", "N_m"),
    ("m/s^2", "m_per_s2"), ("rad / s²", "rad_per_s2"), ("1", ""),
    ("%", "percent"), ("1/s", "per_s"), ("N m s/rad", "N_m_s_per_rad"),
])
def test_units_are_spelled_for_columns(unit, spelled):
    assert column("a.b", unit) == ("a.b_" + spelled if spelled else "a.b")


def test_numbers_read_back_to_twelve_digits(monkeypatch):
    monkeypatch.setattr(store, "BLOCK", 50)  # several pieces
    run = recording(contacts=CONTACTS)
    _, body = parsed(rows(run, "bodies"))
    values = np.array(body, dtype=float)
    assert values.shape == (N, 1 + 5 * 13)
    expected = np.column_stack([run.time, run.table("bodies").values])
    # half a unit of the twelfth digit of a mantissa that is at least 1
    assert np.all(np.abs(values - expected) <= 5e-12 * np.abs(expected))


def test_contacts_are_one_row_per_pair_and_sample(monkeypatch):
    monkeypatch.setattr(store, "BLOCK", 64)  # one sample a piece
    text = "".join(contact_rows(recording(contacts=CONTACTS)))
    lines = text.splitlines()
    assert lines[0] == "time_s,body,other,x_m,y_m,fx_N,fy_N,normal_N,tangential_N"
    assert lines[1] == "0.015,finger1.distal,disc,0,0,-0.5,3,3,0.5"
    assert lines[2] == "0.015,finger1.proximal,finger1.distal,0.001,-0.002,0,-1,1,0"
    assert lines[3] == f"0.025,finger1.proximal,disc,0.002,-0.004,2,0,{2 * S:.12g},-{2 * S:.12g}"
    assert lines[4] == "0.025,disc,palm,0.003,-0.006,0.25,4,4,-0.25"
    assert len(lines) == 1 + len(CONTACTS)
    assert text.endswith("\n")
