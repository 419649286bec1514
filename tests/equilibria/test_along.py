"""Branches of equilibria and their folds, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

import sandbox
from sandbox.equilibria.branches import Branch, rest_along
from sandbox.equilibria.following import Along, OnBranch
from sandbox.errors import SceneError
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import read_scene
from tests.equilibria.scenes import ARM, MASS, G, pendulum

HALF, RISE, K = 0.1, 0.03, 1000.0
LENGTH = math.hypot(HALF, RISE)
TOP = math.sqrt(LENGTH ** (2 / 3) * HALF ** (4 / 3) - HALF**2)
"""Where the truss has no stiffness left."""


def load(y: float) -> float:
    """What von Mises' truss bears."""
    return 2 * K * (LENGTH / math.hypot(HALF, y) - 1) * y


def truss(value: float) -> Mechanism:
    return read_scene("snap_through", overrides={"parameters.load": value}).mechanism


@pytest.fixture(scope="module")
def branches() -> list[Branch]:
    return rest_along(truss, 0.0, 1.5, 11)


def test_every_point_of_a_truss_that_snaps_through(branches: list[Branch]):
    first, second = branches
    for stop in (*first.stops, *second.stops):
        assert stop.value == pytest.approx(load(stop.rest["node.y"]), abs=5e-9)
        stiff = abs(stop.rest["node.y"]) > TOP
        if not stop.fold:
            assert stop.rest.stability == ("stable" if stiff else "unstable")
    assert first.ends == second.ends == ""
    on_grid = {round(stop.value, 9) for stop in (*first.stops, *second.stops)}
    assert on_grid >= {round(value, 9) for value in np.linspace(0, 1.5, 11).tolist()}


def test_its_fold(branches: list[Branch]):
    """The load is off by the square of how far the fold is missed, the place by that itself."""
    (fold,), () = branches[0].folds, branches[1].folds
    assert fold.value == pytest.approx(load(TOP), rel=1e-9)
    assert fold.rest["node.y"] == pytest.approx(TOP, abs=1e-8)


@pytest.mark.nightly
def test_both_folds_where_the_range_holds_them():
    """From -1.5 to 1.5 N the branch goes round both and leaves at the other end."""
    branch, = rest_along(truss, -1.5, 1.5, 13)
    low = branch.stops[0]
    assert low.rest["node.y"] > RISE
    assert [round(fold.value, 8) for fold in branch.folds] == [
        round(load(TOP), 8), round(-load(TOP), 8)]
    assert branch.stops[-1].value == 1.5


def test_along_a_stiffness_and_not_a_load():
    """k a = m g l sin a of a pendulum with its spring at rest at 0.1 rad."""
    def make(k: float) -> Mechanism:
        return read_scene(pendulum(k, rest_angle=0.1)).mechanism

    branch, = rest_along(make, 0.5, 0.15, 6)
    for stop in branch.stops:
        angle = stop.rest["hinge.angle"]
        assert stop.value * (angle - 0.1) == pytest.approx(
            MASS * G * ARM * math.sin(angle), abs=1e-9)
        assert stop.rest.stability == "stable"


def test_along_a_length_that_joints_hang_on():
    """A finger on a disc that goes nearer: joints and contacts move with the value."""
    def make(x: float) -> Mechanism:
        return read_scene("single_finger", overrides={"bodies[0].at[0]": x}).mechanism

    found = rest_along(make, 0.0110543, 0.0112, 3)
    end = next(stop for stop in found[0].stops if stop.value == 0.0112)
    there, = sandbox.rest(make(0.0112)).rests
    for name in ("finger.mcp.angle", "finger.distal/disc.normal"):
        assert end.rest[name] == pytest.approx(there[name], rel=1e-6)


def test_what_is_no_range():
    with pytest.raises(SceneError, match="is no range"):
        rest_along(truss, 1.0, 1.0, 5)


def test_what_has_no_stiffness_told():
    with pytest.raises(SceneError, match="its stiffness is not told, for fluids"):
        rest_along(lambda _: read_scene("pneumatic_hand").mechanism, 0.0, 1.0, 3)


def test_a_branch_leads_where_it_says():
    """On a rail at x = p, hung by a spring from the origin, moved by p: the tangent is dy/dp."""
    def make(p: float) -> Mechanism:
        return read_scene({
            "format": 1, "run": {"duration": 1.0}, "gravity": [0, -G],
            "bodies": [{"name": "wall", "motion": "fixed"},
                       {"name": "bead", "at": [p, -0.2], "mass": 0.3,
                        "shapes": [{"type": "circle", "radius": 0.01}]}],
            "joints": [{"type": "slot", "name": "rail", "a": "wall", "b": "bead",
                        "start": [p, -1], "end": [p, 1], "turns": False}],
            "springs": [{"type": "linear", "name": "spring", "a": "wall", "b": "bead",
                         "on_a": [0, 0], "on_b": [0, 0], "stiffness": 30.0,
                         "rest_length": 0.1}]}).mechanism

    along = Along(make, None, 0.1)

    def found(p: float) -> OnBranch:
        search = along.at(p)
        search.follow()
        balance = search.settle()
        assert balance is not None
        return along.point(p, balance, None)

    one, two = found(0.05), found(0.05 + 1e-5)
    way = (two.pose - one.pose)[1, :2] / 1e-5
    told = one.way[:2] / one.way[-1] * one.balance.size / along.span
    np.testing.assert_allclose(told, way, rtol=1e-3, atol=1e-6)
