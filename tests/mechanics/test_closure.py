"""The ball in a hull against a library's, isotropy; linear programs against another solver."""

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

from sandbox.mechanics.closure import grasp_isotropy, largest_ball
from sandbox.mechanics.linear_program import LinearProgram

DISC = [[1, 0], [-1, 0]]


def inward(contacts):
    """Normals towards the origin, for contacts whose sides stand across their radius."""
    at = np.asarray(contacts, dtype=float)
    return -at / np.linalg.norm(at, axis=-1, keepdims=True)


def hull_radius(points):
    """By the facets of a library's hull: outward normals n and offsets d, n x + d <= 0 inside."""
    hull = ConvexHull(points)
    return max(0.0, float(-hull.equations[:, 3].max()))


@pytest.mark.parametrize("seed", [0, 6, 19])
def test_balls_are_those_of_a_librarys_hull(seed):
    random = np.random.default_rng(seed)
    points = random.normal(size=(40, 4 + seed, 3)) + random.normal(size=(40, 1, 3)) * 0.2
    expected = [hull_radius(each) for each in points]
    np.testing.assert_allclose(largest_ball(points), expected, atol=1e-12)
    assert any(expected) or seed == 0


@pytest.mark.parametrize("points", [
    np.zeros((5, 3)),
    np.outer(np.arange(-3, 4), [1.0, 2.0, 3.0]),
    [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0.5, 0.5, 0]],
    [[1, 0, 0.5], [-1, 0, 0.5], [0, 1, 0.5], [0, -1, 0.5], [0.5, 0.5, 0.5]],
    np.eye(3),
])
def test_what_has_no_inside_holds_no_ball(points):
    assert largest_ball(points) == 0.0


def test_isotropy():
    """Of n contacts with friction evenly round a disc: G G^T = diag(n, n, n), all values alike.

    Without friction only normals count, and nothing turns a disc.
    """
    angles = np.radians([90, 210, 330])
    at = np.stack([np.cos(angles), np.sin(angles)], axis=-1)

    def of(mu, rho):
        return float(grasp_isotropy(at, -at, mu, centre=(0, 0), length=rho))

    assert of(0.5, 1.0) == pytest.approx(1.0)
    assert of(0.5, 2.0) == pytest.approx(0.5)
    assert of(0.0, 1.0) == 0.0
    assert float(grasp_isotropy(at[:1], -at[:1], 0.5, centre=(0, 0), length=1.0)) == 0.0
    # two opposite ones: along their line 2, across it 2, turning 2 / rho^2
    assert float(grasp_isotropy(DISC, inward(DISC), 0.5, centre=(0, 0), length=4.0)) == (
        pytest.approx(0.25))


# --- linear programs


def drawn(seed):
    """A program of up to 7 rows; every other one of halves, where much is alike."""
    rng = np.random.default_rng(seed)
    m = int(rng.integers(1, 8))
    n = m + int(rng.integers(0, 10))
    A = rng.normal(size=(m, n))
    A = np.round(2 * A) / 2 if seed % 2 else A
    b = A @ np.maximum(rng.normal(size=n), 0) if seed % 3 else rng.normal(size=m)
    return A, b, rng.normal(size=n)


def test_programs_drawn_at_random_have_the_value_that_another_solver_finds():
    seen = set()
    for seed in range(100):
        A, b, c = drawn(seed)
        if np.linalg.matrix_rank(A) < len(A):
            continue
        truth, found = linprog(c, A_eq=A, b_eq=b), LinearProgram(A, b)
        seen.add(truth.status)
        if truth.status == 2:  # nothing balances, which the prices prove
            assert found.missing > 1e-6
            assert (found.against @ A).max() < 1e-8
            assert found.against @ b == pytest.approx(found.missing)
            continue
        assert found.missing < 1e-12
        least = found.minimum(c)
        if truth.status == 3:
            assert least.value == -np.inf
            continue
        assert least.value == pytest.approx(truth.fun, abs=1e-9)
        # the proof: whoever balances has at least y b
        assert least.reduced.min() > -1e-8
        assert least.reduced == pytest.approx(c - A.T @ least.prices, abs=1e-11)
        assert least.prices @ b == pytest.approx(least.value, abs=1e-11)
    assert seen == {0, 2, 3}
