"""What reactions and momenta are held to: the largest force or moment there, and shares of it."""

from __future__ import annotations

import pytest

from tests.audit.still import block, figures, machine, still, turns

G = 9.81
WEIGHT = 0.2 * G
EXACT, H = 1e-9, 1e-3
STOOD, STOOD_TURNING = 1e-11, 1e-10
"""What bodies that are let stand may lose of their velocities [m/s, rad/s]."""


def hung(*drives, gravity=(0.0, -G), **more):
    """A body of 0.2 kg, its centre of mass 0.3 m below its hinge."""
    return machine(block("one", centre=(0.0, -0.3)), gravity=gravity, drives=list(drives),
                   joints=[{"type": "pin", "name": "pin", "a": "wall", "b": "one",
                            "on_b": (0, 0)}], **more)


def carried(force, size):
    """A recorded force of the hinge, its recorded size, and nothing that moves."""
    def change(a):
        a["joint_force"][:, 0], a["joint_reaction"][:, 0] = force, size
    return change


def test_a_size_is_that_of_its_components_to_rounding_of_the_largest():
    """3 and 4 N make 5 N; the largest of the joint's in the run is 10 N."""
    def make(error):
        def change(a):
            carried([3.0, 4.0], 5.0)(a)
            a["joint_force"][0, 0], a["joint_reaction"][0, 0] = [0.0, -10.0], 10.0
            a["joint_reaction"][2, 0] += 10.0 * error
        return still(hung(), change)
    turns("reaction.size", 1e-12, make, by=1e-2)


def beam(*joints):
    return machine(block("beam"), block("two"), joints=[
        {"type": kind, "name": f"end{i}", "a": "wall", "b": "beam", "on_b": (x, 0)}
        for i, (kind, x) in enumerate(joints)])


@pytest.mark.parametrize(("joints", "shared"), [
    ([("weld", -0.1), ("weld", 0.1)], "'end0', 'end1'"), ([("weld", 0.1)], "")])
def test_joints_that_share_a_load_are_named(joints, shared):
    figure = figures(still(beam(*joints)))["reaction.shared"]
    count = shared.count("end")
    assert (figure.value, figure.verdict) == (count, "look" if count else "pass")
    assert figure.why.endswith(f": {shared.replace(chr(39), '').replace(', ', '; ') or 'none'}")


def test_joints_that_share_in_a_dead_centre_only_are_not_told():
    """A bar on a pin and a rod, all in line, which pull at each other as long as they are."""
    machine_ = machine(
        block("bar", at=(0.0, 0.0), angle=0.5),
        joints=[{"type": "pin", "name": "pin", "a": "wall", "b": "bar", "on_b": (0, 0)},
                {"type": "rod", "name": "rod", "a": "wall", "b": "bar", "on_a": (1.0, 0.0),
                 "on_b": (0.3, 0.0)}])

    def turned(*angles):
        def change(a):
            a["body_pose"][:, 1, 2] = angles
        return figures(still(machine_, change))["reaction.shared"]
    assert turned(0.0, 0.0, 0.0, 0.0).value == 2
    assert turned(0.0, 0.2, 0.4, 0.6).value == 0


# -- momentum --------------------------------------------------------------------------------


def moving(ax=0.0, ay=0.0, alpha=0.0, **arrays):
    def change(a):
        a["body_acceleration"][:, 1] = [ax, ay, alpha]
        for key, value in arrays.items():
            a[key][:] = value
    return change


def free(*drives, gravity=(0.0, -G), **more):
    return machine(block("one", centre=(0.0, -0.3)), gravity=gravity, drives=list(drives), **more)


def allowed(scale, mass=0.2, still=STOOD):
    """Of the largest load, what is left where bodies are let stand."""
    return EXACT + mass * still / H / scale


def test_mass_times_acceleration_is_the_force_to_1e_9_of_the_largest():
    """Of a body that falls: by a share e less than it should, along and across."""
    most = allowed(WEIGHT)
    turns("momentum.force", most, lambda e: still(free(), moving(0, -G * (1 - e))), by=1e-3)
    turns("momentum.force", most, lambda e: still(free(), moving(G * e * 0.6, -G * (1 - e * 0.8))),
          by=1e-3)


def test_what_a_joint_carries_is_among_the_loads():
    """The weight hangs on its hinge; a share e less than that is left over."""
    turns("momentum.force", allowed(WEIGHT), lambda e: still(
        hung(), carried([0.0, WEIGHT * (1 - e)], WEIGHT)), by=1e-3)


LEVER = {"type": "force", "name": "lever", "body": "one", "at": (0.06, -0.3), "direction": (0, 1),
         "value": 1}
"""At an arm of 60 mm from the centre of mass."""


def test_inertia_times_its_acceleration_is_the_moment_to_1e_9_of_the_largest():
    full = 2.0 * 0.06 / 3e-4
    most = allowed(2.0 * 0.06, 3e-4, STOOD_TURNING)
    turns("momentum.moment", most, lambda e: still(
        free(LEVER, gravity=(0, 0)), moving(0, 10.0, full * (1 - e), drive_value=2.0)), by=1e-3)
    both = [{**LEVER, "name": "other", "at": (-0.06, -0.3)}, LEVER]
    turns("momentum.moment", most, lambda e: still(
        free(*both, gravity=(0, 0)), moving(0, 20.0, full * e, drive_value=2.0)), by=1e-3)
