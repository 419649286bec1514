"""Contact geometry: overlaps, curves, and outlines that are cut into pieces."""

from __future__ import annotations

import math

import numpy as np
import pytest

import sandbox
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import load_scene

from .machines import G, disc, fixed, mechanism

R = 0.01


def test_a_wedged_disc_is_not_pushed_out() -> None:
    """A disc half a millimetre too large for its gap on either side: there is no way out, so that
    asking for one would be answered with forces without end. It slides down as if it fitted.
    """
    wall = {"type": "box", "size": (0.02, 0.4)}
    run = sandbox.simulate(mechanism(
        duration=0.1, gravity=(0.0, -G),
        bodies=[fixed("left", at=(-0.02, 0.0), shapes=[wall]),
                fixed("right", at=(0.02, 0.0), shapes=[wall]),
                disc("disc", R + 5e-4, (0.0, 0.0)),
                fixed("floor", at=(0.5, -0.01), shapes=[{"type": "box", "size": (0.2, 0.02)}]),
                disc("sunk", R, (0.5, R - 2e-3))]))
    assert np.abs(run["disc.x"]).max() < 1e-9
    assert run["disc.y"][-1] == pytest.approx(-G * run.time[-1]**2 / 2, rel=1e-3)
    # elsewhere an overlap of 2 mm comes out, at 0.1 m/s, and then the disc rests
    assert run["sunk.y"][-1] == pytest.approx(R, abs=1e-6)
    assert np.abs(np.diff(run["sunk.y"]) / np.diff(run.time)).max() == pytest.approx(0.1, rel=1e-3)


GRAVITY, MASS = 9.81, 0.5


def placed(ground: dict[str, object], shape: dict[str, object], at: list[float],
           **keys: object) -> Recording:
    """A body that may move along y only, or freely with ``free``, on fixed ground."""
    free, friction = keys.pop("free", False), keys.pop("friction", 0)
    guide = {"type": "slot", "name": "guide", "a": "frame", "b": "body", "turns": False,
             "start": [at[0], at[1] - 0.1], "end": [at[0], at[1] + 0.1]}
    return simulate(load_scene({
        "run": {"duration": 0.3, "step": 5e-4, "sample_rate": 2000}, "gravity": [0, -GRAVITY],
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


@pytest.mark.parametrize("off", [0.0, 0.004, -0.009])
def test_a_ball_on_a_corner_is_pushed_away_from_the_corner(off: float) -> None:
    """The normal leads from the corner to the middle of the ball."""
    half, rise, radius = 0.03, 0.01, 0.02
    lens = arch(half, rise) | {"angle": math.pi / 2, "at": [0, -half]}
    run = placed(lens, {"type": "circle", "radius": radius},
                 [off, math.sqrt(radius**2 - off**2) + 1e-6])
    lean = math.sqrt(1 - (off / radius) ** 2)
    assert run["body.y"][-1] == pytest.approx(radius * lean, abs=1e-9)
    assert run["body/ground.normal"][-1] == pytest.approx(MASS * GRAVITY / lean, rel=1e-9)


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
    assert np.abs(force) == pytest.approx([0.0, MASS * GRAVITY], abs=1e-7)
    assert 0.5 < lean < 1.0


DISC, HIGH = {"type": "circle", "radius": 0.03}, 0.03


def run_on(ground, body, at, *, velocity=(0.0, 0.0), duration=1.0, friction=0.0, **keys):
    scene = {
        "run": {"duration": duration, "step": 1e-3, "sample_rate": 1000}, "gravity": [0, -9.81],
        "materials": {"m": {"friction": friction}},
        "bodies": [
            {"name": "ground", "motion": "fixed", "material": "m", "shapes": ground},
            {"name": "b", "density": 1000, "material": "m", "at": at, "velocity": velocity,
             "shapes": [body], **keys}]}
    return simulate(load_scene(scene))


def test_the_ends_of_a_chain_can_be_hit():
    found = run_on([{"type": "polyline", "points": [[0, 0], [0, 0.5]]}], DISC, [0.0, 0.6])
    assert found["b.y"][-1] == pytest.approx(0.53, abs=1e-6)


HILL = [[x / 20, -0.05 * (x / 20) ** 2] for x in range(20, -21, -1)]
COMB = [[x / 10, -0.3 - 0.4 * (x % 2)] for x in range(-10, 11)]


@pytest.mark.parametrize("at", [-0.5, 0.0, 0.01])
@pytest.mark.parametrize(("speed", "sharp"), [(0.1, 0.2), (20.0, 0.02)])
def test_a_sharp_corner_does_not_fall_through_a_seam(at, speed, sharp):
    """A spike hits a hill cut into many pieces, at its corners, where seams end, and beside them.

    It is in the hill by less than it moves in a step, and comes out again.
    """
    spike = {"type": "polygon", "points": [[0, 0], [sharp, 0.3], [-sharp, 0.3]]}
    found = run_on([{"type": "polygon", "points": HILL + COMB}], spike, [at, 0.005],
                   velocity=(0.0, -speed), duration=0.3, friction=0.5)
    above = found["b.y"] + 0.05 * found["b.x"] ** 2
    assert above.min() > -1e-3 * speed - 1e-4
    assert above[-1] > -1e-4


@pytest.mark.parametrize("degrees", [1.0, 10.0, 40.0])
def test_an_inward_corner_stops_the_velocity_across_the_next_side(degrees):
    """A disc that slides on goes at v cos(bend): what was across the new side is gone."""
    bend = math.radians(degrees)
    far = [math.cos(bend), math.sin(bend)]
    slope = [[-1, -0.2], [0.5, -0.2], [far[0], -0.1], far, [0, 0], [-1, 0]]
    found = run_on([{"type": "polygon", "points": slope}], DISC, [-0.5, HIGH],
                   velocity=(4.0, 0.0), duration=0.16)
    speed = np.hypot(found["b.vx"], found["b.vy"])
    climbed = found["b.y"][-1] - HIGH
    assert climbed > 0
    wanted = math.sqrt((4 * math.cos(bend)) ** 2 - 2 * 9.81 * climbed)
    # the blow begins within a step and ends within the next: the slope takes h g sin(bend) a step
    assert speed[-1] == pytest.approx(wanted, abs=2e-3 * 9.81 * math.sin(bend) + 1e-5)


@pytest.mark.parametrize("hole", [24, 100])
def test_a_disc_slides_from_side_to_side_of_a_round_hole(hole):
    """It keeps within the hole, lies on the lowest side as on a plane, and gains no energy."""
    turns = [math.tau * (k + 0.5) / hole for k in range(hole)]
    ring = [[0.1 * math.cos(turn), 0.1 * math.sin(turn)] for turn in turns]
    found = run_on([{"type": "polygon", "points": [[-1, -1], [1, -1], [1, 1], [-1, 1]],
                  "holes": [ring]}], {"type": "circle", "radius": 0.03}, [0.03, 0.0],
                   duration=2.0)
    assert np.hypot(found["b.x"], found["b.y"]).max() < 0.07 + 1e-6
    assert found["b.y"].min() == pytest.approx(0.03 - 0.1 * math.cos(math.pi / hole), abs=1e-9)
    energy = 9.81 * found["b.y"] + (found["b.vx"] ** 2 + found["b.vy"] ** 2) / 2
    assert energy.max() < 1e-5
