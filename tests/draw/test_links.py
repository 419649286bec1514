"""Rods, ropes, cylinders, grooves in the ground, and lines to points beside bodies."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.draw.film import joints
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.links import cylinder, has_ropes
from sandbox.draw.film.sheet import Text
from sandbox.draw.film.stalks import beside, far_feet, stalks
from sandbox.draw.film.wheels import wheel_pictures
from sandbox.model.compile import compile_mechanism
from sandbox.recording.recording import Recording

NODE = {"mass": 1e-3, "inertia": 1e-9}


def _run(**lists: Any) -> Recording:
    return sandbox.simulate(sandbox.expand(sandbox.load_scene({
        "run": {"duration": 0.01, "step": 1e-3, "sample_rate": 1000}, "gravity": [0, 0], **lists})))


def _truss(bars: int = 1) -> Recording:
    """A weight of 30 N on a node that ``bars`` pairs of bars at 45 deg and a rail carry."""
    return _run(
        bodies=[{"name": "ground", "motion": "fixed"}, {"name": "low", "at": [0, 0], **NODE},
                {"name": "high", "at": [1, 1], **NODE}],
        joints=[{"type": "slot", "name": "rail", "a": "ground", "b": "low",
                 "start": [-0.5, 0], "end": [0.5, 0]},
                {"type": "slot", "name": "wall", "a": "ground", "b": "high",
                 "start": [1, 0.5], "end": [1, 1.5]},
                {"type": "rope", "name": "stay", "a": "ground", "b": "low",
                 "on_a": [1, 0], "longest": 1},
                *({"type": "rod", "name": f"bar{i}", "a": "low", "b": "high"}
                  for i in range(bars))],
        drives=[{"type": "force", "name": "load", "body": "high", "direction": [0, -1],
                 "value": 30}])


@pytest.mark.parametrize(("low", "high"), [(100, 107), (100, 100), (100, 140), (100, 185)])
def test_a_rod_keeps_its_length(low: float, high: float) -> None:
    """As it is of steel: the piston goes as far as the actuator grows, within its cylinder."""
    found = [cylinder(length, low, high, 12) for length in np.linspace(low, high, 7)]
    rods = [length - piston for length, (_, piston) in
            zip(np.linspace(low, high, 7), found, strict=True)]
    assert rods == pytest.approx([rods[0]] * 7, rel=1e-12)
    tubes = {tube for tube, _ in found}
    assert len(tubes) == 1
    assert all(0 <= piston <= tube < low for tube, piston in found)


def test_what_one_rod_cannot_go_shows_how_far_it_is_out() -> None:
    ends = [cylinder(length, 100, 300, 12)[1] / cylinder(length, 100, 300, 12)[0]
            for length in (100, 300)]
    assert ends == pytest.approx([0.14, 0.86])


def _draw(run: Recording, monkeypatch: pytest.MonkeyPatch) -> dict[str, list[Any]]:
    """What was drawn of the ground, in pixels of the enlarged picture, and which labels."""
    seen: dict[str, list[Any]] = {"rail": [], "roller": [], "symbol": []}
    monkeypatch.setattr(joints, "fixed_rail", lambda _, a, b: seen["rail"].append((a, b)))
    monkeypatch.setattr(joints, "roller", lambda _, a, b, at, turns: seen["roller"].append(at))
    monkeypatch.setattr(joints, "ground_symbol", lambda _, at: seen["symbol"].append(at))
    renderer = FrameRenderer(run)
    renderer.draw(0.01)
    seen["label"] = [label.text for label in renderer._canvas.labels]
    seen["camera"] = [renderer._canvas.camera]
    return seen


def test_a_groove_in_the_ground_has_a_roller_and_no_supports_at_its_ends(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen = _draw(_truss(), monkeypatch)
    to_pixels = seen["camera"][0].to_pixels
    assert np.allclose(seen["roller"], to_pixels(np.array([[0.0, 0], [1, 1]])), atol=1)
    assert np.allclose(seen["rail"][0], to_pixels(np.array([[-0.5, 0], [0.5, 0]])))
    assert np.allclose(seen["symbol"], to_pixels(np.array([[1.0, 0]])))  # the stay's alone


def test_few_bars_have_their_tension_written(monkeypatch: pytest.MonkeyPatch) -> None:
    """The weight through the bar at 45 deg, -30 sqrt(2) N; its part along the rail, 30 N."""
    labels = _draw(_truss(), monkeypatch)["label"]
    assert "-42.4 N" in labels
    assert "30.0 N" in labels


def test_of_many_none_is_written(monkeypatch: pytest.MonkeyPatch) -> None:
    run = _truss(bars=12)
    assert all(abs(run[f"bar{i}.tension"][-1]) > 1 for i in range(12))
    labels = _draw(run, monkeypatch)["label"]
    assert [text for text in labels if not text.startswith("load")] == []


def test_numbers_of_bars_lie_on_no_bar() -> None:
    renderer = FrameRenderer(_truss())
    placed = [word.rect for word in renderer.sheet(0.01).words
              if isinstance(word, Text) and renderer._stage.contains(word.rect)]
    assert len(placed) == 3  # the load's, the bar's, the stay's
    ends = renderer.camera.to_pixels(np.array([[0.0, 0], [1, 1]]))
    for share in np.linspace(0, 1, 200):
        x, y = ends[0] + share * (ends[1] - ends[0])
        assert not any(rect.collidepoint(x, y) for rect in placed)


def test_a_rope_is_told_and_an_actuator_is_none() -> None:
    run = _truss()
    assert has_ropes(run.model)
    words = [item.after for row in FrameRenderer(run)._legend for item in row]
    assert "rope" in words
    rod = _run(bodies=[{"name": "g", "motion": "fixed"}, {"name": "b", "at": [1, 0], **NODE}],
               joints=[{"type": "rod", "name": "r", "a": "g", "b": "b"},
                       {"type": "actuator", "name": "c", "a": "g", "b": "b", "on_a": [0, 1]}])
    assert not has_ropes(rod.model)


def _beside(**field: Any) -> Any:
    return compile_mechanism(sandbox.expand(sandbox.load_scene({
        "bodies": [{"name": "frame", "motion": "fixed",
                    "shapes": [{"type": "box", "size": [0.2, 0.1]}]},
                   {"name": "arm", "mass": 1, "at": [1, 0],
                    "shapes": [{"type": "capsule", "end": [1, 0], "radius": 0.1}]}],
        "joints": [{"type": "actuator", "name": "c", "a": "frame", "b": "arm",
                    "on_a": [0, -0.5], "on_b": [0.5, 0.35]}], **field})))


def test_a_point_beside_a_body_has_a_line_to_where_the_body_is_nearest() -> None:
    """Straight down 0.25 m to a capsule's side, 0.45 m to that of a box."""
    model = _beside()
    found = stalks(model)
    assert len(found[0]) == len(found[1]) == 1
    assert found[1][0][0] == (0.5, 0.35)
    assert found[1][0][1] == pytest.approx((0.5, 0.1), abs=1e-12)
    assert math.dist(*found[0][0]) == pytest.approx(0.45)
    assert beside(model, 1, (0.5, 0.05)) is None
    assert far_feet(model, 0.44) == {0: [(0.0, -0.5)]}
    assert far_feet(model, 0.46) == {0: []}


def test_gears_on_one_shaft_show_one_turn() -> None:
    scene = sandbox.load_scene({
        "bodies": [{"name": "f", "motion": "fixed"},
                   *({"name": f"w{i}", "mass": 1, "inertia": 1, "at": [x, 0]}
                     for i, x in enumerate((0, 0.05, 0.11)))],
        "joints": [*({"type": "pin", "name": f"p{i}", "a": "f", "b": f"w{i}", "on_b": [0, 0]}
                     for i in range(3)),
                   {"type": "gear", "name": "g0", "a": "w0", "b": "w1",
                    "radius_a": 0.01, "radius_b": 0.04},
                   {"type": "gear", "name": "g1", "a": "w1", "b": "w2",
                    "radius_a": 0.015, "radius_b": 0.045}]})
    wheels = wheel_pictures(compile_mechanism(sandbox.expand(scene)))
    spokes = [wheel.spoke for wheel in wheels[2] if wheel.spoke is not None]
    assert len(spokes) == 2
    assert [math.atan2(*spoke[1, ::-1]) for spoke in spokes] == [0.0, 0.0]
