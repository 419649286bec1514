"""Recordings of a finger under control, made from closed forms instead of a simulation."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from sandbox.recording.builder import RecordingBuilder
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import planned
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene

H = 1e-3
TARGETS = np.radians([5.0, 10.0, 15.0])
SHORTENING = 2.971e-3
JOINTS = ("mcp", "pip", "dip")
STIFFNESS = (15000.0, 5000.0, 1100.0)


def scene(name: str = "controlled", **changes: Any) -> dict[str, Any]:
    """Set A with a PID loop for every spring and a constant pull."""
    return {
        "name": name, "title": f"A finger called {name}", "run": {"duration": 3, "step": H},
        "parts": [{
            "type": "finger", "name": "finger", "lengths": [0.045, 0.026, 0.021],
            "masses": [0.012, 0.006, 0.004], "radii": [0.009, 0.008, 0.0075],
            "guides": [[-0.015, -0.005], [0.0225, -0.005], [0.013, -0.005], [0.0105, -0.005]],
            "springs": {"stiffness": STIFFNESS, "from": [-0.007, 0.008], "to": [0.007, 0.008]}}],
        "drives": [
            {"type": "pull", "name": "pull", "tendon": "finger", "value": 15},
            *({"type": "stiffness", "name": f"k{i + 1}", "spring": f"finger.{joint}_spring"}
              for i, joint in enumerate(JOINTS))],
        "controllers": [
            {"type": "pid", "name": f"{joint}_loop", "writes": f"k{i + 1}",
             "reads": f"finger.{joint}.angle", "target": float(TARGETS[i]), "kp": 1e4}
            for i, joint in enumerate(JOINTS)],
        **changes,
    }


def second_order(t: np.ndarray, zeta: float, omega: float) -> np.ndarray:
    """Answer to a unit step of an underdamped second-order system."""
    damped = omega * np.sqrt(1 - zeta**2)
    return 1 - np.exp(-zeta * omega * t) * (
        np.cos(damped * t) + zeta * omega / damped * np.sin(damped * t))


def recording(
    content: dict[str, Any] | None = None, *, zeta: float = 0.6, omega: float = 6.0,
    reach: tuple[float, float, float] = (1.0, 1.0, 1.0), info: dict[str, Any] | None = None,
) -> Recording:
    """The joints go to their targets, or a share of them; stiffness goes with them."""
    mechanism = expand(load_scene(content or scene()))
    t = (np.arange(round(mechanism.run.duration / H)) + 0.5) * H
    size, cables = len(mechanism.bodies), len(mechanism.tendons)
    builder = RecordingBuilder(mechanism, len(t), {
        "body_centre": np.zeros((size, 2)), "body_mass": np.ones(size),
        "body_inertia": np.ones(size), "tendon_initial": np.full(cables, 0.1),
        "tendon_rest": np.full(cables, 0.1)})
    arrays = builder.blank(len(t))
    for array in arrays.values():
        array[:] = 0.0
    answer = second_order(t, zeta, omega)
    pins = {joint.name: i for i, joint in enumerate(mechanism.joints)}
    for i, (joint, target) in enumerate(zip(JOINTS, TARGETS, strict=True)):
        column = pins[f"finger.{joint}"]
        arrays["joint_angle"][:, column] = reach[i] * target * answer
    arrays["tendon_length"][:] = 0.1 - SHORTENING * answer[:, None]
    for i, drive in enumerate(mechanism.drives):
        steady = 15.0 if drive.type == "pull" else STIFFNESS[int(drive.name[1:]) - 1]
        varies = any(drive.name == c.writes for c in mechanism.controllers)
        swing = 2 * (answer - 1) ** 2 if varies else 0
        arrays["drive_value"][:, i] = steady * (1 + swing)
    builder.put(0, arrays)
    return builder.finish(t, replace(planned(mechanism.run), **(info or {})))
