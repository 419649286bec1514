"""Contacts of outlines cut into pieces: nothing is caught on a seam, nothing falls through one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.scene.read.load import load_scene

BOX, DISC, BAR = (
    ({"type": "box", "size": [0.1, 0.04]}, 0.02), ({"type": "circle", "radius": 0.03}, 0.03),
    ({"type": "capsule", "start": [-0.05, 0], "end": [0.05, 0], "radius": 0.02}, 0.02))
LINE = [[x / 10, 0.0] for x in range(-10, 11)]


def run(ground, body, at, *, velocity=(0.0, 0.0), duration=1.0, friction=0.0, **keys):
    scene = {
        "run": {"duration": duration, "step": 1e-3, "sample_rate": 1000}, "gravity": [0, -9.81],
        "materials": {"m": {"friction": friction}},
        "bodies": [
            {"name": "ground", "motion": "fixed", "material": "m", "shapes": ground},
            {"name": "b", "density": 1000, "material": "m", "at": at, "velocity": velocity,
             "shapes": [body], **keys}]}
    return simulate(load_scene(scene))


@pytest.mark.parametrize("turned", [0.0, 0.3])
@pytest.mark.parametrize(("body", "height"), [BOX, DISC, BAR], ids=["box", "disc", "bar"])
@pytest.mark.parametrize("radius", [0.0, 0.005])
def test_a_flat_chain_is_as_smooth_as_one_plane(body, height, radius, turned):
    """Without friction g sin(slope) t, to rounding, over nine joints."""
    c, s = math.cos(turned), -math.sin(turned)
    chain = [[c * x - s * y, s * x + c * y] for x, y in LINE]
    high = height + radius
    found = run([{"type": "polyline", "points": chain, "radius": radius}], body,
                [-0.8 * c - high * s, -0.8 * s + high * c], velocity=(c, s), angle=-turned,
                duration=0.4 if turned else 1.0)
    along = c * found["b.vx"] + s * found["b.vy"]
    assert along == pytest.approx(1 + 9.81 * math.sin(turned) * found.time, abs=1e-9)
    assert np.abs(-s * found["b.x"] + c * found["b.y"] - high).max() < 1e-9


def test_the_ends_of_a_chain_can_be_hit():
    found = run([{"type": "polyline", "points": [[0, 0], [0, 0.5]]}], DISC[0], [0.0, 0.6])
    assert found["b.y"][-1] == pytest.approx(0.53, abs=1e-6)


HILL = [[x / 20, -0.05 * (x / 20) ** 2] for x in range(20, -21, -1)]
COMB = [[x / 10, -0.3 - 0.4 * (x % 2)] for x in range(-10, 11)]


@pytest.mark.parametrize("at", [-0.5, -0.05, 0.0, 0.01, 0.3])
@pytest.mark.parametrize("speed", [0.1, 20.0])
@pytest.mark.parametrize("sharp", [0.02, 0.2])
def test_a_sharp_corner_does_not_fall_through_a_seam(at, speed, sharp):
    """A spike hits a hill cut into many pieces, at its corners, where seams end, and beside them.

    It is in the hill by less than it moves in a step, and comes out again.
    """
    spike = {"type": "polygon", "points": [[0, 0], [sharp, 0.3], [-sharp, 0.3]]}
    found = run([{"type": "polygon", "points": HILL + COMB}], spike, [at, 0.005],
                velocity=(0.0, -speed), duration=0.3, friction=0.5)
    above = found["b.y"] + 0.05 * found["b.x"] ** 2
    assert above.min() > -1e-3 * speed - 1e-4
    assert above[-1] > -1e-4


@pytest.mark.parametrize("degrees", [1.0, 10.0, 40.0])
def test_a_corner_that_bends_inwards_takes_what_lies_across_it(degrees):
    """A disc that slides on goes at v cos(bend): what was across the new side is gone."""
    bend = math.radians(degrees)
    far = [math.cos(bend), math.sin(bend)]
    slope = [[-1, -0.2], [0.5, -0.2], [far[0], -0.1], far, [0, 0], [-1, 0]]
    found = run([{"type": "polygon", "points": slope}], DISC[0], [-0.5, DISC[1]],
                velocity=(4.0, 0.0), duration=0.16)
    speed = np.hypot(found["b.vx"], found["b.vy"])
    climbed = found["b.y"][-1] - DISC[1]
    assert climbed > 0
    wanted = math.sqrt((4 * math.cos(bend)) ** 2 - 2 * 9.81 * climbed)
    # the blow begins within a step and ends within the next: the slope takes h g sin(bend) a step
    assert speed[-1] == pytest.approx(wanted, abs=2e-3 * 9.81 * math.sin(bend) + 1e-5)


@pytest.mark.parametrize("hole", [24, 100])
def test_a_disc_slides_from_side_to_side_of_a_round_hole(hole):
    """It keeps within the hole, lies on the lowest side as on a plane, and gains no energy."""
    turns = [math.tau * (k + 0.5) / hole for k in range(hole)]
    ring = [[0.1 * math.cos(turn), 0.1 * math.sin(turn)] for turn in turns]
    found = run([{"type": "polygon", "points": [[-1, -1], [1, -1], [1, 1], [-1, 1]],
                  "holes": [ring]}], {"type": "circle", "radius": 0.03}, [0.03, 0.0],
                duration=2.0)
    assert np.hypot(found["b.x"], found["b.y"]).max() < 0.07 + 1e-6
    assert found["b.y"].min() == pytest.approx(0.03 - 0.1 * math.cos(math.pi / hole), abs=1e-9)
    energy = 9.81 * found["b.y"] + (found["b.vx"] ** 2 + found["b.vy"] ** 2) / 2
    assert energy.max() < 1e-5
