"""Work of springs against what they hold, and what of it may be left over."""

from __future__ import annotations

import pytest

from tests.audit.still import H, block, figures, machine, still, turns

ALLOWED = 1e-3 * (H / 5e-4) ** 2
"""Of what was turned over: 0.1 % at h = 0.5 ms, growing with h^2."""


def sprung(rest=0.45, touches=None, **spring):
    band = {"type": "linear", "name": "band", "a": "wall", "b": "one", "stiffness": 50.0}
    if rest is not None:
        band["rest_length"] = rest
    return machine(block("one", at=(0.3, 0.4)), block("two"), springs=[{**band, **spring}], **{
        "joints": [{"type": "pin", "name": "pin", "a": "wall", "b": "two", "on_b": (0, 0)}],
        "drives": [{"type": "torque", "name": "motor", "joint": "pin", "value": 0}]})


@pytest.mark.parametrize(("rest", "slack"), [(0.45, 0.45), (None, 0.5)])
def test_a_springs_work_is_what_it_no_longer_holds(rest, slack):
    """k x^2 / 2 from 0.5 m at t = 0 to 0.6 m, in energy of which 2 J are turned over."""
    given = 25.0 * ((0.5 - slack) ** 2 - (0.6 - slack) ** 2)

    def make(error):
        def change(a):
            a["spring_length"][:] = 0.6
            a["spring_work"][:, 0] = given
            a["spring_work"][2, 0] += 2.0 * error
            a["drive_work"][3, 0] = 2.0 - abs(given)
        return still(sprung(rest), change)
    turns("energy.springs", ALLOWED, make)


def test_a_rotary_springs_work_is_that_of_its_hinges_angle_in_its_sense():
    """b turned by 0.7 against a's 0.2, counted clockwise from 0.1: -0.6 at t = 0; rest at 0.25."""
    machine_ = machine(
        block("one", angle=0.2), block("two", angle=0.7),
        joints=[{"type": "pin", "name": "pin", "a": "one", "b": "two", "on_b": (0, 0),
                 "positive": "clockwise", "zero": 0.1}],
        springs=[{"type": "rotary", "name": "coil", "joint": "pin", "stiffness": 8.0,
                  "rest_angle": 0.25, "damping": 1.0}],
        drives=[{"type": "torque", "name": "motor", "joint": "pin", "value": 0}])
    given = 4.0 * (0.85**2 - 0.05**2)

    def make(error):
        def change(a):
            a["spring_length"][:] = 0.3
            a["spring_work"][:, 0] = given
            a["spring_work"][2, 0] -= 5.0 * error
            a["drive_work"][3, 0] = 5.0 - given
        return still(machine_, change)
    turns("energy.springs", ALLOWED, make)


@pytest.mark.parametrize(("n", "every", "steps"), [(4, 2, 6), (2, 2, 4), (1, 1, 1)])
def test_springs_may_differ_by_their_force_times_what_overlaps_moved(n, every, steps):
    """Shifts of 5e-6 m in samples 0 and 1, and what is left of the last in 2, at 0.4 N at most."""
    touches = [(i, 1, 0, (0.0, 0.0), (0.0, 1.0), (0.0, 0.0), -6e-6) for i in range(min(n, 2))]

    def make(error):
        def change(a):
            a["spring_length"][:] = 0.45
            a["spring_force"][0, 0] = -0.4
            a["spring_force"][1:, 0] = 0.3
            a["spring_work"][:, 0] = 25.0 * 0.05**2
            a["spring_work"][-1, 0] -= 2.0 * error
            a["drive_work"][:, 0] = 2.0 - 25.0 * 0.05**2 * (n > 1)
            a["drive_work"][-1, 0] -= (25.0 * 0.05**2 - 2.0 * error) * (n == 1)
        return still(sprung(), change, n=n, every=every, touches=touches)
    turns("energy.springs", ALLOWED + 0.4 * steps * 5e-6 / 2.0, make)


def test_springs_with_dampers_or_of_many_stiffnesses_have_no_such_energy():
    for spring, word in (({"damping": 0.5}, "no spring is without a damper"),
                         ({}, "left out: band")):
        machine_ = sprung(**spring)
        content = machine_.model_dump(by_alias=True)
        if not spring:
            content["drives"] = [*content["drives"], {"type": "stiffness", "name": "k",
                                                      "spring": "band"}]
        run = still(type(machine_).model_validate(content), lambda a: a["spring_work"].__iadd__(9))
        figure = figures(run)["energy.springs"]
        assert figure.verdict == "not computed"
        assert word in figure.why
