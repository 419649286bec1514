"""What touch is held to: overlap, friction, slack cords."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.audit.contacts import used_friction
from sandbox.audit.evidence import Evidence
from tests.audit.still import block, figures, machine, still, turns

SLOP = 2e-6
DISC = {"type": "circle", "radius": 0.02, "at": (0.03, 0.04)}
BAR = {"type": "capsule", "start": (0.0, 0.0), "end": (0.08, 0.06), "radius": 0.01}
BOX = {"type": "box", "size": (0.06, 0.08), "at": (0.1, 0.0)}
WEDGE = {"type": "polygon", "points": [(0.0, 0.0), (0.1, 0.0), (0.0, 0.2)]}


def pair(*shapes, **more):
    body = {**block("one", centre=(0.0, 0.0)), "shapes": list(shapes)}
    return machine(body, {**block("two", centre=(0.0, 0.0)), "shapes": [DISC]},
                   block("three"), run={"slop": SLOP}, **more)


def touch(sample, gap, *, force=(0.0, 0.0), normal=(0.0, 1.0), who=(1, 2)):
    return (sample, *who, force, normal, (0.0, 0.0), gap)


# -- friction --------------------------------------------------------------------------------


def rough(mu):
    machine_ = pair(materials={"m": {"friction": mu}})
    content = machine_.model_dump(by_alias=True)
    for body in content["bodies"]:
        body["material"] = "m"
    return type(machine_).model_validate(content)


def test_a_contact_may_use_its_friction_limit_and_a_millionth_more():
    """5 N along (0.6, 0.8), mu 0.4: 2 N across at most; in whichever sense."""
    normal, across = np.array([0.6, 0.8]), np.array([-0.8, 0.6])
    for side in (1.0, -1.0):
        turns("contact.friction", 1 + 1e-6, lambda e, side=side: still(rough(0.4), touches=[
            touch(0, 0.0, force=3 * normal, normal=normal),
            touch(1, 0.0, force=5 * normal + side * 2 * e * across, normal=normal)]), by=1e-7)


def test_each_contact_has_the_friction_of_its_own_pair():
    """0.4 on one and two, 0.1 on two and three, 0.2 on three and one: the limits of 5 N each."""
    machine_ = pair(contacts=[{"between": between, "friction": mu} for between, mu in (
        (("one", "two"), 0.4), (("three", "two"), 0.1), (("one", "three"), 0.2))])
    used = used_friction(Evidence(still(machine_, touches=[
        touch(1, 0.0, force=(0.25, 5.0), who=who) for who in ((1, 2), (2, 3), (3, 1), (2, 1))])))
    assert used == pytest.approx([0.125, 0.5, 0.25, 0.125])
    assert used_friction(Evidence(still(machine_))).shape == (0,)


def test_a_limit_of_a_micronewton_is_none():
    figure = figures(still(rough(1.0), touches=[touch(1, 0.0, force=(0.9e-6, 1e-6))]))
    assert figure["contact.friction"].value == 0.0
    figure = figures(still(rough(1.0), touches=[touch(1, 0.0, force=(0.9e-6, 1.2e-6))]))
    assert figure["contact.friction"].value == pytest.approx(0.75)


def test_without_friction_any_force_across_is_beyond_the_limit_by_its_share():
    """1 + t / n: 5 N and 5e-6 N across."""
    turns("contact.friction", 1 + 1e-6, lambda e: still(rough(0.0), touches=[
        touch(1, 0.0, force=(5 * (e - 1), 5.0))]), by=1e-8)
    quiet = figures(still(rough(0.0), touches=[touch(1, 0.0, force=(0.9e-6, 5.0))]))
    assert quiet["contact.friction"].value == 0.0  # below 1e-6 N nothing is touched


def test_a_force_across_of_a_micronewton_is_none():
    """To the bit: 1e-6 N is what still counts as nothing, across as along the normal."""
    used = used_friction(Evidence(still(rough(0.0), touches=[
        touch(1, 0.0, force=(across, 5.0)) for across in (1e-6, np.nextafter(1e-6, 1.0))])))
    assert used[0] == 0.0
    assert used[1] > 1.0


def test_a_push_of_next_to_nothing_is_not_divided_by():
    """2e-6 N across of 1e-9 N: against 1e-6 N, so 1 + (2e-6 - 0.4e-9) / 1e-6."""
    figure = figures(still(rough(0.4), touches=[touch(1, 0.0, force=(2e-6, 1e-9))]))
    assert figure["contact.friction"].value == pytest.approx(1 + 2 - 0.4e-3)


def test_which_contacts_stick_or_slip_at_the_end():
    """Within a thousandth of the limit one counts as slipping; one without push is left out."""
    def told(*forces, mu=0.4):
        touches = [touch(2, 0.0, force=(1.0, 9.0)),
                   *(touch(3, 0.0, force=force) for force in forces)]
        return figures(still(rough(mu), touches=touches))["contact.friction"].why
    assert "at the end: one/two slips" in told((0.99901 * 2.0, 5.0))
    assert "at the end: one/two sticks, 0 % from the limit" in told((0.99899 * 2.0, 5.0))
    assert "one/two sticks" in told((0.999, 4.0), mu=0.25)  # to the bit
    assert "one/two sticks, 75 % from the limit" in told((0.5, 5.0))
    assert "one/two frictionless" in told((0.0, 5.0), mu=0.0)
    assert "nothing touches at the end" in told((0.0, 1e-6))
    assert "one/two" in told((0.0, 1.01e-6))
    assert "slips; one/two sticks" in told((2.0, 5.0), (0.5, 5.0))


def test_several_points_of_bodies_of_several_shapes_have_no_one_limit():
    """Sums over normals that differ: of two shapes against one, and where the number is unknown."""
    def told(merged, *shapes):
        machine_ = machine({**block("one", centre=(0.0, 0.0)), "shapes": list(shapes)},
                           {**block("two", centre=(0.0, 0.0)), "shapes": [DISC]})
        run = still(machine_, lambda a: a["contact_merged"].__setitem__(slice(None), merged),
                    touches=[touch(3, 0.0, force=(5.0, 1.0)), touch(3, 0.0, force=(0.0, 1.0))])
        return figures(run)["contact.friction"]
    assert told(1, BAR, BOX).value == told(2, BOX).value == told(np.nan, BOX).value > 2
    assert told([2, 1], BAR, BOX).value == 0.0
    assert "one/two has several normals; one/two sticks" in told([2, 1], BAR, BOX).why
    for merged in (2, np.nan):
        assert "a normal of its own" in told(merged, BAR, BOX).why


# -- slack -----------------------------------------------------------------------------------


CORDS = [{"name": name, "guides": [{"body": "wall"}, {"body": "one", "at": (0.1, 0)}]}
         for name in ("cord", "other")]


@pytest.mark.parametrize(("tension", "other", "value", "words"), [
    ([0, 0, 1, 1, 1], [1, 1, 1, 1, 1], 0.0, "no cord hung loose once it had pulled"),
    ([0, 0, 1, 0, 0], [1, 1, 1, 1, 1], 4e-3, "cord for 0.004 s"),
    ([0, 1, 0, 1, 0], [1, 0, 0, 0, 1], 6e-3, "cord for 0.004 s; other for 0.006 s"),
    ([0, 0, 0, 0, 0], [1, 1, 1, 1, 1], math.inf, "cord never pulled"),
    ([1, 1, 1e-9, 1, 1], [1, 1, 1, 1, 1], 2e-3, "cord for 0.002 s"),
    ([1, 1, 1.01e-9, 1, 1], [1, 1, 1, 1, 1], 0.0, "no cord hung loose once it had pulled"),
    ([0, 0, 0, 0, 1], [1, 1, 1, 1, 1], 0.0, "no cord hung loose once it had pulled"),
])
def test_a_tendon_is_slack_that_has_pulled_and_hangs(tension, other, value, words):
    """Samples of two steps, 2 ms; above 1e-9 N a cord pulls."""
    run = still(machine(block("one"), tendons=CORDS), lambda a: a["tendon_tension"].__setitem__(
        slice(None), np.transpose([tension, other])), n=5, every=2)
    figure = figures(run)["tendon.slack"]
    assert figure.value == pytest.approx(value)
    assert figure.verdict == ("look" if value else "pass")
    assert words in figure.why
    assert figure.threshold == 0.0


def test_the_first_four_of_many_slack_tendons_are_told():
    cords = [{**CORDS[0], "name": name} for name in "abcde"]
    run = still(machine(block("one"), tendons=cords), lambda a: a["tendon_tension"].__setitem__(
        0, 1.0), n=2)
    assert figures(run)["tendon.slack"].why == "cords that hung loose: " + "; ".join(
        f"{name} for 0.001 s" for name in "abcd")


def test_a_single_sample_tells_nothing_of_slack():
    run = still(machine(block("one"), tendons=CORDS), n=1)
    assert figures(run)["tendon.slack"].why == "there are too few samples"
