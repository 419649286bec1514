"""Records of loads: what never changes, what the next step needs, what a step gave."""

from __future__ import annotations

import numpy as np

LOAD = np.dtype([
    ("number", np.int64),   # the model's
    ("body", np.int64),
    ("x", float), ("y", float),     # where its force acts, from the centre of mass [m]
    ("turning", np.int64),  # whether its components are along the body's axes
    ("scale", float),       # of its force: the mass where it is an acceleration, else 1
    ("mass", float), ("inertia", float),    # of the body [kg, kg m^2]
    ("x_code", np.int64), ("x_end", np.int64),  # steps of the programs of its two components and
    ("y_code", np.int64), ("y_end", np.int64),  # its torque, or -1
    ("t_code", np.int64), ("t_end", np.int64),
    ("timed", np.int64),    # whether it hangs on the time
    ("first", np.int64), ("last", np.int64),    # sides of what a liquid lifts
    ("level", float),       # of the liquid [m]
    ("lift", float),        # its force per area below that [N/m^2]
])
LOAD_STATE = np.dtype([
    ("work", float),        # done on the body [J]
])
LOAD_RESULT = np.dtype([
    ("fx", float), ("fy", float),   # in the world [N]
    ("torque", float),      # about the centre of mass [N m]
    ("step_work", float),   # of the last step [J]
])

LOADED = np.dtype([
    ("body", np.int64),
    ("first", np.int64), ("last", np.int64),    # its loads
    ("row", np.int64), ("row_y", np.int64), ("row_turn", np.int64),     # unknowns, or -1
    ("entry", np.int64),    # the first of the three entries of these
])
LOADED_RESULT = np.dtype([
    ("stiff", np.int64),    # whether its loads are taken at the step's end
])
SUM, SLOPES, GIVEN, YIELDS, AXES, SCRATCH = 0, 1, 4, 5, 6, 9
"""Rows of numbers of each loaded body, three a row: the sum of its loads [N, N, N m]; by how much
that grows with each velocity after the step; what of it is among the known forces; the rates at
which loads slow motion along each of three axes [1/s]; these axes; scratch."""
NUMBERS = 13
"""How many rows there are."""
