"""Recordings written by hand, in which nothing moves or acts but what a test sets.

What an audit has to find in them follows from a few numbers; no engine runs.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sandbox.audit.audit import Figure, audit
from sandbox.elements.joints import Pin
from sandbox.recording.recording import Recording
from sandbox.scene.geometry import mass_properties
from sandbox.scene.mechanism import Mechanism
from tests.recording.sample import recording

H = 1e-3
Change = Callable[[dict[str, np.ndarray]], None]
Touch = tuple[int, int, int, tuple[float, float], tuple[float, float], tuple[float, float], float]
"""Sample, body, other; force [N] on body, its normal, where [m], gap [m]."""


def machine(*bodies: dict[str, Any], **more: Any) -> Mechanism:
    return Mechanism.model_validate({"bodies": [{"name": "wall", "motion": "fixed"}, *bodies],
                                     **more})


def block(name: str, at: tuple[float, float] = (0.0, 0.0), **more: Any) -> dict[str, Any]:
    """A body without shape, of 0.2 kg and 3e-4 kg m^2."""
    return {"name": name, "mass": 0.2, "inertia": 3e-4, "at": at, **more}


def still(
    mechanism: Mechanism, change: Change | None = None, *, n: int = 4, every: int = 1,
    touches: list[Touch] | None = None, **info: Any,
) -> Recording:
    """``n`` samples, one in ``every`` steps of :data:`H`, at the scene's poses, then changed."""
    touches = touches or []
    run = recording(mech=mechanism, n=n, contacts=[touch[:5] for touch in touches],
                    info={"step": H, **info})
    arrays = {key: np.zeros_like(array) for key, array in run.arrays.items()}
    for key in ("contact_sample", "contact_body", "contact_other", "contact_force",
                "contact_normal"):
        arrays[key] = np.array(run.arrays[key])
    for row, touch in enumerate(touches):
        arrays["contact_point"][row], arrays["contact_gap"][row] = touch[5:]
        arrays["contact_merged"][row] = 1
    arrays["time"] = (np.arange(n) * every + every / 2) * H
    angles = {}
    for i, body in enumerate(mechanism.bodies):
        arrays["body_pose"][:, i] = *body.at, body.angle
        angles[body.name] = body.angle
        arrays["body_mass"][i] = arrays["body_inertia"][i] = np.inf
        if body.motion == "dynamic":
            weight = mass_properties(body)
            arrays["body_mass"][i], arrays["body_inertia"][i] = weight.mass, weight.inertia
            arrays["body_centre"][i] = weight.centre
    for j, joint in enumerate(mechanism.joints):
        if isinstance(joint, Pin):
            turned = joint.sense * (angles[joint.b] - angles[joint.a])
            arrays["joint_angle"][:, j] = turned - joint.zero
    if change is not None:
        change(arrays)
    return Recording(mechanism, arrays, run.info)


def figures(run: Recording) -> dict[str, Figure]:
    return {figure.name: figure for figure in audit(run)}


def turns(
    name: str, threshold: float, make: Callable[[float], Recording], *, by: float = 1e-6,
) -> None:
    """Holds a figure to its closed form: it passes up to ``threshold`` and looks just beyond.

    ``make(error)`` gives a recording that is wrong by ``error`` in what the figure compares.
    """
    for share, verdict in ((1 - by, "pass"), (1 + by, "look")):
        figure = figures(make(share * threshold))[name]
        assert figure.threshold == pytest.approx(threshold, rel=by / 2, abs=0)
        assert figure.value == pytest.approx(share * threshold, rel=by / 10, abs=0)
        assert figure.verdict == verdict
