"""Records of joints, their limits, their motors and brakes, their dry friction; and what they do.

As :mod:`sandbox.engine.state` has them: what never changes, what lasts, what a step gives.
"""

from __future__ import annotations

import numpy as np

POINT, GROOVE, DISTANCE, RANGE, GEAR, RACK, ROLL = 0, 1, 2, 3, 4, 5, 6
"""What joints keep."""
PACED, SPRUNG, PLACED = 0, 1, 2
"""What motors do: keep a rate, or none; go to a place as a spring would, or rigidly."""
STOP, LINE, FLANK = 0, 1, 2
"""What is limited: a hinge's angle; the way along a groove or a distance; the play of teeth."""

JOINT = np.dtype([
    ("keeps", np.int64),    # POINT ... ROLL
    ("a", np.int64), ("ax", float), ("ay", float),  # body and point [m]; of a groove its start
    ("b", np.int64), ("bx", float), ("by", float),
    ("gx", float), ("gy", float),   # direction of a groove in a, or of a rack in b, a unit vector
    ("reach", float),       # distance kept; length of a groove; what teeth bend about [m]
    ("turn", float),        # angle of b against a kept by what does not turn [rad]
    ("ra", float), ("rb", float),   # of teeth the base circles, of what rolls the circles; rb with
                                    # the sign by which it turns with a [m]
    ("push", float),        # of gears: 1 side by side, -1 one inside the other
    ("tilt_c", float), ("tilt_s", float),   # of a rack: of its pressure angle
    ("k", float),           # of teeth without play [N/m]
    ("start", float), ("start_back", float),    # what its flanks, or its rolling, begin with [m]
    ("row", np.int64), ("row_y", np.int64),     # unknowns of its force, or -1; of what rolls the
                                                # second is that along the circles
    ("row_turn", np.int64),     # unknown of its couple, or -1
    ("entry", np.int64),    # the first of two entries a row
    ("hinge", np.int64), ("stopped", np.int64),     # whether it has an angle; and stops
    ("sense", float),       # of a hinge, from a counter-clockwise turn to its positive one
    ("zero", float),        # what its angle is less by [rad]
    ("tie", np.int64),      # its TIE, or -1
    ("line", np.int64),     # whether it is an actuator, whose length is told
])
JOINT_STATE = np.dtype([
    ("flank", float),       # which side of the teeth pushes, +1 or -1
])
JOINT_RESULT = np.dtype([
    ("way", float),         # along a groove from its start; the distance [m]
    ("dx", float), ("dy", float),   # direction along the groove, or from a to b; push of teeth on b
    ("ta", float), ("tb", float),   # d way / d angle of a and of b [m]
    ("fx", float), ("fy", float),   # its force on b [N]
    ("couple", float),      # on b [N m]
])

LIMIT = np.dtype([
    ("joint", np.int64),
    ("what", np.int64),     # STOP, LINE or FLANK
    ("side", float),        # +1 for the least value, -1 for the largest; which flank
    ("bound", float),       # [rad, m]
])
LIMIT_STATE = np.dtype([
    ("impulse", float),     # of the last step [N s, N m s]
])

MOTOR = np.dtype([
    ("drive", np.int64), ("a", np.int64), ("b", np.int64),
    ("sense", float),       # from a counter-clockwise turn to the hinge's positive one
    ("most", float),        # of a motor [N m]; nan of a brake, whose value that is
    ("slope", float),       # of a motor with a line [N m s/rad]; nan of others
    ("tie", np.int64),      # TIE of the hinge, or -1
    ("law", np.int64),      # PACED, SPRUNG or PLACED
    ("line", np.int64),     # the actuator that it lengthens [N, m for N m, rad], or -1
    ("k", float), ("c", float),     # with which it goes to a place [N m/rad, N m s/rad]
    ("stiff", np.int64),    # whether these are taken at the step's end
    ("fastest", float),     # that it goes there [rad/s]
    ("zero", float),        # what the hinge's angle is less by [rad]
])
MOTOR_STATE = np.dtype([
    ("target", float),      # the place that it was to be at after the last step, nan before [rad]
    ("aim", float),         # the same after this one [rad]
    ("short", float),       # by how much it is not where it was to be [rad]
    ("along", float),       # the rate of its target [rad/s]
    ("seen", float),        # its rate before the step [rad/s]
    ("asked", float),       # the rate that it is asked for [rad/s]
    ("bend", float),        # rate by which its line grows besides in the step [m/s]
    ("impulse", float),     # on b, of the last step [N m s]
    ("mode", np.int64),     # -1 and 1 at its least and largest torque, 0 in between
])

RUB = np.dtype([
    ("joint", np.int64),
    ("sum", np.int64),      # what the joint carries, counted on from bodies, slips and sums
    ("most", float),        # what it rubs with, of what hangs on nothing [N m, N]
    ("share", float),       # or of 1 N that the joint carries [m, 1]; 0 of what hangs on nothing
    ("static", float),      # how many times as much it holds with
])
RUB_STATE = np.dtype([
    ("impulse", float),     # on b, counter-clockwise or along the groove, of the last step
    ("pressed", float),     # that of the joint which it hangs on [N s]
    ("mode", np.int64),     # -1 and 1 where it slipped, 0 where it held
    ("bound", float),       # static friction where it held, else nan [N s, N m s]
    ("ux", float), ("uy", float),   # where the joint pushed: of rows, not of the world
    ("kept", np.int64),     # whether it has held since a place along its groove was noted
    ("place", float),       # that place [m]
    ("work", float),        # [J]
])
RUB_RESULT = np.dtype([
    ("force", float),       # on b, in the joint's sense [N m, N]
    ("sticks", float),      # 1 where it held, else 0
    ("step_work", float),   # [J]
])
