"""Faults planted one by one in a sound recording, or in the scene that it claims to be of.

Each has to be noticed at a hundredth of the size that is given. The finger closes on a disc, is
hit, and comes to rest; with every step recorded and with every other one.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import load_scene
from tests.engine.machines import G, disc, fixed, mass, mechanism
from tests.support.mechanisms import finger
from tests.support.reference import SET_G, SET_G_TABLE

MIDDLE, DISC, EVERY = 2, 4, slice(None)
Plant = Callable[[Recording, float], Recording]


@cache
def sound(rate: float) -> Recording:
    groups = [{"name": "finger", "kind": "finger",
               "bodies": ["finger.proximal", "finger.middle", "finger.distal"]}]
    return simulate(finger(
        SET_G, pull={"ramp": {"to": 3.75, "over": 0.3}}, duration=0.6, step=5e-4,
        disc=SET_G_TABLE[0], groups=groups, run={"sample_rate": rate}))


@cache
def coiled() -> Recording:
    """Two hinges: a rotary spring with a damper, a motor of varying speed, and a soft cord."""
    return simulate(mechanism(
        duration=0.4, gravity=(0.0, -G), run={"sample_rate": 2000.0},
        bodies=[fixed("wall"), disc("one", 0.03, (0.1, 0.0)), disc("two", 0.03, (-0.1, 0.0)),
                {"name": "led", "motion": "scheduled", "path": {"x": "=0.3 + 0.1 * t"}}],
        joints=[{"type": "pin", "name": "coil", "a": "wall", "b": "one", "on_a": (0, 0),
                 "limits": (-0.3, 1.0)},
                {"type": "pin", "name": "axle", "a": "wall", "b": "two", "on_a": (0, 0)}],
        springs=[{"type": "rotary", "name": "spring", "joint": "coil", "stiffness": 0.2,
                  "damping": 1e-3},
                 {"type": "linear", "name": "band", "a": "led", "b": "one", "stiffness": 20.0,
                  "damping": 0.2, "rest_length": 0.15}],
        tendons=[{"name": "cord", "guides": [{"body": "wall", "at": (-0.1, 0.2)}, {"body": "two"}],
                  "stiffness": 50.0, "damping": 0.1}],
        drives=[{"type": "motor", "name": "motor", "joint": "axle", "torque": 0.5,
                 "value": "=3 * sin(9 * t)"}]))


@cache
def stiff() -> Recording:
    """What a step of 0.5 ms solves at its end: a coil, a band and a cord that hardly give."""
    return simulate(mechanism(
        duration=0.3, gravity=(0.0, -G), run={"sample_rate": 2000.0},
        bodies=[fixed("wall"), disc("one", 0.03, (0.1, 0.0)), disc("two", 0.03, (-0.1, 0.0)),
                disc("three", 0.03, (0.3, 0.0))],
        joints=[{"type": "pin", "name": "coil", "a": "wall", "b": "one", "on_a": (0, 0)}],
        springs=[{"type": "rotary", "name": "spring", "joint": "coil", "stiffness": 2e4,
                  "damping": 1e-3},
                 {"type": "linear", "name": "band", "a": "wall", "b": "two", "stiffness": 1e6,
                  "damping": 5.0, "on_a": (-0.1, 0.2)}],
        tendons=[{"name": "cord", "guides": [{"body": "wall", "at": (0.2, 0.3)}, {"body": "three"}],
                  "damping": 2.0}]))


@cache
def cornered() -> Recording:
    """A disc that rolls along the floor of a corner of one body, and comes to rest at its wall."""
    corner = {**fixed("corner"), "material": "m", "shapes": [
        {"type": "box", "size": (1.0, 0.1), "at": (0.0, -0.05)},
        {"type": "box", "size": (0.1, 1.0), "at": (0.25, 0.5)}]}
    return simulate(mechanism(
        duration=0.6, gravity=(3.0, -G), run={"sample_rate": 2000.0},
        materials={"m": {"friction": 0.3}},
        bodies=[corner, {**disc("one", 0.03, (0.0, 0.03)), "material": "m"}]))


@cache
def sliding() -> Recording:
    """An arm that is held, one that swings on its journal, a block on a groove of a turning rod.

    The rod is turned by a motor with a line.
    """
    return simulate(mechanism(
        duration=0.3, gravity=(0.0, -G), run={"sample_rate": 2000.0},
        bodies=[fixed("wall"), {"name": "one", "mass": 1.0, "inertia": 1e-3, "at": (0.1, 0.0)},
                {"name": "two", "mass": 1.0, "inertia": 1e-3, "at": (0.1, 0.5)},
                {"name": "rod", "mass": 1.0, "inertia": 0.01, "at": (0.0, 1.0)},
                {"name": "bead", "mass": 0.2, "inertia": 1e-4, "at": (0.1, 1.0)}],
        joints=[{"type": "pin", "name": "held", "a": "wall", "b": "one", "on_a": (0, 0),
                 "friction": 2.0},
                {"type": "pin", "name": "slips", "a": "wall", "b": "two", "on_a": (0, 0.5),
                 "friction_coefficient": 0.3, "pin_radius": 0.03},
                {"type": "slot", "name": "groove", "a": "rod", "b": "bead", "start": (0, 0),
                 "end": (3, 0), "friction_coefficient": 0.2},
                {"type": "pin", "name": "axle", "a": "wall", "b": "rod", "on_b": (0, 0)}],
        drives=[{"type": "motor", "name": "motor", "joint": "axle", "stall": 3.0,
                 "no_load": 8.0}]))


@cache
def rockers() -> Recording:
    return simulate(load_scene("rocker_differential"))


LOADS: list[dict[str, Any]] = [
    {"type": "drag", "name": "air", "linear": 0.5, "turning": 0.01},
    {"type": "law", "name": "keel", "bodies": ["one"], "frame": "body", "at": (0.1, 0.05),
     "force": ["=-0.1 * vx", "=-3 * vy * speed"], "torque": "=0.1 * sin(9 * t)"},
    {"type": "law", "name": "heavy", "bodies": ["two"], "acceleration": ["=-0.3 * ax", "=-x"]},
    {"type": "buoyancy", "name": "water"}]


@cache
def loaded() -> Recording:
    """Two bodies under drag, laws and buoyancy."""
    return simulate(mechanism(
        duration=0.2, step=1e-3, gravity=(0.0, -9.81), run={"sample_rate": 1000}, loads=LOADS,
        bodies=[{**mass(name, 40.0, (x, 0.0)), "thickness": 1.0, "inertia": 0.5,
                 "shapes": [{"type": "box", "size": (0.4, 0.2)}],
                 "velocity": (1.0, 0.2), "angle": 0.2, "angular_velocity": 1.0}
                for name, x in (("one", 0.0), ("two", 3.0))]))


def array(key: str, index: Any, change: Callable[[np.ndarray, float], np.ndarray]) -> Plant:
    """A recorded array changed at an index, by the size of the fault."""
    def plant(run: Recording, size: float) -> Recording:
        arrays = {name: np.array(values) for name, values in run.arrays.items()}
        arrays[key][index] = change(arrays[key][index], size)
        return Recording(run.mechanism, arrays, run.info)
    return plant


def scene(change: Callable[[dict[str, Any], float], None]) -> Plant:
    """The saved mechanism changed."""
    def plant(run: Recording, size: float) -> Recording:
        content = json.loads(run.mechanism.model_dump_json(by_alias=True))
        change(content, size)
        return Recording(type(run.mechanism).model_validate(content), run.arrays, run.info)
    return plant


def number(change: Callable[[Any, float], Any], *path: Any) -> Plant:
    """A number of the scene changed by the size of the fault."""
    def plant(content: dict[str, Any], size: float) -> None:
        *inner, last = path
        for key in inner:
            content = content[key]
        content[last] = change(content[last], size)
    return scene(plant)


def grown(*path: Any) -> Plant:
    """A number of the scene made larger by a share of itself."""
    return number(lambda value, size: value * (1 + size), *path)


def longer_by(*path: Any) -> Plant:
    """A number of the scene with the size of the fault added."""
    return number(lambda value, size: value + size, *path)


def longer(content: dict[str, Any], size: float) -> None:
    """The proximal phalanx: what hangs on its end is further out."""
    x, y = content["bodies"][2]["at"]
    content["joints"][1]["on_a"] = [x + size, y]


def twice(run: Recording, size: float) -> Recording:
    """One contact row written a second time, its force ``size`` of the first one's."""
    row = len(run.arrays["contact_gap"]) // 2
    arrays = {name: np.insert(values, row, values[row], axis=0) if name.startswith("contact_")
              else values for name, values in run.arrays.items()}
    arrays["contact_force"][row] *= size
    return Recording(run.mechanism, arrays, run.info)


def more(values: np.ndarray, size: float) -> np.ndarray:
    return values * (1 + size)


def further(values: np.ndarray, size: float) -> np.ndarray:
    return values + size


FINGER: list[tuple[str, Plant, float]] = [
    ("spring.law", grown("springs", 0, "stiffness"), 0.01),
    ("drive.signal tendon.law", array("drive_value", EVERY, more), 0.01),
    ("drive.signal", grown("drives", 0, "value", "to"), 0.01),
    ("contact.place", longer_by("bodies", DISC, "shapes", 0, "radius"), 0.004),
    ("schedule", longer_by("bodies", DISC, "at", 0), 5e-4),
    ("joint.drift poses", scene(longer), 5e-4),
    ("clock", array("time", EVERY, more), 0.01),
    ("hinge", array("joint_rate", EVERY, more), 0.01),
    ("hinge", array("joint_angle", (EVERY, 1), further), 1e-3),
    ("momentum.force", twice, 1.0),
    ("contact.place momentum.moment", array("contact_point", (EVERY, 0), further), 1e-3),
    ("contact.place", array("contact_gap", EVERY, further), 1e-3),
    ("momentum.force reaction.size", array("joint_force", (333, 1), more), -1.0),
    ("scene.numbers", grown("bodies", MIDDLE, "mass"), 0.01),
    ("momentum.moment scene.numbers", array("body_inertia", MIDDLE, more), 0.01),
    ("tendon.path", array("tendon_length", EVERY, more), 0.01),
    ("scene.numbers", array("tendon_initial", EVERY, more), 0.01),
]
EVERY_STEP = [
    ("velocity", array("body_velocity", EVERY, more), 0.01),
    ("velocity", array("body_velocity", (700, MIDDLE), further), 0.01),
    ("work", array("spring_work", (EVERY, 0), more), 0.01),
    ("energy.lost work", array("tendon_work", EVERY, more), 0.01),
    ("work", array("joint_damping_work", (EVERY, 1), more), 0.01),
]
COILED = [
    ("spring.torque", grown("springs", 0, "stiffness"), 0.01),
    ("damper.law spring.torque", grown("springs", 0, "damping"), 1.0),
    ("spring.law", grown("springs", 1, "damping"), 1.0),
    ("tendon.law", grown("tendons", 0, "stiffness"), 1.0),
    ("tendon.law", grown("tendons", 0, "damping"), 1.0),
    ("scene.numbers", array("tendon_rest", EVERY, further), 1e-3),
    ("drive.signal",
     number(lambda _, size: f"=3 * (1 + {size}) * sin(9 * t)", "drives", 0, "value"), 0.01),
    ("momentum.moment", array("drive_torque", EVERY, more), 0.01),
    ("schedule",
     number(lambda _, size: f"=0.3 + 0.1 * (1 + {size}) * t", "bodies", 3, "path", "x"), 0.01),
    ("momentum.moment stop.law", array("joint_stop", (10, 0), further), 1.0),
]
STIFF = [
    ("spring.torque", grown("springs", 0, "stiffness"), 0.01),
    ("spring.law", grown("springs", 1, "stiffness"), 0.01),
    ("spring.law", grown("springs", 1, "damping"), 1.0),
    ("tendon.law", grown("tendons", 0, "stiffness"), 0.01),
    ("tendon.law", grown("tendons", 0, "damping"), 1.0),
    ("scene.numbers tendon.law", number(lambda _, size: size, "tendons", 0, "slack"), 1e-6),
]
ROCKERS = [("differential", array("tendon_length", (EVERY, i), further), 1e-4) for i in range(4)]
HELD, SLIPS, GROOVE = 0, 1, 2
"""Joints of :func:`sliding`."""
SLIDING = [
    ("joint.drift", longer_by("joints", GROOVE, "start", 1), 1e-4),
    ("joint.friction momentum.moment", array("joint_friction", (EVERY, SLIPS), more), 0.01),
    ("joint.friction momentum.moment", array("joint_friction", (EVERY, SLIPS), more), -200.0),
    ("joint.friction momentum.moment", array("joint_friction", (EVERY, HELD), more), 200.0),
    ("joint.friction momentum.force", array("joint_friction", (EVERY, GROOVE), more), 0.01),
    ("joint.friction", array("joint_sticks", (EVERY, SLIPS), lambda x, _: x + 1), 1.0),
    ("joint.friction", array("joint_sticks", (EVERY, HELD), lambda x, _: x - 1), 1.0),
    ("work", array("joint_friction_work", (EVERY, SLIPS), more), 0.01),
    ("work", array("joint_friction_work", (EVERY, GROOVE), more), 0.01),
    ("drive.motor momentum.moment", array("drive_torque", (EVERY, 0), more), 0.01),
    ("joint.friction", grown("joints", SLIPS, "friction_coefficient"), 0.01),
    ("joint.friction", grown("joints", SLIPS, "pin_radius"), 0.01),
    ("joint.friction", grown("joints", GROOVE, "friction_coefficient"), 0.01),
    ("drive.motor", grown("drives", 0, "stall"), 0.01),
    ("drive.signal", grown("drives", 0, "no_load"), 0.01),
]


LOADED = [
    *(("load.law", array("load_force", (100, i), more), 0.01) for i in (0, 2, 4)),
    *(("load.law", array("load_torque", (100, i), more), 0.01) for i in (0, 2, 4)),
    *(("load.law", number(lambda *_, value=value: value, "loads", i, field), 1.0)
      for i, field, value in (
          (0, "linear", 0.5005), (0, "turning", 0.01001), (0, "flow", (1e-3, 0.0)),
          (1, "at", (0.1001, 0.05)), (1, "frame", "world"), (1, "torque", "=0.1 * sin(9.01 * t)"),
          (2, "acceleration", ("=-0.301 * ax", "=-x")), (3, "density", 1000.5),
          (3, "level", 1e-4))),
    ("energy.lost", array("load_work", (EVERY, 0), more), 0.1),
]
CORNERED = [
    ("contact.place", longer_by("bodies", 1, "shapes", 0, "radius"), 0.004),
    ("contact.place", longer_by("bodies", 0, "shapes", 0, "at", 1), -5e-4),
    ("contact.place", array("contact_point", (EVERY, 1), further), 1e-3),
    ("contact.place", array("contact_gap", EVERY, further), 1e-3),
    ("contact.place", array("contact_normal", (EVERY, 0), further), 1e-3),
    ("contact.place",
     array("contact_merged", EVERY, lambda points, size: np.ones_like(points)), 1.0),
]


def several(run: Recording) -> np.ndarray:
    """Rows of several points: the disc at rest in the corner."""
    return np.flatnonzero(run.arrays["contact_merged"] > 1)


def looks(run: Recording) -> set[str]:
    return {figure.name for figure in audit(run) if figure.verdict == "look"}


@pytest.mark.parametrize("run", [
    lambda: sound(2000.0), lambda: sound(1000.0), coiled, stiff, cornered,
    sliding, loaded, rockers], ids=["finger", "finger_rate", "coiled", "stiff", "cornered",
                                    "sliding", "loaded", "rockers"])
def test_without_a_fault_nothing_is_noticed(run):
    assert not looks(run())


@pytest.mark.parametrize(("run", "figures", "plant", "size"), [
    (run, *row) for run, table in (
        (lambda: sound(1000.0), FINGER), (lambda: sound(2000.0), EVERY_STEP), (coiled, COILED),
        (stiff, STIFF), (cornered, CORNERED), (sliding, SLIDING), (loaded, LOADED),
        (rockers, ROCKERS))
    for row in table])
def test_a_fault_is_noticed_at_a_hundredth_of_its_size(run, figures, plant, size):
    assert set(figures.split()) <= looks(plant(run(), 0.01 * size))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_rows_of_several_points_are_held_across_their_force_and_to_the_hulls_along_it(side):
    """The place is on the line of action, or moments are off; on it anywhere between surfaces.

    The force leads up and back at 45 degrees; the disc's hull begins 30 mm from its centre.
    """
    run = cornered()
    rows = several(run)
    force = run.arrays["contact_force"][rows]
    along = force / np.hypot(*force.T)[:, None]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    for size in (1e-3, 1e-5):
        assert "momentum.moment" in looks(
            array("contact_point", rows, further)(run, side * size * across))
    centre = run.arrays["body_pose"][run.arrays["contact_sample"][rows], 1, :2]
    from_centre = np.einsum("mi,mi->m", run.arrays["contact_point"][rows] - centre, along)
    edge = side * 0.03 - from_centre
    for beyond, seen in ((-1e-6, set()), (1e-6, {"contact.place"})):
        move = (edge + side * beyond)[:, None] * along
        assert looks(array("contact_point", rows, further)(run, move)) == seen


def test_velocities_are_noticed_between_samples_by_a_per_cent_where_these_resolve_the_motion():
    """A pendulum of a second and a half, one sample in five steps."""
    run = simulate(mechanism(
        duration=2.0, gravity=(0.0, -G), run={"sample_rate": 400.0},
        bodies=[fixed("wall"), disc("bob", 0.02, (0.3, -0.4))],
        joints=[{"type": "pin", "name": "pin", "a": "wall", "b": "bob", "on_a": (0, 0)}]))
    plant = array("body_velocity", EVERY, more)
    assert not looks(run)
    assert "velocity" in looks(plant(run, 0.01))
