"""What drives may come to while a run goes on, as far as the mechanism tells beforehand."""

from __future__ import annotations

import numpy as np

from sandbox.scene.elements.controllers import writes_of
from sandbox.scene.elements.drives import StiffnessDrive
from sandbox.scene.mechanism import Mechanism, signal_of
from sandbox.scene.values.signals import AnySignal, Table, values

INSTANTS = 257
"""Of a run, at which a signal is looked at."""


def largest_stiffness(mechanism: Mechanism) -> dict[str, float]:
    """The largest stiffness [N/m, N m/rad] that drives give to springs, by the springs' names.

    By the drive's signal, the upper limits of a controller that writes it, and
    what events set it to. What a controller without limits does is not known.
    """
    found: dict[str, float] = {}
    limits: dict[str, float] = {}
    for controller in mechanism.controllers:
        given = getattr(controller, "limits", None)
        writes = writes_of(controller)
        pairs = [given] if len(writes) == 1 and given and np.isscalar(given[0]) else given or ()
        limits |= {name: pair[1] for name, pair in zip(writes, pairs, strict=False)}
    for drive in mechanism.drives:
        if isinstance(drive, StiffnessDrive):
            found[drive.spring] = max([
                _largest(signal_of(drive, mechanism), mechanism.run.duration),
                limits.get(drive.name, 0.0),
                *(event.set[drive.name] for event in mechanism.events if drive.name in event.set)])
    return found


def _largest(signal: AnySignal, duration: float) -> float:
    if isinstance(signal, Table):
        return max(value for _, value in signal.table)
    return float(values(signal, np.linspace(0.0, duration, INSTANTS)).max())
