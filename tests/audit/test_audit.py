"""Every figure of the audit can fail: spoil a recording, and the right one asks for a look."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from sandbox.audit.audit import Figure, audit, figure_data
from sandbox.audit.contacts import friction_of
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.recording.store import summary
from sandbox.samples.outcome import Status
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene
from sandbox.study.reference_fingers import SET_G, SET_G_TABLE
from tests.audit.test_planted import coiled
from tests.engine.machines import G, disc, fixed, mass, mechanism
from tests.recording.sample import CONTACTS, recording
from tests.verification.machines import finger

PALM, PROXIMAL, MIDDLE, DISTAL, DISC = range(5)


@pytest.fixture(scope="module")
def held():
    """A Set G finger that closes on a disc and comes to rest, every step recorded."""
    return simulate(finger(
        SET_G, pull={"ramp": {"to": 3.75, "over": 0.3}}, duration=1.0, step=5e-4,
        disc=SET_G_TABLE[0], groups=[{"name": "finger", "kind": "finger", "bodies": [
            "finger.proximal", "finger.middle", "finger.distal"]}],
        run={"sample_rate": 2000.0}))


@pytest.fixture(scope="module")
def falling():
    """A disc that falls on a rough floor and slides."""
    return simulate(mechanism(
        duration=0.2, gravity=(0.0, -G),
        bodies=[fixed("floor", shapes=[{"type": "box", "size": (2.0, 0.1), "at": (0, -0.05)}]),
                disc("puck", 0.02, (0.0, 0.0205), velocity=(0.5, 0.0))]))


@pytest.fixture(scope="module")
def tree():
    scene = load_scene({"run": {"duration": 0.2}, "bodies": [
        mass("one", 0.02, (0.0, 0.06)), mass("two", 0.02, (0.0, 0.0))],
        "parts": [{"type": "rocker_tree", "name": "tree", "pulls": ["one", "two"]}],
        "drives": [{"type": "pull", "name": "pull", "tendon": "tree", "value": 0.1}]})
    return simulate(expand(scene))


def figures(run):
    return {figure.name: figure for figure in audit(run)}


def spoilt(run, key, change):
    """The recording with one array changed in place."""
    arrays = {name: np.array(array) for name, array in run.arrays.items()}
    change(arrays[key])
    return Recording(run.mechanism, arrays, run.info)


@pytest.fixture(scope="module")
def led():
    """A motor that begins at rest."""
    return simulate(mechanism(
        duration=0.1, bodies=[fixed("wall"), disc("wheel", 0.03, (0.1, 0.0))],
        joints=[{"type": "pin", "name": "axle", "a": "wall", "b": "wheel", "on_a": (0, 0)}],
        drives=[{"type": "motor", "name": "motor", "joint": "axle", "torque": 0.5,
                 "value": "=3 * sin(9 * t)"}]))


@pytest.fixture(scope="module")
def gripped():
    """A weight on a cord that two eyes hold, pulled until it slides."""
    guides = [{"body": "load"}, {"body": "wall", "friction": 0.2},
              {"body": "wall", "at": (-0.1, 0.0), "friction": 0.1}, {"body": "wall", "at": (0, -1)}]
    return simulate(mechanism(
        duration=0.1, gravity=(0.0, -9.81), bodies=[fixed("wall"), mass("load", 0.1, (0.0, -0.5))],
        tendons=[{"name": "cord", "guides": guides, "pretension": 0.981}],
        drives=[{"type": "pull", "name": "pull", "tendon": "cord", "value": "=0.981 + 20 * t"}]))


def pumped():
    """A pump that moves a load through a valve, against a drag."""
    return simulate(mechanism(
        duration=0.05, bodies=[fixed("wall"), disc("load", 0.03, (0.1, 0.0))],
        joints=[{"type": "slot", "name": "rail", "a": "wall", "b": "load", "start": (0, 0),
                 "end": (1, 0)}],
        lines=[{"name": "oil", "chambers": [{"type": "cylinder", "a": "wall", "b": "load",
                                             "area": 1e-4}]}, {"name": "supply", "volume": 1e-6}],
        valves=[{"name": "throttle", "a": "supply", "b": "oil", "resistance": 1e10}],
        loads=[{"type": "drag", "name": "air", "linear": 0.5}],
        drives=[{"type": "flow", "name": "pump", "line": "supply", "value": "=1e-6 * t"}]))


def lifted():
    """A disc that swings on a cord, which a wheel on its way bends."""
    return simulate(mechanism(
        duration=0.3, gravity=(0.0, -9.81), bodies=[
            fixed("wall"), disc("bob", 0.03, (0.1, -0.4))],
        tendons=[{"name": "cord", "guides": [
            {"body": "wall"}, {"body": "wall", "at": (-0.01, -0.2), "radius": 0.01,
                               "side": "right"}, {"body": "bob"}]}]))


def rubbed():
    """A disc that slows down in a groove that rubs."""
    return simulate(mechanism(
        duration=0.05, gravity=(0.0, -9.81),
        bodies=[fixed("wall"), {**disc("block", 0.03, (0.1, 0.0)), "velocity": (0.5, 0.0)}],
        joints=[{"type": "slot", "name": "rail", "a": "wall", "b": "block", "start": (0, 0),
                 "end": (1, 0), "friction_coefficient": 0.3}]))


def broken():
    """A rod that breaks under a growing pull."""
    return simulate(mechanism(
        duration=0.1, bodies=[fixed("wall"), mass("load", 0.1, (0.0, -0.5))],
        joints=[{"type": "rod", "name": "rod", "a": "wall", "b": "load", "breaks_at": 1.0}],
        drives=[{"type": "force", "name": "pull", "body": "load", "direction": (0, -1),
                 "value": "=20 * t"}]))


def served():
    """An arm that a servo turns to its place."""
    return simulate(mechanism(
        duration=0.2, bodies=[fixed("wall"), mass("arm", 0.1, (0.0, 0.0))],
        joints=[{"type": "pin", "name": "hinge", "a": "wall", "b": "arm", "on_b": (0, 0)}],
        drives=[{"type": "servo", "name": "servo", "joint": "hinge", "value": 0.1, "torque": 1.0,
                 "stiffness": 2.0, "damping": 0.05}]))


def test_a_good_run_passes_every_figure_that_it_has(held, falling, tree, led, gripped):
    seen = set()
    for run in (held, falling, tree, coiled(), led, gripped, pumped(), lifted(), rubbed(),
                broken(), served()):
        found = figures(run)
        assert {f.name: f.why for f in found.values() if f.verdict == "look"} == {}
        seen |= {f.name for f in found.values() if f.verdict == "pass"}
    assert seen == set(found)  # each figure was computed in one of them


def scale(index, factor):
    def change(array):
        array[index] *= factor
    return change


def shift(index, by):
    def change(array):
        array[index] += by
    return change


EVERY = slice(None)


@pytest.mark.parametrize("length", [{}, {"length": 0.1}])
def test_a_rod_is_held_to_its_length_at_the_start_from_the_first_sample_on(length):
    run = simulate(mechanism(
        duration=0.02, gravity=(0.0, -G), bodies=[fixed("wall"), mass("bob", 0.5, (0.0, -0.1))],
        joints=[{"type": "rod", "name": "rod", "a": "wall", "b": "bob", **length}]))
    assert figures(run)["joint.drift"].verdict == "pass"
    found = figures(spoilt(run, "body_pose", shift((EVERY, 1, 1), -1e-6)))["joint.drift"]
    assert (found.verdict, found.value) == ("look", pytest.approx(1e-6))


@pytest.mark.parametrize(("key", "change", "looks"), [
    ("tendon_tension", scale(slice(-3, None), 1.01),
     {"momentum.force", "momentum.moment", "tendon.law", "rest.moments", "rest.contacts"}),
    ("tendon_length", shift(EVERY, 2e-6), {"tendon.path", "tendon.shortening"}),
    ("joint_angle", shift((EVERY, 1), 1e-3),
     {"poses", "hinge", "tendon.shortening", "spring.length"}),
    ("body_pose", shift((EVERY, MIDDLE, 0), 1e-5), {"poses", "joint.drift", "momentum.moment"}),
    ("body_pose", shift((EVERY, MIDDLE, 2), 1e-3), {"poses", "joint.drift", "momentum.moment"}),
    ("spring_force", scale((EVERY, 0), 1.01), {"momentum.moment", "spring.law", "rest.moments"}),
    ("joint_reaction", scale((EVERY, 1), 1.0001), {"reaction.size"}),
    ("joint_couple", shift((EVERY, 1), 1e-6), {"momentum.moment"}),
    ("joint_damping", scale((EVERY, 0), 1.01), {"momentum.moment", "damper.law"}),
    ("body_velocity", scale(EVERY, 1.2), {"velocity", "energy.lost"}),
    ("spring_work", scale(EVERY, 1.1), {"work"}),
    ("drive_work", scale(EVERY, 1.0), set()),
    ("tendon_work", scale(EVERY, 0.95), {"work", "energy.created", "energy.lost"}),
    ("joint_damping_work", scale(EVERY, 1.1), {"work", "energy.created", "energy.lost"}),
    ("contact_force", scale(EVERY, 1.01), {"rest.moments", "rest.contacts", "momentum.force"}),
    ("contact_normal", scale(EVERY, -1.0), {"contact.place"}),
    ("tendon_tension", scale(slice(900, 950), 0.0), {"tendon.slack", "tendon.law"}),
    ("body_pose", shift((EVERY, MIDDLE, 2), -2.5), {"stop.overrun", "stop.law"}),
])
def test_a_spoilt_recording_asks_for_a_look(held, key, change, looks):
    found = figures(spoilt(held, key, change))
    assert looks <= {f.name for f in found.values() if f.verdict == "look"}


def test_a_force_beyond_friction_asks_for_a_look(falling):
    run = spoilt(falling, "contact_force", scale((EVERY, 0), 1.1))
    assert figures(falling)["contact.friction"].value == pytest.approx(1.0)  # it slides
    assert figures(run)["contact.friction"].verdict == "look"


def test_a_free_body_of_another_mass_asks_for_a_look(falling):
    run = spoilt(falling, "body_mass", scale(1, 1.01))
    assert figures(run)["momentum.force"].verdict == "look"


@pytest.mark.parametrize("share", [1e-6, 3e-9])
def test_friction_of_a_guide_beyond_eulers_bound_asks_for_a_look(gripped, share):
    """By a share of the tension: the solve itself leaves 1e-10 of those on both sides."""
    assert figures(gripped)["tendon.grip"].value < 2.1e-10
    tension, friction = gripped["cord.tension_1"][-1], gripped.arrays["guide_friction"][-1, 0]
    grown = 1 + share * tension / abs(friction)
    found = figures(spoilt(gripped, "guide_friction", scale((-1, 0), grown)))["tendon.grip"]
    # the tension before shrinks as the friction grows, and the bound by tanh(mu phi / 2) of that
    expected = share * (1 + math.tanh(0.1 * math.pi / 2))
    assert (found.verdict, found.value) == ("look", pytest.approx(expected, rel=0.02))


def test_a_rocker_that_goes_elsewhere_asks_for_a_look(tree):
    rocker = [b.name for b in tree.mechanism.bodies].index("tree.rocker1")
    run = spoilt(tree, "body_pose", shift((EVERY, rocker, 0), 1e-4))
    assert figures(run)["differential"].verdict == "look"


def test_forces_that_statics_does_not_decide_are_told(held):
    content = held.mechanism.model_dump(by_alias=True)
    content["materials"] = {"smooth": {"friction": 0.5}}
    run = simulate(type(held.mechanism).model_validate(content))
    figure = figures(run)["contact.shared"]
    assert figure.verdict == "look"
    assert "that balance alone does not fix: 3 of 3 on " in figure.why
    assert "friction" in figures(run)["rest.contacts"].why


def test_a_hinge_that_carries_nothing_is_not_asked_about_rest():
    """A motor led to its target has no load there: what is left is the last of the motion."""
    scene = load_scene({
        "run": {"duration": 1.0}, "bodies": [fixed("base"), mass("arm", 0.05, (0.0, 0.0))],
        "joints": [{"type": "pin", "name": "axle", "a": "base", "b": "arm", "on_a": [0, 0]}],
        "drives": [{"type": "torque", "name": "motor", "joint": "axle", "value": 0}],
        "controllers": [{"type": "pid", "name": "hold", "reads": "axle.angle", "target": 0.5,
                         "writes": "motor", "kp": 0.02, "kd": 8e-4}]})
    run = simulate(expand(scene))
    assert figures(run)["rest.moments"].verdict == "not computed"
    loaded = load_scene({**scene.model_dump(exclude={"schema_"}), "drives": [
        *scene.model_dump()["drives"],
        {"type": "brake", "name": "brake", "joint": "axle", "value": 1.0},
        {"type": "force", "name": "weight", "body": "arm", "at": [0.1, 0], "direction": [0, -1],
         "value": 1.0}]})
    assert figures(simulate(expand(loaded)))["rest.moments"].verdict == "pass"


def test_numbers_that_are_none_are_never_a_pass(held):
    run = spoilt(held, "body_pose", shift((slice(100, None), MIDDLE, 0), np.nan))
    found = figures(run)
    assert {"poses", "joint.drift", "momentum.moment"} <= {
        f.name for f in found.values() if f.verdict != "pass"}
    json.dumps([figure_data(f) for f in found.values()], allow_nan=False)


@pytest.mark.parametrize(("name", "reason"), [
    ("differential", "no tree"), ("poses", "no body hangs"), ("tendon.path", "no tendon"),
    ("spring.length", "no straight spring"), ("stop.overrun", "no hinge has stops"),
    ("rest.moments", "not at rest"), ("rest.contacts", "not at rest"),
    ("contact.shared", "no finger"), ("contact.friction", "nothing touches"),
    ("tendon.slack", "no tendon"), ("joint.drift", "no joint"), ("reaction.size", "no joint"),
])
def test_what_cannot_be_computed_says_why(name, reason):
    run = simulate(mechanism(gravity=(0.0, -G), bodies=[mass("stone", 1.0, (0.0, 0.0))]))
    figure = figures(run)[name]
    assert figure.verdict == "not computed"
    assert reason in figure.why
    assert math.isnan(figure.value)


@pytest.mark.parametrize(("more", "reason"), [
    ({"bodies": [fixed("wall"), {"name": "plate", "motion": "scheduled", "path": {"x": "=t"}}]},
     "schedule"),
    ({"bodies": [disc("ball", 0.1, (0, 0))], "drives": [
        {"type": "radius", "name": "swell", "body": "ball", "value": "=0.1 + 0.01 * t"}]},
     "radius"),
])
def test_work_that_is_not_recorded_is_told(more, reason):
    for name in ("energy.created", "energy.lost"):
        figure = figures(simulate(mechanism(**more)))[name]
        assert figure.verdict == "not computed"
        assert reason in figure.why


def test_contacts_of_which_some_steps_are_missing_leave_energy_open(held):
    run = held.pick(np.arange(1, len(held), 2))
    figure = figures(run)["energy.lost"]
    assert figure.verdict == "not computed"
    assert "sample_rate" in figure.why


def test_an_unfinished_run_and_an_empty_one_are_audited(held):
    cut = replace(held.info, status=Status.UNFINISHED)
    unfinished = Recording(held.mechanism, held.arrays, cut)
    assert "did not come to its end" in figures(unfinished)["rest.moments"].why
    assert {f.verdict for f in audit(held.part(0, 0))} == {"not computed"}


def test_arbitrary_numbers_neither_pass_in_silence_nor_raise():
    found = figures(recording(contacts=CONTACTS))
    assert found["momentum.moment"].verdict != "pass"
    assert all(isinstance(f, Figure) and f.why for f in found.values())


def test_run_json_holds_the_figures(held, tmp_path):
    held.save(tmp_path)
    kept = json.loads((tmp_path / "run.json").read_text())["audit"]
    assert [f["name"] for f in kept] == [f.name for f in audit(held)]
    assert {f["verdict"] for f in kept} == {"pass", "not computed"}
    assert next(f for f in kept if f["name"] == "differential")["value"] is None
    assert summary(held, verdicts=[], figures=[])["audit"] == []


def test_friction_of_a_pair_is_that_of_the_last_rule_or_of_the_materials():
    bodies = [disc(name, 0.1, (0, 0), material=name) for name in ("wood", "steel", "rubber")]
    machine = mechanism(
        bodies=bodies, materials={"wood": {"friction": 0.4}, "steel": {"friction": 0.1},
                                  "rubber": {"friction": 0.9}},
        contacts=[{"between": ("wood", "*"), "friction": 0.3},
                  {"between": ("rubber", "wood"), "friction": 0.7}])
    assert friction_of(machine, 0, 1) == 0.3
    assert friction_of(machine, 0, 2) == 0.7
    assert friction_of(machine, 1, 2) == pytest.approx(0.3)  # sqrt(0.1 * 0.9)
