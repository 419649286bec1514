"""Lemke's method: modes of random systems from cold, and where changing modes does not end."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.lemke import MOST, lemke_modes
from sandbox.engine.simulation import Simulation
from sandbox.scene.document import Scene

from .test_bounded import MOST as ENDLESS
from .test_bounded import contacts, keeps, random_matrix, rows_for, solved


def found(rows: np.ndarray, delassus: np.ndarray) -> bool:
    room = np.zeros((2 * MOST, 2 * MOST + 2))
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
    low = np.choose(kind, [np.zeros(n), -most, np.full(n, -ENDLESS), -most])
    high = np.choose(kind, [np.full(n, ENDLESS), most, np.full(n, ENDLESS), most])
    rows = rows_for(delassus, rng.normal(size=n), low, high)
    rows["mode"] = rng.integers(-1, 2, n)
    assert found(rows, delassus)
    assert solved(rows, delassus) == 1
    again = rows.copy()
    assert solved(again, delassus) == 1
    assert keeps(rows, delassus, 1e-9)


def test_a_run_tells_in_how_many_steps_forces_were_relaxed() -> None:
    run = Simulation(Scene.model_validate({"run": {"duration": 0.01}, "bodies": [
        {"name": "ground", "motion": "fixed"}]}))
    run.run()
    assert run.recording().notes == []
    run._tables.state.standing[0] = 3
    note, = run.recording().notes
    assert "not exact, in 3 of 20 steps" in note
