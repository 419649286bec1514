"""What frames of a live view show, worked out anew from runs of the same scenes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.engine.inspect_control import Checked
from sandbox.engine.live import Live
from sandbox.engine.simulation import Simulation
from sandbox.web.frames import HEAD, LiveFrames, looked_at
from tests.engine.machines import H, fixed, mechanism

STEPS = 33
"""Of a frame at the usual speed."""


def told(frames: LiveFrames) -> dict[str, Any]:
    """The present frame."""
    frames.relisted()
    return decoded(frames.frame([0.0] * (len(HEAD) - 1)), frames)


def decoded(data: bytes, frames: LiveFrames) -> dict[str, Any]:
    """A frame by its names."""
    head = frames.drawing()
    numbers = np.frombuffer(data, "<f4").astype(float)
    found: dict[str, Any] = dict(zip(HEAD, numbers, strict=False))
    at = len(HEAD)

    def take(count: int) -> Any:
        nonlocal at
        at += count
        return numbers[at - count:at]

    found["pose"] = take(3 * head["frames"]).reshape(-1, 3)
    found["columns"] = take(head["columns"])
    found["drives"], found["watched"] = take(head["drives"]), take(len(frames.watched))
    counts = take(len(head["tables"])).astype(int)
    for (name, width), count in zip(head["tables"].items(), counts, strict=True):
        found[name] = take(width * count).reshape(-1, width)
    trail = int(found["trail"])
    return {**found, "places": numbers[at:].reshape(-1, trail, 2) if trail else None,
            "items": head["list"]["items"]}


def begun(machine: Any) -> LiveFrames:
    live = Live(machine)
    return LiveFrames(live, looked_at(Checked(machine), 0.2))


def test_a_contact_is_shown_on_the_object_where_the_steps_have_pushed() -> None:
    """A block hits the object beside its middle, and that the floor: means of all steps since."""
    box = {"type": "box", "size": (0.06, 0.02)}
    machine = mechanism(gravity=(0, -9.81), bodies=[
        fixed("floor", shapes=[{"type": "box", "size": (0.4, 0.02), "at": (0.0, -0.01)}]),
        {"name": "block", "at": (0.13, 0.0325), "mass": 0.3, "shapes": [box],
         "velocity": (0.2, -0.5)},
        {"name": "thing", "at": (0.1, 0.01), "mass": 0.2, "role": "object", "shapes": [box]}])
    frames, every = begun(machine), Simulation(Checked(machine))
    frames.live.step(STEPS - 1)
    first = told(frames)
    frames.live.step(STEPS)
    second = told(frames)
    every.step(2 * STEPS)
    arrays = every.recording().arrays
    rate = round(1 / (machine.run.sample_rate * H))
    assert rate == 1  # every step is a sample
    # the first frame tells all steps but the one that was made before there was any
    for frame, steps in ((first, range(1, STEPS)), (second, range(STEPS, 2 * STEPS))):
        rows = [k for k, of in enumerate(arrays["contact_sample"]) if of in steps]
        sums: dict[tuple[int, int], Any] = {}
        for k in rows:
            a, b = arrays["contact_body"][k], arrays["contact_other"][k]
            on, of, sign = (b, a, -1.0) if b == 2 else (a, b, 1.0)
            force, place = sign * arrays["contact_force"][k], arrays["contact_point"][k]
            total = sums.setdefault((on, of), [np.zeros(2), np.zeros(2), 0.0])
            size = np.hypot(*force)
            total[0], total[1] = total[0] + force, total[1] + size * place
            total[2] += size
        found = {divmod(int(row[1]), 3): row[2:] for row in frame["contacts"]}
        assert set(found) == set(sums)
        assert (2, 1) in found  # the block's push on the object
        for pair, (force, place, size) in sums.items():
            assert found[pair][2:4] == pytest.approx(force / len(steps), rel=1e-5, abs=1e-6)
            assert found[pair][:2] == pytest.approx(place / size, rel=1e-5)


def test_a_layer_is_listed_where_it_is_shown() -> None:
    """A block at rest on the floor: m g over its width."""
    box = {"type": "box", "size": (0.06, 0.02)}
    machine = mechanism(gravity=(0, -9.81), bodies=[
        fixed("floor", shapes=[{"type": "box", "size": (0.4, 0.02), "at": (0.0, -0.01)}]),
        {"name": "block", "at": (0.1, 0.01), "mass": 0.3, "shapes": [box]}])
    frames = begun(machine)
    frames.live.step(20 * STEPS)
    told(frames)
    assert frames.relisted() is None  # the page knows this list
    frames.layers = {"pressure"}
    again = frames.relisted()
    assert again is not None
    assert {item["l"] for item in again["list"]["items"]} == {"pressure"}
    [strip] = [rows for name, rows in told(frames).items() if name.startswith("pressure")]
    assert strip[0, 10] == pytest.approx(0.3 * 9.81 / 0.06, rel=0.02)


def test_a_traced_point_beside_the_middle_goes_round_with_its_body() -> None:
    machine = mechanism(bodies=[{"name": "disc", "at": (0.2, 0.1), "mass": 1.0, "inertia": 1e-3,
                                 "angular_velocity": 20.0}],
                        view={"traces": [{"body": "disc", "at": (0.03, 0.04)}]})
    frames = begun(machine)
    frames.layers = {"traces"}
    frames.live.step(STEPS)
    told(frames)
    before = frames.live["disc.angle"]
    frames.live.step(STEPS)
    [way] = told(frames)["places"]
    angles = np.unwrap(np.arctan2(way[:, 1] - 0.1, way[:, 0] - 0.2)) - np.arctan2(0.04, 0.03)
    assert np.hypot(way[:, 0] - 0.2, way[:, 1] - 0.1) == pytest.approx(0.05, abs=1e-6)
    assert (np.diff(angles) > 0).all()
    assert angles[-1] == pytest.approx(frames.live["disc.angle"], abs=1e-5)
    assert before < angles[0] <= before + 20.0 * 2 * H


def test_marks_of_a_belt_go_as_far_as_its_speed_says() -> None:
    """From rest with 2 m/s^2: t^2 metres, whatever the frames are that lie between."""
    machine = mechanism(
        bodies=[fixed("belt", shapes=[{"type": "box", "size": (4.0, 0.2)}])],
        drives=[{"type": "surface", "name": "run", "body": "belt",
                 "value": {"ramp": {"from": 0, "to": 1, "start": 0, "over": 0.5}}}])
    frames = begun(machine)
    frames.layers = {"drives"}
    places = []
    for steps in (40, 200, 40):
        frames.live.step(steps)
        found = told(frames)
        places.append((found["pose"][found["items"][0]["at"][0]][0], frames.live.time))
    (x0, t0), _, (x1, t1) = places
    assert abs(x1 - x0) == pytest.approx(t1**2 - t0**2, rel=0.01)


def test_what_begins_late_is_listed_and_a_larger_tension_extends_the_scale() -> None:
    """The trial run has no force: nothing moves and the rod carries nothing."""
    frames = begun(mechanism(
        bodies=[fixed("wall"), {"name": "bob", "at": (0.0, -0.2), "mass": 1.0, "inertia": 1e-3}],
        joints=[{"type": "rod", "name": "rod", "a": "wall", "b": "bob"}],
        drives=[{"type": "force", "name": "pull", "body": "bob", "direction": [0.6, -0.8],
                 "value": 0.0}]))
    frames.layers = {"velocity", "tensions"}
    scales = []
    for pull in (0.0, 10.0, 100.0, 10.0):
        frames.live.give("pull", pull)
        frames.live.step(STEPS)
        told(frames)
        rows = frames.drawing()["list"]["legend"]
        scales.append([float(row["after"].split()[-2]) for row in rows if row["k"] == "ramp"])
        assert any(row["l"] == "velocity" for row in rows) == (pull > 0 or len(scales) > 1)
    assert scales[0] == []
    assert 8.0 <= scales[1][0] <= 20.0 < 80.0 <= scales[2][0] == scales[3][0]
