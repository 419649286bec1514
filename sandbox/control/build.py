"""From what a scene says of a controller to the law that acts."""

from __future__ import annotations

from sandbox.control.equilibrium import Equilibrium, joint_model
from sandbox.control.feedback import Feedback
from sandbox.control.law import Law
from sandbox.control.pid import Gains, Pid
from sandbox.control.relay import Relay
from sandbox.control.schedule import Schedule
from sandbox.control.state_feedback import StateFeedback
from sandbox.control.switch import Switch
from sandbox.elements.controllers import (
    Controller,
    EquilibriumController,
    FeedbackController,
    PidController,
    RelayController,
    ScheduleController,
    StateFeedbackController,
    SwitchController,
)
from sandbox.scene.crossings import Fingers
from sandbox.scene.mechanism import Mechanism


def build(spec: Controller, mechanism: Mechanism, period: float) -> Law:
    """The law of a controller of ``mechanism`` that acts every ``period`` [s]."""
    match spec:
        case PidController():
            return _pid(spec, period)
        case ScheduleController():
            return Schedule()
        case FeedbackController():
            return Feedback()
        case SwitchController():
            return Switch(spec)
        case RelayController():
            return Relay(spec, period)
        case StateFeedbackController():
            return StateFeedback(spec, period)
        case EquilibriumController():
            return Equilibrium(spec, joint_model(spec, Fingers(mechanism)), period)


def _pid(spec: PidController, period: float) -> Pid:
    gains = Gains(spec.kp, spec.ki, spec.kd, filter=spec.filter, anti_windup=spec.anti_windup,
                  tracking=spec.tracking)
    return Pid(gains, period, bias=spec.bias, bumpless=spec.bumpless, resumes=not spec.active)
