"""What each figure of the audit asks, what a look means and what to do about it.

The terminal and docs/audit.md show these words.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

ASKS: Mapping[str, str] = {
    "poses": "are the links where their hinge angles put them?",
    "tendon.path": "is each cord as long as the way along its guides?",
    "tendon.lift": "does a cord leave a wheel just where it would have to stick to it?",
    "tendon.shortening": "do cords over hinges shorten as the hinge angles say?",
    "spring.length": "is a spring as long as its ends are apart?",
    "joint.drift": "do joints hold their two sides together?",
    "stop.overrun": "does every hinge stay within its stops?",
    "differential": "does each rocker or pulley go the mean way, by its arms, of its strings?",
    "clock": "were samples taken at the times that the sample rate says?",
    "scene.numbers": "are masses and lengths those of the scene?",
    "schedule": "are fixed bodies, and those led along a path, where the scene puts them?",
    "velocity": "are velocities the rates at which poses change?",
    "hinge": "is a hinge's angle that between its two bodies?",
    "spring.law": "is a spring's force stiffness times stretch, plus damping?",
    "tendon.law": "is a cord's tension what its drive or its stretch gives, never below 0?",
    "spring.torque": "is a rotary spring's torque what its angle gives?",
    "damper.law": "is a hinge damper's torque its damping times the hinge's rate?",
    "load.law": "is each load, such as drag, what its law gives at that place and speed?",
    "tendon.grip": "is the larger tension at a guide at most e^(mu phi) times the smaller?",
    "tendon.spans": "is each piece of a cord that rubs as tight as it is stretched?",
    "joint.friction": "is friction in joints at most mu N, and against the motion?",
    "line.volume": "is the volume of each line of fluid that of its chambers?",
    "line.flow": "does each line of fluid hold just what flowed into it?",
    "line.law": "does a line's pressure fit what is in it?",
    "valve.law": "does the pressure across a valve fit its flow?",
    "line.energy": "does what pumps give arrive in bodies, fluid and valves?",
    "release.force": "does what was let go, or broke, carry nothing any more?",
    "release.load": "does nothing carry more than it breaks at?",
    "drive.signal": "do drives have the values that the scene gives them?",
    "drive.motor": "do motors and brakes keep their speed, or give all they may?",
    "stop.law": "do stops push only where a hinge is at its limit?",
    "work": "is the work of each element its force times the way it went?",
    "drive.place": "do servos push with what their law says?",
    "reaction.size": "is the size of each hinge force that of its x and y parts?",
    "reaction.shared": "does balance alone fix what each joint carries?",
    "momentum.force": "is F = m a for every body?",
    "momentum.moment": "is M = I alpha for every body?",
    "energy.start": "do motors start without a jolt that loses energy?",
    "energy.created": "is there no more energy than was put in?",
    "energy.lost": "is energy lost only to friction, dampers and impacts?",
    "rest.moments": "at rest, do the moments about every hinge balance?",
    "rest.contacts": "at rest, do contact forces balance the tendon's pull?",
    "contact.shared": "does balance alone fix every contact force?",
    "contact.place": "are contacts on the outlines of both bodies?",
    "contact.friction": "is friction at contacts at most mu N?",
    "contact.slides": "is friction at contacts mu N against the sliding, where they slide?",
    "contact.closes": "do contacts push only where bodies touch, and wherever they overlap?",
    "contact.bounces": "do impacts give back the speed that restitution says?",
    "impact.swallowed": "do impacts take no more energy than restitution says?",
    "tendon.slack": "do cords that have pulled stay taut?",
    "contact.bounds": "is each contact force in the range that balance and friction leave?",
}
"""By the figure's name, in the order of the audit; a yes is a pass."""


@dataclass(frozen=True)
class Advice:
    """What to think of a figure that asks for a look."""

    figures: tuple[str, ...]
    """Whose look it is; empty: of all that no other advice names."""
    means: str
    do: str


ADVICE: tuple[Advice, ...] = (
    Advice(("contact.shared",),
           "nothing is wrong: with friction, or more contacts than hinges, several sets of contact "
           "forces hold the same grasp, and the run shows one of them",
           "quote tensions and sums of forces; of a single contact force quote its range, which "
           "`sandbox bounds RUN` tells"),
    Advice(("reaction.shared",),
           "nothing is wrong: joints hold what fewer could hold, so how they share the load hangs "
           "on how much each gives, which rigid bodies do not say; the run shows the smallest "
           "forces that will do",
           "take out the joint that is one too many, or put a stiff spring in its place"),
    Advice(("tendon.slack",),
           "a cord that had pulled hung loose for a while, or a cord never pulled at all: what it "
           "is to move did not follow it",
           "plot its tension; if it is to stay taut, give it less slack, or more that pulls "
           "against it"),
    Advice(("energy.start",),
           "a motor starts at a speed that its hinge does not have: a blow within one step, whose "
           "forces are the larger, the shorter the step",
           "let its speed begin with the hinge's, as `=20 * (1 - exp(-50 * t))` does from rest"),
    Advice(("rest.moments", "rest.contacts"),
           "what counts as rest still moves a little, so the forces are not yet those of rest",
           "let it run longer (`run.duration`) and see whether the value falls"),
    Advice(("energy.created", "energy.lost", "poses", "joint.drift", "tendon.shortening",
            "spring.length", "differential", "stop.overrun", "stop.law"),
           "the step is too long for motion as fast, or masses as unlike, as these",
           "halve `run.step` and run again: if the value falls, it was the step; "
           "`sandbox converge` says which step will do"),
    Advice(("contact.friction", "contact.slides", "contact.closes", "contact.bounces",
            "impact.swallowed", "contact.bounds", "contact.place", "joint.friction", "drive.motor",
            "drive.place", "tendon.grip"),
           "in some step no set of forces met all conditions, as where a body is driven into a "
           "jam, and those of that step are approximate",
           "see which element it is; halve `run.step`; give what jams a way out"),
    Advice((),
           "the recording does not agree with itself or with its scene: it was changed, is of an "
           "older version, or sandbox has a fault",
           "run the scene again; if it stays, report it with the scene"),
)
"""The last is for all other figures."""


def advice_on(figure: str) -> Advice:
    """What to think of a look of a figure."""
    return next(each for each in ADVICE if not each.figures or figure in each.figures)
