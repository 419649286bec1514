"""What touch is held to: overlap, friction, slack cords."""

from __future__ import annotations

import copy
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import sandbox
from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from tests.audit.still import block, figures, machine, still, turns
from tests.engine.machines import G, disc, fixed, mechanism

DISC = {"type": "circle", "radius": 0.02, "at": (0.03, 0.04)}


def pair(**more):
    bodies = [{**block(name, centre=(0.0, 0.0)), "material": "m"} for name in ("one", "two")]
    return machine(bodies[0], {**bodies[1], "shapes": [DISC]}, block("three"), **more)


def touch(sample, gap, *, force=(0.0, 0.0), normal=(0.0, 1.0), who=(1, 2)):
    return (sample, *who, force, normal, (0.0, 0.0), gap)


# -- friction --------------------------------------------------------------------------------


def rough(mu, static=1.0):
    return pair(materials={"m": {"friction": mu, "static": static}})


@pytest.mark.parametrize(("mu", "static"), [(0.4, 1.0), (0.25, 1.6)])
def test_a_contact_may_use_its_friction_limit_and_a_millionth_more(mu, static):
    """5 N along (0.6, 0.8), mu of what holds 0.4: 2 N across at most; in whichever sense."""
    normal, across = np.array([0.6, 0.8]), np.array([-0.8, 0.6])
    for side in (1.0, -1.0):
        turns("contact.friction", 1 + 1e-6, lambda e, side=side: still(rough(mu, static), touches=[
            touch(0, 0.0, force=3 * normal, normal=normal),
            touch(1, 0.0, force=5 * normal + side * 2 * e * across, normal=normal)]), by=1e-7)


def test_without_friction_any_force_across_is_beyond_the_limit_by_its_share():
    """1 + t / n: 5 N and 5e-6 N across."""
    turns("contact.friction", 1 + 1e-6, lambda e: still(rough(0.0), touches=[
        touch(1, 0.0, force=(5 * (e - 1), 5.0))]), by=1e-8)
    quiet = figures(still(rough(0.0), touches=[touch(1, 0.0, force=(0.9e-6, 5.0))]))
    assert quiet["contact.friction"].value == 0.0  # below 1e-6 N nothing is touched


# -- slack -----------------------------------------------------------------------------------


CORDS = [{"name": name, "guides": [{"body": "wall"}, {"body": "one", "at": (0.1, 0)}]}
         for name in ("cord", "other")]


@pytest.mark.parametrize(("tension", "other", "value", "words"), [
    ([0, 0, 1, 1, 1], [1, 1, 1, 1, 1], 0.0, "no tendon was slack after it had pulled"),
    ([0, 1, 0, 1, 0], [1, 0, 0, 0, 1], 6e-3, "cord for 0.004 s; other for 0.006 s"),
    ([0, 0, 0, 0, 0], [1, 1, 1, 1, 1], math.inf, "cord never pulled"),
    ([1, 1, 1e-9, 1, 1], [1, 1, 1, 1, 1], 2e-3, "cord for 0.002 s"),
    ([1, 1, 1.01e-9, 1, 1], [1, 1, 1, 1, 1], 0.0, "no tendon was slack after it had pulled"),
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


# -- laws of contacts and impacts, by runs of another scene --------------------------------------


FLOOR = fixed("floor", material="m", shapes=[{"type": "box", "size": (6.0, 0.1), "at": (0, -0.05)}])


def box(x, y, **more):
    return {"name": "box", "at": (x, y), "mass": 1.0, "material": "m",
            "shapes": [{"type": "box", "size": (0.2, 0.1)}], **more}


def ball(name, x, speed, **more):
    return {**disc(name, 0.03, (x, 0.03)), "velocity": (speed, 0.0), "material": "m", **more}


def scene(*bodies, e=0.0, mu=0.0, static=1.0, **more):
    return {"duration": 0.3, "bodies": list(bodies), **more,
            "materials": {"m": {"friction": mu, "static": static, "restitution": e}}}


SLIDES = scene(FLOOR, box(0.0, 0.05, velocity=(1.0, 0.0)), mu=0.3, gravity=(0.0, -G))
DRAGGED = scene(FLOOR, box(0.0, 0.05), mu=0.3, static=1.6, gravity=(0.0, -G), drives=[
    {"type": "force", "name": "drag", "body": "box", "direction": (1, 0), "value": "=30 * t"}])
TUMBLES = scene(FLOOR, box(0.0, 0.2, angle=0.3, velocity=(3.0, 0.0), angular_velocity=5.0),
                e=0.7, mu=0.2, gravity=(0.0, -G))
MEET = scene(ball("one", 0.0, 2.0), ball("two", 0.2, 0.0), ball("three", 0.5, -1.0), e=0.8)
CRADLE = scene(ball("one", -0.05, 1.0), *(ball(name, 0.06 * i, 0.0) for i, name in enumerate(
    ("two", "three", "four"), start=1)), e=1.0)
SWINGS = scene(
    fixed("wall", material="m", shapes=[{"type": "box", "size": (0.2, 2), "at": (0.13, 0)}]),
    {**ball("bob", 0.0, 0.0), "at": (-0.15, -0.3)}, fixed("frame"), e=0.7, gravity=(0.0, -G),
    duration=0.6,
    joints=[{"type": "pin", "name": "pin", "a": "frame", "b": "bob", "on_a": (0, 0.1)}])
DRIVEN = scene(
    ball("rotor", 0.0, 0.0), {**ball("one", -0.2, 2.0), "at": (-0.2, 0.05)}, fixed("frame"),
    e=1, mu=1, joints=[{"type": "pin", "name": "p", "a": "frame", "b": "rotor", "on_b": (0, 0)}],
    drives=[{"type": "motor", "name": "m", "joint": "p", "value": "=30 * t", "torque": 5}])
FALLS = scene(FLOOR, box(0.0, 0.1), gravity=(0.0, -G))


@cache
def simulated(key, *change):
    """The run of a scene, by its name, with one number of its material changed."""
    changed = copy.deepcopy(globals()[key])
    for name, value in change:
        changed["materials"]["m"][name] = value
    return simulate(mechanism(**changed))


def verdicts(run, content):
    """The verdicts of a run that is said to be of a scene."""
    run = Recording(mechanism(**content), run.arrays, run.info)
    return {name.partition(".")[2]: figure.verdict for name, figure in figures(run).items()
            if name.startswith(("contact.", "impact.", "momentum."))}


@pytest.mark.parametrize("every", [1, 2])
@pytest.mark.parametrize("key", [
    "SLIDES", "DRAGGED", "TUMBLES", "MEET", "CRADLE", "SWINGS", "DRIVEN", "FALLS"])
def test_a_run_of_its_own_scene_passes(key, every):
    run = simulate(mechanism(**{**globals()[key], "run": {"sample_rate": 2000 / every}}))
    assert "look" not in {figure.verdict for figure in figures(run).values()}


@pytest.mark.parametrize("factor", [0.999, 1.001])
@pytest.mark.parametrize(("key", "number", "figure"), [
    ("SLIDES", "friction", "slides"), ("DRAGGED", "friction", "slides"),
    ("TUMBLES", "friction", "slides"), ("TUMBLES", "restitution", "bounces"),
    ("MEET", "restitution", "bounces")])
def test_a_coefficient_too_small_or_too_large_is_noticed(key, number, figure, factor):
    right = globals()[key]["materials"]["m"][number]
    assert verdicts(simulated(key, (number, right * factor)), globals()[key])[figure] == "look"


def test_static_friction_beyond_its_bound_is_noticed():
    assert verdicts(simulated("DRAGGED", ("static", 1.7)), DRAGGED)["slides"] == "look"


@pytest.mark.parametrize(("key", "e", "right"), [
    ("MEET", 0.79, 0.8), ("CRADLE", 0.99, 1.0), ("CRADLE", 0.999, 1.0), ("SWINGS", 0.6, 0.7)])
def test_energy_that_impacts_swallow_is_noticed_in_chains_and_on_joints_too(key, e, right):
    """Of balls in a row the approaches are not recorded, only what all of them took."""
    found = verdicts(simulated(key, ("restitution", e)), globals()[key])
    assert found["swallowed"] == "look"
    assert found["bounces"] == ("not computed" if key == "CRADLE" else "look")
    assert found["force"] == "pass"
    more = verdicts(simulated(key, ("restitution", right)), globals()[key])
    assert more["swallowed"] == "pass"


def test_more_energy_than_restitution_leaves_is_no_loss():
    found = verdicts(simulated("MEET", ("restitution", 0.85)), MEET)
    assert (found["swallowed"], found["bounces"]) == ("pass", "look")


@pytest.mark.parametrize(("key", "change", "verdict"), [
    ("contact_gap", lambda gap: gap + 1e-4, "look"),
    ("contact_gap", lambda gap: gap - 1e-4, "pass"),
    ("contact_force", lambda force: -force, "look")])
def test_a_force_across_a_gap_and_one_that_pulls_are_noticed(key, change, verdict):
    run = simulated("FALLS")
    arrays = {**run.arrays, key: change(run.arrays[key])}
    assert verdicts(Recording(run.mechanism, arrays, run.info), FALLS)["closes"] == verdict


def test_bodies_that_pass_through_each_other_are_noticed():
    """A box falls through a floor that its contact rules leave out."""
    through = {**FALLS, "contacts": [{"between": ["box", "floor"], "collide": False}]}
    found = verdicts(simulate(mechanism(**through)), FALLS)
    assert (found["closes"], found["force"]) == ("look", "pass")


@pytest.mark.parametrize(("mass", "verdict"), [(0.2, "pass"), (0.6, "look")])
def test_a_skin_deeper_than_it_is_thick_is_noticed(mass, verdict):
    """A ball released on a skin sinks by m g / k (1 + exp(-zeta pi / sqrt(1 - zeta^2)))."""
    k, c, thickness = 1000.0, 10.0, 0.004
    run = sandbox.simulate({
        "gravity": [0, -10], "run": {"duration": 0.5},
        "materials": {"gel": {"skin": {"stiffness": k, "damping": c, "thickness": thickness}}},
        "bodies": [
            {"name": "floor", "motion": "fixed",
             "shapes": [{"type": "box", "size": [1, 0.1], "at": [0, -0.05]}]},
            {"name": "ball", "at": [0, 0.02], "mass": mass, "material": "gel",
             "shapes": [{"type": "circle", "radius": 0.02}]}]})
    zeta = c / (2 * math.sqrt(k * mass))
    overshoot = math.exp(-zeta * math.pi / math.sqrt(1 - zeta**2))
    depth = next(each for each in audit(run) if each.name == "skin.depth")
    assert depth.verdict == verdict
    if verdict == "pass":  # h^2 w^2 / 24 of the period, and a sample beside the turning point
        assert depth.value == pytest.approx(mass * 10 / k * (1 + overshoot) / thickness, rel=1e-4)


def test_a_step_that_was_not_solved_is_noticed():
    run = simulate(mechanism(bodies=[
        fixed("floor", shapes=[{"type": "box", "size": (1, 0.02), "at": (0, -0.01)}]),
        disc("ball", 0.02, (0, 0.02))], gravity=(0.0, -G), duration=0.05))
    assert figures(run)["contact.residual"].verdict == "pass"
    solver = {**run.info.contact_solver, "residual": 2e-6}
    off = Recording(run.mechanism, run.arrays, replace(run.info, contact_solver=solver))
    assert figures(off)["contact.residual"].verdict == "look"
