"""Expectations, meters and outcomes of runs."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from sandbox.samples.expectations import verdicts
from sandbox.samples.outcome import (
    Happened,
    Outcome,
    Status,
    Stop,
    outcome_data,
    planned,
    read_outcome,
)
from sandbox.scene.settings import Run
from tests.recording.sample import CONTACTS, H, N, recording


def judge(expect, *, contacts=CONTACTS, **options):
    return verdicts(recording(contacts=contacts, expect=[expect], **options))


def ramp(**options):
    """The meter ``r`` is 0.5, 1.5, ... 19.5 over the samples: t / H."""
    options.setdefault("meters", [{"name": "r", "value": f"=t / {H}", "unit": "N"}])
    return options


@pytest.mark.parametrize(("name", "over", "value"), [
    ("mean", [0, None], N / 2),
    ("final", [0, None], 19.5),
    ("std", [0, None], math.sqrt((N**2 - 1) / 12)),  # of 1..N, population
    ("min", [0.1, 0.15], 10.5),
    ("final", [0.1, 0.15], 14.5),
    ("mean", [0.105, 0.115], 11.0),  # both ends are samples, both count
    ("min", "last 50 ms", 14.5),  # back from the last sample, at 0.195 s
    ("mean", "last 0 s", 19.5),
])
def test_statistics_over_windows(name, over, value):
    [verdict] = judge({name: "r", "over": over, "is": value, "within": 1e-9}, **ramp())
    # t / H has one rounding of 2e-16 relative; sums of 20 terms stay below 1e-12
    assert verdict.value == pytest.approx(value, abs=1e-12)
    assert verdict.ok
    assert verdict.reason == ""
    assert (verdict.quantity, verdict.statistic, verdict.unit) == ("r", name, "N")


@pytest.mark.parametrize(("at", "value"), [
    (0.105, 10.5), (0.1075, 10.75), ("110 ms", 11.0), (0.0, 0.0), (0.2, 20.0)])
def test_a_value_at_an_instant_lies_on_the_line_of_the_samples_about_it(at, value):
    """The ramp is straight, so that every instant is exact, those beyond the samples too."""
    [verdict] = judge({"quantity": "r", "at": at, "is": value, "within": 1e-9}, **ramp())
    assert verdict.value == pytest.approx(value, abs=1e-12)
    assert (verdict.ok, verdict.reason) == (True, "")
    assert verdict.statistic.startswith("at ")


@pytest.mark.parametrize(("bounds", "low", "high", "ok"), [
    ({"is": 20, "within": "2.5 %"}, 19.5, 20.5, True),
    ({"is": 20, "within": 0.4}, 19.6, 20.4, False),
    ({"between": [19, 20]}, 19, 20, True),
    ({"between": [20, 21]}, 20, 21, False),
    ({"above": 19}, 19, math.inf, True),
    ({"below": 19}, -math.inf, 19, False),
    ({"above": 19, "below": 20}, 19, 20, True),
])
def test_ranges(bounds, low, high, ok):
    [verdict] = judge({"max": "r", "because": "a ramp", **bounds}, **ramp())
    assert (verdict.low, verdict.high) == pytest.approx((low, high), rel=1e-15)
    assert verdict.ok is ok
    assert verdict.because == "a ramp"
    assert isinstance(verdict.ok, bool)
    assert isinstance(verdict.value, float)


@pytest.mark.parametrize(("expect", "options", "reason"), [
    ({"max": "r", "over": [0.101, 0.104], "below": 99}, ramp(), "no sample lies in the window"),
    ({"max": "disc.xx", "below": 99}, {},
     "unknown quantity 'disc.xx'; did you mean 'disc.x'?"),
    ({"min": "q", "above": -99}, ramp(meters=[{"name": "q", "value": "=1 / disc.contact.normal"}]),
     "17 of 20 samples have no value"),
    ({"min": "r", "over": [0, 0.5], "above": -99}, ramp(),
     "the window ends at 0.5 s, the run at 0.2 s"),
    ({"quantity": "r", "at": 0.3, "above": -99}, ramp(),
     "the instant is 0.3 s, the run ends at 0.2 s"),
    ({"min": "r", "over": "last 0.3 s", "above": -99}, ramp(),
     "the window is the last 0.3 s, the run has 0.2 s"),
])
def test_nothing_passes_by_silence(expect, options, reason):
    [verdict] = judge(expect, **options)
    assert not verdict.ok
    assert verdict.reason == reason


def test_a_run_that_stopped_early_fails_what_it_did_not_reach():
    options = {**ramp(), "n": 10, "info": {"complete": False}}
    [whole] = judge({"max": "r", "below": 99}, **options)
    assert not whole.ok
    assert whole.value == pytest.approx(9.5)
    assert whole.reason == "the run stopped at 0.095 s, before its end"
    [last] = judge({"max": "r", "over": "last 20 ms", "below": 99}, **options)
    [beyond] = judge({"max": "r", "over": [0.05, 0.15], "below": 99}, **options)
    [within] = judge({"max": "r", "over": [0, 0.05], "below": 99}, **options)
    assert (last.ok, beyond.ok, within.ok) == (False, False, True)
    assert [judge({"quantity": "r", "at": at, "below": 99}, **options)[0].ok
            for at in (0.05, 0.15)] == [True, False]


def test_a_run_that_an_event_stopped_fails_what_it_did_not_reach():
    stop = Stop("far", "pass", 0.1)
    options = {**ramp(), "n": 10, "info": {"stopped": stop}}
    beyond, verdict = judge({"max": "r", "over": [0.05, 0.15], "below": 99}, **options)
    assert (beyond.ok, verdict.ok) == (False, True)
    assert beyond.reason == "the event far stopped the run before 0.15 s"
    for over in ([0, 0.1], [0.05, None]):
        assert judge({"max": "r", "over": over, "below": 99}, **options)[0].ok


@pytest.mark.parametrize(("given", "allowed", "ok"), [
    ({"max": "finger1.contact.count", "is": 1}, "1", True),
    ({"mean": "finger1.contact.count", "is": 3}, "2.997 to 3.003", False),
    ({"max": "finger1.contact.count", "is": 1, "within": 0.5}, "0.5 to 1.5", True),
    ({"max": "finger1.contact.count", "is": 2000}, "1998 to 2002", False),
])
def test_the_range_of_a_count_is_that_count(given, allowed, ok):
    """Between 2.997 and 3.003 there is no other one."""
    verdict, = judge(given)
    assert (verdict.allowed, verdict.ok) == (allowed, ok)


# --- meters


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


# --- outcomes


RUN = Run(duration=0.1, step=1e-3, sample_rate=500.0)
STOP = Stop("far", "pass", 0.05)


@pytest.mark.parametrize(("status", "reason", "stopped", "complete"), [
    (Status.DONE, "", None, True),
    (Status.STOPPED, "", STOP, True),
    (Status.INTERRUPTED, "interrupted", None, False),
    (Status.INTERRUPTED, "interrupted", STOP, False),
    (Status.DIVERGED, "the simulation diverged at t = 1 s: wild", None, False),
    (Status.UNFINISHED, "", None, False),
])
def test_a_status_is_what_the_files_say(status, reason, stopped, complete):
    outcome = replace(planned(RUN), complete=complete, reason=reason, stopped=stopped)
    assert outcome.status is status
    again = read_outcome(json.loads(json.dumps(outcome_data(outcome))), RUN)
    assert again == outcome


def test_every_field_goes_there_and_back():
    outcome = Outcome(
        step=2e-3, steps=50, sample_rate=250.0, seed=3,
        versions={"python": "3"}, wall={"build": 0.5}, events=(Happened("far", 0.05),),
        broke=(Happened("rod", 0.0425),), stopped=Stop("far", "fail", 0.05, "too far"),
        controllers={"c": {"tuned": False}}, notes=("one", "two"))
    assert read_outcome(outcome_data(outcome), RUN) == outcome
    assert outcome != planned(RUN)
    assert outcome.marked == [Happened("rod broke", 0.0425), Happened("far", 0.05)]
    assert set(outcome_data(outcome)) == set(outcome_data(planned(RUN)))
