"""What a joint of two wheels, or of a wheel and a rack, has in its table beside the usual."""

from __future__ import annotations

import math
from typing import Any

from sandbox.model.joints import flank_of, slip_of
from sandbox.model.model import Model


def wheel_fields(model: Model, i: int) -> dict[str, Any]:
    """Fields of JOINT that joint ``i`` has besides, if it is one of wheels."""
    joints, pose = model.joints, model.bodies.pose
    keeps, (ra, rb), sign = joints.kind[i].keeps, joints.radii[i], -1.0 if joints.inside[i] else 1.0
    c, s = math.cos(joints.pressure[i]), math.sin(joints.pressure[i])
    if keeps == "roll":
        return {"ra": ra, "rb": sign * rb, "reach": abs(ra + sign * rb),
                "start": slip_of(model, i, pose)[0]}
    if not joints.kind[i].teeth:
        return {}
    push = sign if keeps == "gear" else 1.0
    row = {"ra": ra * c, "push": push, "k": joints.stiffness[i],
           "start": push * flank_of(model, i, pose, 1).gap,
           "start_back": push * flank_of(model, i, pose, -1).gap}
    if keeps == "gear":
        return row | {"rb": -sign * rb * c, "reach": abs(ra + sign * rb) * s}
    gx, gy = joints.along[i]
    return row | {"tilt_c": c, "tilt_s": s, "gx": gx, "gy": gy, "reach": ra}
