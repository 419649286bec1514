"""Distances of convex shapes, with numbers worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.samples.nearby import PlacedPiece, apart

S = np.sqrt(0.5)


def piece(*corners, grown=0.0):
    return PlacedPiece(np.array(corners, dtype=float), grown, None)


BOX = piece((-1, -1), (1, -1), (1, 1), (-1, 1))


@pytest.mark.parametrize(("one", "two", "gap", "normal", "at"), [
    (piece((0, 0), grown=1), piece((3, 4), grown=2), 2.0, (0.6, 0.8), (1.2, 1.6)),
    (piece((0, 0), grown=1), piece((0, 1.5), grown=1), -0.5, (0, 1), (0, 0.75)),
    # capsules: side to side, end to end in line, side to end
    (piece((0, 0), (4, 0), grown=1), piece((2, 3), (9, 3), grown=1), 1.0, (0, 1), (None, 1.5)),
    (piece((0, 0), (0.3, 0.1), grown=0.01), piece((0.6, 0.2), (0.9, 0.3), grown=0.01),
     np.hypot(0.3, 0.1) - 0.02, np.array([3, 1]) / np.sqrt(10), (0.45, 0.15)),
    (piece((0, 0), (4, 0), grown=1), piece((2, -3), (2, -9), grown=0.5), 1.5, (0, -1), (2, -1.75)),
    # a polygon: a circle at a side, at a corner; a side, a corner; what is in it a little
    (BOX, piece((0.3, 3), grown=1), 1.0, (0, 1), (0.3, 1.5)),
    (BOX, piece((2, 2), grown=1), np.sqrt(2) - 1, (S, S), None),
    (BOX, piece((1, 0.5), (4, 0.5), (4, 3), (1, 3)), 0.0, (1, 0), (1, None)),
    (BOX, piece((1 + 1e-9, -3), (5, -3), (5, 3), (1 + 1e-9, 3)), 1e-9, (1, 0), (1, None)),
    (BOX, piece((1 - 1e-9, -3), (5, -3), (5, 3), (1 - 1e-9, 3)), -1e-9, (1, 0), (1, None)),
    (BOX, piece((1.5, 0), (3, -1), (3, 1)), 0.5, (1, 0), (1.25, 0)),
    (BOX, piece((2, 2), (3, 2), (3, 3), (2, 3)), np.sqrt(2), (S, S), (1.5, 1.5)),
])
def test_gap_normal_and_place(one, two, gap, normal, at):
    for pair, sign in (((two, one), -1), ((one, two), 1)):
        found, out, place = apart(*pair)
        assert found == pytest.approx(gap, abs=1e-15)
        assert out == pytest.approx(sign * np.asarray(normal))
    for i, wanted in enumerate(at or ()):
        if wanted is not None:
            assert place[i] == pytest.approx(wanted, abs=2e-9)
