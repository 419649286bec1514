"""Cost per finger as a hand grows from 4 to 64 fingers on one tree of rockers."""

from __future__ import annotations

import json
from functools import partial
from typing import Any

from benchmarks.measure import Figure, interleaved, loop_seconds, mechanism
from sandbox.engine.simulate import simulate
from sandbox.scene.library import find_scene

COUNTS = (4, 8, 16, 32, 64)
PULL = 3.75
"""Of each finger [N]."""


def hand(count: int, duration: float) -> dict[str, Any]:
    """The fingers of ``adaptive_grasp``, as many as asked for, each on a fixed circle."""
    base = json.loads(find_scene("adaptive_grasp").read_text(encoding="utf-8"))
    fingers = [{"like": "digit", "name": f"finger{i}", "at": [0, f"={count - i} * pitch"]}
               for i in range(count)]
    circles = [{"type": "section", "name": f"section{i}", "circle": "16 mm",
                "material": "object", "at": ["11 mm", f"={count - i} * pitch - 0.039"]}
               for i in range(count)]
    tree = {"type": "rocker_tree", "name": "tree", "pulls": [f["name"] for f in fingers]}
    return {
        **{key: base[key] for key in ("parameters", "materials", "templates")},
        "run": {"duration": duration, "step": 5e-4},
        "parts": [*fingers, *circles, tree],
        "drives": [{"type": "pull", "name": "actuator", "tendon": "tree",
                    "value": {"ramp": {"to": PULL * count, "over": duration / 2}}}],
    }


def figures(*, quick: bool = False) -> list[Figure]:
    """Time per step and finger for each count, relative to the smallest hand."""
    counts = COUNTS[:2] if quick else COUNTS
    duration = 0.1 if quick else 0.6
    machines = [mechanism(hand(count, duration)) for count in counts]
    simulate(machines[0])
    spent = interleaved(
        [partial(lambda machine: loop_seconds(simulate(machine)), machine)
         for machine in machines], 1 if quick else 5)
    each = [1e6 * t / count / (duration / 5e-4) for t, count in zip(spent, counts, strict=True)]
    return [
        Figure(f"cost per finger, {counts[-1]} / {counts[0]} fingers", each[-1] / each[0], "",
               most=1.3),
        *(Figure(f"  {count} fingers", cost, "us/step/finger")
          for count, cost in zip(counts, each, strict=True)),
    ]
