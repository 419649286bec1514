"""Short ways to spell out mechanisms, and the engine's parts laid bare."""

from __future__ import annotations

from typing import Any

import numpy as np

from sandbox.engine.tables import Tables, make_tables
from sandbox.engine.world import World
from sandbox.model.compile import compile_mechanism
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
    world = World(compile_mechanism(machine))
    return world, make_tables(
        world.model, world.h, world.order, world.motor_impulses, world.body, world.force)


def inverse_masses(tables: Tables) -> np.ndarray:
    """Inverse masses of all coordinates (x, y, angle of each body in turn), shape [3 nb]."""
    inverse = tables.constants.inverse_mass
    return np.stack([inverse[:, 0], *inverse.T], axis=1).ravel()


def rows_of(tables: Tables) -> np.ndarray:
    """J of all tendons, dense, [nt, 3 nb], from what ``measure`` left in the guides."""
    constants, result = tables.constants, tables.result
    J = np.zeros((len(constants.cords), 3 * len(constants.inverse_mass)))
    for i, cord in enumerate(constants.cords):
        for n in range(cord["first"], cord["last"]):
            b, row = 3 * constants.guides[n]["body"], result.guides[n]
            J[i, b:b + 3] += row["jx"], row["jy"], row["jt"]
    return J
