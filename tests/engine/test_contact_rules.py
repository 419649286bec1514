"""Which bodies may touch: contact rules, planes and joints, with few and many categories."""

from __future__ import annotations

from fnmatch import fnmatchcase
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sandbox.engine.simulate import simulate
from sandbox.engine.world import make_filters
from sandbox.model.compile import compile_mechanism
from sandbox.model.pairs import allowed_pairs, friction_of, static_friction_of
from sandbox.scene.mechanism import Mechanism

from .machines import G, disc, fixed, mechanism

PATTERNS = ("*", "a*", "b*", "a1", "b2", "?1", "c*", "nobody")
NAMES = tuple(f"{letter}{i}" for letter in "abc" for i in range(4))


def reference(machine: Mechanism) -> np.ndarray:
    """The rules read one pair at a time."""
    names = [body.name for body in machine.bodies]
    free = [body.motion == "dynamic" for body in machine.bodies]
    allowed = np.zeros((len(names), len(names)), dtype=bool)
    said = [(rule.collide, {n for n in names if fnmatchcase(n, rule.between[0])},
             {n for n in names if fnmatchcase(n, rule.between[1])}) for rule in machine.contacts]
    joined = {frozenset((joint.a, joint.b)) for joint in machine.joints if not joint.collide}
    planes = [{-1, 0, 1} if body.plane == "all" else set(body.plane) for body in machine.bodies]
    for i, a in enumerate(names):
        for j, b in enumerate(names):
            verdict = True
            for collide, p, q in said:
                if (a in p and b in q) or (b in p and a in q):
                    verdict = collide
            allowed[i, j] = (verdict and i != j and (free[i] or free[j])
                             and bool(planes[i] & planes[j])
                             and frozenset((a, b)) not in joined)
    return allowed


rule = st.builds(lambda a, b, c: {"between": (a, b), "collide": c},
                 st.sampled_from(PATTERNS), st.sampled_from(PATTERNS), st.booleans())
pair = st.tuples(st.sampled_from(NAMES), st.sampled_from(NAMES), st.booleans()).filter(
    lambda p: p[0] != p[1])
planes = st.dictionaries(
    st.sampled_from(NAMES), st.sampled_from([-1, 1, [0, 1], [-1, 1], "all"]))


@settings(deadline=None, max_examples=60)
@given(st.lists(rule, max_size=6), st.lists(pair, max_size=5), st.sets(st.sampled_from(NAMES)),
       planes)
def test_allowed_pairs(rules: Any, pairs: Any, resting: Any, planes: Any) -> None:
    machine = mechanism(
        bodies=[disc(n, 0.01, (0.0, 0.0), plane=planes.get(n, 0),
                     **({"motion": "fixed"} if n in resting else {}))
                for n in NAMES],
        joints=[{"type": "rope", "name": f"j{i}", "a": a, "b": b, "longest": 1.0, "collide": c}
                for i, (a, b, c) in enumerate(pairs)],
        contacts=rules)
    np.testing.assert_array_equal(
        allowed_pairs(compile_mechanism(machine)), reference(machine))


def test_friction_of_a_pair_is_that_of_the_last_rule_or_of_materials() -> None:
    """The engine's tables, and what reads one pair at a time."""
    machine = mechanism(
        bodies=[disc(n, 0.01, (0.0, 0.0), material=m)
                for n, m in (("a", "x"), ("b", "y"), ("c", "y"))],
        materials={"x": {"friction": 0.2, "static": 2.0}, "y": {"friction": 0.8}},
        contacts=[{"between": ("b", "c"), "friction": 0.3, "static": 1.6},
                  {"between": ("c", "*"), "static": 1.1}])
    filters = make_filters(compile_mechanism(machine))
    for i, j, slides, holds in ((0, 1, 0.4, 2.0**0.5), (1, 2, 0.3, 1.1), (0, 2, 0.4, 1.1)):
        assert filters.friction[i, j] == pytest.approx(slides)
        assert filters.static[i, j] == pytest.approx(holds)
        assert friction_of(machine, i, j) == pytest.approx(slides)
        assert static_friction_of(machine, i, j) == pytest.approx(slides * holds)


def crossing(count: int, duration: float = 0.1) -> Mechanism:
    """2 ``count`` discs fall on their own plates; each passes through its own partner."""
    bodies, rules = [fixed("floor", shapes=[{"type": "box", "size": (9.0, 0.02)}])], []
    for i in range(count):
        x = 0.1 * i - 2
        bodies += [disc(f"a{i}", 0.01, (x, 0.0205)), disc(f"b{i}", 0.01, (x, 0.022))]
        rules.append({"between": (f"a{i}", f"b{i}"), "collide": False})
    return mechanism(duration=duration, gravity=(0.0, -G), bodies=bodies, contacts=rules)


@pytest.mark.parametrize("count", [3, 40])
def test_refused_pairs_pass_through_each_other(count: int) -> None:
    """Discs that overlap and may not touch both come to lie on the floor, others do not.

    With 40 such pairs there are 81 kinds of body, more than pymunk's 32 categories: all are then
    of one, and the table of pairs tells them apart. On the floor a disc's centre is 20 mm up, less
    m g / k where so many contacts are compliant, with h^2 k / m = 40.
    """
    run = simulate(crossing(count))
    heights = [run[f"{name}{i}.y"][-1] for i in range(count) for name in "ab"]
    depth = G * run.info.step**2 / 40 if count > 30 else 0.0
    np.testing.assert_allclose(heights, 0.02 - depth, atol=1e-9)
    others = np.unique(run.arrays["contact_other"])
    np.testing.assert_array_equal(others, [0])


def test_what_may_touch_does_so_beyond_32_kinds() -> None:
    """Of the same 40 pairs the last may touch after all: its upper disc is pushed off the lower.

    Centres 2 r apart once the overlap of 18.5 mm is undone, at 0.1 m/s.
    """
    machine = crossing(40, duration=0.25)
    run = simulate(machine.model_copy(update={"contacts": machine.contacts[:-1]}))
    apart = [run[f"b39.{q}"][-1] - run[f"a39.{q}"][-1] for q in "xy"]
    assert np.hypot(*apart) == pytest.approx(0.02, abs=1e-6)
    assert run["b38.y"][-1] == pytest.approx(0.02 - G * run.info.step**2 / 40, abs=1e-9)


def test_fixed_bodies_are_apart_for_joints() -> None:
    """A joint to one fixed body must not switch off the contact with another.

    pymunk forbids contact by pairs of *bodies*: were all fixed bodies the space's one static body,
    the disc hung from the wall would fall through the floor.
    """
    machine = mechanism(
        duration=0.2, gravity=(0.0, -G),
        bodies=[fixed("wall"), fixed("floor", shapes=[{"type": "box", "size": (1, 0.02)}]),
                disc("ball", 0.01, (0.0, 0.025))],
        joints=[{"type": "rope", "name": "rope", "a": "wall", "b": "ball", "longest": 1.0}])
    assert simulate(machine)["ball.y"][-1] == pytest.approx(0.02, abs=1e-9)
