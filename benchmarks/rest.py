"""The four-finger hand at rest: how near tensions are to F/4, how quiet they and contacts are."""

from __future__ import annotations

import numpy as np

from benchmarks.measure import Figure, mechanism
from sandbox.engine.simulate import simulate
from sandbox.numeric import Array
from sandbox.recording.recording import Recording

QUIET = 1e-8
"""The most that a force at rest may scatter [N]."""


def _tensions(run: Recording, late: Array) -> Array:
    """Of the fingers [N], shape [fingers, samples]."""
    return np.stack([run[name][late] for name in run.match("finger*.tendon.tension")])


def _noise_of_contacts(run: Recording, late: Array) -> float:
    """Largest standard deviation of any component of any pair's force [N]; infinite if one goes."""
    samples = np.flatnonzero(late)
    chosen = run.arrays["contact_sample"] >= samples[0]
    force = run.arrays["contact_force"][chosen]
    pairs = np.stack([run.arrays["contact_body"][chosen], run.arrays["contact_other"][chosen]])
    worst = 0.0
    for pair in np.unique(pairs, axis=1).T:
        its = (pairs == pair[:, None]).all(axis=0)
        worst = max(worst, float(force[its].std(axis=0).max()) if its.sum() == len(samples)
                    else np.inf)
    return worst


def figures(*, quick: bool = False) -> list[Figure]:
    """Largest deviation [% of F/4] and largest standard deviations [N] over the last 0.2 s.

    There is nothing to shorten when ``quick``: the hand needs its time to come to rest.
    """
    found = []
    for step in (5e-4, 1e-3, 2e-3):
        run = simulate(mechanism("adaptive_grasp", {
            "run.step": step, "run.sample_rate": 1 / max(step, 1e-3)}))
        late = run.time >= run.time[-1] - 0.2
        tension = _tensions(run, late)
        share = run["actuator.value"][-1] / len(tension)
        label = f"at h = {1e3 * step:g} ms"
        found += [
            Figure(f"tension off F/4 {label}", 100 * abs(tension.mean(axis=1) / share - 1).max(),
                   "%", most=0.01),
            Figure(f"std of tensions {label}", tension.std(axis=1).max(), "N", most=QUIET),
            Figure(f"std of contact forces {label}", _noise_of_contacts(run, late), "N",
                   most=QUIET),
        ]
    return found
