"""What the compiled step works on: constants, the state of a run, what the last step gave.

Three records, so that each number is one of three things: it never changes
(:class:`Constants`), the next step needs it (:class:`State`), or it is only reported
(:class:`Result`). A run is its constants, its state and pymunk's space; the state can be
copied, the space cannot. Bodies are numbered as pymunk lists them (``World.order``);
points of bodies are relative to their centres of mass, along the body's axes.

nb bodies, na actions of drives, ns straight springs, nh damped hinges, nt tendons, ng
guides, m tendons that are solved together.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.numeric import Array, Integers, Records

TENDON, PULL, ELASTIC = 0, 1, 2
"""Kinds of cord: solved with the others; of given tension; soft enough to be taken as it is."""

ACTION = np.dtype([
    ("drive", np.int64),    # whose value it takes
    ("a", np.int64),        # the body of a force; the first body of a hinge
    ("b", np.int64),        # -1 for a force; the second body of the hinge
    ("x", float), ("y", float),     # where a force acts [m]
    ("dx", float), ("dy", float),   # its direction, a unit vector
    ("turning", np.int64),  # whether that turns with the body
    ("spring", np.int64),   # -1, or the rotary spring whose stiffness the drive sets
    ("rest", float),        # angle of b against a at which that spring is at rest [rad]
    ("motor", np.int64),    # 0, or the address of the impulse of a motor or brake (pymunk's)
    ("sense", float),       # from a counter-clockwise turn to the hinge's positive one
])
ACTION_STATE = np.dtype([
    ("work", float),        # done on the bodies since t = 0 [J]
])
ACTION_RESULT = np.dtype([
    ("fx", float), ("fy", float),   # of a force, in the world [N]
    ("torque", float),      # about the centre of mass of a, or on b of a hinge [N m]
    ("step_work", float),   # of the last step [J]
])

SPRING = np.dtype([
    ("drive", np.int64),    # that sets its stiffness; -1 for its own
    ("a", np.int64), ("ax", float), ("ay", float),  # body and point of one end [m]
    ("b", np.int64), ("bx", float), ("by", float),
    ("k", float),           # [N/m]
    ("c", float),           # [N s/m]
    ("rest", float),        # [m]
    ("sharing", float),     # how many dampers answer together on its busier body
])
SPRING_STATE = np.dtype([
    ("damping", float),     # force of its damper [N]
    ("work", float),        # [J]
])
SPRING_RESULT = np.dtype([
    ("length", float),      # [m]
    ("force", float),       # positive pulls [N]
    ("ux", float), ("uy", float),   # direction from a to b
    ("ta", float), ("tb", float),   # its moment about either centre of mass, for 1 N [m]
    ("step_work", float),   # [J]
])

DAMPER = np.dtype([
    ("a", np.int64), ("b", np.int64),   # bodies of the hinge
    ("c", float),           # [N m s/rad]
    ("joint", np.int64),    # number of the hinge
    ("block", np.int64),    # where its row of the inverse matrices begins
    ("first", np.int64), ("size", np.int64),    # the dampers that share that matrix
])
DAMPER_STATE = np.dtype([
    ("torque", float),      # on b [N m]
    ("work", float),        # [J]
])
DAMPER_RESULT = np.dtype([
    ("wanted", float),      # change of torque, were it alone [N m]
    ("step_work", float),   # [J]
])

CORD = np.dtype([
    ("first", np.int64), ("last", np.int64),    # its guides
    ("kind", np.int64),     # TENDON, PULL or ELASTIC
    ("drive", np.int64),    # that pulls it, or -1
    ("k", float),           # [N/m]
    ("c", float),           # [N s/m]
    ("rest", float),        # length up to which it is slack [m]
    ("response", float),    # largest J M^-1 J^T in any pose [1/kg]
])
CORD_STATE = np.dtype([
    ("active", np.int64),   # whether it pulled in the last solve
    ("damping", float),     # force of the damper of an elastic one [N]
    ("work", float),        # [J]
])
CORD_RESULT = np.dtype([
    ("length", float),      # [m]
    ("tension", float),     # [N]
    ("step_work", float),   # [J]
])

GUIDE = np.dtype([
    ("body", np.int64), ("x", float), ("y", float),     # place [m]
    ("radius", float),      # of the wheel, positive where its centre lies right of the path [m]
])
GUIDE_STATE = np.dtype([
    ("wrap", float),        # angle round the wheel, or where a wound cord leaves it [rad]
    ("wrap0", float),       # the same at t = 0, of a wound cord
])
GUIDE_RESULT = np.dtype([
    ("jx", float), ("jy", float),   # dL/dx, dL/dy of the body
    ("jt", float),          # dL/dangle [m]
])


class Constants(NamedTuple):
    """What no step changes."""

    h: float
    """The step [s]."""
    inverse_mass: Array
    """1 / mass and 1 / inertia, [nb, 2]; 0 for bodies that do not move freely."""
    actions: Records
    """ACTION, [na]."""
    springs: Records
    """SPRING, [ns]."""
    dampers: Records
    """DAMPER, [nh]."""
    damper_inverse: Array
    """Inverses of I + h/2 C A of the dampers that share bodies, row by row."""
    cords: Records
    """CORD, [nt]."""
    guides: Records
    """GUIDE, [ng]."""
    rows: Integers
    """The tendon of each row of the network's matrix, [m]."""
    pairs: Integers
    """(slot, guide, guide) that add up to the matrix's entries, [p, 3]."""
    starts: Integers
    """Where the slots of each row begin, and their end, [m + 1]; the diagonal comes last."""
    columns: Integers
    """The column of each slot."""


class State(NamedTuple):
    """All that changes in a run and that the next step needs."""

    body: Array
    """x, y, angle, vx, vy, omega of the centres of mass, [nb, 6]; pymunk's, filled after steps."""
    before: Array
    """Velocities one step earlier, [nb, 3]."""
    force: Array
    """Force and torque that acted in the last step [N, N m], [nb, 3]."""
    held: Array
    """Change of velocity in a step that is not of our doing, a running mean, [nb, 3]."""
    actions: Records
    """ACTION_STATE, [na]."""
    springs: Records
    """SPRING_STATE, [ns]."""
    dampers: Records
    """DAMPER_STATE, [nh]."""
    cords: Records
    """CORD_STATE, [nt]."""
    guides: Records
    """GUIDE_STATE, [ng]."""


class Result(NamedTuple):
    """What the last step gave; no step reads it."""

    pose: Array
    """Predicted pose at which forces were worked out, [nb, 3]."""
    actions: Records
    """ACTION_RESULT, [na]."""
    springs: Records
    """SPRING_RESULT, [ns]."""
    dampers: Records
    """DAMPER_RESULT, [nh]."""
    cords: Records
    """CORD_RESULT, [nt]."""
    guides: Records
    """GUIDE_RESULT, [ng]."""
    scratch: Array
    """Memory for the network's matrix, its factor and two right sides, [4, slots]."""
