"""Numbers beside arrows: read at half the size, told apart, none missing where there is room."""

import numpy as np
import pygame
import pytest

from sandbox.draw.film.canvas import Label, picture_unit, spots_at, type_size
from sandbox.draw.film.labels import MOST_LISTED, listed_together, place_labels
from sandbox.draw.film.linework import Linework
from sandbox.draw.film.palette import BACKGROUND, FORCE, INK, VELOCITY
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


def test_lines_are_counted_by_the_height_of_what_hides_them():
    """An upright line through a text counts one, a level one as often as it is long."""
    lines = picture((100, 50, 200, 200))
    assert lines.under(pygame.Rect(80, 100, 60, 20)) == pytest.approx(1.0)
    assert lines.under(pygame.Rect(80, 100, 300, 20)) == pytest.approx(2.0)
    assert lines.under(pygame.Rect(150, 40, 60, 20)) == pytest.approx(60 / 20)
    assert lines.under(pygame.Rect(120, 100, 60, 20)) == 0.0
    assert lines.under(pygame.Rect(-50, -50, 20, 20)) == 0.0
    assert picture((100, 50, 200, 200), colour=(225, 225, 225)).under(
        pygame.Rect(80, 100, 60, 20)) == 0.0, "hatching hides nothing"


def test_in_a_picture_that_stands_alone_a_number_hides_as_little_as_it_can():
    """Three places beside the arrow: the first two lie on lines, the last is in the open."""
    lines = picture((180, 60, 8, 100), (202, 60, 8, 100), (100, 190, 190, 30))
    spots = [(200.0, 100.0), (200.0, 200.0), (150.0, 140.0)]
    label = Label("3.0", spots_at(*spots), FORCE, unit="N", at=AT)
    (film,), (still,) = placed([label]), placed([label], drawn=lines)
    assert film.rect.center == pytest.approx(spots[0], abs=1)
    assert still.rect.center == pytest.approx(spots[2], abs=1)


def test_a_number_stands_off_where_all_about_its_arrow_is_full():
    """A comb of lines 60 pixels wide about the tip, and open ground beyond."""
    comb = picture(*((x, 120, 4, 60) for x in range(170, 230, 8)))
    assert isinstance(placed([value("3.0")])[0], Text)
    line, word = placed([value("3.0")], drawn=comb)
    assert isinstance(line, Hair)
    assert comb.under(word.rect) == 0.0
    assert STAGE.contains(word.rect)
    gap = np.hypot(line.start[0] - AT[0], line.start[1] - AT[1])
    assert gap < 60, "it goes no farther than it has to"


def test_one_line_is_no_reason_to_stand_off():
    (word,) = placed([value("3.0")], drawn=picture((150, 100, 50, 100)))
    assert word.rect.center == pytest.approx(AT, abs=1)


def test_what_is_avoided_counts_as_a_line():
    label = Label("3.0", spots_at(AT, (150.0, 100.0)), FORCE, unit="N", at=AT)
    around = [pygame.Rect(195, 145, 10, 10)]
    (word,) = placed([label], avoided=around, drawn=picture())
    assert word.rect.center == pytest.approx((150, 100), abs=1)


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
