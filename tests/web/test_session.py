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
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import read_scene
from sandbox.web.session import FRAME, MAX_SPEED, Found, Session

from .test_frames import decoded

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


def of_file(data: dict[str, Any], tmp_path: Path) -> Session:
    """A session of a scene that may be changed later."""
    return Session(lambda overrides: Found(read_scene(data, overrides=overrides)), {},
                   lambda name: tmp_path / name)


def ask(made: Session, **message: Any) -> list[dict[str, Any]]:
    return made.handle(json.dumps(message))


def told(made: Session) -> dict[str, Any]:
    made.relisted()
    return decoded(made.frame(), made.frames)


def values(answers: list[dict[str, Any]]) -> dict[str, float]:
    """What sliders are set to by an answer."""
    [found] = [each["controls"] for each in answers if "controls" in each]
    return {each["name"]: each["value"] for each in found}


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
    place = [body.name for body in made.scene.bodies].index("weight")
    assert frame["pose"][place] == pytest.approx(
        [live["weight.x"], live["weight.y"], live["weight.angle"]], abs=1e-6)
    [row] = frame["contacts"]  # the ball lies on the floor: its weight
    on = row[1] // len(made.scene.bodies)
    assert row[5] * (1 if on == 2 else -1) == pytest.approx(0.05 * 9.81, rel=1e-5)
    ask(made, speed=0.5)
    assert play(made, 0.5)["t"] == pytest.approx(0.75, abs=2e-3)
    ask(made, speed=1e9)
    assert made.speed == MAX_SPEED


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
    assert '--set "parameters.pull=4 N"' in ask(made, save="scene")[0]["said"]


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


def test_going_back_gives_parameters_and_targets_what_they_were(tmp_path: Path) -> None:
    """What is set after the instant gone back to is not in the run any more, nor on the sliders."""
    made = session(tmp_path, **GUIDED)
    play(made, 0.1)
    ask(made, set="parameters.pull", value=2.0)
    play(made, 0.1)
    for name, value in (("parameters.pull", 1.0), ("rest.target", 0.5), ("rest.active", 0)):
        ask(made, set=name, value=value)
    play(made, 0.01)
    shown = values(ask(made, do="back"))
    assert [shown[name] for name in ("winch", "parameters.pull", "rest.target", "rest.active")] == [
        2.0, 2.0, -0.2, 1.0]
    assert "pull=2.0" in ask(made, save="scene")[0]["said"]
    while made.live.time > 0.1:
        shown = values(ask(made, do="back"))
    assert shown["parameters.pull"] == shown["winch"] == 3.0
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
    made.live.step(made.live.steps % 2)  # a run has samples of every other step
    arrays = made.live.latest()
    assert np.abs(arrays["drive_value"][-1, 1:]).max() == 0
    assert np.array_equal(simulate(made.live.played()).arrays["body_pose"][-1, 1],
                          arrays["body_pose"][-1, 1])


def test_what_was_played_is_saved_as_a_scene_and_as_a_run(tmp_path: Path) -> None:
    made = session(tmp_path)
    play(made, 0.1)
    ask(made, drag=["ball", 0.005, 0.0], to=[0.15, -0.25])
    play(made, 0.1)
    ask(made, set="winch", value=1.5)
    y = play(made, 0.1)["pose"][[body.name for body in made.scene.bodies].index("weight"), 1]
    [answer] = ask(made, save="scene")
    assert answer["file"] == "pulled_played.json"
    assert "expect" not in json.loads(answer["text"])
    _, save = ask(made, save="run")
    assert "the run is in" in save()["said"]
    run = Recording.load(tmp_path / "pulled_played")
    assert run.complete
    assert run.arrays["body_pose"][-1, 1, 1] == pytest.approx(y, abs=1e-3)
    assert set(run.match("hand*.value")) == {"hand1.x.value", "hand1.y.value"}


def test_a_view_opens_with_the_meters_of_the_scene(tmp_path: Path) -> None:
    """Not with what may be looked at of any scene, and without what a run tells in the end."""
    made = session(tmp_path, view={"meters": [
        {"of": "=cord.tension - 2", "unit": "N", "title": "more than 2 N", "range": [0, 2]},
        "ball/floor.normal", {"of": ["[wb]*.y", "weight.contact.fx"], "style": "number"}]})
    head = made.head()["head"]
    assert head["watched"] == ["=cord.tension - 2", "ball/floor.normal", "weight.y", "ball.y"]
    assert [(one["title"], one["range"], one["number"]) for one in head["meters"]] == [
        ("more than 2 N", (0.0, 2.0), 0), ("", None, 0), ("", None, 1)]
    tension, pressed, _, height = play(made, 0.1)["watched"]
    assert (tension, pressed, height) == pytest.approx((1.0, 0.05 * 9.81, -0.3), abs=1e-3)
    reason = "'weight.contact.fx' is computed after the run and cannot be read during it"
    assert made.status()["status"]["left_out"] == [
        f"a curve of a meter of the view is left out: {reason}"]
    assert ask(made, watch=["weight.y", "weight.contact.fx"]) == [{"error": reason}]


@pytest.mark.parametrize(("message", "said"), [
    ({"set": "winhc", "value": 1.0}, "did you mean 'winch'"),
    ({"set": "winch", "value": "fast"}, "not a number with a unit"),
    ({"set": "parameters.pul", "value": 1}, "did you mean 'parameters.pull'"),
    ({"set": "parameters.pull", "value": "3 mm"}, "unit of length"),
    ({"set": "parameters.load", "value": -1}, "mass"),
    ({"set": "parameters.pull", "value": [1]}, "expected a number"),
    ({"set": "winch", "value": "long" * 9000}, "not a number with a unit"),
    ({"drag": ["floor", 0, 0], "to": [0, 0]}, "moves freely"),
    ({"drag": ["ball", 0, None], "to": [0, 0]}, "two finite numbers"),
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
    [answer] = made.handle(json.dumps(message))
    assert said in answer["error"]
    assert "\n" not in answer["error"]
    assert len(answer["error"]) < 300
    assert before == (made.live, made.overrides, made.live.steps)
    assert made.live.inputs == []


@pytest.mark.parametrize("text", ["", "[" * 5000, b"\xff"])
def test_what_is_no_message_does_no_harm(tmp_path: Path, text: str | bytes) -> None:
    assert "error" in session(tmp_path).handle(text)[0]


def test_an_unexpected_error_is_answered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = session(tmp_path)
    monkeypatch.setattr(made.hand, "drop", lambda: {}["path"])
    assert "KeyError('path')" in ask(made, drop=1, id=5)[0]["error"]
    assert made.ack == 5


def test_a_file_that_was_changed_is_read_anew_or_its_faults_are_told(tmp_path: Path) -> None:
    data = {**PULLED}
    made = of_file(data, tmp_path)
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
    ask(made, set="parameters.load", value="0.3 kg")
    data |= {"drives": [{**PULLED["drives"][0], "value": 3}], "expect": [],
             "parameters": {"load": "200 g"}}  # one that the file has no more keeps nothing back
    assert made.reload()
    assert made.overrides == {"parameters.load": "0.3 kg"}


def test_a_run_that_diverges_or_is_stopped_says_so_and_begins_anew(tmp_path: Path) -> None:
    made = session(tmp_path, drives=GUIDED["drives"], events=[
        {"name": "enough", "when": "=weight.y < -0.25", "stop": "pass"}])
    for name, value, why in (("winch", 0.0, "'enough' stopped it"), (
            "blow", 1e9, "diverged at t = .* s: ball: its motion has run away")):
        ask(made, set=name, value=value)
        play(made, 1.0)
        assert not made.playing
        assert re.search(why, made.status()["status"]["trouble"])
        for what in ({"set": "winch", "value": 1.0}, {"drag": ["ball", 0, 0], "to": [0, 0]}):
            assert re.search(f"the run is over.*{why}", ask(made, **what)[0]["error"])
        ask(made, do="reset")
        ask(made, do="run")
        assert made.playing
        assert made.status()["status"]["trouble"] == ""


def test_what_the_check_warns_of_is_told_with_the_scene_that_it_is_of(tmp_path: Path) -> None:
    def read(overrides: Mapping[str, Any]) -> Found:
        loaded = read_scene(PULLED, overrides=overrides)
        return Found(loaded, [name for name, value in loaded.scene.parameters.items()
                              if value < 0.1])

    made = Session(read, {}, lambda name: tmp_path / name)
    for name, value, told in (("load", "50 g", ["load"]), ("pull", "0.05 N", ["load", "pull"]),
                              ("load", "200 g", ["pull"])):  # begins anew, goes on, anew
        ask(made, set=f"parameters.{name}", value=value)
        assert made.status()["status"]["warnings"] == told


def test_sliders_keep_from_where_to_where_they_go_until_the_file_changes(tmp_path: Path) -> None:
    data = {**PULLED}
    made = of_file(data, tmp_path)

    def spans() -> dict[str, tuple[float, float]]:
        return {each["name"]: (each["low"], each["high"])
                for each in made.head()["head"]["controls"]}

    before = spans()
    assert before == {"parameters.load": (0.0, 400.0), "parameters.pull": (0.0, 6.0),
                      "winch": (0.0, 6.0)}
    for what in ({"set": "parameters.pull", "value": "1000 N"},
                 {"set": "parameters.load", "value": "300 g"}, {"do": "reset"}):
        ask(made, **what)
        assert spans() == before
    data["parameters"] = {"load": "100 g", "pull": "3 N"}
    made.overrides.clear()
    assert made.reload()
    assert spans()["parameters.load"] == (0.0, 200.0)


def test_a_drive_takes_units_of_its_dimension_and_answers_what_that_is(tmp_path: Path) -> None:
    made = session(tmp_path, **GUIDED)
    for name, text, value in (("winch", "0.004 kN", 4.0), ("rest.target", "-150 mm", -0.15)):
        assert ask(made, set=name, value=text) == [{"given": {"name": name, "value": value}}]
    assert play(made, 0.1)["drives"][0] == pytest.approx(4.0)
    for name, text, wrong in (
            ("winch", "3 rpm", "'winch': 'rpm' is a unit of angular speed, but this is a force ("),
            ("winch", "3 kn", "did you mean 'kN'"), ("rest.active", "1 N", "takes no unit"),
            ("winch", "much", "much"), ("winsh", "3", "winsh"), ("winsh", "3 N", "winsh")):
        assert wrong in ask(made, set=name, value=text)[0]["error"]
    assert made.live.inputs[-1].value == -0.15  # nothing else was set


def test_pairs_are_found_by_name_and_by_pattern_and_stay_after_a_reset(tmp_path: Path) -> None:
    """One that touched is offered; what is asked for is what a simulation reads."""
    made = session(tmp_path)
    assert {name: unit for name, unit in made.head()["head"]["units"].items() if "/" in name} == {
        "ball/floor.normal": "N", "ball/floor.tangential": "N"}
    [answer] = ask(made, watch=["*/floor.normal", "floor/ball.tangential", "weight.y"])
    names = [one["name"] for one in answer["watched"]]
    assert {"ball/floor.normal", "floor/ball.tangential", "weight.y"} <= set(names)
    seen = dict(zip(names, play(made, 0.1)["watched"], strict=True))
    assert seen["ball/floor.normal"] == pytest.approx(0.05 * 9.81, abs=1e-3)
    ask(made, do="reset")
    assert made.frames.watched == names
    assert "did you mean 'ball/floor.normal'" in ask(made, watch=["ball/flor.normal"])[0]["error"]
