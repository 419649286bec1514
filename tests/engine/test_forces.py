"""Springs, dampers and drives, one call of ``apply_forces`` at a time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sandbox.engine.forces import apply_forces
from sandbox.engine.simulate import simulate
from sandbox.engine.tables import Tables
from sandbox.engine.world import World
from sandbox.scene.mechanism import Mechanism

from .machines import cord, disc, fixed, inverse_masses, mass, mechanism, parts

H = 5e-4


def forces(
    world: World, tables: Tables, *, velocity: Any = None, before: Any = None, drive: Any = (),
) -> np.ndarray:
    """Force and torque on every body [nb, 3] in a first step, for velocities given [nb, 3]."""
    body = world.body.copy()
    if velocity is not None:
        body[:, 3:] = velocity
    then = body[:, 3:].copy() if before is None else np.array(before, dtype=float)
    state = tables.state._replace(body=body, before=then, force=np.zeros((len(body), 3)))
    apply_forces(tables.constants, state, tables.result, np.array(drive, dtype=float))
    np.testing.assert_array_equal(then, body[:, 3:])
    return state.force


def predicted(world: World, velocity: Any) -> np.ndarray:
    """Pose at which pymunk will apply the forces, [nb, 3]."""
    return world.body[:, :3] + world.h * np.asarray(velocity)


def moments(world: World, velocity: Any, out: np.ndarray) -> np.ndarray:
    """Sum of forces and of moments about the world's origin, [3]."""
    pose = predicted(world, velocity)
    about = out[:, 2] + pose[:, 0] * out[:, 1] - pose[:, 1] * out[:, 0]
    return np.array([*out[:, :2].sum(axis=0), about.sum()])


# -- springs ---------------------------------------------------------------------


def linear(**more: Any) -> tuple[World, Tables]:
    """A spring from the wall's (0.1, 0) to (0, 0.05) of a body at (0.3, 0.2), turned 90 deg."""
    return parts(mechanism(
        bodies=[fixed("wall"),
                {"name": "b", "mass": 0.2, "inertia": 1e-4, "at": (0.3, 0.2), "angle": np.pi / 2}],
        springs=[{"type": "linear", "name": "s", "a": "wall", "b": "b", "on_a": (0.1, 0.0),
                  "on_b": (0.0, 0.05), "stiffness": 300.0, **more}]))


def test_spring_at_the_predicted_pose() -> None:
    """k (L - L0) along the line between the points, at x + h v: rounding."""
    world, tables = linear(rest_length=0.1)
    velocity = np.array([[3.0, -2.0, 50.0], [0.0, 0.0, 0.0]])
    out = forces(world, tables, velocity=velocity)
    x, y, angle = predicted(world, velocity)[0]
    end = np.array([x - 0.05 * np.sin(angle), y + 0.05 * np.cos(angle)])
    line = end - [0.1, 0.0]
    force = -300.0 * (np.linalg.norm(line) - 0.1) * line / np.linalg.norm(line)
    arm = end - [x, y]
    np.testing.assert_allclose(
        out[0], [*force, arm[0] * force[1] - arm[1] * force[0]], rtol=1e-12)
    assert tables.result.springs["length"][0] == pytest.approx(np.linalg.norm(line), rel=1e-14)


def test_spring_pushes_when_short() -> None:
    """Rest length 1 m, standing 0.25 m long (wall's point to (0.25, 0.2)): pushed away."""
    world, tables = linear(rest_length=1.0)
    out = forces(world, tables)
    assert tables.result.springs["force"][0] == pytest.approx(300 * (0.25 - 1.0), rel=1e-12)
    assert out[0, :2] == pytest.approx(300 * 0.75 * np.array([0.15, 0.2]) / 0.25, rel=1e-12)


def test_spring_of_no_length_is_harmless() -> None:
    """Its ends on one point: no direction, no force, no NaN."""
    world, tables = parts(mechanism(
        bodies=[fixed("wall"), mass("b", 0.1, (0.0, 0.0))],
        springs=[{"type": "linear", "name": "s", "a": "wall", "b": "b", "stiffness": 100.0,
                  "damping": 1.0, "rest_length": 0.1}]))
    np.testing.assert_array_equal(forces(world, tables), 0.0)


def test_linear_damper_rule() -> None:
    """F = F' + (c (1.5 v - 0.5 v') - F') / (1 + h c (1/m + r^2/I) / 2), F' = 0 to begin with.

    In its second step F' is the first one's force.
    """
    world, tables = linear(stiffness=0.0, damping=8.0)
    now, then = [[1.0, -0.5, 4.0], [0, 0, 0]], [[0.8, -0.1, 3.0], [0, 0, 0]]
    x, y, angle = predicted(world, now)[0]
    arm = 0.05 * np.array([-np.sin(angle), np.cos(angle)])
    u = np.array([x, y]) + arm - [0.1, 0.0]
    u /= np.linalg.norm(u)
    row = np.array([*u, arm[0] * u[1] - arm[1] * u[0]])
    free = row**2 @ [1 / 0.2, 1 / 0.2, 1 / 1e-4]
    wanted = 8.0 * row @ (1.5 * np.array(now[0]) - 0.5 * np.array(then[0]))
    first = wanted / (1 + 0.5 * H * 8.0 * free)
    out = forces(world, tables, velocity=now, before=then)
    np.testing.assert_allclose(out[0], -first * row, rtol=1e-12)
    out = forces(world, tables, velocity=now, before=then)
    second = first + (wanted - first) / (1 + 0.5 * H * 8.0 * free)
    np.testing.assert_allclose(out[0], -second * row, rtol=1e-12)


def test_linear_dampers_of_one_body_answer_together() -> None:
    """Two alike side by side: each divides by 1 + 2 h c (1/m + r^2/I) / 2, for both act."""
    world, tables = parts(mechanism(
        bodies=[fixed("wall"), mass("b", 0.1, (0.3, 0.0))],
        springs=[{"type": "linear", "name": name, "a": "wall", "b": "b", "stiffness": 0.0,
                  "damping": 6.0} for name in ("s", "t")]))
    out = forces(world, tables, velocity=[[0.5, 0.0, 0.0], [0, 0, 0]],
                 before=[[0.4, 0.0, 0.0], [0, 0, 0]])
    each = 6.0 * (1.5 * 0.5 - 0.5 * 0.4) / (1 + 0.5 * H * 6.0 / 0.1 * 2)
    np.testing.assert_allclose(tables.result.springs["force"], [each, each], rtol=1e-12)
    np.testing.assert_allclose(out[0], [-2 * each, 0, 0], rtol=1e-12)


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
    """(I + h/2 C A) (tau - tau') = -C (1.5 omega - 0.5 omega') - tau', A = D M^-1 D^T, dense.

    Three steps of random velocities, all hinges in one matrix here; the engine has one a chain.
    """
    world, tables = parts(chains())
    n = {name: world.number[i] for name, i in world.model.names.body.items()}
    pairs = [(n["wall" if i == 0 else f"{chain}{i - 1}"], n[f"{chain}{i}"])
             for chain in "pq" for i in range(3)]
    C = np.diag([1e-3, 2e-3, 3e-3, 1e-3, 2e-3, 3e-3 + 5e-3])
    D = np.zeros((6, 7))
    for i, (a, b) in enumerate(pairs):
        D[i, a], D[i, b] = -1, 1
    A = D @ np.diag(inverse_masses(tables)[2::3]) @ D.T
    assert sorted(tables.constants.dampers["size"]) == [3] * 6
    rng = np.random.default_rng(0)
    tau, then = np.zeros(6), rng.uniform(-9, 9, (7, 3))
    for _ in range(3):
        now = rng.uniform(-9, 9, (7, 3)) * (np.arange(7) != n["wall"])[:, None]
        omega, omega_then = D @ now[:, 2], D @ then[:, 2]
        out = forces(world, tables, velocity=now, before=then)
        tau = tau + np.linalg.solve(
            np.eye(6) + H / 2 * C @ A, -C @ (1.5 * omega - 0.5 * omega_then) - tau)
        np.testing.assert_allclose(out[:, 2], D.T @ tau, rtol=1e-11, atol=1e-15)
        np.testing.assert_array_equal(out[:, :2], 0.0)
        then = now


# -- inside the mechanism nothing is gained -----------------------------------------


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10**6))
def test_actio_est_reactio(seed: int) -> None:
    """Springs, dampers, tendons and hinge torques between free bodies: sum of forces and of moments
    is zero, to rounding of the largest term.
    """
    rng = np.random.default_rng(seed)
    names = ["a", "b", "c"]
    bodies = [{"name": n, "mass": 0.1, "inertia": 1e-4, "angle": rng.uniform(-3, 3),
               "at": rng.uniform(-1, 1, 2).tolist()} for n in names]

    def spot() -> list[float]:
        return rng.uniform(-0.1, 0.1, 2).tolist()

    world, tables = parts(mechanism(
        bodies=bodies,
        joints=[{"type": "pin", "name": "j", "a": "a", "b": "b", "on_a": spot(), "damping": 0.01,
                 "positive": "clockwise"}],
        springs=[{"type": "linear", "name": "s", "a": "b", "b": "c", "on_a": spot(), "on_b": spot(),
                  "stiffness": 200.0, "damping": 3.0, "rest_length": 0.2}],
        tendons=[cord("pulled", ("a", spot()), ("b", spot(), 0.03, "right"), ("c", spot(), 0.02)),
                 cord("stiff", ("c", spot(), 0.01), ("a", spot()), ("b", spot()),
                      rest_length=0.01)],
        drives=[{"type": "torque", "name": "t", "joint": "j", "value": 0.3},
                {"type": "pull", "name": "p", "tendon": "pulled", "value": 7.0}]))
    velocity = rng.uniform(-1, 1, (3, 3))
    out = forces(world, tables, velocity=velocity, drive=[0.3, 7.0])
    assert (tables.result.cords["tension"] > 0).all()
    np.testing.assert_allclose(
        moments(world, velocity, out), 0.0, atol=1e-13 * max(1.0, abs(out).max()))


# -- drives --------------------------------------------------------------------------


@pytest.mark.parametrize("frame", ["world", "body"])
def test_force_drive(frame: str) -> None:
    """F along its direction (of any length), turned with the body or not; torque r x F about the
    centre of mass, which is not the frame's origin here.
    """
    world, tables = parts(mechanism(
        bodies=[{"name": "b", "mass": 0.1, "inertia": 1e-4, "at": (1.0, 2.0), "angle": 0.6,
                 "centre": (0.02, 0.01)}],
        drives=[{"type": "force", "name": "f", "body": "b", "at": (0.05, 0.03),
                 "direction": (3.0, 4.0), "frame": frame, "value": 2.0}]))
    velocity = np.array([[0.3, 0.1, 20.0]])
    out = forces(world, tables, velocity=velocity, drive=[2.0])
    angle = 0.6 + world.h * 20.0
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    force = np.array([1.2, 1.6])
    force = turn @ force if frame == "body" else force
    arm = turn @ [0.03, 0.02]
    np.testing.assert_allclose(
        out[0], [*force, arm[0] * force[1] - arm[1] * force[0]], rtol=1e-12)


@pytest.mark.parametrize(("positive", "sign"), [("counterclockwise", 1.0), ("clockwise", -1.0)])
def test_torque_drive(positive: str, sign: float) -> None:
    """+tau on ``b`` and -tau on ``a``, in the hinge's own positive sense."""
    world, tables = parts(mechanism(
        bodies=[mass("a", 0.1, (0, 0)), mass("b", 0.1, (0, 0))],
        joints=[{"type": "pin", "name": "j", "a": "a", "b": "b", "on_a": (0, 0),
                 "positive": positive}],
        drives=[{"type": "torque", "name": "t", "joint": "j", "value": 0.2}]))
    out = forces(world, tables, drive=[0.2])
    np.testing.assert_allclose(out, [[0, 0, -0.2 * sign], [0, 0, 0.2 * sign]])


def test_pull_drive() -> None:
    """The tension is the drive's value; each guide feels T times the sum of units.

    An eye on (0, 0) between (-1, 0) and (0, -1) is drawn to (-1, -1) by T each way.
    """
    world, tables = parts(mechanism(
        bodies=[fixed("wall"), mass("b", 0.1, (0, 0))],
        tendons=[cord("t", ("wall", (-1.0, 0.0)), ("b",), ("wall", (0.0, -1.0)))],
        drives=[{"type": "pull", "name": "p", "tendon": "t", "value": 1.0}]))
    tension = 5.0
    out = forces(world, tables, drive=[tension])
    assert tables.result.cords["tension"][0] == tension
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
