"""The figure of a sweep: what is the same everywhere is one value, few values are all named."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sandbox.draw.figure import style
from sandbox.draw.figure.sweeps import FoundLine, SweepColumn, SweepDrawing, draw_sweep

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


def test_points_that_fail_have_another_colour(drawn):
    varied = [SweepColumn(name, "", column) for name, column in
              (("a", PULL), ("b", STIFFNESS), ("c", PULL + STIFFNESS))]
    held = np.array([1, 0, 0, 1, np.nan, 1, 1, 1.0])
    panels = drawn(varied, SweepColumn("force", "N", PULL), held=held, condition="force > 1 N")
    for panel in panels:
        orange, = (line for line in panel.lines if line.get_color() == style.ORANGE)
        assert len(orange.get_xdata()) == 2
    assert panels[0].figure.get_supxlabel() == "2 of 8 runs fail force > 1 N: orange."


def test_what_a_search_found_is_a_line(drawn):
    size = SweepColumn("size", "m", np.linspace(0.1, 0.2, 4))
    panel, _ = drawn([size], SweepColumn("v", "m/s", np.arange(4.0)), grid=False,
                     found=FoundLine("size", 0.14, 0.15, 0.16, "Dashed: v < 1 m/s"))
    dashed = [line.get_xdata()[0] for line in panel.lines if line.get_color() == style.INK]
    assert 150 in dashed
    assert panel.figure.get_supxlabel() == "Dashed: v < 1 m/s"
