"""Each wrong input gives one diagnostic: its code, its place, what is wrong, and a near miss.

One table for all that a scene may have wrong; what has to be written in Python is tested beside it.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from typing import Any

import pytest

import sandbox
from sandbox.errors import Problem
from sandbox.values.paths import parse_path
from tests.scene.hand import ARM, FLUIDS, hand

DISC: dict[str, Any] = {"name": "disc", "mass": 1, "shapes": [{"type": "circle", "radius": 0.01}]}
PUSH = {"type": "force", "name": "push", "body": "ball", "direction": [1, 0],
        "value": "=profile(t)"}
SCENES: dict[str, dict[str, Any]] = {
    "hand": hand(), "arm": ARM, "fluids": FLUIDS, "ball": {"bodies": [{**DISC, "name": "a"}]},
    "outline": {"bodies": [{"name": "x", "motion": "fixed", "shapes": [
        {"type": "polygon", "points": [[0, 0], [1, 0], [1, 1], [0, 1]]}]}]},
    "repeat": {"parameters": {"n": 1}, "bodies": [
        {"name": "b{i}", "mass": 1, "inertia": 1, "repeat": 2}],
        "groups": [{"name": "all", "bodies": ["b0"]}]},
    "tables": {"tables": {"profile": {"points": [[0, 1], [1, 3], [3, 2]]}},
               "bodies": [{**DISC, "name": "ball"}], "drives": [PUSH]},
    "pair": {
        "bodies": [DISC, {"name": "wall", "motion": "fixed",
                          "shapes": [{"type": "box", "size": [1, 1]}]}],
        "joints": [
            {"type": "pin", "name": "hinge", "a": "wall", "b": "disc", "on_a": [0, 0]},
            {"type": "actuator", "name": "piston", "a": "wall", "b": "disc", "on_a": [0, -1]}],
        "springs": [{"type": "rotary", "name": "coil", "joint": "hinge", "stiffness": 1}],
        "tendons": [{"name": "cord", "guides": [{"body": "wall"}, {"body": "disc"}]}]},
    "mesh": {
        "bodies": [DISC, {"name": "wall", "motion": "fixed"}],
        "joints": [
            {"type": "pin", "name": "hinge", "a": "wall", "b": "disc", "on_a": [0, 0]},
            {"type": "gear", "name": "mesh", "a": "wall", "b": "disc", "radius_a": 0.02,
             "radius_b": 0.05}],
        "springs": [{"type": "linear", "name": "band", "a": "wall", "b": "disc", "on_a": [0, -1],
                     "force": "=stretch"}],
        "loads": [{"type": "law", "name": "f", "force": [0, 0]}]},
}
WRONG = r"""
[hand]
bodies[0].mas = 1 | unknown-key | unknown key 'mas' ? 'mass'
bodies[0].name = | missing-key | 'name' is missing @ bodies[0]
bodies[0].mass = 0 | out-of-range | must be greater than 0, got 0
bodies[0].mass = "1 mm" | wrong-unit | 'mm' is a unit of length
bodies[0].mass = "=pul" | name-not-found | unknown name 'pul' ? 'pull'
bodies[1].at = [1] | missing-key | entry 1 of the list is missing
bodies[1].motion = "fix" | not-allowed | 'fix' is not allowed ? 'fixed'
bodies[1].shapes[0].type = "polygone" | unknown-type | unknown type 'polygone' ? 'polygon'
bodies[2].name = "disc" | duplicate-name | is already that of another body
joints[0].a = "wal" | name-not-found | there is no body named 'wal' ? 'wall'
joints[0].b = "wall" | conflicting-keys | must be two bodies @ joints[0]
tendons[0].guides = [{"body": "disc"}] | wrong-type | at least 2
drives[2].direction = [0, 0] | out-of-range | [0, 0] is no direction
drives[1].shape = 1 | not-settable | shape 1 of 'disc' (they count from 0) is no circle
drives[1].value = "=0.01 - t" | out-of-range | not greater than 0 at t
parts[0].like = "digits" | bad-template | no template 'digits' ? 'digit'
parts[3].pulls[1] = "fingr2" | name-not-found | named 'fingr2' ? 'finger2'
parts[2].name = "finger1" | duplicate-name | is taken by parts[0]
templates.digit.rads = 1 | unknown-key | unknown key ? 'radii'
parameters.pull = "=each" | circular-definition | each → pull → each @ parameters.each
parameters["a.b"] = 1 | invalid-name | is not the name of a parameter
title = "a\ud800" | invalid-json | half a character (a surrogate) @ $
parameters = 3 | wrong-type | expected an object {…}, got the number 3
run.duration = 31500000.0 | limit-exceeded | 63 000 000 000 steps
view.fps = 30 | not-allowed | 30 is not allowed here
contacts[0].between[0] = "finger1" | name-not-found | no body's name ? 'finger1.*'
contacts[0].collide = "no" | wrong-type | expected true or false, got the text 'no'
materials.rubber.static = 0.5 | out-of-range | at least 1
materials.rubber = {"friction": 0, "static": 2}
    | conflicting-keys | 'static' is a multiple of 'friction', which is 0
meters[0].value = "=a +" | bad-expression | 'a +' is not an expression
expect[0].within = "5 parsec" | wrong-unit | unknown unit 'parsec'
expect[0].at = "1 ms" | conflicting-keys | 'quantity' and 'at' go together @ expect[0]
expect[0].over = ["2 ms", "1 ms"] | out-of-range | before it begins at 0.002 s @ expect[0]
expect[0] = {"quantity": "body.x", "at": "1 ms", "over": [0, "1 ms"], "is": 1}
    | conflicting-keys | 'at' is one instant and 'over' a window: give one of them
format = 2 | unsupported-format | this version of sandbox reads format 1
drives[2].value = "3 mm" | wrong-unit | 'mm' is a unit of length, but this is a force
drives[2].value = {"table": [[1, 0], [1, 2]]} | bad-table | must increase @ drives[2].value.table
drives[2].value = {"too": 3} | wrong-type | expected a number, a ramp
[arm]
controllers[0].writes = "moter"
    | name-not-found | there is no drive named 'moter' to write ? 'motor'
controllers[0].reads = "elbow.angel"
    | unknown-quantity | unknown quantity 'elbow.angel' ? 'elbow.angle'
controllers[0].reads = "elbow.damping" | quantity-not-live | cannot be read during it
controllers[0].limits = [1, -1] | out-of-range | 1 is not below -1
controllers[0].rate = "300 Hz"
    | bad-rate | 300 Hz is no whole number of steps: one act every 6.66667 steps of 0.0
controllers[0].target = "=1 / (t - t)" | out-of-range | no finite value
controllers[0].name = "motor" | duplicate-name | already that of a drive
events = [{"name": "later", "at": "2 s", "stop": "pass"}]
    | event-never-happens | and the run ends at 1 s @ events[0].at
events = [{"name": "later", "when": "=t > 0", "after": "0.6 s", "rate": "2 Hz", "stop": "pass"}]
    | event-never-happens | due at 1 s @ events[0].after
events = [{"name": "later", "at": 0.1, "set": {"loop.tarket": 1}}] | name-not-found
    | there is nothing named 'loop.tarket' to set ? 'loop.target' @ events[0].set["loop.tarket"]
events = [{"name": "later", "at": 0.1, "set": {"loop.active": 2}}]
    | out-of-range | 0 or 1 @ events[0].set["loop.active"]
events = [{"name": "later", "stop": "pass"}]
    | conflicting-keys | give either 'at' or 'when' @ events[0]
events = [{"name": "later", "at": 0.1, "stop": "fail", "lasts": 0.1}]
    | conflicting-keys | 'lasts' needs 'set' @ events[0].lasts
[fluids]
lines[0].chambers[0].area = "10 cm" | wrong-unit | 'cm' is a unit of length
lines[0].chambers[1].displacement = 0 | out-of-range | other than 0
lines[1].volume = | out-of-range | outside of
lines[1].modulus = 1000000000.0 | conflicting-keys | exclude each other @ lines[1]
lines[0].least = 1 | out-of-range | a vacuum, to 0 @ lines[0]
lines[0].pressure = "-2 bar" | out-of-range | between least and relief @ lines[0]
valves[0].resistance = | conflicting-keys | a 'resistance' greater than 0 @ valves[0]
drives[0] = {"type": "pressure", "name": "more", "line": "air", "value": 0}
    | set-twice | the pressure of 'air' is set already, by 'more' @ drives[1].line
[ball]
bodies[0].plane = "al" | not-allowed | 'al' is not a plane ? 'all'
bodies[0].plane = [] | wrong-type | expected 1 to 64 planes, got 0
bodies = [{"name": "a", "mass": 5e-324, "inertia": 1}]
    | out-of-range | at least 1e-12 kg @ bodies[0].mass
bodies = [{"name": "a", "density": 1000000000000.0, "shapes": [{"type": "box", "size": [1000000.0,
    1000000.0]}]}] | out-of-range | mass is 1e+22 @ bodies[0]
bodies = [{"name": "a", "motion": "fixed", "shapes": [{"type": "polygon", "points": [[0, 0], [1e-12,
    0], [0, 1]]}]}] | out-of-range | shortest side @ bodies[0].shapes[0].points
bodies = [{"name": "a", "motion": "scheduled", "path": {"x": {"table": [[0, 0], [0.5, 1000000000.0],
    [1, 0]]}}}] | out-of-range | 1e+09 is too large @ bodies[0].path.x
drives = [{"type": "force", "name": "push", "body": "a", "direction": [5e-324, 5e-324], "value": 1}]
    | out-of-range | as a direction its length is @ drives[0].direction
drives = [{"type": "force", "name": "push", "body": "a", "direction": [1, 0], "value": {"to": 1e+17,
    "over": 0.1}}] | out-of-range | 1e+17 is too large @ drives[0].value
bodies[0].shapes[0] = {"type": "drawing", "file": "no.svg"}
    | bad-drawing | no folder to read a drawing from
parts = [{"name": "jaw", "include": "jaw"}]
    | bad-include | comes from no file has no folder @ parts[0].include
[outline]
bodies[0].shapes[0].points = [[0, 0], [2, 2], [2, 0], [0, 2]] | bad-outline
    | crosses or touches itself at [1, 1], where the side from corner 0 meets that from corner 2
bodies[0].shapes[0].nodes = [[[0, 0, 0, 1], [2, 0, 0, 1]]]
    | bad-outline | are not on its outline @ bodies[0].shapes[0]
bodies[0].shapes[0].points = [[0, 0], [1, 1], [2, 2]]
    | bad-outline | no area: its corners lie in one line
bodies[0].shapes[0].points = [[0, 0], [1, 0], [1, 0], [0, 1]]
    | bad-outline | corners 1 and 2 are the same point
bodies[0].shapes[0].holes = [[[5, 5], [6, 5], [5, 6]]]
    | bad-outline | hole 0: this hole lies outside of the outline at [5, 5]
bodies[0].shapes[0].holes = [[[0.1, 0.1], [0.9, 0.1], [0.1, 0.9]], [[0.2, 0.2], [0.3, 0.2], [0.2,
    0.3]]] | bad-outline | hole 1: this hole and hole 0 lie one in the other
bodies[0].shapes[0] = {"type": "cam", "base": 0.03, "roller": 0.01, "lift": [[0, 0], [2, 0], [1,
    0]]} | bad-outline | entry 2 has 57.2958 deg after 114.592 deg
bodies[0].shapes[0] = {"type": "cam", "base": 0.03, "roller": 0.01, "lift": [[0, 0], [2, 0],
    ["360 deg", 0]]} | bad-outline | cover 360 deg
[repeat]
bodies[0].repeat = 0 | bad-repeat | 0 is not a number of copies
bodies[0].repeat = 1000000000.0 | limit-exceeded | 1e+09 copies are more
bodies[0].repeat = {} | bad-repeat | either 'count' or 'list'
bodies[0].repeat = {"list": [{"i": 3}]}
    | duplicate-name | that of the index @ bodies[0].repeat.list[0].i
parameters.i = 3 | duplicate-name | 'i' is that of a parameter @ bodies[0].repeat
bodies[0].repeat = {"count": 2, "index": "t"}
    | invalid-name | means the time @ bodies[0].repeat.index
bodies[0].repeat = {"count": 2, "circle": [0, 0], "line": [0, 0]}
    | bad-repeat | exclude each other @ bodies[0].repeat
[tables]
tables.profile = {"points": [[0, 1], [0, 2]]}
    | bad-table | must increase: point 1 has 0 after 0 @ tables.profile.points
tables.profile = {"points": [[0, 1], [1, 2]], "beyond": "repeat"} | bad-table | must be equal: 1, 2
tables.profile = {"points": [["0 mm", 1], ["1 s", 2]]}
    | bad-table | all x of a table are of one kind, and here are length and @ tables.profile.points
tables.profile = {"points": [[0, 0], [1e-12, 1000000000.0]]} | bad-table | too steep
[pair]
view = {"follow": "disk"} | name-not-found | there is no body named 'disk' ? 'disc' @ view.follow
view = {"show": {"velocity": ["disk"]}}
    | name-not-found | no body's name matches 'disk' ? 'disc' @ view.show.velocity
drives = [{"type": "stiffness", "name": "d", "spring": "hinge", "value": 1}]
    | name-not-found | no spring named 'hinge' @ drives[0].spring
drives = [{"type": "stiffness", "name": "d", "tendon": "cord", "value": 1}]
    | not-settable | with 100000 N/m it counts as inextensible @ drives[0].tendon
tendons = [{"name": "cord", "guides": [{"body": "wall"}, {"body": "disc"}],
    "stiffness": 500}] & drives = [{"type": "stiffness", "name": "d", "tendon": "cord", "value": 1},
    {"type": "pull", "name": "p", "tendon": "cord", "value": 1}] | not-settable
    | 'p' pulls it, which sets its tension @ drives[0].tendon
tendons = [{"name": "cord", "guides": [{"body": "wall"}, {"body": "disc", "friction": 0.2},
    {"body": "wall", "at": [1, 0]}], "stiffness": 500}] & drives = [{"type": "stiffness",
    "name": "d", "tendon": "cord", "value": 1}] | not-settable
    | its guide 1 has friction @ drives[0].tendon
drives = [{"type": "pull", "name": "d", "tendon": "cord", "value": "=sqrt(0.5 - t)"}]
    | out-of-range | no finite value @ drives[0].value
meters = [{"name": "hinge", "value": "=1"}]
    | duplicate-name | already that of a joint @ meters[0].name
bodies[2] = {"name": "disc.angle", "mass": 1, "inertia": 1}
    | duplicate-name | also means the quantity 'angle' of 'disc' @ bodies[2].name
drives = [{"type": "servo", "name": "d", "joint": "piston", "value": 0.1, "torque": 1}]
    | name-not-found | 'piston' is an actuator, and 'servo' acts on a hinge
    ? a drive of type 'length', which acts on an actuator @ drives[0].joint
[mesh]
joints[0].friction = 1 & joints[0].friction_coefficient = 0.1 & joints[0].pin_radius = 0.01 |
    conflicting-keys | not both @ joints[0]
joints[0].friction = 1 & joints[0].static = 0.5 | out-of-range | at least 1 @ joints[0].static
joints[1].pressure_angle = "50 deg" | out-of-range | must be at most 0.785398
joints[1].inside = true & joints[1].radius_b = 0.02 | out-of-range | must differ @ joints[1]
joints[1].backlash = -0.001 | out-of-range | must be 0 or more
joints[1] = {"type": "rack", "name": "mesh", "a": "wall", "b": "disc", "radius": 0.02, "along": [0,
    0]} | out-of-range | [0, 0] is no direction @ joints[1].along
springs[0].force = | conflicting-keys | give either 'stiffness' or 'force' @ springs[0]
springs[0].force = "=twist" | name-not-found | unknown name 'twist'
springs[0].force = "=sine(stretch)" | bad-expression | unknown function 'sine' ? 'sin'
drives = [{"type": "stiffness", "name": "d", "spring": "band", "value": 200}] | not-settable |
    has no stiffness to set: it follows a law @ drives[0].spring
drives = [{"type": "stiffness", "name": "k", "spring": "band", "tendon": "cord"}] & tendons =
    [{"name": "cord", "guides": [{"body": "wall", "at": [0, 1]}, {"body": "disc"}]}] |
    conflicting-keys | needs either 'spring' or 'tendon' @ drives[0]
loads[0].force = ["=-vxx", 0] | name-not-found | unknown name 'vxx' ? 'vx' @ loads[0].force[0]
parameters = {"mass": 2} & loads[0].force = ["=-mass * vx", 0] | duplicate-name | 'mass' is a
    parameter, and here it would mean the body's own @ loads[0].force[0]
loads[0].force[0] = "3 m/s" | wrong-unit | 'm/s' is a unit of speed, but this is a force
loads[0].force = | conflicting-keys | give a 'force', an 'acceleration' or a 'torque' @ loads[0]
loads[0].bodies = "dsc" | name-not-found | no body's name matches 'dsc' ? 'disc' @
    loads[0].bodies[0]
loads[0].bodies = ["wall"] | name-not-found | 'wall' matches no body that moves freely @
    loads[0].bodies[0]
loads[0].force[1] = "=1 / x" | undefined-law | has no finite value on 'disc' at t = 0, x = 0
loads[0] = {"type": "drag", "name": "f"} | conflicting-keys | give 'linear', 'area' or 'turning'
gravity = [1, 0] & loads[0] = {"type": "buoyancy", "name": "f"} | bad-fluid | gravity, which has to
    point downwards @ loads[0]
bodies[0].displaces = [{"type": "polyline", "points": [[0, 0], [1, 0]]}] | bad-outline | no area
    that could keep a liquid away @ bodies[0]
events = [{"name": "e", "at": 0.1, "release": ["hinge", "disc"]}] | not-releasable | 'disc' is a
    body, which cannot be released @ events[0].release[1]
events = [{"name": "e", "at": 0.1, "take_up": "mesh"}] | not-releasable | 'mesh' joins wheels where
    they meet at t = 0, so events cannot engage it again @ events[0].take_up[0]
events = [{"name": "e", "at": 0.1, "release": "hinge", "take_up": "hinge"}] | conflicting-keys | one
    event cannot release and engage 'hinge' @ events[0]
drives = [{"type": "hold", "name": "h0", "element": "hinge", "value": 1}, {"type": "hold", "name":
    "h1", "element": "hinge", "value": 1}] | set-twice | the hold of 'hinge' is set already, by 'h0'
    @ drives[1].element
loads[0].bodies = "all" | name-not-found
    | no body's name matches 'all' ? '*', every body that moves freely @ loads[0].bodies[0]
"""
"""Below the name of a scene in brackets: changes ``place = value`` (no value removes a key, ``&``
joins two), code, part of the message, ``?`` hint, ``@`` the diagnostic's place if it is another."""


def rows() -> Iterator[Any]:
    scene = ""
    for row in WRONG.strip("\n").replace("\n    ", " ").split("\n"):
        if row.startswith("["):
            scene = row.strip("[]")
            continue
        changes, code, message = row.split(" | ")
        found = [change.split(" =", 1) for change in changes.split(" & ")]
        message, _, place = message.partition(" @ ")
        message, _, hint = message.partition(" ? ")
        path = "$" if place == "$" else f"$.{place or found[-1][0]}"
        yield pytest.param(SCENES[scene], found, (code, path, hint), message,
                           id=f"{scene}: {changes[:60]}")


def change(scene: dict[str, Any], place: str, value: str) -> None:
    """Set the JSON text of a value at a place; an empty text removes the key."""
    *way, last = parse_path(place)
    holder: Any = scene
    for step in way:
        holder = holder[step]
    if not value:
        del holder[last]
    elif isinstance(holder, list) and last == len(holder):
        holder.append(json.loads(value))
    else:
        holder[last] = json.loads(value)


@pytest.mark.parametrize(("scene", "changes", "expected", "message"), [*rows()])
def test_one_diagnostic(
    scene: dict[str, Any], changes: list[list[str]], expected: tuple[str, str, str], message: str,
) -> None:
    scene = copy.deepcopy(scene)
    for place, value in changes:
        change(scene, place, value.strip())
    with pytest.raises(sandbox.SceneError) as refused:
        sandbox.simulate(sandbox.load_scene(scene))
    (problem,) = refused.value.problems
    assert (problem.code, problem.path, problem.hint) == expected
    assert message in problem.message


def test_a_name_close_to_that_of_an_unreadable_element_gets_it_as_suggestion() -> None:
    scene = copy.deepcopy(SCENES["pair"])
    scene["bodies"][0]["shapes"][0]["type"] = "cirle"
    scene["joints"][0]["b"] = "dics"
    with pytest.raises(sandbox.SceneError) as caught:
        sandbox.load_scene(scene)
    found = next(each for each in caught.value.problems if each.code == "name-not-found")
    assert found.hint == "'disc'"
    assert not found.allowed


def test_a_diagnostic_without_a_known_code_cannot_be_made() -> None:
    with pytest.raises(KeyError, match="no diagnostic has the code 'my words'"):
        Problem("my words", "$")
    with pytest.raises(KeyError, match="no diagnostic has the code 'none'"):
        sandbox.SandboxError("my words", code="none")
