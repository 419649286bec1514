"""Outlines: what is wrong with them, their pieces, and the directions that are their surface."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.errors import SceneError
from sandbox.scene.elements.bodies import Body, Polygon
from sandbox.scene.geometry import mass_properties, solids
from sandbox.scene.outlines.pieces import MOST_CORNERS, chain_faces, pieces_of
from sandbox.scene.outlines.rings import inside, is_convex, signed_area, without_straight
from sandbox.scene.read.load import load_scene

ELL = ((0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 4.0), (0.0, 4.0))
STAR = tuple((r * math.cos(k * math.pi / 7), r * math.sin(k * math.pi / 7))
             for k, r in enumerate([2.0, 0.7] * 7))
SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


def circle(n: int, radius: float, at: tuple[float, float] = (0.0, 0.0)):
    return tuple((at[0] + radius * math.cos(math.tau * k / n),
                  at[1] + radius * math.sin(math.tau * k / n)) for k in range(n))


def moved(ring, x: float, y: float):
    return tuple((p + x, q + y) for p, q in ring)


RINGS = {
    "ell": (ELL, ()), "star": (STAR, ()), "clockwise": (STAR[::-1], ()),
    "ring": (circle(90, 2.0), (circle(40, 1.0),)),
    "fine circle": (circle(500, 1.0), ()),
    "tiny": (tuple((1e-6 * x, 1e-6 * y) for x, y in ELL), ()),
    "far": (moved(ELL, 1e3, -1e3), ()),
    "corners in line": ((*ELL[:1], (1.0, 0.0), (2.0, 0.0), *ELL[1:]), ()),
}

RINGS["sieve"] = (circle(200, 3.0), (circle(12, 0.3, (-1.2, 0)), circle(9, 0.4, (1.5, 0)),
                                     moved(SQUARE, -0.4, 0.9)))


@pytest.mark.parametrize("name", RINGS)
def test_the_pieces_are_convex_and_cover_the_outline_and_no_more(name):
    outer, holes = RINGS[name]
    pieces = pieces_of(outer, holes)
    area = abs(signed_area(outer)) - sum(abs(signed_area(hole)) for hole in holes)
    assert sum(signed_area(piece.ring) for piece in pieces) == pytest.approx(area, rel=1e-9)
    assert all(is_convex(piece.ring) and len(piece.ring) <= MOST_CORNERS for piece in pieces)
    corners = {corner for ring in (outer, *holes) for corner in ring}
    assert {corner for piece in pieces for corner in piece.ring} <= corners


@pytest.mark.parametrize("name", RINGS)
def test_every_side_is_the_surface_of_one_piece(name):
    """As many arcs without a width as the outline has sides; their lengths are its own."""
    outer, holes = RINGS[name]
    sides = [p for ring in (outer, *holes) for p in without_straight(ring)]
    arcs = np.concatenate([piece.faces for piece in pieces_of(outer, holes)])
    flat = (arcs[:, :2] == arcs[:, 2:]).all(axis=1)
    assert np.count_nonzero(flat) == len(sides)


def test_a_chain_faces_both_ways_and_outwards_at_its_joints_and_ends():
    arcs = chain_faces(((0.0, 0.0), (1.0, 0.0), (2.0, 1.0), (3.0, 1.0)))
    assert [len(each) for each in arcs] == [2 + 2 + 2, 2 + 2, 2 + 2]
    first = arcs[0]
    assert (first[:2] == [[0, -1, 0, -1], [0, 1, 0, 1]]).all()
    assert first[2] == pytest.approx([0, 1, -1, 0])  # its end, to the left
    # the joint bends to the left: it stands out to the right, down
    assert first[4][:2] == pytest.approx([0, -1])
    assert first[5][2:] == pytest.approx([math.sqrt(0.5), -math.sqrt(0.5)])


# --- mass


def test_an_annulus_has_the_mass_centre_and_inertia_of_its_closed_form():
    """Regular n-gons: area n R^2 sin(a) / 2, polar second moment area R^2 (2 + cos a) / 6."""
    def gon(n, radius):
        a = math.tau / n
        area = n * radius**2 * math.sin(a) / 2
        return area, area * radius**2 * (2 + math.cos(a)) / 6

    (a1, i1), (a2, i2) = gon(120, 0.2), gon(80, 0.1)
    body = Body(name="ring", density=1000.0, thickness=0.01, shapes=(
        Polygon(type="polygon", points=moved(circle(120, 0.2), 3, 4),
                holes=(moved(circle(80, 0.1), 3, 4),)),))
    found = mass_properties(body)
    assert found.mass == pytest.approx(10 * (a1 - a2), rel=1e-12)
    assert found.centre == pytest.approx((3, 4), rel=1e-12)
    assert found.inertia == pytest.approx(10 * (i1 - i2), rel=1e-9)


# --- what is wrong


def problems(**shape) -> str:
    with pytest.raises(SceneError) as raised:
        load_scene({"bodies": [{"name": "x", "motion": "fixed", "shapes": [shape]}]})
    return str(raised.value)


@pytest.mark.parametrize(("points", "words"), [
    ([[0, 0], [2, 2], [2, 0], [0, 2]], "crosses or touches itself at [1, 1], where the side from "
     "corner 0 meets that from corner 2"),
    ([[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]], "at [2, 0]"),  # a corner on a side
    ([[0, 0], [4, 0], [4, 4], [4, 2], [0, 4]], "at [4, 2]"),  # a side back along another
    ([[0, 0], [1, 1], [2, 2]], "no area: its corners lie in one line"),
    ([[0, 0], [1, 0], [1, 0], [0, 1]], "corners 1 and 2 are the same point"),
    ([[0, 0], [1, 0], [0, 1], [0, 0]], "corners 3 and 0 are the same point"),
    # a star in one stroke: bends all one way, twice round
    ([[0, 3], [-2, -3], [3, 1], [-3, 1], [2, -3]], "crosses or touches itself"),
])
def test_an_outline_that_is_none_is_told_with_the_place(points, words):
    text = problems(type="polygon", points=points)
    assert "$.bodies[0].shapes[0].points" in text
    assert words in text


@pytest.mark.parametrize(("holes", "words"), [
    ([[[5, 5], [6, 5], [5, 6]]], "hole 0: this hole lies outside of the outline at [5, 5]"),
    ([[[0.5, 0.5], [1.5, 0.5], [0.5, 0.6]]], "hole 0: this hole meets the outline at [1, 0.5]"),
    ([[[0.1, 0.1], [0.9, 0.1], [0.1, 0.9]], [[0.2, 0.2], [0.3, 0.2], [0.2, 0.3]]],
     "hole 1: this hole and hole 0 lie one in the other"),
    ([[[0.1, 0.1], [0.5, 0.1], [0.1, 0.5]], [[0.2, 0.2], [0.9, 0.2], [0.2, 0.9]]],
     "hole 1: this hole meets hole 0"),
    ([[[0.2, 0.2], [0.3, 0.3], [0.4, 0.4]]], "hole 0: the outline has no area"),
])
def test_a_hole_that_is_none_is_told(holes, words):
    text = problems(type="polygon", points=SQUARE, holes=holes)
    assert "$.bodies[0].shapes[0].holes" in text
    assert words in text


def test_all_corners_count():
    ring = [list(p) for p in circle(1500, 2.0)]
    text = problems(type="polygon", points=ring, holes=[[list(p) for p in circle(501, 1.0)]])
    assert "have 2001 corners" in text
    assert "at most 2000" in text


def test_a_polyline_belongs_to_what_does_not_move_freely():
    with pytest.raises(SceneError, match="a polyline has no area"):
        load_scene({"bodies": [{"name": "x", "mass": 1, "shapes": [
            {"type": "polyline", "points": [[0, 0], [1, 0]]}]}]})
    assert "points 1 and 2 are the same point" in problems(
        type="polyline", points=[[0, 0], [1, 0], [1, 0]])


@pytest.mark.parametrize(("shape", "place"), [
    ({"type": "polygon", "points": SQUARE, "holes": [[[0.2, 0.2], [0.20000000000001, 0.2],
                                                      [0.2, 0.4]]]}, "holes[0]"),
    ({"type": "polyline", "points": [[0, 0], [1e-12, 0], [1, 0]]}, "points"),
])
def test_sides_that_are_too_short_are_told(shape, place):
    text = problems(**shape)
    assert f"$.bodies[0].shapes[0].{place}: the shortest side of this" in text


@pytest.mark.parametrize("seed", range(6))
def test_what_crosses_itself_is_found_as_all_pairs_find_it(seed):
    """Against every pair of sides, one by one; what is sound is cut into pieces."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(4, 9))
    points = [tuple(p) for p in rng.uniform(-1, 1, (n, 2)).tolist()]

    def beside(a, b, c):
        return np.sign((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))

    crossed = False
    for i in range(n):
        for j in range(i + 2, n - (i == 0)):
            p, q, r, s = points[i], points[(i + 1) % n], points[j], points[(j + 1) % n]
            crossed |= (beside(p, q, r) != beside(p, q, s)) and (beside(r, s, p) != beside(r, s, q))
    if crossed:
        assert "crosses or touches itself" in problems(type="polygon", points=points)
    else:
        shape = Polygon(type="polygon", points=points)
        middle = rng.uniform(-1, 1, (200, 2)).tolist()
        parts = [solid.points for solid, _ in solids(shape)]
        assert all(inside(tuple(p), tuple(points)) == any(inside(tuple(p), ring) for ring in parts)
                   for p in middle)
