"""A small scene with something of every kind, for tests that break it."""

from __future__ import annotations

import copy
from typing import Any

_SCENE: dict[str, Any] = {
    "format": 1,
    "parameters": {"each": "=pull / 2", "pull": "15 N", "r": "9 mm"},
    "run": {"duration": "0.2 s", "step": "0.5 ms"},
    "materials": {"rubber": {"friction": 0.9}},
    "templates": {
        "digit": {
            "type": "finger", "lengths": ["45 mm", "26 mm"], "masses": ["12 g", "6 g"],
            "radii": ["=r", "8 mm"],
            "guides": [["-22 mm", "-14 mm"], ["20 mm", "-14 mm"], ["12 mm", "-10 mm"]],
            "limits": ["85 deg", "95 deg"],
            "springs": {"stiffness": "300 N/m", "from": ["-7 mm", "8 mm"], "to": ["7 mm", "8 mm"]},
        },
    },
    "parts": [
        {"like": "digit", "name": "finger1"},
        {"like": "digit", "name": "finger2", "at": [0, "130 mm"], "springs": {"stiffness": 200}},
        {"type": "section", "name": "section1", "circle": "16 mm", "at": [0.05, "-40 mm"]},
        {"type": "rocker_tree", "name": "tree", "pulls": ["finger1", "finger2"]},
    ],
    "bodies": [
        {"name": "disc", "at": [0.5, 0], "mass": 1, "material": "rubber",
         "shapes": [{"type": "circle", "radius": "20 mm"}, {"type": "box", "size": [0.01, 0.01]}]},
        {"name": "wall", "motion": "fixed", "at": [1, 0],
         "shapes": [{"type": "polygon", "points": [[0, 0], [1, 0], [0, 1]]}]},
        {"name": "cam", "motion": "scheduled", "path": {"angle": "=tau * t"},
         "shapes": [{"type": "capsule", "end": [0.1, 0], "radius": 0.01}]},
    ],
    "joints": [
        {"type": "pin", "name": "hinge", "a": "wall", "b": "disc", "on_b": [0, 0]},
        {"type": "rope", "name": "leash", "a": "wall", "b": "disc", "longest": 1},
    ],
    "springs": [
        {"type": "rotary", "name": "coil", "joint": "hinge", "stiffness": 0.1},
        {"type": "linear", "name": "band", "a": "wall", "b": "disc", "stiffness": "10 N/m"},
    ],
    "tendons": [{"name": "cord", "guides": [{"body": "wall"}, {"body": "disc", "at": [0, 0.01]}]}],
    "drives": [
        {"type": "pull", "name": "actuator", "tendon": "tree",
         "value": {"ramp": {"to": "=pull", "over": "0.1 s"}}},
        {"type": "radius", "name": "swell", "body": "disc", "value": "=0.02 + 0.01 * t"},
        {"type": "force", "name": "push", "body": "disc", "direction": [1, 0],
         "value": {"table": [[0, 0], ["0.1 s", "1 N"]]}},
        {"type": "torque", "name": "motor", "joint": "hinge", "value": "1 N mm"},
    ],
    "contacts": [{"between": ["finger1.*", "finger2.*"], "collide": False}],
    "groups": [{"name": "rest", "bodies": ["disc", "wall"]}],
    "meters": [{"name": "closing", "value": "=finger1.mcp.angle + finger2.mcp.angle"}],
    "expect": [{"mean": "finger1.tendon.tension", "over": "last 0.1 s", "is": "=each",
                "within": "1 %"}],
    "view": {"fps": 50},
}


def hand() -> dict[str, Any]:
    """A fresh copy of the scene."""
    return copy.deepcopy(_SCENE)


PID = {"type": "pid", "name": "loop", "reads": "elbow.angle", "target": "=goal", "writes": "motor",
       "kp": "=gain", "ki": 1.5, "limits": ["-1 N m", "1 N m"]}
ARM: dict[str, Any] = {
    "format": 1,
    "run": {"duration": "1 s", "step": "0.5 ms"},
    "parameters": {"goal": "20 deg", "gain": 3},
    "bodies": [
        {"name": "base", "motion": "fixed"},
        {"name": "arm", "mass": 0.1, "inertia": 1e-4},
        {"name": "hand", "at": [0.1, 0], "mass": 0.1, "inertia": 1e-4},
    ],
    "joints": [
        {"type": "pin", "name": "elbow", "a": "base", "b": "arm", "on_a": [0, 0],
         "limits": ["-30 deg", "90 deg"]},
        {"type": "pin", "name": "wrist", "a": "arm", "b": "hand", "on_b": [0, 0]},
    ],
    "drives": [
        {"type": "torque", "name": "motor", "joint": "elbow", "value": 0},
        {"type": "torque", "name": "second", "joint": "wrist", "value": 0},
    ],
    "controllers": [PID],
}
"""An arm of two links under a PID controller."""

FINGER: dict[str, Any] = {
    "type": "finger", "name": "finger",
    "lengths": ["45 mm", "26 mm", "21 mm"], "radii": ["9 mm", "8 mm", "7.5 mm"],
    "masses": ["12 g", "6 g", "4 g"],
    "guides": [["-22 mm", "-14 mm"], ["24 mm", "-8 mm"], ["10 mm", "-3 mm"], ["4 mm", "-1 mm"]],
    "springs": {"stiffness": "300 N/m", "from": ["-8 mm", "8 mm"], "to": ["8 mm", "8 mm"]},
}
"""A finger of three phalanges, as a part."""

FLUIDS: dict[str, Any] = {
    "bodies": [{"name": "ground", "motion": "fixed"},
               {"name": "ram", "mass": 1, "inertia": 1, "at": [0.1, 0]}],
    "joints": [{"type": "pin", "name": "hinge", "a": "ground", "b": "ram", "on_a": [0, 0]}],
    "lines": [{"name": "oil", "chambers": [
        {"type": "cylinder", "a": "ground", "b": "ram", "area": "10 cm^2"},
        {"type": "vane", "joint": "hinge", "displacement": "2 ml/rad"}]},
        {"name": "air", "gas": 1.4, "volume": "1 l"}],
    "valves": [{"name": "tap", "a": "oil", "b": "air", "resistance": "1 bar s/l"}],
    "drives": [{"type": "flow", "name": "pump", "line": "oil", "value": "1 l/min"},
               {"type": "pressure", "name": "source", "line": "air", "value": "1 bar"},
               {"type": "opening", "name": "lever", "valve": "tap", "value": "50 %"}],
}
"""A cylinder and a vane on a line of oil, a line of air, and a valve between them."""
