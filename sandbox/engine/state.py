"""Arrays of a run: constants, the state that the next step needs, results of the last step.

Each number is one of three things: it never changes (:class:`Constants`), the next step needs it
(:class:`State`), or it is only reported (:class:`Result`). A run is its constants, its state and
where pymunk's bodies are. Records of elements stand in :mod:`sandbox.engine.records`.

Shapes: nb bodies, nd drives, m unknowns of the bilateral rows (:mod:`sandbox.engine.plan`), ne
entries of these, r bounded rows for which there is room. Arrays of records have one axis. Guides
are first those of tendons, then those of spans.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, NamedTuple

import numpy as np

from sandbox.engine import records
from sandbox.model.programs import CURVE, KNOT, STEP
from sandbox.numeric import Array, Integers, Records

STILL, STILL_TURNING = 1e-11, 1e-10
"""Where nothing moves faster [m/s, rad/s] all is at rest, and contacts carry what they carried."""

COARSE = 1e-8
"""Steps with a larger residual [m/s, rad/s] are counted."""

NORMAL, TANGENT, LIMITED, DRIVEN = 0, 1, 2, 3
CABLE_FRICTION, CABLE_LOAD, JOINT_FRICTION, JOINT_LOAD = 4, 5, 6, 7
"""Where a bounded row comes from: a contact's two, a limit, a motor or brake; friction between a
guide and its cord, and what that is measured by: the sum of the tensions on either side; friction
in a joint, and its measure: what the joint carries."""
SLIDES, HOLDS, TRIED = 0, 1, 2
"""Phases of a row with static friction in a step: it has sliding friction; static friction; or it
slipped against that, and sliding friction is tried (:mod:`sandbox.engine.friction`)."""

BOUND = np.dtype([
    ("source", np.int64), ("index", np.int64),  # NORMAL ... DRIVEN, and which one
    ("a", np.int64), ("b", np.int64),
    ("ax", float), ("ay", float), ("at", float),    # y = these times the velocities of a and b
    ("bx", float), ("by", float), ("bt", float),
    ("want", float),        # added to y [m/s, rad/s]
    ("trend", float),       # of impacts: how y, "want" at the pose, changes in the step [m/s^2]
    ("gap", float), ("closing", float), ("bend", float),    # gap there, its rate, how that changes
    ("soft", float),        # compliance: added to y for an impulse of 1
    ("measure", np.int64),  # whether the row acts on nothing: others are bounded by its impulse
    ("gentle", np.int64),   # whether an overlap is undone slowly
    ("hold", float),        # how strongly its impulse is held to the last, as a share of base
    ("passive", np.int64),  # whether it is friction that must not drive where its measure is < 0
    ("tight", float),       # share of its measure by which it may exceed its bound; 0 for any
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

SHAPE = np.dtype([
    ("body", np.int64),
    ("margin", float),      # by which it stands out in pymunk, so that contacts are seen coming [m]
    ("first", np.int64), ("last", np.int64),    # its FACEs, -1 where all of it is surface
    ("vertex", np.int64), ("vertex_end", np.int64),     # of its core: a point, a line, a polygon
    ("radius", float),      # of the surface about the core [m]; that of a circle may change
    ("span", np.int64), ("span_end", np.int64),     # its SPANs; -1 if the core is no curve
    ("closed", np.int64),   # whether its curve is closed, counter-clockwise about the material
    ("leader", np.int64),   # the first shape of the same outline
])
FACE = np.dtype([
    ("x0", float), ("y0", float), ("x1", float), ("y1", float),     # ends, counter-clockwise
])
"""An arc of unit normals, in the body's frame, with which a piece of an outline is its surface."""
SPAN = np.dtype([
    *((f"{axis}{n}", float) for axis in "xy" for n in range(6)),
    ("before", np.int64), ("after", np.int64),      # its neighbours; -1 at an end
    ("corner", np.int64),   # whether there is a corner between it and the span before
    ("start", float),       # of the path of a slot: arc length up to the span [m]
])
"""A quintic piece of a curve, x = sum x_n w^n for w in [0, 1], from the centre of mass [m]."""
TOUCH = np.dtype([
    ("shape_a", np.int64), ("shape_b", np.int64), ("feature", np.int64),    # which point it is
    ("a", np.int64), ("b", np.int64),       # bodies, a < b
    ("nx", float), ("ny", float),           # normal from a to b
    ("ax", float), ("ay", float), ("bx", float), ("by", float),     # arms of the point [m]
    ("gap", float),         # [m]
    ("ka", float), ("da", float), ("kb", float), ("db", float),     # curvatures k / d
    ("acceleration", float),    # of the gap while the bodies keep their velocities [m/s^2]
    ("friction", float), ("static", float), ("restitution", float),
    ("normal", float), ("tangent", float),  # impulses on b, along (nx, ny) and (-ny, nx) [N s]
    ("bounce", float), ("rub", float),      # the same, of impacts, which come before
    ("mode", np.int64),     # of the tangential row: -1 and 1 slide, 0 sticks
    ("listed", np.int64),   # whether its rows are among those solved
    ("late", np.int64),     # whether it is hit only because of the forces of this step
    ("belt", float),        # by how much surfaces that run add to its rate of sliding [m/s]
    ("led", float),         # how far impacts of the step lead its gap back [m]
    ("instant", float),     # of its last impact in the step, after the pose [s]
    ("phase", np.int64),    # AWAY, CLOSING or RESTING
    ("sums", np.int64),     # its CONTACT_SUMS in this sample interval, or -1
    ("stretch", float),     # of the spring along a compliant contact [m]
    ("want", float), ("soft", float),   # of its normal row, where its skin is soft, else 0
    ("want_along", float), ("soft_along", float),   # of its tangential row, the same
])
PILE_BODY = np.dtype([
    ("number", np.int64),   # of the body
    ("island", np.int64),   # another body of its island, the lowest one's is itself
    ("rows", np.int64),     # of the lowest: rows of the island's contacts, negative: never a pile
    ("piled", np.int64), ("awake", np.int64),
    ("still", np.int64),    # for how many steps it has been still
    ("place", np.int64),    # in the order of elimination, -1 without one
    ("x", float), ("y", float), ("t", float),   # change of its velocity without contacts
    ("fastest", float),     # of the lowest: the largest free rate of the island's contacts [m/s]
])
"""A free body that nothing but contacts connects (:mod:`sandbox.engine.islands`)."""
PILED = np.dtype([
    ("touch", np.int64), ("a", np.int64), ("b", np.int64),  # PILE_BODY or -1
    ("slot", np.int64),     # block of the two
    ("mode", np.int64),
    *((name, float) for name in (
        "friction", "tolerance",
        "n_last", "t_last",     # impulses of the last step [N s]
        "n0", "t0", "n_best", "t_best", "pn", "pt",
        "want_n", "want_t",     # added to the rates [m/s]
        "bend",                 # what of that bodies that turn give along the contact
        "soft_n", "soft_t",     # compliance: rate for an impulse of 1
        "base_n", "base_t",     # response of the bodies to an impulse of 1
        "stiffness", "along",   # tangential [N/m]; what of want_t its spring gives
        "Rn", "Rt", "n_shift", "t_shift", "yn", "yt", "dyn", "dyt")),
])
"""A contact of a pile while its step is solved (:mod:`sandbox.engine.piles`)."""
AWAY, CLOSING, RESTING = 0, 1, 2
"""Phases of a contact: it carries nothing; it was hit, and the next step closes its gap; it
carries."""

CONTACT = np.dtype([
    ("a", np.int64), ("b", np.int64),   # bodies
    ("x", float), ("y", float),         # place in the world [m]
    ("nx", float), ("ny", float),       # normal from a to b
    ("gap", float),                     # [m]
    ("normal", float), ("tangent", float),  # impulses on b, along (nx, ny) and (-ny, nx) [N s]
    ("twist", float),                   # moment on b besides that of these at the place [N m s]
])
CONTACT_SUMS = np.dtype([
    ("a", np.int64), ("b", np.int64),   # bodies
    ("x", float), ("y", float),         # place, times the normal impulse [m N s]
    ("nx", float), ("ny", float),       # normal impulse on a [N s]
    ("px", float), ("py", float),       # impulse on a [N s]
    ("normal", float),                  # size of the normal impulse [N s]
])
"""A contact's sums over the steps of a sample interval, numbers as in ``mean_contact_force``."""
IMPACT = np.dtype([
    ("step", np.int64),     # counted from 0 among those made in one go
    ("a", np.int64), ("b", np.int64),   # bodies
    ("x", float), ("y", float),         # place in the world [m]
    ("px", float), ("py", float),       # impulse on a in that step [N s]
    ("after", float),       # instant after the pose of the step [s]
])


class Constants(NamedTuple):
    """What no step changes."""

    h: float
    """The step [s]."""
    gravity: Array
    """[m/s^2], [2]."""
    inverse_mass: Annotated[Array, 2]
    """1 / mass and 1 / inertia, [nb, 2]; 0 for bodies that do not move freely."""
    bodies: Annotated[Records, BODY]
    scheduled: Integers
    """Numbers of the bodies that move as a schedule has it."""
    actions: Annotated[Records, records.ACTION]
    springs: Annotated[Records, records.SPRING]
    cords: Annotated[Records, records.CORD]
    guides: Annotated[Records, records.GUIDE]
    slips: Annotated[Records, records.SLIP]
    wheels: Integers
    """Guides whose wheels a cord can lift off, [nw]."""
    joints: Annotated[Records, records.JOINT]
    limits: Annotated[Records, records.LIMIT]
    motors: Annotated[Records, records.MOTOR]
    dry_friction: Annotated[Records, records.DRY_FRICTION]
    fluids: Annotated[Records, records.FLUID]
    chambers: Annotated[Records, records.CHAMBER]
    valves: Annotated[Records, records.VALVE]
    pumps: Annotated[Records, records.PUMP]
    loads: Annotated[Records, records.LOAD]
    """[nk], those of a body side by side."""
    loaded: Annotated[Records, records.LOADED]
    sides: Annotated[Array, 2]
    """Outlines of what liquids lift, from the centres of mass (:mod:`sandbox.model.loads`)."""
    ties: Annotated[Records, records.TIE]
    shapes: Annotated[Records, SHAPE]
    faces: Annotated[Records, FACE]
    """Those of a shape side by side."""
    vertices: Annotated[Array, 2]
    """Corners of the shapes' cores, from the centres of mass [m], [n, 2]."""
    spans: Annotated[Records, SPAN]
    """Those of a curve side by side."""
    steps: Annotated[Records, STEP]
    """Of the programs of all laws (:mod:`sandbox.model.programs`)."""
    curves: Annotated[Records, CURVE]
    """Of the scene's tables."""
    knots: Annotated[Records, KNOT]
    """Of these."""
    friction: Annotated[Array, 2]
    """Coefficient of every pair of bodies, negative where they may not touch, [nb, nb]."""
    static: Annotated[Array, 2]
    """Static over sliding friction of every pair of bodies, [nb, nb]."""
    restitution: Annotated[Array, 2]
    """Of every pair of bodies, [nb, nb]."""
    starts: Integers
    """This and what follows: :class:`sandbox.engine.plan.Pattern`."""
    below: Integers
    updates: Integers
    entry_row: Integers
    entry_body: Integers
    pairs: Annotated[Integers, 2]
    direct: Annotated[Integers, 2]
    body_starts: Integers
    body_entries: Integers
    branch_starts: Integers
    branches: Integers
    hubs: Annotated[Integers, 2]
    skin: Annotated[Array, 3]
    """Stiffness [N/m] and damping [N s/m] of the contacts of every pair of bodies, 0 where they are
    rigid, [2, nb, nb], or [2, 0, 0] if all are."""
    loose: Integers
    """The PILE_BODY of each body, or -1, [nb]."""


class State(NamedTuple):
    """All that changes in a run and that the next step needs."""

    body: Annotated[Array, 2]
    """x, y, angle, vx, vy, omega of the centres of mass, [nb, 6]; pymunk's, filled after moves."""
    actions: Annotated[Records, records.ACTION_STATE]
    springs: Annotated[Records, records.SPRING_STATE]
    cords: Annotated[Records, records.CORD_STATE]
    guides: Annotated[Records, records.GUIDE_STATE]
    slips: Annotated[Records, records.SLIP_STATE]
    joints: Annotated[Records, records.JOINT_STATE]
    limits: Annotated[Records, records.LIMIT_STATE]
    motors: Annotated[Records, records.MOTOR_STATE]
    dry_friction: Annotated[Records, records.DRY_FRICTION_STATE]
    fluids: Annotated[Records, records.FLUID_STATE]
    valves: Annotated[Records, records.VALVE_STATE]
    pumps: Annotated[Records, records.PUMP_STATE]
    loads: Annotated[Records, records.LOAD_STATE]
    made: Integers
    """Steps made, this one among them, but for those in which all was at rest; which of those made
    in one go this one is, from 0; how many of ``broken`` and of ``impacts`` are filled, [4]."""
    ties: Annotated[Records, records.TIE_STATE]
    broken: Annotated[Records, records.BROKEN]
    """What broke in the steps made in one go; room for more than do."""
    impacts: Annotated[Records, IMPACT]
    """Of the steps made in one go, [contacts] or more."""
    touches: Annotated[Records, TOUCH]
    """Of the last step, [contacts]."""
    touching: Integers
    """How many of these there are; whether a step waits for room to be gone on with, [2]."""
    last_drive: Array
    """Values of the drives in the last step, [nd]."""
    standing: Integers
    """In how many steps modes were not found; for how many steps all has been at rest; how often
    modes were not found in this step; which row is jammed, from 1, or 0; how many rows; in how many
    steps impacts were too many to be put in order, [6]."""
    pile_bodies: Annotated[Records, PILE_BODY]
    accuracy: Array
    """Residual of the bounded rows in the last step [m/s, rad/s]; the largest so far; the step that
    it was in, counted as ``made``; steps with piles that were awake; steps with a residual above
    :data:`COARSE`, [5]."""


class Result(NamedTuple):
    """What the last step gave, and room to work in.

    No step reads what the one before left there, but for three things: ``columns`` are 0 from step
    to step, of ``unknowns`` the compliances of rigid rows and hubs are those of the start, and
    ``pile_starts`` and ``pile_below`` are kept.
    """

    velocity: Annotated[Array, 2]
    """After the step, [nb, 3]; pymunk's, which takes it from here."""
    before: Annotated[Array, 2]
    """Velocities before the step, [nb, 3]."""
    force: Annotated[Array, 2]
    """Forces and torques that the poses tell [N, N m], [nb, 3]; once they are in ``free``, scratch:
    cosine and sine of the angles one step on."""
    free: Annotated[Array, 2]
    """Velocities that these alone, and impacts, lead to; after the step the mean of before and
    after, [nb, 3]."""
    kick: Annotated[Array, 2]
    """Velocities that impacts add, [nb, 3], in ``free`` already."""
    delayed: Annotated[Array, 2]
    """The same, each times the instant of its impact after the pose [m, rad], [nb, 3]."""
    shift: Annotated[Array, 2]
    """How far impacts after the pose displace it, so that the next one is right, [nb, 3]."""
    turn: Annotated[Array, 2]
    """Cosine and sine of the bodies' angles, [nb, 2]."""
    actions: Annotated[Records, records.ACTION_RESULT]
    springs: Annotated[Records, records.SPRING_RESULT]
    cords: Annotated[Records, records.CORD_RESULT]
    guides: Annotated[Records, records.GUIDE_RESULT]
    slips: Annotated[Records, records.SLIP_RESULT]
    joints: Annotated[Records, records.JOINT_RESULT]
    dry_friction: Annotated[Records, records.DRY_FRICTION_RESULT]
    fluids: Annotated[Records, records.FLUID_RESULT]
    chambers: Annotated[Records, records.CHAMBER_RESULT]
    valves: Annotated[Records, records.VALVE_RESULT]
    pumps: Annotated[Records, records.PUMP_RESULT]
    loads: Annotated[Records, records.LOAD_RESULT]
    loaded: Annotated[Records, records.LOADED_RESULT]
    pressing: Annotated[Array, 3]
    """Numbers of the loaded bodies, [no, NUMBERS, 3]."""
    felt: Annotated[Array, 2]
    """Scratch: a load's force and torque with slopes, [3, 4]."""
    ties: Annotated[Records, records.TIE_RESULT]
    belts: Array
    """Speeds at which surfaces run, counter-clockwise round their bodies [m/s], [nb]."""
    stack: Annotated[Array, 2]
    """Scratch of laws: values with their slopes, [depth, 4]."""
    read_names: Annotated[Array, 2]
    """Scratch: what a law reads, values with slopes, [names, 4]."""
    entries: Annotated[Array, 3]
    """J and W J of the entries, [2, ne, 3]."""
    values: Array
    """The matrix and its factor, [slots + m]."""
    unknowns: Annotated[Array, 2]
    """What rows ask for; compliances, of hubs - mass and - inertia; the forward-substituted right
    side; the solution; scratch; gaps that joints may keep in this step, 0 but for impacts,
    [6, m]."""
    found: Annotated[Records, TOUCH]
    """As pymunk found them in this step, [contacts]."""
    order: Integers
    """Scratch, [contacts]."""
    rows: Annotated[Records, BOUND]
    """The rows that are solved for, [r]."""
    columns: Annotated[Array, 2]
    """L^-1 R W C^T of each, [r, m]."""
    reached: Annotated[Integers, 2]
    """Which unknowns are not 0 in it, [r, m]."""
    delassus: Annotated[Array, 2]
    """What the rows make of one another, G, [r, r]."""
    system: Annotated[Array, 2]
    """Scratch, [r, r + 1]."""
    chosen: Integers
    """Scratch, [r]."""
    tableau: Annotated[Array, 2]
    """Scratch of Lemke's method, [2 r, 2 r + 2], but r not above what that is tried for."""
    basis: Annotated[Integers, 2]
    """Scratch of the same, [3, 2 r + 2]."""
    pile_starts: Integers
    """This and the next: the pattern of the matrix of piles (:mod:`sandbox.engine.blocks`), for
    np bodies; a step keeps it if it has all that meets in it, [np + 1]."""
    pile_below: Integers
    pile_adjacent: Annotated[Integers, 2]
    """Scratch of its order, [np, words]."""
    pile_work: Annotated[Integers, 2]
    """The same, [3, np]."""
    pile_vectors: Annotated[Array, 3]
    """Velocities of the bodies of piles: the result, a trial, those without contacts; inverse
    masses; forces, a right side, a change, [7, np, 3]."""
    pile_diagonal: Annotated[Array, 3]
    """Blocks of the matrix, [np, 3, 3]; below and above the diagonal, [slots, 3, 3]."""
    pile_lower: Annotated[Array, 3]
    pile_upper: Annotated[Array, 3]
    piled: Annotated[Records, PILED]
    """[contacts]"""
    pile_jacobian: Annotated[Array, 3]
    """Of the normal and the tangential rate of each with respect to both bodies: normal a, b,
    tangential a, b, [contacts, 4, 3]."""


SAMPLED: dict[type, tuple[str, ...]] = {
    State: ("actions", "springs", "cords", "guides", "slips", "limits", "dry_friction",
            "fluids", "valves", "pumps", "loads", "ties"),
    Result: ("actions", "springs", "cords", "slips", "joints", "dry_friction",
             "fluids", "valves", "pumps", "loads"),
}
"""Arrays that are copied in each sample; recorded values are computed from these later."""


class Snapshot(NamedTuple):
    """Memory for samples on their way to the recording, an axis of samples before all others."""

    pose: Annotated[Array, 3]
    """x, y, angle of the bodies' frames, in the model's order as all of bodies, [n, nb, 3]."""
    velocity: Annotated[Array, 3]
    """Of the centres of mass, at the instant of the pose, [n, nb, 3]."""
    acceleration: Annotated[Array, 3]
    """[n, nb, 3]"""
    copied: Mapping[str, Records]
    """Samples of :data:`SAMPLED` by the names of their views."""
    copies: Annotated[Integers, 2]
    """Of each the address of what is copied, that of the first sample, words to copy, [k, 3]."""
    drive: Annotated[Array, 2]
    """Values of the drives in the step of each sample, [n, nd]."""
    contacts: Annotated[Records, CONTACT]
    """Of all samples, one after the other."""
    fill: Integers
    """How many contacts there are up to the end of each sample, [n]."""
    taken: Integers
    """Samples kept since the start of the run; how many of these were handed on; whether there is
    no room for the next one (1), or for what touches in the next step (2); samples whose means are
    kept, [4]."""
    sums: Array
    """Sums of forces over the steps of a sample interval, in the columns of the recorded
    ``mean_force`` [N, N m], [nc]."""
    means: Annotated[Array, 2]
    """Means of these around each sample, [n, nc]."""
    steady: Integers
    """Whether these are the forces of the sample's step: all steps were the same, or the interval
    goes on, [n]."""
    waiting: Array
    """How many steps were made that are not in the sums, with the forces of the last one; whether
    there is anything in the sums, [2]."""
    mean_contacts: Annotated[Records, CONTACT_SUMS]
    """Of the sample intervals, one after the other; last the unfinished one."""
    mean_fill: Integers
    """How many of these there are up to the end of each sample's interval, [n]."""
    unfinished: Integers
    """The first of these that belongs to the unfinished interval; how many do, [2]."""
