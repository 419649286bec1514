"""Plain geometry against closed forms and quadrature over triangles."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.scene.bodies import Box, Capsule, Circle, Polygon
from sandbox.scene.geometry import area_properties

SIDES = 4096
"""Of the polygons that stand for round shapes."""
CHORD = (2 * math.pi / SIDES) ** 2
"""An inscribed n-gon, x = 2 pi / n, has the share sin(x) / x = 1 - x^2 / 6 of the disc's area and
1 - x^2 / 3 of its second moment; parts of it that are straight lose nothing: below x^2."""


def quadrature(outline: np.ndarray) -> tuple[float, np.ndarray, float]:
    """Area, centroid and second moment of a convex outline [n, 2], by triangles.

    The rule with a triangle's three edge midpoints is exact for quadratics, and uses neither
    Green's theorem nor the parallel axis theorem.
    """
    a, b, c = outline[0], outline[1:-1], outline[2:]
    area = np.abs((b[:, 0] - a[0]) * (c[:, 1] - a[1]) - (b[:, 1] - a[1]) * (c[:, 0] - a[0])) / 2
    middles = np.stack([(a + b) / 2, (b + c) / 2, (c + a) / 2])
    total = area.sum()
    centre = np.einsum("t,mtx->x", area / 3, middles) / total
    second = np.einsum("t,mtx->", area / 3, (middles - centre) ** 2)
    return float(total), centre, float(second)


def round_outline(start: Any, end: Any, radius: float) -> np.ndarray:
    """Outline of the convex hull of two discs; each end gets half of the corners."""
    lean = math.atan2(end[1] - start[1], end[0] - start[0])
    angles = lean + np.pi / 2 + np.linspace(0, 2 * np.pi, SIDES, endpoint=False)
    centres = np.where(np.arange(SIDES)[:, None] < SIDES / 2, start, end)
    return centres + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


POINTS = ((0.01, 0.0), (0.05, 0.01), (0.06, 0.03), (0.02, 0.04))


@pytest.mark.parametrize(("start", "end", "radius"), [
    ((0.01, 0.02), (0.05, -0.01), 0.004), ((0.0, 0.0), (0.001, 0.0), 0.02)], ids=["long", "stub"])
def test_capsule(start: Any, end: Any, radius: float) -> None:
    """Tolerance: what the inscribed polygon misses, see CHORD."""
    area, centre, second = quadrature(round_outline(start, end, radius))
    got_area, got_centre, got_second = area_properties(
        Capsule(type="capsule", start=start, end=end, radius=radius))
    assert got_area == pytest.approx(area, rel=CHORD)
    assert got_second == pytest.approx(second, rel=CHORD)
    assert got_centre == pytest.approx(tuple(centre), abs=1e-6 * radius)


@pytest.mark.parametrize("points", [POINTS, POINTS[::-1], POINTS[:3]], ids=["ccw", "cw", "tri"])
def test_polygon(points: Any) -> None:
    """Both sums are exact for polygons: rounding only."""
    area, centre, second = quadrature(np.array(points))
    got_area, got_centre, got_second = area_properties(Polygon(type="polygon", points=points))
    assert got_area == pytest.approx(area, rel=1e-12)
    assert got_centre == pytest.approx(tuple(centre), rel=1e-12)
    assert got_second == pytest.approx(second, rel=1e-11)


def test_circle_and_box_have_their_textbook_formulas() -> None:
    """Second moments pi r^4 / 2 and w h (w^2 + h^2) / 12, wherever they stand."""
    for shape, area, second in (
            (Circle(type="circle", radius=0.012, at=(0.1, -0.3)), np.pi * 0.012**2,
             np.pi * 0.012**4 / 2),
            (Box(type="box", size=(0.06, 0.02), at=(0.1, -0.3), angle=0.7), 0.06 * 0.02,
             0.06 * 0.02 * (0.06**2 + 0.02**2) / 12)):
        assert area_properties(shape) == (
            pytest.approx(area, rel=1e-12), pytest.approx((0.1, -0.3), rel=1e-12),
            pytest.approx(second, rel=1e-10))
