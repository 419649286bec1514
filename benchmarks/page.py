"""The page of a report: how large it is, and how long it takes to write."""

from __future__ import annotations

from benchmarks.measure import Figure, interleaved, mechanism, seconds
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.show.page import report

RESTLESS = "=pull * (0.55 + 0.45 * sin(2 * pi * 2.3 * t))"
"""A pull that never lets the hand rest."""


def figures(*, quick: bool = False) -> list[Figure]:
    """Of ten seconds of the four-finger hand that never rests, and of its own two seconds."""
    restless = simulate(mechanism("adaptive_grasp", {
        "run.duration": 1.0 if quick else 10.0, "drives[0].value": {"expression": RESTLESS}}))
    short = simulate(mechanism("adaptive_grasp", {"run.duration": 0.5 if quick else 2.0}))
    found = []
    for name, run, most in (("restless", restless, 5.0), ("at rest in the end", short, None)):

        def write(run: Recording = run) -> float:
            fresh = run.part(0, len(run))  # the first look works out what later ones reuse
            return seconds(lambda: report([fresh]))

        took = interleaved([write], 1 if quick else 5)[0]
        size = len(report([run]).encode()) / 1e6
        found += [Figure(f"page, {name}", size, "MB", most=most),
                  Figure(f"  written, {name}", took, "s", most=1.0)]
    return found
