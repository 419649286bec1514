"""Numbers in the tables of the compiled forces, found again without them."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.engine.state import DAMPED, ELASTIC, STIFF
from sandbox.scene.mechanism import Mechanism
from tests.engine.machines import H, cord, fixed, mechanism, parts

FAR = (0.0, 100.0)
"""So far that a stretch keeps its direction to 1e-3 while a body turns: the most, to 1e-6."""
BODIES: list[dict[str, Any]] = [
    fixed("wall"), {"name": "one", "mass": 0.02, "inertia": 3e-6, "centre": (0.003, -0.002)},
    {"name": "two", "mass": 0.5, "inertia": 2e-4, "at": (0.3, 0.1), "angle": 0.4}]


def path(poses: dict[str, np.ndarray], guides: list[tuple[str, tuple[float, float]]]) -> float:
    """Length of a cord through plain eyes."""
    points = []
    for body, (x, y) in guides:
        px, py, angle = poses.get(body, np.zeros(3))
        c, s = math.cos(angle), math.sin(angle)
        points.append((px + c * x - s * y, py + s * x + c * y))
    return sum(math.dist(p, q) for p, q in pairwise(points))


def response(
    machine: Mechanism, guides: list[tuple[str, tuple[float, float]]], poses: dict[str, np.ndarray],
) -> float:
    """J M^-1 J^T by central differences of the length over every coordinate of every free body."""
    total, by = 0.0, 1e-5
    for body in machine.bodies:
        if body.motion == "fixed":
            continue
        centre = np.array(body.centre or (0.0, 0.0))
        for k, inverse in enumerate((1 / body.mass, 1 / body.mass, 1 / body.inertia)):
            lengths = []
            for change in (by, -by):
                moved = poses[body.name].copy()
                moved[k] += change
                if k == 2:  # about the centre of mass, which stays
                    for angle, sign in ((poses[body.name][2], 1), (moved[2], -1)):
                        c, s = math.cos(angle), math.sin(angle)
                        moved[0] += sign * (c * centre[0] - s * centre[1])
                        moved[1] += sign * (s * centre[0] + c * centre[1])
                lengths.append(path({**poses, body.name: moved}, guides))
            total += inverse * ((lengths[0] - lengths[1]) / (2 * by)) ** 2
    return total


def largest(guides: list[tuple[str, tuple[float, float]]], **more: Any) -> tuple[Mechanism, float]:
    """A mechanism with one cord, and the bound that its row keeps."""
    machine = mechanism(bodies=BODIES, tendons=[cord("cord", *guides, **more)])
    return machine, float(parts(machine)[1].constants.cords["response"][0])


@pytest.mark.parametrize("guides", [
    [("wall", FAR), ("one", (0.013, 0.007))],
    [("one", (0.013, 0.007)), ("wall", FAR)],
    [("wall", FAR), ("one", (0.013, 0.007)), ("wall", FAR)],
    [("one", (-0.02, 0.01)), ("wall", FAR), ("two", (0.05, 0.02))],
    [("one", (-0.02, 0.01)), ("wall", FAR), ("two", (0.05, 0.02)), ("wall", FAR)],
], ids=["end", "start", "folded back", "both ends", "an end and a fold"])
def test_the_largest_response_is_the_most_that_any_pose_gives(guides):
    """Each body feels its pulls from far up; turned all the way round, one angle gives the most.

    With n angles the nearest is pi / n off, which takes the share (pi / n)^2 at most of the arms.
    """
    machine, bound = largest(guides)
    count = 720
    best = 0.0
    for angle in np.arange(count) * 2 * np.pi / count:
        poses = {name: np.array([0.0, 0.0, angle + off])
                 for name, off in (("one", 0.0), ("two", 0.0))}
        best = max(best, *(response(machine, guides, {**poses, "two": np.array([0, 0, other])})
                           for other in _opposite(guides, angle)))
    assert best <= bound * (1 + 1e-6)
    assert best == pytest.approx(bound, rel=(np.pi / count) ** 2 + 1e-5)


def _opposite(guides, angle):
    """Angles of the second body that put its arm square when the first's is, or nothing to look."""
    own = {name: at for name, at in guides if name != "wall"}
    if "two" not in own:
        return [0.0]
    centre = np.array(BODIES[1]["centre"])
    one, two = (np.arctan2(*(np.array(at) - off)[::-1])
                for at, off in ((own["one"], centre), (own["two"], 0)))
    return [angle + one - two, angle + one - two + np.pi]


def test_no_pose_of_a_crowded_cord_gives_more_than_its_largest_response():
    guides = [("one", (0.02, 0.0)), ("two", (0.01, -0.03)), ("one", (-0.015, 0.01)),
              ("two", (0.04, 0.0)), ("wall", (0.0, 0.2))]
    machine, bound = largest(guides)
    random = np.random.default_rng(3)
    found = [response(machine, guides, {
        name: np.array([*random.uniform(-0.1, 0.1, 2), random.uniform(-np.pi, np.pi)])
        for name in ("one", "two")}) for _ in range(500)]
    assert 0.25 * bound < max(found) <= bound * (1 + 1e-6)


def test_a_wheel_adds_its_radius_to_the_arm():
    """The cord leaves the wheel at its rim: at most |r| + radius from the centre of mass."""
    machine, bound = largest([("wall", FAR), ("two", (0.03, 0.04), 0.02, "right")])
    assert bound == pytest.approx(1 / 0.5 + (0.05 + 0.02) ** 2 / 2e-4, rel=1e-12)
    assert machine.tendons[0].guides[1].side == "right"
    assert largest([("wall", FAR), ("two", (0.03, 0.04), 0.02, "left")])[1] == bound


@pytest.mark.parametrize(("damping", "soft"), [(0.0, ELASTIC), (0.1, DAMPED)])
def test_a_cord_is_a_spring_where_the_step_is_short_for_its_largest_response(
    damping: float, soft: int,
) -> None:
    """h^2 k response up to 1: the pose tells its tension, or a row at mid-step; beyond, stiff."""
    guides = [("wall", FAR), ("one", (0.013, 0.007))]
    _, bound = largest(guides)
    kinds = []
    for share in (0.999, 1.001):
        step = math.sqrt(share / (1000.0 * bound))
        machine = mechanism(step=step, bodies=BODIES, tendons=[
            cord("cord", *guides, stiffness=1000.0, damping=damping)])
        cords = parts(machine)[1].constants.cords
        kinds.append(int(cords["kind"][0]))
        assert (cords["row"][0] >= 0) == (kinds[-1] != ELASTIC)
    assert kinds == [soft, STIFF]


@pytest.mark.parametrize(("damping", "soft"), [(0.0, ELASTIC), (0.1, DAMPED)])
def test_a_straight_spring_likewise(damping: float, soft: int) -> None:
    """Its largest response is 1/m + r^2/I of either end: here 1/0.5 + (0.05^2 + 0.02^2)/2e-4."""
    response = 1 / 0.5 + (0.05**2 + 0.02**2) / 2e-4
    kinds = []
    for share in (0.999, 1.001):
        step = math.sqrt(share / (1000.0 * response))
        springs = parts(mechanism(step=step, bodies=BODIES, springs=[
            {"type": "linear", "name": "s", "a": "wall", "b": "two", "on_b": (0.05, 0.02),
             "stiffness": 1000.0, "damping": damping}]))[1].constants.springs
        kinds.append(int(springs["kind"][0]))
        assert (springs["row"][0] >= 0) == (kinds[-1] != ELASTIC)
    assert kinds == [soft, STIFF]


def test_what_nothing_moves_has_no_row() -> None:
    """Cords and springs between fixed bodies: there is no velocity to ask for."""
    _, tables = parts(mechanism(
        bodies=[fixed("wall"), fixed("beam", at=(0.3, 0.0)), *BODIES[1:]],
        springs=[{"type": "linear", "name": "s", "a": "wall", "b": "beam", "stiffness": 10.0,
                  "damping": 1.0}],
        tendons=[cord("t", ("wall",), ("beam",))]))
    for table in (tables.constants.springs, tables.constants.cords):
        assert table["row"].tolist() == [-1]
    assert len(tables.constants.starts) == 1


def test_rows_of_joints_are_in_turn_and_all_different() -> None:
    """Two of a pin, three of a weld, one of a rod and of a slot that turns, two of a slider."""
    kinds = [("pin", {"on_a": (0, 0)}), ("weld", {"on_a": (0, 0)}), ("rod", {}),
             ("slot", {"start": (-1, 0), "end": (1, 0)}),
             ("slot", {"start": (-1, 0), "end": (1, 0), "turns": False}),
             ("rope", {"longest": 2.0})]
    _, tables = parts(mechanism(bodies=BODIES, joints=[
        {"type": kind, "name": f"j{i}", "a": "wall", "b": "two", **more}
        for i, (kind, more) in enumerate(kinds)]))
    rows = tables.constants.joints[["row", "row_y", "row_turn"]].tolist()
    held = [[i for i in row if i >= 0] for row in rows]
    assert [len(row) for row in held] == [2, 3, 1, 1, 2, 0]
    assert sorted(i for row in held for i in row) == list(range(9))
    for joint, own in zip(tables.constants.joints, held, strict=True):
        entries = tables.constants.entry_row[joint["entry"]:joint["entry"] + 2 * len(own)]
        assert entries.tolist() == [row for row in own for _ in range(2)]


def two_arms(springs: list[dict[str, Any]], damping: float = 1e-3) -> Mechanism:
    """Two arms pinned to a wall, their hinges damped [N m s/rad]."""
    bodies = [fixed("wall"), *({"name": name, "mass": 0.1, "inertia": 1e-4, "angle": angle}
                               for name, angle in (("one", 0.3), ("two", -0.2)))]
    joints = [{"type": "pin", "name": f"hinge_{name}", "a": "wall", "b": name, "on_a": (0, 0),
               "damping": damping} for name in ("one", "two")]
    return mechanism(bodies=bodies, joints=joints, springs=springs)


def test_all_dampers_of_a_hinge_add_up():
    """The hinge's own 1e-3 and two springs' 2e-3 and 4e-3 N m s/rad, on the second hinge only."""
    _, tables = parts(two_arms([
        {"type": "rotary", "name": name, "joint": "hinge_two", "stiffness": 0.0, "damping": c}
        for name, c in (("s1", 2e-3), ("s2", 4e-3))]))
    rows = tables.constants.dampers
    assert dict(zip(rows["joint"].tolist(), rows["c"].tolist(), strict=True)) == {
        0: 1e-3, 1: pytest.approx(7e-3, rel=1e-15)}


def test_the_work_of_a_torsion_spring_counts_from_where_it_begins():
    """k/2 (y0^2 - y^2), y the angle off its rest, with neither start nor rest at 0.

    Forces act at y_n over (y_(n+1) - y_(n-1)) / 2, which telescopes; with the leapfrog's
    y_(n+1) + y_(n-1) = (2 - h^2 k / I) y_n the y^2 of the pose counts as (1 - h^2 k / 2 I) y^2.
    At the start y_0 = y_1, half a step on either side of rest.
    """
    k, rest = 0.2, 0.25
    machine = two_arms([
        {"type": "rotary", "name": "s", "joint": "hinge_one", "stiffness": k, "rest_angle": rest}],
        damping=0.0)
    run = simulate(machine)
    y = run["hinge_one.angle"] - rest
    share = 1 - H**2 * k / 1e-4 / 2
    np.testing.assert_allclose(
        run["s.work"], k * (y[0]**2 - share * y**2) / 2, rtol=1e-11, atol=1e-16)
    assert abs(run["s.work"][0]) < 1e-3 * k * (0.3 - rest)**2
    assert np.ptp(y) > 1e-3
