"""Bodies so unlike that rounding shows are named, with the number; others are not."""

from __future__ import annotations

from typing import Any

import pytest

from sandbox.engine.inspect import inspect
from sandbox.scene.mechanism import Mechanism

DISC = {"type": "circle", "radius": 0.005}
APART = [{"between": ["*", "*"], "collide": False}]


def pair(light: float, *, links: Any = None, inertia: float | None = None) -> dict[str, Any]:
    """Two discs 20 mm apart, of 2 kg and of less."""
    return {"bodies": [{"name": "heavy", "mass": 2.0, "shapes": [DISC]},
                       {"name": "light", "mass": light, "at": [0.02, 0], "shapes": [DISC],
                        **({"inertia": inertia} if inertia else {})}], **(links or {})}


def said(scene: dict[str, Any]) -> list[str]:
    found = inspect(Mechanism.model_validate(scene))
    assert {one.severity for one in found} <= {"warning"}
    return [str(one) for one in found if one.code == "mass-ratio"]


PIN = {"joints": [{"type": "pin", "name": "j", "a": "heavy", "b": "light", "on_b": [0, 0]}]}
CORD = {"contacts": APART, "tendons": [{"name": "cord", "guides": [
    {"body": "heavy"}, {"body": "light"}]}]}
TOUCH: dict[str, Any] = {}


@pytest.mark.parametrize("links", [PIN, CORD, TOUCH], ids=["joint", "cord", "contact"])
def test_two_bodies_and_the_number(links):
    assert said(pair(2.1e-6, links=links)) == []
    line, = said(pair(1.9e-6, links=links))
    assert line.startswith("warning: light: has 1.9e-06 kg where 'heavy' has 2 kg")
    assert "masses differ by 1 : 1.1e+06; rounding errors show beyond 1 : 1e+06" in line
    assert line.endswith("forces are right to 1e-09 of the largest")
    assert said(pair(1e-10, links=links))[0].endswith("make the two more alike")


SPRING = {"springs": [{"type": "linear", "name": "s", "a": "heavy", "b": "light",
                       "stiffness": 1e-3}]}


@pytest.mark.parametrize("more", [{}, SPRING])
def test_what_has_nothing_to_do_with_each_other_may_be_as_unlike_as_it_likes(more):
    """A spring is no part of the balance that is solved for."""
    assert said(pair(1e-9, links={"contacts": APART, **more})) == []


def test_a_body_in_between_links_the_two():
    scene = pair(1e-6, links={"contacts": APART})
    scene["bodies"].append({"name": "mean", "mass": 1e-3, "inertia": 1e-7, "at": [0.01, 0]})
    scene["joints"] = [{"type": "pin", "name": f"to_{one}", "a": "mean", "b": one, "on_b": [0, 0]}
                       for one in ("heavy", "light")]
    assert "light: has 1e-06 kg where 'heavy'" in said(scene)[0]
    scene["bodies"][2]["motion"] = "fixed"
    del scene["bodies"][2]["mass"], scene["bodies"][2]["inertia"]
    assert said(scene) == []


@pytest.mark.parametrize("size", [[0.08, 0.002], [0.002, 0.08]])
def test_a_shape_is_pushed_as_far_out_as_it_reaches(size):
    """40 mm: 1e-13 kg m^2 over that squared."""
    rod = {"type": "box", "size": size}
    scene = pair(0.1, links=TOUCH, inertia=1e-13)
    scene["bodies"][1] |= {"shapes": [rod], "at": [0.2, 0]}
    assert "at 40.01 mm from its centre as 6.2e-11 kg would" in said(scene)[0]


def test_a_body_that_turns_too_easily_is_as_light_where_it_is_pushed():
    """1/m + r^2/I with 0.1 kg, 1e-12 kg m^2 and 20 mm: 2.5e-9 kg."""
    found, = said(pair(0.1, links=PIN | {"joints": [
        {**PIN["joints"][0], "on_a": [0, 0], "on_b": [-0.02, 0]}]}, inertia=1e-12))
    assert ("with 1e-12 kg m^2 answers a push at 20 mm from its centre as 2.5e-09 kg would, "
            "where 'heavy' has 2 kg") in found
