"""Controllers: what reads quantities of the running mechanism and sets its drives.

A controller acts at a rate of its own. When it acts after step k it reads what
a recording of every step has of step k, and what it writes holds from step k + 1 until
it acts again; its first act is before the first step. The value of a drive
that a controller writes is where that drive begins.

What is common to all laws, limits and rate limits, is applied outside of them;
a law is given what was in force, so that it does not wind up.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, ValidationInfo, field_validator, model_validator

from sandbox.elements.element import Element
from sandbox.values.numbers import (
    POSITIVE,
    Angle,
    Duration,
    Flag,
    Frequency,
    Instant,
    Items,
    Length,
    Name,
    Pair,
    Point,
    Quantity,
    checked_expression,
    parameters_of,
)
from sandbox.values.signals import AngleSignal, AnySignal, Signal
from sandbox.values.spec import TYPE, Spec
from sandbox.wording import WrongValueError

RATE = 1000.0
"""How often a controller acts by default [Hz]; the nearest whole number of steps is used."""

Range = Pair[Quantity]
Positive = Annotated[Quantity, POSITIVE]
Matrix = Items[Items[Quantity]]


def bound(text: str, info: ValidationInfo) -> str:
    """An expression of quantities with the scene's parameters put in; a plain name stays."""
    expression = checked_expression(text, info).bind(parameters_of(info))
    return f"={expression.text}" if text.lstrip().startswith("=") else text.strip()


def _ordered(limits: Range | None) -> None:
    if limits is not None and limits[0] >= limits[1]:
        raise WrongValueError("out-of-range", f"limits are [lowest, highest], and {limits[0]:g} is "
                              f"not below {limits[1]:g}")


class _Controller(Element):
    name: Name
    """Its name, by which events set ``<name>.target`` and ``<name>.active``."""
    rate: Frequency | None = None
    """How often it acts [Hz]; by default 1 kHz or the nearest rate that the step divides."""
    active: Flag = True
    """Whether it acts from the start; an event may switch it by setting ``<name>.active``."""


class _Single(_Controller):
    """A controller of one drive."""

    writes: Name
    """Name of the drive that it sets."""
    limits: Range | None = None
    """[lowest, highest] that it sets, in the drive's unit; none by default."""
    slew: Positive | None = None
    """Largest change a second, either way, in the drive's unit; none by default."""

    @field_validator("limits")
    @classmethod
    def _limits_ordered(cls, limits: Range | None) -> Range | None:
        _ordered(limits)
        return limits


class _Reader(_Single):
    """A controller of one drive by one reading."""

    reads: str
    """A quantity (``finger.mcp.angle``) or an expression (``"=a.angle - b.angle"``)."""

    @field_validator("reads")
    @classmethod
    def _bind_reads(cls, text: str, info: ValidationInfo) -> str:
        return bound(text, info)


class PidController(_Reader):
    """Brings a reading to its target by a drive: a PID controller.

    u = bias + kp e + ki ∫e dt - kd d(reading)/dt with e = target - reading.

    Gains may be negative, where more of the input makes the reading less.
    """

    type: Literal["pid"] = TYPE
    target: Signal
    """What the reading shall be over time, in the reading's unit; an event may set
    ``<name>.target``."""
    kp: Quantity = 0.0
    """Gain of the error [drive's unit per reading's unit]."""
    ki: Quantity = 0.0
    """Gain of the error's integral [drive's unit per reading's unit and second]."""
    kd: Quantity = 0.0
    """Gain of the reading's rate, against it [drive's unit times seconds per reading's unit]."""
    filter: Instant = 0.0
    """Time constant of the low-pass on the derivative [s]; 0 is none."""
    bias: Quantity | None = None
    """What is added to the law, in the drive's unit; by default the drive's value when the
    controller begins."""
    bumpless: Flag = False
    """Begin with the integral at which the first output is the bias. Switched on in the middle
    of a run, a loop with an integral goes on from what the drive has, in any case."""
    anti_windup: Literal["clamp", "back_calculation", "none"] = "clamp"
    """What becomes of the integral while the output is cut: ``clamp`` holds it while it would lead
    further beyond what can be set, ``back_calculation`` leads it back, ``none`` lets it run on."""
    tracking: Duration | None = None
    """Time constant of the back-calculation [s]; by default |kp / ki|, and at once if kp is 0."""

    @model_validator(mode="after")
    def _tracking_is_used(self) -> Self:
        if self.tracking is not None and self.anti_windup != "back_calculation":
            raise WrongValueError("conflicting-keys", "'tracking' is for \"anti_windup\": "
                                  "\"back_calculation\"")
        return self


class ScheduleController(_Single):
    """Sets a drive to a value over time, at its own rate and within limits."""

    type: Literal["schedule"] = TYPE
    value: Signal
    """What the drive is set to over time, in its unit."""


class FeedbackController(_Single):
    """Sets a drive to an expression of quantities and of the time ``t``."""

    type: Literal["feedback"] = TYPE
    value: str
    """What the drive is set to, in its unit: an expression of quantities, of parameters and of the
    time ``t`` [s], such as ``"=0.2 * cos(axle.angle)"``."""

    @field_validator("value")
    @classmethod
    def _bind_value(cls, text: str, info: ValidationInfo) -> str:
        return bound(text, info)


class SwitchController(_Reader):
    """On/off with hysteresis: one value once the reading fell below, another once it rose above.

    In between the drive keeps what it has; at the start of a run that is ``value_below``.
    """

    type: Literal["switch"] = TYPE
    below: Quantity
    """The reading under which ``value_below`` is set, in the reading's unit."""
    above: Quantity
    """The reading over which ``value_above`` is set, in the reading's unit; more than ``below``."""
    value_below: Quantity
    """What the drive is set to once the reading is less than ``below``, in the drive's unit."""
    value_above: Quantity
    """What the drive is set to once the reading is more than ``above``, in the drive's unit."""

    @model_validator(mode="after")
    def _thresholds(self) -> Self:
        if self.below >= self.above:
            raise WrongValueError("out-of-range", "'below' must be less than 'above'")
        return self


class RelayController(_Reader):
    """A PID controller that first finds its gains itself, by switching its drive to and fro.

    That is relay auto-tuning (Astrom and Hagglund 1984).
    The drive is switched between bias + amplitude and bias - amplitude until the
    reading has gone round ``cycles`` times; amplitude and period of those after
    the first give the gains. What was found stands in ``run.json``.
    """

    type: Literal["relay"] = TYPE
    target: Signal
    """What the reading shall swing about, and then be, in the reading's unit."""
    amplitude: Quantity
    """Half the height of what is switched, in the drive's unit; not 0, and negative where more of
    the input makes the reading less."""
    hysteresis: Annotated[Quantity, Field(ge=0)] = 0.0
    """How far the reading passes the target before the relay switches, in the reading's unit."""
    cycles: int = Field(default=4, ge=2, le=100)
    """How often the reading goes round before gains are worked out; the first time is not
    measured."""
    rule: Literal["ziegler_nichols_pi", "ziegler_nichols_pid", "tyreus_luyben_pi",
                  "tyreus_luyben_pid", "no_overshoot_pid"] = "tyreus_luyben_pi"
    """Which rule gives the gains for the ultimate gain and period that were found, and whether the
    law has a derivative."""
    bias: Quantity | None = None
    """Middle of what is switched, in the drive's unit; by default the drive's value when the
    controller begins."""

    @field_validator("amplitude")
    @classmethod
    def _switches(cls, amplitude: float) -> float:
        if amplitude == 0:
            raise WrongValueError("out-of-range", "must not be 0: the relay would not switch")
        return amplitude


class _Several(_Controller):
    """A controller of several drives."""

    writes: Items[Name] = Field(min_length=1, max_length=32)
    """Names of the drives that it sets."""
    limits: Items[Range] | None = None
    """[lowest, highest] of each drive, in its unit; none by default."""
    slew: Items[Positive] | None = None
    """Largest change a second of each drive, either way, in its unit; none by default."""

    @field_validator("limits")
    @classmethod
    def _each_ordered(cls, limits: tuple[Range, ...] | None) -> tuple[Range, ...] | None:
        for pair in limits or ():
            _ordered(pair)
        return limits

    @model_validator(mode="after")
    def _one_each(self) -> Self:
        for key in ("limits", "slew"):
            given = getattr(self, key)
            if given is not None and len(given) != len(self.writes):
                raise WrongValueError("wrong-type", f"'{key}': expected {len(self.writes)} "
                                      f"entries, one a drive, got {len(given)}")
        return self


class StateFeedbackController(_Several):
    """Brings several readings to their targets at once, by a gain for each.

    u = bias + gains (targets - readings) + integral_gains ∫(targets - readings) dt.

    The gains come from a design such as a linear-quadratic one.
    """

    type: Literal["state_feedback"] = TYPE
    reads: Items[str] = Field(min_length=1, max_length=64)
    """Quantities, or expressions of them, in the order of the columns of ``gains``."""
    targets: Items[Signal]
    """What each reading shall be over time, in the reading's unit."""
    gains: Matrix
    """A row for each drive, a column for each reading [drive's unit per reading's unit]."""
    integral_gains: Matrix | None = None
    """Gains of the errors' integrals, in the shape of ``gains``; none by default. Where a row's
    drive is at its limit, that row's integral is held."""
    bias: Items[Quantity] | None = None
    """What is added for each drive, in its unit; by default the drives' values when the controller
    begins."""

    @field_validator("reads")
    @classmethod
    def _bind_each(cls, texts: tuple[str, ...], info: ValidationInfo) -> tuple[str, ...]:
        return tuple(bound(text, info) for text in texts)

    @model_validator(mode="after")
    def _shapes(self) -> Self:
        rows, columns = len(self.writes), len(self.reads)
        wrong = [key for key in ("gains", "integral_gains")
                 if (given := getattr(self, key)) is not None
                 and (len(given) != rows or any(len(row) != columns for row in given))]
        if wrong:
            raise WrongValueError("wrong-type", f"'{wrong[0]}': expected {rows} rows (drives) and "
                                  f"{columns} columns")
        if len(self.targets) != columns:
            raise WrongValueError("wrong-type", f"'targets': expected {columns} entries, one a "
                                  "reading")
        if self.bias is not None and len(self.bias) != rows:
            raise WrongValueError("wrong-type", f"'bias': expected {rows} entries, one a drive")
        return self


class FingerGeometry(Spec):
    """A finger's tendon and springs as the paper's section 4 gives them; slack at rotation 0."""

    lengths: Items[Length] = Field(min_length=1, max_length=32)
    """Lengths of the phalanges, the proximal one first [m]."""
    guides: Items[Point]
    """V_0 in the palm's frame from the first hinge, V_1 ... V_n in their phalanges' frames [m]."""
    on_previous: Annotated[Items[Point], Field(alias="from")]
    """M'' of each spring, on the body before the hinge, from the hinge [m]."""
    on_phalanx: Annotated[Items[Point], Field(alias="to")]
    """M' of each spring, in the frame of the body after the hinge [m]."""

    @model_validator(mode="after")
    def _counts(self) -> Self:
        n = len(self.lengths)
        for key, given, wanted in (("guides", self.guides, n + 1), ("from", self.on_previous, n),
                                   ("to", self.on_phalanx, n)):
            if len(given) != wanted:
                raise WrongValueError("wrong-type", f"'{key}': a finger of {n} phalanges has "
                                      f"{wanted}, got {len(given)}")
        return self


class EquilibriumController(_Several):
    """Holds the joints of a pulled finger by the stiffness of its springs, from T h = k dlm hm.

    k = T h / (dlm hm) at the targets, and what is left, torque = kp (rotation - reference)
    + kd rate + ki ∫(rotation - reference) dt, as stiffness torque / (dlm hm) at the present
    rotations. h is the tendon's arm, dlm the spring's elongation and hm its arm.
    """

    type: Literal["equilibrium"] = TYPE
    tendon: Name
    """Name of the tendon that turns the joints."""
    joints: Items[Name] = Field(min_length=1, max_length=32)
    """Names of the hinges; ``writes`` are the stiffness drives of the springs across them, in this
    order."""
    targets: Items[AngleSignal]
    """Of the joints' rotations over time [rad], each in its hinge's sense."""
    pull: Positive | None = None
    """T that is reckoned with [N]; by default the tension that the tendon has."""
    kp: Items[Quantity]
    """Torque per error of rotation, one for each joint [N m/rad]."""
    ki: Items[Quantity] | None = None
    """Torque per integral of the error, one for each joint [N m/(rad s)]; none by default. The
    integral begins once ``rise`` is over."""
    kd: Items[Quantity] | None = None
    """Torque per rate of rotation, one for each joint [N m s/rad]; none by default."""
    rise: Instant = 0.0
    """Time in which the reference goes from where the joints are to the targets [s]."""
    guard: Annotated[Angle, Field(gt=0)] = math.radians(2.0)
    """dlm hm, 0 in the straight finger, counts as no less than it is at this rotation [rad]."""
    geometry: FingerGeometry | None = None
    """What the law takes the finger for; by default what it is."""

    @model_validator(mode="after")
    def _per_joint(self) -> Self:
        n = len(self.writes)
        counts = {key: len(given) for key in ("joints", "targets", "kp", "ki", "kd")
                  if (given := getattr(self, key)) is not None}
        if self.geometry is not None:
            counts["geometry"] = len(self.geometry.lengths)
        for key, got in counts.items():
            if got != n:
                raise WrongValueError("wrong-type", f"'{key}': expected {n} entries, one a drive, "
                                      f"got {got}")
        return self


Controller = Annotated[
    PidController | ScheduleController | FeedbackController | SwitchController | RelayController
    | StateFeedbackController | EquilibriumController,
    Field(discriminator="type"),
]


def every(rate: float | None, step: float) -> int:
    """Steps of ``step`` [s] between two acts at ``rate`` [Hz]; None is near :data:`RATE`."""
    return max(1, round(1 / ((rate or RATE) * step)))


def writes_of(controller: Controller) -> tuple[str, ...]:
    """The drives that a controller sets."""
    writes = controller.writes
    return (writes,) if isinstance(writes, str) else writes


def readings_of(controller: Controller) -> tuple[str, ...]:
    """What a controller reads: names of quantities, or expressions of them that begin with ``=``.

    An expression law reads the result of its expression.
    """
    match controller:
        case FeedbackController():
            return (controller.value,)
        case ScheduleController():
            return ()
        case StateFeedbackController():
            return controller.reads
        case EquilibriumController():
            motion = [f"{joint}.{kind}" for kind in ("angle", "rate")
                      for joint in controller.joints]
            tension = [f"{controller.tendon}.tension"] if controller.pull is None else []
            return (*motion, *tension)
        case PidController() | SwitchController() | RelayController():
            return (controller.reads,)


def targets_of(controller: Controller) -> tuple[AnySignal, ...]:
    """What a controller leads its readings to, over time; a schedule's target is its value."""
    match controller:
        case ScheduleController():
            return (controller.value,)
        case PidController() | RelayController():
            return (controller.target,)
        case StateFeedbackController() | EquilibriumController():
            return controller.targets
        case FeedbackController() | SwitchController():
            return ()
