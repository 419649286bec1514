"""What a session does with what is asked of it; no transport, no browser."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.errors import Problem, SceneError
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import load_scene, read_scene
from sandbox.show.frames import HEAD
from sandbox.show.page import quantities
from sandbox.show.session import FASTEST, FRAME, Found, Session

PULLED: dict[str, Any] = {
    "name": "pulled", "parameters": {"load": "200 g", "pull": "3 N"}, "run": {"duration": 10},
    "gravity": [0, -9.81],
    "bodies": [{"name": "frame", "motion": "fixed"},
               {"name": "weight", "at": [0, -0.2], "mass": "=load",
                "shapes": [{"type": "circle", "radius": "10 mm"}]},
               {"name": "ball", "at": [0.1, -0.3], "mass": "50 g",
                "shapes": [{"type": "circle", "radius": "10 mm"}]},
               {"name": "floor", "motion": "fixed", "at": [0.1, -0.32],
                "shapes": [{"type": "box", "size": [0.1, 0.02]}]}],
    "tendons": [{"name": "cord", "guides": [{"body": "weight"}, {"body": "frame"}]}],
    "drives": [{"type": "pull", "name": "winch", "tendon": "cord", "value": "=pull"}],
    "expect": [{"mean": "cord.tension", "is": "=pull", "within": "1 %"}],
}


GUIDED: dict[str, Any] = {
    "drives": [*PULLED["drives"], {"type": "force", "name": "blow", "body": "ball",
                                    "direction": [0, 1], "value": 0}],
    "controllers": [{"type": "pid", "name": "rest", "reads": "weight.y", "writes": "blow",
                     "target": -0.2, "kp": 0.1}],
}


def session(tmp_path: Path, **scene: Any) -> Session:
    def read(overrides: Mapping[str, Any]) -> Found:
        return Found(read_scene({**PULLED, **scene}, overrides=overrides))

    made = Session(read, {}, lambda name: tmp_path / name)
    made.playing = True
    return made


def ask(made: Session, **message: Any) -> list[dict[str, Any]]:
    return made.hear(json.dumps(message))


def told(made: Session) -> dict[str, Any]:
    """A frame by its names."""
    numbers = np.frombuffer(made.frame(), "<f4").astype(float)
    found: dict[str, Any] = dict(zip(HEAD, numbers, strict=False))
    at = len(HEAD)
    for name, width in made.head()["head"]["layout"]:
        found[name] = numbers[at:at + width]
        at += width
    found["watched"] = numbers[at:at + len(made.frames.watched)]
    at += len(made.frames.watched)
    end = at + 6 * int(found["contacts"])
    places = numbers[end:].reshape(-1, int(found["trail"]), 2) if found["trail"] else numbers[end:]
    return {**found, "rows": numbers[at:end].reshape(-1, 6), "places": places}


def play(made: Session, seconds: float) -> dict[str, Any]:
    for _ in range(round(seconds / FRAME)):
        made.advance(FRAME, budget=10.0)
    return told(made)


def test_time_passes_at_the_asked_speed_and_a_frame_tells_the_run(tmp_path: Path) -> None:
    made = session(tmp_path)
    frame = play(made, 0.5)
    assert frame["t"] == pytest.approx(0.5 + 5e-4, abs=1e-3)
    assert frame["rate"] == pytest.approx(1.0, abs=0.06)  # a mean that began at 0
    assert frame["watched"] == pytest.approx([3.0])
    live = made.live
    assert frame["pose"][:3] == pytest.approx(
        [live["weight.x"], live["weight.y"], live["weight.angle"]], abs=1e-6)
    [row] = frame["rows"]  # the ball lies on the floor: its weight
    assert row[3] * (1 if row[4] == 2 else -1) == pytest.approx(0.05 * 9.81, rel=1e-5)
    ask(made, speed=0.5)
    assert play(made, 0.5)["t"] == pytest.approx(0.75, abs=2e-3)
    ask(made, speed=1e9)
    assert made.speed == FASTEST


def test_it_pauses_once_at_the_end_of_the_scene_and_says_so(tmp_path: Path) -> None:
    made = session(tmp_path, run={"duration": 0.2})
    while made.playing:
        made.advance(FRAME, budget=10.0)
    assert made.live.time == pytest.approx(0.2)
    assert "ends at 0.2 s" in made.status()["status"]["note"]
    ask(made, speed=0.02)
    ask(made, do="run")
    assert made.status()["status"]["note"] == ""
    made.advance(FRAME)  # less than a step
    assert made.playing
    made.advance(1.0)
    assert made.playing
    ask(made, do="reset")
    made.playing, made.speed = True, 1.0
    play(made, 0.3)
    assert not made.playing


def test_what_does_not_fit_the_budget_is_left_out_and_the_rate_says_so(tmp_path: Path) -> None:
    made = session(tmp_path)
    for _ in range(60):
        made.advance(FRAME, budget=0.0)
    assert made.live.time < 0.5
    assert told(made)["rate"] < 0.7


def test_contact_forces_are_the_mean_of_the_steps_since_the_last_frame(tmp_path: Path) -> None:
    """While the ball is thrown on the floor: m dv = (F - m g) dt, whatever single steps carry."""
    made = session(tmp_path)
    play(made, 0.1)
    ask(made, drag=["ball", 0, 0], to=[0.1, -0.2])
    play(made, 0.2)
    ask(made, drop=1)
    before, steps = made.live["ball.vy"], made.live.steps
    frame = told(made)
    while not len(frame["rows"]):
        before, steps = made.live["ball.vy"], made.live.steps
        made.advance(FRAME, budget=10.0)
        frame = told(made)
    dt = (made.live.steps - steps) * made.scene.run.step
    [row] = frame["rows"]
    force = row[3] * (1 if row[4] == 2 else -1)
    change = 0.05 * (made.live["ball.vy"] - before + 9.81 * dt)
    # velocities read are means of two steps: half a step of weight at each end
    assert force * dt == pytest.approx(change, abs=2 * 0.05 * 9.81 * made.scene.run.step)
    assert force > 2 * 0.05 * 9.81


def test_arrows_that_nobody_looks_at_are_not_worked_out_and_those_looked_at_are(
    tmp_path: Path,
) -> None:
    made = session(tmp_path)
    made.hear('{"layers": ["bodies"]}')
    before = told(made)["moving"]
    ask(made, set="winch", value=0.0)
    assert np.array_equal(play(made, 0.1)["moving"], before)
    made.hear('{"layers": ["bodies", "velocity"]}')
    frame = play(made, 0.1)
    index = [at for at, _ in enumerate(frame["moving"]) if abs(frame["moving"][at]) > 0.5]
    assert frame["moving"][index] == pytest.approx([made.live["weight.vy"]], rel=1e-3)
    made.hear('{"do": "reset"}')
    assert made.frames.layers == {"bodies", "velocity"}


def test_a_trace_has_what_lies_between_two_frames(tmp_path: Path) -> None:
    made = session(tmp_path, view={"traces": [{"body": "weight", "at": [0.01, 0]}]})
    ask(made, set="winch", value=0.0)
    assert len(told(made)["places"]) == 0
    made.hear('{"layers": ["traces"]}')
    play(made, 0.05)
    before = made.live["weight.y"]
    made.advance(FRAME, budget=10.0)
    (way, *_) = told(made)["places"]
    assert len(way) == 8
    assert way[:, 0] == pytest.approx(np.full(8, 0.01), abs=1e-7)
    assert (np.diff(way[:, 1]) < 0).all()
    assert before > way[0, 1]
    assert way[-1, 1] == pytest.approx(made.live["weight.y"], abs=1e-7)


def test_a_drive_is_set_while_it_runs_a_parameter_of_it_too(tmp_path: Path) -> None:
    made = session(tmp_path)
    play(made, 0.1)
    assert ask(made, set="winch", value=2.5, id=7) == []
    assert play(made, 0.05)["watched"] == pytest.approx([2.5])
    assert told(made)["ack"] == 7
    _, controls = ask(made, set="parameters.pull", value="4 N", id=8)
    assert controls["controls"][1]["value"] == 4.0
    frame = play(made, 0.05)
    assert frame["watched"] == pytest.approx([4.0])
    assert frame["t"] > 0.19  # it went on
    assert '--set "parameters.pull=4 N"' in made.line()


def test_a_parameter_that_shapes_the_scene_begins_it_anew(tmp_path: Path) -> None:
    made = session(tmp_path)
    play(made, 0.1)
    kinds = [key for answer in ask(made, set="parameters.load", value=0.3) for key in answer]
    assert kinds == ["head", "status"]
    assert made.live.time == pytest.approx(5e-4)
    assert made.live.scene.bodies[1].mass == 0.3


def test_pulled_by_the_hand(tmp_path: Path) -> None:
    made = session(tmp_path)
    ask(made, drag=["ball", 0.0, 0.0], to=[0.1, -0.2])
    frame = play(made, 0.6)
    assert frame["hand"] == 2
    # the spring hangs with its load: k = m w^2, m g / k = g / w^2
    assert frame["from_y"] == pytest.approx(-0.2 - 9.81 / 40**2, abs=1e-4)
    assert frame["force_y"] == pytest.approx(0.05 * 9.81, rel=1e-3)
    ask(made, drop=1)
    assert told(made)["hand"] == -1
    assert play(made, 0.1)["force_y"] == 0


def test_step_back_and_reset(tmp_path: Path) -> None:
    made = session(tmp_path)
    ask(made, do="pause")
    steps = made.live.steps
    ask(made, do="step")
    assert made.live.steps == steps + round(FRAME / 5e-4)
    ask(made, set="winch", value=1.0)
    ask(made, do="run")
    play(made, 0.2)
    there = made.live.time, made.live["weight.y"]
    ask(made, do="step")
    ask(made, do="back")
    assert not made.playing
    assert (made.live.time, made.live["weight.y"]) == there
    assert told(made)["watched"] == pytest.approx([1.0])
    ask(made, do="back")
    assert made.live.time == pytest.approx(there[0] - 33 * 5e-4)
    ask(made, do="reset")
    assert made.live.inputs == []
    assert told(made)["watched"] == pytest.approx([3.0])


def test_going_back_gives_parameters_and_targets_what_they_were(tmp_path: Path) -> None:
    """What is set after the instant gone back to is not in the run any more, nor on the sliders."""
    def values(answers: list[dict[str, Any]]) -> dict[str, float]:
        [found] = [each["controls"] for each in answers if "controls" in each]
        return {each["name"]: each["value"] for each in found}

    made = session(tmp_path, **GUIDED)
    play(made, 0.1)
    ask(made, set="parameters.pull", value=2.0)
    play(made, 0.1)
    ask(made, set="parameters.pull", value=1.0)
    ask(made, set="rest.target", value=0.5)
    [_, shown] = ask(made, set="rest.active", value=0), ask(made, set="parameters.pull", value=1.5)
    assert values(shown)["rest.target"] == 0.5
    assert values(shown)["rest.active"] == 0
    play(made, 0.01)
    shown = ask(made, do="back")
    assert values(shown) | {"winch": 2.0} == values(shown)
    assert [values(shown)[name] for name in ("parameters.pull", "rest.target", "rest.active")] == [
        2.0, -0.2, 1.0]
    assert "pull=2.0" in ask(made, save="scene")[0]["said"]
    while made.live.time > 0.1:
        shown = ask(made, do="back")
    assert values(shown)["parameters.pull"] == values(shown)["winch"] == 3.0
    assert ask(made, save="scene")[0]["said"] == ""
    ask(made, set="parameters.pull", value=1.0)
    assert values(ask(made, do="reset"))["winch"] == 1.0
    made.live.step(100)
    assert values(ask(made, do="back"))["parameters.pull"] == 1.0


def test_going_back_to_when_a_body_was_pulled_lets_it_go(tmp_path: Path) -> None:
    """Nobody holds it any more: no force may act on it that the picture does not show."""
    made = session(tmp_path)
    ask(made, drag=["weight", 0.0, 0.0], to=[0.1, -0.1])
    there = play(made, 0.1)["t"]
    play(made, 0.1)
    ask(made, drop=1)
    play(made, 0.1)
    while told(made)["t"] > there:
        ask(made, do="back")
    assert told(made)["hand"] == -1
    ask(made, do="step")
    if made.live.steps % 2:  # a run has samples of every other step
        made.live.step(1)
    arrays = made.live.latest()
    assert np.abs(arrays["drive_value"][-1, 1:]).max() == 0
    assert arrays["body_acceleration"][-1, 1, 0] == pytest.approx(
        arrays["tendon_tension"][-1, 0] / 0.2 * -arrays["body_pose"][-1, 1, 0] / np.hypot(
            *arrays["body_pose"][-1, 1, :2]), rel=1e-3)
    assert np.array_equal(simulate(made.live.played()).arrays["body_pose"][-1, 1],
                          arrays["body_pose"][-1, 1])


def test_what_was_played_is_saved_as_a_scene_and_as_a_run(tmp_path: Path) -> None:
    made = session(tmp_path)
    play(made, 0.1)
    ask(made, drag=["ball", 0.005, 0.0], to=[0.15, -0.25])
    play(made, 0.1)
    ask(made, set="winch", value=1.5)
    y = play(made, 0.1)["pose"][1]
    [answer] = ask(made, save="scene")
    assert answer["file"] == "pulled_played.json"
    scene = json.loads(answer["text"])
    assert "expect" not in scene
    _, save = ask(made, save="run")
    assert "the run is in" in save()["said"]
    run = Recording.load(tmp_path / "pulled_played")
    assert run.complete
    assert run.arrays["body_pose"][-1, 1, 1] == pytest.approx(y, abs=1e-3)
    assert set(run.match("hand*.value")) == {"hand1.x.value", "hand1.y.value"}
    first = (tmp_path / "pulled_played" / "run.npz").read_bytes()
    ask(made, save="run")[1]()
    again = Recording.load(tmp_path / "pulled_played")
    assert all(again.arrays[key].tobytes() == array.tobytes() for key, array in run.arrays.items())
    assert first


@pytest.mark.parametrize("scene", [
    "capstan", "dog_clutch", "hydraulic_press", "linear_actuator", "motor_line", "planetary",
    "servo_arm", "shape_change", "tendon_stiffness", "trebuchet"])
def test_scenes_of_all_kinds_run_again_to_the_same_bits(scene: str, tmp_path: Path) -> None:
    made = Session(lambda overrides: Found(read_scene(scene, overrides=overrides)), {},
                   lambda name: tmp_path / name)
    bodies = made.scene.bodies
    free = [body.name for body in bodies if body.motion == "dynamic"]
    play(made, 0.05)
    assert ask(made, drag=[free[-1], 0.001, 0.002], to=[0.05, 0.05]) == []
    play(made, 0.05)
    for control in made.head()["head"]["controls"]:
        if control["kind"] in ("drive", "target"):
            assert ask(made, set=control["name"],
                       value=0.5 * (control["low"] + control["high"])) == []
    play(made, 0.05)
    ask(made, drop=1)
    made.advance(FRAME, budget=10.0)
    poses = made.live.latest()["body_pose"][-1]
    [answer] = ask(made, save="scene")
    again = simulate(load_scene(json.loads(answer["text"]), overrides={
        "run.sample_rate": 1 / made.scene.run.step}))
    # a scheduled body's last step leads on, and a run's end is where its path ends
    own = [i for i, body in enumerate(bodies) if body.motion != "scheduled"]
    assert np.array_equal(again.arrays["body_pose"][-1, own], poses[own])


def test_meters_are_what_was_asked_for(tmp_path: Path) -> None:
    made = session(tmp_path)
    [answer] = ask(made, watch=["ball.y", "cord.length", "ball.y"])
    assert [each["name"] for each in answer["watched"]] == ["ball.y", "cord.length"]
    assert {each["unit"] for each in answer["watched"]} == {"m"}
    assert told(made)["watched"] == pytest.approx([-0.3, 0.2], abs=1e-3)
    ask(made, do="reset")
    assert made.frames.watched == ["ball.y", "cord.length"]


def test_a_view_opens_with_the_meters_of_the_scene(tmp_path: Path) -> None:
    """Not with what may be looked at of any scene, and without what a run tells in the end."""
    view = {"meters": [
        {"of": "=cord.tension - 2", "unit": "N", "title": "more than 2 N", "range": [0, 2]},
        "ball/floor.normal", "winch.work", {"of": ["[wb]*.y"], "style": "number"}]}
    made = session(tmp_path, view=view)
    head = made.head()["head"]
    assert head["watched"] == ["=cord.tension - 2", "ball/floor.normal", "weight.y", "ball.y"]
    units = {one["name"]: one["unit"] for one in head["quantities"]}
    assert [units[name] for name in head["watched"]] == ["N", "N", "m", "m"]
    assert [(one["title"], one["range"], one["number"]) for one in head["meters"]] == [
        ("more than 2 N", (0.0, 2.0), 0), ("", None, 0), ("", None, 1)]
    tension, pressed, _, height = play(made, 0.1)["watched"]
    assert (tension, pressed, height) == pytest.approx((1.0, 0.05 * 9.81, -0.3), abs=1e-3)
    [answer] = ask(made, watch=["=cord.tension - 2", "ball.x"])
    assert [one["unit"] for one in answer["watched"]] == ["N", "m"]
def test_what_is_looked_at_first_comes_first(tmp_path: Path) -> None:
    """The view, the page and the words of ``sandbox plot`` begin with the same."""
    made = session(tmp_path)
    usual = made._look.catalogue.usual
    assert usual["tendon"] == made.frames.watched == ["cord.tension"]
    assert usual["body"] == ["weight.y", "ball.y"]
    shown = [each["name"] for each in made.head()["head"]["quantities"]]
    ball = [name for name in shown if name.startswith("ball.")]
    assert ball[:3] == ["ball.x", "ball.y", "ball.contact.normal"]
    assert sorted(shown) == sorted(made.live.names())
    assert quantities(made._look).index("winch.value") < quantities(made._look).index("winch.work")


def test_meters_of_what_is_worked_out_after_a_run_are_left_out(tmp_path: Path) -> None:
    made = Session(lambda overrides: Found(read_scene("slider_crank", overrides=overrides)), {},
                   lambda name: tmp_path / name)
    names = {each["name"] for each in made.head()["head"]["quantities"]}
    meters = {meter.name for meter in made.scene.meters}
    assert meters - names
    assert set(made.frames.watched) <= names
    assert np.isfinite([made.live[name] for name in made.frames.watched]).all()


@pytest.mark.parametrize(("message", "said"), [
    ({"set": "winhc", "value": 1.0}, "did you mean 'winch'"),
    ({"set": "winch", "value": "fast"}, "not a number with a unit"),
    ({"set": "winch", "value": 1e40}, "as a value of 'winch'"),
    ({"set": "parameters.pul", "value": 1}, "did you mean 'parameters.pull'"),
    ({"set": "parameters.pull", "value": "3 mm"}, "unit of length"),
    ({"set": "parameters.load", "value": -1}, "mass"),
    ({"set": "parameters.pull", "value": [1]}, "no value"),
    ({"set": "parameters.pull", "value": ["long" * 9000]}, "no value"),
    ({"set": "winch", "value": "long" * 9000}, "not a number with a unit"),
    ({"drag": ["floor", 0, 0], "to": [0, 0]}, "moves freely"),
    ({"drag": ["ball", 0, None], "to": [0, 0]}, "no finite number"),
    ({"drag": ["ball", 0, 0], "to": [1e308, 0]}, "too large to be computed with"),
    ({"drag": ["ball", -1e308, 1e308], "to": [0, 0]}, "too large to be computed with"),
    ({"watch": ["ball.yy"]}, "ball.y"),
    ({"watch": [f"ball.{i}" for i in range(20)]}, "no more than"),
    ({"do": "runn"}, "did you mean 'run'"),
    ({"hello": 1}, "nothing to do"),
    ([1, 2], "JSON object"),
])
def test_what_is_wrong_is_answered_in_a_line_and_changes_nothing(
    tmp_path: Path, message: Any, said: str,
) -> None:
    made = session(tmp_path)
    before = made.live, made.overrides, made.live.steps
    [answer] = made.hear(json.dumps(message))
    assert said in answer["error"]
    assert "\n" not in answer["error"]
    assert len(answer["error"]) < 300
    assert before == (made.live, made.overrides, made.live.steps)
    assert made.live.inputs == []


@pytest.mark.parametrize("text", ["", "{", "[" * 5000, b"\xff", '{"id": 1e400}', "NaN"])
def test_what_is_no_message_does_no_harm(tmp_path: Path, text: str | bytes) -> None:
    assert "error" in session(tmp_path).hear(text)[0]


@pytest.mark.parametrize("error", [KeyError("path"), IndexError("9"), ZeroDivisionError()])
def test_an_error_that_nobody_foresaw_is_answered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: Exception,
) -> None:
    made = session(tmp_path)

    def fail(_: Any) -> None:
        raise error

    monkeypatch.setattr(made.hand, "drop", lambda: fail(0))
    [answer] = ask(made, drop=1, id=5)
    assert type(error).__name__ in answer["error"]
    assert made.ack == 5


def test_a_file_that_was_changed_is_read_anew_or_its_faults_are_told(tmp_path: Path) -> None:
    data = {**PULLED}
    made = Session(lambda overrides: Found(read_scene(data, overrides=overrides)), {},
                   lambda name: tmp_path / name)
    ask(made, set="parameters.pull", value="4 N")
    play(made, 0.1)
    data["gravity"] = [0, "down"]
    live = made.live
    assert not made.reload()
    assert "gravity" in made.status()["status"]["trouble"]
    assert made.live is live
    data["gravity"] = [0, -1.6]
    assert made.reload()
    assert made.scene.gravity == (0, -1.6)
    assert made.live["winch.value"] == 4.0  # today's value is kept
    assert made.status()["status"]["trouble"] == ""


def test_a_parameter_that_the_file_has_no_more_does_not_keep_it_from_being_read(
    tmp_path: Path,
) -> None:
    data = {**PULLED}
    made = Session(lambda overrides: Found(read_scene(data, overrides=overrides)), {},
                   lambda name: tmp_path / name)
    ask(made, set="parameters.pull", value="4 N")
    ask(made, set="parameters.load", value="0.3 kg")
    data["parameters"] = {"load": "200 g"}
    assert not made.reload()  # the drive still asks for it
    assert "pull" in made.status()["status"]["trouble"]
    assert set(made.overrides) == {"parameters.pull", "parameters.load"}
    data["drives"] = [{**PULLED["drives"][0], "value": 3}]
    data["expect"] = []
    assert made.reload()
    assert made.overrides == {"parameters.load": "0.3 kg"}
    assert made.live["winch.value"] == 3.0


def test_a_value_that_cannot_be_played_with_is_not_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = session(tmp_path)

    def refused(*_: Any) -> Recording:
        raise SceneError([Problem("not with this", "")])

    monkeypatch.setattr("sandbox.show.session.looked_at", refused)
    assert ask(made, set="parameters.load", value="0.3 kg") == [{"error": "not with this"}]
    assert made.overrides == {}


def test_a_run_that_diverges_or_is_stopped_says_so_and_begins_anew(tmp_path: Path) -> None:
    made = session(tmp_path, events=[
        {"name": "enough", "when": "=weight.y < -0.25", "stop": "pass"}])
    ask(made, set="winch", value=0.0)
    play(made, 1.0)
    assert not made.playing
    assert "'enough' stopped it" in made.status()["status"]["trouble"]
    assert "run is over" in ask(made, set="winch", value=1.0)[0]["error"]
    ask(made, do="reset")
    ask(made, do="run")
    assert made.playing
    wild = session(tmp_path, drives=[{"type": "force", "name": "kick", "body": "ball",
                                      "direction": [1, 0], "value": 0}], expect=[])
    ask(wild, set="kick", value=1e9)
    play(wild, 0.5)
    assert "ball" in wild.trouble
    assert not wild.playing
    why = r"diverged at t = .* s: ball: its motion has run away"
    assert re.search(why, wild.status()["status"]["trouble"])
    for what in ({"set": "kick", "value": 1.0}, {"drag": ["ball", 0, 0], "to": [0, 0]}):
        [answer] = ask(wild, **what)
        assert re.search("the run is over: .*" + why, answer["error"])
    ask(wild, do="reset")
    assert wild.status()["status"]["trouble"] == ""
    assert wild.live["kick.value"] == 0.0


def test_what_the_check_warns_of_is_told_with_the_scene_that_it_is_of(tmp_path: Path) -> None:
    def read(overrides: Mapping[str, Any]) -> Found:
        loaded = read_scene(PULLED, overrides=overrides)
        light = loaded.scene.parameters["load"] < 0.1, loaded.scene.parameters["pull"] < 1
        return Found(loaded, [text for text, so in zip(("a", "b"), light, strict=True) if so])

    made = Session(read, {}, lambda name: tmp_path / name)
    assert made.status()["status"]["warnings"] == []
    head, status = ask(made, set="parameters.load", value="50 g")  # begins anew
    assert "head" in head
    assert status["status"]["warnings"] == ["a"]
    status, _ = ask(made, set="parameters.pull", value="0.5 N")  # goes on
    assert status["status"]["warnings"] == ["a", "b"]
    ask(made, set="parameters.load", value="200 g")
    assert made.status()["status"]["warnings"] == ["b"]


def test_sliders_keep_from_where_to_where_they_go_until_the_file_changes(tmp_path: Path) -> None:
    def spans(answer: dict[str, Any]) -> dict[str, tuple[float, float]]:
        return {each["name"]: (each["low"], each["high"]) for each in answer["controls"]}

    data = {**PULLED}
    made = Session(lambda overrides: Found(read_scene(data, overrides=overrides)), {},
                   lambda name: tmp_path / name)
    before = spans(made.head()["head"])
    assert before == {"parameters.load": (0.0, 400.0), "parameters.pull": (0.0, 6.0),
                      "winch": (0.0, 6.0)}
    [_, told] = ask(made, set="parameters.pull", value="1000 N")
    assert spans(told) == before
    [head, _] = ask(made, set="parameters.load", value="300 g")
    assert spans(head["head"]) == before
    [_, told] = ask(made, do="reset")
    assert spans(told) == before
    data["parameters"] = {"load": "100 g", "pull": "3 N"}
    made.overrides.clear()
    assert made.reload()
    assert spans(made.head()["head"])["parameters.load"] == (0.0, 200.0)


def test_a_drive_takes_units_of_its_dimension_and_answers_what_that_is(tmp_path: Path) -> None:
    made = session(tmp_path, **GUIDED)
    assert ask(made, set="winch", value="0.004 kN") == [{"given": {"name": "winch", "value": 4.0}}]
    assert play(made, 0.1)["drive"][0] == pytest.approx(4.0)
    assert ask(made, set="rest.target", value="-150 mm") == [
        {"given": {"name": "rest.target", "value": -0.15}}]
    said = ask(made, set="winch", value="3 rpm")[0]["error"]
    assert said.startswith("'winch': 'rpm' is a unit of angular speed, but this is a force; "
                           "allowed: a number, or one with a unit: ")
    assert "'N'" in said
    assert "did you mean 'kN'" in ask(made, set="winch", value="3 kn")[0]["error"]
    for name, text, wrong in (("rest.active", "1 N", "takes no unit"), ("winch", "much", "much"),
                              ("winsh", "3", "winsh"), ("winsh", "3 N", "winsh")):
        assert wrong in ask(made, set=name, value=text)[0]["error"]
    assert made.live.inputs[-1].value == -0.15  # nothing else was set


def test_a_meter_that_cannot_be_read_while_it_runs_is_named_with_the_reason(
    tmp_path: Path,
) -> None:
    view = {"meters": ["weight.y", {"of": ["winch.value", "weight.contact.fx"]}]}
    made = session(tmp_path, view=view)
    reason = "'weight.contact.fx' is worked out after a run and cannot be read while it runs"
    status = made.status()["status"]
    assert status["warnings"] == []
    assert status["left_out"] == [f"a curve of a meter of the view is left out: {reason}"]
    head = made.head()["head"]
    assert head["watched"] == ["weight.y", "winch.value"]
    alone = session(tmp_path, view={"meters": ["weight.y", "weight.contact.fx"]})
    assert alone.status()["status"]["left_out"] == [f"a meter of the view is left out: {reason}"]
    assert alone.head()["head"]["watched"] == ["weight.y"]
    assert "weight.contact.fx" in head["late"]
    assert not {"weight.y", *(each["name"] for each in head["quantities"])} & set(head["late"])
    assert ask(made, watch=["weight.y", "weight.contact.fx"]) == [{"error": reason}]


def test_pairs_are_found_by_name_and_by_pattern_and_stay_after_a_reset(tmp_path: Path) -> None:
    """One that touched is offered; what is asked for is what a simulation reads."""
    made = session(tmp_path)
    offered = {each["name"]: each["unit"] for each in made.head()["head"]["pairs"]}
    assert offered == {"ball/floor.normal": "N", "ball/floor.tangential": "N"}
    [answer] = ask(made, watch=["*/floor.normal", "floor/ball.tangential", "weight.y"])
    names = [one["name"] for one in answer["watched"]]
    assert {"ball/floor.normal", "floor/ball.tangential", "weight.y"} <= set(names)
    assert {one["unit"] for one in answer["watched"][:2]} == {"N"}
    seen = dict(zip(names, play(made, 0.1)["watched"], strict=True))
    assert seen["ball/floor.normal"] == pytest.approx(0.05 * 9.81, abs=1e-3)
    ask(made, do="reset")
    assert made.frames.watched == names
    for wrong, said in (("ball/flor.normal", "did you mean 'ball/floor.normal'"),
                        ("*/floor.norml", "no quantity fits")):
        [answer] = ask(made, watch=[wrong])
        assert said in answer["error"]


def test_it_begins_at_the_speed_of_the_view_and_keeps_what_is_chosen(tmp_path: Path) -> None:
    made = session(tmp_path, view={"speed": 0.25})
    assert made.status()["status"]["speed"] == 0.25
    assert made.head()["head"]["view"]["speed"] == 0.25
    ask(made, speed=2)
    ask(made, set="parameters.load", value="300 g")  # which begins it anew
    assert made.speed == 2
    assert session(tmp_path, view={"speed": 100}).speed == FASTEST
