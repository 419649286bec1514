"""Tensions of rods and ropes: the reaction with its sign, against statics."""

from __future__ import annotations

import math

import numpy as np
import pytest

import sandbox


def _bracket(turned: float) -> sandbox.Recording:
    """A weight of 10 N on two rods at a wall, the lower one at 45 degrees, all turned in space."""
    c, s = math.cos(turned), math.sin(turned)

    def at(x: float, y: float) -> list[float]:
        return [c * x - s * y, s * x + c * y]

    return sandbox.simulate(sandbox.load_scene({
        "run": {"duration": 0.05}, "gravity": at(0.0, -10.0),
        "bodies": [{"name": "wall", "motion": "fixed"},
                   {"name": "node", "at": at(1.0, 0.0), "angle": 0.7, "mass": 1.0,
                    "inertia": 1e-3}],
        "joints": [
            {"type": "rod", "name": "tie", "a": "wall", "b": "node", "on_a": [0, 0]},
            {"type": "rod", "name": "strut", "a": "node", "b": "wall", "on_b": at(0.0, -1.0)},
            {"type": "rope", "name": "stay", "a": "wall", "b": "node", "on_a": [0, 0],
             "longest": 2.0}],
        "meters": [{"name": "both", "unit": "N", "value": "=tie.tension + strut.tension"}],
        "controllers": [{"type": "feedback", "name": "copy", "writes": "shove",
                         "value": "=0 * tie.tension + 0 * strut.tension"}],
        "drives": [{"type": "force", "name": "shove", "body": "node", "direction": [1, 0],
                    "value": 0}],
        "events": [{"name": "pushed", "when": "=strut.tension < -14.1 and tie.tension > 9.9",
                    "stop": "pass"}],
    }))


@pytest.mark.parametrize("turned", [0.0, -2.2])
def test_a_bracket(turned: float) -> None:
    """Tie and strut carry W and -W sqrt(2); which end is ``a`` says nothing, nor where is up."""
    run = _bracket(turned)
    assert run["tie.tension"][-1] == pytest.approx(10.0, rel=1e-9)
    assert run["strut.tension"][-1] == pytest.approx(-10.0 * math.sqrt(2.0), rel=1e-9)
    assert np.all(run["stay.tension"] == 0.0)
    assert run["both"][-1] == pytest.approx(10.0 - 10.0 * math.sqrt(2.0), rel=1e-9)
    assert run.unit("tie.tension") == "N"


def test_controllers_and_events_read_them_while_a_run_goes_on() -> None:
    run = _bracket(0.4)
    assert run.info.stopped is not None
    assert run.info.stopped.event == "pushed"
