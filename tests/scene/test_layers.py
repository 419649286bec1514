"""Layers of pictures: what words mean, what is shown by default, words for slips."""

from types import SimpleNamespace

import pytest

from sandbox.scene.layers import EVERY, meant, parse_layers
from sandbox.wording import WrongValueError


def test_words_are_taken_in_order():
    assert parse_layers("traces, -contacts") == {"traces": EVERY, "contacts": ()}
    assert parse_layers(["contacts", "-contacts"]) == {"contacts": ()}
    assert parse_layers(["-contacts", "contacts"]) == {"contacts": EVERY}


def test_layers_may_name_their_bodies():
    found = parse_layers({"velocity": ["finger*", "disc"], "contacts": False, "axes": True,
                   "body_names": "disc"})
    assert found == {"velocity": ("finger*", "disc"), "contacts": (), "axes": EVERY,
                     "body_names": ("disc",)}
    bodies = [SimpleNamespace(name=name, role=role) for name, role in (
        ("palm", "palm"), ("finger.distal", "phalanx"), ("disc", "object"))]
    assert meant(found["velocity"], bodies) == [1, 2]
    assert meant(found["contacts"], bodies) == []
    assert meant(["role:obj*", "pa*"], bodies) == [0, 2]
    assert meant(EVERY, bodies) == [0, 1, 2]


@pytest.mark.parametrize(("value", "message", "hint"), [
    (["velocty"], "no layer named 'velocty'", "'velocity'"),
    ("contact", "no layer named 'contact'", "'contacts'"),
    ([3], "the number 3 is no layer", ""),
    ({"velocity": 3}, "the number 3 does not name the bodies for 'velocity'", ""),
    ({"tensions": ["a"]}, "'tensions' is shown for all bodies or for none", ""),
])
def test_wrong_layers_are_refused_with_the_allowed_ones(value, message, hint):
    with pytest.raises(WrongValueError) as caught:
        parse_layers(value)
    assert message in caught.value.message
    assert caught.value.hint == hint
    assert caught.value.allowed
