"""The figure of a sweep: what is the same everywhere is one value, few values are all named."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sandbox.figure import style
from sandbox.figure.sweeps import SweepColumn, SweepDrawing, draw_sweep

PULL, STIFFNESS = np.repeat([2.0, 4.0, 7.0, 8.0], 2), np.tile([200.0, 400.0], 4)


@pytest.fixture
def drawn(monkeypatch):
    """Draws, and gives the figure before it is written."""
    def draw(varied, *kept, grid=True, failed=None, **more):
        figures = []
        monkeypatch.setattr(style, "save_figure", lambda figure, path: figures.append(figure))
        none = np.zeros(len(varied[0].values), dtype=bool)
        draw_sweep(Path("sweep.png"), SweepDrawing(
            varied, kept, none if failed is None else failed, none, grid=grid, **more))
        figures[0].canvas.draw()
        return figures[0].axes
    return draw


def test_what_differs_by_rounding_only_is_one_value(drawn):
    pull, k = np.repeat([2.0, 4.0, 7.0, 8.0], 4), np.tile([1.0, 2.0, 3.0, 4.0], 4)
    varied = [SweepColumn("pull", "N", pull), SweepColumn("k", "N/m", k)]
    same, close = (SweepColumn(name, "N", 35.0 + share * pull)
                   for name, share in (("same", 1e-12), ("close", 1e-6)))
    panel, _ = drawn(varied, same, close)  # and the bar of its colours
    assert panel.get_title(loc="left") == "close [N]"
    assert np.ptp(panel.collections[0].get_array()) > 0
    assert panel.figure.get_supxlabel() == "same = 35 N in all runs."
    panel, bar = drawn(varied, same, replace(same, name="too"))
    assert np.ptp(panel.collections[0].get_array()) == 0
    assert [text.get_text() for text in bar.get_yticklabels()] == ["35"]
    assert panel.figure.get_supxlabel() == "too = 35 N in all runs."


@pytest.mark.parametrize("turned", [False, True])
def test_a_path_of_few_values_makes_a_curve_of_each(drawn, turned):
    """Two stiffnesses of four pulls are two curves over the pull, whichever was written first."""
    varied = [SweepColumn("pull", "N", PULL), SweepColumn("k", "N/m", STIFFNESS)]
    panel, = drawn(varied[::-1] if turned else varied, SweepColumn("ratio", "", PULL / STIFFNESS))
    curves = [line for line in panel.lines if len(line.get_xdata())]
    assert [list(line.get_xdata()) for line in curves] == [[2, 4, 7, 8]] * 2
    assert list(curves[1].get_ydata()) == [2 / 400, 4 / 400, 7 / 400, 8 / 400]
    assert [text.get_text() for text in panel.get_legend().get_texts()] == [
        "k = 200 N/m", "k = 400 N/m"]
