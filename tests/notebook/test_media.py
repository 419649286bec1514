"""Pictures, films and plots as values."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import sandbox


@pytest.fixture(scope="module")
def run() -> sandbox.Recording:
    return sandbox.simulate(sandbox.load_scene("single_finger", overrides={"run.duration": 0.2}))


def test_a_picture_is_that_of_render(run: sandbox.Recording, tmp_path: Path) -> None:
    sandbox.render(run, tmp_path / "a.png", size=(320, 240))
    picture = run.picture(size=(320, 240))
    assert picture.data == (tmp_path / "a.png").read_bytes()
    assert picture.data != run.picture(0.01, size=(320, 240)).data
    assert repr(picture).startswith("<PNG of single_finger at t = 0.19975 s, ")
    assert picture._repr_html_().startswith('<img style="max-width:100%" alt="single_finger at')
    picture.save(tmp_path / "b.png")
    assert (tmp_path / "b.png").read_bytes() == picture.data
    with pytest.raises(sandbox.OutputError, match=r"this is a \.png file"):
        picture.save(tmp_path / "b.gif")


def test_a_film_is_that_of_render(run: sandbox.Recording, tmp_path: Path) -> None:
    sandbox.render(run, tmp_path / "a.gif", size=(320, 240), speed=0.5)
    film = run.film(size=(320, 240), speed=0.5)
    assert film.data == (tmp_path / "a.gif").read_bytes()
    assert Image.open(io.BytesIO(film.data)).is_animated
    assert "data:image/gif;base64," in film._repr_html_()


def test_a_picture_of_nothing() -> None:
    with pytest.raises(sandbox.OutputError, match="nothing was recorded"):
        sandbox.Simulation(sandbox.load_scene("single_finger")).recording().picture()


def test_a_plot_shows_what_it_is_asked_for(run: sandbox.Recording, tmp_path: Path) -> None:
    figure = run.plot("finger.*.angle", "finger.tendon.tension", "finger.mcp.angle")
    angles, tension = figure.axes
    curves = {line.get_xdata().tobytes(): line for line in angles.lines}
    assert len(angles.lines) >= len(run.names("finger.*.angle"))
    assert len(tension.lines) >= 1
    assert figure.get_suptitle() == run.mechanism.title
    assert curves
    image = Image.open(io.BytesIO(figure._repr_png_()))
    assert image.format == "PNG"
    assert image.width > 500  # as wide as a column of a notebook, at least
    figure.savefig(tmp_path / "x.pdf")


def test_a_plot_of_one_against_another_in_a_window(run: sandbox.Recording) -> None:
    figure = run.plot("finger.pip.angle", x="finger.mcp.angle", begin=0.1, end=0.15)
    seen = (run.time >= 0.1) & (run.time <= 0.15)
    drawn = [line for line in figure.axes[0].lines if len(line.get_xdata()) > 2]
    np.testing.assert_allclose(drawn[0].get_xdata(), np.degrees(run["finger.mcp.angle"][seen]))
    np.testing.assert_allclose(drawn[0].get_ydata(), np.degrees(run["finger.pip.angle"][seen]))
    with pytest.raises(sandbox.SandboxError, match=r"did you mean 'finger\.mcp\.angle'"):
        run.plot("finger.pip.angle", x="finger.mcp.angel")
    assert len(run.plot("finger.pip.angle", x="time").axes) == 1
