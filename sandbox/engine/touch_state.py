"""Records of shapes and what touches, as those of :mod:`sandbox.engine.state`."""

from __future__ import annotations

import numpy as np

SHAPE = np.dtype([
    ("body", np.int64),
    ("margin", float),      # by which it stands out in pymunk, so that contacts are seen coming [m]
    ("first", np.int64), ("last", np.int64),    # its FACEs, -1 where all of it is surface
])
FACE = np.dtype([
    ("x0", float), ("y0", float), ("x1", float), ("y1", float),     # ends, counter-clockwise
])
"""An arc of unit normals, in the body's frame, with which a piece of an outline is its surface."""
TOUCH = np.dtype([
    ("shape_a", np.int64), ("shape_b", np.int64), ("feature", np.int64),    # which point it is
    ("a", np.int64), ("b", np.int64),       # bodies, a < b
    ("nx", float), ("ny", float),           # normal from a to b
    ("ax", float), ("ay", float), ("bx", float), ("by", float),     # arms of the point [m]
    ("gap", float),         # [m]
    ("friction", float), ("restitution", float),
    ("normal", float), ("tangent", float),  # impulses on b, along (nx, ny) and (-ny, nx) [N s]
    ("bounce", float), ("rub", float),      # the same, of impacts, which come before
    ("mode", np.int64),     # of the tangential row: -1 and 1 slide, 0 sticks
    ("listed", np.int64),   # whether its rows are among those solved
    ("late", np.int64),     # whether it is hit only because of the forces of this step
    ("belt", float),        # by how much surfaces that run add to its rate of sliding [m/s]
])

CONTACT = np.dtype([
    ("a", np.int64), ("b", np.int64),   # bodies
    ("x", float), ("y", float),         # place in the world [m]
    ("nx", float), ("ny", float),       # normal from a to b
    ("gap", float),                     # [m]
    ("normal", float), ("tangent", float),  # impulses on b, along (nx, ny) and (-ny, nx) [N s]
])
