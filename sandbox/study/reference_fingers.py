"""Set A and Set G: the two reference fingers, as plain numbers (SI), with no sandbox in them.

Lengths are those of digit III, rounded (Buryanov and Kotiuk 2010); masses, radii,
guides and springs are assumptions within what comparable public hands use.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

MM = 1e-3


@dataclass(frozen=True)
class FingerSet:
    """n phalanges from the palm out; straight along +x, palm side at -y, closing clockwise."""

    guides: tuple[tuple[float, float], ...]
    """V_0 (palm, from the first hinge), V_1 ... V_n (own frames) [m]."""
    before: tuple[tuple[float, float], ...]
    """M'' of every spring from its hinge, on the phalanx before [m]."""
    after: tuple[tuple[float, float], ...]
    """M' of every spring from its hinge, on the phalanx after [m]."""
    stiffness: tuple[float, ...]
    """[N/m]; slack at 0."""
    damping: tuple[float, ...]
    """Of the joints [N m s/rad]."""
    lengths: tuple[float, ...] = (45 * MM, 26 * MM, 21 * MM)
    masses: tuple[float, ...] = (12e-3, 6e-3, 4e-3)
    radii: tuple[float, ...] = (9 * MM, 8 * MM, 7.5 * MM)
    limits: tuple[float, ...] = field(default=tuple(np.radians([85.0, 95.0, 75.0]).tolist()))
    """Upper stops [rad]; the lower ones are 0."""

    @property
    def inertias(self) -> tuple[float, ...]:
        """About the centres, at L/2: m (L^2/12 + r^2/4) [kg m^2]."""
        return tuple(m * (length**2 / 12 + r**2 / 4) for m, length, r in
                     zip(self.masses, self.lengths, self.radii, strict=True))


def _points(*pairs: tuple[float, float]) -> tuple[tuple[float, float], ...]:
    return tuple((x * MM, y * MM) for x, y in pairs)


SET_A = FingerSet(
    guides=_points((-15, -5), (22.5, -5), (13, -5), (10.5, -5)),
    before=_points((-7, 8), (-7, 8), (-7, 10)),
    after=_points((7, 8), (7, 8), (7, 10)),
    stiffness=(15000.0, 5000.0, 1100.0),
    damping=(6e-3, 2.5e-3, 6e-4),
)
SET_G = FingerSet(
    guides=_points((-22, -14), (24, -8), (10, -3), (4, -1)),
    before=_points((-8, 8), (-8, 8), (-8, 8)),
    after=_points((8, 8), (8, 8), (8, 8)),
    stiffness=(300.0, 300.0, 300.0),
    damping=(4e-3, 1.2e-3, 3e-4),
)


@dataclass(frozen=True)
class DiscRow:
    """A row of the Set G table: what a frictionless finger does to a fixed disc."""

    disc_radius: float
    centre: tuple[float, float]
    tension: float
    degrees: tuple[float, float, float]
    forces: tuple[float, float, float]


SET_G_TABLE = (
    DiscRow(16 * MM, (11.0543 * MM, -38.2597 * MM), 3.75, (35.0, 62.361, 49.276),
            (0.5839, 0.9175, 0.6454)),
    DiscRow(16 * MM, (11.0543 * MM, -38.2597 * MM), 5.0, (35.0, 62.361, 49.276),
            (1.0409, 1.0009, 1.0399)),
    DiscRow(20 * MM, (8.7600 * MM, -41.5363 * MM), 5.0, (35.0, 55.369, 42.315),
            (0.6696, 0.9111, 0.9172)),
)
