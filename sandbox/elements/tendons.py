"""Tendons: cords routed through guides, with one tension along the path where it slides freely."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Literal, Self

from pydantic import Field, model_validator

from sandbox.elements.element import OTHER_SIDE, BodyName, Element, Quantity, recorded
from sandbox.elements.springs import TakenUp
from sandbox.values.numbers import (
    NOT_NEGATIVE,
    POSITIVE,
    Damping,
    Distance,
    Flag,
    Force,
    Items,
    Length,
    Name,
    Point,
    Ratio,
    Stiffness,
)
from sandbox.values.spec import Spec
from sandbox.wording import WrongValueError

if TYPE_CHECKING:
    from sandbox.scene.mechanism import Mechanism

RIGID = 1e5
"""Stiffness [N/m] that stands for a cord without stretch: 0.04 mm under the pull of a finger."""

QUANTITIES: Mapping[str, Quantity] = {
    "length": recorded("tendon_length", "m",
                       "along its path, including the length wound up on wheels at its ends since "
                       "t = 0",
                       live=True),
    "shortening": Quantity(
        "m", "path length at t = 0 minus the current one, between the wheels at its ends: positive "
             "if wound up", live=True),
    "tension": recorded("tendon_tension", "N", "along the whole path, never below 0; with friction "
                                               "at guides, of the last span", live=True),
    "work": recorded("tendon_work", "J", "done on the bodies since t = 0"),
}
NUMBERED: Mapping[str, Quantity] = {
    "tension": Quantity("N", "`tension_0` and so on: tension of each span, in order",
                        live=True),
    "slip": Quantity("m", "`slip_1` and so on: length that has slid over that guide since t = 0, "
                          "towards the last guide; guides count from 0", live=True),
    "lifted": Quantity("1", "`lifted_1` and so on: 1 while the tendon is off that guide's wheel, "
                            "else 0; guides count from 0", live=True,
                       yes_no=True),
}
"""What tendons have besides, with a number each: where guides hold them by friction the tensions of
their pieces and what slid over such a guide; ``lifted`` of each wheel that one can lift off."""


class Guide(Spec):
    """A point, or a wheel, of a body that a tendon passes.

    At either end the tendon is tied there. A guide between the ends lets it slide
    through, without friction unless it has some; a wheel (``radius``) at an end has it
    wound on: it pays out as the body turns, which is how equations (1)-(3) come in.
    A wheel between the ends without friction and whole turns holds nothing back: the
    cord lifts off it where it would have to, goes straight past, and is taken up again.
    """

    body: BodyName
    """Name of the body that it is on, and that it presses."""
    at: Point = (0.0, 0.0)
    """The eye, or the wheel's centre, in the body's frame [m]."""
    radius: Distance = 0.0
    """Radius of the wheel [m]; 0, the default, is a plain eye."""
    side: Annotated[Literal["left", "right"], OTHER_SIDE] = "left"
    """On which side of the cord, walked from its first guide to its last, the wheel's centre lies:
    round a wheel on its ``left`` the cord bends counter-clockwise, round one on its ``right``
    clockwise. An end on the ``left`` is wound up by turning counter-clockwise at the last guide,
    clockwise at the first. Of no effect on an eye."""
    turns: int = Field(default=0, ge=0, le=1000)
    """Whole turns that the cord goes round the wheel at t = 0, besides the arc that its ends make:
    of a capstan. Of no effect on an eye, or where the cord is tied."""
    begins: Literal["on", "off"] | None = None
    """Whether the cord lies on the wheel at t = 0 or goes straight past it: ``on`` though the
    straight way is clear of it, so that the cord goes round it and crosses itself, or ``off``, to
    meet it later. By default it is off where the straight way past the wheel is clear of it, with
    its centre on the ``side`` that it should be; a loop is on. Of no effect where a cord cannot
    lift off: an eye, a wheel with ``friction`` or ``turns``, the first guide of a loop, or where
    it is tied."""
    friction: Ratio = 0.0
    """Coefficient of friction between cord and guide: by the angle φ that the cord bends there its
    tension may grow up to e^(friction φ) times before it slides (Euler, Eytelwein). On a wheel
    that turns this is its grip. Of no effect where the cord is tied."""


class Tendon(Element):
    """A cord through ``guides``, which pulls and never pushes.

    T = stiffness * stretch + damping * rate, never below 0.

    It is elastic, with the default stiffness as well: one that snaps taut gives
    the speed back. From 100 kN/m on only exp(-pi h w / 2) of it, so that what
    comes of the jolt depends on the step h until that is small against the
    period 2 pi / w, w^2 = stiffness / mass. Where a jolt is to be inelastic, a
    joint of type ``rope`` does it between two points; a cord through guides
    needs a ``damping`` of some times sqrt(stiffness * mass).
    """

    RECORDED = QUANTITIES

    name: Name
    """Its name; quantities are ``<name>.tension``, ``<name>.length`` and so on."""
    guides: Items[Guide] = Field(min_length=2, max_length=64)
    """Where the cord runs, from end to end; a pull drive acts at the last one."""
    closed: Flag = False
    """True: a loop, such as a belt. From the last guide it runs on to the first, and it is tied
    nowhere."""
    stiffness: Stiffness = Field(default=RIGID, gt=0)
    """Tension per stretch of the whole cord [N/m]; from 100 kN/m on, the default, the cord stands
    for one without stretch and is solved at the end of the step."""
    damping: Damping = 0.0
    """Tension per rate of stretch [N s/m]; from 100 kN/m on the step damps the cord as well, as
    step * stiffness would."""
    rest_length: Length | None = None
    """Length of the cord where it just does not pull [m]; by default that of its path at t = 0.
    ``slack`` comes on top."""
    slack: Distance = 0.0
    """Added to the rest length [m], 0 or more: by so much the path has to grow from what it is at
    t = 0, unless ``rest_length`` says otherwise, before the cord pulls. A cord that shall pull
    from the start has a ``rest_length`` shorter than its path, or a ``pretension``, and no
    slack."""
    pretension: Annotated[Force, NOT_NEGATIVE] | None = None
    """Tension along the whole cord at t = 0 [N], in place of ``rest_length`` and ``slack``."""
    breaks_at: Annotated[Force, POSITIVE] | None = None
    """The tension above which it is let go [N], anywhere along it, for good unless an event takes
    it up again; by default it never breaks."""
    released: Flag = False
    """Whether it is let go from the start, until an event takes it up."""
    taken_up: TakenUp = "natural"
    """With which length at rest an event takes it up again: ``natural`` is the one that it has had,
    so that it may pull at once; ``as_is`` that of its path then, so that it begins without
    tension."""

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.pretension is not None and (self.rest_length is not None or self.slack):
            raise WrongValueError("conflicting-keys", "a cord has a pretension, or a rest_length "
                                  "and slack, not both")
        if self.closed and len(self.guides) == 2 and not any(g.radius for g in self.guides):
            raise WrongValueError("bad-tendon-path", "a loop of two guides encloses nothing: give "
                                  "one a radius")
        return self

    @property
    def path(self) -> tuple[Guide, ...]:
        """The guides as the cord passes them: of a loop the first one comes last again."""
        return (*self.guides, self.guides[0]) if self.closed else self.guides

    @property
    def gripping(self) -> tuple[int, ...]:
        """Which guides hold the cord by friction; a loop that one alone holds, none does."""
        inner = range(0 if self.closed else 1, len(self.guides) - (0 if self.closed else 1))
        found = tuple(k for k in inner if self.guides[k].friction > 0.0)
        return () if self.closed and len(found) == 1 else found

    @property
    def lifting(self) -> tuple[int, ...]:
        """Which wheels the cord can lift off; of a loop not its first guide."""
        inner = range(1, len(self.guides) - (0 if self.closed else 1))
        return tuple(k for k in inner if self.guides[k].radius > 0.0 and not self.guides[k].turns
                     and k not in self.gripping)

    def quantities(self, mechanism: Mechanism) -> dict[str, str]:
        """The quantities that it records, with their units."""
        found = super().quantities(mechanism)
        if self.gripping:
            found |= {f"tension_{k}": NUMBERED["tension"].unit for k in range(len(self.path) - 1)}
            found |= {f"slip_{k}": NUMBERED["slip"].unit for k in self.gripping}
        return found | {f"lifted_{k}": NUMBERED["lifted"].unit for k in self.lifting}

    def needed(self, quantity: str) -> str:
        """The field that it needs to record a quantity; empty where no field adds it."""
        word, _, text = quantity.rpartition("_")
        if word not in NUMBERED or not text.isdecimal():
            return ""
        at = int(text)
        if not (0 if word == "tension" else 1) <= at < len(self.path) - 1:
            return ""
        return {"tension": "'friction' at one of its guides",
                "slip": f"'friction' at its guide {at}, between its ends",
                "lifted": f"a 'radius' of its guide {at}, between its ends, and neither "
                          "'friction' nor 'turns' there"}[word]
