"""The tendon network: lengths, gradients, the linear system and its slack tendons."""

from __future__ import annotations

import itertools
import math
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from sandbox.engine import tables as tables_module
from sandbox.engine.network import add_force, elimination, solve
from sandbox.engine.network import measure as measured
from sandbox.engine.state import (
    CORD,
    CORD_RESULT,
    GUIDE,
    GUIDE_RESULT,
    GUIDE_STATE,
    Constants,
    Result,
)
from sandbox.engine.tables import Tables
from sandbox.scene.mechanism import Mechanism

from .machines import H, cord, fixed, inverse_masses, mass, mechanism, parts, rows_of


@pytest.fixture(autouse=True)
def _all_solved_together(monkeypatch: pytest.MonkeyPatch) -> None:
    """No tendon is soft enough to be taken on its own."""
    monkeypatch.setattr(tables_module, "SOFT", -1.0)


class Path(NamedTuple):
    """One tendon's row, its guides, their memory and their rows of J."""

    cords: Any
    guides: Any
    memory: Any
    told: Any

    def pull(self, tension: float, force: np.ndarray) -> None:
        """Add its pull to ``force`` [nb, 3]."""
        cords = np.zeros(1, dtype=CORD_RESULT)
        cords["tension"] = tension
        none = np.zeros(0)
        empty = np.zeros(0, dtype=np.int64)
        add_force.py_func(
            Constants(H, none, none, none, none, none, self.cords, self.guides, empty,
                      empty, empty, empty),
            Result(none, none, none, none, cords, self.told, none), 0, force)


def path(*guides: tuple[int, float, float, float]) -> Path:
    """One tendon over guides (body, x, y, signed radius)."""
    rows = np.zeros(len(guides), dtype=GUIDE)
    for row, (body, x, y, radius) in zip(rows, guides, strict=True):
        row["body"], row["x"], row["y"], row["radius"] = body, x, y, radius
    cords = np.zeros(1, dtype=CORD)
    cords["last"] = len(guides)
    return Path(cords, rows, np.zeros(len(guides), GUIDE_STATE),
                np.zeros(len(guides), GUIDE_RESULT))


def measure(one: Path, pose: np.ndarray, start: bool) -> float:
    return measured(one.cords[0], one.guides, one.memory, one.told, pose, start)


def polyline(points: list[tuple[float, float]]) -> float:
    return sum(math.dist(p, q) for p, q in itertools.pairwise(points))


def test_eyes_make_a_polyline() -> None:
    """Rounding only. Body 1 is turned by 90 deg at (1, 2): its (0.1, 0.3) is at (0.7, 2.1)."""
    one = path((0, 0.0, 0.0, 0.0), (1, 0.1, 0.3, 0.0), (0, 0.5, 0.0, 0.0))
    pose = np.array([[0.0, 0.0, 0.0], [1.0, 2.0, math.pi / 2]])
    expected = polyline([(0.0, 0.0), (0.7, 2.1), (0.5, 0.0)])
    assert measure(one, pose, True) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(("side", "wrap"), [(1.0, math.pi / 2), (-1.0, 3 * math.pi / 2)],
                         ids=["right", "left"])
def test_wheel_between_two_eyes(side: float, wrap: float) -> None:
    """From (-L, 0) over a wheel at the origin to (0, -L), tangents of length sqrt(L^2 - r^2).

    The cord arrives along +x and leaves along -y, a turn of 90 deg clockwise. With the wheel on
    its right it takes, between the tangents, 90 deg + 2 asin(r / L) of the rim; on its left it
    goes round the other way and crosses itself: 270 deg + 2 asin(r / L).
    """
    far, radius = 0.1, 0.02
    one = path((0, -far, 0, 0), (0, 0, 0, side * radius), (0, 0, -far, 0))
    arc = radius * (wrap + 2 * math.asin(radius / far))
    expected = 2 * math.sqrt(far**2 - radius**2) + arc
    assert measure(one, np.zeros((1, 3)), True) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("sides", [(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)])
def test_belt_between_two_wheels(sides: tuple[float, float]) -> None:
    """Open belt: sqrt(d^2 - (r1 - r2)^2); crossed: sqrt(d^2 - (r1 + r2)^2). Wound on at both ends,
    what is wound counts from the start, so the length is that of the free stretch.
    """
    r1, r2, d = 0.02, 0.03, 0.1
    one = path((0, 0, 0, sides[0] * r1), (0, 0, d, sides[1] * r2))
    between = r1 - r2 if sides[0] == sides[1] else r1 + r2
    assert measure(one, np.zeros((1, 3)), True) == pytest.approx(
        math.sqrt(d**2 - between**2), rel=1e-14)


@pytest.mark.parametrize("side", [1.0, -1.0], ids=["right", "left"])
def test_a_cord_that_grazes_its_wheel_does_not_go_round_it(side: float) -> None:
    """Three points in line, the wheel touching from one side: the wrap is 0, not 2 pi, whichever
    way the rounding falls (here for 200 directions of the line).
    """
    radius = 0.01
    for angle in np.linspace(0, 2 * math.pi, 200):
        u = np.array([math.cos(angle), math.sin(angle)])
        centre = 0.05 * u + side * radius * np.array([u[1], -u[0]])
        one = path((0, 0, 0, 0), (0, *centre, side * radius), (0, *(0.1 * u), 0))
        assert measure(one, np.zeros((1, 3)), True) == pytest.approx(0.1, abs=1e-9)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("place", [0, 1])
def test_wound_end_pays_out_for_many_turns(place: int, side: float) -> None:
    """A wheel turned by phi takes up r phi of cord, for three turns, in steps of 0.1 rad.

    Walking from the first guide, a wheel at the start on the right (s = +1) pays out when it turns
    counter-clockwise; at the end the same turn takes up: dL = ± s r dphi. The other guide is far
    off and does not move, so the tangent stays where it is.
    """
    radius = 0.02
    guides = [(0, 0.0, 0.0, side * radius), (1, 0.0, 0.5, 0.0)]
    one = path(*(guides if place == 0 else guides[::-1]))
    pose = np.zeros((2, 3))
    start = measure(one, pose, True)
    assert start == pytest.approx(math.sqrt(0.25 - radius**2), rel=1e-14)
    for phi in np.arange(0, 6 * math.pi, 0.1):
        pose[0, 2] = phi
        sign = side if place == 0 else -side
        assert measure(one, pose, False) - start == pytest.approx(
            sign * radius * phi, abs=1e-12)


def test_wrap_is_continuous_for_more_than_a_turn() -> None:
    """An eye circles a wheel twice, in steps of 3 deg: the length grows by r dphi each time."""
    radius, far = 0.02, 0.1
    one = path((0, -far, 0.0, 0), (0, 0, 0, radius), (1, 0.0, 0.0, 0))
    pose = np.zeros((2, 3))
    lengths = []
    for i in range(241):
        phi = -math.radians(3 * i)
        pose[1, :2] = far * math.cos(phi), far * math.sin(phi)
        lengths.append(measure(one, pose, i == 0))
    np.testing.assert_allclose(np.diff(lengths), radius * math.radians(3), rtol=1e-9)


def random_path(draw: Any) -> tuple[Path, np.ndarray]:
    """Guides on four bodies that stand far enough apart for every wheel to be passed."""
    count = draw(st.integers(2, 6))
    unit = st.floats(-1, 1)
    guides = []
    for i in range(count):
        radius = draw(st.sampled_from([0.0, 0.02, -0.02, 0.05, -0.05]))
        guides.append((i % 4, 0.05 * draw(unit), 0.05 * draw(unit), radius))
    pose = np.array([[0.5 * i + 0.05 * draw(unit), 0.3 * (i % 2) + 0.05 * draw(unit),
                      3 * draw(unit)] for i in range(4)])
    return path(*guides), pose


@settings(deadline=None, max_examples=60)
@given(st.data())
def test_gradient(data: Any) -> None:
    """J = dL/dq against central differences with e = 1e-5: e^2 / 6 times the third derivative.

    Guides are at least 0.2 m apart and arms at most 0.13 m, so third derivatives stay below some
    100 / m^2: 2e-9, and as much again for rounding 1e-16 * 3 m / 1e-5 = 3e-11.
    """
    one, pose = random_path(data.draw)
    measure(one, pose, True)
    exact = np.zeros((4, 3))
    one.pull(-1.0, exact)
    numeric = np.zeros((4, 3))
    for b, axis in itertools.product(range(4), range(3)):
        for sign in (1, -1):
            moved = pose.copy()
            moved[b, axis] += sign * 1e-5
            numeric[b, axis] += sign * measure(one, moved, False) / 2e-5
    np.testing.assert_allclose(exact, numeric, atol=2e-8)
    # a cord is inside the mechanism: its forces and moments about the origin add up to nothing
    np.testing.assert_allclose(exact[:, :2].sum(axis=0), 0, atol=1e-12)
    moments = exact[:, 2] + pose[:, 0] * exact[:, 1] - pose[:, 1] * exact[:, 0]
    assert abs(moments.sum()) < 1e-12


def net(seed: int, tendons: int, bodies: int = 4) -> tuple[Mechanism, Tables]:
    """Random tendons over some free bodies and a fixed one, stretched or slack by up to 2 mm."""
    rng = np.random.default_rng(seed)
    names = ["wall", *(f"b{i}" for i in range(bodies))]
    spec = [fixed("wall"), *(
        {"name": n, "mass": 10 ** rng.uniform(-3, 0), "inertia": 10 ** rng.uniform(-6, -3),
         "at": rng.uniform(-0.3, 0.3, 2).tolist()} for n in names[1:])]
    cords = [cord(f"t{i}", *((str(n), rng.uniform(-0.1, 0.1, 2).tolist())
                             for n in rng.choice(names, 3, replace=False)),
                  stiffness=10 ** rng.uniform(2, 5), damping=rng.uniform(0, 20))
             for i in range(tendons)]
    machine = mechanism(bodies=spec, tendons=cords)
    tables = parts(machine)[1]
    tables.constants.cords["rest"] += rng.uniform(-2e-3, 2e-3, tendons)
    return machine, tables


def dense(tables: Tables, h: float, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The matrix and right side of the module's equation, from dense J and M."""
    J, w, cords = rows_of(tables), inverse_masses(tables), tables.constants.cords
    lead = cords["c"] + h * cords["k"]
    A = np.diag(1 / (h * lead)) + (J * w) @ J.T
    stretch = tables.result.cords["length"] - cords["rest"]
    rhs = cords["k"] * stretch + lead * (J @ velocity.ravel())
    return A, rhs / (h * lead)


def solved(tables: Tables, h: float, velocity: np.ndarray) -> np.ndarray:
    solve(tables.constants._replace(h=h), tables.state, tables.result, velocity)
    return tables.result.cords["tension"].copy()


def by_hand(A: np.ndarray, rhs: np.ndarray) -> np.ndarray:
    """T >= 0, A T - rhs >= 0, T (A T - rhs) = 0, by trying every set of taut tendons."""
    m = len(rhs)
    found = []
    for taut in itertools.product([False, True], repeat=m):
        on = np.array(taut)
        T = np.zeros(m)
        T[on] = np.linalg.solve(A[np.ix_(on, on)], rhs[on])
        left = A @ T - rhs
        if (T >= 0).all() and (left[~on] >= 0).all():
            found.append(T)
    assert len(found) == 1  # A is positive definite
    return found[0]


@pytest.mark.parametrize("seed", range(30))
def test_slack_tendons_are_found(seed: int) -> None:
    """The same set as brute force finds, started from whatever set the last step left."""
    h = 5e-4
    rng = np.random.default_rng(seed)
    tendons = int(rng.integers(1, 7))
    _, tables = net(seed, tendons)
    velocity = rng.uniform(-0.2, 0.2, (5, 3))
    tables.state.cords["active"] = rng.integers(0, 2, tendons)
    A, rhs = dense(tables, h, velocity)
    expected = by_hand(A, rhs)
    np.testing.assert_allclose(solved(tables, h, velocity), expected,
                               rtol=1e-13 * np.linalg.cond(A), atol=1e-12 * abs(rhs).max())


@pytest.mark.parametrize("seed", range(8))
def test_forty_tendons_on_few_bodies(seed: int) -> None:
    """Too many for brute force: min |R T - R^-T rhs| with T >= 0, A = R^T R, is the same problem
    (its optimality conditions are those of ``by_hand``), and nnls solves it.
    """
    h = 1e-3
    _, tables = net(100 + seed, 40, bodies=6)
    velocity = np.random.default_rng(seed).uniform(-0.2, 0.2, (7, 3))
    A, rhs = dense(tables, h, velocity)
    R = np.linalg.cholesky(A).T
    expected = nnls(R, np.linalg.solve(R.T, rhs))[0]
    scale = expected.max()
    np.testing.assert_allclose(solved(tables, h, velocity), expected, atol=1e-8 * scale)
    assert 5 < (expected > 0).sum() < 38


@settings(deadline=None, max_examples=50)
@given(st.data())
def test_elimination_is_a_factorisation(data: Any) -> None:
    """For random sparsity the columns named hold all of the Cholesky factor in that order."""
    n = data.draw(st.integers(1, 12))
    links = data.draw(st.sets(st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)), max_size=20))
    groups: list[set[int]] = [{i} for i in range(n)]
    for i, j in links:
        groups[i].add(j)
        groups[j].add(i)
    order, columns = elimination(groups)
    assert sorted(order) == list(range(n))
    rng = np.random.default_rng(n)
    A = np.zeros((n, n))
    for i, group in enumerate(groups):
        for j in group - {i}:
            A[i, j] = A[j, i] = rng.uniform(-1, 1) if A[i, j] == 0 else A[i, j]
    A += n * np.eye(n)
    L = np.linalg.cholesky(A[np.ix_(order, order)])
    for i, row in enumerate(columns):
        assert row == sorted(row)
        missing = set(range(i)) - set(row)
        np.testing.assert_allclose(L[i, list(missing)], 0, atol=1e-14)


@pytest.mark.parametrize("leaves", [4, 16, 64, 256])
def test_binary_trees_fill_little(leaves: int) -> None:
    """Rockers: node i meets its parent and its brother, three links a rocker.

    Such a graph has treewidth 2: there is always a node that meets at most two others, and taking
    it out leaves another such graph. So at most two entries a row, below 2 n in all.
    """
    count = 2 * leaves - 1
    groups: list[set[int]] = [set() for _ in range(count)]
    for i in range(1, count):
        parent, brother = (i - 1) // 2, i + 1 if i % 2 else i - 1
        groups[i] |= {parent, brother}
        groups[parent].add(i)
    _, columns = elimination(groups)
    assert 3 * (leaves - 1) <= sum(len(row) for row in columns) <= 2 * count


def test_tendon_between_fixed_bodies_only() -> None:
    """No body answers: the tension is k times the stretch, whatever the step."""
    machine = mechanism(
        bodies=[fixed("a"), fixed("b", at=(0.3, 0.0)), mass("load", 0.1, (0.0, 1.0))],
        tendons=[cord("t", ("a",), ("b",), stiffness=500.0, rest_length=0.28)])
    _, tables = parts(machine)
    assert solved(tables, 5e-4, np.zeros((3, 3))) == pytest.approx([500 * 0.02], rel=1e-12)
