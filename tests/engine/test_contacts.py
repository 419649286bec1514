"""Contacts: forces at rest, friction, impacts, surface drives, rules, contact buffers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.engine import simulation as module
from sandbox.engine import world
from sandbox.engine.simulate import simulate
from sandbox.engine.world import Room
from sandbox.errors import SandboxError
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene

from .machines import G, disc, fixed, mechanism, sound

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
@pytest.mark.parametrize(("thing", "moving_first"), [
    (BALL, True), (CRATE, False), (PRISM, True), (ROLL, False), (ROLL, True)])
def test_a_table_carries_a_body(thing: dict[str, Any], table: str, moving_first: bool) -> None:
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


# -- friction --------------------------------------------------------------------------


@pytest.mark.parametrize(("tangent", "rolls"), [(0.89, True), (0.91, False)])
def test_a_rolling_disc_has_static_friction(tangent: float, rolls: bool) -> None:
    """A disc on a slope needs tan / 3 to roll; else it slides with g (sin - mu cos) at once."""
    slope = np.arctan(tangent)
    run = sound(simulate(mechanism(
        duration=0.2, gravity=(G * np.sin(slope), -G * np.cos(slope)),
        materials={"rough": {"friction": 0.2, "static": 1.5}},
        bodies=[fixed("plane", material="rough", shapes=[{"type": "box", "size": (4.0, 0.02)}]),
                disc("disc", 0.02, (0.0, 0.03), material="rough")])))
    gains = 2 / 3 * G * np.sin(slope) if rolls else G * (np.sin(slope) - 0.2 * np.cos(slope))
    assert run["disc.vx"] == pytest.approx(gains * run.time, abs=1e-9)


@pytest.mark.parametrize("count", [3, 5])
def test_a_bar_on_feet_in_line_stays_put(count: int) -> None:
    """Pushed aside by less than friction holds: it does not move at all, and carries its weight."""
    x = np.linspace(-0.1, 0.1, count)
    run = simulate(mechanism(
        duration=0.5, gravity=(1.0, -G),
        bodies=[fixed("floor", shapes=[{"type": "box", "size": (2.0, 0.02)}]),
                {"name": "bar", "mass": 0.2, "inertia": 5e-4, "at": (0.0, 0.02), "shapes": [
                    {"type": "circle", "radius": 0.01, "at": (float(at), 0.0)} for at in x]}],
        contacts=[{"between": ("bar", "floor"), "friction": 0.5}]))
    late = run.time > 0.05
    for name in ("bar.x", "bar.y", "bar.angle"):
        assert np.ptp(run[name][late]) == 0.0
    np.testing.assert_allclose(run["bar/floor.normal"][late], 0.2 * G, rtol=1e-9)
    np.testing.assert_allclose(np.abs(run["bar/floor.tangential"][late]), 0.2, rtol=1e-6)


R = 0.01


FRICTION, SPEED, MASS = 0.4, 1.0, 2.0


def belt(belt: dict[str, Any], body: dict[str, Any], *, value: Any = SPEED, end: float = 0.6,
         ground: bool = False, **more: Any) -> Any:
    named = {"material": "rubber"}
    still = [{"name": "ground", "motion": "fixed"}] if ground else []
    return load_scene({
        "run": {"duration": end, "step": 1e-3, "sample_rate": 1000}, "gravity": [0, -G],
        "materials": {"rubber": {"friction": FRICTION}},
        "bodies": [*still, {"name": "belt", "motion": "fixed", **named, **belt},
                   {"name": "load", "mass": MASS, **named, **body}],
        "drives": [{"type": "surface", "name": "run", "body": "belt", "value": value}], **more})


FLAT = {"shapes": [{"type": "box", "size": [4, 0.1]}]}
LOAD_BOX = {"at": [0, 0.1], "shapes": [{"type": "box", "size": [0.2, 0.1]}]}


def test_the_surface_of_a_free_body_pushes_it_back() -> None:
    """Momentum: a sled without friction below and its load go apart, m v + m' v' = 0."""
    sled = {"at": [0, 0], "motion": "dynamic", "mass": 3.0, "shapes": [{"type": "box",
                                                                        "size": [4, 0.1]}]}
    run = simulate(belt(sled, LOAD_BOX, ground=True, joints=[
        {"type": "slot", "name": "rail", "a": "ground", "b": "belt", "start": [-5, 0],
         "end": [5, 0], "turns": False}]))
    assert np.abs(MASS * run["load.vx"] + 3 * run["belt.vx"]).max() < 1e-9
    assert run["load.vx"][-1] - run["belt.vx"][-1] == pytest.approx(-SPEED, abs=1e-9)
    sound(run)


def test_a_belt_drives_a_bouncing_body_with_mu_times_the_normal_impulse() -> None:
    """Falling at u it leaves with e u up and mu (1 + e) u along, as long as that is less than V."""
    ball = {"at": [0, 0.25], "inertia": 1e6, "shapes": [{"type": "circle", "radius": 0.1}]}
    scene_ = belt(FLAT, ball, value=5.0, end=0.2, materials={
        "rubber": {"friction": FRICTION, "restitution": 0.5}})
    run = simulate(scene_)
    fall = np.sqrt(2 * G * 0.1)
    assert run["load.vx"][-1] == pytest.approx(-FRICTION * 1.5 * fall, rel=G * 1e-3 / fall * 2)


def test_a_belt_under_a_fixed_box_consumes_power() -> None:
    """At rest nothing is worked out again, but for what the belt does: mu m g v for ever."""
    rod = {"type": "rod", "name": "stay", "a": "belt", "b": "load", "on_a": [1.9, 0.1],
           "collide": True}
    run = simulate(belt(FLAT, LOAD_BOX, end=1.0, joints=[rod]))
    power = FRICTION * MASS * G * SPEED
    assert run["run.work"][-1] == pytest.approx(power * run.time[-1], rel=1e-3)
    assert run["stay.reaction"][-1] == pytest.approx(FRICTION * MASS * G, rel=1e-9)


def heap(rows: int, columns: int, *, duration: float = 0.1, **more: Any) -> Mechanism:
    """Discs in rows on a floor between two walls, each row half a disc beside the last."""
    bodies = [fixed("tray", shapes=[
        {"type": "box", "size": (4, 0.1), "at": (0, -0.05)},
        {"type": "box", "size": (0.1, 2), "at": (-0.05 - R, 1)},
        {"type": "box", "size": (0.1, 2), "at": (0.05 + 2 * R * columns, 1)}])]
    for j in range(rows):
        for i in range(columns):
            at = (2 * R * i + R * (j % 2), R + 1.01 * math.sqrt(3) * R * j)
            bodies.append(disc(f"d{j}_{i}", R, at))
    return mechanism(duration=duration, gravity=(0.0, -G), bodies=bodies, **more)


def small_buffers(monkeypatch: pytest.MonkeyPatch, contacts: int = 2, rows: int = 8) -> list[Room]:
    """Runs start with no more room than this; every room that is made then."""
    made: list[Room] = []

    def room(**given: int) -> Room:
        made.append(Room(**given) if made else Room(contacts, rows))
        return made[-1]

    monkeypatch.setattr(world, "Room", room)
    return made


def test_growing_contact_buffers_does_not_change_results(monkeypatch: pytest.MonkeyPatch) -> None:
    machine = heap(3, 4, duration=0.03, run={"sample_rate": 400.0})
    whole = simulate(machine)
    made = small_buffers(monkeypatch)
    again = simulate(machine)
    assert len(made) > 1
    for name, array in whole.arrays.items():
        np.testing.assert_array_equal(again.arrays[name], array, err_msg=name)


def test_too_many_contacts_are_refused_with_their_number(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_CONTACTS", 5)
    small_buffers(monkeypatch)
    with pytest.raises(SandboxError, match=r"\d+ contacts at once at t = .*more than the 5"):
        simulate(heap(2, 8))


def crossing(count: int, duration: float = 0.1) -> Mechanism:
    """2 ``count`` discs fall on their own plates; each passes through its own partner."""
    bodies, rules = [fixed("floor", shapes=[{"type": "box", "size": (9.0, 0.02)}])], []
    for i in range(count):
        x = 0.1 * i - 2
        bodies += [disc(f"a{i}", 0.01, (x, 0.0205)), disc(f"b{i}", 0.01, (x, 0.022))]
        rules.append({"between": (f"a{i}", f"b{i}"), "collide": False})
    return mechanism(duration=duration, gravity=(0.0, -G), bodies=bodies, contacts=rules)


@pytest.mark.parametrize("count", [3, 40])
def test_refused_pairs_pass_through_each_other(count: int) -> None:
    """Discs that overlap and may not touch both come to lie on the floor, others do not.

    With 40 such pairs there are 81 kinds of body, more than pymunk's 32 categories: all are then
    of one, and the table of pairs tells them apart. On the floor a disc's centre is 20 mm up, less
    m g / k where so many contacts are compliant, with h^2 k / m = 40.
    """
    run = simulate(crossing(count))
    heights = [run[f"{name}{i}.y"][-1] for i in range(count) for name in "ab"]
    depth = G * run.info.step**2 / 40 if count > 30 else 0.0
    np.testing.assert_allclose(heights, 0.02 - depth, atol=1e-9)
    others = np.unique(run.arrays["contact_other"])
    np.testing.assert_array_equal(others, [0])


def test_permitted_pairs_touch_beyond_32_collision_groups() -> None:
    """Of the same 40 pairs the last may touch after all: its upper disc is pushed off the lower.

    Centres 2 r apart once the overlap of 18.5 mm is undone, at 0.1 m/s.
    """
    machine = crossing(40, duration=0.25)
    run = simulate(machine.model_copy(update={"contacts": machine.contacts[:-1]}))
    apart = [run[f"b39.{q}"][-1] - run[f"a39.{q}"][-1] for q in "xy"]
    assert np.hypot(*apart) == pytest.approx(0.02, abs=1e-6)
    assert run["b38.y"][-1] == pytest.approx(0.02 - G * run.info.step**2 / 40, abs=1e-9)


def test_fixed_bodies_are_apart_for_joints() -> None:
    """A joint to one fixed body must not switch off the contact with another.

    pymunk forbids contact by pairs of *bodies*: were all fixed bodies the space's one static body,
    the disc hung from the wall would fall through the floor.
    """
    machine = mechanism(
        duration=0.2, gravity=(0.0, -G),
        bodies=[fixed("wall"), fixed("floor", shapes=[{"type": "box", "size": (1, 0.02)}]),
                disc("ball", 0.01, (0.0, 0.025))],
        joints=[{"type": "rope", "name": "rope", "a": "wall", "b": "ball", "longest": 1.0}])
    assert simulate(machine)["ball.y"][-1] == pytest.approx(0.02, abs=1e-9)


def test_motion_does_not_depend_on_whether_bounds_are_checked() -> None:
    """Fixed bodies far away, so many that pymunk looks for contacts in every step, change nothing.

    Without them it is called where bounds meet only; bodies bounce and part in between.
    """
    shapes = [{"type": "box", "size": (0.06, 0.04)}, {"type": "circle", "radius": 0.03},
              {"type": "capsule", "end": (0.05, 0.0), "radius": 0.01}]
    thrown = [{"name": f"b{i}", "mass": 0.1, "at": (0.09 * (i % 8), 0.1 + 0.12 * (i // 8)),
               "angle": 0.3 * i, "velocity": (0.1 * math.sin(i), 0.1 * (i % 7)),
               "angular_velocity": 4 * math.cos(i), "shapes": [shapes[i % 3]],
               "material": "rubber"} for i in range(16)]
    floor = fixed("floor", shapes=[{"type": "box", "size": (8.0, 0.02)}])
    far = [disc(f"far{i}", 0.1, (100.0 + i, 50.0), motion="fixed") for i in range(12)]
    poses = [simulate(mechanism(
        duration=0.4, gravity=(0.0, -G), bodies=[floor, *thrown, *more],
        materials={"rubber": {"restitution": 0.4, "friction": 0.4}},
    )).arrays["body_pose"][:, :17] for more in ([], far)]
    np.testing.assert_array_equal(*poses)
