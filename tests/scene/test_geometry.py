"""Plain geometry against closed forms and quadrature over triangles."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.scene.bodies import Box, Capsule, Circle, Polygon
from sandbox.scene.geometry import area_properties


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


POINTS = ((0.01, 0.0), (0.05, 0.01), (0.06, 0.03), (0.02, 0.04))


@pytest.mark.parametrize("points", [POINTS, POINTS[::-1], POINTS[:3]], ids=["ccw", "cw", "tri"])
def test_polygon(points: Any) -> None:
    """Both sums are exact for polygons: rounding only."""
    area, centre, second = quadrature(np.array(points))
    got_area, got_centre, got_second = area_properties(Polygon(type="polygon", points=points))
    assert got_area == pytest.approx(area, rel=1e-12)
    assert got_centre == pytest.approx(tuple(centre), rel=1e-12)
    assert got_second == pytest.approx(second, rel=1e-11)


def test_other_shapes_have_their_textbook_formulas() -> None:
    """Second moments pi r^4 / 2 and w h (w^2 + h^2) / 12; of a capsule as of a box and two halves.

    The centroid of half a disc lies 4 r / (3 pi) from its centre.
    """
    r, w, h, length, off = 0.012, 0.06, 0.02, 0.05, 4 * 0.012 / (3 * math.pi)
    halves = math.pi * r**2 * (r**2 / 2 - off**2 + (length / 2 + off) ** 2)
    for shape, area, second in (
            (Circle(type="circle", radius=r, at=(0.1, -0.3)), math.pi * r**2, math.pi * r**4 / 2),
            (Box(type="box", size=(w, h), at=(0.1, -0.3), angle=0.7), w * h,
             w * h * (w**2 + h**2) / 12),
            (Capsule(type="capsule", start=(0.085, -0.32), end=(0.115, -0.28), radius=r),
             math.pi * r**2 + 2 * r * length,
             halves + 2 * r * length * (4 * r**2 + length**2) / 12)):
        assert area_properties(shape) == (
            pytest.approx(area, rel=1e-12), pytest.approx((0.1, -0.3), rel=1e-12),
            pytest.approx(second, rel=1e-10))
