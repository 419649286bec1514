"""What all figures share."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sandbox.figure import style
from sandbox.figure.style import NEAR
from sandbox.figure.sweeps import SweepColumn, SweepDrawing, draw_sweep


@pytest.mark.parametrize(("value", "text"), [
    (16474.3, "16470"), (2.97136, "2.971"), (5.0, "5"), (0.0, "0"), (-0.4701, "-0.4701"),
    (99.996, "100"), (float("inf"), "-"), (float("nan"), "-"), (1.2e-5, "0.000012"),
])
def test_numbers(value: float, text: str) -> None:
    assert style.number(value) == text


def test_units_that_people_read() -> None:
    small, large = np.array([0.003, np.nan]), np.array([0.003, -2.0])
    assert style.shown_as("rad").factor == pytest.approx(57.29578)
    assert style.shown_as("m", small).unit == "mm"
    assert style.shown_as("m", small, large) == style.Shown(1, "m")
    assert [style.shown_as(each).unit for each in ("rad/s", "1", "Pa")] == ["deg/s", "", "Pa"]
    assert style.shown_as("Pa", np.array([-5e4, np.nan])) == style.Shown(1e-3, "kPa")


@pytest.mark.parametrize("suffix", style.METADATA)
def test_the_same_figure_gives_the_same_bytes(tmp_path: Path, suffix: str) -> None:
    for name in "ab":
        figure = style.new_figure(60)
        axes = figure.subplots()
        axes.plot([0, 1], [0, 1])
        axes.set_title(style.plain("costs $5_x$"))
        style.save_figure(figure, tmp_path / f"{name}{suffix}")
    a, b = ((tmp_path / f"{name}{suffix}").read_bytes() for name in "ab")
    assert a == b
    assert len(a) > 1000


def test_texts_print_and_have_an_end() -> None:
    assert style.plain("a\u202e\x1b$") == r"a\u202e\x1b\$"
    assert len(style.plain("W" * 20_000)) == style.MAX_LETTERS


X = np.linspace(0.0, 1.0, 201)


def test_where_two_part_each_runs_alone():
    """One bends at 0.6 with slope 1: it is alone from NEAR beyond that."""
    axes = style.new_figure(60).subplots()
    axes.set(xlim=(0, 1), ylim=(0, 1))
    lines = axes.plot(X, X) + axes.plot(X, np.minimum(X, 0.6))
    style.show_coincident(axes, lines)
    dashed = axes.lines[2:]
    assert [line.get_color() for line in dashed] == [line.get_color() for line in lines]
    for line in dashed:
        together = line.get_xdata()[np.isfinite(line.get_ydata())]
        assert together[[0, -1]] == pytest.approx([0.0, 0.6 + NEAR], abs=0.006)


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
    one, two, *_ = drawn(varied, same, close)
    assert [axes.get_title(loc="left") for axes in (one, two)] == ["same [N]", "close [N]"]
    assert [np.ptp(axes.collections[0].get_array()) > 0 for axes in (one, two)] == [False, True]


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
