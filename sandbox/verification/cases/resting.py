"""Equilibria found without waiting: a truss and its folds, a finger on its springs, a pendulum."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.equilibria.branches import rest_along
from sandbox.equilibria.rest import rest
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.statics import joint_torques
from sandbox.mechanics.tendon import route
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene, read_scene
from sandbox.study.plain_mechanisms import G, fixed, mechanism
from sandbox.study.reference_fingers import SET_G
from sandbox.verification.cases.case import Case, Check, Findings

NEWTON = "Newton's method ends where a motion is less than 10⁻¹¹ of the size"
HALF, RISE, STIFFNESS = 0.1, 0.03, 1000.0


def _load(y: float) -> float:
    """What von Mises' truss bears with its node at y."""
    rest_length = math.hypot(HALF, RISE)
    return 2 * STIFFNESS * (rest_length / math.hypot(HALF, y) - 1) * y


def _truss(value: float) -> Mechanism:
    return read_scene("snap_through", overrides={"parameters.load": value}).mechanism


def _snap_through() -> Findings:
    rest_length = math.hypot(HALF, RISE)
    top = math.sqrt(rest_length ** (2 / 3) * HALF ** (4 / 3) - HALF**2)
    branch, = rest_along(_truss, -1.5, 1.5, 25)
    y = np.array([stop.rest["node.y"] for stop in branch.stops])
    loads = np.array([stop.value for stop in branch.stops])
    off = max(abs(value - _load(at)) for value, at in zip(loads, y, strict=True))
    wrong = sum((stop.rest.stability == "stable") != (abs(stop.rest["node.y"]) > top)
                for stop in branch.stops if not stop.fold)
    checks = [Check("largest load that is not that of its place", "N", 0.0, off, 1e-8,
                    f"{NEWTON}; the truss gives way by up to 10⁴ N/m"),
              Check("points whose stability is told wrongly", "1", 0.0, float(wrong), 0.0,
                    "it is stable where |y| is above that of the fold"),
              Check("folds", "1", 2.0, float(len(branch.folds)), 0.0, "one up, one down")]
    for fold, sign in zip(branch.folds, (1.0, -1.0), strict=False):
        word = "upper" if sign > 0 else "lower"
        checks += [Check(f"{word} fold: load", "N", sign * _load(top), fold.value, 1e-9,
                         "off by the square of how far the fold is missed"),
                   Check(f"{word} fold: place", "m", sign * top, fold.rest["node.y"], 1e-8,
                         "where the value changes by 10⁻⁷ of the way along the branch")]
    closed = np.linspace(y.max(), y.min(), 400)
    return Findings(checks, [Panel("The node over its load", "load [N]", "height [mm]", [
        Curve("F = 2 k (L₀/L − 1) y", np.array([_load(at) for at in closed]), 1e3 * closed),
        Curve("sandbox rest", loads, 1e3 * y, "points")])])


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (low, middle) if function(low) * function(middle) <= 0 else (middle, high)
    return (low + high) / 2


def _upright() -> Findings:
    """A bob that a rotary spring holds up, too weakly."""
    m, arm, k = 0.2, 0.1, 0.05
    inertia = m * arm**2 + 1e-5
    found = rest(mechanism(
        duration=1.0, step=1e-3, gravity=(0.0, -G),
        bodies=[fixed("wall"), {"name": "bob", "at": (0.0, arm), "mass": m, "inertia": 1e-5}],
        joints=[{"type": "pin", "name": "hinge", "a": "wall", "b": "bob", "on_b": (0.0, -arm)}],
        springs=[{"type": "rotary", "name": "spring", "joint": "hinge", "stiffness": k,
                  "rest_angle": 0.0}]), starts=[{"hinge.angle": at} for at in (0.0, 0.5, -0.5)])
    aside = _root(lambda a: k * a - m * G * arm * math.sin(a), 1.0, 3.0)
    upright, one, other = found.rests
    return Findings([
        Check("upright: ω²", "1/s^2", (k - m * G * arm) / inertia, float(upright.modes[0]), 1e-4,
              "slopes of forces are differences over 10⁻⁷, good to some 10⁻⁷"),
        *(Check(f"{word}: angle", "rad", sign * aside, each["hinge.angle"], 1e-9, NEWTON)
          for word, sign, each in (("one side", 1, one), ("other side", -1, other))),
        Check("at the side: ω²", "1/s^2", (k - m * G * arm * math.cos(aside)) / inertia,
              float(one.modes[0]), 1e-4, "the same")])


def _finger() -> Findings:
    """The finger of Set G under a light pull, with nothing to hold."""
    pull = 0.1
    found, = rest(load_scene("single_finger", overrides={
        "bodies[0].at": [1.0, 1.0], "parameters.pull": pull})).rests
    theta = np.array([found[f"finger.{name}.angle"] for name in ("mcp", "pip", "dip")])
    springs = spring_set(np.tile((-0.008, 0.008), (3, 1)), np.tile((0.008, 0.008), (3, 1)))
    arms = route(SET_G.guides, SET_G.lengths).arms(theta)
    left = joint_torques(pull, arms, np.full(3, 300.0), springs.elongations(theta),
                         springs.arms(theta))
    return Findings([Check(f"moment left about {name}", "N m", 0.0, float(value), 1e-12,
                           f"{NEWTON}, of springs with 10⁻² N m/rad")
                     for name, value in zip(("mcp", "pip", "dip"), left, strict=True)])


CASES = (
    Case("rest_snap_through", "A truss that snaps through, along its load",
         "F = 2 k (L₀ / L − 1) y, folds at y² = L₀^(2/3) b^(4/3) − b²", "scene `snap_through`, "
         "loads from −1.5 to 1.5 N", "every point of the branch, and its folds, against the "
         "closed form", _snap_through),
    Case("rest_upright", "A pendulum held up by a weak spring", "k a = m g l sin a, "
         "ω² = (k − m g l cos a) / I", "a bob of 200 g on 100 mm, k = 0.05 N m/rad, from three "
         "angles", "the three poses of rest, and how small motions grow or swing", _upright),
    Case("rest_finger", "A finger at rest on its springs", "T h_i = k_i Δl_i hm_i, from (17), (29)",
         "scene `single_finger`, the disc out of reach, 0.1 N",
         "moments of tendon and springs about each hinge, where `sandbox rest` has it", _finger),
)
