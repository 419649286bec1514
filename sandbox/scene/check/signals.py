"""Values over time that have none at some instant of a run, or a radius that is not positive."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator

import numpy as np

from sandbox.errors import Problem
from sandbox.numeric import Array
from sandbox.scene.mechanism import Mechanism
from sandbox.values.signals import AnySignal, Formula, values
from sandbox.values.tables import Tables

SIGNAL_SAMPLES = 257
"""Instants of a run at which a formula is tried."""


def check_signals(mechanism: Mechanism) -> Iterator[Problem]:
    """Formulas without a finite value during the run, radii that are not positive."""
    duration, tables = mechanism.run.duration, mechanism.functions
    for path, signal, positive in _signals(mechanism):
        if isinstance(signal, Formula) or positive:
            yield from _try_signal(signal, duration, path, tables, positive=positive,
                                   at_once=path.startswith("$.controllers"))


def _signals(mechanism: Mechanism) -> Iterator[tuple[str, AnySignal, bool]]:
    """Every signal with its path, and whether it must stay positive."""
    for i, drive in enumerate(mechanism.drives):
        if drive.value is not None:
            yield f"$.drives[{i}].value", drive.value, drive.positive_value
    for i, controller in enumerate(mechanism.controllers):
        signals = controller.signals
        key = controller.target_key
        for j, signal in enumerate(signals):
            place = f"[{j}]" if key == "targets" else ""
            yield f"$.controllers[{i}].{key}{place}", signal, False
    for i, body in enumerate(mechanism.bodies):
        if body.path is not None:
            for key in ("x", "y", "angle"):
                if (signal := getattr(body.path, key)) is not None:
                    yield f"$.bodies[{i}].path.{key}", signal, False


def _try_signal(
    signal: AnySignal, duration: float, path: str, tables: Tables, *, positive: bool,
    at_once: bool = False,
) -> Iterator[Problem]:
    """``at_once`` says that the signal is asked for at t = 0, too: drives have no such step."""
    t: Array = duration * (np.arange(SIGNAL_SAMPLES, dtype=np.float64) + 0.5) / SIGNAL_SAMPLES
    if at_once:
        t = np.append(0.0, t)
    count = len(t) if not _lacks(signal, t, tables) else bisect_left(
        range(1, len(t) + 1), True, key=lambda n: _lacks(signal, t[:n], tables) != "")
    if positive and count and np.any((found := values(signal, t[:count], tables)) <= 0):
        first = t[int(np.argmax(found <= 0))]
        yield Problem("out-of-range",
                      f"the radius is not greater than 0 at t = {first:.4g} s", path)
    elif count < len(t):
        yield Problem("out-of-range", f"{_lacks(signal, t[count:count + 1], tables)} at t = "
                      f"{t[count]:.4g} s", path, allowed=f"a finite value from 0 to {duration:g} s")


def _lacks(signal: AnySignal, t: Array, tables: Tables) -> str:
    """Why a signal has no value at one of some instants, or nothing."""
    try:
        values(signal, t, tables)
    except ValueError as error:
        return str(error)
    return ""
