"""Short ways to spell out mechanisms, and the engine's parts laid bare."""

from __future__ import annotations

from typing import Any

import numpy as np

from sandbox.engine.advance import UNKEPT, advance
from sandbox.engine.entry_points import prepare
from sandbox.engine.memory import make_memory
from sandbox.engine.snapshot import make_snapshot
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
    """pymunk's world of a mechanism and the tables of its elements, as a run makes them."""
    world = World(compile_mechanism(machine))
    return world, make_tables(world.model, world.h, world.order, world.body, world.velocity,
                              world.filters, world.shape_table, world.face_table, world.room)


class Bench:
    """A mechanism on the bench: the compiled loop makes a step at a time, its tables in view."""

    def __init__(self, machine: Mechanism) -> None:
        self.world, self.tables = parts(machine)
        self.constants, self.state, self.result, _ = self.tables
        drives = len(self.world.model.drives.name)
        self.kept = make_snapshot(1, self.constants, drives, 2 * self.world.room.contacts)
        self.memory = make_memory(self.world.native, *self.tables[:3], self.kept,
                                  prepare(self.constants, advance))

    def step(
        self, *drive: float, speeds: Any = None, steps: int = 1, due: int = UNKEPT,
    ) -> Bench:
        """Make steps with the drives' values; ``speeds`` [ns, 3] are those of scheduled bodies.

        Step ``due`` is kept as a sample.
        """
        moved = np.zeros((len(self.constants.scheduled), 3)) if speeds is None else speeds
        made = advance(self.memory.address, self.world.h, np.tile(np.array(drive), (steps, 1)),
                       np.tile(np.array(moved, dtype=float), (steps, 1, 1)), due, due)
        assert made == steps
        return self

    def number(self, body: str) -> int:
        """The row of a body."""
        return int(self.world.number[self.world.model.names.body[body]])

    def throw(self, velocity: Any) -> Bench:
        """Give all bodies velocities [nb, 3]."""
        self.world.velocity[:] = velocity
        self.world.write()
        self.world.read()
        return self


def inverse_masses(tables: Tables) -> np.ndarray:
    """Inverse masses of all coordinates (x, y, angle of each body in turn), shape [3 nb]."""
    inverse = tables.constants.inverse_mass
    return np.stack([inverse[:, 0], *inverse.T], axis=1).ravel()


def rows_of(tables: Tables) -> np.ndarray:
    """The bilateral rows of the last step, dense, [m, 3 nb], from its entries; no hubs."""
    constants, J = tables.constants, tables.result.entries[0]
    dense = np.zeros((tables.result.unknowns.shape[1], 3 * len(constants.inverse_mass)))
    for row, body, values in zip(constants.entry_row, constants.entry_body, J, strict=True):
        dense[row, 3 * body:3 * body + 3] += values
    return dense
