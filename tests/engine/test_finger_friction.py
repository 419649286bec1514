"""The finger of ``scenes/finger_friction.json`` at rest, against statics of its own."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
from scipy.optimize import fsolve

from sandbox.scene.library import shipped_scenes

SCENE = json.loads(shipped_scenes()["finger_friction"].read_text(encoding="utf-8"))
HINGES = ("mcp", "pip", "dip")


def metres(points: Any) -> np.ndarray:
    return np.array([[float(str(x).removesuffix(" mm")) / 1e3 for x in point] for point in points])


def statics(friction: float, pull: float) -> tuple[np.ndarray, float]:
    """Angles of the hinges [rad] and the tension in the tip [N] as the whole cord slides.

    A virtual turn shortens each piece of the cord against its own tension and stretches springs.
    """
    digit = SCENE["templates"]["digit"]
    lengths = metres([digit["lengths"]])[0]
    guides, before, after = (metres(p) for p in (
        digit["guides"], digit["springs"]["from"], digit["springs"]["to"]))
    stiffness = np.array(digit["springs"]["stiffness"])
    rest = np.hypot(*(after - before).T)

    def placed(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points of the cord from behind V_0 to V_3, and lengths of the springs."""
        origin, angle = np.zeros(2), 0.0
        cord, springs = [guides[0] - [0.015, 0.0], guides[0]], []
        for i in range(3):
            def world(p: np.ndarray, angle: float, origin: np.ndarray = origin) -> np.ndarray:
                c, s = math.cos(angle), math.sin(angle)
                return origin + np.array([c * p[0] - s * p[1], s * p[0] + c * p[1]])

            root = world(before[i], angle)
            angle -= q[i]
            springs.append(math.dist(root, world(after[i], angle)))
            cord.append(world(guides[i + 1], angle))
            origin = world(np.array([lengths[i], 0.0]), angle)
        return np.array(cord), np.array(springs)

    def tensions(cord: np.ndarray, pull: float) -> np.ndarray:
        ways = np.diff(cord, axis=0)
        along = np.arctan2(ways[:, 1], ways[:, 0])
        return pull * np.exp(-friction * np.concatenate([[0.0], np.cumsum(np.abs(np.diff(along)))]))

    def moments(q: np.ndarray, pull: float) -> np.ndarray:
        cord, springs = placed(q)
        pulls, drawn = tensions(cord, pull), stiffness * (springs - rest)
        found, d = np.zeros(3), 1e-6
        for i in range(3):
            turn = np.eye(3)[i] * d
            more, less = placed(q + turn), placed(q - turn)
            pieces = [np.hypot(*np.diff(cord, axis=0).T) for cord, _ in (more, less)]
            found[i] = (pulls @ (pieces[0] - pieces[1]) + drawn @ (more[1] - less[1])) / (2 * d)
        return found

    q = np.zeros(3)
    for part in np.linspace(0.05, 1.0, 20):
        q = fsolve(moments, q, args=(part * pull,), xtol=1e-9)
    return q, float(tensions(placed(q)[0], pull)[-1])


def expected(what: str) -> float:
    """What the scene expects of a quantity, SI."""
    value = next(one["is"] for one in SCENE["expect"] if what in one.values())
    number, unit = value.split()
    return math.radians(float(number)) if unit == "deg" else float(number)


def test_the_scene_expects_what_statics_say() -> None:
    """To the digits that it is written with, 0.01 deg and 0.001 N."""
    mu = SCENE["parameters"]["mu"]
    for finger, friction in (("rubs", mu), ("slides", 0.0)):
        angles, tip = statics(friction, 8.0)
        for hinge, angle in zip(HINGES, angles, strict=True):
            assert abs(expected(f"{finger}.{hinge}.angle") - angle) < math.radians(0.006)
        if friction:
            assert abs(expected("rubs.tendon.tension_0") - tip) < 6e-4
