"""Why a run diverged or jammed."""

from __future__ import annotations

from collections.abc import Container

import numpy as np

from sandbox.engine.control import Control
from sandbox.engine.fluids import FULL
from sandbox.engine.tables import Tables
from sandbox.engine.world import World
from sandbox.errors import Jammed, SimulationDiverged
from sandbox.model.supports import together

MIN_SHARE = 0.01  # of the impulses of a jam, in the largest: smaller rows are left out


def diverged(now: float, world: World, tables: Tables, control: Control) -> SimulationDiverged:
    """The error of a run that diverged at ``now`` [s], with its probable cause."""
    model = world.model
    if tables.state.standing[3]:
        return _jammed(now, world, tables)
    pressure, content = (tables.elements.fluids[name] for name in ("pressure", "content"))
    burst = np.flatnonzero(~(np.abs(pressure) < FULL) | ~(np.abs(content) < FULL))
    if len(burst):
        return SimulationDiverged(
            now, model.lines.name[burst[0]],
            "its pressure has run away; a relief, or a smaller flow, may help")
    loads = model.loads
    given = tables.elements.loads
    for load in given["number"][~np.isfinite(given["fx"] + given["fy"] + given["torque"])]:
        return SimulationDiverged(
            now, model.bodies.name[loads.body[load]],
            f"the load {model.mechanism.loads[loads.load[load]].name!r} has no finite "
            "value there: a division by zero, or out of range")
    body = np.abs(world.body)
    finite = np.isfinite(body).all(axis=1)
    worst = int(np.argmin(finite) if not finite.all() else np.argmax(body.max(axis=1)))
    reason = "its motion has run away" if finite.all() else "its motion is no longer a number"
    helps = f"smaller forces, or a smaller run.step than {world.h:g} s, may help"
    driver = _driver(tables, _joined(world, worst))
    if driver is not None:
        reason += (f", driven by {model.bodies.name[world.order[driver]]}, which moves on a "
                   "schedule: past a dead centre or out of reach the connected bodies cannot "
                   "follow")
    if loop := control.furthest():
        reason += f", driven by {loop}"
        helps = f"gains of the other sign, smaller ones or limits may help; or {helps}"
    return SimulationDiverged(now, model.bodies.name[world.order[worst]], f"{reason}; {helps}")


def _driver(tables: Tables, bodies: Container[int]) -> int | None:
    """The first of some bodies, in pymunk's order, that moves on a schedule."""
    return next((body for body in tables.constants.scheduled.tolist()
                 if tables.result.velocity[body].any() and body in bodies), None)


def _joined(world: World, body: int) -> set[int]:
    """The bodies, in pymunk's order, that joints connect with one through free bodies."""
    groups = (set(world.number[world.model.joints.bodies[joints]].ravel().tolist())
              for joints in together(world.model))
    return next((found for found in groups if body in found), set())


def _jammed(now: float, world: World, tables: Tables) -> Jammed:
    which, n = tables.state.standing[3:5].tolist()
    row, rows = tables.result.rows[which - 1], tables.result.rows[:n]
    names = [world.model.bodies.name[number] for number in world.order]
    jam = rows[(np.abs(rows["p"]) >= MIN_SHARE * abs(row["p"])) & (rows["a"] < len(names))]
    jam = jam if row["p"] else rows[which - 1:which]  # left out, it has no impulse
    pairs = np.stack([jam["a"], jam["b"]], axis=1).tolist()
    found = {body for pair in pairs for body in pair}
    joined = set().union(*(_joined(world, body) for body in found))
    driver = next(body for body in (_driver(tables, some) for some in (
        found, joined, range(len(names)))) if body is not None)
    free = tables.constants.inverse_mass[:, 0] > 0
    walls = [pair for pair in pairs if any(not free[body] and body != driver for body in pair)]
    one, other = sorted((walls or pairs)[0], key=lambda body: (body != driver, not free[body]))
    what = f"drives {names[one]} against" if one != driver else "is driven against"
    return Jammed(now, names[driver], f"{names[driver]}, which moves on a schedule, {what} "
                  f"{names[other]}, and neither can move away")
