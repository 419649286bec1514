"""What frames of a live view show, worked out anew from runs of the same scenes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.engine.inspect_control import Checked
from sandbox.engine.live import Live
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.show.channels import surface_ways
from sandbox.show.frames import HEAD, LiveFrames, looked_at
from tests.engine.machines import H, fixed, mechanism

STEPS = 33
"""Of a frame at the usual speed."""


def decoded(data: bytes, frames: LiveFrames) -> dict[str, Any]:
    """A frame by its names."""
    numbers = np.frombuffer(data, "<f4").astype(float)
    found: dict[str, Any] = dict(zip(HEAD, numbers, strict=False))
    at = len(HEAD)
    for name, width in [*frames.drawing()["layout"], ("watched", len(frames.watched))]:
        found[name] = numbers[at:at + width]
        at += width
    for name, count in (("rows", found["contacts"]), ("sides", found["patches"])):
        found[name] = numbers[at:at + 6 * int(count)].reshape(-1, 6)
        at += 6 * int(count)
    trail = int(found["trail"])
    return {**found, "places": numbers[at:].reshape(-1, trail, 2) if trail else None}


def told(frames: LiveFrames) -> dict[str, Any]:
    return decoded(frames.frame(dict.fromkeys(HEAD, 0.0)), frames)


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
        found = {(int(row[4]), int(row[5])): row for row in frame["rows"]}
        assert set(found) == set(sums)
        assert (2, 1) in found  # the block's push on the object
        for pair, (force, place, size) in sums.items():
            assert found[pair][2:4] == pytest.approx(force / len(steps), rel=1e-5, abs=1e-6)
            assert found[pair][:2] == pytest.approx(place / size, rel=1e-5)


def test_pressure_stands_out_of_the_object_that_it_is_shown_on() -> None:
    """A block at rest on an object on the floor: m g over the width, to the left of each side."""
    box = {"type": "box", "size": (0.06, 0.02)}
    machine = mechanism(gravity=(0, -9.81), bodies=[
        fixed("floor", shapes=[{"type": "box", "size": (0.4, 0.02), "at": (0.0, -0.01)}]),
        {"name": "block", "at": (0.1, 0.03), "mass": 0.3, "shapes": [box]},
        {"name": "thing", "at": (0.1, 0.01), "mass": 0.2, "role": "object", "shapes": [box]}])
    frames = begun(machine)
    frames.live.step(20 * STEPS)
    assert len(told(frames)["sides"]) == 0  # as long as nobody asks for it
    frames.layers = {"pressure"}
    below, above = sorted(told(frames)["sides"].tolist(), key=lambda side: side[1])
    assert above == pytest.approx(
        [0.07, 0.02, 0.3 * 9.81 / 0.06, 0.13, 0.02, 0.3 * 9.81 / 0.06], rel=0.02)
    assert below == pytest.approx(
        [0.13, 0.0, 0.5 * 9.81 / 0.06, 0.07, 0.0, 0.5 * 9.81 / 0.06], rel=0.02, abs=1e-4)


def test_surfaces_come_as_far_as_their_speed_takes_them_whichever_way_it_goes() -> None:
    """Marks go with what lies on the belt: on its top against the way round that is positive."""
    machine = mechanism(gravity=(0, -9.81), materials={"rubber": {"friction": 0.5}}, bodies=[
        fixed("belt", material="rubber", shapes=[
            {"type": "capsule", "start": (-1.0, 0.0), "end": (1.0, 0.0), "radius": 0.05}]),
        {"name": "box", "at": (0.0, 0.1), "mass": 1.0, "material": "rubber",
         "shapes": [{"type": "box", "size": (0.1, 0.1)}]}],
        drives=[{"type": "surface", "name": "run", "body": "belt", "value": 0.4}])
    frames = begun(machine)
    ways = []
    for _ in range(30):
        frames.live.step(STEPS)
        ways.append(float(told(frames)["way"][0]))
    assert abs(ways[-1]) == pytest.approx(0.4 * frames.live.time, rel=0.01)
    assert np.diff(ways) == pytest.approx(ways[-1] / 30, rel=0.05)
    assert frames.live["box.vx"] == pytest.approx(-np.sign(ways[-1]) * 0.4, abs=0.01)
    run = simulate(machine.model_copy(update={"run": machine.run.model_copy(
        update={"duration": frames.live.time})}))
    assert surface_ways(run.model, run.arrays)[-1] == pytest.approx(ways[-1], rel=0.01)


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
