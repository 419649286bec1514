"""The outcome of a run: how it ended, how it was computed, what happened.

The status follows from three entries of a run's files: whether it is complete, for which reason it
is not, and which event stopped it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import AliasChoices, Field, TypeAdapter, ValidationError

from sandbox.errors import ControllerFailed, Interrupted, RecordingFull
from sandbox.scene.settings import Run
from sandbox.values.units import size_fault
from sandbox.wording import quoted

INTERRUPTED, LIMITED = Interrupted.outcome, RecordingFull.outcome  # The reasons of such runs
FAILED = ControllerFailed.outcome.format("")  # Begins the reason of a run that its controller ended


class Status(Enum):
    """How a run ended; the value is the end of a sentence that begins with "the run"."""

    DONE = "completed"  # All planned steps were made
    STOPPED = "was stopped on purpose"
    """An event of the scene, or a controller in Python that raised ``StopRun``, ended it: the run
    is complete."""
    INTERRUPTED = "was interrupted"  # Ctrl-C
    DIVERGED = "diverged"
    """The motion ran away or was no longer a number; ``reason`` names the body."""
    LIMITED = "was stopped by a limit"  # More was recorded than allowed
    FAILED = "was ended by its controller"
    """A controller in Python raised an exception; ``reason`` names it."""
    UNFINISHED = "stopped"
    """Not at its end, without a reason: its recording was taken during the run."""


Finite = Annotated[float, Field(allow_inf_nan=False)]
Time = Annotated[Finite, Field(alias="time_s")]


@dataclass(frozen=True)
class Happened:
    """An event that happened, or an element that broke."""

    event: Annotated[str, Field(validation_alias=AliasChoices("event", "name"))]  # Its name
    time: Time
    """When [s]: of an event the end of the step after which it acted; of an element the instant
    within a step at which it reached its load."""


@dataclass(frozen=True)
class Stop:
    """The event that stopped a run."""

    event: str  # Its name; or that of the controller in Python that stopped the run
    verdict: Literal["pass", "fail"]
    time: Time  # When [s]
    because: str = ""  # Why, in the scene's words


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """How a run ended, how it was computed, what happened in it."""

    complete: bool = True  # Whether the run came to the end that its scene gives it
    reason: str = ""  # Why the run is not complete, in a sentence
    step: Finite  # Time step h [s]
    steps: int = 0  # Steps that were planned; 0 if unknown
    sample_rate: Finite  # Samples per second of simulated time [Hz], as kept
    seed: int = 0  # Of random numbers; the engine draws none
    versions: Mapping[str, str] = field(default_factory=dict)
    """Of sandbox, Python and the libraries that computed the run, by name."""
    wall: Annotated[Mapping[str, Finite], Field(alias="wall_s")] = field(default_factory=dict)
    """Time that each phase took [s], by name: ``build``, ``simulate``."""
    events: tuple[Happened, ...] = ()  # The events that happened, in order of time
    broke: tuple[Happened, ...] = ()  # The joints, springs and tendons that broke, in order of time
    stopped: Stop | None = None
    """The event that stopped the run; of several the one whose verdict counts."""
    controllers: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """Results of laws of controllers, by controller: plain JSON data."""
    contact_solver: Mapping[str, Finite] = field(default_factory=dict)
    """How contacts, limits and friction were solved; empty where unknown or there are none.
    ``residual``: the largest violation of their laws [m/s, rad/s]; ``time_s``: when;
    ``steps_above_1e-8``; ``relaxed_steps``. Where piles had compliant contacts also
    ``compliant_steps``, ``stiffness`` h^2 k G, ``damping`` ratio, ``tangential`` over normal
    stiffness."""
    notes: tuple[str, ...] = ()  # Such as meters without a value

    @property
    def status(self) -> Status:
        """How the run ended."""
        if self.complete:
            return Status.STOPPED if self.stopped else Status.DONE
        if not self.reason:
            return Status.UNFINISHED
        if self.reason.startswith(FAILED):
            return Status.FAILED
        return {INTERRUPTED: Status.INTERRUPTED, LIMITED: Status.LIMITED}.get(
            self.reason, Status.DIVERGED)

    @property
    def marked(self) -> list[Happened]:
        """Events and breaks, as figures and pages mark them, in order of time."""
        return sorted([*self.events, *(Happened(f"{one.event} broke", one.time)
                                       for one in self.broke)], key=lambda one: one.time)


def step_notes(made: int, *, relaxed: int, unordered: int, overlapping: int) -> tuple[str, ...]:
    """Notes on steps of those made that are approximate or were too long for the motion."""
    notes = {
        f"the forces of contacts, friction and motors are approximate in {relaxed} of {made} "
        "steps: sticking and sliding were not resolved": relaxed,
        f"{unordered} of {made} steps have more than 100 impacts in sequence; the rest was solved "
        "at one instant. Reduce `run.step` to have fewer impacts in each step": unordered,
        f"in {overlapping} of {made} steps bodies moved so fast that they overlapped, and may have "
        "passed through each other. Reduce `run.step`": overlapping}
    return tuple(note for note, steps in notes.items() if steps)


def planned(run: Run, *, complete: bool = True) -> Outcome:
    """The outcome of a run of which only its scene's settings are known."""
    return Outcome(complete=complete, step=run.step, sample_rate=run.sample_rate)


@cache
def _adapter() -> TypeAdapter[Outcome]:
    return TypeAdapter(Outcome)


def outcome_data(outcome: Outcome) -> dict[str, Any]:
    """An outcome as plain JSON data, SI, keys as in the files of a run."""
    data: dict[str, Any] = _adapter().dump_python(outcome, mode="json", by_alias=True)
    data["broke"] = [{"name": one.event, "time_s": one.time} for one in outcome.broke]
    return data


def read_outcome(data: Mapping[str, Any], run: Run) -> Outcome:
    """The outcome that plain JSON data describe; what they lack is as ``run`` has it."""
    given = outcome_data(planned(run, complete=False)) | dict(data)
    try:
        found = _adapter().validate_json(json.dumps(given), strict=True)
    except ValidationError as error:
        first = error.errors()[0]
        raise ValueError(f"{quoted('.'.join(map(str, first['loc'])))}: {first['msg']}") from None
    for key, size, dimension in (("step", found.step, "time"),
                                 ("sample_rate", found.sample_rate, "frequency")):
        if fault := size_fault(size, dimension):
            raise ValueError(f"its {key} is {fault}")
    return found
