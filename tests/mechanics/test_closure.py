"""Force closure, epsilon, isotropy and spread against closed forms, a library's hull, scaling."""

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

from sandbox.mechanics.closure import (
    contact_wrenches,
    force_spread,
    grasp_epsilon,
    grasp_isotropy,
    largest_ball,
)

MUS = [0.0, 0.05, 0.3, 0.5, 1.0, 2.0]
DISC = [[1, 0], [-1, 0]]
SQUARE = [[1, 0], [0, 1], [-1, 0], [0, -1]]
THREE = [[np.cos(a), np.sin(a)] for a in np.radians([90, 210, 330])]
TRIANGLE = [[0.5 * np.cos(a), 0.5 * np.sin(a)] for a in np.radians([30, 150, 270])]


def inward(contacts):
    """Normals towards the origin, for contacts whose sides stand across their radius."""
    at = np.asarray(contacts, dtype=float)
    return -at / np.linalg.norm(at, axis=-1, keepdims=True)


def epsilon(contacts, normals, mu, rho=1.0, centre=(0, 0)):
    return float(grasp_epsilon(contacts, normals, mu, centre=centre, length=rho))


@pytest.mark.parametrize("mu", [0.1, 0.5, 0.9])
def test_three_contacts_round_a_disc(mu):
    """Turning is what they balance least: mu, moments over the radius."""
    assert epsilon(THREE, inward(THREE), mu) == pytest.approx(mu, rel=1e-12)


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


@pytest.mark.parametrize("mu", [1e-6, 0.2, 0.5])
def test_two_sides_of_a_square(mu):
    """The wrenches (-1, u, u / sqrt 2) and (1, u, -u / sqrt 2), u = +-mu, make a tetrahedron.

    Its corners are every other one of a box with half sides 1, mu, mu / sqrt 2, its faces
    1 / sqrt(1 + 1 / mu^2 + 2 / mu^2) off: epsilon is mu / sqrt(3 + mu^2), however little they rub.
    """
    sides = [[1, 0], [-1, 0]]
    assert epsilon(sides, inward(sides), mu, np.sqrt(2)) == pytest.approx(
        mu / np.sqrt(3 + mu**2), rel=1e-9)


@pytest.mark.parametrize("mus", [(0.2, 0.8), (0.8, 0.2), (0.0, 0.8)])
def test_of_two_contacts_that_rub_unlike_the_smoother_one_counts(mus):
    """On a disc: faces lie mu / sqrt(2 + mu^2) off, with mu of either contact."""
    least = min(mus)
    assert float(grasp_epsilon(DISC, inward(DISC), mus, centre=(0, 0), length=1.0)) == (
        pytest.approx(least / np.sqrt(2 + least**2), abs=1e-12))


def test_a_square_without_friction():
    """Form closure by four contacts off the middles; none where all moments have one sign."""
    right, left, up, down = [-1, 0], [1, 0], [0, -1], [0, 1]
    normals = [right, left, up, down]
    closes = [[1, 0.5], [-1, -0.5], [0.5, 1], [-0.5, -1]]
    turns = [[1, 0.5], [-1, -0.5], [-0.5, 1], [0.5, -1]]
    assert epsilon(closes, normals, 0.0, np.sqrt(2)) == pytest.approx(1 / (2 * np.sqrt(3)))
    assert epsilon(turns, normals, 0.0, np.sqrt(2)) == 0.0


def hull_radius(points):
    """By the facets of a library's hull: outward normals n and offsets d, n x + d <= 0 inside."""
    hull = ConvexHull(points)
    return max(0.0, float(-hull.equations[:, 3].max()))


@pytest.mark.parametrize("seed", range(20))
def test_balls_are_those_of_a_librarys_hull(seed):
    random = np.random.default_rng(seed)
    points = random.normal(size=(40, 4 + seed, 3)) + random.normal(size=(40, 1, 3)) * 0.2
    expected = [hull_radius(each) for each in points]
    np.testing.assert_allclose(largest_ball(points), expected, atol=1e-12)
    assert any(expected) or seed < 4


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


def test_many_sets_at_a_time_are_those_one_by_one():
    random = np.random.default_rng(3)
    points = random.normal(size=(7, 300, 16, 3))
    whole = largest_ball(points)
    assert whole.shape == (7, 300)
    assert (whole > 0).any()
    for i in range(7):
        np.testing.assert_array_equal(whole[i, 5], largest_ball(points[i, 5]))


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


@pytest.mark.parametrize("mu", [0.2, 0.7])
def test_epsilon_is_the_least_load_that_forces_of_sum_1_balance_at_most(mu):
    """By linear programs over the forces themselves: in the worst direction epsilon, else more."""
    at = np.array([[1, 0.2], [-0.4, 0.8], [-0.7, -0.6]])
    edges = contact_wrenches(at, inward(at), mu, centre=(0, 0), length=1.1)
    found = epsilon(at, inward(at), mu, 1.1)
    facets = ConvexHull(edges).equations
    others = np.random.default_rng(0).normal(size=(25, 3))
    others /= np.linalg.norm(others, axis=1, keepdims=True)
    most = []
    for w in [facets[facets[:, 3].argmax(), :3], *others]:
        # sum f_e p_e = s w, sum f_e = 1, f_e >= 0
        A = np.zeros((4, 7))
        A[:3, :6], A[:3, 6], A[3, :6] = edges.T, -w, 1
        most.append(linprog([0] * 6 + [-1], A_eq=A, b_eq=[0, 0, 0, 1]).x[6])
    assert most[0] == pytest.approx(found, abs=1e-9)
    assert min(most[1:]) > found > 0.1


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


def test_isotropy_counts_the_tangents_of_what_rubs():
    """Three contacts round a disc, of which the one on top rubs: it adds (1, 0, -1) to the normals.

    G G^T = diag(3/2, 3/2, 0) + (1, 0, -1)(1, 0, -1)^T has the values 3, 3/2 and 1/2.
    """
    assert float(grasp_isotropy(THREE, inward(THREE), [0.5, 0, 0], centre=(0, 0), length=1.0)) == (
        pytest.approx(1 / np.sqrt(6)))


def test_spread():
    np.testing.assert_allclose(force_spread([[2, 2, 2], [1, 0, 0], [3, 1, 2]]),
                               [0, np.sqrt(2), np.sqrt(2 / 3) / 2], atol=1e-15)


@pytest.mark.parametrize(("call", "told"), [
    (lambda: contact_wrenches([[1, 0]], [[1, 0]], -0.1, centre=(0, 0), length=1), "friction"),
    (lambda: contact_wrenches([[1, 0]], [[1, 0]], 0.1, centre=(0, 0), length=0), "length"),
    (lambda: contact_wrenches([[1, 0]], [[1, 0], [0, 1]], 0, centre=(0, 0), length=1), "normals"),
    (lambda: largest_ball([[1, 2]]), "wrenches"),
    (lambda: largest_ball([[1, 2, np.nan]]), "wrenches"),
    (lambda: force_spread([0, 0]), "forces"),
    (lambda: force_spread([-1, 2]), "forces"),
])
def test_what_is_impossible_is_refused(call, told):
    with pytest.raises(ValueError, match=told):
        call()
