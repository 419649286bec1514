"""A short share of the fuzzer's inputs, and that it would notice what is wrong."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

import sandbox
from tests.fuzz import __main__ as command
from tests.fuzz import recordings, trial
from tests.fuzz.inputs import make
from tests.fuzz.trial import attempt

SHARE = 12
"""Groups of inputs in the suite, and how many are in each."""
GROUP = 20
RECORDINGS, FEW = 5, 10
"""The same of recordings."""


@pytest.mark.parametrize("group", range(SHARE))
def test_no_input_is_a_fault(group: int) -> None:
    """Time is left to the command: beside other tests an input may take longer."""
    outcomes = [attempt(seed) for seed in range(group * GROUP, (group + 1) * GROUP)]
    assert [each for each in outcomes if each.fault and "took" not in each.fault] == []
    assert {each.stage for each in outcomes} & {"done", "simulate"}


def test_an_input_is_made_again_from_its_seed(capfdbinary: pytest.CaptureFixture[bytes]) -> None:
    files = [make(seed) for seed in range(50)]
    assert files == [make(seed) for seed in range(50)]
    assert len(set(files)) > 40
    assert command.main(["--show", "7"]) == 0
    assert capfdbinary.readouterr().out == files[7]


def test_what_is_wrong_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(path: Path) -> None:
        raise ZeroDivisionError("of all things")

    monkeypatch.setattr(trial, "read_scene", broken)
    assert attempt(0).fault.startswith("ZeroDivisionError: of all things (")
    monkeypatch.setattr(trial, "SECONDS", 0.01)

    def slow(path: Path) -> None:
        time.sleep(0.02)
        raise sandbox.SceneError([])

    monkeypatch.setattr(trial, "read_scene", slow)
    assert attempt(0).fault == "a refusal without words"


def test_a_process_that_dies_is_told_and_replaced(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str],
) -> None:
    """By a worker that dies at seed 1 and never ends at seed 3."""
    monkeypatch.setattr(command, "HANG", 1.0)
    worker = tmp_path / "tests" / "fuzz" / "worker.py"
    worker.parent.mkdir(parents=True)
    for folder in (worker.parent, worker.parent.parent):
        (folder / "__init__.py").touch()
    worker.write_text("""
import json, os, sys, time
for seed in range(int(sys.argv[1]), int(sys.argv[2])):
    print(json.dumps({"begins": seed}), flush=True)
    os.abort() if seed == 1 else time.sleep(60 if seed == 3 else 0)
    print(json.dumps({"seed": seed, "stage": "done", "seconds": 0, "fault": ""}), flush=True)
""")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", os.fspath(tmp_path))
    assert command.main(["--count", "5"]) == 1
    said = capsys.readouterr().out
    assert "seed 1: dies: the process ended with -6" in said
    assert "seed 3: hangs: no end of it" in said
    assert "5 inputs from seed 0 on, 2 faults" in said


@pytest.mark.parametrize("group", range(RECORDINGS))
def test_no_recording_is_a_fault(group: int) -> None:
    outcomes = [attempt(seed, recording=True)
                for seed in range(group * FEW, (group + 1) * FEW)]
    assert [each for each in outcomes if each.fault and "took" not in each.fault] == []
    assert {each.stage for each in outcomes} & {"done", "load"}


def test_a_recording_is_made_again_from_its_seed(
    capfdbinary: pytest.CaptureFixture[bytes],
) -> None:
    found = [recordings.make(seed) for seed in range(12)]
    assert found == [recordings.make(seed) for seed in range(12)]
    assert len({each["run.npz"] for each in found}) > 8
    assert command.main(["--recordings", "--show", "3"]) == 0
    assert capfdbinary.readouterr().out == found[3]["run.npz"]
