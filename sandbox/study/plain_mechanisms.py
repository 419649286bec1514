"""Mechanisms built from plain elements only, so that a check depends on no part's expansion."""

from __future__ import annotations

from typing import Any

from sandbox.scene.mechanism import Mechanism
from sandbox.study.reference_fingers import DiscRow, FingerSet

BODIES = ("finger.proximal", "finger.middle", "finger.distal")
HINGES = ("finger.mcp", "finger.pip", "finger.dip")
G = 9.81


def mechanism(*, duration: float, step: float = 5e-4, **elements: Any) -> Mechanism:
    """A mechanism of the given elements, run for ``duration`` [s] with time step ``step`` [s]."""
    run = {"duration": duration, "step": step, **elements.pop("run", {})}
    return Mechanism.model_validate({"run": run, **elements})


def fixed(name: str, **more: Any) -> dict[str, Any]:
    """A body that stays where it is."""
    return {"name": name, "motion": "fixed", **more}


def mass(name: str, kilograms: float, at: tuple[float, float], **more: Any) -> dict[str, Any]:
    """A body without shape, so that nothing touches it."""
    return {"name": name, "mass": kilograms, "inertia": 1e-5, "at": at, **more}


def cord(name: str, *guides: tuple[Any, ...], **more: Any) -> dict[str, Any]:
    """A tendon through (body, at) or (body, at, radius, side)."""
    keys = ("body", "at", "radius", "side")
    return {"name": name, "guides": [dict(zip(keys, g, strict=False)) for g in guides], **more}


def finger(
    numbers: FingerSet, *, pull: Any, duration: float, step: float, disc: DiscRow | None = None,
    stops: bool = True, **more: Any,
) -> Mechanism:
    """Three phalanges, straight along +x from the origin, palm side -y, pulled from the palm.

    The frames' origins are the near hinges; nothing of the finger touches
    itself, and a disc, fixed, touches it without friction.
    """
    near = [0.0, numbers.lengths[0], numbers.lengths[0] + numbers.lengths[1]]
    bodies = [fixed("finger.palm", role="palm")]
    joints, springs = [], []
    for i, name in enumerate(BODIES):
        length, before = numbers.lengths[i], "finger.palm" if i == 0 else BODIES[i - 1]
        hinge = 0.0 if i == 0 else numbers.lengths[i - 1]
        bodies.append({
            "name": name, "at": (near[i], 0.0), "mass": numbers.masses[i], "role": "phalanx",
            "centre": (length / 2, 0.0), "inertia": numbers.inertias[i], "material": "smooth",
            "shapes": [{"type": "capsule", "end": (length, 0.0), "radius": numbers.radii[i]}],
        })
        joints.append({
            "type": "pin", "name": HINGES[i], "a": before, "b": name, "on_b": (0.0, 0.0),
            "positive": "clockwise", "limits": (0.0, numbers.limits[i]) if stops else None,
            "damping": numbers.damping[i],
        })
        springs.append({
            "type": "linear", "name": f"finger.spring{i + 1}", "a": before, "b": name,
            "on_a": (hinge + numbers.before[i][0], numbers.before[i][1]),
            "on_b": numbers.after[i], "stiffness": numbers.stiffness[i],
        })
    carriers = ("finger.palm", *BODIES)
    guides = [{"body": body, "at": at} for body, at in zip(carriers, numbers.guides, strict=True)]
    if disc is not None:
        bodies.append(fixed("disc", at=disc.centre, material="smooth", shapes=[
            {"type": "circle", "radius": disc.disc_radius}]))
    return mechanism(
        duration=duration, step=step, bodies=bodies, joints=joints, springs=springs,
        tendons=[{"name": "finger.tendon", "guides": guides[::-1]}],
        drives=[{"type": "pull", "name": "actuator", "tendon": "finger.tendon", "value": pull}],
        materials={"smooth": {"friction": 0.0}},
        contacts=[{"between": ("finger.*", "finger.*"), "collide": False}], **more)
