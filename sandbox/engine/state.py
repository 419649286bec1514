"""Arrays of a run: constants, elements, the state that the next step needs, results of the last.

The records of elements are in :mod:`sandbox.engine.records`. In shapes, ``unknowns`` and
``entries`` are those of the bilateral rows (:mod:`sandbox.engine.plan`), ``rows`` bounded ones,
``piles`` bodies of piles. Guides are first those of tendons, then those of spans.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from sandbox.engine import records
from sandbox.model.programs import CURVE, KNOT, STEP
from sandbox.numeric import Array, Integers, Records

STILL, STILL_TURNING = 1e-11, 1e-10  # speeds [m/s, rad/s] of a mechanism at rest

COARSE = 1e-8  # steps with a larger residual [m/s, rad/s] are counted

NORMAL, TANGENT, LIMITED, DRIVEN = 0, 1, 2, 3
CABLE_FRICTION, CABLE_LOAD, JOINT_FRICTION, JOINT_LOAD = 4, 5, 6, 7
"""Where a bounded row comes from: a contact's two, a limit, a motor or brake; friction between a
guide and its tendon, and what that is measured by: the sum of the tensions on either side; friction
in a joint, and its measure: what the joint carries."""
SLIDES, HOLDS, TRIED = 0, 1, 2  # phases of a row with static friction; slipped, sliding is tried

BOUND = np.dtype([
    ("source", np.int64), ("index", np.int64),  # NORMAL ... DRIVEN, and which one
    ("a", np.int64), ("b", np.int64),
    ("ax", float), ("ay", float), ("at", float),    # y = these times the velocities of a and b
    ("bx", float), ("by", float), ("bt", float),
    ("bias", float), ("trend", float),  # added to y; of impacts: its change in the step [m/s^2]
    ("gap", float), ("closing", float), ("bend", float),    # gap there, its rate, how that changes
    ("soft", float),        # compliance: added to y for an impulse of 1
    ("measure", np.int64),  # whether the row acts on nothing: others are bounded by its impulse
    ("gentle", np.int64), ("hold", float),  # undo overlaps slowly; weight of its last impulse
    ("passive", np.int64),  # whether it is friction that must not drive where its measure is < 0
    ("tight", float),       # share of its measure by which it may exceed its bound; 0 for any
    ("normal", np.int64), ("friction", float),  # of a tangential row the normal one; else -1
    ("low", float), ("high", float),    # of the impulse, of rows that are not tangential
    ("static", float), ("phase", np.int64),     # over sliding friction; SLIDES, HOLDS or TRIED
    ("reserve", float),       # bound in the last step, then what was left of it; nan if unknown
    ("p_static", float), ("slip", float),  # impulse and mode of the last step, then of holding
    ("mode", np.int64), ("factored", np.int64),     # -1 at low, 0 between (y = 0), 1 at high; the
                            # same in the system that is factored
    ("last", float), ("p", float),  # impulses: of the last step, which fades where it moves; this
    ("free", float), ("base", float),   # y without bounded rows; for an impulse of 1, alone
    ("back", float), ("out", np.int64),  # of free, undoes an overlap; joints hold both bodies
    ("branch", np.int64), ("violation", float),     # unknowns of its column; of its mode, as a rate
])

BODY = np.dtype([
    ("number", np.int64),   # the model's
    ("x", float), ("y", float),     # the centre of mass in the body's frame [m]
])

SHAPE = np.dtype([
    ("body", np.int64), ("margin", float),  # by which it is larger in pymunk, to find gaps [m]
    ("first", np.int64), ("last", np.int64),    # its FACEs, -1 where all of it is surface
    ("vertex", np.int64), ("vertex_end", np.int64),     # of its core: a point, a line, a polygon
    ("radius", float),      # of the surface about the core [m]; that of a circle may change
    ("span", np.int64), ("span_end", np.int64),     # its SPANs; -1 if the core is no curve
    ("closed", np.int64), ("leader", np.int64),     # a closed curve; first shape of the outline
])
FACE = np.dtype([
    ("x0", float), ("y0", float), ("x1", float), ("y1", float),     # ends, counter-clockwise
])  # an arc of unit normals, in the body's frame, with which a piece of an outline is its surface
SPAN = np.dtype([
    *((f"{axis}{n}", float) for axis in "xy" for n in range(6)),
    ("before", np.int64), ("after", np.int64),      # its neighbours; -1 at an end
    ("corner", np.int64),   # whether there is a corner between it and the span before
    ("start", float),       # of the path of a slot: arc length up to the span [m]
])  # a quintic piece of a curve, x = sum x_n w^n for w in [0, 1], from the centre of mass [m]
TOUCH = np.dtype([
    ("shape_a", np.int64), ("shape_b", np.int64), ("feature", np.int64),    # which point it is
    ("a", np.int64), ("b", np.int64),       # bodies, a < b
    ("nx", float), ("ny", float),           # normal from a to b
    ("ax", float), ("ay", float), ("bx", float), ("by", float),     # arms of the point [m]
    ("gap", float), ("ka", float), ("da", float), ("kb", float), ("db", float),     # curvatures k/d
    ("ahead", float), ("distance", float),  # when it was located, after the pose [s]; its gap then
    ("acceleration", float),    # of the gap while the bodies keep their velocities [m/s^2]
    ("friction", float), ("static", float), ("restitution", float),
    ("normal", float), ("tangent", float),  # impulses on b, along (nx, ny) and (-ny, nx) [N s]
    ("bounce", float), ("drag", float),      # the same, of impacts, which come before
    ("mode", np.int64),     # of the tangential row: -1 and 1 slide, 0 sticks
    ("listed", np.int64),   # whether its rows are among those solved
    ("late", np.int64),     # whether it is hit only because of the forces of this step
    ("belt", float),        # velocity of driven surfaces along it [m/s]
    ("gap_shift", float), ("instant", float),   # by impacts [m]; of the last one, from the pose [s]
    ("phase", np.int64), ("sums", np.int64),    # AWAY, CLOSING or RESTING; CONTACT_SUMS, or -1
    ("stretch", float),     # of the spring along a compliant contact [m]
    ("bias", float), ("soft", float),   # of its normal row, where its skin is soft, else 0
    ("bias_along", float), ("soft_along", float),   # of its tangential row, the same
])
PILE_BODY = np.dtype([
    ("number", np.int64), ("island", np.int64),     # body; another of its island, first: itself
    ("rows", np.int64),     # of the lowest: rows of the island's contacts, negative: never a pile
    ("piled", np.int64), ("awake", np.int64), ("still", np.int64),  # steps for which it is still
    ("cluster", np.int64),  # the first body of those that joints connect with it, itself or -1
    ("linked", np.int64), ("carried", np.int64),    # of the lowest: has joints; rows that carry
    ("x", float), ("y", float), ("t", float),   # change of its velocity without contacts
    ("fastest", float),     # of the lowest: the largest free rate of the island's contacts [m/s]
])  # a free body that may be in a pile (islands)
PILED = np.dtype([  # those that are used most come first
    ("a", np.int64), ("b", np.int64),   # PILE_BODY or -1
    *((name, float) for name in (
        "friction", "pn", "pt",
        "bias_n", "bias_t",     # added to the rates [m/s]
        "soft_n", "soft_t",     # compliance: rate for an impulse of 1
        "base_n", "base_t",     # response of the bodies to an impulse of 1
        "yn", "yt", "tolerance", "Rn", "Rt", "n_shift", "t_shift", "dyn", "dyt")),
    ("mode", np.int64), ("factored", np.int64),     # its mode in the factor of the matrix, or -1
    ("slot", np.int64),     # block of the two bodies
    ("source", np.int64),   # NORMAL, LIMITED, DRIVEN or JOINT_FRICTION
    ("index", np.int64),    # its TOUCH, LIMIT, MOTOR or DRY_FRICTION
    *((name, float) for name in (
        "R_factored",           # its Rn in the factor
        "n_last", "t_last",     # impulses of the last step [N s]
        "n0", "t0", "n_best", "t_best",
        "bend",                 # share of bias_t by turning bodies
        "stiffness", "along")),     # tangential [N/m]; share of bias_t by its spring
])  # a contact or a bounded row of a joint in a pile while its step is solved (piles)
IN_PILE = -1  # value of a contact's "listed" that keeps it from the rows of the direct solver
AWAY, CLOSING, RESTING = 0, 1, 2  # phases of a contact: free; hit, gap closing; in contact

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
])  # a contact's sums over the steps of a sample interval, numbers as in `mean_contact_force`
IMPACT = np.dtype([
    ("step", np.int64),     # counted from 0 among those made in one go
    ("a", np.int64), ("b", np.int64),   # bodies
    ("x", float), ("y", float),         # place in the world [m]
    ("px", float), ("py", float),       # impulse on a in that step [N s]
    ("after", float),       # instant after the pose of the step [s]
])


class Constants(NamedTuple):
    """What no step changes."""

    h: float  # the step [s]
    gravity: Array  # [m/s^2], [2]
    inverse_mass: Annotated[Array, "bodies 2"]  # 1 / mass and 1 / inertia; 0 unless free
    bodies: Annotated[Records, BODY]
    scheduled: Integers  # numbers of the bodies that move as a schedule has it
    wheels: Integers  # guides whose wheels a tendon can lift off, [nw]
    sides: Annotated[Array, "sides 5"]  # outlines of what liquids lift, from centres of mass
    shapes: Annotated[Records, SHAPE]
    faces: Annotated[Records, FACE]  # those of a shape side by side
    vertices: Annotated[Array, "vertices 2"]  # of cores, from centres of mass [m]
    spans: Annotated[Records, SPAN]  # those of a curve side by side
    steps: Annotated[Records, STEP]  # of the programs of all laws (`programs`)
    curves: Annotated[Records, CURVE]  # of the scene's tables
    knots: Annotated[Records, KNOT]  # of these
    friction: Annotated[Array, "bodies bodies"]  # of every pair, below 0 if they may not touch
    static: Annotated[Array, "bodies bodies"]  # static over sliding friction of every pair
    restitution: Annotated[Array, "bodies bodies"]  # of every pair
    skin: Annotated[Array, "2 bodies bodies"]  # [N/m], [N s/m] of soft contacts; or [2, 0, 0]
    neighbors: Annotated[Integers, "neighbors 2"]  # bodies that may touch
    loose: Integers  # the PILE_BODY of each body, or -1
    pile_nodes: Annotated[Integers, "pile_nodes 3"]  # with the next two: rows, see pile_rows
    pile_blocks: Annotated[Integers, "pile_blocks 2"]
    pile_entries: Annotated[Integers, "pile_entries 3"]


class Elements(NamedTuple):
    """One record for each element: what never changes of it, its state and its last results."""

    actions: Annotated[Records, records.ACTION]
    springs: Annotated[Records, records.SPRING]
    cables: Annotated[Records, records.CABLE]
    guides: Annotated[Records, records.GUIDE]
    slips: Annotated[Records, records.SLIP]
    joints: Annotated[Records, records.JOINT]
    limits: Annotated[Records, records.LIMIT]
    motors: Annotated[Records, records.MOTOR]
    dry_friction: Annotated[Records, records.DRY_FRICTION]
    fluids: Annotated[Records, records.FLUID]
    chambers: Annotated[Records, records.CHAMBER]
    valves: Annotated[Records, records.VALVE]
    pumps: Annotated[Records, records.PUMP]
    loads: Annotated[Records, records.LOAD]  # those of a body side by side
    loaded: Annotated[Records, records.LOADED]
    bonds: Annotated[Records, records.BOND]


class State(NamedTuple):
    """All that changes in a run and that the next step needs."""

    body: Annotated[Array, "bodies 6"]  # positions and velocities of the centres of mass
    placed: Annotated[Array, "bodies 3"]  # poses that the step moves on: impacts displace them
    made: Annotated[Integers, "4"]  # steps but at rest; index in the call; broken; impacts
    broken: Annotated[Records, records.BROKEN]  # what broke in the steps made in one go
    impacts: Annotated[Records, IMPACT, "impacts"]  # of the steps made in one go
    touches: Annotated[Records, TOUCH, "contacts"]  # of the last step
    touching: Annotated[Integers, "3"]
    """Number; whether a step waits for room; whether pymunk lacks poses, 2: and their path."""
    last_drive: Annotated[Array, "drives"]  # values of the drives in the last step
    standing: Annotated[Integers, "7"]
    """Steps without modes, at rest; failures now, jammed row, rows; steps unordered, overlaps."""
    pile_bodies: Annotated[Records, PILE_BODY, "piles"]
    pile_place: Annotated[Integers, "nodes"]  # in the order of elimination, or -1
    accuracy: Annotated[Array, "6"]
    """Residual [m/s, rad/s], maximum, its step; steps with piles, above COARSE; since a sample."""


class Result(NamedTuple):
    """Results of the last step, and scratch memory."""

    velocity: Annotated[Array, "bodies 3"]  # after the step; pymunk takes it from here
    before: Annotated[Array, "bodies 3"]  # velocities before the step
    force: Annotated[Array, "bodies 3"]  # forces and torques at the poses [N, N m]
    free: Annotated[Array, "bodies 3"]  # velocities by force and kick; then means over the step
    kick: Annotated[Array, "bodies 3"]  # velocities that impacts add, in ``free`` already
    delayed: Annotated[Array, "bodies 3"]  # the same, times their instants after the pose
    shift: Annotated[Array, "bodies 3"]  # displacement of the pose by later impacts
    turn: Annotated[Array, "bodies 2"]  # cosine and sine of the bodies' angles
    ahead: Annotated[Array, "bodies 3"]  # the same of other angles, and these: of one step on
    pressing: Annotated[Array, "loaded numbers 3"]  # NUMBERS of the loaded bodies
    load_terms: Annotated[Array, "3 4"]  # scratch: a load's force and torque with slopes
    boxes: Annotated[Array, "bodies 7"]
    """Bounds of shapes: least x, y, largest x, y; smallest margin; how much farther than that a
    point moves in the step; reach from the centre of mass."""
    belts: Annotated[Array, "bodies"]  # speeds of surfaces, counter-clockwise [m/s]
    stack: Annotated[Array, "stack 4"]  # scratch of laws: values with their slopes
    read_names: Annotated[Array, "names 4"]  # scratch: arguments of a law with slopes
    entries: Annotated[Array, "2 entries 3"]  # J and W J of the entries
    values: Annotated[Array, "values"]  # the matrix and its factor
    unknowns: Annotated[Array, "6 unknowns"]
    """Right sides; compliances; substituted right sides; solution; scratch; allowed gaps."""
    pile_counts: Annotated[Integers, "2"]  # whether rows connect piled bodies; rows in piles
    pile_starts: Annotated[Integers, "nodes+1"]  # and the next two: pattern of the matrix (blocks)
    pile_below: Annotated[Integers, "slots"]
    pile_slots: Annotated[Integers, "pile_blocks"]  # of the blocks of rows
    pile_held: Annotated[Array, "pile_nodes 3"]  # compliance of the rows of springs and tendons
    pile_answer: Annotated[Array, "2 unknowns"]  # impulses of rows; 0
    found: Annotated[Records, TOUCH, "contacts"]  # as pymunk found them in this step
    order: Annotated[Integers, "contacts"]  # scratch
    rows: Annotated[Records, BOUND, "rows"]  # the rows that are solved for
    columns: Annotated[Array, "rows unknowns"]  # L^-1 R W C^T of each
    reached: Annotated[Integers, "rows unknowns"]  # which unknowns are not 0 in it
    delassus: Annotated[Array, "rows rows"]  # coupling of the rows, G
    system: Annotated[Array, "rows rows+1"]  # scratch
    chosen: Annotated[Integers, "rows"]  # scratch
    pile_adjacent: Annotated[Integers, "nodes words"]  # scratch of its order
    pile_work: Annotated[Integers, "3 nodes"]  # the same
    pile_coefficients: Annotated[Array, "pile_blocks 3 3"]  # blocks of the rows
    pile_compliance: Annotated[Array, "pile_nodes 3"]  # of the rows
    pile_vectors: Annotated[Array, "8 nodes 3"]
    """Velocities of piled bodies, - impulses of rows: result, trial, those without contacts;
    inverse masses; forces, a right side, a change; what impulses add."""
    pile_diagonal: Annotated[Array, "nodes 3 3"]  # blocks of the matrix
    pile_lower: Annotated[Array, "slots 3 3"]  # those below the diagonal
    pile_upper: Annotated[Array, "slots 3 3"]  # and above
    piled: Annotated[Records, PILED, "rows"]
    pile_jacobian: Annotated[Array, "rows 4 3"]  # normal a, b, tangential a, b of each


class Snapshot(NamedTuple):
    """Memory for samples on their way to the recording, an axis of samples before all others."""

    pose: Annotated[Array, "samples bodies 3"]  # of the bodies' frames, in the model's order
    velocity: Annotated[Array, "samples bodies 3"]  # of the centres of mass, when they are there
    acceleration: Annotated[Array, "samples bodies 3"]
    copied: Mapping[str, Records]  # samples of the tables in `SAMPLED`
    copies: Annotated[Integers, "copies 5"]  # source and target; records; words of one, to copy
    residual: Annotated[Array, "samples"]  # maximum since the sample before [m/s, rad/s]
    drive: Annotated[Array, "samples drives"]  # values of the drives in the step of each sample
    contacts: Annotated[Records, CONTACT, "contacts"]  # of all samples, one after the other
    fill: Annotated[Integers, "samples"]  # how many contacts there are up to the end of each sample
    taken: Annotated[Integers, "4"]  # samples kept, written; missing: 1 sample, 2 contacts; means
    sums: Annotated[Array, "forces"]  # of forces in an interval, as in `mean_force` [N, N m]
    means: Annotated[Array, "samples forces"]  # means of these around each sample
    steady: Annotated[Integers, "samples"]  # 1 if forces are means: equal, or unfinished
    waiting: Annotated[Array, "2"]  # steps not in the sums; whether these have any
    mean_contacts: Annotated[Records, CONTACT_SUMS, "mean_contacts"]  # by intervals
    mean_fill: Annotated[Integers, "samples"]  # their number up to the end of each interval
    unfinished: Annotated[Integers, "2"]  # first of the unfinished interval; their number


_ITEMS = {str(Array): float, str(Integers): np.int64, str(NDArray[np.intc]): np.intc}


@cache
def declared(part: Any) -> dict[str, tuple[Any, list[str]]]:
    """Item types and lengths of the arrays of a part, by their fields; of a number no type."""
    found: dict[str, tuple[Any, list[str]]] = {}
    for name, note in get_type_hints(part, include_extras=True).items():
        kind, *more = get_args(note) if get_origin(note) is Annotated else (note,)
        if kind is Records or str(kind) in _ITEMS:
            item = more[0] if kind is Records else _ITEMS[str(kind)]
            shape = more[-1] if more and isinstance(more[-1], str) else name
            found[name] = item, shape.split()
        elif note is int:
            found[name] = None, []
    return found


def zeros(part: Any, name: str, sizes: Mapping[str, int]) -> Any:
    """Zeros for one array of a part; ``sizes`` are the lengths by their names."""
    item, shape = declared(part)[name]
    return np.zeros([int(length) if length.isdigit() else
                     sizes[length.removesuffix("+1")] + length.endswith("+1")
                     for length in shape], item)


def allocate(part: Any, sizes: Mapping[str, int], **given: Any) -> Any:
    """A part whose arrays that are not ``given`` are zeros."""
    return part(**given, **{
        name: zeros(part, name, sizes) for name in part._fields if name not in given})
