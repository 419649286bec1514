"""Bilateral rows one by one: derivatives of what they keep, and how it bends."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sandbox.engine.rows import CLOSED, NOTHING

from .dense import cord_length, derivative, joint_gaps, spring_length
from .machines import Bench, H, fixed, mechanism, rows_of
from .test_solve import Made, bilateral

KINDS: dict[str, dict[str, Any]] = {
    "pin": {}, "weld": {}, "rod": {}, "slot": {"turns": True}, "slider": {"turns": False}}
SEEDS = pytest.mark.parametrize("seed", range(5))


def joined(kind: str, seed: int) -> tuple[Bench, np.ndarray]:
    """Two thrown bodies and one joint, after a step; poses there in the model's order."""
    made = Made(seed)
    made.elements["joints"].clear()
    made.joint("slot" if kind == "slider" else kind, "b2", "b3", **KINDS[kind])
    bench = Bench(made.machine()).step(speeds=[[0.0, 0.0, 0.0]])
    return bench, bench.state.body[bench.world.number, :3]


def in_model_order(bench: Bench, row: np.ndarray) -> np.ndarray:
    return row.reshape(-1, 3)[bench.world.number].ravel()


def unknowns(bench: Bench) -> list[int]:
    """The unknowns of the only joint, in the order of its gaps."""
    joint = bench.constants.joints[0]
    return [int(joint[key]) for key in ("row", "row_y", "row_turn") if joint[key] >= 0]


@SEEDS
@pytest.mark.parametrize("kind", KINDS)
def test_joints_know_the_derivatives_of_their_gaps(kind: str, seed: int) -> None:
    """By every coordinate, at the step's pose: rounding."""
    bench, pose = joined(kind, seed)
    gaps, J = joint_gaps(bench.world.model), rows_of(bench.tables)
    assert len(gaps) == len(unknowns(bench))
    for (_, gap), row in zip(gaps, unknowns(bench), strict=True):
        np.testing.assert_allclose(
            in_model_order(bench, J[row]), derivative(gap, pose), rtol=1e-12, atol=1e-13)


@SEEDS
@pytest.mark.parametrize("kind", KINDS)
def test_joints_ask_for_their_gap_and_how_it_bends(kind: str, seed: int) -> None:
    """-gap / h - h / 2 of the second derivative of the gap along the velocities before.

    That by differences over 2e-3 s: 5e-7 of the fourth derivative, which is omega^2 of the second.
    """
    bench, pose = joined(kind, seed)
    velocity, t = bench.result.before[bench.world.number], 1e-3
    for (_, gap), row in zip(joint_gaps(bench.world.model), unknowns(bench), strict=True):
        along = [float(np.real(gap(pose + sign * t * velocity))) for sign in (-1, 0, 1)]
        bend = (along[0] - 2 * along[1] + along[2]) / t**2
        off = H / 2 * (1e-4 * abs(bend) + 1e-8) + NOTHING / H
        assert bench.result.unknowns[0, row] == pytest.approx(
            -along[1] / H - H / 2 * bend, rel=1e-9, abs=off)


@SEEDS
@pytest.mark.parametrize("kind", KINDS)
def test_joints_are_closed_where_the_step_leads(kind: str, seed: int) -> None:
    """However far they were open before; how far they bend is bounded, not worked out: twice."""
    bench, pose = joined(kind, seed)
    there = pose + H * bench.result.velocity[bench.world.number]
    for _, gap in joint_gaps(bench.world.model):
        assert abs(np.real(gap(there))) < 2 * CLOSED


def test_joints_close_from_a_millimetre_away_at_once() -> None:
    """A fast spin opens a pin by (omega h)^2 r / 2; three more solves are enough for 0.1 rad."""
    bench = Bench(mechanism(
        bodies=[fixed("wall"), {"name": "b", "mass": 0.1, "inertia": 1e-4, "at": (0.1, 0.0),
                                "angular_velocity": 200.0}],
        joints=[{"type": "pin", "name": "j", "a": "wall", "b": "b", "on_a": (0.0, 0.0)}]))
    model, number = bench.world.model, bench.world.number
    bench.step()
    pose = bench.state.body[number, :3]
    opened = max(abs(np.real(gap(pose))) for _, gap in joint_gaps(model))
    assert opened > 1e-3
    there = pose + H * bench.result.velocity[number]
    assert max(abs(np.real(gap(there))) for _, gap in joint_gaps(model)) < 2 * CLOSED


@pytest.mark.parametrize("seed", range(20))
def test_cords_and_springs_know_how_they_shorten(seed: int) -> None:
    """Rows of those that have one: the derivative of the length, less; slack cords have none."""
    made = bilateral(seed)
    bench = Bench(made.machine()).step(*made.drive, speeds=[[0.0, 0.0, 0.0]])
    pose, J = bench.state.body[bench.world.number, :3], rows_of(bench.tables)
    model, seen = bench.world.model, 0
    tables: list[tuple[Any, Callable[..., Any]]] = [
        (bench.constants.springs, spring_length), (bench.constants.cords, cord_length)]
    for table, length in tables:
        for i in range(len(table)):
            if table["row"][i] < 0:
                continue
            seen += 1
            expected = -derivative(lambda q, i=i, length=length: length(model, q, i), pose)
            if length is cord_length and not bench.state.cords["active"][i]:
                expected[:] = 0.0
            np.testing.assert_allclose(
                in_model_order(bench, J[table["row"][i]]), expected, rtol=1e-12, atol=1e-13)
    assert seen > 0
