"""Bodies and joints of scenes, as their files would hold them."""

from __future__ import annotations

from typing import Any

from sandbox.verification.benchmarks.benchmark import Json

G = 9.81
"""Where a problem has weight [m/s^2]."""
GROUND: Json = {"name": "ground", "motion": "fixed"}


def point(z: complex) -> list[float]:
    """A complex number as x and y."""
    z = complex(z)
    return [z.real, z.imag]


def body(name: str, at: complex, angle: float, centre: complex, kilograms: float, inertia: float,
         **more: Any) -> Json:
    """A body whose frame sits at ``at`` and is turned by ``angle``, its centre in that frame."""
    return {"name": name, "at": point(at), "angle": float(angle), "centre": point(centre),
            "mass": kilograms, "inertia": inertia, **more}


def bar(name: str, near: complex, angle: float, length: float, kilograms: float,
        **more: Any) -> Json:
    """A uniform bar whose frame sits at its near end."""
    return body(name, near, angle, length / 2, kilograms, kilograms * length**2 / 12, **more)


def mass(name: str, kilograms: float, at: complex, **more: Any) -> Json:
    """A point mass: its inertia is there because every body has one, and nothing turns it."""
    return {"name": name, "at": point(at), "mass": kilograms, "inertia": 1e-3 * kilograms, **more}


def pin(a: str, b: str, on_b: complex = 0.0) -> Json:
    """A hinge named after both bodies."""
    return {"type": "pin", "name": f"{a}_{b}", "a": a, "b": b, "on_b": point(on_b)}
