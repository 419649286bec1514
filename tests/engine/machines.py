"""Helpers that build mechanisms, and an engine stepped by hand."""

from __future__ import annotations

from typing import Any

import numpy as np

from sandbox.audit.audit import audit
from sandbox.engine.advance import UNKEPT, advance
from sandbox.engine.entry_points import prepare
from sandbox.engine.memory import make_memory
from sandbox.engine.snapshot import make_snapshot
from sandbox.engine.tables import make_tables
from sandbox.engine.world import World
from sandbox.model.compile import compile_mechanism
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

G = 9.81
H = 5e-4


def mechanism(*, duration: float = 0.1, step: float = H, **elements: Any) -> Mechanism:
    """A mechanism of the given elements, run for ``duration`` [s] in steps of ``step`` [s]."""
    run = {"duration": duration, "step": step, "sample_rate": 1 / step, **elements.pop("run", {})}
    return Mechanism.model_validate({"run": run, **elements})


def sound(run: Recording) -> Recording:
    """A run whose audit finds nothing."""
    wrong = {f.name: f.why for f in audit(run) if f.verdict == "look"}
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


def cord(name: str, *guides: tuple[Any, ...], **more: Any) -> dict[str, Any]:
    """A tendon through (body, at, radius, side), cut short where the rest is plain."""
    keys = ("body", "at", "radius", "side")
    return {"name": name, "guides": [dict(zip(keys, g, strict=False)) for g in guides], **more}


class Bench:
    """A mechanism stepped one step at a time, with the engine's tables."""

    def __init__(self, machine: Mechanism) -> None:
        self.world = world = World(compile_mechanism(machine))
        self.tables = tables = make_tables(world)
        self.constants, self.elements, self.state, self.result, _ = tables
        self.kept = make_snapshot(1, tables, 2 * self.world.room.contacts)
        self.memory = make_memory(self.world.native, *tables, self.kept,
                                  prepare(self.constants, self.elements, advance))

    def step(self, *drive: float, speeds: Any = None) -> Bench:
        """Make one step with the drives' values; ``speeds`` [ns, 3] are of scheduled bodies."""
        moved = np.zeros((len(self.constants.scheduled), 3)) if speeds is None else speeds
        made = advance(self.memory.address, self.world.h, np.array([drive]),
                       np.array([moved], dtype=float), UNKEPT, UNKEPT)
        assert made == 1
        return self
