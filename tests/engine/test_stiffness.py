"""Rotary springs: too stiff for the step, soft, and their work."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.scene.mechanism import Mechanism

from .machines import H, fixed, mechanism

INERTIA, M, D = 2e-6, 0.01, 0.03
"""Of a body, and of its centre of mass from its hinge."""


def flap(k: float, *, duration: float = 0.05, **more: Any) -> Mechanism:
    """A body on a hinge to the ground, turned by 0.1 rad out of its spring's rest."""
    bodies = [fixed("ground"), {"name": "flap", "mass": M, "inertia": INERTIA, "centre": (D, 0.0),
                                "angle": 0.1}]
    spring = {"type": "rotary", "name": "s", "joint": "hinge", "stiffness": k}
    more.setdefault("springs", [spring])
    return mechanism(duration=duration, bodies=bodies, run={"sample_rate": 1 / H}, joints=[
        {"type": "pin", "name": "hinge", "a": "ground", "b": "flap", "on_b": (0, 0)}], **more)


ABOUT = INERTIA + M * D**2
"""Inertia about the hinge."""


@pytest.mark.parametrize("pace", [3.0, 30.0, 3e3])
def test_it_does_not_blow_up_and_shrinks_as_backward_euler_does(pace):
    """Of its amplitude 1 / sqrt(1 + (h w)^2) is left by a step; 10 are given it to get going."""
    run = simulate(flap(ABOUT * (pace / H) ** 2))
    swing = np.abs(run["hinge.angle"])
    assert swing.max() < 0.11
    assert swing[40:].max() < 0.1 / math.hypot(1, pace) ** 30 + 1e-12


def two_arms(springs: list[dict[str, Any]], damping: float = 1e-3) -> Mechanism:
    """Two arms pinned to a wall, their hinges damped [N m s/rad]."""
    bodies = [fixed("wall"), *({"name": name, "mass": 0.1, "inertia": 1e-4, "angle": angle}
                               for name, angle in (("one", 0.3), ("two", -0.2)))]
    joints = [{"type": "pin", "name": f"hinge_{name}", "a": "wall", "b": name, "on_a": (0, 0),
               "damping": damping} for name in ("one", "two")]
    return mechanism(bodies=bodies, joints=joints, springs=springs)


def test_the_work_of_a_torsion_spring_counts_from_where_it_begins():
    """k/2 (y0^2 - y^2), y the angle off its rest, with neither start nor rest at 0.

    Forces act at y_n over (y_(n+1) - y_(n-1)) / 2, which telescopes; with the leapfrog's
    y_(n+1) + y_(n-1) = (2 - h^2 k / I) y_n the y^2 of the pose counts as (1 - h^2 k / 2 I) y^2.
    At the start y_0 = y_1, half a step on either side of rest.
    """
    k, rest = 0.2, 0.25
    machine = two_arms([
        {"type": "rotary", "name": "s", "joint": "hinge_one", "stiffness": k, "rest_angle": rest}],
        damping=0.0)
    run = simulate(machine)
    y = run["hinge_one.angle"] - rest
    share = 1 - H**2 * k / 1e-4 / 2
    np.testing.assert_allclose(
        run["s.work"], k * (y[0]**2 - share * y**2) / 2, rtol=1e-11, atol=1e-16)
    assert abs(run["s.work"][0]) < 1e-3 * k * (0.3 - rest)**2
    assert np.ptp(y) > 1e-3
