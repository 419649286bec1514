"""Rows with bounds: modes against all modes there are, against scipy, and where nothing decides."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from sandbox.engine.bounded import HOLD, HOLD_TANGENT, relax, solve_modes
from sandbox.engine.state import BOUND

from .machines import Bench, H, cord, disc, fixed, mechanism, rows_of
from .machines import G as GRAVITY

MOST = 1e300


def rows_for(
    delassus: np.ndarray, free: np.ndarray, low: Any = 0.0, high: Any = MOST,
    friction: dict[int, tuple[int, float]] | None = None, last: Any = 0.0,
) -> np.ndarray:
    """BOUND for a matrix; ``friction`` tells of tangential rows their normal one and mu."""
    rows = np.zeros(len(free), dtype=BOUND)
    rows["normal"], rows["low"], rows["high"], rows["last"] = -1, low, high, last
    rows["free"], rows["base"] = free, np.diag(delassus)
    for k, (normal, mu) in (friction or {}).items():
        rows[k]["normal"], rows[k]["friction"] = normal, mu
        rows[k]["low"] = rows[k]["high"] = 0.0
    return rows


def solved(rows: np.ndarray, delassus: np.ndarray, slack: float = 1e-12) -> int:
    n = len(rows)
    return int(solve_modes(rows, n, delassus, np.zeros((n, n + 1)), np.zeros(n, np.int64), slack))


def held(rows: np.ndarray) -> np.ndarray:
    """How strongly each impulse is held to its last."""
    return np.where(rows["normal"] < 0, HOLD, HOLD_TANGENT) * rows["base"]


def keeps(rows: np.ndarray, delassus: np.ndarray, tol: float) -> bool:
    """Whether the impulses satisfy all conditions; rates to ``tol``, impulses to as much / G."""
    p = rows["p"]
    y = delassus @ p + rows["free"] + held(rows) * (p - rows["last"])
    for k, row in enumerate(rows):
        low, high, small = row["low"], row["high"], tol / delassus[k, k]
        if row["normal"] >= 0:
            high = row["friction"] * p[row["normal"]]
            low = -high
        if not low - small <= p[k] <= high + small:
            return False
        if p[k] > low + small and y[k] > tol:
            return False
        if p[k] < high - small and y[k] < -tol:
            return False
    return True


def random_matrix(rng: np.random.Generator, n: int, rank: int | None = None) -> np.ndarray:
    C = rng.normal(size=(n, rank or n + 2))
    return C @ C.T


@pytest.mark.parametrize("seed", range(60))
def test_boxes_are_those_of_a_quadratic_programme(seed: int) -> None:
    """Motors, stops and frictionless contacts: p minimises p G p / 2 + f p between its bounds.

    G = L L^T, so that is a bounded least-squares problem, which scipy solves its own way.
    """
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 30))
    delassus = random_matrix(rng, n)
    free = rng.normal(size=n)
    motor = rng.uniform(size=n) < 0.5
    high = np.where(motor, 10 ** rng.uniform(-2, 1, n), MOST)
    low = np.where(motor, -high, 0.0)
    rows = rows_for(delassus, free, low, high)
    rows["mode"] = rng.integers(-1, 2, n) * motor
    assert solved(rows, delassus) > 0
    L = np.linalg.cholesky(delassus)
    truth = lsq_linear(L.T, -np.linalg.solve(L, free), bounds=(low, np.where(motor, high, np.inf)),
                       method="bvls", tol=1e-15).x
    condition = np.linalg.cond(delassus)
    np.testing.assert_allclose(
        rows["p"], truth, rtol=0, atol=(HOLD + 1e-13) * condition * max(1.0, abs(truth).max()))


def contacts(
    rng: np.random.Generator, count: int, bodies: int,
) -> tuple[np.ndarray, dict[int, Any]]:
    """G of random contacts between bodies 1:100 in mass, normals and tangents in turn."""
    weights = 10 ** rng.uniform(-1, 1, bodies)
    W = np.repeat(weights, 3) * np.tile([1.0, 1.0, 2.0], bodies)
    C = np.zeros((2 * count, 3 * bodies))
    for i in range(count):
        angle = rng.uniform(-np.pi, np.pi)
        normal = np.array([np.cos(angle), np.sin(angle)])
        ends = rng.choice(bodies, min(2, bodies), replace=False)
        for sign, body in zip((1, -1), ends[:int(rng.integers(1, 3))], strict=False):
            arm = rng.uniform(-1, 1, 2)
            for k, way in enumerate((normal, [-normal[1], normal[0]])):
                C[2 * i + k, 3 * body:3 * body + 3] = (
                    sign * way[0], sign * way[1], sign * (arm[0] * way[1] - arm[1] * way[0]))
    friction = {2 * i + 1: (2 * i, float(rng.choice([0.1, 0.3, 1.0]))) for i in range(count)}
    return (C * W) @ C.T, friction


def by_hand(rows: np.ndarray, delassus: np.ndarray) -> list[np.ndarray]:
    """All impulses that satisfy the conditions, by trying every mode of every contact."""
    count, found = len(rows) // 2, []
    A, f = delassus + np.diag(held(rows)), rows["free"]
    for modes in itertools.product(("open", "stick", "left", "right"), repeat=count):
        basis: list[np.ndarray] = []  # how impulses hang on the unknowns of a mode
        wanted: list[int] = []
        for i, mode in enumerate(modes):
            mu = rows["friction"][2 * i + 1]
            for k in {"open": (), "stick": (0, 1), "left": (0,), "right": (0,)}[mode]:
                column = np.zeros(len(rows))
                column[2 * i + k] = 1.0
                if mode in ("left", "right"):
                    column[2 * i + 1] = -mu if mode == "left" else mu
                basis.append(column)
                wanted.append(2 * i + k)
        B = np.array(basis).reshape(-1, len(rows)).T
        try:
            p = B @ np.linalg.solve((A @ B)[wanted], -f[wanted]) if wanted else np.zeros(len(rows))
        except np.linalg.LinAlgError:
            continue
        trial = rows.copy()
        trial["p"] = p
        if keeps(trial, delassus, 1e-9):
            found.append(p)
    return found


def test_friction_is_among_all_solutions_there_are() -> None:
    """One to three contacts, cold: solved nearly always (Lemke's share of such systems is 96 to
    100 %, and what is left is for ``relax``), and then one of those that brute force finds.
    """
    solutions, cold = 0, 400
    for seed in range(cold):
        rng = np.random.default_rng(seed)
        delassus, friction = contacts(rng, int(rng.integers(1, 4)), int(rng.integers(1, 4)))
        rows = rows_for(delassus, rng.normal(size=len(delassus)), friction=friction)
        all_there_are = by_hand(rows, delassus)
        if solved(rows, delassus) < 0:
            continue
        solutions += 1
        if np.abs(rows["p"]).max() > 1e6:  # wedged: only what holds to the last gives way
            assert keeps(rows, delassus, 1e-14 * np.abs(rows["p"]).max())
            continue
        off = [np.abs(rows["p"] - p).max() for p in all_there_are]
        assert min(off) < 1e-6 * max(1.0, np.abs(rows["p"]).max()), seed
    assert solutions > 0.97 * cold


@pytest.mark.parametrize("seed", range(40))
def test_a_solution_stays_one_from_its_own_modes(seed: int) -> None:
    """Begun with the modes that it ended with it takes one linear system."""
    rng = np.random.default_rng(seed)
    delassus, friction = contacts(rng, 6, 8)
    rows = rows_for(delassus, rng.normal(size=12), friction=friction)
    assert solved(rows, delassus) > 0
    assert keeps(rows, delassus, 1e-8)
    before = rows["p"].copy()
    assert solved(rows, delassus) == 1
    np.testing.assert_array_equal(rows["p"], before)


def test_rows_that_fight_go_to_their_bounds() -> None:
    """Two motors of one shaft, 1 and -1 rad/s: each gives its all, and nothing turns."""
    delassus = np.ones((2, 2))
    rows = rows_for(delassus, np.array([-1.0, 1.0]), low=-0.25, high=0.25)
    assert solved(rows, delassus) > 0
    np.testing.assert_array_equal(rows["p"], [0.25, -0.25])
    assert rows["mode"].tolist() == [1, -1]


def test_a_stop_takes_all_that_a_motor_gives() -> None:
    """It turns at -1 rad/s into a stop: the motor at its least, the stop against it."""
    delassus = np.array([[1.0, 1.0], [1.0, 1.0]])
    rows = rows_for(delassus, np.array([1.0, 0.0]), low=[-0.5, 0.0], high=[0.5, MOST])
    assert solved(rows, delassus) > 0
    np.testing.assert_allclose(rows["p"], [-0.5, 0.5], rtol=2e-10)


def test_a_brake_that_is_let_go_of_carries_nothing() -> None:
    """No torque either way: whatever it did in the last step, and whatever the rate."""
    for mode, last in itertools.product((-1, 0, 1), (-0.3, 0.3)):
        rows = rows_for(np.eye(1), np.array([2.0]), low=0.0, high=0.0, last=last)
        rows["mode"] = mode
        assert solved(rows, np.eye(1)) > 0
        assert rows["p"].tolist() == [0.0]


def feet(count: int) -> np.ndarray:
    """G of feet in line under a bar of 1 kg and 1/12 kg m^2: two freedoms for all of them."""
    x = np.linspace(-0.5, 0.5, count)
    return 1.0 + 12.0 * np.outer(x, x)


@pytest.mark.parametrize("count", [3, 4, 7])
def test_shares_that_nothing_decides_stay_as_they_were(count: int) -> None:
    """Feet in line: any shares that carry the bar will do, and those of the last step do.

    Of rounding that is not in G's range an impulse takes 1e-16 / HOLD = 1e-6 of its own at most.
    """
    delassus, free = feet(count), np.full(count, -1.0)
    even = np.full(count, 1.0 / count)
    rng = np.random.default_rng(count)
    _, _, null = np.linalg.svd(np.stack([np.ones(count), np.linspace(-0.5, 0.5, count)]))
    last = even + 0.3 / count * null[2:].T @ rng.uniform(-1, 1, count - 2)
    np.testing.assert_allclose(delassus @ last + free, 0.0, atol=1e-15)
    rows = rows_for(delassus, free, last=last)
    for _ in range(100):
        assert solved(rows, delassus) == 1
        np.testing.assert_allclose(rows["p"], last, rtol=0, atol=1e-5 * abs(last).max())
        rows["last"] = rows["p"]


def test_a_load_that_changes_moves_shares_by_the_least() -> None:
    """From thirds of a bar of 10 N s to one of 20: the least change, weighed by each one's own G.

    Those of the outer feet are four times the middle one's: of the change they take a quarter of
    its share each, 1/6, 4/6, 1/6.
    """
    rows = rows_for(feet(3), np.full(3, -2.0), last=1 / 3)
    assert solved(rows, feet(3)) == 1
    np.testing.assert_allclose(rows["p"], [1 / 3 + 1 / 6, 1 / 3 + 4 / 6, 1 / 3 + 1 / 6], rtol=1e-5)


@pytest.mark.parametrize("seed", range(20))
def test_relaxation_is_a_fallback(seed: int) -> None:
    """From the last impulses it keeps all bounds, and near a solution it stays there.

    Sweeps shrink the error by 1 - 1 / cond each at the worst, so a matrix of condition below 4
    leaves (3/4)^60 = 3e-8.
    """
    rng = np.random.default_rng(seed)
    delassus = np.eye(8) + 0.05 * random_matrix(rng, 8) / 8
    friction = {2 * i + 1: (2 * i, 0.5) for i in range(4)}
    rows = rows_for(delassus, rng.normal(size=8), friction=friction, last=1.0)
    assert np.linalg.cond(delassus) < 4
    exact = rows.copy()
    assert solved(exact, delassus) > 0
    relax(rows, 8, delassus)
    # what holds to the last impulses is left out of the sweeps
    np.testing.assert_allclose(rows["p"], exact["p"], rtol=0, atol=1e-6)
    assert (rows["p"][::2] >= 0).all()
    assert (abs(rows["p"][1::2]) <= 0.5 * rows["p"][::2] + 1e-15).all()
    moved = rows["p"][1::2] != 0
    np.testing.assert_array_equal(
        rows["mode"][1::2][moved], exact["mode"][1::2][moved])


@pytest.mark.parametrize("count", [3, 5])
def test_a_bar_on_feet_in_line_stays_put(count: int) -> None:
    """Pushed aside by less than friction holds, for half a second: not a bit of it moves once it
    stands, and every foot carries what it carried; together they carry its weight.
    """
    x = np.linspace(-0.1, 0.1, count)
    run = Bench(mechanism(
        gravity=(1.0, -GRAVITY),
        bodies=[fixed("floor", shapes=[{"type": "box", "size": (2.0, 0.02)}]),
                {"name": "bar", "mass": 0.2, "inertia": 5e-4, "at": (0.0, 0.02), "shapes": [
                    {"type": "circle", "radius": 0.01, "at": (float(at), 0.0)} for at in x]}],
        contacts=[{"between": ("bar", "floor"), "friction": 0.5}])).step(steps=100)
    touches = run.state.touches[:count].copy()
    pose = run.state.body.copy()
    run.step(steps=900)
    np.testing.assert_array_equal(run.state.body, pose)
    np.testing.assert_allclose(run.state.touches[:count]["normal"], touches["normal"], rtol=1e-9)
    np.testing.assert_allclose(run.state.touches[:count]["tangent"], touches["tangent"], rtol=1e-9)
    assert touches["normal"].sum() == pytest.approx(0.2 * GRAVITY * H, rel=1e-9)
    assert abs(touches["tangent"].sum()) == pytest.approx(0.2 * 1.0 * H, rel=1e-6)


# -- G itself --------------------------------------------------------------------------


@pytest.mark.parametrize("hub", [12, 0])
def test_what_rows_make_of_one_another_goes_through_the_mechanism(
    hub: int, monkeypatch: pytest.MonkeyPatch,
) -> None:
    """G = C (W - W B^T (B W B^T + c)^-1 B W) C^T, dense, and the rates without bounded impulses.

    Two discs on a jointed chain with a cord and a damper press on floors; with a hub of none or of
    all bodies.
    """
    from sandbox.engine import tables

    made = tables.make_pattern
    monkeypatch.setattr(tables, "make_pattern",
                        lambda *given, **more: made(*given, hub=hub, **more))
    bench = Bench(mechanism(
        gravity=(0.0, -GRAVITY),
        bodies=[fixed("floor", shapes=[{"type": "box", "size": (2.0, 0.02)}]),
                disc("a", 0.01, (0.0, 0.02)), disc("b", 0.01, (0.1, 0.02)),
                {"name": "c", "mass": 0.3, "inertia": 1e-4, "at": (0.05, 0.1)}],
        materials={}, contacts=[{"between": ("*", "floor"), "friction": 0.4}],
        joints=[{"type": "pin", "name": "p", "a": "a", "b": "c", "on_a": (0.0, 0.0),
                 "damping": 1e-3},
                {"type": "rod", "name": "r", "a": "b", "b": "c"}],
        tendons=[cord("t", ("a", (0.0, 0.005)), ("b", (0.0, 0.005)), rest_length=0.1 - 1e-7,
                      damping=1.0)])).step()
    constants, result = bench.constants, bench.result
    assert (constants.hubs[:, 0] >= 0).sum() == (3 if hub == 0 else 0)
    rows = result.rows[result.rows["base"] > 0]
    assert len(rows) == 4
    B = rows_of(bench.tables)
    kept = [int(i) for i in np.flatnonzero(B.any(axis=1))]
    w = np.stack([constants.inverse_mass[:, 0], *constants.inverse_mass.T], axis=1).ravel()
    C = np.zeros((4, B.shape[1]))
    for k, row in enumerate(rows):
        C[k, 3 * row["a"]:3 * row["a"] + 3] = row["ax"], row["ay"], row["at"]
        C[k, 3 * row["b"]:3 * row["b"] + 3] = row["bx"], row["by"], row["bt"]
    B, c = B[kept], result.unknowns[1][kept]
    inner = np.linalg.inv((B * w) @ B.T + np.diag(c))
    G = (C * w) @ C.T - (C * w) @ B.T @ inner @ (B * w) @ C.T
    np.testing.assert_allclose(result.delassus[:4, :4], G, rtol=0, atol=1e-9 * abs(G).max())
    free = result.before.copy()
    free[constants.inverse_mass[:, 0] > 0] += H * np.array([0.0, -GRAVITY, 0.0])
    v = free.ravel() + (w * B.T.dot(inner).T).T @ (result.unknowns[0][kept] - B @ free.ravel())
    # joints are closed along the way, which asks for h / 2 omega^2 r more; bodies are of 0.1 m
    bend = H / 2 * float(np.abs(result.velocity[:, 2]).max()) ** 2 * 0.1
    np.testing.assert_allclose(rows["free"], C @ v + rows["want"], rtol=0, atol=1e-9 + bend)
