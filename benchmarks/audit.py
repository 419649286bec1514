"""What the audit costs, against the run that it looks over: simulate, save, draw."""

from __future__ import annotations

import tempfile
from pathlib import Path

from benchmarks.measure import Figure, interleaved, mechanism, seconds
from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.picture.film import render
from sandbox.recording.store import save_data


def figures(*, quick: bool = False) -> list[Figure]:
    """The audit's share of a run of the four-finger hand, compiled code and imports set aside."""
    machine = mechanism("adaptive_grasp", {"run.duration": 0.5 if quick else 2.0})
    runs = [simulate(machine)]

    def run() -> None:
        runs[0] = simulate(machine)
        with tempfile.TemporaryDirectory() as folder:
            save_data(runs[0], Path(folder))
            render(runs[0], Path(folder) / "animation.gif")

    def look() -> float:
        fresh = runs[0].part(0, len(runs[0]))  # the first look works out what later ones reuse
        return seconds(lambda: audit(fresh))

    whole, looked = interleaved([lambda: seconds(run), look], 1 if quick else 5)
    return [
        Figure("audit / simulate, save and draw", looked / whole, "", most=0.1),
        Figure("  audit", 1e3 * looked, "ms"),
        Figure("  simulate, save and draw", 1e3 * whole, "ms"),
    ]
