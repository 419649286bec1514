"""Each target of each trial is one test."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from tests.hard.trial import Target, Trial, full_name, measure
from tests.hard.trials import TRIALS


def targets() -> Iterator[Any]:
    for trial in TRIALS:
        for target in trial.targets:
            yield pytest.param(trial, target, id=full_name(trial, target))


@pytest.mark.parametrize(("trial", "target"), list(targets()))
def test_target(trial: Trial, target: Target) -> None:
    value = target.value([measure(trial, step)[target.measure] for step in target.steps])
    assert target.holds(value), f"{value:.4g}: {target.why}"
