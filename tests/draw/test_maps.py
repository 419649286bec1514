"""Maps of reachable poses: written whole, in every format, refused without content."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from sandbox.draw.figure.maps import Bar, MapRow, Plane, Region, save_bars, save_maps


def row(*planes):
    return MapRow("pull 1 N", [("a box: reaches it", "#2f6690")], planes)


def plane(high=5.0):
    box = Region("a box", "#2f6690", [(1.0, 4.0, 1.0, high)])
    line = Region("a line", "#c2571a", x=np.linspace(0, 3, 9), y=np.linspace(0, 3, 9))
    return Plane("x [deg]", "y [deg]", 10.0, 10.0, (box, line), (2.0, 2.0), stops=(20.0, 8.0))


def share(path, colour):
    """Share of the picture's pixels near a colour."""
    pixels = np.asarray(Image.open(path).convert("RGB")).astype(int)
    return float((np.abs(pixels - colour).max(axis=2) < 12).mean())


def test_maps_show_what_they_are_given(tmp_path):
    small, large = tmp_path / "small.png", tmp_path / "large.png"
    save_maps(small, [row(plane(2.0))])
    save_maps(large, [row(plane(8.0))])
    blue = (160, 184, 205)  # the box's colour at its opacity, on white
    assert share(large, blue) > 4 * share(small, blue) > 0


@pytest.mark.parametrize("ending", ["svg", "pdf"])
def test_other_formats(tmp_path, ending):
    save_maps(tmp_path / f"maps.{ending}", [row(plane()), row(plane())])
    assert (tmp_path / f"maps.{ending}").stat().st_size > 5000


def test_unequal_rows_are_refused(tmp_path):
    with pytest.raises(ValueError, match="got 1, 2"):
        save_maps(tmp_path / "maps.png", [row(plane()), row(plane(), plane())])
    with pytest.raises(ValueError, match="got none"):
        save_maps(tmp_path / "maps.png", [])


def test_bars_need_bars(tmp_path):
    with pytest.raises(ValueError, match="got none"):
        save_bars(tmp_path / "bars.png", [], title="", x="", right=1.0, marks=(), notes=())
    save_bars(tmp_path / "bars.png", [Bar("one", "a", "#2f6690", 1.0, 9.0)], title="ranges",
              x="pull [N]", right=5.0, marks=(2.0,), notes=[("#2f6690", "from 1 N")])
    assert share(tmp_path / "bars.png", (47, 102, 144)) > 0.05
