"""On/off control with hysteresis."""

from __future__ import annotations

from typing import Any

from sandbox.elements.controllers.controller import Switch, SwitchController


def switch(**more: Any) -> Switch:
    return Switch(SwitchController.model_validate({
        "type": "switch", "name": "s", "reads": "x.y", "writes": "u", "below": 1, "above": 2,
        "value_below": 10, "value_above": 20, **more}), 1e-3)


def path(law: Switch, readings: list[float], has: float = 0.0) -> list[float]:
    law.begin([readings[0]], [], [has])
    return [law.act(0.0, [reading], [], [has])[0] for reading in readings]


def test_it_remembers_between_the_thresholds():
    law = switch()
    assert path(law, [1.5, 2.0, 2.1, 1.5, 1.0, 0.9, 1.0, 2.0, 3.0]) == [
        10, 10, 20, 20, 20, 10, 10, 10, 20]
    assert law.report() == {}


def test_a_switch_continues_from_the_drive_value():
    law = switch()
    assert path(law, [1.5], has=20.0) == [10]
    assert path(law, [1.5], has=20.0) == [20]
    assert path(switch(active=False), [1.5], has=7.0) == [7]
    assert path(switch(active=False), [2.5], has=7.0) == [20]
