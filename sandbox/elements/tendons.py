"""Tendons routed through guides, with one tension along the path where they slide freely."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from sandbox.elements.element import OTHER_SIDE, BodyName, Element, Quantity, computed, live
from sandbox.elements.springs import TakenUp
from sandbox.values import numbers as of
from sandbox.values.spec import Spec
from sandbox.wording import refuse_if

if TYPE_CHECKING:
    from sandbox.engine.pymunk_draft import PymunkDraft
    from sandbox.scene.mechanism import Mechanism

RIGID = 1e5  # stiffness [N/m] from which a tendon counts as inextensible

QUANTITIES: Mapping[str, Quantity] = {
    "length": live("tendon_length", "m", "along its path, wound up length since t = 0 included"),
    "shortening": computed("m", "path length at t = 0 minus the current one, between the wheels at "
                                "its ends: positive if wound up", live=True),
    "tension": live("tendon_tension", "N", "along the path; with guide friction of its last span"),
    "work": Quantity("tendon_work", "J", "done on the bodies since t = 0"),
}
# additional quantities of tendons with a number each: of spans, guides with friction, wheels
NUMBERED: Mapping[str, Quantity] = {
    "tension": computed("N", "`tension_0` and so on: tension of each span, in order", live=True),
    "slip": computed("m", "`slip_1` and so on: length that has slid over that guide since t = 0, "
                          "towards the last guide; guides count from 0", live=True),
    "lifted": computed("1", "`lifted_1` and so on: 1 while the tendon is off that guide's wheel",
                       live=True, yes_no=True),
}


class Guide(Spec):
    """A point or a wheel on a body that a tendon passes.

    At its ends a tendon is fixed to its guide; a wheel (``radius``) there winds it up as the body
    turns, as in equations (1)-(3). Between the ends it slides, without friction by default. It
    lifts off a wheel without friction and whole turns, and lands on it again.
    """

    body: BodyName
    """Name of the body that carries it."""
    at: of.Point = (0.0, 0.0)
    """The point, or the wheel's centre, in the body's frame [m]."""
    radius: of.Distance = 0.0
    """Radius of the wheel [m]; 0, the default, is a point."""
    side: Annotated[Literal["left", "right"], OTHER_SIDE] = "left"
    """Side of the wheel's centre, seen along the tendon: around a wheel on its ``left`` it bends
    counter-clockwise. An end on the ``left`` is wound up by counter-clockwise rotation at the last
    guide, clockwise at the first. Without effect on a point."""
    turns: int = Field(default=0, ge=0, le=1000)
    """Additional whole turns around the wheel at t = 0; without effect on a point, at the ends."""
    begins: Literal["on", "off"] | None = None
    """Whether the tendon lies ``on`` the wheel at t = 0 or passes it straight, ``off``. By default
    it is off if the straight path clears the wheel with its centre on ``side``; a loop is on.
    Without effect on points, wheels with ``friction`` or ``turns``, a loop's first guide, ends."""
    friction: of.Ratio = 0.0
    """Coefficient of friction between tendon and guide: over a wrap angle φ the tension may grow by
    up to e^(friction φ) before the tendon slides (Euler, Eytelwein). Without effect at the ends."""


class Tendon(Element):
    """A tendon through ``guides``, which pulls and never pushes.

    T = stiffness * stretch + damping * rate, never below 0. It is elastic, also with the default
    stiffness: a tendon that snaps taut rebounds. From 100 kN/m on only exp(-pi h w / 2) of the
    rebound remains, so it depends on the step h unless h is small against the period 2 pi / w, w^2
    = stiffness / mass. For an inelastic jolt use a joint of type ``rope`` between two points, or a
    ``damping`` of several times sqrt(stiffness * mass).
    """

    RECORDED = QUANTITIES
    name: of.Name
    """Its name; quantities are ``<name>.tension``, ``<name>.length`` and so on."""
    guides: of.Items[Guide] = Field(min_length=2, max_length=64)
    """Path of the tendon from end to end; a pull drive acts at the last guide."""
    closed: of.Flag = False
    """True: a loop, such as a belt, from the last guide on to the first, without ends."""
    stiffness: of.Stiffness = Field(default=RIGID, gt=0)
    """Tension per stretch of the whole tendon [N/m]; from 100 kN/m, the default, inextensible."""
    damping: of.Damping = 0.0
    """Tension per rate of stretch [N s/m]; from 100 kN/m on, plus step * stiffness."""
    rest_length: of.Length | None = None
    """Rest length [m]; by default that of its path at t = 0. ``slack`` is added."""
    slack: of.Distance = 0.0
    """Added to the rest length [m]: the path grows by this before the tendon pulls."""
    pretension: Annotated[of.Force, of.NOT_NEGATIVE] | None = None
    """Tension along the whole tendon at t = 0 [N], in place of ``rest_length`` and ``slack``."""
    breaks_at: Annotated[of.Force, of.POSITIVE] | None = None
    """Tension above which it breaks [N], until an event engages it again; never by default."""
    released: of.Flag = False
    """Whether it starts released, until an event engages it."""
    taken_up: TakenUp = "natural"
    """Rest length once engaged again: ``natural``, as before, or ``as_is``, without tension."""

    def _verify(self) -> None:
        refuse_if(self.pretension is not None and (self.rest_length is not None or self.slack),
                  "a tendon has a pretension, or a rest_length and slack, not both")
        refuse_if(self.closed and len(self.guides) == 2 and not any(g.radius for g in self.guides),
                  "a loop of two guides encloses nothing: give one a radius", "bad-tendon-path")

    @property
    def path(self) -> tuple[Guide, ...]:
        """The guides as the tendon passes them: of a loop the first one comes last again."""
        return (*self.guides, self.guides[0]) if self.closed else self.guides

    @property
    def gripping(self) -> tuple[int, ...]:
        """Which guides hold the tendon by friction; a loop that one alone holds, none does."""
        inner = range(0 if self.closed else 1, len(self.guides) - (0 if self.closed else 1))
        found = tuple(k for k in inner if self.guides[k].friction > 0.0)
        return () if self.closed and len(found) == 1 else found

    @property
    def lifting(self) -> tuple[int, ...]:
        """Which wheels the tendon can lift off; of a loop not its first guide."""
        inner = range(1, len(self.guides) - (0 if self.closed else 1))
        return tuple(k for k in inner if self.guides[k].radius > 0.0 and not self.guides[k].turns
                     and k not in self.gripping)

    def quantities(self, mechanism: Mechanism) -> dict[str, str]:
        found = super().quantities(mechanism)
        if self.gripping:
            found |= {f"tension_{k}": NUMBERED["tension"].unit for k in range(len(self.path) - 1)}
            found |= {f"slip_{k}": NUMBERED["slip"].unit for k in self.gripping}
        return found | {f"lifted_{k}": NUMBERED["lifted"].unit for k in self.lifting}

    def without_pymunk(self, mechanism: Mechanism) -> str:
        if self.closed:
            return "a closed tendon (belt)"
        if self.gripping:
            return "a tendon with guide friction"
        return "a tendon that is off a wheel at t = 0" \
            if any(self.guides[k].begins == "off" for k in self.lifting) else ""

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """Forces on its guides, set before each step; a SlideJoint alternates in trees."""
        path = draft.model.tendons.guides(index)
        law = {"stiffness": self.stiffness, "damping": self.damping, "rest": self.rest_length,
               "slack": self.slack - (self.pretension or 0.0) / self.stiffness}
        draft.add("tendon", self.name, *(
            (guide.body, guide.at, radius) for guide, radius in zip(
                self.guides, draft.model.tendons.guide_radius[path], strict=True)),
            **{key: value for key, value in law.items() if value})

    def needed(self, quantity: str) -> str:
        word, _, at = quantity.rpartition("_")
        needs = {"tension": "'friction' at one of its guides",
                 "slip": f"'friction' at its guide {at}, between its ends",
                 "lifted": f"a 'radius' of its guide {at}, between its ends, and neither "
                           "'friction' nor 'turns' there"}
        numbers = map(str, range(word != "tension", len(self.path) - 1))
        return needs.get(word, "") if at in numbers else ""
