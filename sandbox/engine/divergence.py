"""What a run is ended with whose motion is no longer sound: who is to blame, what may help."""

from __future__ import annotations

import numpy as np

from sandbox.engine.fluid_report import FULL
from sandbox.engine.steering import Steering
from sandbox.engine.tables import Tables
from sandbox.engine.world import World
from sandbox.errors import SimulationDiverged


def diverged(now: float, world: World, tables: Tables, steering: Steering) -> SimulationDiverged:
    """What to say at ``now`` [s]: the body that is worst and the loop that led there."""
    model = world.model
    pressure, content = tables.result.fluids["pressure"], tables.state.fluids["content"]
    burst = np.flatnonzero(~(np.abs(pressure) < FULL) | ~(np.abs(content) < FULL))
    if len(burst):
        return SimulationDiverged(
            now, model.lines.name[burst[0]],
            "its pressure has run away; a relief, or a smaller flow, may help")
    loads = model.loads
    number = tables.constants.loads["number"]
    for row, out in zip(number.tolist(), tables.result.loads, strict=True):
        if not np.isfinite([out["fx"], out["fy"], out["torque"]]).all():
            return SimulationDiverged(
                now, model.bodies.name[loads.body[row]],
                f"the load {model.mechanism.loads[loads.load[row]].name!r} has no finite "
                "value there: a division by zero, or out of range")
    body = np.abs(world.body)
    finite = np.isfinite(body).all(axis=1)
    worst = np.argmin(finite) if not finite.all() else np.argmax(body.max(axis=1))
    reason = "its motion has run away" if finite.all() else "its motion is no longer a number"
    helps = f"smaller forces, or a smaller run.step than {world.h:g} s, may help"
    if loop := steering.furthest():
        reason += f", led by {loop}"
        helps = f"gains of the other sign, smaller ones or limits may help; or {helps}"
    return SimulationDiverged(
        now, model.bodies.name[world.order[worst]], f"{reason}; {helps}")
