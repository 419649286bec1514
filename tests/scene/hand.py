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
