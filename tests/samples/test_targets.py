"""What controllers lead to what, read off a recording."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.samples.outcome import Happened
from sandbox.samples.targets import controlled, initial, led, responses, start, targets, track
from tests.samples.controlled import STIFFNESS, TARGETS, recording, scene

ANGLES = [f"finger.{joint}.angle" for joint in ("mcp", "pip", "dip")]


def loop(**changes: object) -> dict[str, object]:
    return {"type": "pid", "name": "loop", "writes": "pull", "reads": "finger.tendon.shortening",
            "target": 0.003, "kp": 1.0, **changes}


def test_targets_of_controllers() -> None:
    run = recording()
    found = targets(run)
    assert list(found) == ANGLES
    for name, goal in zip(ANGLES, TARGETS, strict=True):
        assert found[name] == pytest.approx(np.full(len(run), goal))
    assert led(run) == ANGLES
    assert controlled(run) == ["k1", "k2", "k3"]


def test_meters_hold_targets_where_nothing_leads() -> None:
    meters = [{"name": "finger.mcp.angle.target", "value": "=0.3 * t", "unit": "rad"},
              {"name": "nothing.target", "value": "=1"}]
    run = recording(scene(controllers=[loop()], meters=meters))
    found = targets(run)
    assert set(found) == {"finger.tendon.shortening", "finger.mcp.angle"}
    assert found["finger.mcp.angle"] == pytest.approx(0.3 * run.time)
    assert led(run) == ["finger.tendon.shortening"]
    # a controller's target counts more, one by hand most
    run = recording(scene(meters=meters))
    assert targets(run)["finger.mcp.angle"][0] == pytest.approx(TARGETS[0])
    assert targets(run, {"finger.mcp.angle": 0.5, "no.such": 1})["finger.mcp.angle"][0] == 0.5
    assert "no.such" not in targets(run, {"no.such": 1.0})


@pytest.mark.parametrize(("lasts", "after"), [(None, 0.001), (0.5, 0.003)])
def test_events_change_targets(lasts: float | None, after: float) -> None:
    event = {"name": "less", "at": 1.0, "set": {"loop.target": 0.001},
             **({"lasts": lasts} if lasts else {})}
    told = {"events": (Happened("less", 1.0), Happened("gone", 2.0))}
    run = recording(scene(controllers=[loop()], events=[event]), info=told)
    goal = targets(run)["finger.tendon.shortening"]
    assert goal[np.searchsorted(run.time, 0.999)] == 0.003
    assert goal[np.searchsorted(run.time, 1.001)] == 0.001
    assert goal[-1] == after
    # an event that did not happen changes nothing
    run = recording(scene(controllers=[loop()], events=[event]))
    assert np.ptp(targets(run)["finger.tendon.shortening"]) == 0


def test_where_things_start() -> None:
    run = recording()
    assert [start(run, name) for name in ANGLES] == pytest.approx([0, 0, 0])
    assert start(run, "finger.tendon.shortening") == 0
    assert start(run, "k2.value") == STIFFNESS[1]
    assert start(run, "pull.value") == initial(run, "pull") == 15
    assert start(run, "finger.distal.x") == pytest.approx(0.071)
    assert start(run, "finger.tendon.tension") is None
    assert start(run, "finger.mcp.rate") is None


def test_a_track_begins_at_zero_if_it_can() -> None:
    run = recording()
    time, value, target = track(run, "finger.dip.angle", targets(run)["finger.dip.angle"])
    assert target is not None
    assert len(time) == len(value) == len(target) == len(run) + 1
    assert (time[0], value[0], target[0]) == (0, pytest.approx(0), pytest.approx(TARGETS[2]))
    assert len(track(run, "finger.tendon.tension").time) == len(run)


def test_a_step_is_counted_from_its_beginning() -> None:
    """A response so quick that the first sample is already half way."""
    run = recording(omega=2000, zeta=0.5)
    assert run["finger.mcp.angle"][0] > 0.3 * TARGETS[0]
    found = responses(run, targets(run))["finger.mcp.angle"]
    assert found.start == pytest.approx(0)
    highest = run["finger.mcp.angle"].max() / TARGETS[0]
    assert found.overshoot == pytest.approx(100 * (highest - 1))
