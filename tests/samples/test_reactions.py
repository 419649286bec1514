"""Joint reactions from the balance of bodies, on machines with a known answer."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.samples.loads import Loads
from sandbox.samples.reactions import joint_reactions, solve
from tests.engine.machines import G, cord, disc, fixed, mass, mechanism
from tests.recording.sample import recording


def run_of(*bodies, duration=0.02, **more):
    return simulate(mechanism(
        gravity=(0.0, -G), bodies=[fixed("wall"), *bodies], duration=duration, **more))


def size_errors(run):
    """Largest difference between |R| and the solver's impulse / h, of every joint [N]."""
    found = joint_reactions(run)
    return np.abs(np.hypot(found[..., 0], found[..., 1]) - run.arrays["joint_reaction"]).max(axis=0)


def test_a_hanging_body_pulls_its_pin_up_with_its_weight():
    run = run_of(mass("bob", 0.5, (0.0, -0.1)), joints=[
        {"type": "pin", "name": "pin", "a": "wall", "b": "bob", "on_a": (0, 0)}])
    assert joint_reactions(run)[:, 0] == pytest.approx(
        np.broadcast_to([0.0, 0.5 * G], (len(run), 2)), abs=1e-12)
    assert run["pin.reaction_x"] == pytest.approx(0.0, abs=1e-12)
    assert run["pin.reaction_y"] == pytest.approx(0.5 * G)
    assert run.unit("pin.reaction_y") == "N"


def test_a_pin_whose_b_is_the_wall_counts_the_force_on_the_wall():
    run = run_of(mass("bob", 0.5, (0.0, -0.1)), joints=[
        {"type": "pin", "name": "pin", "a": "bob", "b": "wall", "on_b": (0, 0)}])
    assert run["pin.reaction_y"] == pytest.approx(-0.5 * G)


def test_a_chain_carries_all_that_hangs_below():
    bodies = [mass(f"bob{i}", 0.1 * (i + 1), (0.0, -0.1 * (i + 1))) for i in range(3)]
    joints = [{"type": "pin", "name": f"pin{i}", "a": "wall" if i == 0 else f"bob{i - 1}",
               "b": f"bob{i}", "on_b": (0, 0.1)} for i in range(3)]
    run = run_of(*bodies, joints=joints)
    carried = np.array([0.6, 0.5, 0.3]) * G
    assert joint_reactions(run)[-1, :, 1] == pytest.approx(carried)


@pytest.mark.parametrize("joint", [
    {"type": "rope", "longest": 0.1}, {"type": "rod"},
    {"type": "weld", "on_a": (0, 0)},
    {"type": "slot", "start": (-0.1, -0.1), "end": (0.1, -0.1), "turns": False},
])
def test_every_kind_of_joint_carries_a_weight(joint):
    run = run_of(mass("bob", 0.5, (0.0, -0.1)), duration=0.1,
                 joints=[{"name": "joint", "a": "wall", "b": "bob", **joint}])
    # a rope's end comes to rest by shares of what is left; what it carries by then is m (g + a)
    assert joint_reactions(run)[-1, 0] == pytest.approx([0.0, 0.5 * G], abs=1e-4 * 0.5 * G)
    assert size_errors(run) == pytest.approx(0.0, abs=1e-12)


def test_a_body_between_two_ropes_and_a_wind():
    """Two ropes at 45 degrees share the weight; a sideways force loads the one behind."""
    run = run_of(
        mass("bob", 0.5, (0.0, -0.1)), duration=0.1,
        joints=[{"type": "rod", "name": f"rod{x + 1}", "a": "wall", "b": "bob",
                 "on_a": (0.1 * x, 0.0)} for x in (-1, 1)],
        drives=[{"type": "force", "name": "wind", "body": "bob", "direction": (1, 0), "value": 1}])
    along = np.array([0.5 * G + 1, 0.5 * G - 1]) / 2  # vertical share of each
    found = joint_reactions(run)[-1]
    assert found == pytest.approx(np.column_stack([along * [-1, 1], along]), abs=1e-6)
    assert size_errors(run) == pytest.approx(0.0, abs=1e-9)


def four_bar():
    links = [("crank", 0.1, (0.0, 0.0), (0.0, 0.1)), ("coupler", 0.2, (0.0, 0.1), (0.2, 0.15)),
             ("rocker", 0.15, (0.25, 0.0), (0.2, 0.15))]
    bodies = [mass(name, weight, start) for name, weight, start, _ in links]
    ends = [("wall", "crank", (0.0, 0.0)), ("crank", "coupler", (0.0, 0.1)),
            ("coupler", "rocker", (0.2, 0.05)), ("wall", "rocker", (0.25, 0.0))]
    joints = [{"type": "pin", "name": f"pin{i}", "a": a, "b": b, "on_a": at}
              for i, (a, b, at) in enumerate(ends)]
    return bodies, joints


def test_a_ring_of_four_pins_is_solved_as_a_whole():
    bodies, joints = four_bar()
    run = run_of(*bodies, joints=joints, duration=0.1)
    solved = solve(Loads(run))
    assert set(solved.how.values()) == {"loop"}
    largest = run.arrays["joint_reaction"].max()
    assert size_errors(run).max() < 1e-9 * largest


def test_supports_that_share_a_load_are_not_determined():
    """A beam welded at both ends: six unknowns, three equations."""
    run = run_of(mass("beam", 0.5, (0.0, 0.0)), joints=[
        {"type": "weld", "name": f"end{i}", "a": "wall", "b": "beam", "on_b": (x, 0)}
        for i, x in enumerate((-0.1, 0.1))])
    solved = solve(Loads(run))
    assert np.isnan(joint_reactions(run)).all()
    assert "more unknown forces than equations" in solved.why[0]


def test_two_ropes_in_line_are_not_determined():
    run = run_of(mass("bob", 0.5, (0.0, -0.1)), joints=[
        {"type": "rod", "name": f"rod{i}", "a": "wall", "b": "bob"} for i in range(2)])
    assert np.isnan(joint_reactions(run)).all()


def test_a_wheel_with_a_wound_cord_balances_its_torque():
    """A hanging weight on a wheel of radius r, held by a rotary spring: the axle carries both."""
    run = simulate(mechanism(
        duration=0.1, gravity=(0.0, -G),
        bodies=[fixed("wall"), disc("wheel", 0.05, (0.0, 0.0)), mass("load", 0.2, (-0.05, -0.2))],
        joints=[{"type": "pin", "name": "axle", "a": "wall", "b": "wheel", "on_a": (0, 0)},
                {"type": "slot", "name": "guide", "a": "wall", "b": "load",
                 "start": (-0.05, -0.5), "end": (-0.05, 0.0), "turns": False}],
        springs=[{"type": "rotary", "name": "coil", "joint": "axle", "stiffness": 2.0,
                  "damping": 0.01}],
        tendons=[cord("cord", ("load",), ("wheel", (0, 0), 0.05, "right"))]))
    solved = solve(Loads(run))
    weight = 0.3 * G
    assert size_errors(run).max() < 1e-12 * weight
    assert np.abs(solved.left[2]).max() < 1e-12 * weight * 0.05


def test_a_recording_without_samples_has_no_rows():
    assert joint_reactions(recording().part(0, 0)).shape == (0, 3, 2)
