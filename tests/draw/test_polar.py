"""Forces by direction: drawn where they are, without what is no number."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from sandbox.draw.figure.polar import save_pushes

AROUND = np.linspace(0, 2 * np.pi, 120, endpoint=False)


def draw(path, bounds, found=(1.0, 1.0), directions=(0.0, np.pi),
         most=(1.0, 1.0)):
    save_pushes(path, title="a $ disc", around=AROUND, bounds=np.array(bounds),
                directions=np.array(directions), found=np.array(found), most=np.array(most),
                limit="0.2 mm")
    return path


def reach(path, colour=(47, 102, 144)):
    """From where to where a colour is found, as shares of width and height."""
    pixels = np.asarray(Image.open(path).convert("RGB")).astype(int)
    y, x = np.nonzero(np.abs(pixels - colour).max(axis=2) < 12)
    below = y < 0.85 * len(pixels)  # not in the legend
    return np.ptp(x[below]) / pixels.shape[1] if below.any() else 0.0


def test_the_bound_is_as_large_as_it_is_told(tmp_path):
    """A circle of half the force is half as wide, where the legend says as much of both."""
    whole = reach(draw(tmp_path / "a.png", np.full(120, 1.9), found=(2.0, 2.0)))
    half = reach(draw(tmp_path / "b.png", np.full(120, 0.95), found=(2.0, 2.0)))
    assert 0.5 < whole < 0.9
    assert half == pytest.approx(whole / 2, rel=0.02)


def test_what_is_no_number_is_left_out(tmp_path):
    upper = np.where(np.sin(AROUND) > 0, 1.0, np.inf)
    assert reach(draw(tmp_path / "a.png", upper, found=(np.inf, 1.0))) > 0.3
    assert reach(draw(tmp_path / "b.png", np.full(120, np.nan), found=(np.inf, np.inf))) == 0.0


@pytest.mark.parametrize("ending", ["svg", "pdf"])
def test_other_formats(tmp_path, ending):
    first = draw(tmp_path / f"one.{ending}", np.ones(120)).read_bytes()
    assert first == draw(tmp_path / f"two.{ending}", np.ones(120)).read_bytes()


def test_a_far_bound_does_not_stretch_the_picture(tmp_path):
    """One direction with a hundred times the force: all else is as large as without it."""
    far = np.where(np.arange(120) == 30, 100.0, 1.0)
    assert reach(draw(tmp_path / "a.png", far, found=(1.0, 100.0))) > 0.2


def test_what_did_not_move_has_a_mark(tmp_path):
    far = np.full(120, np.nan)
    marked = draw(tmp_path / "a.png", far, found=(1.0, np.inf))
    plain = draw(tmp_path / "b.png", far, found=(1.0,), directions=(0.0,), most=(1.0,))
    assert marked.read_bytes() != plain.read_bytes()


def test_marks_and_bound_are_at_their_own_directions(tmp_path, monkeypatch):
    """Moved at 0.3 rad by 1 N, not moved at 2 rad by 2 N, far beyond at 4 rad; all of one bound."""
    figures = []
    monkeypatch.setattr("sandbox.draw.figure.polar.style.save_figure",
                        lambda figure, _: figures.append(figure))
    bounds = 1.5 + 0.5 * np.cos(AROUND)
    draw(tmp_path / "a.png", bounds, found=(1.0, np.inf, 90.0), directions=(0.3, 2.0, 4.0),
         most=(1.0, 2.0, 90.0))
    lines = {line.get_marker(): line for line in figures[0].axes[0].lines}
    told = {marker: (line.get_xdata().tolist(), line.get_ydata().tolist())
            for marker, line in lines.items()}
    assert told["o"] == ([0.3], [1.0])
    assert told["x"] == ([2.0], [2.0])
    assert told["^"][0] == [4.0]
    around, drawn = (np.array(each) for each in told["None"])
    assert drawn == pytest.approx(1.5 + 0.5 * np.cos(around))
    assert np.ptp(around) == pytest.approx(2 * np.pi)
