"""Questions that the checks answer, and the meaning and remedy of each warning.

The terminal and docs/audit.md show these texts.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

ASKS: Mapping[str, str] = {
    "poses": "are the links where their hinge angles put them?",
    "tendon.path": "is each tendon as long as its path along the guides?",
    "tendon.lift": "does a tendon leave a wheel exactly where it would have to stick to it?",
    "tendon.shortening": "does the tendon shortening match the hinge angles?",
    "spring.length": "is each spring as long as the distance between its ends?",
    "joint.drift": "do joints hold their two sides together?",
    "stop.overrun": "does every hinge stay within its stops?",
    "differential": "does each rocker or pulley move by the weighted mean of its strings?",
    "clock": "do the sample times match the sample rate?",
    "scene.numbers": "are masses and lengths those of the scene?",
    "schedule": "do fixed and scheduled bodies follow the scene?",
    "velocity": "are velocities the time derivatives of poses?",
    "hinge": "is each hinge angle the angle between its two bodies?",
    "spring.law": "is each spring force stiffness times stretch, plus damping?",
    "tendon.law": "does each tendon tension follow from its drive or its stretch, never below 0?",
    "spring.torque": "does each rotary spring's torque follow from its angle?",
    "damper.law": "is each hinge damper's torque its damping times the hinge's rate?",
    "load.law": "does each load, such as drag, follow its law?",
    "tendon.grip": "is the larger tension at a guide at most e^(mu phi) times the smaller?",
    "tendon.spans": "does the tension of each span of a tendon with friction match its stretch?",
    "joint.friction": "is joint friction at most mu N and opposed to the motion?",
    "line.volume": "is the volume of each fluid line the sum of its chambers?",
    "line.flow": "does the fluid in each line equal the net inflow?",
    "line.law": "does each line's pressure match its content?",
    "valve.law": "does the pressure drop of each valve match its flow?",
    "line.energy": "does the work of pumps go to bodies, fluid and valves?",
    "release.force": "do released and broken elements carry no load?",
    "release.load": "does no element carry more than its breaking load?",
    "drive.signal": "do drives have the values of the scene?",
    "drive.motor": "do motors and brakes keep their speed, or act at their limit?",
    "stop.law": "do stops act only at the hinge limits?",
    "work": "is the work of each element the integral of its power?",
    "drive.place": "does each servo effort follow its law?",
    "reaction.size": "is each reaction the magnitude of its x and y components?",
    "reaction.shared": "does statics determine every joint reaction?",
    "momentum.force": "is F = m a for every body?",
    "momentum.moment": "is M = I alpha for every body?",
    "energy.start": "do motors start without a jolt that loses energy?",
    "energy.created": "is there no more energy than was supplied?",
    "energy.lost": "is energy lost only to friction, dampers and impacts?",
    "rest.moments": "at rest, do the moments about every hinge balance?",
    "rest.contacts": "at rest, do contact forces balance the tendon tension?",
    "contact.shared": "does statics determine every contact force?",
    "contact.place": "are contacts on the outlines of both bodies?",
    "contact.friction": "is contact friction at most mu N?",
    "contact.slides": "is contact friction mu N against the sliding?",
    "contact.closes": "do contacts push exactly where bodies touch?",
    "contact.bounces": "do impacts rebound with the coefficient of restitution?",
    "impact.swallowed": "do impacts lose no more energy than restitution allows?",
    "contact.residual": "were contacts, limits and friction solved in every step?",
    "tendon.slack": "do tendons stay taut once they have pulled?",
    "contact.bounds": "is each contact force within the range that balance and friction allow?",
}
"""Questions by the name of the check, in the order of the audit; yes means pass."""


@dataclass(frozen=True)
class Advice:
    """Meaning and remedy of a warning."""

    figures: tuple[str, ...]
    """Names of the checks; empty: all checks that no other advice names."""
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
    Advice(("energy.created", "energy.lost", "poses", "joint.drift", "tendon.shortening",
            "spring.length", "differential", "stop.overrun", "stop.law"),
           "the step is too long for this speed or for these mass ratios",
           "halve `run.step` and run again: if the value falls, the step was too long; "
           "`sandbox converge` finds a suitable step"),
    Advice(("contact.friction", "contact.residual", "contact.slides", "contact.closes",
            "contact.bounces", "impact.swallowed", "contact.bounds", "contact.place",
            "joint.friction", "drive.motor",
            "drive.place", "tendon.grip"),
           "in some step no forces satisfied all conditions, for example in a jam; the forces of "
           "that step are approximate",
           "find the element; halve `run.step`; remove the jam"),
    Advice((),
           "the recording does not match its scene: it was changed, an older version wrote it, or "
           "sandbox has a bug",
           "run the scene again; if the warning stays, report it with the scene"),
)
"""The last one is for all other checks."""


def advice_on(figure: str) -> Advice:
    """Return the advice on a warning of a check."""
    return next(each for each in ADVICE if not each.figures or figure in each.figures)
