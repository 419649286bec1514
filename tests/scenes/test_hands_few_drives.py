"""The hands of Figures 1a to 1e, 2c and 2d: what they expect, and that a fault breaks it.

That the expectations hold as the scenes are written is tested with all shipped scenes.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from sandbox.engine.simulate import simulate
from sandbox.mechanics.grasp import disc_centre, disc_grasp
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.statics import contact_forces, contact_jacobian, joint_torques
from sandbox.mechanics.tendon import route
from sandbox.model.compile import compile_mechanism
from sandbox.paper.hand_stiffness import FreeFinger, free_fingers
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import verdicts
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene

FAULTS: dict[str, tuple[dict[str, Any], set[str]]] = {
    "sliding_pulleys": ({"tendons[cord].guides[2].friction": 0.01},
                        {"finger1.tendon.tension", "work"}),
    "eigenposture": ({"tendons[cord3].guides[0].radius": 0.0202},
                     {"x3", "finger3.tendon.tension", "off3"}),
    "antagonistic": ({"tendons[cord_f1].guides[2].radius": 0.0081}, {"mcp.angle", "moved"}),
    "four_motor": ({"parts[tree].shares": [1, 1, 1.01]}, {"middle.tendon.tension"}),
    "six_motor": ({"parts[2].tendon_to[0].radius": 0.00605}, {"ring.tendon.tension"}),
    "elastic_tendons": ({"springs[elastic{i + 1}].stiffness": "=1.01 * k"}, {"off1"}),
}
"""For each scene: a fault, and some of the quantities that are no longer as expected."""
SHARED = ("sliding_pulleys", "elastic_tendons")
LENGTHS, RADII = (0.045, 0.026, 0.021), (0.009, 0.008, 0.0075)
GUIDES = np.array([(-22, -14), (24, -8), (10, -3), (4, -1)]) * 1e-3
BACK: Any = np.full((3, 2), 8e-3)


def failed(name: str, **overrides: Any) -> set[str]:
    """The quantities of a scene that are not as expected."""
    run = simulate(load_scene(name, overrides=overrides))
    return {verdict.quantity for verdict in verdicts(run) if not verdict.ok}


@cache
def run_of(name: str) -> Recording:
    return simulate(load_scene(name))


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_found(name: str) -> None:
    overrides, broken = FAULTS[name]
    assert broken <= failed(name, **overrides)


@pytest.mark.parametrize("step", ["1 ms", "2 ms"])
@pytest.mark.parametrize("name", FAULTS)
def test_the_verdict_does_not_hang_on_the_step(name: str, step: str) -> None:
    assert not failed(name, **{"run.step": step})


@pytest.mark.parametrize("held", [(1, 0), (2, 0), (1, 3), (2, 5)])
@pytest.mark.parametrize("name", SHARED)
def test_other_objects_and_stopped_fingers(name: str, held: tuple[int, int]) -> None:
    assert not failed(name, **{"parameters.object": held[0], "parameters.blocked": held[1]})


@pytest.mark.parametrize("y", [-0.0375, -0.039])
@pytest.mark.parametrize("name", ["four_motor", "six_motor"])
def test_the_disc_comes_to_the_middle_from_where_it_lies(name: str, y: float) -> None:
    assert not failed(name, **{"bodies[disc].at[1]": y})


def test_what_the_palm_carries() -> None:
    """Twice what three phalanges push along x, by f = J^-T tau: to the last digit that is printed.

    The normals point to the phalanges, so that the disc is pushed the other way.
    """
    grasp = disc_grasp(disc_centre(np.radians(35), 0.031, 0.016, RADII[0]), 0.016, LENGTHS, RADII)
    springs = spring_set(BACK * (-1, 1), BACK)
    torques = joint_torques(4.0, route(GUIDES, LENGTHS).arms(grasp.theta), [300.0] * 3,
                            springs.elongations(grasp.theta), springs.arms(grasp.theta))
    pressed = contact_forces(contact_jacobian(grasp.theta, LENGTHS, grasp.distances), torques)
    for name in ("four_motor", "six_motor"):
        expected = [e.value for e in load_scene(name).expect if e.mean == "palm/disc.normal"]
        assert expected[0] == pytest.approx(2 * float(pressed @ grasp.normals[:, 0]), abs=6e-5)


def test_free_fingers_are_pulled_as_their_travels_ask() -> None:
    """To the last digit that is printed: T from x_j = sum of shortenings + what the cords stretch.

    The pulley's two pieces stretch by T / 2 over the cord's stiffness and give half of it; the
    finger's own cord stretches by T over its own.
    """
    scene = load_scene("eigenposture")
    fingers = free_fingers(compile_mechanism(expand(scene)))
    A, B = np.array([20, 24, 20, 16]) * 1e-3, np.array([12, 4, -8, -16]) * 1e-3
    travels = {1.25: 1.4 * A / 2, 2.45: (1.4 * A + 0.9 * B) / 2}
    seen = 0
    for expect in scene.expect:
        who = expect.mean or ""
        if who.endswith(".tendon.tension"):
            assert isinstance(expect.over, tuple)
            finger = who.partition(".")[0]
            x = float(travels[expect.over[0]][int(finger[-1]) - 1])
            tension = pull_for(fingers[finger], x)
            assert expect.value == pytest.approx(tension, abs=6e-5)
            seen += 1
    assert seen == 8


def pull_for(finger: FreeFinger, x: float) -> float:
    """The tension [N] at which a free finger and its cords of 1e5 N/m take up ``x`` [m]."""
    low, high = 0.0, 10.0
    for _ in range(60):
        middle = (low + high) / 2
        taken = float(finger.tendon.shortening(finger.rest(middle))) + middle * 1.25e-5
        low, high = (middle, high) if taken < x else (low, middle)
    return low


def test_one_finger_stalls_the_shaft_where_pulleys_share() -> None:
    """Both meet sections of many sizes: 1/n each there, almost all for one here."""
    stalled = run_of("eigenposture")
    assert stalled["share2"][-1] > 0.7
    shared = run_of("sliding_pulleys")
    tensions = np.array([shared[f"finger{k}.tendon.tension"][-1] for k in range(1, 6)])
    np.testing.assert_allclose(tensions / tensions.sum(), 0.2, rtol=1e-6)


@pytest.mark.parametrize(("sum_", "torque"), [(16e-3, 0.0), (16e-3, 0.015), (48e-3, 0.015)])
def test_antagonists_rest_where_their_energy_is_least(sum_: float, torque: float) -> None:
    """c s^3 / 3 of either spring and the torque's work; no equation of the scene's own."""
    r, c, pose = 8e-3, 3e4, np.radians(30)
    flex, extend = sum_ / 2 + r * pose, sum_ / 2 - r * pose

    def energy(theta: float) -> float:
        stretches = np.maximum([flex - r * theta, extend + r * theta], 0.0)
        return float(c * (stretches**3).sum() / 3 - torque * theta)

    least = minimize_scalar(energy, bounds=(0, 1.2), method="bounded", options={"xatol": 1e-10}).x
    run = run_of("antagonistic")
    at = {(16e-3, 0.0): 0.88, (16e-3, 0.015): 1.33, (48e-3, 0.015): 2.93}[sum_, torque]
    found = float(run["mcp.angle"][int(np.searchsorted(run.time, at))])
    assert found == pytest.approx(least, abs=2e-4)
