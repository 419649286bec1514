"""Each target of each trial is one test; those that are not reached yet stand in ``not_yet``."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from tests.hard.not_yet import NOT_YET
from tests.hard.trial import Target, Trial, full_name, reached
from tests.hard.trials import TRIALS


def targets() -> Iterator[Any]:
    for trial in TRIALS:
        for target in trial.targets:
            name = full_name(trial, target)
            marks = [pytest.mark.xfail(strict=False)] if name in NOT_YET else []
            yield pytest.param(trial, target, id=name, marks=marks)


@pytest.mark.parametrize(("trial", "target"), list(targets()))
def test_target(trial: Trial, target: Target) -> None:
    value = reached(trial, target)
    assert target.holds(value), f"{value:.4g}, wanted {target.wanted}: {target.why}"


def test_names() -> None:
    """Unique, and what is not reached yet is something that is wanted."""
    names = [full_name(trial, target) for trial in TRIALS for target in trial.targets]
    assert len(set(names)) == len(names)
    assert set(names) >= NOT_YET
