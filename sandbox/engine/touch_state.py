"""Records of shapes and what touches, as those of :mod:`sandbox.engine.state`."""

from __future__ import annotations

import numpy as np

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
])
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
