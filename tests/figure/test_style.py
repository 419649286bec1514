"""What all figures share."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.figure import style


@given(st.lists(st.floats(0, 1), min_size=1, max_size=12), st.floats(0.01, 0.2))
def test_labels_move_apart(wanted: list[float], gap: float) -> None:
    places = style.apart(np.array(wanted), gap)
    order = np.argsort(wanted, kind="stable")
    assert np.all(np.diff(places[order]) >= gap - 1e-12)
    # least squares: the mean does not move
    assert places.mean() == pytest.approx(np.mean(wanted))


@pytest.mark.parametrize(("value", "text"), [
    (16474.3, "16470"), (2.97136, "2.971"), (5.0, "5"), (0.0, "0"), (-0.4701, "-0.4701"),
    (99.996, "100"), (float("inf"), "-"), (float("nan"), "-"), (1.2e-5, "0.000012"),
])
def test_numbers(value: float, text: str) -> None:
    assert style.number(value) == text


def test_units_that_people_read() -> None:
    small, large = np.array([0.003, np.nan]), np.array([0.003, -2.0])
    assert style.shown_as("rad").factor == pytest.approx(57.29578)
    assert style.shown_as("rad/s").unit == "deg/s"
    assert style.shown_as("m", small).unit == "mm"
    assert style.shown_as("m", small, large) == style.Shown(1, "m", " m")
    assert style.shown_as("N m") == style.Shown(1, "N m", " N m")
    assert style.shown_as("1") == style.Shown(1, "", "")


@pytest.mark.parametrize("suffix", style.SUFFIXES)
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


def test_no_other_files(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"\.png, \.svg, \.pdf"):
        style.save_figure(style.new_figure(60), tmp_path / "x.bmp")
