"""Small scenes to steer."""

from __future__ import annotations

from typing import Any

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
