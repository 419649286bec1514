"""Contact and bound solver against enumeration; Lemke's method and relaxation as fallbacks."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from sandbox.engine.bounded import HOLD, HOLD_TANGENT, solve_modes
from sandbox.engine.lemke import MOST as LARGEST
from sandbox.engine.lemke import lemke_modes
from sandbox.engine.state import BOUND

pytestmark = pytest.mark.nightly  # these kernels are compiled anew when called directly

MOST = 1e300


def rows_for(
    delassus: np.ndarray, free: np.ndarray, low: Any = 0.0, high: Any = MOST,
    friction: dict[int, tuple[int, float]] | None = None, last: Any = 0.0,
) -> np.ndarray:
    """BOUND for a matrix; ``friction`` tells of tangential rows their normal one and mu."""
    rows = np.zeros(len(free), dtype=BOUND)
    rows["normal"], rows["low"], rows["high"], rows["last"] = -1, low, high, last
    rows["free"], rows["base"], rows["hold"] = free, np.diag(delassus), HOLD
    for k, (normal, mu) in (friction or {}).items():
        rows[k]["normal"], rows[k]["friction"] = normal, mu
        rows[k]["low"] = rows[k]["high"] = 0.0
        rows[k]["hold"] = HOLD_TANGENT
    return rows


def solved(rows: np.ndarray, delassus: np.ndarray, slack: float = 1e-12) -> int:
    n = len(rows)
    return int(solve_modes(rows, n, delassus, np.zeros((n, n + 1)), np.zeros(n, np.int64), slack))


def keeps(rows: np.ndarray, delassus: np.ndarray, tol: float) -> bool:
    """Whether the impulses satisfy all conditions; rates to ``tol``, impulses to as much / G."""
    p = rows["p"]
    y = delassus @ p + rows["free"] + rows["hold"] * rows["base"] * (p - rows["last"])
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
    A, f = delassus + np.diag(rows["hold"] * rows["base"]), rows["free"]
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
    """Random systems of one to three contacts: the solution is among those of an enumeration."""
    solutions, cold = 0, 120
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


# -- Lemke's method


def found(rows: np.ndarray, delassus: np.ndarray) -> bool:
    room = np.zeros((2 * LARGEST, 2 * LARGEST + 2))
    return bool(lemke_modes(rows, len(rows), delassus, room, np.zeros((3, len(room) + 2), int)))


def pile(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """3 to 20 contacts with friction among bodies 1:100 that move as bodies can: f is in G's range.

    For such Lemke's method has a solution to end with.
    """
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 21))
    delassus, friction = contacts(rng, count, count + 2)
    free = delassus @ (rng.normal(size=2 * count) / np.sqrt(np.diag(delassus)))
    return rows_for(delassus, free, friction=friction), delassus


def test_modes_of_contacts_are_those_of_a_solution_at_once() -> None:
    """From no modes at all.

    Where G is singular, forces that nothing decides may end on either side of a bound by rounding,
    which differs between processors: some of these want modes changed once more.
    """
    regular = 0
    for seed in range(40):
        rows, delassus = pile(seed)
        assert found(rows, delassus), seed
        passes = solved(rows, delassus)
        if np.linalg.matrix_rank(delassus) == len(rows):
            regular += 1
            assert passes == 1, seed
        assert solved(rows, delassus) == 1, seed
        assert keeps(rows, delassus, 1e-7 * float(np.abs(rows["free"]).max())), seed
    assert regular > 10


@pytest.mark.parametrize("seed", range(12))
def test_boxes_of_any_bounds(seed: int) -> None:
    """Motors, stops and rows without bounds: G is positive definite, so there is one solution."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 30))
    delassus = random_matrix(rng, n)
    kind = rng.integers(0, 4, n)
    most = 10 ** rng.uniform(-2, 1, n)
    most[kind == 3] = 0.0
    low = np.choose(kind, [np.zeros(n), -most, np.full(n, -MOST), -most])
    high = np.choose(kind, [np.full(n, MOST), most, np.full(n, MOST), most])
    rows = rows_for(delassus, rng.normal(size=n), low, high)
    rows["mode"] = rng.integers(-1, 2, n)
    assert found(rows, delassus)
    assert solved(rows, delassus) == 1
    again = rows.copy()
    assert solved(again, delassus) == 1
    assert keeps(rows, delassus, 1e-9)
