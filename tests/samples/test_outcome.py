"""A run's status, and that it is worked out from what every archive says."""

import json
from dataclasses import replace

import pytest

from sandbox.samples.outcome import (
    Happened,
    Outcome,
    Status,
    Stop,
    outcome_data,
    planned,
    read_outcome,
    status_of,
)
from sandbox.scene.elements.settings import Run

RUN = Run(duration=0.1, step=1e-3, sample_rate=500.0)
STOP = Stop("far", "pass", 0.05)


@pytest.mark.parametrize(("status", "reason", "stopped", "complete"), [
    (Status.DONE, "", None, True),
    (Status.STOPPED, "", STOP, True),
    (Status.INTERRUPTED, "interrupted", None, False),
    (Status.INTERRUPTED, "interrupted", STOP, False),
    (Status.DIVERGED, "the simulation diverged at t = 1 s: wild", None, False),
    (Status.UNFINISHED, "", None, False),
])
def test_a_status_is_what_the_files_say(status, reason, stopped, complete):
    assert status.complete is complete
    assert status_of(complete=complete, reason=reason, stopped=stopped) is status
    outcome = replace(planned(RUN), status=status, reason=reason, stopped=stopped)
    assert outcome.complete is complete
    again = read_outcome(json.loads(json.dumps(outcome_data(outcome))), RUN)
    assert again == outcome


@pytest.mark.parametrize(("status", "reason", "stopped"), [
    (Status.DONE, "", STOP), (Status.STOPPED, "", None), (Status.INTERRUPTED, "", None),
    (Status.DIVERGED, "interrupted", None), (Status.UNFINISHED, "it broke", None),
])
def test_a_status_that_an_archive_would_not_give_back_is_refused(status, reason, stopped):
    with pytest.raises(ValueError, match=status.name):
        replace(planned(RUN), status=status, reason=reason, stopped=stopped)


def test_every_field_goes_there_and_back():
    outcome = Outcome(
        status=Status.STOPPED, step=2e-3, steps=50, sample_rate=250.0, seed=3,
        versions={"python": "3"}, wall={"build": 0.5}, events=(Happened("far", 0.05),),
        broke=(Happened("rod", 0.0425),), stopped=Stop("far", "fail", 0.05, "too far"),
        controllers={"c": {"tuned": False}}, notes=("one", "two"))
    assert read_outcome(outcome_data(outcome), RUN) == outcome
    assert outcome != planned(RUN)
    assert outcome.marked == [Happened("rod broke", 0.0425), Happened("far", 0.05)]
    assert set(outcome_data(outcome)) == set(outcome_data(planned(RUN)))
