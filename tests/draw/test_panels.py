"""Plots for reports."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sandbox.draw.figure.panels import Curve, Panel, save_panels

X = np.linspace(0.1, 1, 20)
PANEL = Panel("Title", "x [m]", "y [N]", [Curve("one", X, X**2), Curve("two", X, X, "points")])


def test_panels_stand_side_by_side(tmp_path: Path) -> None:
    save_panels(tmp_path / "one.png", [PANEL])
    save_panels(tmp_path / "two.png", [PANEL, PANEL])
    sizes = []
    for name in ("one", "two"):
        with Image.open(tmp_path / f"{name}.png") as picture:
            sizes.append(picture.size)
    one, two = sizes
    assert two[0] == pytest.approx(2 * one[0], abs=2)
    assert two[1] == one[1]


def test_the_same_panel_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a.png", "b.png"):
        save_panels(tmp_path / name, [PANEL])
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


@pytest.mark.parametrize("panel", [
    Panel("", "h", "e", [Curve("e", X, X**2, "joined"), Curve("2", X, X, "dashed")], scale="log"),
    Panel("", "p", "", [Curve("", X[:3], np.arange(3.0), "ticks")], rows=["a", "b", "c"]),
    Panel("", "t", "f", [Curve(str(i), X, i * X) for i in range(6)], top=2.0),
], ids=["log", "rows", "many"])
def test_other_kinds(tmp_path: Path, panel: Panel) -> None:
    save_panels(tmp_path / "plot.svg", [panel])
    assert "<svg" in (tmp_path / "plot.svg").read_text()


def test_nothing_to_draw(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="at least one"):
        save_panels(tmp_path / "plot.png", [])
