"""The PID law, sampled: derivative of the reading, low-pass on it, anti-windup, bumpless start.

Sources: K. J. Astrom and R. M. Murray, Feedback Systems (2nd ed., 2021), chapter 11;
K. J. Astrom and B. Wittenmark, Computer-Controlled Systems (3rd ed., 1997), section 8.5.

Relay auto-tuning makes the loop swing, and computes gains from period and amplitude.

Sources: K. J. Astrom and T. Hagglund, "Automatic tuning of simple regulators with
specifications on phase and amplitude margins", Automatica 20 (1984) 645-651.
Rules: J. G. Ziegler and N. B. Nichols, Trans. ASME 64 (1942) 759-768; B. D. Tyreus
and W. L. Luyben, Ind. Eng. Chem. Res. 31 (1992) 2625-2628; the rule without overshoot
as in D. E. Seborg, T. F. Edgar and D. A. Mellichamp, Process Dynamics and Control.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, field_validator, model_validator

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
    filter: float = 0.0  # Time constant of the low-pass on the derivative [s]; 0 is none
    anti_windup: Literal["clamp", "back_calculation", "none"] = "clamp"
    tracking: float | None = None  # Time constant of the back-calculation [s]; None is |kp / ki|

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


RULES: dict[str, tuple[float, float, float]] = {
    "ziegler_nichols_pi": (0.45, 1 / 1.2, 0.0),
    "ziegler_nichols_pid": (0.6, 1 / 2, 1 / 8),
    "tyreus_luyben_pi": (1 / 3.2, 2.2, 0.0),
    "tyreus_luyben_pid": (1 / 2.2, 2.2, 1 / 6.3),
    "no_overshoot_pid": (0.2, 1 / 2, 1 / 3),
}  # kp / Ku, integral time / Tu, derivative time / Tu of each rule
FILTER = 0.1
"""Low-pass on the derivative, as a fraction of the derivative time; 1/20 to 1/3 is usual."""


class RelayController(ReadingController):
    """A PID controller that first finds its gains itself, by switching its drive to and fro.

    That is relay auto-tuning (Astrom and Hagglund 1984).
    The drive is switched between bias + amplitude and bias - amplitude until the
    reading has gone round ``cycles`` times; amplitude and period of those after
    the first give the gains. What was found stands in ``run.json``.
    """

    of_drive = ("bias", "amplitude")
    of_reading = ("hysteresis",)

    type: Literal["relay"] = TYPE
    target: Signal
    """What the reading shall swing about, and then be, in the reading's unit."""
    amplitude: Quantity
    """Amplitude of the switching, in the drive's unit; not 0; negative if more input lowers the
    reading."""
    hysteresis: Annotated[Quantity, Field(ge=0)] = 0.0
    """How far the reading passes the target before the relay switches, in the reading's unit."""
    cycles: int = Field(default=4, ge=2, le=100)
    """Number of oscillations before the gains are computed; the first one is not measured."""
    rule: Literal["ziegler_nichols_pi", "ziegler_nichols_pid", "tyreus_luyben_pi",
                  "tyreus_luyben_pid", "no_overshoot_pid"] = "tyreus_luyben_pi"
    """Tuning rule that gives the gains from the ultimate gain and period, and whether the law has a
    derivative."""
    bias: Quantity | None = None
    """Mean of the switching, in the drive's unit; by default the drive's value when the controller
    starts."""

    @field_validator("amplitude")
    @classmethod
    def _switches(cls, amplitude: float) -> float:
        if amplitude == 0:
            raise WrongValueError("out-of-range", "must not be 0: the relay would not switch")
        return amplitude

    def make_law(self, mechanism: Mechanism, period: float) -> Law:
        """Its law, which acts every ``period`` [s]."""
        return Relay(self, period)


def ultimate_gain(relay: float, amplitude: float, hysteresis: float) -> float:
    """Ku = 4 d / (pi sqrt(a^2 - eps^2)), from the describing function of the relay.

    Args:
        relay: d, half of the height of what the relay switched; its sign is the gain's.
        amplitude: a, half of the height of the reading's swing; more than ``hysteresis``.
        hysteresis: eps, how far beyond the target the relay switches.
    """
    return 4 * relay / (math.pi * math.sqrt((amplitude - hysteresis) * (amplitude + hysteresis)))


def gains_of(rule: str, gain: float, period: float) -> Gains:
    """The gains that a rule gives for the ultimate gain Ku and period Tu [s]."""
    proportional, integral, derivative = RULES[rule]
    kp = proportional * gain
    return Gains(kp, kp / (integral * period), kp * derivative * period,
                 filter=FILTER * derivative * period)


@dataclass
class _Swing:
    """One cycle: error and input at their extremes, sum of the input."""

    acts: int = 0
    high: float = -math.inf
    low: float = math.inf
    high_input: float = -math.inf
    low_input: float = math.inf
    sum_input: float = 0.0

    def see(self, error: float, given: float) -> None:
        """Take one act in."""
        self.acts += 1
        self.sum_input += given
        self.high, self.low = max(self.high, error), min(self.low, error)
        self.high_input = max(self.high_input, given)
        self.low_input = min(self.low_input, given)


class Relay(Law):
    """Switches its drive until the reading has gone round often enough, then is a PID.

    A cycle lasts from one switch to bias + amplitude to the next. The first one is
    not measured; of the others the mean period is Tu and the mean half-height of the
    error is a. The half-height d of the input is that of what was applied, so limits
    that cut the relay do no harm. The PID begins with the mean input of the measured
    cycles, which is what held the reading around its target.
    """

    def __init__(self, spec: RelayController, period: float) -> None:
        self._given, self._amplitude = spec.bias, spec.amplitude
        self._hysteresis, self._cycles, self._rule = spec.hysteresis, spec.cycles, spec.rule
        self._period = period
        self._pid: Pid | None = None
        self._found: dict[str, Any] = {}
        self._began = self._up = False
        self._bias = 0.0
        self._starts: list[float] = []
        self._swing, self._swings = _Swing(), list[_Swing]()

    def begin(self, readings: Row, targets: Row, inputs: Row) -> None:
        """Begin to swing; once tuned, go on as a PID from what the drive has."""
        if self._pid is not None:
            self._pid.begin(readings, targets, inputs)
            return
        self._began = True
        self._bias = inputs[0] if self._given is None else self._given
        self._up = targets[0] >= readings[0]
        self._starts, self._swings, self._swing = [], [], _Swing()

    def act(self, t: float, readings: Row, targets: Row, applied: Row) -> list[float]:
        """The relay's side, or the PID's output once there is one."""
        if self._pid is not None:
            return self._pid.act(t, readings, targets, applied)
        error = targets[0] - readings[0]
        self._swing.see(error, applied[0])
        if self._up and error < -self._hysteresis:
            self._up = False
        elif not self._up and error > self._hysteresis:
            self._up = True
            if self._starts:  # a cycle is complete
                self._swings.append(self._swing)
            self._starts.append(t)
            self._swing = _Swing()
            if len(self._swings) == self._cycles:
                pid, mean = self._tuned(t)
                pid.begin(readings, targets, [mean])
                self._pid = pid
                return pid.act(t, readings, targets, [mean])
        return [self._bias + self._amplitude if self._up else self._bias - self._amplitude]

    def _tuned(self, t: float) -> tuple[Pid, float]:
        """The PID that the measured cycles give, and the input that it begins with."""
        swings = self._swings[1:]
        period = (self._starts[-1] - self._starts[1]) / len(swings)
        amplitude = sum(s.high - s.low for s in swings) / (2 * len(swings))
        relay = math.copysign(
            sum(s.high_input - s.low_input for s in swings) / (2 * len(swings)), self._amplitude)
        mean = sum(s.sum_input for s in swings) / sum(s.acts for s in swings)
        gain = ultimate_gain(relay, amplitude, self._hysteresis)
        gains = gains_of(self._rule, gain, period)
        self._found = {
            "tuned": True, "tuned_at_s": t, "rule": self._rule,
            "ultimate_gain": gain, "ultimate_period_s": period,
            "reading_amplitude": amplitude, "input_amplitude": abs(relay), "bias": mean,
            "kp": gains.kp, "ki": gains.ki, "kd": gains.kd, "filter_s": gains.filter,
        }
        return Pid(gains, self._period, bias=mean, bumpless=True), mean

    def report(self) -> dict[str, Any]:
        """What was found, or why nothing was."""
        if self._found:
            return self._found
        why = "it was never switched on"
        if self._began:
            why = (f"the reading went round {len(self._swings)} times of {self._cycles}; a longer "
                   "run, a larger amplitude or a bias nearer to what the target needs may help")
        return {"tuned": False, "why": why}
