"""Relay auto-tuning: the loop is made to swing, and gains follow from how it does.

K. J. Astrom and T. Hagglund, "Automatic tuning of simple regulators with
specifications on phase and amplitude margins", Automatica 20 (1984) 645-651.
Rules: J. G. Ziegler and N. B. Nichols, Trans. ASME 64 (1942) 759-768; B. D. Tyreus
and W. L. Luyben, Ind. Eng. Chem. Res. 31 (1992) 2625-2628; the rule without overshoot
as in D. E. Seborg, T. F. Edgar and D. A. Mellichamp, Process Dynamics and Control.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, field_validator

from sandbox.elements.controllers.controller import Law, ReadingController, Row
from sandbox.elements.controllers.pid import Gains, Pid
from sandbox.values.numbers import Quantity
from sandbox.values.signals import Signal
from sandbox.values.spec import TYPE
from sandbox.wording import WrongValueError

if TYPE_CHECKING:
    from sandbox.scene.mechanism import Mechanism

RULES: dict[str, tuple[float, float, float]] = {
    "ziegler_nichols_pi": (0.45, 1 / 1.2, 0.0),
    "ziegler_nichols_pid": (0.6, 1 / 2, 1 / 8),
    "tyreus_luyben_pi": (1 / 3.2, 2.2, 0.0),
    "tyreus_luyben_pid": (1 / 2.2, 2.2, 1 / 6.3),
    "no_overshoot_pid": (0.2, 1 / 2, 1 / 3),
}
"""kp / Ku, integral time / Tu, derivative time / Tu of each rule."""
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
