"""Mechanisms built from plain elements, so that a check does not depend on how parts expand."""

from __future__ import annotations

from typing import Any

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from tests.support.reference import DiscRow, FingerSet

BODIES = ("finger.proximal", "finger.middle", "finger.distal")
HINGES = ("finger.mcp", "finger.pip", "finger.dip")
G = 9.81
"""Gravitational acceleration [m/s^2]."""
Json = dict[str, Any]


def mechanism(*, duration: float, step: float = 5e-4, **elements: Any) -> Mechanism:
    """Mechanism of the given elements with run settings ``duration`` [s] and ``step`` [s]."""
    run = {"duration": duration, "step": step, **elements.pop("run", {})}
    return Mechanism.model_validate({"run": run, **elements})


def simulated(
    duration: float, step: float = 5e-4, *, g: float = 0.0, gravity_x: float = 0.0,
    every_step: bool = False, **elements: Any,
) -> Recording:
    """Recording of plain elements; ``g`` [m/s^2] acts along -y."""
    if every_step:
        elements["run"] = {"sample_rate": 1 / step}
    return simulate(mechanism(duration=duration, step=step, gravity=(gravity_x, -g), **elements))


def fixed(name: str, **more: Any) -> Json:
    """Fixed body."""
    return {"name": name, "motion": "fixed", **more}


def mass(name: str, kilograms: float, at: tuple[float, float], **more: Any) -> Json:
    """Body without a shape: it touches nothing."""
    return {"name": name, "mass": kilograms, "inertia": 1e-5, "at": at, **more}


def pin(name: str, a: str, b: str, **more: Any) -> Json:
    """Pin joint at the origin of ``b``, unless ``more`` places it elsewhere."""
    place = {} if {"on_a", "on_b"} & more.keys() else {"on_b": (0.0, 0.0)}
    return {"type": "pin", "name": name, "a": a, "b": b, **place, **more}


def spring(name: str, a: str, b: str, **more: Any) -> Json:
    """Linear spring."""
    return {"type": "linear", "name": name, "a": a, "b": b, **more}


def force(name: str, body: str, direction: tuple[float, float], value: Any) -> Json:
    """Force drive at the origin of a body."""
    return {"type": "force", "name": name, "body": body, "direction": direction, "value": value}


def guide(body: str, at: tuple[float, float] = (0.0, 0.0), radius: float = 0.0,
          side: str = "left", friction: float = 0.0) -> Json:
    """Via point (radius 0) or pulley of a tendon."""
    return {"body": body, "at": at, "radius": radius, "side": side, "friction": friction}


def cable(name: str, *guides: tuple[Any, ...], **more: Any) -> Json:
    """Tendon through guides given as (body, at, radius, side)."""
    return {"name": name, "guides": [guide(*each) for each in guides], **more}


def finger(
    numbers: FingerSet, *, pull: Any, duration: float, step: float, disc: DiscRow | None = None,
    stops: bool = True, **more: Any,
) -> Mechanism:
    """Three straight phalanges along +x from the origin, palmar side -y, pulled from the palm.

    Frames have their origins at the near hinges. The finger has no contacts with itself; it
    touches the fixed disc without friction.
    """
    near = [0.0, numbers.lengths[0], numbers.lengths[0] + numbers.lengths[1]]
    bodies, joints, springs = [fixed("finger.palm", role="palm")], [], []
    for i, name in enumerate(BODIES):
        length, before = numbers.lengths[i], "finger.palm" if i == 0 else BODIES[i - 1]
        hinge = 0.0 if i == 0 else numbers.lengths[i - 1]
        bodies.append({
            "name": name, "at": (near[i], 0.0), "mass": numbers.masses[i], "role": "phalanx",
            "centre": (length / 2, 0.0), "inertia": numbers.inertias[i], "material": "smooth",
            "shapes": [{"type": "capsule", "end": (length, 0.0), "radius": numbers.radii[i]}]})
        joints.append(pin(
            HINGES[i], before, name, positive="clockwise", damping=numbers.damping[i],
            limits=(0.0, numbers.limits[i]) if stops else None))
        springs.append(spring(
            f"finger.spring{i + 1}", before, name, on_b=numbers.after[i],
            on_a=(hinge + numbers.before[i][0], numbers.before[i][1]),
            stiffness=numbers.stiffness[i]))
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
