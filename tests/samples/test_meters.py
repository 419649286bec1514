import numpy as np
import pytest

from sandbox.samples.meters import order
from tests.recording.sample import CONTACTS, N, mechanism, recording


def meters(**values):
    return [{"name": name, "value": value, "unit": "rad"} for name, value in values.items()]


def test_a_meter_is_its_expression_sample_by_sample():
    run = recording(meters=meters(
        closure="=finger1.mcp.angle + 2 * finger1.pip.angle", half="=closure / 2", one="=1"))
    expected = run["finger1.mcp.angle"] + 2 * run["finger1.pip.angle"]
    assert np.array_equal(run["closure"], expected)
    assert np.array_equal(run["half"], expected / 2)
    assert np.array_equal(run["one"], np.ones(N))
    assert run.unit("closure") == "rad"
    assert run.notes == []


def test_order_does_not_depend_on_where_a_meter_stands():
    run = recording(meters=meters(c="=b + 1", b="=a + 1", a="=disc.x"))
    assert np.array_equal(run["c"], run["disc.x"] + 1 + 1)
    assert order(run.mechanism) == ([2, 1, 0], [])


def test_a_division_by_zero_is_nan_there_and_noted():
    run = recording(contacts=CONTACTS, meters=meters(
        share="=finger1.proximal.contact.normal / disc.contact.normal", after="=share * 2"))
    # the disc is touched in samples 1, 2 and 3 of 20
    assert np.flatnonzero(np.isfinite(run["share"])).tolist() == [1, 2, 3]
    assert run["share"][1] == pytest.approx(1 / 3, rel=1e-15)
    assert run.notes == [
        "meter 'share' has no finite value in 17 of 20 samples, first at t = 0.005 s",
        "meter 'after' has no finite value in 17 of 20 samples, first at t = 0.005 s"]


@pytest.mark.parametrize(("value", "reason"), [
    ("=nobody.x", "unknown quantity 'nobody.x'"),
    ("=m", "it depends on itself"),
    ("=2 ** (100 * t + 64)", "an exponent is at most 64"),
])
def test_a_meter_without_any_value_does_not_lose_the_run(value, reason):
    run = recording(meters=meters(m=value, good="=disc.x"))
    assert np.isnan(run["m"]).all()
    assert np.array_equal(run["good"], run["disc.x"])
    [note] = run.notes
    assert note.startswith("meter 'm' has no value: ")
    assert reason in note


def test_every_circle_is_found_once():
    mech = mechanism(meters=meters(a="=b", b="=a", c="=d", d="=h", h="=c", f="=a", g="=1"))
    assert order(mech) == ([6], [[0, 1], [2, 3, 4]])
    run = recording(mech=mech)
    assert np.isnan(run["f"]).all()
    assert len(run.notes) == 5
