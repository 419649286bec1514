"""Environments keep Gymnasium's contract, and their episodes are runs of the scene."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import sandbox
from sandbox import SandboxError, SceneError
from sandbox.gym.env import SceneEnv
from sandbox.recording.recording import Recording

DOWN = ["pendulum.angle", "pendulum.rate"]


def pendulum(**more: Any) -> dict[str, Any]:
    """A rod of 0.3 m that a torque swings; at 1.5 rad an event ends the run."""
    return {
        "run": {"duration": 0.5, "step": 1e-3},
        "gravity": [0, -9.81],
        "parameters": {"mass": "0.2 kg", "most": "2 N m"},
        "bodies": [
            {"name": "base", "motion": "fixed"},
            {"name": "rod", "mass": "=mass", "angle": "-90 deg",
             "shapes": [{"type": "capsule", "end": [0.3, 0], "radius": "8 mm"}]}],
        "joints": [{"type": "pin", "name": "pendulum", "a": "base", "b": "rod", "on_a": [0, 0],
                    "zero": "-90 deg"}],
        "drives": [{"type": "torque", "name": "motor", "joint": "pendulum",
                    "value": {"ramp": {"to": "=most", "over": 0.1}}}],
        "events": [{"name": "up", "when": "=pendulum.angle > 1.5", "stop": "pass",
                    "because": "it is up"}],
        **more}


def words(**more: Any) -> dict[str, Any]:
    return {"observe": DOWN, "act": {"motor": (-2.0, 2.0)},
            "reward": "-abs(pendulum.angle - 1)", **more}


FINGER: dict[str, Any] = {"observe": ["finger.*.angle", "finger.tendon.tension"],
                          "act": "actuator", "reward": "closure"}


def make(scene: Any = None, **more: Any) -> SceneEnv:
    return sandbox.gym.make(pendulum() if scene is None else scene, **words(**more))


def play(env: SceneEnv, actions: Any, **options: Any) -> list[tuple[Any, ...]]:
    """All that an episode tells, its first observation first."""
    first, info = env.reset(**options)
    steps: list[tuple[Any, ...]] = [(first, info)]
    for action in actions:
        steps.append(env.step(np.atleast_1d(action)))
        if steps[-1][2] or steps[-1][3]:
            break
    return steps


def same(one: Recording, other: Recording) -> bool:
    return set(one.arrays) == set(other.arrays) and all(
        one.arrays[key].tobytes() == other.arrays[key].tobytes() for key in one.arrays)


@pytest.mark.parametrize(("scene", "given"), [
    ("single_finger", FINGER),
    ("servo_arm", {"observe": ["left.angle", "right.rate"], "act": {"pd": (0, 1.5)},
                   "reward": "=-abs(left.angle - 1)"}),
    (pendulum(), words(randomise={"parameters.mass": [0.1, 0.2, 0.3]}, act={"*": None},
                       observe=["pendulum.*"], reward=lambda run: run.time)),
])
def test_gymnasiums_checker_passes(scene: Any, given: dict[str, Any]) -> None:
    """Its checker warns of what is doubtful, and here warnings are errors."""
    check_env(sandbox.gym.make(scene, **given))


def test_an_episode_is_the_run_with_its_actions_as_a_table() -> None:
    rng = np.random.default_rng(3)
    env = sandbox.gym.make("single_finger", set={"run.duration": "0.3 s"}, **FINGER)
    play(env, rng.uniform(-1, 1, 40))
    run = env.recording()
    assert run.info.complete
    again = sandbox.simulate(sandbox.load_scene("single_finger", overrides=env.played()))
    assert same(run, again)


def test_the_same_seed_and_actions_give_the_same() -> None:
    actions = np.random.default_rng(6).uniform(-0.3, 0.3, 25)
    randomised = {"randomise": {"parameters.mass": "uniform(0.1 kg, 0.4 kg)"}}
    one, other = make(**randomised), make(**randomised)
    first = play(one, actions, seed=8)
    for steps in (play(other, actions, seed=8), play(one, actions, seed=8)):
        for a, b in zip(first, steps, strict=True):
            assert a[0].tobytes() == b[0].tobytes()
            assert a[1:] == b[1:]
    assert play(one, actions)[0][1] != first[0][1]  # the next draw


def test_observations_and_rewards_are_quantities_at_the_end_of_an_interval() -> None:
    env = make(observe=["pendulum.angle", "=2 * pendulum.rate", "rod.ay"])
    steps = play(env, [0.5, -0.5, 0.2])
    run = env.recording()
    for k, (seen, reward, *_) in enumerate(steps[1:], start=1):
        at = 20 * k - 1  # every step is a sample
        angle = run["pendulum.angle"][at]
        assert seen[0] == angle
        assert seen[1] == 2 * run["pendulum.rate"][at]
        assert seen[2] == pytest.approx(run["rod.ay"][at], rel=1e-12)
        assert reward == -abs(angle - 1)


def test_an_event_terminates_and_the_end_truncates() -> None:
    *_, last = play(make(), [1.0] * 50)
    assert last[2:4] == (True, False)
    assert last[4]["stopped"] == "up"
    assert last[4]["because"] == "it is up"
    steps = play(make(), [0.0] * 50)
    assert steps[-1][2:4] == (False, True)
    assert len(steps) == 1 + 25


def test_divergence_terminates_with_its_own_reward() -> None:
    env = make(act={"motor": (-2.0, 1e12)}, lost=-50.0)
    steps = play(env, [1.0] * 30)
    seen, reward, terminated, truncated, info = steps[-1]
    assert (reward, terminated, truncated) == (-50.0, True, False)
    assert "diverged" in info
    assert np.isfinite(seen).all()
    with pytest.raises(SandboxError, match=r"the episode is over.*reset\(\) begins one"):
        env.step(np.zeros(1))
    assert np.isfinite(play(env, [0.0])[1][0]).all()


def test_options_change_one_episode() -> None:
    env = make()
    plain = play(env, [0.4])
    heavy = play(env, [0.4], options={"set": {"parameters.mass": "1 kg"}})
    assert heavy[0][1]["set"] == {"parameters.mass": "1 kg"}
    assert heavy[1][0][0] < plain[1][0][0]
    assert play(env, [0.4])[1][0].tobytes() == plain[1][0].tobytes()
    with pytest.raises(SceneError, match="no option 'sett'"):
        env.reset(options={"sett": {}})


def test_no_action_is_refused_and_so_is_one_before_an_episode() -> None:
    env = make()
    with pytest.raises(SandboxError, match="no episode has begun"):
        env.step(np.zeros(1))
    env.reset()
    for wrong in ([0.0, 0.0], [np.nan]):
        with pytest.raises(SandboxError, match="1 finite numbers, -1 to 1, for 'motor'"):
            env.step(np.array(wrong))


def test_undefined_observations_and_rewards_are_errors() -> None:
    env = make(observe=["=1 / (1 - pendulum.angle / pendulum.angle)"])
    with pytest.raises(SandboxError, match="has no value at t = 0 s"):
        env.reset()
    env = make(reward="sqrt(-1 - t)")
    env.reset()
    with pytest.raises(SandboxError, match="the reward has no value"):
        env.step(np.zeros(1))


@pytest.mark.parametrize("kind", ["sync", pytest.param("async", marks=pytest.mark.nightly)])
def test_vector_environments_match_single_ones(kind: str) -> None:
    drawn = words(randomise={"parameters.mass": "uniform(0.1 kg, 0.4 kg)"})
    envs = gymnasium.make_vec(
        "sandbox.gym:sandbox/Scene-v0", num_envs=2, vectorization_mode=kind, scene=pendulum(),
        **drawn)
    try:
        seen, _ = envs.reset(seed=[11, 12])
        actions = np.array([[0.3], [-0.2]])
        rows = [seen] + [envs.step(actions)[0] for _ in range(5)]
    finally:
        envs.close()
    for i, seed in enumerate((11, 12)):
        alone = play(sandbox.gym.make(pendulum(), **drawn), [actions[i, 0]] * 5, seed=seed)
        assert [row[i].tobytes() for row in rows] == [steps[0].tobytes() for steps in alone]


# --- requests that are refused


def refusal(scene: Any = None, **more: Any) -> str:
    with pytest.raises(SceneError) as raised:
        sandbox.gym.make(pendulum() if scene is None else scene, **words(**more))
    return str(raised.value)


def spans(scene: Any, **more: Any) -> dict[str, tuple[float, float]]:
    env = sandbox.gym.make(scene, **more)
    return {**env.task.observe, **env.task.act}


@pytest.mark.parametrize(("wrong", "message"), [
    ({"observe": ["pendulum.angel"]},
     r"observe[0]: unknown quantity 'pendulum.angel'. Did you mean 'pendulum.angle'?"),
    ({"observe": ["motor.work"]}, "'motor.work' is computed after the run"),
    ({"observe": ["=pendulum.angle +"]}, "observe[0]: "),
    ({"act": ["moto"]}, "there is no drive named 'moto'. Did you mean 'motor'?"),
    ({"act": {"motor": "2 N m"}}, "is no range. Allowed: (lowest, highest), in SI"),
    ({"every": "1.5 ms"}, "every: 0.0015 s is no whole number of steps of 0.001 s"),
    ({"randomise": {"parameters.mas": [1, 2]}}, 'randomise["parameters.mas"]: cannot set'),
    ({"randomise": {"parameters.mass": ["1 kg", "-1 kg"]}}, "the scene is wrong"),
    ({"every": "9 s"}, "9 s is longer than the run"),
])
def test_wrong_requests_are_refused_with_a_near_miss(wrong: dict[str, Any], message: str) -> None:
    assert message in refusal(**wrong)


def test_a_drive_that_the_scene_steers_is_refused() -> None:
    scene = pendulum(controllers=[{"type": "schedule", "name": "program", "writes": "motor",
                                   "value": 1}])
    assert "the drive 'motor' is set by 'program'" in refusal(scene)
    scene = pendulum(events=[{"name": "off", "at": 0.2, "set": {"motor": 0}}])
    assert "the drive 'motor' is set by 'off'" in refusal(scene)


def test_a_drive_without_a_range_asks_for_one() -> None:
    scene = pendulum(drives=[{"type": "torque", "name": "motor", "joint": "pendulum", "value": 0}])
    text = refusal(scene, act=["motor"])
    assert "the scene gives no range for 'motor'" in text
    assert "act={'motor': (lowest, highest)}" in text
    assert text.count("\n") == 0


def test_ranges_are_those_of_the_scene() -> None:
    found = spans("single_finger", reward="closure", act="actuator", observe=[
        "finger.mcp.angle", "finger.pip.rate"])
    assert found["finger.mcp.angle"] == (0.0, np.radians(85))
    assert found["actuator"] == (0.0, 3.75)
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
