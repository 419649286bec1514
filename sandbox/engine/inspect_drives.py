"""What drives may come to while a run goes on, as far as the mechanism tells beforehand."""

from __future__ import annotations

import numpy as np

from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.scene.elements.controllers import writes_of
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.values.signals import AnySignal, Table, values

INSTANTS = 257
"""Of a run, at which a signal is looked at."""


def largest_stiffness(model: Model) -> Array:
    """The largest stiffness [N/m, N m/rad] of every spring, shape [ns].

    Of one that a drive sets: by the drive's signal, the upper limits of a controller that writes
    it, and what events set it to. What a controller without limits does is not known.
    """
    mechanism, found = model.mechanism, model.springs.stiffness.copy()
    limits: dict[str, float] = {}
    for controller in mechanism.controllers:
        given = getattr(controller, "limits", None)
        writes = writes_of(controller)
        pairs = [given] if len(writes) == 1 and given and np.isscalar(given[0]) else given or ()
        limits |= {name: pair[1] for name, pair in zip(writes, pairs, strict=False)}
    events: dict[str, float] = {}
    for event in mechanism.events:
        events |= {name: max(value, events.get(name, value)) for name, value in event.set.items()}
    for spring in np.flatnonzero(model.springs.drive >= 0).tolist():
        drive = mechanism.drives[model.springs.drive[spring]]
        found[spring] = max([
            float(found[spring]) if drive.value is None
            else _largest(drive.value, mechanism),
            limits.get(drive.name, 0.0), events.get(drive.name, 0.0)])
    return found


def _largest(signal: AnySignal, mechanism: Mechanism) -> float:
    if isinstance(signal, Table):
        return max(value for _, value in signal.table)
    instants = np.linspace(0.0, mechanism.run.duration, INSTANTS)
    return float(values(signal, instants, mechanism.functions).max())
