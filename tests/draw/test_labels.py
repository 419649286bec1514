"""Numbers beside arrows: read at half the size, told apart, none missing where there is room."""

import numpy as np
import pygame
import pytest

from sandbox.draw.film.canvas import Label, spots_at
from sandbox.draw.film.labels import place_labels
from sandbox.draw.film.linework import Linework
from sandbox.draw.film.palette import BACKGROUND, FORCE, INK
from sandbox.draw.film.sheet import Hair, Text
from sandbox.draw.film.typesetter import Typesetter

STAGE = pygame.Rect(0, 30, 400, 300)
AT = (200.0, 150.0)


def value(text, at=AT, colour=FORCE, unit="N"):
    return Label(text, spots_at(at), colour, unit=unit, at=at)


def placed(labels, taken=(), avoided=(), drawn=None):
    return list(place_labels(labels, Typesetter(20), 1.0, STAGE, list(taken), avoided, drawn))


def picture(*boxes, colour=INK):
    """The outlines of boxes, 2 pixels wide, on a blank ground; and their pixels."""
    pixels = np.full((360, 400, 3), BACKGROUND, dtype=np.uint8)
    for left, top, width, height in boxes:
        ground = pixels[top + 2:top + height - 2, left + 2:left + width - 2].copy()
        pixels[top:top + height, left:left + width] = colour
        pixels[top + 2:top + height - 2, left + 2:left + width - 2] = ground
    return Linework(pixels)


def test_numbers_at_one_place_are_one_list():
    words = placed([value("3.0"), value("2.0", (205.0, 146.0)), value("1.0", (260.0, 150.0))])
    assert [word.face.text for word in words] == ["3.0, 2.0 N", "1.0 N"]


def test_a_number_without_room_stands_off_on_a_line_that_crosses_no_text():
    """All about the arrow's tip is taken, and words stand above: the number goes elsewhere."""
    words = pygame.Rect(100, 80, 200, 24)
    taken = [words, *(pygame.Rect(x, y, 14, 14) for x in (170, 193, 216) for y in (130, 143, 156))]
    line, word = placed([value("3.0")], taken)
    assert isinstance(line, Hair)
    assert isinstance(word, Text)
    assert word.rect.collidelist(taken) == -1
    assert STAGE.contains(word.rect)
    assert not words.clipline(line.start, line.end)
    assert np.hypot(line.end[0] - AT[0], line.end[1] - AT[1]) < 4


def test_without_any_room_there_is_no_number():
    assert placed([value("3.0")], [STAGE]) == []
    assert placed([Label("3.0 N", spots_at(AT), FORCE)], [pygame.Rect(190, 140, 20, 20)]) == []


def test_in_a_picture_that_stands_alone_a_number_hides_as_little_as_it_can():
    """Three places beside the arrow: the first two lie on lines, the last is in the open."""
    lines = picture((180, 60, 8, 100), (202, 60, 8, 100), (100, 190, 190, 30))
    spots = [(200.0, 100.0), (200.0, 200.0), (150.0, 140.0)]
    label = Label("3.0", spots_at(*spots), FORCE, unit="N", at=AT)
    (film,), (still,) = placed([label]), placed([label], drawn=lines)
    assert film.rect.center == pytest.approx(spots[0], abs=1)
    assert still.rect.center == pytest.approx(spots[2], abs=1)
