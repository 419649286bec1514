"""The PID law, sampled: derivative of the reading, low-pass on it, anti-windup, bumpless start.

Sources: K. J. Astrom and R. M. Murray, Feedback Systems (2nd ed., 2021), chapter 11;
K. J. Astrom and B. Wittenmark, Computer-Controlled Systems (3rd ed., 1997), section 8.5.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Self

from pydantic import model_validator

from sandbox.elements.controllers.controller import Law, ReadingController, Row
from sandbox.values.numbers import Duration, Flag, Instant, Quantity
from sandbox.values.signals import Signal
from sandbox.values.spec import TYPE
from sandbox.wording import WrongValueError

if TYPE_CHECKING:
    from sandbox.scene.mechanism import Mechanism


class PidController(ReadingController):
    """Brings a reading to its target by a drive: a PID controller.

    u = bias + kp e + ki ∫e dt - kd d(reading)/dt with e = target - reading.

    Gains may be negative, where more of the input makes the reading less.
    """

    of_drive = ("bias",)

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
    """Start with the integral that makes the first output equal the bias. A loop with an integral
    that is switched on during a run starts from the drive's current value in any case."""
    anti_windup: Literal["clamp", "back_calculation", "none"] = "clamp"
    """Integral while the output is saturated: ``clamp`` stops it, ``back_calculation`` drives it
    back, ``none`` continues."""
    tracking: Duration | None = None
    """Time constant of the back-calculation [s]; by default |kp / ki|, and at once if kp is 0."""

    @model_validator(mode="after")
    def _tracking_is_used(self) -> Self:
        if self.tracking is not None and self.anti_windup != "back_calculation":
            raise WrongValueError("conflicting-keys", "'tracking' is for \"anti_windup\": "
                                  "\"back_calculation\"")
        return self

    def make_law(self, mechanism: Mechanism, period: float) -> Law:
        """Its law, which acts every ``period`` [s]."""
        gains = Gains(self.kp, self.ki, self.kd, filter=self.filter, anti_windup=self.anti_windup,
                      tracking=self.tracking)
        return Pid(gains, period, bias=self.bias, bumpless=self.bumpless, resumes=not self.active)


@dataclass(frozen=True)
class Gains:
    """A PID's numbers; see :class:`PidController`."""

    kp: float = 0.0
    ki: float = 0.0
    kd: float = 0.0
    filter: float = 0.0
    """Time constant of the low-pass on the derivative [s]; 0 is none."""
    anti_windup: Literal["clamp", "back_calculation", "none"] = "clamp"
    tracking: float | None = None
    """Time constant of the back-calculation [s]; None is |kp / ki|."""

    def fraction_back(self, period: float) -> float:
        """How much of what was cut off comes off the integral at the next act, 0 to 1.

        The integral is led back as dI/dt = (applied - wanted) / tracking, which
        over a period h takes off exactly 1 - exp(-h / tracking). With kp = 0 and
        no tracking time given that is all of it: such a loop has no other
        memory that could be disturbed. Without ki nothing winds up.
        """
        if self.anti_windup != "back_calculation" or self.ki == 0:
            return 0.0
        tracking = abs(self.kp / self.ki) if self.tracking is None else self.tracking
        return -math.expm1(-period / tracking) if tracking > 0 else 1.0


class Pid(Law):
    """u = bias + kp e + I - kd D, with e = target - reading, sampled with period h.

    - I: the integral of ki e over straight lines between acts,
      I += ki h (e + e_before) / 2.
    - D: the slope of the reading since the last act through 1 / (1 + filter s), exactly for
      straight lines: D = a D_before + (1 - a) (reading - reading_before) / h with
      a = exp(-h / filter). It follows the reading and not the error, so a target that
      jumps gives no kick.
    - Anti-windup looks at what was cut off the last output, by limits or by the rate limit.
      ``clamp`` leaves the integral as it is while it would lead further out;
      ``back_calculation`` leads it back (:meth:`Gains.fraction_back`).
    """

    def __init__(
        self, gains: Gains, period: float, *, bias: float | None = None, bumpless: bool = False,
        resumes: bool = False,
    ) -> None:
        """A law that acts every ``period`` [s].

        Args:
            gains: its numbers.
            period: h [s].
            bias: in the drive's unit; None takes what the drive has at the beginning.
            bumpless: begin so that the first output is the bias.
            resumes: begin so that the first output is what the drive has. So it is at
                every later beginning.
        """
        self._given, self._bumpless, self._resumes = bias, bumpless, resumes
        self._kp, self._half_ki, self._kd = gains.kp, 0.5 * period * gains.ki, gains.kd
        self._keep = math.exp(-period / gains.filter) if gains.filter > 0 else 0.0
        self._weight = (1 - self._keep) / period
        self._clamp = gains.anti_windup == "clamp"
        self._back = gains.fraction_back(period)
        self._bias = self._integral = self._slope = 0.0
        self._before = self._error = self._wanted = 0.0
        self._fresh = True

    @property
    def integral(self) -> float:
        """The integral part I, in the drive's unit."""
        return self._integral

    def begin(self, readings: Row, targets: Row, inputs: Row) -> None:
        """Set bias and integral.

        Of a loop that begins in the middle of a run, the integral takes up the
        difference to what the drive has. A loop without integral action keeps
        to its bias: it could never get rid of the difference.
        """
        now = inputs[0]
        self._bias = now if self._given is None else self._given
        proportional = self._kp * (targets[0] - readings[0])
        if self._resumes and self._half_ki != 0:
            self._integral = now - self._bias - proportional
        else:
            self._integral = -proportional if self._bumpless else 0.0
        self._resumes = self._fresh = True

    def act(self, t: float, readings: Row, targets: Row, applied: Row) -> list[float]:
        """The output; see the class."""
        reading = readings[0]
        error = targets[0] - reading
        if self._fresh:
            self._fresh = False
            self._slope = 0.0
        else:
            step = self._half_ki * (error + self._error)
            cut = self._wanted - applied[0]
            if cut and self._clamp:
                if step * cut < 0:
                    self._integral += step
            else:
                self._integral += step - self._back * cut
            self._slope = self._keep * self._slope + self._weight * (reading - self._before)
        self._before = reading
        self._error = error
        self._wanted = wanted = (
            self._bias + self._kp * error + self._integral - self._kd * self._slope)
        return [wanted]
