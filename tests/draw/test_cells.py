import numpy as np
import pygame
from hypothesis import given
from hypothesis import strategies as st

from sandbox.draw.film.cells import CELL, Cells

STAGE = pygame.Rect(0, 30, 400, 250)
box = st.tuples(st.floats(-100, 500), st.floats(-100, 500), st.floats(0, 200),
                st.floats(0, 200)).map(lambda b: (b[0], b[1], b[0] + b[2], b[1] + b[3]))


@given(st.lists(box, min_size=1, max_size=6))
def test_rectangles_cover_all_and_do_not_overlap(boxes):
    rects = Cells(STAGE).mark(np.array(boxes))
    count = np.zeros((600, 600), int)
    for r in rects:
        assert STAGE.contains(r)
        count[r.top:r.bottom, r.left:r.right] += 1
    assert count.max() <= 1
    for x0, y0, x1, y1 in boxes:
        left, top = max(STAGE.left, int(x0)), max(STAGE.top, int(y0))
        right = min(STAGE.right, int(np.floor(x1)) + 1)
        bottom = min(STAGE.bottom, int(np.floor(y1)) + 1)
        assert count[top:max(top, bottom), left:max(left, right)].all()


def test_no_more_than_the_cells_touched():
    rects = Cells(STAGE).mark(np.array([[1.0, 31.0, 2.0, 32.0]]))
    assert rects == [pygame.Rect(0, 30, CELL, CELL)]


def test_what_is_not_a_number_covers_at_most_a_corner():
    Cells(STAGE).mark(np.array([[np.nan, 0.0, np.inf, 5.0]]))
