"""What an environment is asked for is looked over before anything runs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox import SandboxError, SceneError

from .scenes import pendulum, words


def told(scene: Any = None, **more: Any) -> str:
    with pytest.raises(SceneError) as raised:
        sandbox.gym.make(pendulum() if scene is None else scene, **words(**more))
    return str(raised.value)


def spans(scene: Any, **more: Any) -> dict[str, tuple[float, float]]:
    env = sandbox.gym.make(scene, **more)
    return {**env.task.observe, **env.task.act}


@pytest.mark.parametrize(("wrong", "said"), [
    ({"observe": ["pendulum.angel"]},
     r"observe[0]: unknown quantity 'pendulum.angel'. Did you mean 'pendulum.angle'?"),
    ({"observe": {"pendulum.rat": (0, 1)}}, "observe['pendulum.rat']: unknown quantity"),
    ({"observe": ["motor.work"]}, "'motor.work' is worked out after a run"),
    ({"observe": ["=pendulum.angle +"]}, "observe[0]: "),
    ({"observe": []}, "nothing is observed"),
    ({"observe": {"pendulum.rate": (1, 1)}}, "(1, 1) is no range"),
    ({"act": ["moto"]}, "there is no drive named 'moto'. Did you mean 'motor'?"),
    ({"act": {"motor": "2 N m"}}, "is no range. Allowed: (lowest, highest), in SI"),
    ({"reward": "pendulum.angl"}, "reward: unknown quantity 'pendulum.angl'"),
    ({"every": "1.5 ms"}, "every: 0.0015 s is no whole number of steps of 0.001 s"),
    ({"randomise": {"parameters.mas": [1, 2]}}, 'randomise["parameters.mas"]: cannot set'),
    ({"randomise": {"parameters.mass": "nomal(1 kg, 0.1 kg)"}}, "Did you mean 'normal'?"),
    ({"randomise": {"parameters.mass": ["1 kg", "-1 kg"]}}, "the scene is wrong"),
    ({"randomise": "mass"}, "'mass' does not say what is drawn"),
])
def test_what_is_wrong_is_told_with_a_near_miss(wrong: dict[str, Any], said: str) -> None:
    assert said in told(**wrong)


def test_all_that_is_wrong_is_told_at_once() -> None:
    text = told(observe=["pendulum.angel"], act=["moto"], reward="rat", every="0.1 ms")
    assert text.count("\n") == 3


def test_a_drive_that_the_scene_steers_is_refused() -> None:
    scene = pendulum(controllers=[{"type": "schedule", "name": "program", "writes": "motor",
                                   "value": 1}])
    assert "the drive 'motor' is set by 'program'" in told(scene)
    scene = pendulum(events=[{"name": "off", "at": 0.2, "set": {"motor": 0}}])
    assert "the drive 'motor' is set by 'off'" in told(scene)


def test_a_drive_without_a_range_asks_for_one() -> None:
    scene = pendulum(drives=[{"type": "torque", "name": "motor", "joint": "pendulum", "value": 0}])
    text = told(scene, act=["motor"])
    assert "the scene does not say between which values 'motor' moves" in text
    assert "act={'motor': (lowest, highest)}" in text
    assert text.count("\n") == 0


def test_ranges_are_those_of_the_scene() -> None:
    found = spans("single_finger", reward="closure", act="actuator", observe=[
        "finger.mcp.angle", "finger.tendon.tension", "finger.pip.rate", "actuator.value",
        "finger.distal/disc.normal"])
    assert found["finger.mcp.angle"] == (0.0, np.radians(85))
    assert found["actuator"] == found["actuator.value"] == (0.0, 3.75)
    assert found["finger.tendon.tension"][0] == found["finger.distal/disc.normal"][0] == 0.0
    assert found["finger.pip.rate"][0] == -found["finger.pip.rate"][1] < -1e6
    assert all(np.isfinite(span).all() for span in found.values())


@pytest.mark.parametrize(("drive", "span"), [
    ({"type": "motor", "stall": 2, "no_load": 20}, (-20.0, 20.0)),
    ({"type": "servo", "value": 0, "torque": 2}, (-1.0, 2.0)),
    ({"type": "brake", "value": {"ramp": {"to": 3, "over": 0.1}}}, (0.0, 3.0)),
    ({"type": "torque", "value": "=sin(20 * t)"}, (-1.0, 1.0)),
])
def test_drives_have_the_range_that_their_kind_or_signal_says(
    drive: dict[str, Any], span: tuple[float, float],
) -> None:
    scene = pendulum(drives=[{**drive, "name": "motor", "joint": "pendulum"}])
    scene["joints"][0]["limits"] = [-1.0, 2.0]
    found = spans(scene, act="mot*", observe=["pendulum.angle"], reward="t")
    assert found["motor"] == pytest.approx(span, abs=1e-3)
    assert found["pendulum.angle"] == (-1.0, 2.0)


def test_without_gymnasium_one_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sandbox.gym, "find_spec", lambda name: None)
    with pytest.raises(SandboxError, match=r"pip install 'sandbox-mechanics\[gym\]'"):
        sandbox.gym.make(pendulum(), **words())


@pytest.mark.parametrize(("change", "said"), [
    ({"act": {"motor": (0, "1 mm")}}, "'mm' is a unit of length, and this is in N m"),
    ({"observe": {"pendulum.angle": ("1 N", "2 N")}}, "'N' is a unit of force"),
    ({"every": "9 s"}, "9 s is longer than the run"),
    ({"randomise": {"run.step": "uniform(1 ms, 2 ms)"}}, "the step is the same in all episodes"),
])
def test_units_and_times_that_do_not_fit_are_refused(change: dict[str, Any], said: str) -> None:
    with pytest.raises(SceneError) as caught:
        sandbox.gym.make(pendulum(), **words(**change))
    assert said in str(caught.value)


def test_an_action_holds_for_as_long_in_every_episode() -> None:
    """With steps twice as long it would hold for twice as long."""
    env = sandbox.gym.make(pendulum(), **words())
    with pytest.raises(SceneError, match="the step is the same in all episodes"):
        env.reset(options={"set": {"run.step": "2 ms"}})
    with pytest.raises(SceneError, match="5 does not say what is changed"):
        env.reset(options=5)
    env.reset()
    with pytest.raises(SandboxError, match="'a' is no action"):
        env.step("a")
    assert env.step(np.zeros(1))[4]["time"] == pytest.approx(0.02)
