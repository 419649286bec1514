"""Figures of touch: places, friction, slack cords."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import Figure, judged, missing
from sandbox.audit.outlines import contact_geometry
from sandbox.model.friction import friction_of, static_friction_of
from sandbox.model.ties import held_of
from sandbox.numeric import Array
from sandbox.samples.contacts import TOUCH

CONE = 1e-6
"""Fraction by which sums over the points of a contact may exceed the friction limit by rounding."""
SLIPS = 1e-3
"""Nearer to the limit than this fraction, a contact counts as slipping."""
SLACK = 1e-9
"""A tension [N] below which a cord hangs."""


def contact_figures(evidence: Evidence) -> Iterator[Figure]:
    """Places and friction of contacts, slack of tendons."""
    yield contact_geometry(evidence)
    yield _friction(evidence)
    yield _slack(evidence)


def used_friction(evidence: Evidence) -> Array:
    """Tangential force of every contact row against static friction, [m]; 1 is the cone's edge.

    Where the coefficient is 0, so is the limit: then any tangential force
    counts against the normal force itself.
    """
    a, contacts = evidence.run.arrays, evidence.run.contacts
    count = len(evidence.model.bodies.name)
    pair = a["contact_body"] * count + a["contact_other"]
    kinds = np.unique(pair)
    mu = np.array([static_friction_of(evidence.model.mechanism, *divmod(int(k), count))
                   for k in kinds])
    limit = mu[np.searchsorted(kinds, pair)] * contacts.normal if len(kinds) else np.zeros(0)
    rough = limit > TOUCH
    size = np.abs(contacts.tangential)
    smooth = 1.0 + np.maximum(size - limit, 0.0) / np.maximum(contacts.normal, TOUCH)
    return np.where(rough, size / np.where(rough, limit, 1.0), np.where(size > TOUCH, smooth, 0.0))


def _friction(evidence: Evidence) -> Figure:
    """No contact may exceed its friction limit; which ones stick and slip at the end.

    What adds up forces across normals that differ (a disc wedged in a V) has no limit of its own.
    """
    name, source = "contact.friction", "|t| <= μ n"
    a = evidence.run.arrays
    if not len(a["contact_gap"]):
        return missing(name, why="nothing touches", source=source)
    used, sure = used_friction(evidence), evidence.one_normal
    if not sure.any():
        return missing(name, source=source, why="all rows stand for several points, each with a "
                       "normal of its own")
    last = np.flatnonzero((a["contact_sample"] == len(evidence.run) - 1)
                          & (evidence.run.contacts.normal > TOUCH))
    states = []
    for row in last:
        one, two = int(a["contact_body"][row]), int(a["contact_other"][row])
        mu, static = (of(evidence.model.mechanism, one, two)
                      for of in (friction_of, static_friction_of))
        state = ("has several normals" if not sure[row] else "frictionless" if mu == 0
                 else "slips" if used[row] > 1 - SLIPS or abs(used[row] * static / mu - 1) < SLIPS
                 else f"sticks, {100 * (1 - used[row]):.0f} % from the limit")
        names = evidence.model.bodies.name
        states.append(f"{names[one]}/{names[two]} {state}")
    end = "at the end: " + "; ".join(states) if states else "nothing touches at the end"
    return judged(name, float(used[sure].max(initial=0.0)), "", 1 + CONE, source=source,
                  why=f"largest share of the friction limit in the whole run; {end}")


def _slack(evidence: Evidence) -> Figure:
    """Time for which tendons that have pulled hang slack again."""
    name, source = "tendon.slack", "T > 0"
    tendons, time = evidence.model.mechanism.tendons, evidence.run.time
    if not tendons or len(time) < 2:
        return missing(name, source=source,
                       why="there is no tendon" if not tendons else "there are too few samples")
    hangs = evidence.run.arrays["tendon_tension"] <= SLACK
    hangs &= held_of(evidence.model.ties.tendon, evidence.run.arrays["held"]).T
    once = np.maximum.accumulate(~hangs, axis=0)
    seconds = np.count_nonzero(hangs & once, axis=0) * float(time[1] - time[0])
    never = [t.name for t, pulled in zip(tendons, once[-1], strict=True) if not pulled]
    some = [f"{t.name} for {s:.3g} s" for t, s in zip(tendons, seconds, strict=True) if s > 0]
    slack = [*some, *(f"{each} never pulled" for each in never)]
    value = math.inf if never else float(seconds.max())
    return judged(name, value, "s", 0.0, source=source,
                  why=("cords that hung loose: " + "; ".join(slack[:4]) if slack
                       else "no cord hung loose once it had pulled"))
