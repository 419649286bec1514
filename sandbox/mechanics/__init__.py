"""Closed forms: the paper's equations and underactuated statics, pure functions of arrays.

Every equation of "An Underactuated Multi-finger Grasping Device", its function here, and
corrections of misprints:

| equation | function | note |
|---|---|---|
| (8), (9) | `tendon.TendonRoute.rt`, `dt` | |
| (10), (11) | `tendon.route` | two-argument atan2, -y for the modulus of y |
| (12) | `tendon.TendonRoute.beta_0` | |
| (13), (17) | `tendon.segment_length`; `TendonRoute.lengths` for a finger | |
| (14), (15) | `tendon.TendonRoute.guide_angles` | at the guides; dt_(i-1) for the printed dt_(i) |
| (16) | `tendon.TendonRoute.beta` | right as printed |
| (18), (19) | `tendon.TendonRoute.shortenings`, `shortening` | |
| (20), (21) | `springs.SpringSet.rm`, `dm` | y of M' for the printed y of M |
| (22), (23) | `springs.SpringSet.rho_0`, `omega_0` | atan2(y, -x) for the printed atan2(y/x) |
| (24), (28) | `springs.SpringSet.delta` | delta_0 + theta = pi - rho_0 - omega_0 + theta |
| (25), (29) | `springs.spring_length`; `SpringSet.lengths` for a finger | |
| (26), (27) | `springs.SpringSet.attachment_angles` | rm squared once |
| (30) | `springs.SpringSet.elongations` | |
| (31) | `chain.transforms` | any number of phalanges |
"""
