"""How hard an object may be pushed before no forces balance it any more.

The balance of :mod:`sandbox.audit.bounds` with one unknown more: a force F along a direction at the
centre of mass of one body. What drives give, springs and weights stay as they are in the sample;
contacts, within their cones, joints, stops and cords that nobody pulls carry what they must. Beyond
the largest such F there is no balance at rest where all is now: something gives way, by however
little, and in another pose there may be balance again. Below it something may give way, too.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sandbox.audit.bounds import Balance, Together, together
from sandbox.audit.evidence import Evidence
from sandbox.audit.touching import touched
from sandbox.audit.unknowns import Unknown, Unknowns
from sandbox.numeric import Array


def known_by_sum(evidence: Evidence, body: int, sample: int = -1) -> list[tuple[int, int]]:
    """Pairs that touch with several normals, of those that hang together with a body in a sample.

    Only the sum of their forces is recorded. They are taken to carry any, so that a bound may be
    too large, or none. Numbers of bodies.
    """
    unknowns = Unknowns(touched(evidence.alone(sample % len(evidence.run))))
    group = next((each for each in together(unknowns) if body in each.bodies), None)
    rows = sorted({one.contact for one in group.forces if one.contact >= 0 and one.free}
                  ) if group is not None else []
    a = unknowns.arrays
    return [(int(a["contact_body"][row]), int(a["contact_other"][row])) for row in rows]


def push_limits(
    evidence: Evidence, body: int, directions: Sequence[float], sample: int = -1,
) -> Array:
    """The largest push of a body that can be balanced in a sample [N], for each direction [rad].

    inf where there is no bound; nan where no forces balance the sample itself; 0 of a body that
    nothing touches, and where it is no more than rounding.

    Raises:
        ArithmeticError: a linear program does not come to an end.
    """
    unknowns = Unknowns(touched(evidence.alone(sample % len(evidence.run))))
    group = next((each for each in together(unknowns) if body in each.bodies), None)
    if group is None:
        return np.zeros(len(directions))
    found = []
    for angle in directions:
        push = Unknown({body: np.array([np.cos(angle), np.sin(angle), 0.0])})
        balance = Balance(unknowns, Together(group.bodies, [*group.forces, push]),
                          evidence.left_allowed)
        weight = np.zeros(len(group.forces) + 1)
        weight[-1] = -1.0 / balance.unit[-1]
        least, slack = balance.least(weight) if balance.balanced() else (np.nan, 0.0)
        found.append(0.0 if abs(least) <= slack else -least)
    return np.array(found)
