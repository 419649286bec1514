"""What a step knows of joints, springs and cords that may be let go."""

from __future__ import annotations

import numpy as np

JOINED, STRAIGHT, TURNING, CORDED = 0, 1, 2, 3
"""What is let go: a joint, a straight spring, a rotary spring, a cord."""
SETTLED, TAKEN = -1.0, -2.0
"""As the time since a joint was taken up: its gap is closed; it is still to be looked at."""
NONE = -1
"""No wish."""

TIE = np.dtype([
    ("what", np.int64),     # JOINED, STRAIGHT, TURNING or CORDED
    ("index", np.int64),    # in the table of these
    ("breaks_at", float),   # [N, N m]
    ("over", float),        # time in which a joint's gap closes [s]
    ("as_is", np.int64),    # whether it is taken up with the length that it has then
    ("drive", np.int64),    # that holds it, or -1
])
TIE_STATE = np.dtype([
    ("held", np.int64),
    ("wish", np.int64),     # of an event: to let go, 0, or take up, 1, with the next step; NONE
    ("driven", np.int64),   # as a drive had it last; at first whether it holds
    ("load", float),        # of the last step, nan where it did not hold then [N, N m]
    ("age", float),         # since a joint was taken up [s], SETTLED or TAKEN
    ("x", float), ("y", float), ("t", float),       # its gaps then [m, m, rad]
    ("vx", float), ("vy", float), ("vt", float),    # and their rates
    ("turns", float),       # whole turns that a couple leaves alone [rad]
])
BROKEN = np.dtype([
    ("tie", np.int64),      # what came to its load
    ("row", np.int64),      # the step in which it did, counted from 0 among those made in one go
    ("when", float),        # since the middle of the step before it, as a share of the step
])
TIE_RESULT = np.dtype([
    ("load", float),        # in this step [N, N m]
    ("broke", np.int64),    # whether it broke in this step
])
