"""What the compiled step works on: constants, the state of a run, what the last step gave.

Three records, so that each number is one of three things: it never changes
(:class:`Constants`), the next step needs it (:class:`State`), or it is only reported
(:class:`Result`). A run is its constants, its state and where pymunk's bodies are. Bodies are
numbered as pymunk lists them (``World.order``); points of bodies are relative to their centres
of mass, along the body's axes.

nb bodies, na actions of drives and rotary springs, ns straight springs, nh damped hinges, nt
tendons, ng guides (first those of tendons, then those of spans), nf guides with friction, nw
wheels that a cord can lift off, nj joints, nl limits, nm motors and brakes, nu joints with dry
friction, nz shapes; nq lines of fluid, nc chambers, nv valves, np pumps
(:mod:`sandbox.engine.fluid_state`); nk loads on no bodies (:mod:`sandbox.engine.load_state`); nr
joints, springs and tendons that may be let go (:mod:`sandbox.engine.tie_state`); nd
drives of the model, those of motors and brakes among them; m unknowns of the bilateral rows
(:mod:`sandbox.engine.plan`), ne entries of these; r bounded rows there is room for.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.numeric import Array, Integers, Records

STIFF, PULL, ELASTIC, DAMPED, EVEN, GRIPPED = 0, 1, 2, 3, 4, 5
"""Kinds of cord and straight spring: solved at the step's end; of given tension; soft, its tension
that of the pose; soft with a damper, solved at mid-step. Of spans of a cord that guides hold by
friction: soft, solved evenly about the pose; and that cord as a whole, whose spans pull."""
STILL, STILL_TURNING = 1e-11, 1e-10
"""Where nothing moves faster [m/s, rad/s] all is at rest, and contacts carry what they carried."""
SOFT = 1.0
"""h^2 k s from which on an element is solved at the step's end (:mod:`sandbox.engine.stiffness`); a
leapfrog breaks down at 4."""
NORMAL, TANGENT, LIMITED, DRIVEN, SLIPPING, PULLED, RUBBING, PRESSED = 0, 1, 2, 3, 4, 5, 6, 7
"""Where a bounded row comes from: a contact's two, a limit, a motor or brake; friction between a
guide and its cord, and what that is measured by: the sum of the tensions on either side; friction
in a joint, and its measure: what the joint carries."""
SLIDES, HOLDS, TRIED = 0, 1, 2
"""Phases of a row with static friction in a step: it has sliding friction; static friction; or it
slipped against that, and sliding friction is tried (:mod:`sandbox.engine.breakaway`)."""

ACTION = np.dtype([
    ("drive", np.int64),    # whose value it takes, -1 for a spring of constant stiffness
    ("a", np.int64),        # the body of a force; the first body of a hinge
    ("b", np.int64),        # -1 for a force; the second body of the hinge
    ("x", float), ("y", float),     # where a force acts [m]
    ("dx", float), ("dy", float),   # its direction, a unit vector
    ("turning", np.int64),  # whether that turns with the body
    ("line", np.int64),     # the actuator that is pushed, or -1
    ("spring", np.int64),   # -1, or the rotary spring
    ("k", float),           # its stiffness, if no drive sets it [N m/rad]
    ("rest", float),        # angle of b against a at which that spring is at rest [rad]
    ("motor", np.int64),    # -1, or the number of a motor or brake
    ("sense", float),       # from a counter-clockwise turn to the hinge's positive one
    ("row", np.int64),      # unknown of a rotary spring too stiff for the step, or -1
    ("entry", np.int64),    # the first of its two entries
    ("code", np.int64), ("code_end", np.int64),     # steps of a rotary spring's law, or -1
    ("of_rate", np.int64),  # whether that hangs on the rate
    ("response", float),    # how its ends answer a unit torque, at most [1/(kg m^2)]
    ("tie", np.int64), ("hinge_tie", np.int64),     # TIE of a spring and of its hinge, or -1
    ("runs", np.int64),     # whether it is the surface of a that runs
])
ACTION_STATE = np.dtype([
    ("work", float),        # done on the bodies since t = 0 [J]
])
ACTION_RESULT = np.dtype([
    ("fx", float), ("fy", float),   # of a force, in the world [N]
    ("torque", float),      # about the centre of mass of a, or on b of a hinge [N m]; of a surface
                            # that runs its power [W]
    ("stiff", np.int64),    # whether a law is taken at the step's end
    ("step_work", float),   # of the last step [J]
])

SPRING = np.dtype([
    ("kind", np.int64),     # STIFF, ELASTIC or DAMPED
    ("drive", np.int64),    # that sets its stiffness; -1 for its own
    ("a", np.int64), ("ax", float), ("ay", float),  # body and point of one end [m]
    ("b", np.int64), ("bx", float), ("by", float),
    ("k", float),           # [N/m]
    ("c", float),           # [N s/m]
    ("row", np.int64),      # its unknown, or -1
    ("entry", np.int64),    # the first of its two entries
    ("code", np.int64), ("code_end", np.int64),     # steps of its law, or -1
    ("of_rate", np.int64),  # whether that hangs on the rate
    ("response", float),    # how its ends answer a unit push, at most [1/kg]
    ("tie", np.int64),      # its TIE, or -1
])
SPRING_STATE = np.dtype([
    ("rest", float),        # length at rest [m]
    ("work", float),        # [J]
])
SPRING_RESULT = np.dtype([
    ("length", float),      # [m]
    ("force", float),       # positive pulls [N]
    ("ux", float), ("uy", float),   # direction from a to b
    ("ta", float), ("tb", float),   # its moment about either centre of mass, for 1 N [m]
    ("stiff", np.int64),    # whether a law is taken at the step's end
    ("step_work", float),   # [J]
])

DAMPER = np.dtype([
    ("a", np.int64), ("b", np.int64),   # bodies of the hinge
    ("c", float),           # [N m s/rad]
    ("joint", np.int64),    # number of the hinge
    ("row", np.int64), ("entry", np.int64),     # its unknown, the first of its two entries
])
DAMPER_STATE = np.dtype([
    ("torque", float),      # on b [N m]
    ("work", float),        # [J]
])
DAMPER_RESULT = np.dtype([
    ("step_work", float),   # [J]
])

BOUND = np.dtype([
    ("source", np.int64), ("index", np.int64),  # NORMAL ... DRIVEN, and which one
    ("a", np.int64), ("b", np.int64),
    ("ax", float), ("ay", float), ("at", float),    # y = these times the velocities of a and b
    ("bx", float), ("by", float), ("bt", float),
    ("want", float),        # added to y [m/s, rad/s]
    ("trend", float),       # of impacts: how y, "want" at the pose, changes in the step [m/s^2]
    ("gap", float), ("closing", float), ("bend", float),    # gap there, its rate, how that changes
    ("soft", float),        # of what a drive gives: y for an impulse of 1, besides
    ("normal", np.int64),   # of a tangential row the normal one; -1 of others
    ("friction", float),
    ("low", float), ("high", float),    # of the impulse, of rows that are not tangential
    ("static", float),      # static over sliding friction, of rows in joints and of contacts
    ("phase", np.int64),    # of these: SLIDES, HOLDS or TRIED
    ("spare", float),       # bound in the last step, then what was left of it; nan where unknown
    ("gave", float),        # impulse of the last step, then that with static friction
    ("slip", float),        # mode of the last step, then rate of slip with static friction
    ("mode", np.int64),     # -1, 0, 1: at low, in between (y = 0), at high
    ("last", float),        # impulse of the last step, which fades where it moves
    ("p", float),           # impulse
    ("free", float),        # y without bounded rows
    ("base", float),        # y for an impulse of 1, bilateral rows left out
    ("back", float),        # how much of free asks an overlap back, not above 0
    ("out", np.int64),      # whether joints hold it, so that it neither sees nor gives anything
    ("branch", np.int64),   # how many unknowns its column has
    ("wrong", float),       # by what rate its mode is broken
])

BODY = np.dtype([
    ("number", np.int64),   # the model's
    ("x", float), ("y", float),     # the centre of mass in the body's frame [m]
])


class Constants(NamedTuple):
    """What no step changes."""

    h: float
    """The step [s]."""
    gravity: Array
    """[m/s^2], [2]."""
    inverse_mass: Array
    """1 / mass and 1 / inertia, [nb, 2]; 0 for bodies that do not move freely."""
    bodies: Records
    """BODY, [nb]."""
    scheduled: Integers
    """Numbers of the bodies that move as a schedule has it."""
    actions: Records
    """ACTION, [na]."""
    springs: Records
    """SPRING, [ns]."""
    dampers: Records
    """DAMPER, [nh]."""
    cords: Records
    """CORD, [nt]."""
    guides: Records
    """GUIDE, [ng]."""
    slips: Records
    """SLIP, [nf]."""
    wheels: Integers
    """Guides whose wheels a cord can lift off, [nw]."""
    joints: Records
    """JOINT, [nj]."""
    limits: Records
    """LIMIT, [nl]."""
    motors: Records
    """MOTOR, [nm]."""
    rubs: Records
    """RUB, [nu]."""
    fluids: Records
    """FLUID, [nq]."""
    chambers: Records
    """CHAMBER, [nc]."""
    valves: Records
    """VALVE, [nv]."""
    pumps: Records
    """PUMP, [np]."""
    loads: Records
    """LOAD, [nk], those of a body side by side."""
    loaded: Records
    """LOADED, [no]."""
    sides: Array
    """Outlines of what liquids lift, from the centres of mass (:mod:`sandbox.model.loads`)."""
    ties: Records
    """TIE, [nr]."""
    shapes: Records
    """SHAPE, [nz]."""
    faces: Records
    """FACE, those of a shape side by side."""
    vertices: Array
    """Corners of the shapes' cores, from the centres of mass [m], [n, 2]."""
    spans: Records
    """SPAN, those of a curve side by side."""
    steps: Records
    """STEP of the programs of all laws (:mod:`sandbox.model.programs`)."""
    curves: Records
    """CURVE of the scene's tables."""
    knots: Records
    """KNOT of these."""
    friction: Array
    """Coefficient of every pair of bodies, negative where they may not touch, [nb, nb]."""
    static: Array
    """Static over sliding friction of every pair of bodies, [nb, nb]."""
    restitution: Array
    """Of every pair of bodies, [nb, nb]."""
    starts: Integers
    """This and what follows: :class:`sandbox.engine.plan.Pattern`."""
    below: Integers
    updates: Integers
    entry_row: Integers
    entry_body: Integers
    pairs: Integers
    direct: Integers
    body_starts: Integers
    body_entries: Integers
    branch_starts: Integers
    branches: Integers
    hubs: Integers


class State(NamedTuple):
    """All that changes in a run and that the next step needs."""

    body: Array
    """x, y, angle, vx, vy, omega of the centres of mass, [nb, 6]; pymunk's, filled after moves."""
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
    slips: Records
    """SLIP_STATE, [nf]."""
    joints: Records
    """JOINT_STATE, [nj]."""
    limits: Records
    """LIMIT_STATE, [nl]."""
    motors: Records
    """MOTOR_STATE, [nm]."""
    rubs: Records
    """RUB_STATE, [nu]."""
    fluids: Records
    """FLUID_STATE, [nq]."""
    valves: Records
    """VALVE_STATE, [nv]."""
    pumps: Records
    """PUMP_STATE, [np]."""
    loads: Records
    """LOAD_STATE, [nk]."""
    made: Integers
    """Steps made, this one among them, but for those in which all was at rest; which of those made
    in one go this one is, from 0; how many of ``broken`` and of ``impacts`` are filled, [4]."""
    ties: Records
    """TIE_STATE, [nr]."""
    broken: Records
    """BROKEN, what broke in the steps made in one go; room for more than do."""
    impacts: Records
    """IMPACT of the steps made in one go, [contacts] or more."""
    touches: Records
    """TOUCH of the last step, [contacts]."""
    touching: Integers
    """How many of these there are; whether a step waits for room to be gone on with, [2]."""
    last_drive: Array
    """Values of the drives in the last step, [nd]."""
    standing: Integers
    """In how many steps modes were not found; for how many steps all has been at rest; how often
    modes were not found in this step; which row is jammed, from 1, or 0; how many rows; in how many
    steps impacts were too many to be put in order, [6]."""


class Result(NamedTuple):
    """What the last step gave, and room to work in.

    No step reads what the one before left there, but for two things: ``columns`` are 0 from step to
    step, and of ``unknowns`` the compliances of rigid rows and hubs are those of the start.
    """

    velocity: Array
    """After the step, [nb, 3]; pymunk's, which takes it from here."""
    before: Array
    """Velocities before the step, [nb, 3]."""
    force: Array
    """Forces and torques that the poses tell [N, N m], [nb, 3]; once they are in ``free``, scratch:
    cosine and sine of the angles one step on."""
    free: Array
    """Velocities that these alone, and impacts, lead to; after the step the mean of before and
    after, [nb, 3]."""
    kick: Array
    """Velocities that impacts add, [nb, 3], in ``free`` already."""
    delayed: Array
    """The same, each times the instant of its impact after the pose [m, rad], [nb, 3]."""
    shift: Array
    """How far impacts after the pose displace it, so that the next one is right, [nb, 3]."""
    turn: Array
    """Cosine and sine of the bodies' angles, [nb, 2]."""
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
    slips: Records
    """SLIP_RESULT, [nf]."""
    joints: Records
    """JOINT_RESULT, [nj]."""
    rubs: Records
    """RUB_RESULT, [nu]."""
    fluids: Records
    """FLUID_RESULT, [nq]."""
    chambers: Records
    """CHAMBER_RESULT, [nc]."""
    valves: Records
    """VALVE_RESULT, [nv]."""
    pumps: Records
    """PUMP_RESULT, [np]."""
    loads: Records
    """LOAD_RESULT, [nk]."""
    loaded: Records
    """LOADED_RESULT, [no]."""
    pressing: Array
    """Numbers of the loaded bodies, [no, NUMBERS, 3]."""
    felt: Array
    """Scratch: a load's force and torque with slopes, [3, 4]."""
    ties: Records
    """TIE_RESULT, [nr]."""
    belts: Array
    """Speeds at which surfaces run, counter-clockwise round their bodies [m/s], [nb]."""
    stack: Array
    """Scratch of laws: values with their slopes, [depth, 4]."""
    read_names: Array
    """Scratch: what a law reads, values with slopes, [names, 4]."""
    entries: Array
    """J and W J of the entries, [2, ne, 3]."""
    values: Array
    """The matrix and its factor, [slots + m]."""
    unknowns: Array
    """What rows ask for; compliances, of hubs - mass and - inertia; the forward-substituted right
    side; the solution; scratch, [5, m]."""
    found: Records
    """TOUCH as pymunk found them in this step, [contacts]."""
    order: Integers
    """Scratch, [contacts]."""
    rows: Records
    """BOUND, the rows that are solved for, [r]."""
    columns: Array
    """L^-1 R W C^T of each, [r, m]."""
    reached: Integers
    """Which unknowns are not 0 in it, [r, m]."""
    delassus: Array
    """What the rows make of one another, G, [r, r]."""
    system: Array
    """Scratch, [r, r + 1]."""
    chosen: Integers
    """Scratch, [r]."""
    tableau: Array
    """Scratch of Lemke's method, [2 r, 2 r + 2], but r not above what that is tried for."""
    basis: Integers
    """Scratch of the same, [3, 2 r + 2]."""


ANGLE, RATE, STOPPING, DAMPING, DAMPED_WORK, RUBBED, RUBBED_WORK, STICKS = range(3, 11)
"""Columns of joints in a :class:`Snapshot`, of hinges only: angle [rad] and its rate, torque of
stops and of damping, in the angle's sense [N m], work of that [J]; where they have dry friction
that, in the joint's sense [N m, N], its work [J], whether it holds. Of actuators the first two are
length [m] and its rate."""


class Snapshot(NamedTuple):
    """Memory for samples on their way to the recording, an axis of samples before all others.

    Work [J] is that since t = 0, up to the instant of the sample, in the middle of its step.
    """

    pose: Array
    """x, y, angle of the bodies' frames, in the model's order as all of bodies, [n, nb, 3]."""
    velocity: Array
    """Of the centres of mass, at the instant of the pose, [n, nb, 3]."""
    acceleration: Array
    """[n, nb, 3]"""
    springs: Array
    """Length [m], force [N], work, [n, ns, 3]."""
    cords: Array
    """Length [m], tension [N], work, [n, nt and spans, 3]."""
    slips: Array
    """Friction [N], way [m], [n, nf, 2]."""
    lifted: Array
    """Whether a cord is off its wheel, [n, nw]."""
    actions: Array
    """Torque [N m], work, [n, na, 2]."""
    joints: Array
    """Force on b in the world [N], couple on b [N m], and the columns that follow, [n, nj, 11]."""
    fluids: Array
    """Pressure [Pa], volume beside that at t = 0, flow into it [m^3/s], content, spilled, work, the
    three before that at the step's end, [n, nq, 6]."""
    valves: Array
    """Flow [m^3/s], loss [J], [n, nv, 2]."""
    pumps: Array
    """Flow [m^3/s], work, [n, np, 2]."""
    loads: Array
    """Force in the world [N], torque about the centre of mass [N m], work, [n, nk, 4]."""
    ties: Integers
    """Whether what may be let go holds, [n, nr]."""
    drive: Array
    """What the drives gave in that step, [n, nd]."""
    contacts: Records
    """CONTACT of all samples, one after the other."""
    fill: Integers
    """How many contacts there are up to the end of each sample, [n]."""
    taken: Integers
    """Samples kept since the start of the run; how many of these were handed on; whether there is
    no room for the next one (1), or for what touches in the next step (2); samples whose means are
    kept, [4]."""
    sums: Array
    """Sums of forces over the steps of a sample interval, in the columns of the recorded
    ``mean_force`` [N, N m], [nc]."""
    means: Array
    """Means of these around each sample, [n, nc]."""
    steady: Integers
    """Whether these are the forces of the sample's step: all steps were the same, or the interval
    goes on, [n]."""
    waiting: Array
    """How many steps were made that are not in the sums, with the forces of the last one; whether
    there is anything in the sums, [2]."""
    mean_contacts: Records
    """CONTACT_SUMS of the sample intervals, one after the other; last the unfinished one."""
    mean_fill: Integers
    """How many of these there are up to the end of each sample's interval, [n]."""
    unfinished: Integers
    """The first of these that belongs to the unfinished interval; how many do, [2]."""
