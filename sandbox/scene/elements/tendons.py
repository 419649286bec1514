"""Tendons: cords routed through guides, with one tension along the whole path."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from sandbox.scene.elements.spec import Spec
from sandbox.scene.values.numbers import Damping, Distance, Length, Name, Point, Stiffness

RIGID = 1e5
"""Stiffness [N/m] that stands for a cord without stretch: 0.04 mm under the pull of a finger."""


class Guide(Spec):
    """A point, or a wheel, of a body that a tendon passes.

    At either end the tendon is tied there. A wheel (``radius``) between the
    ends lets it slide round without friction; a wheel at an end has it wound
    on: it pays out as the body turns, which is how equations (1)-(3) come in.
    """

    body: Name
    """Name of the body that it is on, and that it presses."""
    at: Point = (0.0, 0.0)
    """The eye, or the wheel's centre, in the body's frame [m]."""
    radius: Distance = 0.0
    """Radius of the wheel [m]; 0, the default, is a plain eye."""
    side: Literal["left", "right"] = "left"
    """On which side of the cord, walked from its first guide to its last, the wheel's centre lies:
    round a wheel on its ``left`` the cord bends counter-clockwise, round one on its ``right``
    clockwise. An end on the ``left`` is wound up by turning counter-clockwise at the last guide,
    clockwise at the first. Of no effect on an eye."""


class Tendon(Spec):
    """A cord through ``guides``; T = stiffness * stretch + damping * rate, never below 0.

    It is elastic, with the default stiffness as well: one that snaps taut gives
    the speed back. From 100 kN/m on only exp(-pi h w / 2) of it, so that what
    comes of the jerk depends on the step h until that is small against the
    period 2 pi / w, w^2 = stiffness / mass. Where a jerk is to be inelastic, a
    joint of type ``rope`` does it between two points; a cord through guides
    needs a ``damping`` of some times sqrt(stiffness * mass).
    """

    name: Name
    """Its name; quantities are ``<name>.tension``, ``<name>.length`` and so on."""
    guides: tuple[Guide, ...] = Field(min_length=2, max_length=64)
    """Where the cord runs, from end to end; a pull drive acts at the last one."""
    stiffness: Stiffness = Field(RIGID, gt=0)
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
    from the start has a ``rest_length`` shorter than its path, and no slack."""
