"""From specs to laws."""

from __future__ import annotations

from typing import Any

import pytest
from pydantic import TypeAdapter

from sandbox.elements.registry import Controller
from sandbox.scene.mechanism import Mechanism
from sandbox.values.signals import values

H = 1e-3
ONE: dict[str, Any] = {"name": "c", "writes": "u"}
READER: dict[str, Any] = {**ONE, "reads": "x.y"}


def spec(**given: Any) -> Any:
    return TypeAdapter(Controller).validate_python(given)


def first(given: Any, readings: list[float], inputs: list[float]) -> list[float]:
    """What a built law wants at its first act, at t = 0."""
    import numpy as np

    law = given.make_law(Mechanism(), H)
    targets = [float(values(signal, np.zeros(1))[0]) for signal in given.signals]
    assert len(given.readings) == len(readings)
    assert len(given.written) == len(inputs)
    law.begin(readings, targets, inputs)
    return law.act(0.0, readings, targets, inputs)


@pytest.mark.parametrize(("given", "readings", "wanted"), [
    ({**READER, "type": "pid", "target": 2.0, "kp": 3.0}, [1.0], [10.0]),
    ({**READER, "type": "pid", "target": 2.0, "kp": 3.0, "bias": 1.0}, [1.0], [4.0]),
    ({**READER, "type": "pid", "target": 2.0, "kp": 3.0, "bumpless": True}, [1.0], [7.0]),
    ({**ONE, "type": "schedule", "value": {"from": 4.0, "to": 5.0, "over": 1.0}}, [], [4.0]),
    ({**ONE, "type": "feedback", "value": "=2 * x.y"}, [2.5], [2.5]),
    ({**READER, "type": "switch", "below": 1.0, "above": 2.0, "value_below": 5.0,
      "value_above": 6.0}, [3.0], [6.0]),
    ({**READER, "type": "relay", "target": 2.0, "amplitude": 0.5}, [1.0], [7.5]),
    ({**READER, "type": "state_feedback", "writes": ["u"], "reads": ["x.y"], "targets": [2.0],
      "gains": [[3.0]]}, [1.0], [10.0]),
])
def test_every_kind_has_its_law(given, readings, wanted):
    assert first(spec(**given), readings, [7.0]) == wanted
