"""Stills on paper: as wide as a column, with letters that are read there, and their surround."""

import re

import pytest
from PIL import Image

from sandbox.errors import OutputError
from sandbox.picture.film import render
from sandbox.picture.options import LETTERS, PrintSize, paper_of

SIZE = re.compile(r"([0-9.]+)px")


def letters(path):
    """Sizes of all letters [pt], and width and height [mm] of an SVG."""
    text = path.read_text()
    sides = [float(re.search(rf'<svg[^>]*? {side}="([0-9.]+)pt"', text)[1]) / 72 * 25.4
             for side in ("width", "height")]
    return [float(size) for size in SIZE.findall(text)], sides


@pytest.mark.parametrize(("word", "paper"), [
    ("85mm", PrintSize(85)), ("8.5 cm", PrintSize(85)), ("85mmx70mm", PrintSize(85, 70)),
    ("85 x 70 mm", PrintSize(85, 70)), ("3.5in", PrintSize(3.5 * 25.4)),
    ("8.5cm × 70mm", PrintSize(85, 70)),
    ("800x600", None), ("2x", None), ("85", None), ((800, 600), None), ("mm", None),
])
def test_a_size_on_paper_has_a_unit(word, paper):
    found = paper_of(word)
    assert found == paper if paper is None else (found.width, found.height) == pytest.approx(
        (paper.width, paper.height) if paper.height else (paper.width, None))


@pytest.mark.parametrize("word", ["85mm", "85mmx70mm"])
@pytest.mark.parametrize("more", [{}, {"strip": 3}])
def test_no_letter_of_a_still_on_paper_is_smaller_than_seven_points(
    finger_run, tmp_path, word, more,
):
    file, = render(finger_run, tmp_path / "a.svg", size=word, **more)
    sizes, (width, height) = letters(file)
    assert sizes
    assert min(sizes) >= LETTERS == 7.0  # points, as the docs say
    assert width == pytest.approx(paper_of(word).width, abs=0.01)
    if paper_of(word).height:
        assert height == pytest.approx(70, abs=0.1)


def test_a_still_on_paper_has_pixels_enough_for_print_and_says_how_large_it_is(
    finger_run, tmp_path,
):
    file, = render(finger_run, tmp_path / "a.png", size="85mmx70mm")
    with Image.open(file) as picture:
        assert picture.size == (1004, 827)
        assert picture.info["dpi"] == pytest.approx((300, 300), abs=0.1)


def test_a_film_has_no_size_on_paper(finger_run, tmp_path):
    with pytest.raises(OutputError, match=r"a film has pixels.*\.svg"):
        render(finger_run, tmp_path / "a.gif", size="85mm")
