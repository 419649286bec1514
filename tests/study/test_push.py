"""The push that moves an object, by search: against its closed form, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.errors import SceneError
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene
from sandbox.study.push import AGREE, BEYOND, FIRST, SLOWER, pushes

MU, N = 0.4, 2.0
MASS = 0.1 + 3 * 0.02
"""Of the disc and all fingertips."""


@pytest.fixture(scope="module")
def disc() -> Mechanism:
    """The disc between three fingertips, with nothing else that pushes it."""
    return expand(load_scene("held_disc", overrides={"parameters.limit": 0}))


def with_centre_off(disc: Mechanism, off: float) -> Mechanism:
    """The same with the origin of the disc's frame ``off`` beside its middle [m]."""
    bodies = [body if body.name != "disc" else body.model_copy(update={
        "at": (-off, 0.0),
        "shapes": tuple(shape.model_copy(update={"at": (off, 0.0)}) for shape in body.shapes)})
        for body in disc.bodies]
    return disc.model_copy(update={"bodies": tuple(bodies)})


@pytest.mark.parametrize("off", [0.0, 0.008])
def test_a_disc_between_three_fingertips(disc: Mechanism, off: float) -> None:
    """It holds up to 3/2 mu N / max |cos|, then goes as F = r t drives all that moves at most.

    r t^3 / 6 m is the limit then, and it lets go no sooner than the bound says. The slower push,
    whose r counts, is there because the first one tells some 5 % more.
    It is pushed at its centre of mass, wherever its frame has its origin.
    """
    disc = with_centre_off(disc, off)
    seen: list[float] = []
    found = pushes(disc, "disc", at=0.15, over=1.0, count=4, limit=1e-5, progress=seen.append)
    closed = 1.5 * MU * N / np.array([1.0, math.cos(math.pi / 6)] * 2)
    np.testing.assert_allclose(found.bound, closed, rtol=1e-9)
    np.testing.assert_allclose(found.most, BEYOND * closed, rtol=1e-9)
    rate = FIRST * closed / SLOWER / 1.0
    assert found.settled.all()
    late = rate * ((6 * MASS * found.limit / rate) ** (1 / 3) + 2e-3)
    assert (found.found > closed).all()
    assert (found.found < closed + late).all()
    assert len(found.around) == len(found.bounds) >= 120
    np.testing.assert_allclose(found.bounds.max(), closed.max(), rtol=1e-9)
    assert seen == [0.0, 0.25, 0.5, 0.75]


def test_what_does_not_move_up_to_the_most(disc: Mechanism) -> None:
    found = pushes(disc, "disc", at=0.15, over=0.2, count=1, limit=0.5, beyond=1.25)
    assert np.isinf(found.found).all()


def test_without_a_bound_it_is_pushed_with_twice_what_presses() -> None:
    """Two floors with a gap between them carry it, half of its weight each."""
    floors = [{"name": f"floor{side + 1}", "motion": "fixed",
               "shapes": [{"type": "box", "size": (0.4, 0.1), "at": (0.21 * side, -0.05)}]}
              for side in (-1, 1)]
    box = {"name": "box", "mass": 0.2, "at": (0, 0.02),
           "shapes": [{"type": "box", "size": (0.06, 0.04)}]}
    mechanism = expand(load_scene({
        "gravity": [0, -9.81], "bodies": [*floors, box],
        "drives": [{"type": "force", "name": "study_push", "body": "box", "direction": [1, 0],
                    "value": 0}]}))
    found = pushes(mechanism, "box", at=0.05, over=0.3, count=4)
    weight = 0.2 * 9.81
    assert found.limit == pytest.approx(0.01 * math.hypot(0.03, 0.02))
    assert np.isinf(found.bound[3])
    assert np.isinf(found.found[3])
    assert found.most[3] == pytest.approx(2 * weight, rel=1e-6)
    np.testing.assert_allclose(found.bound[:3], [weight / 2, weight, weight / 2], rtol=1e-6)
    assert (found.found[:3] > found.bound[:3]).all()


def test_what_nothing_holds_goes_at_any_push_and_that_is_told() -> None:
    """On a smooth floor F = r t makes r t^3 / 6 m: the force tends to 0 with r, as r^(2/3).

    No two paces tell the same, and the slowest tells the least.
    """
    found = pushes(on_ice(), "box", at=0.05, over=0.3, count=2, limit=1e-6)
    np.testing.assert_array_equal(found.bound, 0.0)
    assert not found.settled.any()
    first = 2 * 0.2 * 9.81 / BEYOND / 0.3
    assert (found.found < first * (6 * 0.2 * 1e-6 / first) ** (1 / 3) / SLOWER).all()


def test_the_push_that_a_scene_has_stays_as_it_is(disc: Mechanism) -> None:
    """It would begin at 0.2 s and move the disc at 0.7 s; held at 0 it leaves nothing to find."""
    shipped = expand(load_scene("held_disc"))
    apart = pushes(shipped, "disc", at=0.15, over=0.4, count=2)
    plain = pushes(disc, "disc", at=0.15, over=0.4, count=2)
    ((name, since, force),) = apart.own.stayed
    assert (name, since, force) == ("pushed", pytest.approx(0.2, abs=2e-3), 0.0)
    np.testing.assert_array_equal(apart.found, plain.found)
    assert plain.own.stayed == ()


def on_ice(**body: object) -> Mechanism:
    return expand(load_scene({
        "gravity": [0, -9.81], "run": {"step": 5e-4}, "materials": {"ice": {"friction": 0}},
        "bodies": [{"name": "floor", "motion": "fixed", "material": "ice",
                    "shapes": [{"type": "box", "size": (9, 0.1), "at": (0, -0.05)}]},
                   {"name": "box", "mass": 0.2, "at": (0, 0.02), "material": "ice", **body,
                    "shapes": [{"type": "box", "size": (0.06, 0.04)}]}]}))


def test_its_own_way_is_not_taken_for_that_of_the_push() -> None:
    """A box that slides with v on ice answers to a push as one at rest (Galilei); v t is told."""
    v = 0.1
    slides = pushes(on_ice(velocity=(v, 0)), "box", at=0.05, over=0.3, count=2, limit=1e-5)
    rests = pushes(on_ice(), "box", at=0.05, over=0.3, count=2, limit=1e-5)
    np.testing.assert_allclose(slides.found, rests.found, rtol=1e-9)
    assert slides.own.way == pytest.approx(v * slides.own.lasts, rel=1e-9)
    assert slides.own.way > 100 * slides.limit


def test_an_elastic_grip_gives_by_its_stiffness() -> None:
    """A block between two jaws on springs k, that stick: 2 k times the limit, whatever presses.

    Both tell it within AGREE, as two paces that differ by SLOWER do; what is left of a lag that
    goes with the pace is AGREE / (SLOWER - 1).
    """
    k, limit = 2000.0, 2e-4
    jaw = {"mass": 0.02, "role": "phalanx", "material": "m",
           "shapes": [{"type": "box", "size": (0.02, 0.04)}]}
    sides = (("left", -1), ("right", 1))
    mechanism = expand(load_scene({
        "run": {"step": 5e-4}, "materials": {"m": {"friction": 0.8}},
        "bodies": [{"name": "frame", "motion": "fixed"},
                   {"name": "block", "mass": 0.12, "role": "object", "material": "m",
                    "shapes": [{"type": "box", "size": (0.04, 0.04)}]},
                   *({"name": name, "at": (way * 0.03, 0.0), **jaw} for name, way in sides)],
        "joints": [{"type": "slot", "name": f"{name}_guide", "a": "frame", "b": name,
                    "on_b": (0, 0), "start": (-0.2, 0.0), "end": (0.2, 0.0), "turns": False}
                   for name, _ in sides],
        "springs": [{"type": "linear", "name": f"{name}_spring", "a": "frame", "b": name,
                     "on_a": (way * 0.2, 0.0), "on_b": (0, 0), "stiffness": k, "damping": 20,
                     "rest_length": 0.17 + 0.015} for name, way in sides]}))
    found = pushes(mechanism, "block", at=0.2, over=0.5, count=2, limit=limit)
    np.testing.assert_array_equal(found.bound, 0.0)
    assert found.settled.all()
    np.testing.assert_allclose(found.found, 2 * k * limit, rtol=AGREE / (SLOWER - 1) + 2e-3)


def test_where_several_normals_hide_the_bound_they_are_named() -> None:
    """A box in a corner, pressed into it with P: one body of two shapes, then a body for each.

    Of the one the sum of both forces is all that is recorded. Of two the box goes out at P along
    the floor: their friction is 0.
    """
    P = 1.5
    floor = {"type": "box", "size": (0.4, 0.1), "at": (0, -0.05)}
    wall = {"type": "box", "size": (0.1, 0.2), "at": (-0.08, 0.1)}
    fixed = {"motion": "fixed", "material": "ice"}
    box = {"name": "box", "mass": 0.2, "at": (0, 0.02), "material": "ice",
           "shapes": [{"type": "box", "size": (0.06, 0.04)}]}

    def bounds(*corner: dict[str, object]) -> tuple[float, tuple[tuple[str, str], ...]]:
        found = pushes(expand(load_scene({
            "gravity": [0, -9.81], "materials": {"ice": {"friction": 0}},
            "bodies": [*corner, box],
            "drives": [{"type": "force", "name": "press", "body": "box", "direction": [-1, 0],
                        "value": P}]})), "box", at=0.05, over=0.1, count=1)
        return float(found.bound[0]), found.blurred

    bound, names = bounds({"name": "corner", **fixed, "shapes": [floor, wall]})
    assert np.isinf(bound)
    assert [set(pair) for pair in names] == [{"corner", "box"}]
    bound, names = bounds({"name": "floor", **fixed, "shapes": [floor]},
                          {"name": "wall", **fixed, "shapes": [wall]})
    assert bound == pytest.approx(P, rel=1e-6)
    assert names == ()


@pytest.mark.parametrize(("body", "at", "told"), [
    ("disk", 0.1, "'disk' is no body"),
    ("frame", 0.1, "'frame' does not move freely"),
    ("lone", 0.1, "nothing touches 'lone' at t = 0.099"),
])
def test_what_cannot_be_pushed(disc: Mechanism, body: str, at: float, told: str) -> None:
    lone = disc.bodies[1].model_copy(update={"name": "lone", "at": (1.0, 1.0)})
    mechanism = disc.model_copy(update={"bodies": (*disc.bodies, lone)})
    with pytest.raises(SceneError) as refused:
        pushes(mechanism, body, at=at)
    assert told in str(refused.value)
    if body == "disk":
        assert refused.value.problems[0].hint == "'disc'"
