"""Force closure, epsilon, isotropy and spread against closed forms, a library's hull, scaling."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from sandbox.mechanics.closure import (
    contact_wrenches,
    force_spread,
    grasp_epsilon,
    grasp_isotropy,
    largest_ball,
)

MUS = [0.0, 0.3, 2.0]
DISC = [[1, 0], [-1, 0]]
SQUARE = [[1, 0], [0, 1], [-1, 0], [0, -1]]
TRIANGLE = [[0.5 * np.cos(a), 0.5 * np.sin(a)] for a in np.radians([30, 150, 270])]


def inward(contacts):
    """Normals towards the origin, for contacts whose sides stand across their radius."""
    at = np.asarray(contacts, dtype=float)
    return -at / np.linalg.norm(at, axis=-1, keepdims=True)


def epsilon(contacts, normals, mu, rho=1.0, centre=(0, 0)):
    return float(grasp_epsilon(contacts, normals, mu, centre=centre, length=rho))


@pytest.mark.parametrize("mu", MUS)
@pytest.mark.parametrize(("contacts", "rho", "closed_form"), [
    (DISC, 1.0, lambda mu: mu / np.sqrt(2 + mu**2)),
    (SQUARE, np.sqrt(2), lambda mu: mu / np.sqrt(2)),
    (TRIANGLE, 1.0, lambda mu: mu / 2),
])
def test_closed_forms(contacts, rho, closed_form, mu):
    """A disc of radius 1, a square of side 2, an equilateral triangle of circumradius 1.

    Held at opposite points, or in the middle of all sides.
    """
    found = epsilon(contacts, inward(contacts), mu, rho)
    expected = closed_form(mu)
    scipys = hull_radius(contact_wrenches(contacts, inward(contacts), mu, centre=(0, 0),
                                          length=rho)) if mu else 0.0
    assert found == pytest.approx(scipys, abs=1e-12)
    assert found == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("mus", [(0.2, 0.8), (0.8, 0.2)])
def test_of_two_contacts_that_rub_unlike_the_smoother_one_counts(mus):
    """On a disc: faces lie mu / sqrt(2 + mu^2) off, with mu of either contact."""
    least = min(mus)
    assert float(grasp_epsilon(DISC, inward(DISC), mus, centre=(0, 0), length=1.0)) == (
        pytest.approx(least / np.sqrt(2 + least**2), abs=1e-12))


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


def test_facets_with_many_corners_and_points_that_coincide():
    """A cube with the middles of its sides, and every point twice: the ball touches six faces."""
    cube = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)
                     if (x, y, z) != (0, 0, 0)], dtype=float)
    assert largest_ball(np.concatenate([cube, cube])) == pytest.approx(1.0, abs=1e-12)
    assert largest_ball(cube + np.array([0.25, 0, 0])) == pytest.approx(0.75, abs=1e-12)
    assert largest_ball(cube + np.array([1.0, 0, 0])) == 0.0
    assert largest_ball(cube + np.array([1.5, 0, 0])) == 0.0


@pytest.mark.parametrize("points", [
    np.zeros((5, 3)),
    np.outer(np.arange(-3, 4), [1.0, 2.0, 3.0]),
    [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0.5, 0.5, 0]],
    [[1, 0, 0.5], [-1, 0, 0.5], [0, 1, 0.5], [0, -1, 0.5], [0.5, 0.5, 0.5]],
    np.eye(3),
])
def test_what_has_no_inside_holds_no_ball(points):
    assert largest_ball(points) == 0.0


def test_neither_place_turn_nor_size_matters():
    random = np.random.default_rng(5)
    angles = np.sort(random.uniform(0, 2 * np.pi, 5))
    at = np.stack([np.cos(angles), 0.6 * np.sin(angles)], axis=-1)
    n = inward(at)
    first = epsilon(at, n, 0.4)
    assert first > 0.05
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, s], [-s, c]])
    moved = 0.03 * at @ turn + [5.0, -2.0]
    assert epsilon(moved, n @ turn, 0.4, 0.03, (5.0, -2.0)) == pytest.approx(first, rel=1e-9)


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


@pytest.mark.parametrize(("call", "told"), [
    (lambda: contact_wrenches([[1, 0]], [[1, 0]], -0.1, centre=(0, 0), length=1), "friction"),
    (lambda: contact_wrenches([[1, 0]], [[1, 0]], 0.1, centre=(0, 0), length=0), "length"),
    (lambda: contact_wrenches([[1, 0]], [[1, 0], [0, 1]], 0, centre=(0, 0), length=1), "normals"),
    (lambda: largest_ball([[1, 2]]), "wrenches"),
    (lambda: force_spread([0, 0]), "forces"),
])
def test_what_is_impossible_is_refused(call, told):
    with pytest.raises(ValueError, match=told):
        call()
