"""The audit: a recording checked against the paper's equations and the laws of mechanics.

Everything follows from the recording alone, not from the solver. Every check has a threshold that
follows from the time step and the solver (docs/audit.md), and a verdict: ``pass``, ``look``, or
``not computed`` with the reason.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from sandbox.audit import bounds, contacts, driven, energy, geometry, laws, outlines, rest
from sandbox.audit.evidence import Check, Evidence, Figure
from sandbox.samples.samples import Samples

__all__ = ["ADVICE", "CHECKS", "Figure", "advice_on", "audit"]

CHECKS: Mapping[str, Check] = {  # in the order of the docs
    each.name: each
    for module in (geometry, laws, driven, energy, rest, outlines, contacts, bounds)
    for each in vars(module).values() if isinstance(each, Check)}


def audit(run: Samples) -> list[Figure]:
    """All figures of a recording, in the order of the docs."""
    if not len(run):
        return [each.missing("nothing was recorded") for each in CHECKS.values()]
    with np.errstate(all="ignore"):
        evidence = Evidence(run)
        return [each.figure(evidence) for each in CHECKS.values()]


class Advice(NamedTuple):
    """Meaning and remedy of a warning."""

    figures: tuple[str, ...]  # Names of the checks; empty: all checks that no other advice names
    means: str
    do: str


ADVICE: tuple[Advice, ...] = (
    Advice(("contact.shared",),
           "nothing is wrong: with friction, or with more contacts than hinges, several sets of "
           "contact forces balance the same grasp, and the run shows one of them",
           "quote tensions and sums of forces; of a single contact force quote its range from "
           "`sandbox bounds RUN`"),
    Advice(("reaction.shared",),
           "nothing is wrong: the mechanism has redundant joints, so rigid-body statics does not "
           "determine each reaction; the run shows the smallest reactions",
           "remove the redundant joint, or replace it by a stiff spring"),
    Advice(("tendon.slack",),
           "a tendon was slack after it had pulled, or it never pulled",
           "plot its tension; to keep it taut, reduce its slack or increase the load against it"),
    Advice(("energy.start",),
           "a motor starts at another speed than its hinge: an impact within one step, whose "
           "forces grow as the step shrinks",
           "start from the speed of the hinge: from rest, `=20 * (1 - exp(-50 * t))`"),
    Advice(("rest.moments", "rest.contacts"),
           "the mechanism still moves a little, so the forces are not yet those of rest",
           "increase `run.duration` and check whether the value falls"),
    Advice(("skin.depth",),
           "a soft skin is deeper than it is thick: a real one would be much stiffer there",
           "use a stiffer or thicker skin, or less force"),
    Advice(("energy.created", "energy.lost", "poses", "joint.drift", "tendon.shortening",
            "spring.length", "differential", "stop.overrun", "stop.law"),
           "the step is too long for this speed or for these mass ratios",
           "halve `run.step` and run again: if the value falls, the step was too long; "
           "`sandbox converge` finds a suitable step"),
    Advice(("contact.friction", "contact.residual", "contact.slides", "contact.closes",
            "contact.bounces", "impact.swallowed", "contact.bounds", "contact.place",
            "joint.friction", "drive.motor", "drive.place", "tendon.grip"),
           "in some step no forces satisfied all conditions, for example in a jam; the forces of "
           "that step are approximate",
           "find the element; halve `run.step`; remove the jam"),
    Advice((),
           "the recording does not match its scene: it was changed, an older version wrote it, or "
           "sandbox has a bug",
           "run the scene again; if the warning stays, report it with the scene"),
)  # The last one is for all other checks
PYMUNK = Advice(  # its errors exceed most thresholds
    (), "pymunk solves joints, tendons and contacts approximately; the value is its error",
    "use the direct solver for exact values, or more `run.pymunk.iterations` and `substeps`")


def advice_on(figure: str, solver: str = "direct") -> Advice:
    """Return the advice on a warning of a check in a run with a solver."""
    if solver == "pymunk":
        return PYMUNK
    return next(each for each in ADVICE if not each.figures or figure in each.figures)
