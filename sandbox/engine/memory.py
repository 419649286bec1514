"""The arrays of a run handed to compiled code in one piece: a table of where they are.

Handed over one by one, some eighty arrays cost more to unwrap than a sample costs to keep, and
tens of seconds to compile. The table holds for each its address and up to three lengths, and
compiled code makes of these the views that it needs: ``memory.body(table)``. That costs nothing,
and a view compiles in some milliseconds. Arrays that stand in a table must neither move nor be
replaced while it is used: :class:`Memory` keeps them alive.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import from_dtype, types
from numba.extending import intrinsic
from numba.np import arrayobj

from sandbox.engine.cord_state import (
    CORD,
    CORD_RESULT,
    CORD_STATE,
    GUIDE,
    GUIDE_RESULT,
    GUIDE_STATE,
    SLIP,
    SLIP_RESULT,
    SLIP_STATE,
)
from sandbox.engine.fluid_state import (
    CHAMBER,
    CHAMBER_RESULT,
    FLUID,
    FLUID_RESULT,
    FLUID_STATE,
    PUMP,
    PUMP_RESULT,
    PUMP_STATE,
    VALVE,
    VALVE_RESULT,
    VALVE_STATE,
)
from sandbox.engine.joint_state import (
    JOINT,
    JOINT_RESULT,
    JOINT_STATE,
    LIMIT,
    LIMIT_STATE,
    MOTOR,
    MOTOR_STATE,
    RUB,
    RUB_RESULT,
    RUB_STATE,
)
from sandbox.engine.load_state import LOAD, LOAD_RESULT, LOAD_STATE, LOADED, LOADED_RESULT
from sandbox.engine.native import FOUND, Native
from sandbox.engine.state import (
    ACTION,
    ACTION_RESULT,
    ACTION_STATE,
    BODY,
    BOUND,
    DAMPER,
    DAMPER_RESULT,
    DAMPER_STATE,
    SPRING,
    SPRING_RESULT,
    SPRING_STATE,
    Constants,
    Result,
    Snapshot,
    State,
)
from sandbox.engine.tie_state import BROKEN, TIE, TIE_RESULT, TIE_STATE
from sandbox.engine.touch_state import (
    CONTACT,
    CONTACT_SUMS,
    FACE,
    IMPACT,
    SHAPE,
    SPAN,
    TOUCH,
)
from sandbox.model.programs import CURVE, KNOT, STEP
from sandbox.numeric import Integers

_arrays: Any = arrayobj
WIDTH = 4
"""Numbers of the table for each array: its address and three lengths."""
_PARTS: tuple[Any, ...] = (Native, Constants, State, Result, Snapshot)
TABLE_WORDS = WIDTH * sum(len(part._fields) for part in _PARTS)
"""Length of the table without the addresses of entry points, which follow."""


class Memory(NamedTuple):
    """What compiled code gets, and what must live as long as it is used."""

    address: int
    """Of the table: address and lengths of every array, then addresses of entry points."""
    h: float
    """The step [s]."""
    kept: tuple[Any, ...]
    """The table and the arrays themselves."""


def make_memory(
    native: Native, constants: Constants, state: State, result: Result, snapshot: Snapshot,
    entry_points: Integers,
) -> Memory:
    """The table of a run.

    Raises:
        ValueError: an array that is not in one piece.
    """
    values: tuple[Any, ...] = (*native, *constants, *state, *result, *snapshot)
    table = np.zeros((len(values), WIDTH), dtype=np.int64)
    for row, value in zip(table, values, strict=True):
        if isinstance(value, np.ndarray):
            if not value.flags.c_contiguous:
                raise ValueError("an array of a run is not in one piece")
            row[0] = value.ctypes.data
            row[1:1 + value.ndim] = value.shape
        elif isinstance(value, int):
            row[0] = value
    whole = np.concatenate([table.ravel(), entry_points])
    return Memory(whole.ctypes.data, constants.h, (whole, *values))


def _row(part: Any, name: str) -> int:
    """Where in the table a field of one of the parts stands."""
    before = sum(len(other._fields) for other in _PARTS[:_PARTS.index(part)])
    return int(WIDTH * (before + part._fields.index(name)))


def _view(part: Any, name: str, dtype: Any, axes: int = 1) -> Any:
    """What makes in compiled code the view of an array, from the table."""
    place = _row(part, name)
    item = from_dtype(np.dtype(dtype))
    made = types.Array(item, axes, "C")
    word = ir.IntType(64)

    def view(context: Any, table: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            source = builder.inttoptr(args[0], word.as_pointer())

            def at(offset: int) -> Any:
                return builder.load(builder.gep(source, [ir.Constant(word, place + offset)]))

            array = _arrays.make_array(made)(context, builder)
            size = ir.Constant(word, context.get_abi_sizeof(context.get_data_type(item)))
            lengths = [at(1 + axis) for axis in range(axes)]
            strides = [size]
            for length in lengths[:0:-1]:
                strides.insert(0, builder.mul(strides[0], length))
            _arrays.populate_array(
                array, data=builder.inttoptr(at(0), array.data.type), shape=lengths,
                strides=strides, itemsize=size, meminfo=None)
            return array._getvalue()

        return made(table), generate

    result: Any = intrinsic(view)
    result.view_of_table = f"{name} {place} {made} {np.dtype(dtype)!r}"
    return result


def _number(part: Any, name: str) -> Any:
    """What reads in compiled code a plain number, from the table."""
    place = _row(part, name)

    def number(context: Any, table: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            word = ir.IntType(64)
            source = builder.inttoptr(args[0], word.as_pointer())
            return builder.load(builder.gep(source, [ir.Constant(word, place)]))

        return types.int64(table), generate

    result: Any = intrinsic(number)
    result.view_of_table = f"{name} {place}"
    return result


# what to call, and with what
step = _number(Native, "step")
each_body = _number(Native, "each_body")
space = _number(Native, "space")
get = _number(Native, "get")
read = _number(Native, "read")
put = _number(Native, "put")
write = _number(Native, "write")
place = _number(Native, "place")
read_count = _view(Native, "read_count", np.intc)
write_count = _view(Native, "write_count", np.intc)
place_count = _view(Native, "place_count", np.intc)
placed = _view(Native, "placed", float, 2)
near = _view(Native, "found", int)
raw = _view(Native, "raw", FOUND)

# what no step changes
gravity = _view(Constants, "gravity", float)
inverse_mass = _view(Constants, "inverse_mass", float, 2)
bodies = _view(Constants, "bodies", BODY)
scheduled = _view(Constants, "scheduled", int)
actions = _view(Constants, "actions", ACTION)
springs = _view(Constants, "springs", SPRING)
dampers = _view(Constants, "dampers", DAMPER)
cords = _view(Constants, "cords", CORD)
guides = _view(Constants, "guides", GUIDE)
slips = _view(Constants, "slips", SLIP)
wheels = _view(Constants, "wheels", int)
joints = _view(Constants, "joints", JOINT)
limits = _view(Constants, "limits", LIMIT)
motors = _view(Constants, "motors", MOTOR)
rubs = _view(Constants, "rubs", RUB)
fluids = _view(Constants, "fluids", FLUID)
chambers = _view(Constants, "chambers", CHAMBER)
valves = _view(Constants, "valves", VALVE)
pumps = _view(Constants, "pumps", PUMP)
loads = _view(Constants, "loads", LOAD)
loaded = _view(Constants, "loaded", LOADED)
sides = _view(Constants, "sides", float, 2)
ties = _view(Constants, "ties", TIE)
shapes = _view(Constants, "shapes", SHAPE)
faces = _view(Constants, "faces", FACE)
vertices = _view(Constants, "vertices", float, 2)
spans = _view(Constants, "spans", SPAN)
steps = _view(Constants, "steps", STEP)
curves = _view(Constants, "curves", CURVE)
knots = _view(Constants, "knots", KNOT)
friction = _view(Constants, "friction", float, 2)
static = _view(Constants, "static", float, 2)
restitution = _view(Constants, "restitution", float, 2)
starts = _view(Constants, "starts", int)
below = _view(Constants, "below", int)
updates = _view(Constants, "updates", int)
entry_row = _view(Constants, "entry_row", int)
entry_body = _view(Constants, "entry_body", int)
pairs = _view(Constants, "pairs", int, 2)
direct = _view(Constants, "direct", int, 2)
body_starts = _view(Constants, "body_starts", int)
body_entries = _view(Constants, "body_entries", int)
branch_starts = _view(Constants, "branch_starts", int)
branches = _view(Constants, "branches", int)
hubs = _view(Constants, "hubs", int, 2)

# what the next step needs
body = _view(State, "body", float, 2)
action_states = _view(State, "actions", ACTION_STATE)
spring_states = _view(State, "springs", SPRING_STATE)
damper_states = _view(State, "dampers", DAMPER_STATE)
cord_states = _view(State, "cords", CORD_STATE)
guide_states = _view(State, "guides", GUIDE_STATE)
slip_states = _view(State, "slips", SLIP_STATE)
joint_states = _view(State, "joints", JOINT_STATE)
limit_states = _view(State, "limits", LIMIT_STATE)
motor_states = _view(State, "motors", MOTOR_STATE)
rub_states = _view(State, "rubs", RUB_STATE)
fluid_states = _view(State, "fluids", FLUID_STATE)
valve_states = _view(State, "valves", VALVE_STATE)
pump_states = _view(State, "pumps", PUMP_STATE)
load_states = _view(State, "loads", LOAD_STATE)
made = _view(State, "made", int)
tie_states = _view(State, "ties", TIE_STATE)
broken = _view(State, "broken", BROKEN)
impacts = _view(State, "impacts", IMPACT)
touches = _view(State, "touches", TOUCH)
touching = _view(State, "touching", int)
last_drive = _view(State, "last_drive", float)
standing = _view(State, "standing", int)

# what the last step gave, and room to work in
velocity = _view(Result, "velocity", float, 2)
before = _view(Result, "before", float, 2)
force = _view(Result, "force", float, 2)
free = _view(Result, "free", float, 2)
kick = _view(Result, "kick", float, 2)
delayed = _view(Result, "delayed", float, 2)
shift = _view(Result, "shift", float, 2)
turn = _view(Result, "turn", float, 2)
action_results = _view(Result, "actions", ACTION_RESULT)
spring_results = _view(Result, "springs", SPRING_RESULT)
damper_results = _view(Result, "dampers", DAMPER_RESULT)
cord_results = _view(Result, "cords", CORD_RESULT)
guide_results = _view(Result, "guides", GUIDE_RESULT)
slip_results = _view(Result, "slips", SLIP_RESULT)
joint_results = _view(Result, "joints", JOINT_RESULT)
rub_results = _view(Result, "rubs", RUB_RESULT)
fluid_results = _view(Result, "fluids", FLUID_RESULT)
chamber_results = _view(Result, "chambers", CHAMBER_RESULT)
valve_results = _view(Result, "valves", VALVE_RESULT)
pump_results = _view(Result, "pumps", PUMP_RESULT)
load_results = _view(Result, "loads", LOAD_RESULT)
loaded_results = _view(Result, "loaded", LOADED_RESULT)
pressing = _view(Result, "pressing", float, 3)
felt = _view(Result, "felt", float, 2)
tie_results = _view(Result, "ties", TIE_RESULT)
belts = _view(Result, "belts", float)
stack = _view(Result, "stack", float, 2)
read_names = _view(Result, "read_names", float, 2)
entries = _view(Result, "entries", float, 3)
values = _view(Result, "values", float)
unknowns = _view(Result, "unknowns", float, 2)
found = _view(Result, "found", TOUCH)
order = _view(Result, "order", int)
rows = _view(Result, "rows", BOUND)
columns = _view(Result, "columns", float, 2)
reached = _view(Result, "reached", int, 2)
delassus = _view(Result, "delassus", float, 2)
system = _view(Result, "system", float, 2)
chosen = _view(Result, "chosen", int)
tableau = _view(Result, "tableau", float, 2)
basis = _view(Result, "basis", int, 2)

# what samples are kept in
kept_pose = _view(Snapshot, "pose", float, 3)
kept_velocity = _view(Snapshot, "velocity", float, 3)
kept_acceleration = _view(Snapshot, "acceleration", float, 3)
kept_springs = _view(Snapshot, "springs", float, 3)
kept_cords = _view(Snapshot, "cords", float, 3)
kept_slips = _view(Snapshot, "slips", float, 3)
kept_lifted = _view(Snapshot, "lifted", float, 2)
kept_actions = _view(Snapshot, "actions", float, 3)
kept_joints = _view(Snapshot, "joints", float, 3)
kept_fluids = _view(Snapshot, "fluids", float, 3)
kept_valves = _view(Snapshot, "valves", float, 3)
kept_pumps = _view(Snapshot, "pumps", float, 3)
kept_loads = _view(Snapshot, "loads", float, 3)
kept_ties = _view(Snapshot, "ties", int, 2)
kept_drive = _view(Snapshot, "drive", float, 2)
kept_contacts = _view(Snapshot, "contacts", CONTACT)
kept_fill = _view(Snapshot, "fill", int)
kept_taken = _view(Snapshot, "taken", int)
sums = _view(Snapshot, "sums", float)
kept_means = _view(Snapshot, "means", float, 2)
kept_steady = _view(Snapshot, "steady", int)
waiting = _view(Snapshot, "waiting", float)
mean_contacts = _view(Snapshot, "mean_contacts", CONTACT_SUMS)
mean_fill = _view(Snapshot, "mean_fill", int)
unfinished = _view(Snapshot, "unfinished", int)
