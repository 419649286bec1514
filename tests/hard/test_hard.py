"""Each target of each trial is one test."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import pytest

from tests.hard.__main__ import main
from tests.hard.trial import AtMost, Order, Target, Trial, full_name, reached
from tests.hard.trials import TRIALS


def targets() -> Iterator[Any]:
    for trial in TRIALS:
        for target in trial.targets:
            yield pytest.param(trial, target, id=full_name(trial, target))


@pytest.mark.parametrize(("trial", "target"), list(targets()))
def test_target(trial: Trial, target: Target) -> None:
    value = reached(trial, target)
    assert target.holds(value), f"{value:.4g}, wanted {target.wanted}: {target.why}"


def test_names() -> None:
    """Each is unique."""
    names = [full_name(trial, target) for trial in TRIALS for target in trial.targets]
    assert len(set(names)) == len(names)


def test_command(capsys: pytest.CaptureFixture[str]) -> None:
    """A line for each target, and what is missed counts; at other steps, errors and orders."""
    code = main(["--only", "row_2_e1"])
    told = capsys.readouterr().out.splitlines()
    assert told[0].split() == ["mechanism", "measure", "step", "value", "unit", "wanted",
                               "wall", "time"]
    assert len(told) == 4
    assert all(" ok " in line for line in told[1:3])
    assert told[-1].startswith("0 missed")
    assert code == 0
    main(["--only", "closing", "--steps", "2e-3,1e-3"])
    lines = capsys.readouterr().out.splitlines()
    assert "2 ms" in lines[1]
    assert "order" in lines[2]
    with pytest.raises(SystemExit):
        main(["--only", "nothing"])
    assert "no such trial; there are chain_20, " in capsys.readouterr().err


def test_a_miss_is_told() -> None:
    """Whatever is too large, infinite or no number, and an order of a run that diverged."""
    most = AtMost("error", 1e-3, 0.1, "")
    assert [most.holds(value) for value in (0.1, 0.11, math.inf, math.nan)] == [
        True, False, False, False]
    order = Order("error", (1e-3, 5e-4), 1.8, "")
    assert order.value([4e-3, 1e-3]) == pytest.approx(2.0)
    assert not order.holds(order.value([math.inf, 1e-3]))
    assert not order.holds(order.value([3e-3, 1e-3]))
