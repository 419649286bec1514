"""Records of the elements in the tables of the compiled step: one row for each element.

Samples copy each record from the field on that :data:`SAMPLED` names. Bodies are numbered as pymunk
lists them (``World.order``); points of bodies are relative to their centres of mass, along the
body's axes.
"""

from __future__ import annotations

import numpy as np

STIFF, PULL, ELASTIC, DAMPED, EVEN, GRIPPED = 0, 1, 2, 3, 4, 5
"""Kinds of tendon and spring: solved at the step's end; of given tension; explicit; with a damper,
at mid-step; evenly about the pose; a whole tendon with friction, whose spans pull."""
SOFT, RESOLVED = 1.0, 4.0
"""h^2 k s up to which an element is explicit (stable up to 4), and up to which springs are taken
evenly about the pose: four steps in a period. Stiffer ones are solved at the step's end."""

ACTION = np.dtype([
    ("drive", np.int64), ("a", np.int64), ("b", np.int64),  # bodies; b is -1 for a force
    ("x", float), ("y", float), ("dx", float), ("dy", float),   # place of a force, its direction
    ("turning", np.int64),  # whether the direction turns with the body
    ("joint", np.int64), ("line", np.int64),    # driven joint, or -1; whether it is an actuator
    ("motor", np.int64), ("sense", float),  # motor or brake, or -1; sign of the hinge
    ("bond", np.int64), ("runs", np.int64),     # of the hinge; whether it drives the surface of a
    ("fx", float), ("fy", float),   # of a force, in the world [N]
    ("work", float),        # on the bodies [J]
    ("torque", float),      # on a, or on b in a hinge's sense [N m]; power of a driven surface [W]
    ("step_work", float),
])

SPRING = np.dtype([
    ("number", np.int64), ("joint", np.int64),  # the model's, -1 for the damping of a hinge; hinge
    ("turning", np.int64),  # whether its coordinate is an angle; a distance otherwise
    ("kind", np.int64),     # STIFF, EVEN, ELASTIC or DAMPED
    ("drive", np.int64),    # that sets its stiffness, or -1
    ("a", np.int64), ("ax", float), ("ay", float), ("b", np.int64), ("bx", float), ("by", float),
    ("k", float), ("c", float),     # [N/m, N m/rad], [N s/m, N m s/rad]
    ("sense", float),       # from its coordinate to the stretch that its law takes, 1 or -1
    ("row", np.int64), ("entry", np.int64),     # its unknown, or -1; the first of two entries
    ("code", np.int64), ("code_end", np.int64),     # steps of its law, or -1
    ("of_rate", np.int64),  # whether its law depends on the rate
    ("response", float),    # bound of the response of its ends to a unit effort [1/kg, 1/(kg m^2)]
    ("bond", np.int64), ("hinge_bond", np.int64),     # BOND of the spring and of its hinge, or -1
    ("rest", float),        # its coordinate at rest [m, rad]
    ("dx", float), ("dy", float), ("ta", float), ("tb", float),     # what its coordinate depends on
    ("stiff", np.int64),    # of a law: 0 soft, 1 even about the pose, 2 at the step's end
    ("way", float), ("effort", float),  # coordinate [m, rad]; positive if it grows by it [N, N m]
    ("work", float), ("step_work", float),  # since t = 0, and of the last step [J]
])

POINT, GROOVE, DISTANCE, RANGE, GEAR, RACK, ROLL = 0, 1, 2, 3, 4, 5, 6  # constraints of joints
PACED, SPRUNG, PLACED = 0, 1, 2  # motors: with a rate or none; a spring to a place; rigid to it
STOP, LINE, FLANK = 0, 1, 2  # limits: angle of a hinge; position or distance; play of teeth

JOINT = np.dtype([
    ("keeps", np.int64),    # POINT ... ROLL
    ("a", np.int64), ("ax", float), ("ay", float), ("b", np.int64), ("bx", float), ("by", float),
    ("gx", float), ("gy", float),   # direction of a groove in a, or of a rack in b, a unit vector
    ("reach", float),       # distance kept; length of a groove, or minimum radius of curvature of a
                            # path; what teeth bend about [m]
    ("turn", float),        # angle of b against a kept by what does not turn [rad]
    ("ra", float), ("rb", float),   # of teeth the base circles, of what rolls the circles; rb with
                                    # the sign by which it turns with a [m]
    ("push", float),        # of gears: 1 side by side, -1 one inside the other
    ("tilt_c", float), ("tilt_s", float), ("k", float),     # of a rack's pressure angle; of teeth
    ("start", float), ("start_back", float),    # initial gaps of flanks, or slip [m]
    ("row", np.int64), ("row_y", np.int64),     # unknowns of its force, or -1; of what rolls the
                                                # second is that along the circles
    ("row_turn", np.int64),     # unknown of its couple, or -1
    ("entry", np.int64), ("entries", np.int64),     # the first of its entries, two a row; how many
    ("hinge", np.int64), ("stopped", np.int64),     # whether it has an angle; and stops
    ("sense", float), ("zero", float),  # of a hinge: as in ACTION; subtracted from the angle [rad]
    ("bond", np.int64), ("line", np.int64),     # or -1; whether its length is recorded
    ("span", np.int64), ("span_end", np.int64),     # SPANs of the path of a slot; -1 without
    ("around", float),      # length of a closed path, else 0 [m]
    ("flank", float),       # which side of the teeth pushes, +1 or -1
    ("on", np.int64), ("place", float),     # of a path: the span where the point is, arc length [m]
    ("dx", float), ("dy", float), ("ta", float), ("tb", float),     # what its free coordinate
                            # depends on; of teeth the direction of the push on b
    ("kick_x", float), ("kick_y", float),   # impulse on b besides that of its rows [N s]: impacts
                                            # act in another pose
    ("twist_a", float), ("twist_b", float),     # for the same reason moments on a and b [N m s]
    ("way", float), ("rate", float),    # its free coordinate [m, rad]; its rate, a hinge's in its
                                        # sense
    ("fx", float), ("fy", float), ("couple", float),    # on b [N, N m]
    ("stop", float),        # torque of the stops of a hinge, in its sense [N m]
])

LIMIT = np.dtype([
    ("joint", np.int64), ("what", np.int64),    # STOP, LINE or FLANK
    ("side", float), ("bound", float),  # +1 for the minimum, -1 for the maximum; [rad, m]
    ("since", float), ("next", float),  # time since it was hit, or 0 [s]; the same of this step
    ("impulse", float),     # of the last step [N s, N m s]
])

MOTOR = np.dtype([
    ("drive", np.int64), ("a", np.int64), ("b", np.int64),
    ("sense", float),       # from a counter-clockwise turn to the hinge's positive one
    ("maximum", float),     # of a motor [N m]; nan of a brake, whose value that is
    ("slope", float),       # of a motor with a line [N m s/rad]; nan of others
    ("bond", np.int64), ("law", np.int64),  # of the hinge, or -1; PACED, SPRUNG or PLACED
    ("joint", np.int64), ("line", np.int64),    # whether the joint is an actuator: [N, m]
    ("k", float), ("c", float), ("stiff", np.int64),    # of a servo; if taken at the step's end
    ("fastest", float), ("zero", float),    # maximum rate [rad/s]; subtracted from the angle [rad]
    ("target", float), ("aim", float),  # after the last step, nan before; after this one [rad]
    ("short", float),       # distance from its target [rad]
    ("along", float), ("seen", float),  # rate of the target; its own before the step [rad/s]
    ("command", float), ("bend", float),    # rates: to be reached; by which its line grows besides
    ("impulse", float), ("mode", np.int64),  # on b [N m s]; -1 and 1 at its bounds, else 0
])

DRY_FRICTION = np.dtype([
    ("joint", np.int64), ("sum", np.int64),     # number of its load, after bodies, slips and sums
    ("maximum", float), ("share", float),   # friction [N m, N]; for 1 N of load [m, 1], or 0
    ("static", float),      # ratio of static to sliding friction
    ("impulse", float), ("pressed", float),  # on b, along the coordinate; of the load [N s]
    ("mode", np.int64), ("bound", float),  # -1, 1 where it slipped; static friction where it held
    ("ux", float), ("uy", float),   # where the joint pushed: of rows, not of the world
    ("kept", np.int64), ("place", float),   # whether it has held since it was noted at a place [m]
    ("work", float), ("force", float),  # [J]; on b, in the joint's sense [N m, N]
    ("sticks", float), ("step_work", float),    # 1 where it held, else 0; [J]
])

CABLE = np.dtype([
    ("first", np.int64), ("last", np.int64),    # its guides
    ("kind", np.int64),     # STIFF, PULL, ELASTIC, DAMPED, EVEN or GRIPPED
    ("closed", np.int64), ("lifts", np.int64),  # a loop; whether it can lift off any wheel
    ("drive", np.int64), ("stiffener", np.int64),   # that pull it, set its stiffness; or -1
    ("c", float),           # [N s/m]; of a span times its length of tendon [N s]
    ("whole", np.int64),    # of a span the tendon that it is of, or -1
    ("spans", np.int64), ("spans_end", np.int64),   # of a tendon that guides grip
    ("minimum", float), ("response", float),    # length in a span [m]; largest J M^-1 J^T [1/kg]
    ("row", np.int64), ("entry", np.int64), ("entries", np.int64),  # its unknown and entries, or -1
    ("into", np.int64), ("out_of", np.int64),   # entries of what slips into a span and out of it
    ("bond", np.int64), ("active", np.int64),   # whether it pulled in the last solve
    ("k", float), ("rest", float),  # [N/m], of a span times its length; with what is wound up [m]
    ("inside", float),      # length of tendon in a span between its wheels [m]
    ("work", float), ("length", float),
    ("wound", float),       # share of that which a span's wheels have wound up since t = 0 [m]
    ("tension", float), ("step_work", float),
])

GUIDE = np.dtype([
    ("body", np.int64), ("x", float), ("y", float),     # place [m]
    ("radius", float),      # of the wheel, positive where its centre lies right of the path [m]
    ("turns", float), ("lifts", np.int64),  # whole ones at t = 0; whether it can lift off its wheel
    ("entry", np.int64),    # where its share of the tendon's row is added, if that has one
    ("jx", float), ("jy", float), ("jt", float),    # dL/dx, dL/dy, dL/dangle of the body
    ("wrap", float),        # angle round the wheel, or where a wound tendon leaves it [rad]
    ("wrap0", float), ("lifted", np.int64),     # wrap at t = 0; whether the tendon is off its wheel
])

SLIP = np.dtype([
    ("cable", np.int64), ("guide", np.int64),   # whole, and where it slips
    ("twin", np.int64),     # the same guide at the end of a loop, or -1
    ("before", np.int64), ("after", np.int64), ("friction", float),     # spans on either side
    ("row", np.int64),      # unknown of its rate
    ("slide", np.int64), ("sum", np.int64),     # where bounded rows find it, and the tensions' sum
    ("impulse", float), ("pressed", float),     # of friction, sum of both tensions' [N s]
    ("mode", np.int64), ("rate", float),    # as of BOUND; [m/s]
    ("way", float), ("force", float),  # of tendon into the span after [m]; drop of the tension [N]
])

FLUID = np.dtype([
    ("first", np.int64), ("last", np.int64),    # its chambers
    ("ahead_min", float), ("ratio", float),     # minimum k and r of its law (fluids.py)
    ("drive", np.int64),    # that sets its pressure, or -1
    ("volume", float), ("c", float),    # at t = 0 [m^3]; of a liquid [m^3/Pa]
    ("gas", float),         # the exponent of a gas, 0 of a liquid
    ("start", float), ("minimum", float), ("maximum", float),   # pressure at t = 0, bounds [Pa]
    ("response", float), ("row", np.int64),     # largest A M^-1 A^T in any pose [m^4/kg]; unknown
    ("content", float),     # at 0 Pa; of a liquid beyond that at t = 0 [m^3]
    ("mode", np.int64),     # -1 not full, 0 full, 1 let out by its relief
    ("spilled", float), ("work", float),    # by the relief [m^3]; on the bodies [J]
    ("grown", float), ("pressure", float),  # growth of its volume since t = 0 [m^3]; [Pa]
    ("ahead", float), ("flow", float),  # steps from the pose to its law's instant; into it [m^3/s]
    ("rigid", float),       # pressure, were the volume to stay [Pa]
    ("yields", float), ("swells", float),  # volume per pressure there [m^3/Pa], per content
    ("conductance", float), ("supply", float),  # fall of the flow per pressure; flow at 0 Pa
    ("step_work", float),   # [J]
])

CHAMBER = np.dtype([
    ("a", np.int64), ("ax", float), ("ay", float), ("b", np.int64), ("bx", float), ("by", float),
    ("turns", np.int64),    # whether it is on a hinge
    ("gain", float), ("start", float),  # volume per distance or angle; that at t = 0
    ("entry_a", np.int64), ("entry_b", np.int64),   # where its share of the row is added
    ("dx", float), ("dy", float), ("ta", float), ("tb", float),     # force on b, moments for 1 Pa
])

VALVE = np.dtype([
    ("a", np.int64), ("b", np.int64),   # lines, -1 for the tank
    ("r", float), ("k", float),     # pressure per flow and per square of it
    ("one_way", np.int64), ("drive", np.int64),     # that opens it, or -1
    ("slot", np.int64),     # of the matrix where its lines meet, -1 with the tank
    ("flow", float), ("shut", np.int64), ("loss", float),   # a to b [m^3/s]; of check valves; [J]
    ("about", float),       # the flow about which its law is linearised [m^3/s]
    ("conductance", float), ("supply", float),  # flow there per pressure, and without pressure
    ("step_loss", float),
])

PUMP = np.dtype([
    ("drive", np.int64), ("line", np.int64),
    ("source", np.int64), ("r", float),     # whether its value is a pressure; between it and line
    ("work", float), ("flow", float), ("step_work", float),     # on the fluid [J]; into the line
])

LOAD = np.dtype([
    ("number", np.int64), ("body", np.int64),   # the model's number
    ("x", float), ("y", float),     # where its force acts, from the centre of mass [m]
    ("turning", np.int64),  # whether its components are along the body's axes
    ("scale", float),       # of its force: the mass where it is an acceleration, else 1
    ("mass", float), ("inertia", float),    # of the body [kg, kg m^2]
    ("x_code", np.int64), ("x_end", np.int64),  # steps of the programs of its two components and
    ("y_code", np.int64), ("y_end", np.int64),  # its torque, or -1
    ("t_code", np.int64), ("t_end", np.int64),
    ("timed", np.int64),    # whether it depends on time
    ("first", np.int64), ("last", np.int64),    # sides of the outline in a liquid
    ("level", float), ("lift", float),  # of the liquid [m]; its force per area below [N/m^2]
    ("work", float), ("fx", float), ("fy", float),  # [J], in the world [N]
    ("torque", float), ("step_work", float),    # about the centre of mass [N m]
])

LOADED = np.dtype([
    ("body", np.int64), ("first", np.int64), ("last", np.int64),    # its loads
    ("row", np.int64), ("row_y", np.int64), ("row_turn", np.int64),     # unknowns, or -1
    ("entry", np.int64), ("stiff", np.int64),   # first of three; if taken at the step's end
])
SUM, SLOPES, GIVEN, YIELDS, AXES, SCRATCH = 0, 1, 4, 5, 6, 9
"""Rows of numbers of a loaded body: sum of its loads [N, N, N m]; slopes by velocities after the
step; part in the known forces; rates at which loads slow motion along axes [1/s]; axes; scratch."""
NUMBERS = 13  # number of rows

JOINED, SPRINGY, PULLING = 0, 1, 2  # kinds of bonds: a joint, a spring, a tendon
SETTLED, TAKEN = -1.0, -2.0  # ages of joints: closed; engaged, the gap is not yet measured
NONE = -1  # no request

BOND = np.dtype([
    ("what", np.int64), ("index", np.int64),    # JOINED, SPRINGY or PULLING; in the table of these
    ("breaks_at", float), ("over", float),  # [N, N m]; time in which a joint's gap closes [s]
    ("as_is", np.int64), ("drive", np.int64),   # engages with its current length; holds it, or -1
    ("request", np.int64),  # of an event for the next step: 0 release, 1 engage, NONE
    ("driven", np.int64),   # as a drive had it last; at first whether it holds
    ("load", float), ("last_load", float),  # nan where it did not hold then [N, N m]
    ("age", float),         # time since a joint engaged [s], SETTLED or TAKEN
    ("x", float), ("y", float), ("t", float),       # its gaps then [m, m, rad]
    ("vx", float), ("vy", float), ("vt", float),    # and their rates
    ("turns", float),       # whole turns that a couple leaves alone [rad]
    ("broke", np.int64), ("held", np.int64),    # in this step
])
BROKEN = np.dtype([
    ("bond", np.int64), ("row", np.int64),  # the step, counted from 0 among those made in one go
    ("when", float),        # since the middle of the step before it, as a share of the step
])

SAMPLED = {
    "actions": "work", "springs": "way", "cables": "work", "guides": "lifted", "slips": "way",
    "joints": "twist_a", "dry_friction": "work", "fluids": "content", "valves": "flow",
    "pumps": "work", "loads": "work", "bonds": "held",
}  # the tables that samples copy, and from which field on; recorded values are computed later
