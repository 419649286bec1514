"""Plots for reports."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sandbox.figure import style
from sandbox.figure.panels import Axis, Curve, Panel, save_panels

X = np.linspace(0.1, 1, 20)


def words(path: Path) -> list[str]:
    """What is written in an SVG: matplotlib leaves each text as a comment beside its outlines."""
    return re.findall(r"<!-- (.*?) -->", path.read_text())


def saved(folder: Path, *curves: Curve) -> Path:
    path = folder / "plot.svg"
    save_panels(path, [Panel("", Axis("x"), Axis("y"), curves)])
    return path


def test_what_is_before_the_comma_and_behind_it_is_said_once(tmp_path: Path) -> None:
    curves = [Curve(f"joint {i}, {tail}", X, i * X, kind) for i in range(4)
              for tail, kind in (("(31)", "line"), ("engine", "points"))]
    told = words(saved(tmp_path, *curves))
    assert [word for word in told if word.startswith(("joint", "(31)", "engine"))] == [
        *(f"joint {i}" for i in (0, 1, 2, 3)), "(31)", "engine"]


def test_lines_that_coincide_show_all_their_colours(tmp_path: Path) -> None:
    """Each has the same share of the line: that of the last alone were nearly all of it."""
    four = [Curve(f"string {i}", X, 0 * X + 1) for i in range(4)]
    save_panels(tmp_path / "plot.png", [Panel(marks=[*four, Curve("other", X, X)])])
    with Image.open(tmp_path / "plot.png") as picture:
        pixels = np.asarray(picture.convert("RGB")).astype(int)
    pixels = pixels[:, :int(0.7 * pixels.shape[1])]  # without the names
    share = np.array([int((np.abs(pixels - rgb(hue)).max(axis=2) < 8).sum())
                      for hue in style.COLOURS[:4]])
    assert share / share.sum() == pytest.approx([0.25] * 4, abs=0.06)


def rgb(hue: str) -> list[int]:
    return [int(hue[k:k + 2], 16) for k in (1, 3, 5)]
