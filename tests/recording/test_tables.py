import csv
import io
import math

import numpy as np
import pytest

from sandbox.recording import tables
from sandbox.recording.tables import column, column_unit, contact_rows, rows

from .sample import CONTACTS, N, S, arrays, mechanism, recording


def parsed(pieces):
    head, *body = csv.reader(io.StringIO("".join(pieces)))
    return head, body


@pytest.mark.parametrize(("unit", "spelled"), [
    ("m", "m"), ("N m", "N_m"), ("N·m", "N_m"),
    ("m/s^2", "m_per_s2"), ("rad / s²", "rad_per_s2"), ("1", ""),
    ("%", "percent"), ("1/s", "per_s"), ("N m s/rad", "N_m_s_per_rad"),
])
def test_units_are_spelled_for_columns(unit, spelled):
    assert column_unit(unit) == spelled
    assert column("a.b", unit) == ("a.b_" + spelled if spelled else "a.b")


@pytest.mark.parametrize(("kind", "heads"), [
    ("springs", "return.length_m return.force_N return.work_J coil.angle_rad coil.torque_N_m "
                "coil.work_J"),
    ("meters", "m_N plain"),
])
def test_headers(kind, heads):
    run = recording(meters=[{"name": "m", "value": "=disc.x", "unit": "N"},
                            {"name": "plain", "value": "=disc.x"}])
    assert parsed(rows(run, kind))[0] == ["time_s", *heads.split()]


def test_numbers_read_back_to_twelve_digits(monkeypatch):
    monkeypatch.setattr(tables, "BLOCK", 50)  # several pieces
    run = recording(contacts=CONTACTS)
    _, body = parsed(rows(run, "bodies"))
    values = np.array(body, dtype=float)
    assert values.shape == (N, 1 + 5 * 13)
    expected = np.column_stack([run.time, run.table("bodies").values])
    # half a unit of the twelfth digit of a mantissa that is at least 1
    assert np.all(np.abs(values - expected) <= 5e-12 * np.abs(expected))


def test_contacts_are_one_row_per_pair_and_sample(monkeypatch):
    monkeypatch.setattr(tables, "BLOCK", 64)  # one sample a piece
    text = "".join(contact_rows(recording(contacts=CONTACTS)))
    lines = text.splitlines()
    assert lines[0] == "time_s,body,other,x_m,y_m,fx_N,fy_N,normal_N,tangential_N"
    assert lines[1] == "0.015,finger1.distal,disc,0,0,-0.5,3,3,0.5"
    assert lines[2] == "0.015,finger1.proximal,finger1.distal,0.001,-0.002,0,-1,1,0"
    assert lines[3] == f"0.025,finger1.proximal,disc,0.002,-0.004,2,0,{2 * S:.12g},-{2 * S:.12g}"
    assert lines[4] == "0.025,disc,palm,0.003,-0.006,0.25,4,4,-0.25"
    assert len(lines) == 1 + len(CONTACTS)
    assert text.endswith("\n")


def test_a_zero_has_no_sign_and_no_value_is_nan():
    mech = mechanism()
    content = arrays(mech)
    content["tendon_tension"][:] = -0.0
    content["tendon_length"][:, 0] = math.nan
    run = type(recording())(mech, content, {})
    _, body = parsed(rows(run, "tendons"))
    assert [row[1:4] for row in body] == [["nan", "nan", "0"]] * N
