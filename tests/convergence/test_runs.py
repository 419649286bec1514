"""Runs at several steps, read at the same instants."""

from __future__ import annotations

import numpy as np

from sandbox.convergence.runs import at_instants, refined
from sandbox.elements.controllers.controller import every
from tests.support.mechanisms import mass, mechanism


def test_controllers_keep_their_rate() -> None:
    """At 0.4 ms the rate next to 1 kHz is 1250 Hz, at 0.2 ms it would be 1 kHz."""
    law = {"type": "schedule", "name": "law", "writes": "push", "value": 1}
    plain = mechanism(
        duration=0.1, step=4e-4, bodies=[mass("load", 1.0, (0, 0))], controllers=[law],
        drives=[{"type": "force", "name": "push", "body": "load", "direction": [1, 0], "value": 0}])
    for parts in (2, 4):
        found = refined(plain, parts)
        assert every(found.controllers[0].rate, found.run.step) == 2 * parts


def test_order_four() -> None:
    errors = []
    for n in (50, 100, 200):
        time = (np.arange(n) + 0.5) / n
        wanted = np.linspace(0.1, 0.9, 777)
        errors.append(np.abs(at_instants(time, np.sin(9 * time), wanted)
                             - np.sin(9 * wanted)).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 3.5).all()
