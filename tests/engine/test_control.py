"""Controllers and events in the loop: when they read, when what they write holds, who is blamed.

A rotor of inertia I under a torque that is held from act to act moves, in this
engine's leapfrog, exactly as  angle += h rate;  rate += h torque / I,  so what
a controller does to it can be worked out by hand, step by step.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.elements.controllers.custom import Custom

H, INERTIA = 5e-4, 2e-4


def rotor(*, duration: float = 0.1, start: float = 0.0, **more: Any) -> dict[str, Any]:
    return {
        "format": 1, "run": {"duration": duration, "step": H, "sample_rate": 1 / H},
        "bodies": [{"name": "base", "motion": "fixed"},
                   {"name": "rotor", "mass": 0.1, "inertia": INERTIA, "angular_velocity": start}],
        "joints": [{"type": "pin", "name": "axle", "a": "base", "b": "rotor", "on_a": [0, 0]}],
        "drives": [{"type": "torque", "name": "motor", "joint": "axle", "value": 0.01}],
        **more,
    }


def run(scene: dict[str, Any], *customs: Custom) -> sandbox.Recording:
    return sandbox.simulate(sandbox.load_scene(scene), controllers=customs)


def by_hand(law: Any, steps: int, every: int, *, start: float = 0.0, torque: float = 0.01) -> Any:
    """Angles, rates and torques of every step; ``law(t, angle, rate) -> torque``."""
    angle, rate, before = -H / 2 * start, start, start
    rows = []
    for k in range(1, steps + 1):
        if (k - 1) % every == 0:
            torque = law((k - 1) * H, angle, (before + rate) / 2)
        if k == 1:  # half a step before t = 0 on the way that it will take
            angle += H**2 / 8 * torque / INERTIA
        angle += H * rate
        before, rate = rate, rate + H * torque / INERTIA
        rows.append((angle, (before + rate) / 2, torque))
    return np.array(rows).T


@pytest.mark.parametrize("every", [1, 2, 7])
def test_a_controller_reads_the_last_step_and_writes_the_next(every):
    law = {"type": "feedback", "name": "pd", "writes": "motor",
           "value": "=0.2 * (0.5 - axle.angle) - 0.004 * axle.rate + 0.01 * sin(40 * t)",
           "rate": 1 / (every * H)}
    got = run(rotor(start=3.0, controllers=[law]))
    angle, rate, torque = by_hand(
        lambda t, q, v: 0.2 * (0.5 - q) - 0.004 * v + 0.01 * np.sin(40 * t),
        len(got), every, start=3.0)
    np.testing.assert_allclose(got["axle.angle"], angle, rtol=0, atol=1e-12)
    np.testing.assert_allclose(got["axle.rate"], rate, rtol=0, atol=1e-10)
    np.testing.assert_allclose(got["motor.value"], torque, rtol=0, atol=1e-12)


def test_by_default_a_controller_acts_a_thousand_times_a_second():
    seen: list[float] = []
    run(rotor(), Custom("watch", ["axle.angle"], ["motor"], lambda t, x: seen.append(t) or 0.0))
    np.testing.assert_allclose(seen, np.arange(100) * 1e-3, atol=1e-12)


def test_the_range_of_a_drive_limits_its_controller():
    """A brake below 0 is none: the integral waits there, and is back at once."""
    drives = [{"type": "brake", "name": "brake", "joint": "axle", "value": 0}]
    law = {"type": "pid", "name": "loop", "reads": "=t", "target": 0.05, "writes": "brake",
           "ki": -10}
    got = run(rotor(drives=drives, controllers=[law]))
    value = got["brake.value"]
    assert value.min() == 0
    # u' = 10 (t - 0.05) from the instant at which the error changes its sign
    expected = np.where(got.time < 0.05, 0.0, 5 * (got.time - 0.05) ** 2)
    np.testing.assert_allclose(value, expected, atol=10 * 0.05 * 2e-3)


def test_a_switched_off_controller_leaves_the_drive_to_its_signal():
    law = {"type": "feedback", "name": "late", "writes": "motor", "value": "=-0.02",
           "active": False}
    events = [{"name": "on", "at": "40 ms", "set": {"late.active": 1}, "lasts": "20 ms"}]
    got = run(rotor(controllers=[law], events=events))
    expected = np.where(got.time < 0.04, 0.01, -0.02)
    # switched off again, the drive keeps what it had
    assert np.array_equal(got["motor.value"], expected)


def test_a_condition_without_a_value_is_named():
    events = [{"name": "odd", "when": "=1 / (axle.angle - axle.angle) > 1", "stop": "pass"}]
    with pytest.raises(sandbox.SimulationDiverged, match="odd: its condition"):
        run(rotor(events=events))


@pytest.mark.parametrize(("first", "second", "expected"), [
    (40, 40, [0.01, 1.0, 2.0, 2.0, 2.0, 0.01]),  # the first ends before the second
    (40, 10, [0.01, 1.0, 2.0, 1.0, 0.01, 0.01]),  # the second within the first
    (40, None, [0.01, 1.0, 2.0, 2.0, 2.0, 2.0]),  # the second is for good
    (None, 25, [0.01, 1.0, 2.0, 2.0, 1.0, 1.0]),
])
def test_of_events_that_overlap_the_last_one_counts(first, second, expected):
    """Set to 1 at 10 ms and to 2 at 30 ms, for so many ms each; looked at six times."""
    events = [{"name": "one", "at": "10 ms", "set": {"motor": 1}},
              {"name": "two", "at": "30 ms", "set": {"motor": 2}}]
    for event, lasts in zip(events, (first, second), strict=True):
        if lasts is not None:
            event["lasts"] = f"{lasts} ms"
    got = run(rotor(events=events))
    looked = np.searchsorted(got.time, [0.005, 0.02, 0.035, 0.045, 0.06, 0.085])
    assert got["motor.value"][looked].tolist() == expected


@pytest.mark.parametrize(("more", "scene", "words"), [
    ({"rate": 300}, {}, "is no whole number of steps"),
    ({"rate": 4000}, {}, "more often than every step"),
    ({}, {"events": [{"name": "e", "at": 0.05, "set": {"motor": 1}}]}, "written already"),
    ({}, {"controllers": [{"type": "schedule", "name": "mine", "writes": "other", "value": 1}]},
     "another controller has this name"),
])
def test_a_callable_is_checked_like_a_controller(more, scene, words):
    mine = Custom("mine", [], ["motor"], lambda t, x: 0.0, **more)
    made = rotor(**scene)
    made["drives"].append({**made["drives"][0], "name": "other"})
    with pytest.raises(sandbox.SceneError, match=words):
        run(made, mine)


def test_an_event_may_only_mark_an_instant():
    """It is noted when its condition becomes true, at the event's rate of 1 kHz, and in plots."""
    events = [{"name": "quick", "when": "=axle.rate > 2"}, {"name": "half", "at": 0.05}]
    marked = run(rotor(start=1.0, events=events))
    bare = run(rotor(start=1.0))
    assert [one.event for one in marked.info.marked] == [
        one.event for one in marked.info.events] == ["quick", "half"]
    when, rate = marked.info.events[0].time, bare["axle.rate"]
    assert (rate[bare.time > when] > 2).all()
    assert (rate[bare.time < when - 1e-3] <= 2).all()
    assert np.array_equal(rate, marked["axle.rate"])


@pytest.mark.parametrize("order", [1, -1])
def test_divergence_names_the_unstable_control_loop(order):
    """One's reading ends as near its target as it began, the other's far off, a few acts later."""
    steady = {"type": "pid", "name": "steady", "reads": "other.value", "target": 0.1,
              "writes": "other", "kp": 0}
    wild = {"type": "pid", "name": "wrong_way", "reads": "axle.angle", "target": 0.1,
            "writes": "motor", "kp": -200}
    scene = rotor(duration=2.0, controllers=[steady, wild][::order])
    scene["drives"].append({"type": "force", "name": "other", "body": "rotor",
                            "direction": [1, 0], "value": 0})
    with pytest.raises(sandbox.SimulationDiverged, match="wrong_way") as caught:
        run(scene)
    assert caught.value.time < 0.064
    assert "axle.angle = " in str(caught.value)
    assert "motor = " in str(caught.value)
    assert len(caught.value.recording) > 10


def test_a_reading_that_is_not_a_number_is_named():
    law = {"type": "feedback", "name": "ratio", "value": "=0.1 / (axle.angle - axle.angle)",
           "writes": "motor"}
    with pytest.raises(sandbox.SimulationDiverged, match=r"ratio: it reads =0\.1 /"):
        run(rotor(controllers=[law]))


@pytest.mark.parametrize("limits", [None, (-1.0, 1.0)])
@pytest.mark.parametrize("value", [float("inf"), float("nan")])
def test_an_output_that_is_not_a_number_is_named(value, limits):
    wish = Custom("endless", ["axle.angle"], ["motor"], lambda t, x: value, limits=limits)
    with pytest.raises(sandbox.SimulationDiverged, match=r"endless: it sets motor to (inf|nan)"):
        run(rotor(), wish)
