"""Studies of random objects in a hand: their files, points of them against closed forms, tables."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.findings import gripping_force
from sandbox.findings.hand_rows import PHALANGES, closing_finger
from sandbox.mechanics.embrace import Pull, close_on_discs
from sandbox.recording.recording import Recording
from sandbox.scene.library import shipped_studies
from sandbox.scene.read.load import load_scene
from sandbox.sweeps.plan import read_plan

RUNS = {"gripping_force_discs": 512, "gripping_force_squares": 256, "differential_rockers": 128,
        "differential_bar": 384}


@pytest.mark.parametrize("study", RUNS)
def test_the_study_files(study: str) -> None:
    plan = read_plan(shipped_studies()[study])
    assert len(plan) == RUNS[study]
    assert {f"{name}{i}" for name in (*PHALANGES, "tension", "contacts", "moves")
            for i in range(1, 5)} <= set(plan.job.keep)


def _forces(run: Recording) -> np.ndarray:
    return np.array([[run[f"finger{i}.{name}.contact.normal"][-1] for name in PHALANGES]
                     for i in range(1, 5)])


def _sections(given: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    r, x, gap = (np.array([given[f"{name}{i}"] for i in range(1, 5)])
                 for name in ("r", "x", "gap"))
    return np.stack([x, -0.009 - gap - r], axis=1), r


def test_forces_of_the_hand_are_those_of_the_closed_form() -> None:
    """The four discs of the picture: three, one, one and two contacts, two with joints on stops.

    The hand's contacts are held to 1e-9 m, a force changes by some 100 N/m of such.
    """
    given = dict(gripping_force.SHOWN)
    run = simulate(load_scene("four_discs", overrides={
        f"parameters.{name}": value for name, value in given.items()}))
    tension = np.array([run[f"finger{i}.tendon.tension"][-1] for i in range(1, 5)])
    np.testing.assert_allclose(tension, 25.0 / 4, rtol=0.01)
    centres, discs = _sections(given)
    there = close_on_discs(closing_finger("four_discs"), centres, discs, Pull(tension), 0.5)
    np.testing.assert_allclose(_forces(run), there.forces, rtol=0, atol=1e-6)
    assert [*(there.forces > 0.01).sum(axis=1)] == [3, 1, 1, 2]


@pytest.mark.parametrize("k", [300.0, 1e5])
def test_tensions_on_the_bar_are_those_of_the_closed_form(k: float) -> None:
    """T_j = F / 4 + k (mean of X - X_j), and each from how far the bar has gone.

    At rest to 1e-10 m, and the stiffest cords make 5e4 N/m of it.
    """
    given = {"r1": 0.016, "x1": 0.01, "gap1": 0.012, "r2": 0.016, "x2": 0.012, "gap2": 0.014,
             "r3": 0.014, "x3": 0.012, "gap3": 0.014, "r4": 0.015, "x4": 0.01, "gap4": 0.014}
    run = simulate(load_scene("four_on_a_bar", overrides={
        f"parameters.{name}": value for name, value in {**given, "k": k}.items()}))
    tension = np.array([run[f"finger{i}.tendon.tension"][-1] for i in range(1, 5)])
    finger, both = closing_finger("four_discs"), 1.0 / (1.0 / k + 1e-5)
    drawn = np.full(4, run["bar_x"][-1])
    there = close_on_discs(finger, *_sections(given), Pull(drawn, both), 0.5)
    np.testing.assert_allclose(there.tension, tension, rtol=0, atol=1e-5)
    way = finger.tendon.shortening(there.theta)
    np.testing.assert_allclose(25.0 / 4 + both * (way.mean() - way), tension, rtol=0, atol=1e-5)
    assert (tension.max() > 18) == (k > 1e4)  # tied rigidly one finger takes nearly all
