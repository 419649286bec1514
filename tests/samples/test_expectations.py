import math

import pytest

from sandbox.samples.expectations import verdicts
from sandbox.samples.outcome import Status, Stop
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


def test_a_pattern_gives_a_verdict_for_every_match():
    found = judge({"max": "finger1.*.contact.normal", "between": [3, 5]})
    assert [(v.quantity, v.ok) for v in found] == [
        ("finger1.proximal.contact.normal", False), ("finger1.distal.contact.normal", True)]
    assert [v.value for v in found] == pytest.approx([math.sqrt(2), 4.0])


@pytest.mark.parametrize(("expect", "options", "reason"), [
    ({"max": "r", "over": [0.101, 0.104], "below": 99}, ramp(), "no sample lies in the window"),
    ({"max": "r", "over": [0.15, 0.1], "below": 99}, ramp(), "no sample lies in the window"),
    ({"max": "r", "below": 99}, {**ramp(), "n": 0, "contacts": ()}, "no sample lies in the window"),
    ({"max": "disc.xx", "below": 99}, {},
     "unknown quantity 'disc.xx'; did you mean 'disc.x'?"),
    ({"max": "disc*.omgea", "below": 99}, {},
     "no quantity fits; did you mean 'disc*.omega'?"),
    ({"min": "q", "above": -99}, ramp(meters=[{"name": "q", "value": "=1 / disc.contact.normal"}]),
     "17 of 20 samples have no value"),
    ({"min": "r", "over": [0, 0.5], "above": -99}, ramp(),
     "the window ends at 0.5 s, the run at 0.2 s"),
    ({"min": "r", "over": "last 0.3 s", "above": -99}, ramp(),
     "the window is the last 0.3 s, the run has 0.2 s"),
])
def test_nothing_passes_by_silence(expect, options, reason):
    [verdict] = judge(expect, **options)
    assert not verdict.ok
    assert verdict.reason == reason


def test_a_run_that_stopped_early_fails_what_it_did_not_reach():
    options = {**ramp(), "n": 10, "info": {"status": Status.UNFINISHED}}
    [whole] = judge({"max": "r", "below": 99}, **options)
    assert not whole.ok
    assert whole.value == pytest.approx(9.5)
    assert whole.reason == "the run stopped at 0.095 s, before its end"
    [last] = judge({"max": "r", "over": "last 20 ms", "below": 99}, **options)
    [beyond] = judge({"max": "r", "over": [0.05, 0.15], "below": 99}, **options)
    [within] = judge({"max": "r", "over": [0, 0.05], "below": 99}, **options)
    assert (last.ok, beyond.ok, within.ok) == (False, False, True)


def test_a_run_that_an_event_stopped_fails_what_it_did_not_reach():
    stop = Stop("far", "pass", 0.1)
    options = {**ramp(), "n": 10, "info": {"status": Status.STOPPED, "stopped": stop}}
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
