"""Meters: named quantities that a scene makes of recorded ones, sample by sample.

An expression may read any quantity of the catalogue, other meters and the
time ``t`` [s]. Where it has no finite value (a division by zero) the meter is
nan and a note says so; a run is not lost for it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sandbox.model.meters import order
from sandbox.numeric import Array
from sandbox.scene.mechanism import Mechanism
from sandbox.values.expressions import parse_expression


def evaluate(
    mechanism: Mechanism, *, read: Callable[[str], Array], time: Array
) -> tuple[Array, list[str]]:
    """All meters over a run, shape [n, number of meters], and notes on those without a value.

    ``read`` gives a recorded quantity, shape [n], or raises ``KeyError``.
    """
    result = np.full((len(time), len(mechanism.meters)), np.nan)
    notes: dict[int, str] = {}
    known: dict[str, Array] = {}
    ordered, circles = order(mechanism)
    tables = mechanism.functions
    for index in ordered:
        meter = mechanism.meters[index]
        try:
            expression = parse_expression(meter.value)
            values = {name: known[name] if name in known else time if name == "t" else read(name)
                      for name in sorted(expression.names)}
            result[:, index] = expression.evaluate({**tables, **values}, finite=False)
        except (KeyError, ValueError) as error:
            notes[index] = f"meter {meter.name!r} has no value: {error}"
        known[meter.name] = result[:, index]
        _blank(result[:, index], time, meter.name, notes, index)
    for index in sorted({index for circle in circles for index in circle}):
        notes[index] = f"meter {mechanism.meters[index].name!r} has no value: it depends on itself"
    return result, [notes[index] for index in sorted(notes)]


def _blank(column: Array, time: Array, name: str, notes: dict[int, str], index: int) -> None:
    """Turn what is not finite into nan, and note how much and when first."""
    bad = ~np.isfinite(column)
    column[bad] = np.nan
    if index not in notes and bad.any():
        notes[index] = (f"meter {name!r} has no finite value in {bad.sum()} of {len(column)} "
                        f"samples, first at t = {time[bad.argmax()]:.6g} s")
