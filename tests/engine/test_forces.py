"""Forces that the pose tells, and dampers by themselves, one step at a time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sandbox.engine.simulate import simulate
from sandbox.scene.mechanism import Mechanism

from .machines import Bench, H, cord, disc, fixed, inverse_masses, mass, mechanism


def thrown(machine: Mechanism, velocity: Any = None, drive: Any = ()) -> Bench:
    """A machine after its first step, its bodies thrown with velocities [nb, 3] before."""
    bench = Bench(machine)
    speeds = np.zeros((len(bench.world.bodies), 3)) if velocity is None else np.array(velocity)
    start = bench.world.body[:, :3].copy()
    bench.throw(speeds).step(*drive)
    np.testing.assert_allclose(bench.state.body[:, :3], start + H * speeds, rtol=1e-15, atol=1e-17)
    return bench


# -- springs ---------------------------------------------------------------------


def linear(**more: Any) -> Mechanism:
    """A spring from the wall's (0.1, 0) to (0, 0.05) of a body at (0.3, 0.2), turned 90 deg."""
    return mechanism(
        bodies=[fixed("wall"),
                {"name": "b", "mass": 0.2, "inertia": 1e-4, "at": (0.3, 0.2), "angle": np.pi / 2}],
        springs=[{"type": "linear", "name": "s", "a": "wall", "b": "b", "on_a": (0.1, 0.0),
                  "on_b": (0.0, 0.05), "stiffness": 300.0, **more}])


def test_spring_at_the_pose_of_the_step() -> None:
    """k (L - L0) along the line between the points, at x + h v: rounding."""
    bench = thrown(linear(rest_length=0.1), [[3.0, -2.0, 50.0], [0.0, 0.0, 0.0]])
    x, y, angle = np.array([0.3, 0.2, np.pi / 2]) + H * np.array([3.0, -2.0, 50.0])
    end = np.array([x - 0.05 * np.sin(angle), y + 0.05 * np.cos(angle)])
    line = end - [0.1, 0.0]
    force = -300.0 * (np.linalg.norm(line) - 0.1) * line / np.linalg.norm(line)
    arm = end - [x, y]
    np.testing.assert_allclose(
        bench.result.force[0], [*force, arm[0] * force[1] - arm[1] * force[0]], rtol=1e-12)
    assert bench.result.springs["length"][0] == pytest.approx(np.linalg.norm(line), rel=1e-14)


def test_spring_pushes_when_short() -> None:
    """Rest length 1 m, standing 0.25 m long (wall's point to (0.25, 0.2)): pushed away."""
    bench = thrown(linear(rest_length=1.0))
    assert bench.result.springs["force"][0] == pytest.approx(300 * (0.25 - 1.0), rel=1e-12)
    assert bench.result.force[0, :2] == pytest.approx(
        300 * 0.75 * np.array([0.15, 0.2]) / 0.25, rel=1e-12)


@pytest.mark.parametrize("stiffness", [100.0, 1e9])
@pytest.mark.parametrize("damping", [0.0, 1.0])
def test_spring_of_no_length_is_harmless(stiffness: float, damping: float) -> None:
    """Its ends on one point: no direction, no force, no NaN."""
    bench = thrown(mechanism(
        bodies=[fixed("wall"), mass("b", 0.1, (0.0, 0.0))],
        springs=[{"type": "linear", "name": "s", "a": "wall", "b": "b", "stiffness": stiffness,
                  "damping": damping, "rest_length": 0.1}]))
    np.testing.assert_array_equal(bench.result.velocity, 0.0)


def test_linear_damper_rule() -> None:
    """F = -c (v + v_before) / 2 at the body's point, with what F itself does to v: mid-step."""
    now = np.array([1.0, -0.5, 4.0])
    bench = thrown(linear(stiffness=0.0, damping=8.0), [now, [0, 0, 0]])
    x, y, angle = np.array([0.3, 0.2, np.pi / 2]) + H * now
    arm = 0.05 * np.array([-np.sin(angle), np.cos(angle)])
    u = np.array([x, y]) + arm - [0.1, 0.0]
    u /= np.linalg.norm(u)
    row = np.array([*u, arm[0] * u[1] - arm[1] * u[0]])
    weights = np.array([1 / 0.2, 1 / 0.2, 1 / 1e-4])
    force = -8.0 * row @ now / (1 + H * 8.0 / 2 * row**2 @ weights)
    np.testing.assert_allclose(
        bench.result.velocity[0], now + H * weights * row * force, rtol=1e-12)
    assert bench.result.springs["force"][0] == pytest.approx(-force, rel=1e-12)


def test_linear_dampers_of_one_body_answer_together() -> None:
    """Two alike side by side: each divides by 1 + 2 h c (1/m) / 2, for both act."""
    bench = thrown(mechanism(
        bodies=[fixed("wall"), mass("b", 0.1, (0.3, 0.0))],
        springs=[{"type": "linear", "name": name, "a": "wall", "b": "b", "stiffness": 0.0,
                  "damping": 6.0} for name in ("s", "t")]), [[0.5, 0.0, 0.0], [0, 0, 0]])
    each = 6.0 * 0.5 / (1 + H * 6.0 / 0.1)
    np.testing.assert_allclose(bench.result.springs["force"], [each, each], rtol=1e-11)
    np.testing.assert_allclose(
        bench.result.velocity[0], [0.5 - H * 2 * each / 0.1, 0, 0], rtol=1e-12)


# -- dampers of hinges -------------------------------------------------------------


def chains() -> Mechanism:
    """Two chains of three links on one wall, their dampers of all sizes, one clockwise; the second
    chain has a rotary spring's damper on top.
    """
    bodies, joints = [fixed("wall")], []
    for chain in "pq":
        for i in range(3):
            bodies.append({"name": f"{chain}{i}", "mass": 0.01, "inertia": 1e-6 * (1 + i)})
            joints.append({
                "type": "pin", "name": f"{chain}j{i}", "on_a": (0.0, 0.0), "b": f"{chain}{i}",
                "a": f"{chain}{i - 1}" if i else "wall", "damping": 1e-3 * (i + 1),
                "positive": "clockwise" if i == 1 else "counterclockwise"})
    return mechanism(bodies=bodies, joints=joints, springs=[
        {"type": "rotary", "name": "s", "joint": "qj2", "stiffness": 0.0, "damping": 5e-3}])


def test_hinge_damper_rule() -> None:
    """(2 / c + h A) tau = -2 D omega, A = D I^-1 D^T, dense: mid-step, with all that they share.

    Three steps of random turns; the links turn about their own centres, so no pin carries any.
    """
    bench = Bench(chains())
    n = {name: bench.number(name) for name in bench.world.model.names.body}
    pairs = [(n["wall" if i == 0 else f"{chain}{i - 1}"], n[f"{chain}{i}"])
             for chain in "pq" for i in range(3)]
    C = np.array([1e-3, 2e-3, 3e-3, 1e-3, 2e-3, 3e-3 + 5e-3])
    D = np.zeros((6, 7))
    for i, (a, b) in enumerate(pairs):
        D[i, a], D[i, b] = -1, 1
    inverse = inverse_masses(bench.tables)[2::3]
    A = np.diag(2 / C) + H * D @ np.diag(inverse) @ D.T
    rng = np.random.default_rng(0)
    for _ in range(3):
        omega = rng.uniform(-9, 9, 7) * (inverse > 0)
        bench.throw(np.outer(omega, [0, 0, 1])).step()
        tau = np.linalg.solve(A, -2 * D @ omega)
        np.testing.assert_allclose(bench.state.dampers["torque"], tau, rtol=1e-10)
        np.testing.assert_allclose(
            bench.result.velocity[:, 2], omega + H * inverse * (D.T @ tau), rtol=1e-10, atol=1e-12)


# -- inside the mechanism nothing is gained -----------------------------------------


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10**6))
def test_actio_est_reactio(seed: int) -> None:
    """Springs, dampers, joints, tendons and hinge torques between free bodies: the impulses of a
    step and their moments at its pose add up to zero, to rounding of the largest.

    They set out together, so that the joints' points stand on one another.
    """
    rng = np.random.default_rng(seed)
    names = ["a", "b", "c"]
    bodies = [{"name": n, "mass": 0.1, "inertia": 1e-4, "angle": rng.uniform(-3, 3),
               "at": rng.uniform(-1, 1, 2).tolist()} for n in names]

    def spot() -> list[float]:
        return rng.uniform(-0.1, 0.1, 2).tolist()

    bench = thrown(mechanism(
        bodies=bodies,
        joints=[{"type": "pin", "name": "j", "a": "a", "b": "b", "on_a": spot(), "damping": 0.01,
                 "positive": "clockwise"},
                {"type": "rod", "name": "r", "a": "b", "b": "c", "on_a": spot(), "on_b": spot()}],
        springs=[{"type": "linear", "name": "s", "a": "b", "b": "c", "on_a": spot(), "on_b": spot(),
                  "stiffness": 200.0, "damping": 3.0, "rest_length": 0.2}],
        tendons=[cord("pulled", ("a", spot()), ("b", spot(), 0.03, "right"), ("c", spot(), 0.02)),
                 cord("stiff", ("c", spot(), 0.01), ("a", spot()), ("b", spot()),
                      rest_length=0.01)],
        drives=[{"type": "torque", "name": "t", "joint": "j", "value": 0.3},
                {"type": "motor", "name": "m", "joint": "j", "value": 3.0, "torque": 0.1},
                {"type": "pull", "name": "p", "tendon": "pulled", "value": 7.0}]),
        np.tile([*rng.uniform(-1, 1, 2), 0.0], (3, 1)), [0.3, 3.0, 7.0])
    assert bench.result.cords["tension"][0] == 7.0
    pose, weights = bench.state.body[:, :3], 1 / inverse_masses(bench.tables).reshape(3, 3)
    gained = weights * (bench.result.velocity - bench.result.before)
    about = gained[:, 2] + pose[:, 0] * gained[:, 1] - pose[:, 1] * gained[:, 0]
    total = np.array([*gained[:, :2].sum(axis=0), about.sum()])
    np.testing.assert_allclose(total, 0.0, atol=1e-12 * abs(gained).max())


# -- drives --------------------------------------------------------------------------


@pytest.mark.parametrize("frame", ["world", "body"])
def test_force_drive(frame: str) -> None:
    """F along its direction (of any length), turned with the body or not; torque r x F about the
    centre of mass, which is not the frame's origin here.
    """
    bench = thrown(mechanism(
        bodies=[{"name": "b", "mass": 0.1, "inertia": 1e-4, "at": (1.0, 2.0), "angle": 0.6,
                 "centre": (0.02, 0.01)}],
        drives=[{"type": "force", "name": "f", "body": "b", "at": (0.05, 0.03),
                 "direction": (3.0, 4.0), "frame": frame, "value": 2.0}]),
        [[0.3, 0.1, 20.0]], [2.0])
    angle = 0.6 + H * 20.0
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    force = np.array([1.2, 1.6])
    force = turn @ force if frame == "body" else force
    arm = turn @ [0.03, 0.02]
    np.testing.assert_allclose(
        bench.result.force[0], [*force, arm[0] * force[1] - arm[1] * force[0]], rtol=1e-12)


@pytest.mark.parametrize(("positive", "sign"), [("counterclockwise", 1.0), ("clockwise", -1.0)])
def test_torque_drive(positive: str, sign: float) -> None:
    """+tau on ``b`` and -tau on ``a``, in the hinge's own positive sense."""
    bench = thrown(mechanism(
        bodies=[mass("a", 0.1, (0, 0)), mass("b", 0.1, (0, 0))],
        joints=[{"type": "pin", "name": "j", "a": "a", "b": "b", "on_a": (0, 0),
                 "positive": positive}],
        drives=[{"type": "torque", "name": "t", "joint": "j", "value": 0.2}]), drive=[0.2])
    np.testing.assert_allclose(bench.result.force, [[0, 0, -0.2 * sign], [0, 0, 0.2 * sign]])


def test_pull_drive() -> None:
    """The tension is the drive's value; each guide feels T times the sum of units.

    An eye on (0, 0) between (-1, 0) and (0, -1) is drawn to (-1, -1) by T each way.
    """
    tension = 5.0
    bench = thrown(mechanism(
        bodies=[fixed("wall"), mass("b", 0.1, (0, 0))],
        tendons=[cord("t", ("wall", (-1.0, 0.0)), ("b",), ("wall", (0.0, -1.0)))],
        drives=[{"type": "pull", "name": "p", "tendon": "t", "value": 1.0}]), drive=[tension])
    out = bench.result.force
    assert bench.result.cords["tension"][0] == tension
    np.testing.assert_allclose(out[0], [-tension, -tension, 0.0], atol=1e-15)
    np.testing.assert_allclose(out[1], [tension, tension, -tension + tension], atol=1e-15)


@pytest.mark.parametrize("free", [("one", "two"), ("one",), ("two",)])
def test_a_damped_spring_does_not_ask_which_of_its_ends_is_a(free):
    """Two discs held off their centres by a damper as strong as the step bears: the same motion."""
    bodies = [
        {**disc(name, 0.02, at, velocity=speed, angular_velocity=turn)}
        if name in free else fixed(name, at=at)
        for name, at, speed, turn in (("one", (0.0, 0.0), (0.3, -0.2), 9.0),
                                      ("two", (0.1, 0.03), (-0.1, 0.4), -15.0))]
    ends = {"one": (0.004, 0.017), "two": (-0.013, 0.009)}
    runs = [simulate(mechanism(duration=0.05, bodies=bodies, springs=[{
        "type": "linear", "name": "band", "a": a, "b": b, "on_a": ends[a], "on_b": ends[b],
        "stiffness": 300.0, "damping": 60.0}])) for a, b in (("one", "two"), ("two", "one"))]
    for key in ("body_pose", "body_velocity", "spring_force", "spring_work"):
        one, other = (run.arrays[key] for run in runs)
        assert one == pytest.approx(other, rel=1e-9, abs=1e-12)
