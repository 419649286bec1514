"""Names of fingers: beside their hinges all along a run, on nothing that is drawn."""

import dataclasses
import itertools

import numpy as np
import pygame
import pytest

from sandbox.draw.film.bounds import drift
from sandbox.draw.film.finger_names import Covered, place_names
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.palette import FAINT_INK
from sandbox.draw.film.sheet import Text

from .conftest import hand, recording

STAGE = pygame.Rect(0, 30, 600, 400)


def ground(*areas, samples=1):
    """A stage where rectangles of single samples are drawn on."""
    covered = Covered(STAGE, 1.0)
    for s in range(samples):
        drawn = np.zeros((480, 600), dtype=bool)
        for sample, (x, y, w, h) in areas:
            if sample == s:
                drawn[y:y + h, x:x + w] = True
        covered.add(drawn)
    return covered


def place(names, hinges, covered):
    return place_names([(name, k) for k, name in enumerate(names)],
                       np.asarray(hinges, dtype=float), covered, lambda text: (60, 14), 1.0)


def test_names_lie_on_nothing_that_any_sample_draws():
    """What passes in one sample only counts as what stands there in all."""
    hinges = [[[300, 200]]] * 3
    above = place(["one"], hinges, ground(samples=3))[0].rect((300, 200))
    assert above.bottom <= 200 - 14
    passed = ground((1, above), samples=3)
    other = place(["one"], hinges, passed)[0].rect((300, 200))
    assert not other.colliderect(above)
    assert place(["one"], hinges, ground((1, STAGE), samples=3)) == []


def test_names_ride_with_their_hinges():
    """The hinge moves by 200 pixels: the name keeps its place beside it, where nothing is then."""
    hinges = [[[200 + 100 * s, 200]] for s in range(3)]
    in_the_way = (330, 100, 140, 90)
    name, = place(["one"], hinges, ground((2, in_the_way), samples=3))
    first, last = (name.rect((200 + 100 * s, 200)) for s in (0, 2))
    assert last.x - first.x == 200
    assert last.y == first.y
    assert not last.colliderect(in_the_way)


def test_hinges_close_together_have_a_name_each():
    """Five hinges a few pixels apart: five names, which neither meet nor are crossed by leaders."""
    at = [(300 + 4 * k, 200 - 9 * k) for k in range(5)]
    covered = ground((0, (240, 150, 120, 250)))
    names = place(["index", "middle", "ring", "little", "thumb"], [at], covered)
    assert len(names) == 5
    lines = [name.leader(at[name.body], 1.0) for name in names]
    rects = [name.rect(at[name.body]) for name in names]
    for (one, line), (other, _) in itertools.permutations(zip(rects, lines, strict=True), 2):
        assert not one.colliderect(other)
        assert not other.clipline(*line)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_hinge_that_is_nowhere_has_no_name(value):
    assert place(["one"], [[[value, 0]]], ground()) == []


def test_leaders_are_drawn_and_taken_away_again():
    """A picture after others is the same as by itself: nothing of an earlier leader stays."""
    run = hand(fingers=1, samples=21)
    moved = run.arrays["body_pose"].copy()
    moved[:, :, 0] += np.linspace(0.0, 0.1, 21)[:, None]
    given = {key: value for key, value in run.arrays.items() if key not in ("time", "body_pose")}
    run = recording(run.mechanism, run.time, moved, **given)
    one, two = FrameRenderer(run, size=(400, 600)), FrameRenderer(run, size=(400, 600))
    name = dataclasses.replace(one._names[0], away=(-20.0, -150.0))    # over ground that is clear
    one._names = two._names = [name]
    for t in (0.0, 0.4, 0.9):
        one.draw(t)
    picture = one.draw(float(run.time[-1]))
    assert (picture == two.draw(float(run.time[-1]))).all()
    hinge = two.camera.to_pixels(run.arrays["body_pose"][-1, name.body, :2])
    start, end = name.leader(tuple(hinge), two.unit)
    x, y = (round((a + b) / 2) for a, b in zip(start, end, strict=True))
    faint = np.abs(picture[y - 3:y + 4, x - 3:x + 4].astype(int) - FAINT_INK).max(axis=2)
    assert faint.min() < 60


def test_a_finger_out_of_sight_has_no_name():
    """Its leader would lead out of the picture."""
    covered = ground(samples=2)
    assert place(["one"], [[[300, 440]], [[300, 440]]], covered) == []
    assert place(["one"], [[[300, 200]], [[700, 200]]], covered) == []


def test_names_go_along_with_a_body_that_is_followed():
    """The hand goes by 0.1 m and the camera with it: the name stays beside its hinge."""
    run = hand(fingers=1, samples=21)
    moved = run.arrays["body_pose"].copy()
    moved[:, :, 0] += np.linspace(0.0, 0.1, 21)[:, None]
    given = {key: value for key, value in run.arrays.items() if key not in ("time", "body_pose")}
    run = recording(run.mechanism, run.time, moved, **given)
    view = run.mechanism.view.model_copy(update={"follow": run.mechanism.groups[0].bodies[1]})
    renderer = FrameRenderer(run, size=(600, 600), view=view)
    name, = renderer._names
    way = drift(run, view)
    for sample in (0, 20):
        words = [word for word in renderer.sheet(float(run.time[sample])).words
                 if isinstance(word, Text) and word.face.text == name.text]
        hinge = renderer.camera.to_pixels(
            run.arrays["body_pose"][sample, name.body, :2] - way[sample])
        assert np.hypot(*(np.array(words[0].rect.center) - hinge - name.away)) <= 2
    assert np.hypot(*(way[20] - way[0])) > 0.05
