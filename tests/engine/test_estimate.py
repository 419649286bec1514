"""What a run would take: counted, bounded, told and refused."""

from __future__ import annotations

from typing import Any

import pytest

from sandbox.engine.inspect import Estimate, look_over
from sandbox.engine.simulate import simulate
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.limits import Limits

DISC = {"type": "circle", "radius": 0.01}


def discs(count: int, apart: float, **more: Any) -> Mechanism:
    return Mechanism.model_validate({
        "bodies": [{"name": f"d{i}", "mass": 0.1, "at": [apart * i, 0], "shapes": [DISC]}
                   for i in range(count)],
        "run": {"duration": 0.01, "step": 1e-3, "sample_rate": 500}, **more})


def of(mechanism: Mechanism) -> Estimate:
    return look_over(mechanism).estimate


def test_steps_and_samples_are_those_of_the_run() -> None:
    found, run = of(discs(2, 1.0)), simulate(discs(2, 1.0))
    assert (found.steps, found.samples) == (run.info.steps, len(run)) == (10, 5)


@pytest.mark.parametrize(("count", "apart", "contacts"), [
    (1, 1.0, 0),     # nothing to touch
    (2, 1.0, 1),     # one pair
    (5, 1.0, 5),     # each touches something
    (5, 0.0, 10),    # all pairs are together
])
def test_contacts_that_are_reckoned_with(count: int, apart: float, contacts: int) -> None:
    assert of(discs(count, apart)).contacts == contacts


def test_sixteen_touching_circles_at_every_microsecond() -> None:
    machine = discs(16, 0.0, run={"duration": 0.9, "step": 1e-6, "sample_rate": 1e6})
    found = of(machine)
    assert found.contacts == 120
    assert found.recorded_bytes > 9e9
    (problem,) = found.beyond(Limits())
    assert "11 412 000 000 bytes with 120 contacts in each sample" in problem.message
    assert "'recorded_bytes', raised by --limit recorded_bytes=N" in problem.allowed
    assert list(found.beyond(Limits(recorded_bytes=10**11))) == []


def test_a_run_of_hours_is_refused() -> None:
    found = Estimate(2_000_000, 1000, 0, 11_880.0, 0)
    (problem,) = found.beyond(Limits())
    assert problem.message == "the run would take about 3.3 h, 11 880 s"
    assert problem.blocks
    assert list(found.beyond(Limits(seconds=20_000))) == []
