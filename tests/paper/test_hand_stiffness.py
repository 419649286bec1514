"""Figure 22: the hand with equal and with varied springs, against statics in another form."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.optimize import minimize_scalar

from sandbox.engine.simulate import simulate
from sandbox.model.compile import compile_mechanism
from sandbox.paper import hand_stiffness
from sandbox.paper.hand_stiffness import FreeFinger, compare, free_fingers
from sandbox.recording.recording import Recording
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene

PULL = 15.0
HINGES = ("mcp", "pip", "dip")
FINGERS = tuple(f"finger{k}" for k in (1, 2, 3, 4))


def mechanism(name: str) -> Mechanism:
    return expand(load_scene(f"stiffness_{name}"))


def fingers(hand: Mechanism) -> dict[str, FreeFinger]:
    return free_fingers(compile_mechanism(hand))


@pytest.fixture(scope="module")
def runs() -> tuple[Recording, Recording]:
    return simulate(mechanism("uniform")), simulate(mechanism("varied"))


def rotations(run: Recording) -> np.ndarray:
    """At the end [deg], shape [fingers, hinges]."""
    return np.degrees([[run[f"{finger}.{hinge}.angle"][-1] for hinge in HINGES]
                       for finger in FINGERS])


def least_energy(joint: int, stiffness: float, tension: float) -> float:
    """Where T lt + k (lm - lm_0)^2 / 2 is least [deg], with points turned about a hinge.

    Another way to the same balance: no arms, no triangles, and none of sandbox's code. The
    numbers are those of the scenes.
    """
    lengths = (0.045, 0.026)
    guides = [(-0.012, -0.014), (0.022, -0.012), (0.008, -0.010), (0.006, -0.008)]
    back = (0.012, 0.0105, 0.010)[joint]
    x, y = guides[joint]
    before = np.array([x - (lengths[joint - 1] if joint else 0.0), y])

    def turned(point: tuple[float, float], theta: float) -> np.ndarray:
        c, s = np.cos(theta), np.sin(theta)
        return np.array([c * point[0] + s * point[1], -s * point[0] + c * point[1]])

    def energy(theta: float) -> float:
        cord = np.linalg.norm(turned(guides[joint + 1], theta) - before)
        spring = np.linalg.norm(turned((0.003, back), theta) - np.array([-0.003, back]))
        return float(tension * cord + stiffness * (spring - 0.006) ** 2 / 2)

    found = minimize_scalar(energy, bounds=(0.0, np.radians(75)), method="bounded",
                            options={"xatol": 1e-10})
    return float(np.degrees(found.x))


@pytest.mark.parametrize("name", ["uniform", "varied"])
def test_balance_of_torques_is_least_energy(name: str) -> None:
    """A minimum of a double is found to the root of its rounding: some 1e-8 of J/rad^2 make
    1e-5 deg at the softest joint (0.023 N m/rad); 1e-3 deg leaves room and would miss nothing.
    """
    for finger in fingers(mechanism(name)).values():
        least = [least_energy(j, float(k), PULL / 4) for j, k in enumerate(finger.stiffness)]
        np.testing.assert_allclose(np.degrees(finger.rest(PULL / 4)), least, atol=1e-3)


def test_engine_ends_in_the_closed_form(runs: tuple[Recording, Recording]) -> None:
    """0.003 deg at the tensions that the run has: what is left of the softest motion.

    The knuckle of finger4 settles with c / k_t = 6e-3 / 0.0231 = 0.26 s; 2.5 s after the ramp
    exp(-9.6) of its 40 deg are left. In the uniform hand the slowest is 0.04 s: nothing is.
    """
    for run, bound in zip(runs, (1e-6, 3e-3), strict=True):
        for row, (name, finger) in zip(rotations(run), free_fingers(run.model).items(),
                                       strict=True):
            closed = finger.rest(float(run[f"{name}.tendon.tension"][-1]))
            np.testing.assert_allclose(row, np.degrees(closed), atol=bound)


def test_tensions_are_a_quarter(runs: tuple[Recording, Recording]) -> None:
    """What a rocker tilted by s makes unequal is s^3 R / (2 l): the root's pivots end 3.2 mm apart
    (190 mm between them, cords of 40 mm), 6e-6; less below it.
    """
    for run, bound in zip(runs, (1e-9, 1e-5), strict=True):
        tension = np.array([run[f"{finger}.tendon.tension"][-1] for finger in FINGERS])
        np.testing.assert_allclose(tension, PULL / 4, rtol=bound)


@pytest.mark.parametrize("name", ["uniform", "varied"])
def test_scenes_expect_the_closed_form(name: str) -> None:
    """To the last digit that they print, 1e-4 deg."""
    scene = load_scene(f"stiffness_{name}")
    hand = fingers(expand(scene))
    expected = {e.final: e.value for e in scene.expect if e.final}
    assert len(expected) == {"uniform": 3, "varied": 12}[name]
    for pattern, value in expected.items():
        who, hinge, _ = pattern.split(".")
        for finger in hand if who == "finger*" else (who,):
            closed = hand[finger].rest(PULL / 4)[HINGES.index(hinge)]
            assert value is not None
            assert np.degrees(value) == pytest.approx(np.degrees(closed), abs=6e-5)


def test_study_writes_picture_and_table(tmp_path: Path, runs: tuple[Recording, Recording]) -> None:
    shares: list[float] = []
    text = hand_stiffness.run(tmp_path, progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    with Image.open(tmp_path / hand_stiffness.PICTURE) as picture:
        assert picture.size[0] == 720
    with (tmp_path / hand_stiffness.NUMBERS).open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [(row["finger"], row["joint"]) for row in rows] == [
        (finger, hinge) for finger in FINGERS for hinge in HINGES]
    wanted = compare(*runs, PULL)
    for row, numbers in zip(rows, wanted, strict=True):
        assert float(row["theta_varied_rad"]) == numbers.theta_varied
        assert float(row["difference_rad"]) == pytest.approx(
            float(row["theta_varied_rad"]) - float(row["theta_uniform_rad"]), abs=1e-15)
    assert (tmp_path / hand_stiffness.TABLE).read_text(encoding="utf-8").count("\n") == 14
    assert "finger4.mcp: 17.9 and 58.6 deg" in text
