"""Groups of elements in the phases of a step.

A group is a set of elements that are solved together, such as all tendons, with a function for some
of the phases, mostly an entry point, which is compiled for scenes with the group only. The step and
its solve use the phases only:

    apply_forces    measure coordinates at the pose; apply the forces that follow from it
    set_rows        bilateral rows that the pose determines, before the solve
    update_rows     bilateral rows that depend on active sets, before each factorisation
    couple_rows     terms of the matrix between two rows, in each factorisation
    limit_rates     rates of bounded rows that depend on the other rows
    change          active sets and linearisations, after each solve
    is_changing     whether a mechanism whose bodies rest changes nevertheless
    is_valid        whether the results are in their ranges
"""

from __future__ import annotations

from typing import Any

from sandbox.engine import fluids, loads, springs, tendons
from sandbox.engine.bonds import release_rows
from sandbox.engine.joint_friction import change_friction
from sandbox.engine.kernel import kernel
from sandbox.engine.motors import brake_in_time, drive_forces
from sandbox.engine.rows import joint_rows
from sandbox.numeric import Array

# phases of one group
couple_rows, limit_rates, is_valid = fluids.join_lines, brake_in_time, fluids.contained


@kernel
def apply_forces(table: int, h: float, drive: Array) -> None:
    """Measure the coordinates of all groups and add the forces that follow from the pose."""
    drive_forces(table, drive)
    springs.stretch(table, drive)
    tendons.pull(table, drive)
    fluids.measure_volumes(table, drive)
    loads.press(table, h)


@kernel
def set_rows(table: int, h: float, drive: Array) -> None:
    """Set the rows that the pose determines, and the initial active sets."""
    joint_rows(table, h)
    springs.spring_rows(table, h, drive)
    springs.law_rows(table, h, drive)
    loads.load_rows(table, h)
    release_rows(table, h)
    tendons.slacken(table)


@kernel
def update_rows(table: int, h: float, drive: Array) -> None:
    """Set the rows that depend on active sets."""
    tendons.cable_rows(table, h)
    fluids.fluid_rows(table, h, drive)


@kernel
def change(table: int, h: float, drive: Array, attempt: int, n: int, again: bool) -> Any:
    """Change contradicted active sets and linearisations: whether any; whether it converges."""
    changed, converging = springs.change_laws(table, h, drive), loads.change_loads(table, h)
    changed |= change_friction(table, n)
    changed |= (again or tendons.change_cables(table, h, attempt)
                or fluids.change_lines(table, h, drive, attempt))
    return changed, converging


@kernel
def is_changing(table: int) -> bool:
    """Whether fluid flows or a load depends on time."""
    return bool(fluids.flowing(table) or loads.timed(table))
