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


def pair(*shapes, **more):
    body = {**block("one", centre=(0.0, 0.0)), "shapes": list(shapes)}
    return machine(body, {**block("two", centre=(0.0, 0.0)), "shapes": [DISC]},
                   block("three"), run={"slop": SLOP}, **more)


def touch(sample, gap, *, force=(0.0, 0.0), normal=(0.0, 1.0), who=(1, 2)):
    return (sample, *who, force, normal, (0.0, 0.0), gap)


# -- friction --------------------------------------------------------------------------------


def rough(mu, static=1.0):
    machine_ = pair(materials={"m": {"friction": mu, "static": static}})
    content = machine_.model_dump(by_alias=True)
    for body in content["bodies"]:
        body["material"] = "m"
    return type(machine_).model_validate(content)


@pytest.mark.parametrize(("mu", "static"), [(0.4, 1.0), (0.25, 1.6)])
def test_a_contact_may_use_its_friction_limit_and_a_millionth_more(mu, static):
    """5 N along (0.6, 0.8), mu of what holds 0.4: 2 N across at most; in whichever sense."""
    normal, across = np.array([0.6, 0.8]), np.array([-0.8, 0.6])
    for side in (1.0, -1.0):
        turns("contact.friction", 1 + 1e-6, lambda e, side=side: still(rough(mu, static), touches=[
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


def test_without_friction_any_force_across_is_beyond_the_limit_by_its_share():
    """1 + t / n: 5 N and 5e-6 N across."""
    turns("contact.friction", 1 + 1e-6, lambda e: still(rough(0.0), touches=[
        touch(1, 0.0, force=(5 * (e - 1), 5.0))]), by=1e-8)
    quiet = figures(still(rough(0.0), touches=[touch(1, 0.0, force=(0.9e-6, 5.0))]))
    assert quiet["contact.friction"].value == 0.0  # below 1e-6 N nothing is touched


def test_which_contacts_stick_or_slip_at_the_end():
    """Within a thousandth of the limit one counts as slipping; one without push is left out."""
    def told(*forces, mu=0.4, static=1.0):
        touches = [touch(2, 0.0, force=(1.0, 9.0)),
                   *(touch(3, 0.0, force=force) for force in forces)]
        return figures(still(rough(mu, static), touches=touches))["contact.friction"].why
    assert "at the end: one/two slips" in told((0.99901 * 2.0, 5.0))
    assert "at the end: one/two sticks, 0 % from the limit" in told((0.99899 * 2.0, 5.0))
    assert "one/two sticks" in told((0.999, 4.0), mu=0.25)  # to the bit
    assert "one/two sticks, 75 % from the limit" in told((0.5, 5.0))
    assert "one/two slips" in told((2.0, 5.0), static=1.6)  # that of sliding
    assert "one/two sticks, 6 % from the limit" in told((3.0, 5.0), static=1.6)
    assert "one/two frictionless" in told((0.0, 5.0), mu=0.0)
    assert "nothing touches at the end" in told((0.0, 1e-6))
    assert "one/two" in told((0.0, 1.01e-6))
    assert "slips; one/two sticks" in told((2.0, 5.0), (0.5, 5.0))


# -- slack -----------------------------------------------------------------------------------


CORDS = [{"name": name, "guides": [{"body": "wall"}, {"body": "one", "at": (0.1, 0)}]}
         for name in ("cord", "other")]


@pytest.mark.parametrize(("tension", "other", "value", "words"), [
    ([0, 0, 1, 1, 1], [1, 1, 1, 1, 1], 0.0, "no cord hung loose once it had pulled"),
    ([0, 1, 0, 1, 0], [1, 0, 0, 0, 1], 6e-3, "cord for 0.004 s; other for 0.006 s"),
    ([0, 0, 0, 0, 0], [1, 1, 1, 1, 1], math.inf, "cord never pulled"),
    ([1, 1, 1e-9, 1, 1], [1, 1, 1, 1, 1], 2e-3, "cord for 0.002 s"),
    ([1, 1, 1.01e-9, 1, 1], [1, 1, 1, 1, 1], 0.0, "no cord hung loose once it had pulled"),
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
