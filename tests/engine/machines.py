"""Helpers that build mechanisms."""

from __future__ import annotations

from typing import Any

from sandbox.audit.audit import audit
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

G = 9.81
H = 5e-4


def mechanism(*, duration: float = 0.1, step: float = H, **elements: Any) -> Mechanism:
    """A mechanism of the given elements, run for ``duration`` [s] in steps of ``step`` [s]."""
    run = {"duration": duration, "step": step, "sample_rate": 1 / step, **elements.pop("run", {})}
    return Mechanism.model_validate({"run": run, **elements})


def sound(run: Recording, *but: str) -> Recording:
    """A run whose audit finds nothing but these."""
    wrong = {f.name: f.why for f in audit(run) if f.verdict == "look" and f.name not in but}
    assert wrong == {}
    return run


def fixed(name: str, **more: Any) -> dict[str, Any]:
    return {"name": name, "motion": "fixed", **more}


def mass(name: str, kilograms: float, at: tuple[float, float], **more: Any) -> dict[str, Any]:
    """A body without shape, so that nothing touches it."""
    return {"name": name, "mass": kilograms, "inertia": 1e-5, "at": at, **more}


def disc(name: str, radius: float, at: tuple[float, float], **more: Any) -> dict[str, Any]:
    """A body that is one disc; it weighs 0.1 kg if it moves."""
    weight = {} if "motion" in more else {"mass": 0.1}
    return {"name": name, "at": at, "shapes": [{"type": "circle", "radius": radius}],
            **weight, **more}


def cable(name: str, *guides: tuple[Any, ...], **more: Any) -> dict[str, Any]:
    """A tendon through (body, at, radius, side), cut short where the rest is plain."""
    keys = ("body", "at", "radius", "side")
    return {"name": name, "guides": [dict(zip(keys, g, strict=False)) for g in guides], **more}
