"""Distributions, agreement and classes: they are drawn, alike each time, and refuse nonsense."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sandbox.draw.figure import populations
from sandbox.draw.figure.populations import Agreeing, ClassPlane, OneSpread, SpreadRow
from sandbox.draw.figure.style import BLUE, RED

VALUES = np.linspace(0.0, 3.0, 50)


def _drawn(path: Path) -> None:
    row = SpreadRow("all", [OneSpread("one", VALUES, "half"), OneSpread("two", VALUES[:0], "none")])
    populations.save_spreads(path / "spreads.svg", [row, row], x="force [N]", y="objects",
                             right=2.0, band=(1.0, 2.0), footnote="shaded")
    populations.save_agreement(path / "agreement.svg", [Agreeing("both", VALUES, VALUES + 1e-6)],
                               x="closed [N]", y="found [N]", difference="off [N]", least=1e-9)
    populations.save_classes(
        path / "classes.svg", [[ClassPlane("plane", VALUES, VALUES, np.arange(50) % 2,
                                           [(VALUES, VALUES, RED)])]],
        [("even", BLUE), ("odd", RED)], x="x [mm]", y="y [mm]", band=(1.0, 2.0), top=3.0)


def test_they_are_drawn(tmp_path: Path) -> None:
    _drawn(tmp_path)
    told = {"spreads.svg": "force [N]", "agreement.svg": "found [N]", "classes.svg": "x [mm]"}
    for name, label in told.items():
        assert f"<!-- {label} -->" in (tmp_path / name).read_text()
    # one distribution in two has values: as many bars in each of two rows
    assert (tmp_path / "spreads.svg").read_text().count("<!-- half -->") == 2


def test_rows_of_unequal_length(tmp_path: Path) -> None:
    one = OneSpread("one", VALUES, "")
    with pytest.raises(ValueError, match="same number of distributions, got 1, 2"):
        populations.save_spreads(tmp_path / "a.png", [SpreadRow("", [one]),
                                                      SpreadRow("", [one, one])],
                                 x="", y="", right=1.0)
