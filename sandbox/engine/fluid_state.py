"""Records of lines of fluid, as those of :mod:`sandbox.engine.state`."""

from __future__ import annotations

import numpy as np

FLUID = np.dtype([
    ("first", np.int64), ("last", np.int64),    # its chambers
    ("ahead", float),       # the least k of its law (fluids.py)
    ("ratio", float),       # its r
    ("drive", np.int64),    # that sets its pressure, or -1
    ("volume", float),      # at t = 0 [m^3]
    ("c", float),           # of a liquid [m^3/Pa]
    ("gas", float),         # the exponent of a gas, 0 of a liquid
    ("start", float), ("least", float), ("most", float),    # pressure at t = 0, its bounds [Pa]
    ("response", float),    # largest A M^-1 A^T in any pose [m^4/kg]
    ("row", np.int64),      # its unknown
])
"""A line."""
FLUID_STATE = np.dtype([
    ("content", float),     # at 0 Pa, of a liquid beside what filled it at t = 0 [m^3]
    ("mode", np.int64),     # -1 not full, 0 full, 1 let out by its relief
    ("spilled", float),     # by the relief [m^3]
    ("work", float),        # done on the bodies [J]
])
FLUID_RESULT = np.dtype([
    ("grown", float),       # volume, beside that at t = 0 [m^3]
    ("pressure", float),    # [Pa]
    ("ahead", float),       # the k of its law: steps from the pose to its instant
    ("flow", float),        # into it [m^3/s]
    ("rigid", float),       # pressure, were the volume to stay [Pa]
    ("yields", float),      # volume per pressure, there [m^3/Pa]
    ("swells", float),      # volume per content, at one pressure
    ("lets", float),        # how much flow falls with its pressure, over valves [m^3/(s Pa)]
    ("gets", float),        # flow where all pressures at the ends of valves are 0 [m^3/s]
    ("step_work", float),   # [J]
])

CHAMBER = np.dtype([
    ("a", np.int64), ("ax", float), ("ay", float),  # body and point [m]
    ("b", np.int64), ("bx", float), ("by", float),
    ("turns", np.int64),    # whether it is on a hinge
    ("gain", float),        # volume per distance of the points, or per angle of b against a
    ("start", float),       # distance or angle at t = 0
    ("entry_a", np.int64), ("entry_b", np.int64),   # where its share of the row is added
])
CHAMBER_RESULT = np.dtype([
    ("x", float), ("y", float),     # force on b for 1 Pa
    ("ta", float), ("tb", float),   # moments for 1 Pa
])

VALVE = np.dtype([
    ("a", np.int64), ("b", np.int64),   # lines, -1 for the tank
    ("r", float), ("k", float),     # pressure per flow and per square of it
    ("one_way", np.int64),
    ("drive", np.int64),    # that opens it, or -1
    ("slot", np.int64),     # of the matrix where its lines meet, -1 with the tank
])
VALVE_STATE = np.dtype([
    ("flow", float),        # from a to b [m^3/s]
    ("shut", np.int64),     # whether a check valve is
    ("loss", float),        # [J]
])
VALVE_RESULT = np.dtype([
    ("about", float),       # the flow that its law is taken straight about [m^3/s]
    ("lets", float),        # flow per pressure there [m^3/(s Pa)]
    ("gets", float),        # flow without pressure there [m^3/s]
    ("step_loss", float),   # [J]
])

PUMP = np.dtype([
    ("drive", np.int64), ("line", np.int64),
    ("source", np.int64),   # whether its value is a pressure; a flow otherwise
    ("r", float),           # between source and line
])
PUMP_STATE = np.dtype([
    ("work", float),        # on the fluid [J]
])
PUMP_RESULT = np.dtype([
    ("flow", float),        # into the line [m^3/s]
    ("step_work", float),   # [J]
])
