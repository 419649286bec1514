"""The figure of a sweep: what is the same everywhere is one value, few values are all named."""

from pathlib import Path

import numpy as np
import pytest

from sandbox.draw.figure import style
from sandbox.draw.figure.sweeps import SweepColumn, SweepDrawing, draw_sweep

PULL, STIFFNESS = np.repeat([2.0, 4.0, 7.0, 8.0], 2), np.tile([200.0, 400.0], 4)


@pytest.fixture
def drawn(monkeypatch):
    """Draws, and gives the figure before it is written."""
    def draw(varied, *kept):
        figures = []
        monkeypatch.setattr(style, "save_figure", lambda figure, path: figures.append(figure))
        none = np.zeros(len(PULL), dtype=bool)
        draw_sweep(Path("sweep.png"), SweepDrawing(varied, kept, none, none, grid=True))
        figures[0].canvas.draw()
        return figures[0].axes
    return draw


def test_what_differs_by_rounding_only_is_one_value(drawn):
    varied = [SweepColumn("pull", "N", PULL), SweepColumn("k", "N/m", STIFFNESS)]
    panels = drawn(varied, SweepColumn("same", "N", 35.0 + 1e-12 * PULL),
                   SweepColumn("close", "N", 35.0 + 1e-6 * PULL))
    same, close = (panel.collections[0].get_array() for panel in panels[:2])
    assert np.ptp(same) == 0
    assert np.ptp(close) > 0
    assert [text.get_text() for text in panels[2].get_yticklabels()] == ["35"]


def test_few_values_of_an_axis_are_its_ticks(drawn):
    panel, = drawn([SweepColumn("pull", "N", PULL)], SweepColumn("force", "N", PULL))
    assert list(panel.get_xticks()) == [2, 4, 7, 8]
    panel, = drawn([SweepColumn("pull", "N", np.array([2, 2.001, 4, 5, 6, 7, 8, 9.0]))],
                   SweepColumn("force", "N", PULL))
    assert 2.001 not in panel.get_xticks()  # they would be written over each other
