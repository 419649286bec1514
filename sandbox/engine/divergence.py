"""What a run is ended with whose motion is no longer sound: who is to blame, what may help."""

from __future__ import annotations

from collections.abc import Container

import numpy as np

from sandbox.engine.control import Control
from sandbox.engine.fluids import FULL
from sandbox.engine.tables import Tables
from sandbox.engine.world import World
from sandbox.errors import Jammed, SimulationDiverged
from sandbox.model.supports import together

PRESSES = 0.01  # minimum impulse of the rows of a jam, as a share of the largest


def diverged(now: float, world: World, tables: Tables, control: Control) -> SimulationDiverged:
    """What to say at ``now`` [s]: the body that is worst and the loop that led there."""
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
    for out in tables.elements.loads:
        if not np.isfinite([out["fx"], out["fy"], out["torque"]]).all():
            row = out["number"]
            return SimulationDiverged(
                now, model.bodies.name[loads.body[row]],
                f"the load {model.mechanism.loads[loads.load[row]].name!r} has no finite "
                "value there: a division by zero, or out of range")
    body = np.abs(world.body)
    finite = np.isfinite(body).all(axis=1)
    worst = np.argmin(finite) if not finite.all() else np.argmax(body.max(axis=1))
    reason = "its motion has run away" if finite.all() else "its motion is no longer a number"
    helps = f"smaller forces, or a smaller run.step than {world.h:g} s, may help"
    driver = _driver(tables, _joined(world, int(worst)))
    if driver >= 0:
        reason += (f", driven by {model.bodies.name[world.order[driver]]}, which moves on a "
                   "schedule: past a dead centre or out of reach the connected bodies cannot "
                   "follow")
    if loop := control.furthest():
        reason += f", led by {loop}"
        helps = f"gains of the other sign, smaller ones or limits may help; or {helps}"
    return SimulationDiverged(
        now, model.bodies.name[world.order[worst]], f"{reason}; {helps}")


def _driver(tables: Tables, bodies: Container[int]) -> int:
    """The first of some bodies, in pymunk's order, that moves on a schedule; -1 for none."""
    moving = [body for body in tables.constants.scheduled.tolist()
              if tables.result.velocity[body].any() and body in bodies]
    return moving[0] if moving else -1


def _joined(world: World, body: int) -> set[int]:
    """The bodies, in pymunk's order, that joints bond to one by way of free bodies."""
    place = {number: i for i, number in enumerate(world.order)}
    for joints in together(world.model):
        found = {place[number] for number in world.model.joints.bodies[joints].ravel().tolist()}
        if body in found:
            return found
    return set()


def _jammed(now: float, world: World, tables: Tables) -> Jammed:
    """Which body a schedule drives into which."""
    which, n = tables.state.standing[3:5].tolist()
    row, rows = tables.result.rows[which - 1], tables.result.rows[:n]
    names = [world.model.bodies.name[number] for number in world.order]
    jam = rows[(np.abs(rows["p"]) >= PRESSES * abs(row["p"])) & (rows["a"] < len(names))]
    jam = jam if row["p"] else rows[which - 1:which]  # left out, it has no impulse
    pairs = np.stack([jam["a"], jam["b"]], axis=1).tolist()
    found = {body for pair in pairs for body in pair}
    joined = set().union(*(_joined(world, body) for body in found))
    driver = next(body for body in (_driver(tables, some) for some in (
        found, joined, range(len(names)))) if body >= 0)
    free = tables.constants.inverse_mass[:, 0] > 0
    walls = [pair for pair in pairs if any(not free[body] and body != driver for body in pair)]
    one, other = sorted((walls or pairs)[0], key=lambda body: (body != driver, not free[body]))
    who = f"{names[driver]}, which moves on a schedule, "
    what = f"drives {names[one]} against" if one != driver else "is driven against"
    return Jammed(now, names[driver],
                  f"{who}{what} {names[other]}, and neither can move away")
