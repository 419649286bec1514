"""Contacts on curves: against circles, at sides, corners, ends and hollows."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.errors import SceneError
from sandbox.recording.recording import Recording
from sandbox.scene.expand import to_json
from sandbox.scene.read.load import load_scene

G, MASS = 9.81, 0.5


def ring(radius: float, count: int = 240) -> list[list[float]]:
    turns = np.arange(count) * math.tau / count
    return [[radius * math.cos(turn), radius * math.sin(turn)] for turn in turns]


def placed(ground: dict[str, object], shape: dict[str, object], at: list[float],
           **keys: object) -> Recording:
    """A body that may move along y only, or freely with ``free``, on fixed ground."""
    free, friction = keys.pop("free", False), keys.pop("friction", 0)
    guide = {"type": "slot", "name": "guide", "a": "frame", "b": "body", "turns": False,
             "start": [at[0], at[1] - 0.1], "end": [at[0], at[1] + 0.1]}
    return simulate(load_scene({
        "run": {"duration": 0.3, "step": 5e-4, "sample_rate": 2000}, "gravity": [0, -G],
        "materials": {"only": {"friction": friction}},
        "bodies": [{"name": "frame", "motion": "fixed"},
                   {"name": "ground", "motion": "fixed", "material": "only",
                    "shapes": [ground]},
                   {"name": "body", "mass": MASS, "inertia": 1e-4, "centre": [0, 0], "at": at,
                    "material": "only", "shapes": [shape], **keys}],
        "joints": [] if free else [guide]}))


def arch(half: float, rise: float) -> dict[str, object]:
    """A lens of two arcs with corners at (-half, 0) and (half, 0), by 33 points each."""
    radius = (half**2 + rise**2) / (2 * rise)
    turns = np.linspace(-1.0, 1.0, 33) * math.asin(half / radius)
    x, y = radius * np.sin(turns), radius * np.cos(turns) - radius + rise
    points = [*zip(x.tolist(), (-y).tolist(), strict=True)]
    points += [*zip(x[::-1].tolist(), y[::-1].tolist(), strict=True)][1:-1]
    return {"type": "curve", "points": points, "corners": [0, 32]}


def arc(radius: float, middle: float, at: list[float], thick: float) -> dict[str, object]:
    """A rounded curve whose surface is an arc of 140 degrees about ``at``, by 141 points."""
    turns = middle + np.linspace(-70, 70, 141) * math.pi / 180
    inner = radius - thick
    return {"type": "curve", "closed": False, "radius": thick, "points": [
        [at[0] + inner * math.cos(turn), at[1] + inner * math.sin(turn)] for turn in turns]}


@pytest.mark.parametrize("ground", [
    {"type": "curve", "points": ring(0.05)}, arc(0.05, math.pi / 2, [0, 0], 0.02)])
@pytest.mark.parametrize(("shape", "same"), [
    ({"type": "box", "size": [0.06, 0.04]}, None),
    ({"type": "capsule", "start": [-0.03, 0], "end": [0.03, 0], "radius": 0.02}, None),
    ({"type": "curve", "points": [[x, y + 0.08] for x, y in ring(0.1)]},
     {"type": "circle", "radius": 0.1, "at": [0, 0.08]})])
def test_a_rough_body_rocks_on_a_curve_as_on_a_circle(
    ground: dict[str, object], shape: dict[str, object], same: dict[str, object] | None,
) -> None:
    """240 points have the curvature of the circle to 6e-5, and so the period to 3e-5."""
    start = {"free": True, "friction": 2, "angular_velocity": 1.5}
    on_circle = placed({"type": "circle", "radius": 0.05}, same or shape, [0, 0.07], **start)
    on_curve = placed(ground, shape, [0, 0.07], **start)
    swing = np.ptp(on_circle["body.angle"])
    assert swing > 0.03
    assert np.abs(on_curve["body.angle"] - on_circle["body.angle"]).max() < 1e-4 * swing
    assert on_curve["body/ground.normal"] == pytest.approx(
        on_circle["body/ground.normal"], rel=1e-5)


@pytest.mark.parametrize("off", [0.0, 0.004, -0.009])
def test_a_ball_on_a_corner_is_pushed_away_from_the_corner(off: float) -> None:
    """The normal leads from the corner to the middle of the ball."""
    half, rise, radius = 0.03, 0.01, 0.02
    lens = arch(half, rise) | {"angle": math.pi / 2, "at": [0, -half]}
    run = placed(lens, {"type": "circle", "radius": radius},
                 [off, math.sqrt(radius**2 - off**2) + 1e-6])
    lean = math.sqrt(1 - (off / radius) ** 2)
    assert run["body.y"][-1] == pytest.approx(radius * lean, abs=1e-9)
    assert run["body/ground.normal"][-1] == pytest.approx(MASS * G / lean, rel=1e-9)


def test_a_ball_in_a_hollow_rests_on_both_of_its_flanks() -> None:
    """Two arcs meet in a groove; by symmetry each carries W / (2 cos)."""
    bulge, apart, radius = 0.05, 0.03, 0.02
    turns = np.linspace(0.0, math.pi, 61)
    left = [[-apart - bulge * math.cos(t), bulge * math.sin(t)] for t in turns]
    right = [[apart - bulge * math.cos(t), bulge * math.sin(t)] for t in turns]
    meets = math.acos(apart / bulge)    # where the arcs cross, at x = 0
    left = [p for p in left if p[0] < -1e-3] + [[0.0, bulge * math.sin(meets)]]
    right = [p for p in right if p[0] > 1e-3]
    ground = {"type": "curve", "closed": False, "points": left + right, "corners": [len(left) - 1]}
    height = math.sqrt((bulge + radius) ** 2 - apart**2)
    run = placed(ground, {"type": "circle", "radius": radius}, [0, height + 1e-6], free=True)
    lean = height / (bulge + radius)
    last = run.arrays["contact_sample"] == len(run) - 1
    assert run["body.y"][-1] == pytest.approx(height, abs=1e-6)   # the spline's arcs
    assert run.arrays["contact_merged"][last].tolist() == [2.0]
    force = run.arrays["contact_force"][last].sum(axis=0)
    assert np.abs(force) == pytest.approx([0.0, MASS * G], abs=1e-7)
    assert 0.5 < lean < 1.0


def test_a_curve_is_written_and_read_without_change() -> None:
    scene = load_scene({"bodies": [{"name": "lens", "motion": "fixed", "shapes": [
        arch(0.03, 0.01), {"type": "curve", "closed": False, "radius": 0.001,
                           "points": [[0, 0], [0.1, 0.02], [0.2, 0]]}]}]})
    assert load_scene(json.loads(to_json(scene))).bodies == scene.bodies
    assert [len(shape.nodes) for shape in scene.bodies[0].shapes] == [1, 1]


@pytest.mark.parametrize(("nodes", "words"), [
    ([[[0, 0, 0, 1]]], "are not on its outline"),
    ([[[0, 0, 0, 1], [2, 0, 0, 1]]], "are not on its outline"),
    ([[[0, 0, 0, 1], [1, 0, 0, 1]]] * 2, "there are 2 curves of 'nodes'")])
@pytest.mark.parametrize("kind", ["polygon", "polyline"])
def test_nodes_belong_to_their_outline(kind: str, nodes: list[object], words: str) -> None:
    with pytest.raises(SceneError, match=words):
        load_scene({"bodies": [{"name": "plate", "motion": "fixed", "shapes": [
            {"type": kind, "points": [[0, 0], [1, 0], [1, 1]], "nodes": nodes}]}]})


def test_a_curve_of_straight_pieces_is_a_polygon() -> None:
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    scene = load_scene({"bodies": [{"name": "box", "motion": "fixed", "shapes": [
        {"type": "curve", "points": square, "corners": [0, 1, 2, 3]}]}]})
    assert scene.bodies[0].shapes[0].nodes == ()
    assert [list(point) for point in scene.bodies[0].shapes[0].points] == square
