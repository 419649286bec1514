"""Scenes and recordings that are changed at random are refused or work; nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.fuzz import trial
from tests.fuzz.trial import attempt

pytestmark = pytest.mark.nightly
GROUP = 20


@pytest.mark.parametrize(("recording", "group"), [
    *((False, group) for group in range(12)), *((True, group) for group in range(3))])
def test_no_input_is_a_fault(recording: bool, group: int) -> None:
    """Time is left to the command: beside other tests an input may take longer."""
    outcomes = [attempt(seed, recording=recording)
                for seed in range(group * GROUP, (group + 1) * GROUP)]
    assert [each for each in outcomes if each.fault and "took" not in each.fault] == []
    assert {each.stage for each in outcomes} & {"done", "simulate", "load"}


def test_a_fault_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(path: Path) -> None:
        raise ZeroDivisionError("of all things")

    monkeypatch.setattr(trial, "read_scene", broken)
    assert attempt(0).fault.startswith("ZeroDivisionError: of all things (")
