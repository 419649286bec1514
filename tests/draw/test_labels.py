"""Numbers beside arrows: read at half the size, told apart, none missing where there is room."""

import numpy as np
import pygame
import pytest

from sandbox.draw.film.canvas import Label, picture_unit, spots_at, type_size
from sandbox.draw.film.labels import MOST_LISTED, listed_together, place_labels
from sandbox.draw.film.palette import FORCE, VELOCITY
from sandbox.draw.film.sheet import Hair, Text
from sandbox.draw.film.typesetter import Typesetter

STAGE = pygame.Rect(0, 30, 400, 300)
AT = (200.0, 150.0)


def value(text, at=AT, colour=FORCE, unit="N"):
    return Label(text, spots_at(at), colour, unit=unit, at=at)


def placed(labels, taken=()):
    return list(place_labels(labels, Typesetter(20), 1.0, STAGE, list(taken)))


def test_numbers_at_one_place_are_one_list():
    words = placed([value("3.0"), value("2.0", (205.0, 146.0)), value("1.0", (260.0, 150.0))])
    assert [word.face.text for word in words] == ["3.0, 2.0 N", "1.0 N"]


@pytest.mark.parametrize("other", [
    value("2.0", colour=VELOCITY), value("2.0", unit="m/s"), value("2.0", (220.0, 150.0)),
    Label("2.0", spots_at(AT), FORCE)])
def test_what_is_of_another_kind_or_place_is_no_part_of_the_list(other):
    assert [each.text for each in listed_together([value("3.0"), other], 1.0)] == ["3.0", "2.0"]


def test_a_list_stays_short():
    found = listed_together([value(str(k)) for k in range(MOST_LISTED + 1)], 1.0)
    assert [each.text.count(",") for each in found] == [MOST_LISTED - 1, 0]


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


def test_one_rule_for_the_size_of_type():
    """As wide, as large; twice the size, twice as large; a band by its height."""
    sizes = [type_size(picture_unit(size)) for size in ((800, 600), (800, 1000), (800, 300))]
    assert sizes == [20, 20, 20]
    assert type_size(picture_unit((1600, 1200))) == 40
    assert type_size(picture_unit((1920, 1080))) == 48
    assert type_size(picture_unit((1600, 300))) == 20
    assert type_size(picture_unit((100, 100))) == 11


def test_a_text_stands_on_what_is_to_be_avoided_only_if_no_other_place_is_free():
    label = Label("1 N", spots_at((100, 100), (100, 200)))
    groove = pygame.Rect(50, 90, 100, 20)
    (text,) = place_labels([label], Typesetter(20), 1.0, STAGE, [], [groove])
    assert text.rect.center == pytest.approx((100, 200), abs=1)
    (text,) = place_labels([label], Typesetter(20), 1.0, STAGE, [pygame.Rect(50, 190, 100, 20)],
                           [groove])
    assert text.rect.center == pytest.approx((100, 100), abs=1)
