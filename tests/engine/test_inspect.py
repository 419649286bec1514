"""The inspection of a scene warns of what is wrong, and only of that."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from sandbox.engine.inspect import inspect
from sandbox.engine.simulate import simulate
from sandbox.errors import SceneError
from sandbox.scene.expand import expand
from sandbox.scene.geometry import mass_properties
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene

M, R, L = 0.01, 0.005, 0.04
DISC = {"type": "circle", "radius": R}
BAR = {"type": "capsule", "start": [0, 0], "end": [L, 0], "radius": R}
GROUND = {"name": "ground", "motion": "fixed"}
PINNED: dict[str, Any] = {
    "bodies": [GROUND, {"name": "bar", "mass": M, "shapes": [BAR]}],
    "joints": [{"type": "pin", "name": "hinge", "a": "ground", "b": "bar", "on_a": [0, 0]}],
}


def found(scene: dict[str, Any], **more: Any) -> list[tuple[str, str, str]]:
    """Severity, element and message of every finding."""
    mechanism = Mechanism.model_validate({**copy.deepcopy(scene), **more})
    return [(f.severity, f.element, f.message) for f in inspect(mechanism)]


def the_one(scene: dict[str, Any], **more: Any) -> tuple[str, str, str]:
    findings = found(scene, **more)
    assert len(findings) == 1, findings
    return findings[0]


def test_a_window_beyond_the_run_has_no_value() -> None:
    expect = [{"mean": "bar.x", "over": [0, 3], "below": 1}]
    severity, _, message = the_one(PINNED, run={"duration": 2}, expect=expect)
    assert (severity, message) == ("warning", "the window ends at 3 s, the run at 2 s")


def jointed(**joint: Any) -> dict[str, Any]:
    """Two discs 50 mm apart with a joint between."""
    return {
        "bodies": [
            {"name": "a", "mass": M, "shapes": [DISC]},
            {"name": "b", "mass": M, "shapes": [DISC], "at": [0.05, 0]},
        ],
        "joints": [{"name": "j", "a": "a", "b": "b", **joint}],
    }


@pytest.mark.parametrize(("joint", "message"), [
    ({"type": "pin", "on_a": [0.05, 0], "on_b": [0, 0.001]}, "anchors are 1 mm apart"),
    ({"type": "weld", "on_a": [0, 0], "on_b": [0, 0]}, "anchors are 50 mm apart"),
    ({"type": "slot", "start": [0, 0.003], "end": [0.1, 0.003]}, "point is 3 mm off the groove"),
    ({"type": "slot", "start": [0, 0], "end": [0.03, 0]}, "point is 20 mm off the groove"),
    ({"type": "slot", "path": [[0, 0.01], [0.05, 0.004], [0.1, 0.01]]}, "is 4 mm off the path"),
])
def test_joints_that_are_not_assembled(joint, message):
    severity, element, text = the_one(jointed(**joint))
    assert (severity, element) == ("warning", "j")
    assert text.startswith("not assembled at t = 0")
    assert message in text


@pytest.mark.parametrize(("joint", "blocks"), [
    ({"type": "rod", "on_a": [0.05, 0], "length": 0.04}, True),
    ({"type": "rod", "on_a": [0.05, 0], "on_b": [0, 2e-9]}, False),
    ({"type": "slot", "start": [0.05, 0], "end": [0.05, 0]}, True),
    ({"type": "slot", "start": [0.05, 0], "end": [0.05, 2e-9]}, None),
    ({"type": "rope", "on_a": [0.05, 0], "longest": 0.04, "shortest": 0.03}, False),
])
def test_a_joint_without_a_direction_is_refused(joint, blocks):
    mechanism = Mechanism.model_validate(jointed(**joint))
    findings = inspect(mechanism)
    assert [one.blocks for one in findings] == ([] if blocks is None else [blocks])
    if blocks:
        with pytest.raises(SceneError) as refused:
            simulate(mechanism)
        assert [one.message for one in refused.value.problems] == [findings[0].message]


@pytest.mark.parametrize("joint", [
    {"type": "pin", "on_a": [0.05, 0], "on_b": [0, 0.9e-5]},
    {"type": "weld", "on_b": [0, 0.3]},
    {"type": "slot", "start": [0.2, 0], "end": [0.05, 0]},
    {"type": "rope", "longest": 0.05, "shortest": 0.05},
])
def test_joints_that_are_assembled(joint):
    assert found(jointed(**joint)) == []


@pytest.mark.parametrize(("turn", "positive", "zero", "ok"), [
    (0.5, "counterclockwise", 0.0, True),
    (-0.5, "counterclockwise", 0.0, False),
    (-0.5, "clockwise", 0.0, True),
    (-0.5, "counterclockwise", -0.6, True),
])
def test_a_hinge_starts_within_its_limits(turn, positive, zero, ok):
    scene = copy.deepcopy(PINNED)
    scene["bodies"][1]["angle"] = turn
    scene["joints"][0] |= {"positive": positive, "zero": zero, "limits": [0, 1]}
    findings = found(scene)
    assert (findings == []) is ok
    assert ok or "outside its limits [0 deg, 57.3 deg]" in findings[0][2]


# --- overlap

def two_discs(distance: float, **second: Any) -> dict[str, Any]:
    return {"bodies": [
        {"name": "a", "mass": M, "shapes": [DISC]},
        {"name": "b", "shapes": [DISC], "at": [distance, 0], "mass": M, **second},
    ]}


def test_overlapping_bodies_are_reported_with_their_depth():
    assert the_one(two_discs(2 * R - 0.001)) == ("warning", "a", "overlaps 'b' by 1 mm at t = 0")


@pytest.mark.parametrize("scene", [
    two_discs(2 * R - 0.9e-5),
    two_discs(R) | {"contacts": [{"between": ["a", "b"], "collide": False}]},
    {"bodies": [{**body, "motion": "fixed"} for body in two_discs(R)["bodies"]]},
    two_discs(0.0) | {"joints": [
        {"type": "pin", "name": "j", "a": "a", "b": "b", "on_a": [0, 0]}]},
], ids=["negligibly deep", "rule", "both fixed", "jointed"])
def test_permitted_overlaps_are_not_reported(scene):
    assert found(scene) == []


# --- tendons

def test_guides_that_coincide_block():
    cable = {"name": "cord", "guides": [
        {"body": "ground", "at": [-0.02, 0.01]}, {"body": "ground", "at": [0.01, 0.01]},
        {"body": "bar", "at": [0.01, 0.01]}]}
    mechanism = Mechanism.model_validate(PINNED | {"tendons": [cable]})
    finding, = inspect(mechanism)
    assert (finding.element, finding.blocks) == ("cord", True)
    assert "guides 1 and 2 coincide" in finding.message


BELT: dict[str, Any] = {
    "bodies": [GROUND, {"name": "w", "mass": 1, "inertia": 1e-3, "at": [0.3, 0]},
               {"name": "u", "mass": 1, "inertia": 1e-3, "at": [0, -0.3]}]}


@pytest.mark.parametrize(("cable", "finding"), [
    ({"guides": [{"body": "w", "friction": 0.2}, {"body": "ground"}]}, "the tendon is fixed there"),
    ({"closed": True, "guides": [{"body": "ground", "radius": 0.05, "friction": 0.2},
                                 {"body": "w", "radius": 0.05}]}, "no other guide holds the loop"),
    ({"guides": [{"body": "w"}, {"body": "ground", "radius": 0.01, "turns": 1}]},
     "its 1 turns have no effect: the tendon is fixed there"),
    ({"closed": True, "guides": [
        {"body": b, "radius": 0.02, "friction": 0.2} for b in ("ground", "w", "u")]},
     "crosses itself: this path winds 2 times around"),
    ({"closed": True, "guides": [
        {"body": "ground", "radius": 0.05, "side": "left"},
        {"body": "w", "radius": 0.05, "side": "left"}]},
     "it turns no wheel: the loop slides over all its guides without friction"),
    ({"guides": [{"body": "w"}, {"body": "ground"}], "pretension": 300, "stiffness": 10},
     "is too large for a tendon"),
])
def test_useless_friction_turns_and_loops_of_tendons_are_reported(
        cable: dict[str, Any], finding: str):
    assert finding in the_one(BELT, tendons=[{"name": "cord", **cable}])[2]


# --- springs and dampers

def inertia_about_hinge() -> float:
    bar = Mechanism.model_validate(PINNED).bodies[1]
    return mass_properties(bar).inertia + M * (L / 2) ** 2


TWO_BARS: dict[str, Any] = {
    "bodies": [{"name": "a", "mass": M, "shapes": [BAR], "at": [-L, 0]},
               {"name": "b", "mass": M, "shapes": [BAR]}],
    "joints": [{"type": "pin", "name": "hinge", "a": "a", "b": "b", "on_b": [0, 0]}]}
ROTARY = {"type": "rotary", "name": "s", "joint": "hinge"}
AT_ITS_RIM = {"type": "linear", "name": "s", "a": "ground", "b": "a", "on_a": [R, 0.1],
              "on_b": [R, 0]}


@pytest.mark.parametrize(("scene", "spring", "softness"), [
    (PINNED, ROTARY, lambda: 1 / inertia_about_hinge()),
    # two equal bars end to end: each turns about its centre, the hinge moves with both
    (TWO_BARS, ROTARY, lambda: 2 / (inertia_about_hinge() - M * (L / 2) ** 2)),
    # a disc of inertia m r^2/2, pulled at its rim across the line of centres: 1/m + r^2/I
    ({"bodies": [GROUND, {"name": "a", "mass": M, "shapes": [DISC]}]}, AT_ITS_RIM, lambda: 3 / M),
])
@pytest.mark.parametrize(("pace", "words"), [
    (0.49, None), (0.51, "more than 1 % off"), (1.99, "more than 1 % off"),
    (2.01, "damped, to 45 % in a step")])
def test_a_spring_is_held_against_the_step(scene, spring, softness, pace, words):
    """h w = h sqrt(k softness); warned above 0.5, damped above 2."""
    stiffness = (pace / Mechanism().run.step) ** 2 / softness()
    findings = found(scene, springs=[{**spring, "stiffness": stiffness}])
    assert len(findings) == (words is not None)
    assert words is None or words in findings[0][2]


def test_a_damper_that_settles_within_a_fraction_of_the_step():
    for share, count in ((4.9, 0), (5.1, 1)):
        scene = copy.deepcopy(PINNED)
        scene["joints"][0]["damping"] = share * inertia_about_hinge() / Mechanism().run.step
        findings = found(scene)
        assert len(findings) == count
        assert not count or (findings[0][1] == "hinge" and "damper" in findings[0][2])


# --- the rest

@pytest.mark.parametrize(("more", "hint"), [
    ({"expect": [{"mean": "bar.contcat.normal", "above": 0}]}, "contact.normal"),
    ({"meters": [{"name": "m", "value": "=hinge.angel * 2"}]}, "hinge.angle")])
def test_unknown_quantities_block(more, hint):
    finding, = inspect(Mechanism.model_validate(PINNED | more))
    assert finding.blocks
    assert hint in str(finding)


def test_a_step_that_does_not_divide_the_sampling_interval():
    run = {"step": 3e-4, "sample_rate": 1000}
    severity, element, text = the_one(PINNED | {"run": run})
    assert (severity, element) == ("warning", "run")
    assert "does not divide" in text
    assert found(PINNED | {"run": {"step": 2.5e-4, "sample_rate": 1000}}) == []


LOOP = {"closed": True, "guides": [
    {"body": body, "radius": 0.05, "friction": 0.1} for body in ("ground", "w")]}
STILL = {"guides": [{"body": "ground"}, {"body": "ground", "at": [0.1, 0]}]}


@pytest.mark.parametrize(("cable", "drive", "words"), [
    (STILL, {"type": "force", "body": "ground", "direction": [1, 0]}, "acts on 'ground'"),
    (STILL, {"type": "pull", "tendon": "cord"}, "acts on 'ground'"),
    (LOOP, {"type": "pull", "tendon": "cord"}, "cord, which is closed and has no end"),
])
def test_a_drive_that_moves_nothing(cable, drive, words):
    text, = [message for _, element, message in found(
        BELT, tendons=[{"name": "cord", **cable}], drives=[{"name": "d", "value": 1, **drive}])
        if element == "d"]
    assert words in text


def test_a_window_without_a_body():
    near = {"centre": [0.08, 0], "width": 0.08}
    far = {"centre": [0.1, 0], "width": 0.08}
    assert found(PINNED | {"view": near}) == []
    assert the_one(PINNED | {"view": far})[1:] == ("view", "no body lies in the window at t = 0")


@pytest.mark.parametrize(("path", "jumps"), [
    ({"x": {"expression": "=0.1 + t"}, "angle": 0.2}, False), ({"x": 0.2}, True),
    ({"angle": {"expression": "=cos(t)"}}, True),
])
def test_a_scheduled_body_begins_where_its_path_does(path, jumps):
    findings = found({"bodies": [
        {"name": "plate", "motion": "scheduled", "at": [0.1, 0], "angle": 0.2, "path": path}]})
    assert bool(findings) is jumps
    assert not jumps or findings[0][:2] == ("warning", "plate")


def test_overconstrained_joints_are_reported():
    """A bar on two pins of the ground: along it either may carry what the other does not."""
    second = {"type": "pin", "name": "second", "a": "ground", "b": "bar", "on_a": [L, 0]}
    severity, _, message = the_one(PINNED, joints=[*PINNED["joints"], second])
    assert severity == "warning"
    assert message.startswith("'hinge', 'second' are overconstrained")
    slides = {**second, "type": "slot", "start": [0, 0], "end": [2 * L, 0]}
    del slides["on_a"]
    assert not found(PINNED, joints=[*PINNED["joints"], {**slides, "on_b": [L, 0]}])


ARM_SCENE: dict[str, Any] = {
    "run": {"duration": 0.1},
    "bodies": [{"name": "frame", "motion": "fixed"},
               {"name": "arm", "at": [0.3, 0.0], "mass": 1.0, "inertia": 1e-2}],
    "joints": [{"type": "pin", "name": "axle", "a": "frame", "b": "arm", "on_b": [-0.3, 0]},
               {"type": "actuator", "name": "cylinder", "a": "frame", "b": "arm",
                "on_a": [0.3, -0.5], "shortest": 0.4, "longest": 0.6}],
}
LIFT = {"type": "length", "name": "lift", "joint": "cylinder", "force": 10}


def idle_warnings(**parts: Any) -> list[tuple[str, str]]:
    """What is found of an element: its path and the words."""
    scene = {**ARM_SCENE, **parts}
    return [(problem.path, problem.message) for problem in inspect(expand(load_scene(scene)))]


@pytest.mark.parametrize(("parts", "path", "words"), [
    ({"drives": [{"type": "surface", "name": "belt", "body": "frame", "value": 1}]},
     "$.drives[0].body", "frame has no shapes"),
    ({"drives": [{**LIFT, "value": {"ramp": {"from": 0.5, "to": 0.7, "over": 0.1}}}]},
     "$.drives[0].value", "sets cylinder to 700 mm, but it is 600 mm long at most"),
    ({"drives": [{**LIFT, "value": 0.6}]}, "", ""),
])
def test_idle_drives_are_reported(parts: dict[str, Any], path: str, words: str) -> None:
    found = idle_warnings(**parts)
    assert [place for place, _ in found] == [path] * bool(path)
    assert all(words in message for _, message in found)


APART = [{"between": ["*", "*"], "collide": False}]


def unlike_pair(light: float, *, links: Any = None, inertia: float | None = None) -> dict[str, Any]:
    """Two discs 20 mm apart, of 2 kg and of less."""
    return {"bodies": [{"name": "heavy", "mass": 2.0, "shapes": [DISC]},
                       {"name": "light", "mass": light, "at": [0.02, 0], "shapes": [DISC],
                        **({"inertia": inertia} if inertia else {})}], **(links or {})}


def mass_warnings(scene: dict[str, Any]) -> list[str]:
    found = inspect(Mechanism.model_validate(scene))
    assert {one.severity for one in found} <= {"warning"}
    return [str(one) for one in found if one.code == "mass-ratio"]


PIN = {"joints": [{"type": "pin", "name": "j", "a": "heavy", "b": "light", "on_b": [0, 0]}]}
CABLE = {"contacts": APART, "tendons": [{"name": "cord", "guides": [
    {"body": "heavy"}, {"body": "light"}]}]}
TOUCH: dict[str, Any] = {}


@pytest.mark.parametrize("links", [PIN, CABLE, TOUCH], ids=["joint", "cord", "contact"])
def test_a_large_mass_ratio_is_reported_with_both_bodies(links):
    assert mass_warnings(unlike_pair(2.1e-6, links=links)) == []
    line, = mass_warnings(unlike_pair(1.9e-6, links=links))
    assert line.startswith("warning: light: has 1.9e-06 kg where 'heavy' has 2 kg")
    assert line.endswith("forces are right to 1e-09 of the largest")


SPRING = {"springs": [{"type": "linear", "name": "s", "a": "heavy", "b": "light",
                       "stiffness": 1e-3}]}


@pytest.mark.parametrize("more", [{}, SPRING])
def test_unconnected_bodies_may_have_any_mass_ratio(more):
    """A spring is no part of the balance that is solved for."""
    assert mass_warnings(unlike_pair(1e-9, links={"contacts": APART, **more})) == []


def test_a_body_that_turns_too_easily_is_as_light_where_it_is_pushed():
    """1/m + r^2/I with 0.1 kg, 1e-12 kg m^2 and 20 mm: 2.5e-9 kg."""
    found, = mass_warnings(unlike_pair(0.1, links=PIN | {"joints": [
        {**PIN["joints"][0], "on_a": [0, 0], "on_b": [-0.02, 0]}]}, inertia=1e-12))
    assert ("with 1e-12 kg m^2 answers a push at 20 mm from its centre as 2.5e-09 kg would, "
            "where 'heavy' has 2 kg") in found


@pytest.mark.parametrize(("points", "closed"), [
    ([(0, 0), (0.1, 0), (0, 0)], False),  # at a node
    ([(0, 0), (0.1, 0), (0.03, 0)], False),  # between nodes
    ([(0, 0), (0.05, 0), (0.1, 0)], True),
])
def test_a_path_that_turns_back_on_itself_is_refused(points, closed):
    with pytest.raises(SceneError, match="turns back on itself") as caught:
        simulate(load_scene(
            jointed(type="slot", path=[list(point) for point in points], closed=closed)))
    assert caught.value.problems[0].path.endswith(".path")
