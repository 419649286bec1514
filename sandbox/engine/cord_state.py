"""What a step knows of cords, their guides, and what slips over these.

Kinds of cord and all else about these records: :mod:`sandbox.engine.state`.
"""

from __future__ import annotations

import numpy as np

CORD = np.dtype([
    ("first", np.int64), ("last", np.int64),    # its guides
    ("kind", np.int64),     # STIFF, PULL, ELASTIC, DAMPED, EVEN or GRIPPED
    ("closed", np.int64),   # whether its last guide is its first
    ("lifts", np.int64),    # whether it can lift off any of its wheels
    ("drive", np.int64),    # that pulls it, or -1
    ("stiffener", np.int64),    # drive that sets its stiffness, or -1
    ("c", float),           # [N s/m]; of a span it is this over what is in it [N s]
    ("whole", np.int64),    # of a span the cord that it is of, or -1
    ("spans", np.int64), ("spans_end", np.int64),   # of a cord that guides grip
    ("least", float),       # so much of a cord counts as being in a span, at least [m]
    ("response", float),    # largest J M^-1 J^T in any pose [1/kg]
    ("row", np.int64),      # its unknown, or -1
    ("entry", np.int64), ("entries", np.int64),     # the first of its entries, and how many
    ("into", np.int64), ("out_of", np.int64),   # entries of what slips into a span and out of it
    ("tie", np.int64),      # TIE of the cord, or -1
])
CORD_STATE = np.dtype([
    ("active", np.int64),   # whether it pulled in the last solve
    ("k", float),           # in force [N/m]; of a span it is this over what is in it [N]
    ("rest", float),        # length up to which it is slack; of a span with what it wound up [m]
    ("inside", float),      # what is in a span between its wheels [m]
    ("work", float),        # [J]
])
CORD_RESULT = np.dtype([
    ("length", float),      # [m]
    ("wound", float),       # share of that which a span's wheels have wound up since t = 0 [m]
    ("tension", float),     # [N]
    ("step_work", float),   # [J]
])

GUIDE = np.dtype([
    ("body", np.int64), ("x", float), ("y", float),     # place [m]
    ("radius", float),      # of the wheel, positive where its centre lies right of the path [m]
    ("turns", float),       # whole ones round it at t = 0, besides
    ("lifts", np.int64),    # whether the cord can lift off its wheel
    ("entry", np.int64),    # where its share of the cord's row is added, if that has one
])
GUIDE_STATE = np.dtype([
    ("wrap", float),        # angle round the wheel, or where a wound cord leaves it [rad]
    ("wrap0", float),       # the same at t = 0, of a wound cord
    ("lifted", np.int64),   # whether the cord is off its wheel
])
GUIDE_RESULT = np.dtype([
    ("jx", float), ("jy", float),   # dL/dx, dL/dy of the body
    ("jt", float),          # dL/dangle [m]
])

SLIP = np.dtype([
    ("cord", np.int64),     # whole, that slips
    ("guide", np.int64),    # its guide at which it does
    ("twin", np.int64),     # the same guide at the end of a loop, or -1
    ("before", np.int64), ("after", np.int64),      # spans on either side
    ("friction", float),    # coefficient
    ("row", np.int64),      # unknown of its rate
    ("slide", np.int64), ("sum", np.int64),     # where bounded rows find it, and the tensions' sum
])
SLIP_STATE = np.dtype([
    ("way", float),         # of cord from the span before into that after since t = 0 [m]
    ("impulse", float),     # of friction in the last step [N s]
    ("sum", float),         # of both tensions' impulses in the last step [N s]
    ("mode", np.int64),     # as of BOUND
])
SLIP_RESULT = np.dtype([
    ("rate", float),        # [m/s]
    ("force", float),       # by how much the tension behind is larger than that before [N]
])
