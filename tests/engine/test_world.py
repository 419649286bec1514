"""The world as pymunk holds it: order, contacts and their orientation, friction, and the fast loop
against the public interface.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.engine.advance import sound
from sandbox.engine.joint_state import STOP
from sandbox.engine.simulate import simulate
from sandbox.engine.state import ANGLE, DAMPED_WORK, DAMPING, RATE, STOPPING
from sandbox.numeric import Array, Records
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

from .machines import Bench, G, H, cord, disc, fixed, mass, mechanism, parts

# -- the same loop twice -----------------------------------------------------------


def busy() -> Mechanism:
    """Some of everything: contacts with friction of their own, joints, stops, springs, tendons."""
    return mechanism(
        gravity=(0.0, -G),
        bodies=[
            fixed("floor", shapes=[{"type": "box", "size": (1, 0.02)}]),
            disc("ball", 0.01, (0.0, 0.03), velocity=(0.3, 0.0)),
            {"name": "bar", "density": 1000.0, "at": (0.1, 0.1), "angle": 0.4,
             "shapes": [{"type": "capsule", "end": (0.05, 0.0), "radius": 0.005}]},
            {"name": "tip", "density": 1000.0, "at": (0.2, 0.1),
             "shapes": [{"type": "box", "size": (0.02, 0.03)}]},
        ],
        joints=[{"type": "pin", "name": "j", "a": "floor", "b": "bar", "on_b": (0.0, 0.0),
                 "limits": (-0.3, 0.3), "damping": 1e-4}],
        springs=[{"type": "linear", "name": "s", "a": "bar", "b": "tip", "stiffness": 30.0,
                  "damping": 0.1, "rest_length": 0.05}],
        tendons=[cord("t", ("floor", (0.1, 0.3)), ("bar", (0.03, 0.0)), ("tip", (0.0, 0.01)))],
        contacts=[{"between": ("ball", "floor"), "friction": 0.7}])


def test_calls_by_address_do_what_the_public_interface_does() -> None:
    """Bit for bit: the compiled loop moves, reads, finds contacts and writes as ``pymunk.batch``
    and ``Space.step`` do, given the same velocities.
    """
    fast, slow = Bench(busy()), Bench(busy()).world
    start, most, taut = fast.state.body.copy(), 0, False
    for _ in range(300):
        fast.step()
        slow.finder.table[0] = 0
        slow.step()
        slow.read()
        np.testing.assert_array_equal(fast.state.body[:, :3], slow.body[:, :3])
        np.testing.assert_array_equal(fast.result.before, slow.body[:, 3:])
        count = slow.finder.table[0]
        assert count == fast.world.finder.table[0]
        key = ("shape_a", "shape_b", "feature")
        np.testing.assert_array_equal(np.sort(fast.world.finder.raw[:count], order=key),
                                      np.sort(slow.finder.raw[:count], order=key))
        most = max(most, count)
        taut |= bool(fast.result.cords["tension"][0] > 0)
        slow.velocity[:] = fast.result.velocity
        slow.write()
    assert taut
    assert most > 0
    assert (abs(fast.state.body - start)[:3, :3] > 1e-4).any(axis=1).all()  # all three did move


def test_what_a_sample_keeps_is_what_the_step_left() -> None:
    bench = Bench(busy()).step(steps=150, due=150)
    kept, state, result = bench.kept, bench.state, bench.result
    number, centre = bench.world.number, bench.world.model.bodies.centre
    body, before = state.body[number], result.before[number]
    c, s = np.cos(body[:, 2]), np.sin(body[:, 2])
    x, y = centre.T
    origin = body[:, :2] - np.stack([c * x - s * y, s * x + c * y], axis=1)
    np.testing.assert_allclose(kept.pose[0, :, :2], origin, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(kept.pose[0, :, 2], body[:, 2])
    np.testing.assert_array_equal(kept.velocity[0], (body[:, 3:] + before) / 2)
    np.testing.assert_array_equal(kept.acceleration[0], (body[:, 3:] - before) / bench.world.h)
    np.testing.assert_array_equal(kept.cords[0], np.stack([
        result.cords["length"], result.cords["tension"], _halfway(state.cords, result.cords)],
        axis=1))
    np.testing.assert_array_equal(kept.springs[0], np.stack([
        result.springs["length"], result.springs["force"],
        _halfway(state.springs, result.springs)], axis=1))
    np.testing.assert_array_equal(kept.joints[0, :, :3], np.stack(
        [result.joints[key] for key in ("fx", "fy", "couple")], axis=1))
    _assert_hinges(bench)
    pressing = state.touches[:state.touching[0]]
    pressing = pressing[pressing["normal"] > 0]
    assert kept.fill[0] == len(pressing) > 0
    np.testing.assert_array_equal(kept.contacts["normal"][:kept.fill[0]], pressing["normal"])


def _halfway(state: Records, result: Records) -> Array:
    """Work up to the middle of the last step."""
    work: Array = state["work"] - result["step_work"] / 2
    return work


def _assert_hinges(bench: Bench) -> None:
    """Angles, stops and dampers of the model's hinges as a sample has them, nan of the others."""
    kept, state, result = bench.kept.joints[0], bench.state, bench.result
    joints, number = bench.world.model.joints, bench.world.number
    a, b = number[joints.bodies[joints.hinges]].T
    sense = joints.sense[joints.hinges]
    turned = state.body[b, 2] - state.body[a, 2]
    np.testing.assert_array_equal(
        kept[joints.hinges, ANGLE], sense * turned - joints.zero[joints.hinges])
    rates = (state.body[:, 5] + result.before[:, 2]) / 2
    np.testing.assert_allclose(kept[joints.hinges, RATE], sense * (rates[b] - rates[a]), rtol=1e-12)
    stopping = np.full(len(joints.name), np.nan)
    stopping[joints.stopped] = 0.0
    for limit, done in zip(bench.constants.limits, state.limits, strict=True):
        if limit["what"] == STOP:
            torque = limit["side"] * done["impulse"] / bench.world.h
            stopping[limit["joint"]] += joints.sense[limit["joint"]] * torque
    np.testing.assert_array_equal(kept[:, STOPPING], stopping)
    for column, values in ((DAMPING, state.dampers["torque"]),
                           (DAMPED_WORK, _halfway(state.dampers, result.dampers))):
        wanted = np.where(joints.angle, 0.0, np.nan)
        damped = bench.constants.dampers["joint"]
        wanted[damped] = (joints.sense[damped] if column == DAMPING else 1.0) * values
        np.testing.assert_array_equal(kept[:, column], wanted)


@pytest.mark.parametrize("bad", [np.nan, np.inf, 2e6])
@pytest.mark.parametrize("column", range(6))
def test_sound(bad: float, column: int) -> None:
    state = np.ones((2, 6))
    assert sound(H, state)
    state[1, column] = bad
    assert not sound(H, state)
    assert sound(H, np.zeros((0, 6)))


def test_bodies_are_numbered_as_pymunk_lists_them() -> None:
    """However dynamic, scheduled and fixed ones are mixed: each row of ``body`` is its own body's.
    """
    at = {name: (float(i), -float(i)) for i, name in enumerate("abcdef")}
    path = {"x": 0.0}
    world, _ = parts(mechanism(bodies=[
        fixed("a", at=at["a"]), {"name": "b", "motion": "scheduled", "path": path, "at": at["b"]},
        mass("c", 0.1, at["c"]), fixed("d", at=at["d"]), mass("e", 0.1, at["e"]),
        {"name": "f", "motion": "scheduled", "path": path, "at": at["f"]}]))
    for name, place in at.items():
        assert tuple(world.body[world.number[world.model.names.body[name]], :2]) == place
    number = world.number[world.model.names.body["e"]]
    world.velocity[number] = 1.0, 2.0, 3.0
    world.write()
    body = world.bodies[number]
    assert (*body.velocity, body.angular_velocity) == (1.0, 2.0, 3.0)
    assert all(other.angular_velocity == 0 for other in world.bodies if other is not body)


# -- contacts ------------------------------------------------------------------------

BALL = disc("thing", 0.01, (0.0, 0.0205))
CRATE = {"name": "thing", "mass": 0.1, "at": (0.0, 0.0205),
         "shapes": [{"type": "box", "size": (0.02, 0.02)}]}
PRISM = {**CRATE, "centre": (0.0, 0.0), "shapes": [
    {"type": "polygon", "points": [(-0.01, -0.01), (0.01, -0.01), (0.0, 0.01)]}]}
ROLL = {**CRATE, "shapes": [
    {"type": "capsule", "start": (-0.01, 0.0), "end": (0.01, 0.0), "radius": 0.01}]}
TABLE: dict[str, list[dict[str, Any]]] = {
    "box": [{"type": "box", "size": (1.0, 0.02)}],
    "capsule": [{"type": "capsule", "start": (-0.5, 0.0), "end": (0.5, 0.0), "radius": 0.01}],
    "polygon": [{"type": "polygon", "points": [(-0.5, 0.01), (0.5, 0.01), (0.0, -0.1)]}],
    "disc": [{"type": "circle", "radius": 0.5, "at": (0.0, -0.49)}],
}


@pytest.mark.parametrize("table", TABLE)
@pytest.mark.parametrize(
    "thing", [BALL, CRATE, PRISM, ROLL], ids=["ball", "crate", "prism", "roll"])
@pytest.mark.parametrize("moving_first", [True, False])
def test_what_lies_is_carried(thing: dict[str, Any], table: str, moving_first: bool) -> None:
    """The force on the moving body by the fixed one is m g upward, whatever the order of the two in
    the scene and of their shapes in pymunk; normal up, sunk by nothing.

    Flat on a disc of 0.5 m the normal stays within 1e-9 of up as nothing tips it.
    """
    bodies = [thing, fixed("table", shapes=TABLE[table])]
    run = simulate(mechanism(
        duration=0.4, gravity=(0.0, -G), bodies=bodies if moving_first else bodies[::-1]))
    rows = run.arrays["contact_sample"] == len(run.time) - 1
    assert rows.sum() == 1
    last = {key: run.arrays[f"contact_{key}"][rows][0]
            for key in ("body", "other", "force", "normal", "gap", "point")}
    names = [body["name"] for body in (bodies if moving_first else bodies[::-1])]
    assert (names[last["body"]], names[last["other"]]) == ("thing", "table")
    np.testing.assert_allclose(last["force"], [0.0, 0.1 * G], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(last["normal"], [0.0, 1.0], atol=1e-9)
    assert abs(last["gap"]) < 1e-9
    np.testing.assert_allclose(last["point"], [0.0, 0.01], atol=1e-6)


@pytest.mark.parametrize("order", [("low", "high"), ("high", "low")])
def test_between_two_moving_bodies_the_first_feels_the_second(order: tuple[str, str]) -> None:
    """A disc on a disc in a tube: +m g on the upper one by the lower, -m g the other way round."""
    bodies = {"low": disc("low", 0.01, (0.0, 0.02)), "high": disc("high", 0.01, (0.0, 0.04))}
    walls = fixed("tube", shapes=[{"type": "box", "size": (0.2, 0.02)}])
    run = simulate(mechanism(
        duration=0.4, gravity=(0.0, -G), bodies=[walls, *(bodies[name] for name in order)]))
    rows = (run.arrays["contact_sample"] == len(run.time) - 1) & (run.arrays["contact_other"] != 0)
    assert run.arrays["contact_body"][rows].tolist() == [1]
    sign = 1 if order[0] == "high" else -1
    np.testing.assert_allclose(
        run.arrays["contact_force"][rows][0], [0.0, sign * 0.1 * G], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(run.arrays["contact_normal"][rows][0], [0.0, sign], atol=1e-9)


# -- friction --------------------------------------------------------------------------


def incline(angle: float, *, of_block: float, of_plane: float, rule: float | None = None,
            ) -> Recording:
    """A block on a plane tilted by ``angle``, by tilting gravity."""
    return simulate(mechanism(
        duration=0.3, gravity=(G * np.sin(angle), -G * np.cos(angle)),
        materials={"block": {"friction": of_block}, "plane": {"friction": of_plane}},
        bodies=[fixed("plane", material="plane", shapes=[{"type": "box", "size": (4.0, 0.02)}]),
                {"name": "block", "mass": 0.1, "at": (0.0, 0.02), "material": "block",
                 "shapes": [{"type": "box", "size": (0.06, 0.02)}]}],
        contacts=[] if rule is None else [{"between": ("block", "plane"), "friction": rule}]))


SLOPE = np.radians(25.0)
MU = np.tan(SLOPE)


@pytest.mark.parametrize(("excess", "slides"), [(1.01, False), (0.99, True)])
@pytest.mark.parametrize("share", [1.0, 0.25])
def test_friction_is_the_geometric_mean(excess: float, slides: bool, share: float) -> None:
    """sqrt(mu1 mu2) a hundredth above tan(angle) holds, a hundredth below slides with
    g (sin - mu cos): in 0.3 s with 0.04 m/s^2 that is 1.9 mm.
    """
    run = incline(SLOPE, of_block=excess * MU * share, of_plane=excess * MU / share)
    expected = 0.01 * np.sin(SLOPE) * G * 0.3**2 / 2 if slides else 0.0
    # begins 3 steps late (fall into contact) at most: 1 % of the way, and 3 um
    assert run["block.x"][-1] == pytest.approx(expected, rel=0.02, abs=5e-6)


@pytest.mark.parametrize(("excess", "slides"), [(1.01, False), (0.99, True)])
def test_a_rule_sets_the_friction_of_a_pair(excess: float, slides: bool) -> None:
    """The rule's coefficient is that of the pair, whatever the materials say."""
    run = incline(SLOPE, of_block=3.0, of_plane=0.01, rule=excess * MU)
    assert (run["block.x"][-1] > 1e-3) == slides


def test_a_rule_concerns_its_pair_only() -> None:
    """Of two like blocks on one plane, one slippery by rule, only that one slides."""
    block = {"mass": 0.1, "material": "rough", "shapes": [{"type": "box", "size": (0.06, 0.02)}]}
    run = simulate(mechanism(
        duration=0.2, gravity=(G * np.sin(SLOPE), -G * np.cos(SLOPE)),
        materials={"rough": {"friction": 0.9}},
        bodies=[fixed("plane", material="rough", shapes=[{"type": "box", "size": (4.0, 0.02)}]),
                {"name": "one", "at": (0.0, 0.02), **block},
                {"name": "two", "at": (-1.0, 0.02), **block}],
        contacts=[{"between": ("one", "plane"), "friction": 0.0}]))
    # without friction: g sin(angle) t^2 / 2; the scheme is off by a h^2 / 8 and one step's v h
    assert run["one.x"][-1] == pytest.approx(G * np.sin(SLOPE) * 0.2**2 / 2, rel=5e-3)
    assert run["two.x"][-1] == pytest.approx(-1.0, abs=5e-6)
    assert run["one/plane.tangential"][-1] == 0.0


def test_restitution() -> None:
    """sqrt(e1 e2) of the speed comes back: 0.5 m/s in free space against a fixed box."""
    run = simulate(mechanism(
        duration=0.05, materials={"a": {"restitution": 0.64}, "b": {"restitution": 1.0}},
        bodies=[fixed("wall", material="b", shapes=[{"type": "box", "size": (0.02, 1.0)}]),
                disc("ball", 0.01, (0.03, 0.0), velocity=(-0.5, 0.0), material="a")]))
    assert run["ball.vx"][-1] == pytest.approx(0.5 * 0.8, rel=1e-9)


def test_pairs_at_rest_leave_no_rows() -> None:
    """A scheduled body inside a fixed one, and another: pymunk lists them, nobody feels them."""
    shape = [{"type": "circle", "radius": 0.01}]
    path = {"x": {"expression": "=0.01 * t"}}
    run = simulate(mechanism(duration=0.02, bodies=[
        fixed("wall", shapes=shape),
        {"name": "m", "motion": "scheduled", "path": path, "shapes": shape},
        {"name": "n", "motion": "scheduled", "path": path, "shapes": shape}]))
    assert len(run.arrays["contact_body"]) == 0
    assert run["m.x"][-1] == pytest.approx(0.01 * run.time[-1], rel=1e-9)
