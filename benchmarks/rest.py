"""Tensions of the four-finger hand at rest: how near to F/4, and how quiet."""

from __future__ import annotations

import numpy as np

from benchmarks.measure import Figure, mechanism
from sandbox.engine.simulate import simulate


def figures(*, quick: bool = False) -> list[Figure]:
    """Largest deviation and standard deviation of any finger over the last 0.2 s [% of F/4].

    There is nothing to shorten when ``quick``: the hand needs its time to come to rest.
    """
    found = []
    for step in (5e-4, 1e-3):
        run = simulate(mechanism("adaptive_grasp", {"run.step": step}))
        late = run.time >= run.time[-1] - 0.2
        tension = np.stack([run[name][late] for name in run.match("finger*.tendon.tension")])
        share = run["actuator.value"][-1] / len(tension)
        label = f"at h = {1e3 * step:g} ms"
        found += [
            Figure(f"tension off F/4 {label}", 100 * abs(tension.mean(axis=1) / share - 1).max(),
                   "%", most=0.01),
            Figure(f"tension's std {label}", 100 * tension.std(axis=1).max() / share, "%",
                   most=0.01),
        ]
    return found
