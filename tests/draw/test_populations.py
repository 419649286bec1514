"""Distributions, agreement and classes: they are drawn, alike each time, and refuse nonsense."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sandbox.draw.figure import populations
from sandbox.draw.figure.populations import Agreement, ClassPlane, Spread, SpreadRow
from sandbox.draw.figure.style import BLUE, RED

VALUES = np.linspace(0.0, 3.0, 50)


def _drawn(path: Path) -> None:
    row = SpreadRow("all", [Spread("one", VALUES, "half"), Spread("two", VALUES[:0], "none")])
    populations.save_spreads(path / "spreads.svg", [row, row], x="force [N]", y="objects",
                             right=2.0, band=(1.0, 2.0), footnote="shaded")
    populations.save_agreement(path / "agreement.svg", [Agreement("both", VALUES, VALUES + 1e-6)],
                               x="closed [N]", y="found [N]", difference="off [N]", least=1e-9)
    populations.save_classes(
        path / "classes.svg", [[ClassPlane("plane", VALUES, VALUES, np.arange(50) % 2,
                                           [(VALUES, VALUES, RED)])]],
        [("even", BLUE), ("odd", RED)], x="x [mm]", y="y [mm]", band=(1.0, 2.0), top=3.0)


def test_they_are_drawn_alike(tmp_path: Path) -> None:
    for name in ("first", "again"):
        (tmp_path / name).mkdir()
        _drawn(tmp_path / name)
    files = sorted(path.name for path in (tmp_path / "first").iterdir())
    assert files == ["agreement.svg", "classes.svg", "spreads.svg"]
    for name in files:
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "again" / name).read_bytes()
    text = (tmp_path / "first" / "classes.svg").read_text()
    assert text.count("<!-- x [mm] -->") == 1


def test_rows_of_unequal_length(tmp_path: Path) -> None:
    one = Spread("one", VALUES, "")
    with pytest.raises(ValueError, match="same number of distributions, got 1, 2"):
        populations.save_spreads(tmp_path / "a.png", [SpreadRow("", [one]),
                                                      SpreadRow("", [one, one])],
                                 x="", y="", right=1.0)
