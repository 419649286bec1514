"""Closed forms: the paper's equations and underactuated statics, pure functions of arrays.

Every equation of "An Underactuated Multi-finger Grasping Device", where it is
computed here, and what was done about its misprints:

| equation | function | note |
|---|---|---|
| (8) | `tendon.guide_radius` | |
| (9) | `tendon.guide_distance` | |
| (10) | `tendon.hinge_angle_before` | two-argument atan2; at the hinge, unlike (14) |
| (11) | `tendon.hinge_angle_after` | two-argument atan2, -y for the modulus of y |
| (12) | `tendon.angle_at_zero` | |
| (13) | `tendon.segment_length` | at beta_0 |
| (14) | `tendon.guide_angle_before` | at the guide: not the angle of (10) |
| (15) | `tendon.guide_angle_after` | dt_(i-1) for the printed dt_(i) |
| (16) | `tendon.TendonRoute.beta` | right as printed |
| (17) | `tendon.segment_length` | at beta; `TendonRoute.lengths` for a finger |
| (18) | `tendon.TendonRoute.shortenings` | |
| (19) | `tendon.TendonRoute.shortening` | |
| (20) | `springs.attachment_radius` | y of M' for the printed y of M |
| (21) | `springs.attachment_distance` | M'' taken from C_i, which the paper leaves open |
| (22) | `springs.hinge_angle_before` | atan2(y, -x) for the printed atan2(y/x) |
| (23) | `springs.hinge_angle_after` | two-argument atan2 |
| (24) | `springs.angle_at_zero` | |
| (25) | `springs.spring_length` | at delta_0 |
| (26) | `springs.SpringSet.attachment_angles` | rm squared once |
| (27) | `springs.SpringSet.attachment_angles` | |
| (28) | `springs.SpringSet.delta` | delta_0 + theta = pi - rho_0 - omega_0 + theta |
| (29) | `springs.spring_length` | at delta; `SpringSet.lengths` for a finger |
| (30) | `springs.SpringSet.elongations` | |
| (31) | `chain.transforms` | any number of phalanges |

Beyond the paper: `statics` (joint torques, J, contacts that let go, stops that
act, which forces are determined), `transmission` (ratios, the two-phalanx
equilibrium curve, isotropy), `grasp_state` (the grasp-state map and its slides),
`grasp` (a finger round a disc), `closure` (force closure of an object, epsilon,
isotropy), `grasp_stiffness` (what a push of it is answered with), `four_bar`
(linkages, fingers that a crank closes).

docs/mechanics.md has worked examples of the latter.

Everything takes and returns NumPy arrays in SI units and broadcasts over
leading axes such as time. Impossible geometry is refused with a ``ValueError``
that names the argument, its value and its unit.
"""
