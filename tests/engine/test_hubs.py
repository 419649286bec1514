"""A palm that many joints act on: free, pinned, over-constrained, sliding, on a link."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.scene.mechanism import Mechanism

from .machines import G, fixed, mechanism

FINGERS = 8
HOLDS: dict[str, list[dict[str, Any]]] = {
    "free": [],
    "pinned": [{"type": "pin", "name": "hold", "a": "wall", "b": "palm", "on_a": (0.02, 0.05)}],
    "pinned twice": [
        {"type": "pin", "name": f"hold{i}", "a": "wall", "b": "palm", "on_a": (x, 0.05)}
        for i, x in enumerate((0.02, -0.03))],
    "sliding": [{"type": "slot", "name": "hold", "a": "wall", "b": "palm", "turns": False,
                 "start": (-1.0, 0.0), "end": (1.0, 0.0)}],
    "on a link": [
        {"type": "pin", "name": "crank", "a": "wall", "b": "link", "on_a": (0.0, 0.1)},
        {"type": "pin", "name": "hold", "a": "palm", "b": "link", "on_a": (0.02, 0.03)}],
}


def hand(hold: str) -> Mechanism:
    """A palm that carries eight damped fingers all round, and is held or not."""
    bodies = [fixed("wall"), {"name": "palm", "mass": 0.2, "inertia": 1e-4, "velocity": (0.2, 0.0),
                              "centre": (0.01, 0.0)},
              {"name": "link", "mass": 0.02, "inertia": 1e-5, "at": (0.01, 0.07)}]
    joints = list(HOLDS[hold])
    for i in range(FINGERS):
        angle = 2 * np.pi * i / FINGERS
        root = (0.04 * np.cos(angle), 0.04 * np.sin(angle))
        bodies.append({"name": f"f{i}", "mass": 0.01, "inertia": 1e-6, "angle": angle, "at": root,
                       "centre": (0.02, 0.0), "angular_velocity": (-1.0) ** i})
        joints.append({"type": "pin", "name": f"j{i}", "a": "palm", "b": f"f{i}", "on_a": root,
                       "damping": 1e-4})
    return mechanism(duration=0.2, gravity=(0.0, -G), bodies=bodies, joints=joints)


@pytest.mark.parametrize("hold", HOLDS)
def test_the_audit_finds_nothing(hold: str) -> None:
    """Momentum, energy and joints of a palm that many fingers act on, over-constrained included."""
    run = simulate(hand(hold))
    verdicts = {figure.name: figure.verdict for figure in audit(run)}
    for name in ("momentum.force", "momentum.moment", "energy.created"):
        assert verdicts[name] == "pass", name
    assert np.ptp(run["f1.angle"]) > 0.05
