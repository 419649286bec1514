"""Rest against closed forms, against simulations, and what can not rest."""

from __future__ import annotations

import math

import numpy as np
import pytest

import sandbox
from sandbox.engine.still import Still
from sandbox.equilibria.polish import look
from sandbox.equilibria.rest import AtRest, rest
from sandbox.errors import SceneError
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.statics import joint_torques
from sandbox.mechanics.tendon import route
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import read_scene
from sandbox.study.reference_fingers import SET_G
from tests.equilibria.scenes import (
    ARM,
    INERTIA,
    MASS,
    G,
    four_bar,
    four_bar_height,
    hanging,
    on_slope,
    pendulum,
)

EXACT = 1e-9
"""Newton's method ends within 1e-11 of the size: of angles some 1e-10, of their functions more."""


def only(scene: object, **options: object) -> AtRest:
    found = rest(scene, **options)  # type: ignore[arg-type]
    assert len(found.rests) == 1
    return found.rests[0]


def turned(found: AtRest) -> float:
    return found["hinge.angle"]


def test_a_weight_on_a_spring():
    found = only(hanging(50.0, 0.3))
    assert found["weight.y"] == pytest.approx(-0.2 - 0.3 * G / 50, abs=1e-11)
    assert found["spring.force"] == pytest.approx(0.3 * G, rel=1e-10)
    assert found.stability == "neutral"  # it hangs, and nothing turns it back about its middle
    assert found.loose == ("weight",)
    stiff = found.stiffness("weight").stiffness()
    assert stiff[1] == pytest.approx(50, rel=1e-9)
    # sideways it is a pendulum: F / x = m g / length
    assert stiff[0] == pytest.approx(0.3 * G / (0.2 + 0.3 * G / 50), rel=1e-6)


@pytest.mark.parametrize(("kind", "stiffness", "damping"), [
    ("spring", 50.0, 20.0), ("spring", 5e6, 0.0), ("cord", 5e6, 20.0)])
def test_what_is_left_of_forces_away_from_rest(kind: str, stiffness: float, damping: float):
    """k x - m g, whatever share of it the step from rest has eased already: up to all but 1e-5."""
    scene = hanging(stiffness, 0.3, damping=damping)
    if kind == "cord":
        del scene["springs"]
        scene["tendons"] = [{"name": "cord", "stiffness": stiffness, "damping": damping,
                             "rest_length": 0.2, "guides": [{"body": "wall"}, {"body": "weight"}]}]
    mechanism = read_scene(scene).mechanism
    still, weight = Still(mechanism), [body.name for body in mechanism.bodies].index("weight")
    pose = still.pose.copy()
    pose[weight, 1] -= 1e-3
    still.put(pose)
    left = look(still, np.zeros(0), 0.2).force
    assert left == pytest.approx([0, stiffness * 1e-3 - 0.3 * G, 0], rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("stiffness", [20.0, 5e6])
def test_a_spring_that_is_soft_or_too_stiff_for_the_step(stiffness: float):
    """Newton's method has to know what the step's end took off the force of a stiff spring."""
    found = only(hanging(stiffness, 0.3, damping=3.0))
    assert found["weight.y"] == pytest.approx(-0.2 - 0.3 * G / stiffness, abs=2e-11)
    assert found.balance is not None
    assert sorted(found.modes)[-1] == pytest.approx(stiffness / 0.3, rel=1e-6)


def test_a_pendulum_that_a_spring_holds_up_has_three():
    """k a = m g l sin a: upright it falls with w^2 = (m g l - k) / I, on either side it rests."""
    k = 0.05
    found = rest(pendulum(k), starts=[{"hinge.angle": at} for at in (0.0, 0.3, -0.3, 2.9)])
    upright, left, right = found.rests
    angle = _root(lambda a: k * a - MASS * G * ARM * math.sin(a), 1.0, 3.0)
    assert turned(upright) == 0
    assert upright.stability == "unstable"
    assert upright.modes[0] == pytest.approx(-(MASS * G * ARM - k) / INERTIA, rel=1e-6)
    for one, sign in ((left, 1.0), (right, -1.0)):
        assert turned(one) == pytest.approx(sign * angle, abs=EXACT)
        assert one.stability == "stable"
        assert one.modes[0] == pytest.approx(
            (k - MASS * G * ARM * math.cos(angle)) / INERTIA, rel=1e-6)


def test_a_four_bar_linkage_under_gravity():
    """A ring: at rest its weight stands as low, or as high, as nearby nowhere."""
    low = only(four_bar())
    crank = low["crank.angle"]
    slope = _slope(four_bar_height, crank)
    assert low.stability == "stable"
    assert abs(slope) < 1e-8
    assert four_bar_height(crank + 0.01) > four_bar_height(crank) < four_bar_height(crank - 0.01)


def test_a_finger_closed_by_its_tendon():
    """T h_i = k_i dl_i hm_i at every hinge, without an object."""
    scene = sandbox.load_scene("single_finger", overrides={"bodies[0].at": [1.0, 1.0],
                                                           "parameters.pull": "0.1 N"})
    found = only(scene)
    theta = np.array([found[f"finger.{name}.angle"] for name in ("mcp", "pip", "dip")])
    tendon = route(SET_G.guides, SET_G.lengths)
    springs = spring_set(np.tile((-0.008, 0.008), (3, 1)), np.tile((0.008, 0.008), (3, 1)))
    left = joint_torques(0.1, tendon.arms(theta), np.full(3, 300.0), springs.elongations(theta),
                         springs.arms(theta))
    assert np.abs(left).max() < 1e-8 * 0.1 * float(tendon.arms(theta).max())
    assert found.stability == "stable"


@pytest.mark.parametrize("finger", [1, 3])
def test_what_holds_and_what_ejects(birglen: AtRest, finger: int):
    """On Birglen's equilibrium curve; the fourth runs off its tip, as the region says."""
    rho = {1: 0.055, 2: 0.060, 3: 0.065}[finger]
    l1, d = 0.05, 0.018
    angle = math.asin((math.sqrt(d**2 + 3 * (4 * l1**2 + d**2 - rho**2)) - d) / (3 * l1))
    assert birglen[f"finger{finger}.pip.angle"] == pytest.approx(angle, abs=EXACT)
    assert birglen[f"finger{finger}.distal/finger{finger}.disc.normal"] == pytest.approx(
        10 * 0.006 / (l1 * math.cos(angle)), rel=1e-8)


@pytest.fixture(scope="module")
def birglen() -> AtRest:
    found = rest("birglen_regions")
    assert found.remarks == ("the event 'gone' is left out: it acts on the way",)
    return found.rests[0]


# --- against simulations of shipped scenes that come to rest


@pytest.mark.parametrize("name", [
    "single_finger", "pulley_differential", "servo_arm", "jaw", "toggle_press", "pneumatic_hand",
    *(pytest.param(name, marks=pytest.mark.nightly) for name in (
        "snap_through", "finger_antagonist", "rope_differential", "small_wheels", "truss",
        "stiffness_uniform", "gripper_mirrored", "hydraulic_press", "elastic_tendons"))])
def test_where_a_shipped_scene_comes_to_rest(name: str):
    """Poses within 1e-6 m and rad, forces within 1e-4 of the largest: what is left of the run's
    own motion at its end is some tenth of that, of 'hydraulic_press' and 'jaw' most."""
    run, found = sandbox.simulate(name), only(name)
    a, b = found.recording.arrays, run.arrays
    off = np.abs(a["body_pose"][0] - b["body_pose"][-1])
    assert off.max() < 1e-6
    forces, last = _forces(found.recording), _forces(run)
    assert forces.keys() == last.keys()
    scale = max(map(abs, last.values()), default=0.0)
    for key, value in last.items():
        assert forces[key] == pytest.approx(value, abs=1e-4 * scale), key


def _forces(run: Recording) -> dict[object, float]:
    a, last = run.arrays, len(run) - 1
    found: dict[object, float] = {}
    for kind in ("tendon_tension", "spring_force", "joint_reaction"):
        for i, value in enumerate(a[kind][last].tolist()):
            if math.isfinite(value):
                found[kind, i] = value
    rows = np.flatnonzero(a["contact_sample"] == last)
    for row in rows[run.contacts.normal[rows] > 1e-6].tolist():
        pair = int(a["contact_body"][row]), int(a["contact_other"][row])
        found[pair] = float(run.contacts.normal[row])
    return found


@pytest.mark.nightly
def test_with_friction_a_slow_load_leads_to_the_same():
    """A finger on a rough disc: the slower the simulation's load, and the more stages, the same."""
    changes = {"materials.smooth.friction": 0.3}
    slow = sandbox.simulate(sandbox.load_scene("single_finger", overrides={
        **changes, "run.duration": 62, "run.sample_rate": 10,
        "drives[0].value.ramp.over": "60 s"}))
    found = only(sandbox.load_scene("single_finger", overrides=changes), stages=400)
    assert found.sticking
    for name in ("mcp", "pip", "dip"):
        assert found[f"finger.{name}.angle"] == pytest.approx(
            float(slow[f"finger.{name}.angle"][-1]), abs=2e-3)


# --- the engine as it is asked


def test_stiffness_is_the_slope_of_what_the_engine_leaves_over():
    """K against differences of the engine's own forces, along each free motion."""
    mechanism = read_scene("stiffness_uniform").mechanism
    still = Still(mechanism)
    drive, _ = still.driven(mechanism.run.duration)
    pose, size = only("stiffness_uniform").recording, 0.3
    assert len(pose) == 1
    still.put(_centred(still, pose))
    here = look(still, drive, size)
    by = 1e-6
    for k in range(min(4, here.free.shape[1])):
        sides = []
        for sign in (1.0, -1.0):
            still.put(here.pose_after(_centred(still, pose), sign * by * here.free[:, k]))
            sides.append(here.free.T @ look(still, drive, size).force)
        slope = (sides[1] - sides[0]) / (2 * by)
        np.testing.assert_allclose(slope, here.stiffness[:, k],
                                   atol=2e-4 * np.abs(here.stiffness).max())


def _centred(still: Still, run: Recording) -> np.ndarray:
    pose = np.array(run.arrays["body_pose"][0])
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    x, y = still.model.bodies.centre.T
    return pose + np.stack([c * x - s * y, s * x + c * y, 0 * x], axis=1)


# --- friction: it holds, or it does not


def test_a_box_that_friction_holds_on_a_slope():
    found = only(on_slope(0.5, math.atan(0.4)))
    assert found.sticking == ("box/plane",)
    assert found["box/plane.tangential"] == pytest.approx(0.5 * G * math.sin(math.atan(0.4)),
                                                          rel=1e-9)
    assert found.stability == "stable"
    assert found.left < 1e-9


def test_a_box_that_slides_for_ever():
    with pytest.raises(SceneError, match=r"nothing holds 'box': it has gone .* m and goes on"):
        rest(on_slope(0.3, math.atan(0.4)))


# --- what is refused, or said


@pytest.mark.parametrize(("scene", "options", "words"), [
    ("finger_stiffness_10N", {}, "the controller 'mcp_loop' acts as the run goes on"),
    ("release", {}, r"the event 'catch' acts at t = 0\.1 s"),
    ("four_bar", {}, "the drive 'motor' goes on for ever"),
    ({"bodies": [{"name": "wall", "motion": "fixed"}]}, {}, "nothing moves freely"),
    (pendulum(1.0), {"starts": [{"hing.angle": 1.0}]}, r"Did you mean 'hinge\.angle'"),
    (pendulum(1.0), {"at": 2.0}, "2 s is not within the run"),
])
def test_scenes_without_an_equilibrium_are_refused(scene, options, words):
    with pytest.raises(SceneError, match=words):
        rest(scene, **options)


def test_a_drive_that_still_changes_is_told():
    scene = hanging(50.0, 0.3)
    scene["drives"] = [{"type": "force", "name": "push", "body": "weight", "direction": [0, -1],
                        "value": {"ramp": {"to": 2.0, "over": 1.0}}}]
    found = rest(scene)
    assert found.remarks == ("the drive 'push' still changes at the end: it is held at its value "
                             "at t = 1 s",)
    half = only(scene, at=0.5)
    assert half["weight.y"] == pytest.approx(-0.2 - (0.3 * G + 1.0) / 50, abs=3e-5)


def _root(function: object, low: float, high: float) -> float:
    for _ in range(200):
        middle = (low + high) / 2
        if function(low) * function(middle) <= 0:  # type: ignore[operator]
            high = middle
        else:
            low = middle
    return (low + high) / 2


def _slope(function: object, at: float) -> float:
    return (function(at + 1e-5) - function(at - 1e-5)) / 2e-5  # type: ignore[operator,no-any-return]


@pytest.mark.parametrize("starts", [(), ({"weight.y": -0.3},)])
def test_what_a_schedule_has_carried_away(starts: tuple[dict[str, float], ...]):
    scene = hanging(50.0, 0.3)
    scene["bodies"][0] = {"name": "wall", "motion": "scheduled",
                          "path": {"y": {"ramp": {"to": 0.01, "over": 0.5}}}}
    found = only(scene, starts=starts)
    assert found["weight.y"] == pytest.approx(0.01 - 0.2 - 0.3 * G / 50, abs=1e-10)
