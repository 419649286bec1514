"""Short ways to spell out mechanisms, and the engine's parts laid bare."""

from __future__ import annotations

from typing import Any

import numpy as np

from sandbox.engine.tables import Tables, make_tables
from sandbox.engine.world import World
from sandbox.scene.mechanism import Mechanism

G = 9.81
H = 5e-4


def mechanism(*, duration: float = 0.1, step: float = H, **elements: Any) -> Mechanism:
    """A mechanism of the given elements, run for ``duration`` [s] in steps of ``step`` [s]."""
    run = {"duration": duration, "step": step, "sample_rate": 1 / step, **elements.pop("run", {})}
    return Mechanism.model_validate({"run": run, **elements})


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


def cord(name: str, *guides: tuple[Any, ...], **more: Any) -> dict[str, Any]:
    """A tendon through (body, at, radius, side), cut short where the rest is plain."""
    keys = ("body", "at", "radius", "side")
    return {"name": name, "guides": [dict(zip(keys, g, strict=False)) for g in guides], **more}


def parts(machine: Mechanism) -> tuple[World, Tables]:
    world = World(machine)
    return world, make_tables(
        machine, world.h, world.number, world.mass, world.motor_impulses)


def inverse_masses(tables: Tables) -> np.ndarray:
    """Inverse masses of all coordinates (x, y, angle of each body in turn), shape [3 nb]."""
    return np.stack([tables.inverse_mass[:, 0], *tables.inverse_mass.T], axis=1).ravel()


def rows_of(tables: Tables) -> np.ndarray:
    """J of all tendons, dense, [nt, 3 nb], from what ``measure`` left in the guides."""
    J = np.zeros((len(tables.spans), 3 * len(tables.inverse_mass)))
    for i, span in enumerate(tables.spans):
        for node in tables.nodes[span["first"]:span["last"]]:
            b = 3 * node["body"]
            J[i, b:b + 3] += node["jx"], node["jy"], node["jt"]
    return J
