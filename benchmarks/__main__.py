"""``python -m benchmarks [--only NAME] [--quick] [--json]``, from the top of a checkout."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from benchmarks.measure import Figure, as_json, table

NAMES = ("step_loop", "control", "command", "drawing", "scaling", "piles", "audit", "page", "rest",
         "accuracy", "work_precision", "plain_pymunk", "view", "gym", "sweeps")

BUSY = 0.7
"""Load average of the last minute above which a warning is due."""


def main(words: list[str] | None = None) -> int:
    """Measure, print, and return 1 if a target is missed."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=(
        "Measure speed and accuracy on this machine against the project's targets. "
        "Ratios are of things measured in turns, in one run; times are medians."))
    parser.add_argument("--only", choices=NAMES, action="append", help="may be given several times")
    parser.add_argument("--quick", action="store_true",
                        help="short and rough: shows that all works, not how fast")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--draw", type=Path, metavar="DIR",
                        help="where pictures of what was measured go, if there are any")
    options = parser.parse_args(words)
    if hasattr(os, "getloadavg") and (load := os.getloadavg()[0]) > BUSY:
        print(f"this machine is busy (load {load:.1f}): times will be too long, and what runs "
              "side by side may not show it", file=sys.stderr)
    found: list[Figure] = []
    for name in options.only or NAMES:
        module = import_module(f"benchmarks.{name}")
        measure: Callable[..., list[Figure]] = module.figures
        figures = measure(quick=options.quick)
        if options.draw is not None and hasattr(module, "draw"):
            module.draw(options.draw, quick=options.quick)
        found += figures
        if not options.json:
            print(f"{name}\n{table(figures)}\n", flush=True)
    if options.json:
        print(as_json(found))
    return 0 if all(figure.ok for figure in found) else 1


if __name__ == "__main__":
    sys.exit(main())
