"""What reactions and momenta are held to: the largest force or moment there, and shares of it."""

from __future__ import annotations

import pytest

from tests.audit.still import block, figures, machine, still, turns

G = 9.81
WEIGHT = 0.2 * G
SOLVED, EXACT = 1e-6, 1e-9
PUSH = [{"type": "force", "name": name, "body": "one", "direction": (x, 0), "value": 10}
        for name, x in (("push", 1), ("pull", -1))]
"""10 N one way and 10 N the other: nothing in sum, and yet the largest force on the body."""


def hung(*drives, gravity=(0.0, -G), **more):
    """A body of 0.2 kg, its centre of mass 0.3 m below its hinge."""
    return machine(block("one", centre=(0.0, -0.3)), gravity=gravity, drives=list(drives),
                   joints=[{"type": "pin", "name": "pin", "a": "wall", "b": "one",
                            "on_b": (0, 0)}], **more)


def reaction(size, *, force=10.0):
    def change(a):
        a["joint_reaction"][:, 0] = size
        a["drive_value"][:] = force
    return change


def test_a_reaction_may_differ_by_a_millionth_of_the_recorded_one():
    """The weight alone: recorded W / (1 - e), so that it is the larger and differs by e of it."""
    turns("reaction.size", SOLVED, lambda e: still(hung(), reaction(WEIGHT / (1 - e))))


def test_a_reaction_may_differ_by_a_millionth_of_the_largest_load_there():
    turns("reaction.size", SOLVED, lambda e: still(hung(*PUSH), reaction(WEIGHT - 10.0 * e)))


def test_the_largest_load_is_that_of_either_body_of_the_joint():
    bodies = [block("one"), block("two", at=(0.0, -0.1)), block("three")]
    for pair in (("one", "two"), ("two", "one")):
        machine_ = machine(*bodies, drives=PUSH, joints=[
            {"type": "pin", "name": "pin", "a": pair[0], "b": pair[1], "on_b": (0, 0)}])
        turns("reaction.size", SOLVED, lambda e, m=machine_: still(m, reaction(10.0 * e)))


def test_loads_on_what_is_fixed_do_not_make_a_reaction_less_exact():
    """500 N between the wall and another body."""
    machine_ = hung()
    with_other = machine(*(b.model_dump() for b in machine_.bodies[1:]), block("two"),
                         gravity=(0.0, -G), joints=[j.model_dump() for j in machine_.joints])
    touch = [(1, 0, 2, (0.0, 500.0), (0.0, 1.0), (0.0, 0.0), 0.0)]
    turns("reaction.size", SOLVED, lambda e: still(
        with_other, reaction(WEIGHT / (1 - e)), touches=touch))


def test_where_nothing_loads_a_joint_a_piconewton_stands_for_it():
    turns("reaction.size", SOLVED, lambda e: still(
        hung(gravity=(0.0, 0.0)), reaction(1e-12 * e)))


# -- momentum --------------------------------------------------------------------------------


def moving(ax=0.0, ay=0.0, alpha=0.0, **arrays):
    def change(a):
        a["body_acceleration"][:, 1] = [ax, ay, alpha]
        for key, value in arrays.items():
            a[key][:] = value
    return change


def free(*drives, gravity=(0.0, -G), **more):
    return machine(block("one", centre=(0.0, -0.3)), gravity=gravity, drives=list(drives), **more)


def test_mass_times_acceleration_is_the_force_to_1e_9_of_the_largest():
    """Of a body that falls: by a share e less than it should, along and across."""
    turns("momentum.force", EXACT, lambda e: still(free(), moving(0, -G * (1 - e))), by=1e-3)
    turns("momentum.force", EXACT, lambda e: still(free(), moving(G * e * 0.6, -G * (1 - e * 0.8))),
          by=1e-3)


def test_the_largest_force_on_a_body_is_any_one_or_its_own_inertia():
    turns("momentum.force", EXACT, lambda e: still(
        free(*PUSH), moving(0, -G + 50.0 * e, drive_value=10.0)), by=1e-3)
    # m a = 0.2 * 300 N against a weight of 2 N: twice that is what is left over
    run = still(free(gravity=(0, 0)), moving(300.0, 0))
    assert figures(run)["momentum.force"].value == pytest.approx(1.0, rel=1e-12)
    turns("momentum.force", EXACT, lambda e: still(
        free(gravity=(0, 0)), moving(5e-12 * e, 0)), by=1e-3)  # 1e-12 N stands for no force


LEVER = {"type": "force", "name": "lever", "body": "one", "at": (0.06, -0.3), "direction": (0, 1),
         "value": 1}
"""At an arm of 60 mm from the centre of mass."""


def test_inertia_times_its_acceleration_is_the_moment_to_1e_9_of_the_largest():
    full = 2.0 * 0.06 / 3e-4
    turns("momentum.moment", EXACT, lambda e: still(
        free(LEVER, gravity=(0, 0)), moving(0, 10.0, full * (1 - e), drive_value=2.0)), by=1e-3)
    both = [{**LEVER, "name": "other", "at": (-0.06, -0.3)}, LEVER]
    turns("momentum.moment", EXACT, lambda e: still(
        free(*both, gravity=(0, 0)), moving(0, 20.0, full * e, drive_value=2.0)), by=1e-3)


def test_where_no_moment_acts_a_millionth_of_the_force_stands_for_it():
    """1e-6 m of arm: 2 N of weight, so 1e-9 of 2e-6 N m."""
    turns("momentum.moment", EXACT, lambda e: still(
        free(), moving(0, -G, e * WEIGHT * 1e-6 / 3e-4)), by=1e-3)


def test_moments_of_bodies_that_touch_in_two_points_are_left_out_and_told():
    """A box on the wall for one sample of four; another body beside it counts on."""
    machine_ = machine(
        {"name": "one", "mass": 0.2, "shapes": [{"type": "box", "size": (0.1, 0.1)}]},
        block("two"), gravity=(0.0, 0.0))
    touch = [(2, 1, 0, (0.0, 0.0), (0.0, 1.0), (0.0, 0.0), 0.0)]

    def change(a):
        a["body_acceleration"][2, 1, 2] = 1e3
    figure = figures(still(machine_, change, touches=touch))["momentum.moment"]
    assert figure.verdict == "pass"
    assert "2 bodies with their joints' reactions" in figure.why
    assert figure.why.endswith("left out where contacts of two points leave moments open: 1 bodies "
                               "in up to 25 % of samples")
    elsewhere = figures(still(machine_, lambda a: a["body_acceleration"].__setitem__(
        (1, 1, 2), 1e3), touches=touch))["momentum.moment"]
    assert elsewhere.verdict == "look"
    assert "worst: one" in elsewhere.why
    force = figures(still(machine_, lambda a: a["body_acceleration"].__setitem__(
        (2, 1, 0), 1e3), touches=touch))["momentum.force"]
    assert force.verdict == "look"


def test_bodies_of_joints_that_are_not_determined_are_left_out_and_named():
    """A beam welded at both ends: it may do what it likes; what swings beside it may not."""
    welds = [{"type": "weld", "name": f"end{i}", "a": "wall", "b": "beam", "on_b": (x, 0)}
             for i, x in enumerate((-0.1, 0.1))]
    machine_ = machine(block("beam"), block("two"), joints=welds)
    run = still(machine_, lambda a: a["body_acceleration"].__setitem__((1, 1), [9.0, 9.0, 9.0]))
    found = figures(run)
    for name in ("momentum.force", "momentum.moment"):
        assert found[name].verdict == "pass"
        assert "1 bodies" in found[name].why
        assert "left out: beam" in found[name].why
    assert found["reaction.size"].verdict == "not computed"
    assert found["reaction.size"].why.startswith("end0: its ring has more unknown forces")
    alone = figures(still(machine(block("beam"), joints=welds)))["momentum.force"]
    assert (alone.verdict, alone.why) == ("not computed", "left out: beam")
    run = still(machine_, lambda a: a["body_acceleration"].__setitem__((1, 2), [9.0, 0.0, 0.0]))
    assert figures(run)["momentum.force"].verdict == "look"


def test_of_many_that_are_left_out_three_are_named_and_the_others_counted():
    def left_out(count):
        names = [f"beam{i}" for i in range(count)]
        welds = [{"type": "weld", "name": f"{name}{end}", "a": "wall", "b": name, "on_b": (end, 0)}
                 for name in names for end in (0, 1)]
        return figures(still(machine(block("free"), *map(block, names), joints=welds)))
    assert left_out(3)["momentum.force"].why.endswith("; left out: beam0; beam1; beam2")
    found = left_out(5)
    assert found["momentum.force"].why.endswith("; left out: beam0; beam1; beam2 and 2 more")
    assert found["reaction.size"].why.endswith("than equations and 7 more")
    hanging = machine(block("one"), block("two"), joints=[
        {"type": "pin", "name": "pin", "a": "wall", "b": "one", "on_b": (0, 0)},
        *({"type": "weld", "name": f"end{i}", "a": "wall", "b": "two", "on_b": (i, 0)}
          for i in range(2))])
    why = figures(still(hanging))["reaction.size"].why
    assert "1 joints, worst: pin; not determined: end0: its ring has" in why
    one = machine(block("one"), joints=[
        {"type": "pin", "name": "pin", "a": "wall", "b": "one", "on_b": (0, 0)}])
    assert figures(still(one))["reaction.size"].why.endswith("1 joints, worst: pin")


def test_a_reaction_is_compared_in_those_samples_in_which_it_is_determined():
    """A slot with the weight, and a slanted rod on its body: at the groove's end it is open."""
    machine_ = machine(
        block("one", at=(0.1, 0.0)), gravity=(0.0, -G), joints=[
            {"type": "slot", "name": "slot", "a": "wall", "b": "one", "start": (0.0, 0.0),
             "end": (0.2, 0.0)},
            {"type": "rod", "name": "rod", "a": "wall", "b": "one", "on_a": (0.0, 0.3)}])

    def at(place, spin=0.0):
        def change(a):
            a["body_pose"][2, 1, 0] = place
            a["joint_reaction"][:, 0] = WEIGHT
            a["joint_reaction"][2, 0] = 77.0 - 70.0 * bool(spin)
            a["body_acceleration"][2, 1, 2] = spin
        return figures(still(machine_, change))
    assert at(0.2)["reaction.size"].verdict == "pass"
    assert at(0.199)["reaction.size"].verdict == "look"
    assert at(0.2, spin=9.0)["momentum.moment"].verdict == "pass"  # as little is known of momentum
    assert at(0.199, spin=9.0)["momentum.moment"].verdict == "look"
