"""The PID law, sampled, and its tuning by a relay.

Sources: K. J. Astrom and R. M. Murray, Feedback Systems (2nd ed., 2021), chapter 11;
K. J. Astrom and B. Wittenmark, Computer-Controlled Systems (3rd ed., 1997), section 8.5.

Relay tuning: K. J. Astrom and T. Hagglund, Automatica 20 (1984) 645-651. Rules: J. G. Ziegler and
N. B. Nichols, Trans. ASME 64 (1942) 759-768; B. D. Tyreus and W. L. Luyben, Ind. Eng. Chem. Res. 31
(1992) 2625-2628; without overshoot D. E. Seborg et al., Process Dynamics and Control.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Field

from sandbox.elements.controllers.controller import Law, ReadingController, Row
from sandbox.values.numbers import NOT_ZERO, Duration, Flag, Instant, Quantity
from sandbox.values.signals import Signal
from sandbox.values.spec import TYPE
from sandbox.wording import refuse_if


class Pid(Law):
    """u = bias + kp e + I - kd D, with e = target - reading, sampled with period h.

    - I: the integral of ki e over straight lines between acts, I += ki h (e + e_before) / 2.
    - D: the slope of the reading since the last act through 1 / (1 + filter s), exact for straight
      lines: D = a D_before + (1 - a) (reading - reading_before) / h with a = exp(-h / filter). It
      follows the reading and not the error, so a target that jumps gives no kick.
    - Anti-windup by the difference between the output and the applied value: ``clamp`` stops the
      integral while it would increase the difference; ``back_calculation`` moves it as
      dI/dt = (applied - wanted) / tracking, over a period h by 1 - exp(-h / tracking) of the
      difference, or all of it if kp is 0 and no tracking time is given.
    """

    def __init__(self, spec: PidController, period: float) -> None:
        self._given, self._bumpless, self._resumes = spec.bias, spec.bumpless, not spec.active
        self._kp, self._half_ki, self._kd = spec.kp, 0.5 * period * spec.ki, spec.kd
        self._keep = math.exp(-period / spec.filter) if spec.filter > 0 else 0.0
        self._weight = (1 - self._keep) / period
        self._clamp, self._back = spec.anti_windup == "clamp", 0.0
        if spec.anti_windup == "back_calculation" and spec.ki != 0:
            tracking = abs(spec.kp / spec.ki) if spec.tracking is None else spec.tracking
            self._back = -math.expm1(-period / tracking) if tracking > 0 else 1.0
        self._bias = self._integral = self._slope = 0.0
        self._before = self._error = self._wanted = 0.0
        self._fresh = True

    def begin(self, readings: Row, targets: Row, inputs: Row) -> None:
        """Set bias and integral; during a run an integral begins at the drive's value."""
        now = inputs[0]
        self._bias = now if self._given is None else self._given
        proportional = self._kp * (targets[0] - readings[0])
        if self._resumes and self._half_ki != 0:
            self._integral = now - self._bias - proportional
        else:
            self._integral = -proportional if self._bumpless else 0.0
        self._resumes = self._fresh = True

    def act(self, t: float, readings: Row, targets: Row, applied: Row) -> list[float]:
        reading = readings[0]
        error = targets[0] - reading
        if self._fresh:
            self._fresh = False
            self._slope = 0.0
        else:
            step = self._half_ki * (error + self._error)
            cut = self._wanted - applied[0]
            self._integral = self.integrated(self._integral, step, cut) if self._clamp else (
                self._integral + (step - self._back * cut))
            self._slope = self._keep * self._slope + self._weight * (reading - self._before)
        self._before = reading
        self._error = error
        self._wanted = wanted = (
            self._bias + self._kp * error + self._integral - self._kd * self._slope)
        return [wanted]


class PidController(ReadingController):
    """Brings a reading to its target by a drive: a PID controller.

    u = bias + kp e + ki ∫e dt - kd d(reading)/dt with e = target - reading.

    Gains may be negative, where more of the input makes the reading less.
    """

    LAW = Pid
    of_drive = ("bias",)
    type: Literal["pid"] = TYPE
    target: Signal
    """Target of the reading over time, in its unit; an event may set ``<name>.target``."""
    kp: Quantity = 0.0
    """Gain of the error [drive's unit per reading's unit]."""
    ki: Quantity = 0.0
    """Gain of the error's integral [drive's unit per reading's unit and second]."""
    kd: Quantity = 0.0
    """Gain of the reading's rate, against it [drive's unit times seconds per reading's unit]."""
    filter: Instant = 0.0
    """Time constant of the low-pass on the derivative [s]; 0 is none."""
    bias: Quantity | None = None
    """Added to the law, in the drive's unit; by default the drive's value at the beginning."""
    bumpless: Flag = False
    """Start with the integral that makes the first output equal the bias. A loop with an integral
    that is switched on during a run starts from the drive's current value in any case."""
    anti_windup: Literal["clamp", "back_calculation", "none"] = "clamp"
    """Integral during saturation: ``clamp`` stops it, ``back_calculation`` drives it back."""
    tracking: Duration | None = None
    """Time constant of the back-calculation [s]; by default |kp / ki|, and at once if kp is 0."""

    def _verify(self) -> None:
        refuse_if(self.tracking is not None and self.anti_windup != "back_calculation",
                  "'tracking' is for \"anti_windup\": \"back_calculation\"")


# kp / Ku, integral time / Tu, derivative time / Tu of each rule
RULES: dict[str, tuple[float, float, float]] = {
    "ziegler_nichols_pi": (0.45, 1 / 1.2, 0.0),
    "ziegler_nichols_pid": (0.6, 1 / 2, 1 / 8),
    "tyreus_luyben_pi": (1 / 3.2, 2.2, 0.0),
    "tyreus_luyben_pid": (1 / 2.2, 2.2, 1 / 6.3),
    "no_overshoot_pid": (0.2, 1 / 2, 1 / 3),
}
FILTER = 0.1  # low-pass on the derivative over the derivative time; 1/20 to 1/3 is usual


def gains_of(rule: str, gain: float, period: float) -> dict[str, Any]:
    """Fields of a :class:`PidController` by a rule, for the ultimate gain Ku and period Tu [s]."""
    proportional, integral, derivative = RULES[rule]
    kp = proportional * gain
    return {"kp": kp, "ki": kp / (integral * period), "kd": kp * derivative * period,
            "filter": FILTER * derivative * period}


class Relay(Law):
    """Switches its drive until the reading has oscillated often enough, then is a PID.

    A cycle lasts from one switch to bias + amplitude to the next. The first one is not measured; of
    the others the mean period is Tu and the mean half-height of the error is a. The half-height d
    is that of the applied input, within limits. The PID begins with the mean input of these cycles.
    """

    def __init__(self, spec: RelayController, period: float) -> None:
        self._spec, self._period = spec, period
        self._pid: Pid | None = None
        self._found: dict[str, Any] = {}
        self._began = self._up = False
        self._bias = 0.0
        self._starts: list[float] = []
        self._cycle = list[tuple[float, float]]()  # error and applied input of each act
        self._cycles = list[list[tuple[float, float]]]()

    def begin(self, readings: Row, targets: Row, inputs: Row) -> None:
        """Begin to oscillate; once tuned, continue as a PID from the drive's value."""
        if self._pid is not None:
            self._pid.begin(readings, targets, inputs)
            return
        self._began = True
        self._bias = inputs[0] if self._spec.bias is None else self._spec.bias
        self._up = targets[0] >= readings[0]
        self._starts, self._cycles, self._cycle = [], [], []

    def act(self, t: float, readings: Row, targets: Row, applied: Row) -> list[float]:
        if self._pid is not None:
            return self._pid.act(t, readings, targets, applied)
        error, hysteresis = targets[0] - readings[0], self._spec.hysteresis
        self._cycle.append((error, applied[0]))
        if self._up and error < -hysteresis:
            self._up = False
        elif not self._up and error > hysteresis:
            self._up = True
            if self._starts:  # a cycle is complete
                self._cycles.append(self._cycle)
            self._starts.append(t)
            self._cycle = []
            if len(self._cycles) == self._spec.cycles:
                self._pid = self._tuned(t)
                mean = [self._found["bias"]]
                self._pid.begin(readings, targets, mean)
                return self._pid.act(t, readings, targets, mean)
        side = self._spec.amplitude if self._up else -self._spec.amplitude
        return [self._bias + side]

    def _tuned(self, t: float) -> Pid:
        """The PID that the measured cycles give."""
        cycles = [tuple(zip(*cycle, strict=True)) for cycle in self._cycles[1:]]
        count = len(cycles)
        period = (self._starts[-1] - self._starts[1]) / count
        a = sum(max(errors) - min(errors) for errors, _ in cycles) / (2 * count)
        d = sum(max(inputs) - min(inputs) for _, inputs in cycles) / (2 * count)
        mean = sum(sum(inputs) for _, inputs in cycles) / sum(len(inputs) for _, inputs in cycles)
        # the describing function of the relay: Ku = 4 d / (pi sqrt(a^2 - hysteresis^2))
        hysteresis = self._spec.hysteresis
        gain = 4 * math.copysign(d, self._spec.amplitude) / (
            math.pi * math.sqrt((a - hysteresis) * (a + hysteresis)))
        gains = gains_of(self._spec.rule, gain, period)
        self._found = {
            "tuned": True, "tuned_at_s": t, "rule": self._spec.rule,
            "ultimate_gain": gain, "ultimate_period_s": period,
            "reading_amplitude": a, "input_amplitude": d, "bias": mean,
            **{key + "_s" * (key == "filter"): value for key, value in gains.items()}}
        return Pid(PidController.model_construct(**gains, bias=mean, bumpless=True), self._period)

    def report(self) -> dict[str, Any]:
        if self._found:
            return self._found
        why = "it was never switched on"
        if self._began:
            why = (f"the reading went round {len(self._cycles)} times of {self._spec.cycles}; a "
                   "longer run, a larger amplitude or a bias nearer to what the target needs may "
                   "help")
        return {"tuned": False, "why": why}


class RelayController(ReadingController):
    """A PID controller that first finds its gains by relay auto-tuning (Astrom, Hagglund 1984).

    It switches the drive between bias + amplitude and bias - amplitude until the reading has
    oscillated ``cycles`` times; amplitude and period of those after the first give the gains, which
    ``run.json`` has.
    """

    LAW = Relay
    of_drive = ("bias", "amplitude")
    of_reading = ("hysteresis",)
    type: Literal["relay"] = TYPE
    target: Signal
    """Target of the reading over time, in its unit; first the reading oscillates about it."""
    amplitude: Annotated[Quantity, NOT_ZERO]
    """Amplitude of the switching, in the drive's unit, not 0; negative if input lowers reading."""
    hysteresis: Annotated[Quantity, Field(ge=0)] = 0.0
    """How far the reading passes the target before the relay switches, in the reading's unit."""
    cycles: int = Field(default=4, ge=2, le=100)
    """Number of oscillations before the gains are computed; the first one is not measured."""
    rule: Literal["ziegler_nichols_pi", "ziegler_nichols_pid", "tyreus_luyben_pi",
                  "tyreus_luyben_pid", "no_overshoot_pid"] = "tyreus_luyben_pi"
    """Tuning rule that gives the gains from the ultimate gain and period."""
    bias: Quantity | None = None
    """Mean of the switching, in the drive's unit; by default the drive's value at the start."""
