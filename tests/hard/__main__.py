"""``python -m tests.hard [--only NAME] [--steps 1e-3,5e-4]``, from the top of a checkout."""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Iterator, Sequence

from tests.hard.trial import Order, Trial, carry_out, milliseconds, reached
from tests.hard.trials import TRIALS

HEADS = ("mechanism", "measure", "step", "value", "unit", "wanted", "", "wall time")
WIDTHS = (18, 26, 15, 10, 7, 15, 4, 9)


def main(words: list[str] | None = None) -> int:
    """Measure, print a line for each target, and return 1 if one is missed."""
    parser = argparse.ArgumentParser(prog="python -m tests.hard", description=(
        "Hard mechanisms against closed forms and independent integrations: every target of "
        "every trial, or, with --steps, every measure at these steps and its order."))
    parser.add_argument("--only", action="append", metavar="NAME",
                        help="trials whose names begin so; may be given several times")
    parser.add_argument("--steps", metavar="S,S", help="steps in seconds, the coarsest first")
    options = parser.parse_args(words)
    chosen = [trial for trial in TRIALS if not options.only or any(
        trial.name.startswith(name) for name in options.only)]
    if not chosen:
        parser.error(f"no such trial; there are {', '.join(trial.name for trial in TRIALS)}")
    print(_line(HEADS))
    missed, began = 0, time.perf_counter()
    for trial in chosen:
        rows = _at_steps(trial, [float(step) for step in options.steps.split(",")]) \
            if options.steps else _targets(trial)
        for row in rows:
            missed += row[6] == "no"
            print(_line(row), flush=True)
    print(f"{missed} missed, {time.perf_counter() - began:.0f} s")
    return 1 if missed else 0


def _line(cells: Sequence[str]) -> str:
    return "  ".join(f"{cell:<{width}}" for cell, width in zip(cells, WIDTHS, strict=True)).rstrip()


def _targets(trial: Trial) -> Iterator[tuple[str, ...]]:
    for target in trial.targets:
        value = reached(trial, target)
        runs = [carry_out(trial, step) for step in target.steps]
        order = isinstance(target, Order)
        yield (trial.name, f"order of {target.measure}" if order else target.measure,
               " / ".join(f"{1e3 * step:g}" for step in target.steps) + " ms",
               _number(value),
               "" if order else trial.measure(target.measure).unit, target.wanted,
               "ok" if target.holds(value) else "no", f"{sum(run.seconds for run in runs):.2f} s")


def _at_steps(trial: Trial, steps: Sequence[float]) -> Iterator[tuple[str, ...]]:
    for measure in trial.measures:
        last = math.nan, math.nan
        for step in steps:
            run = carry_out(trial, step)
            value = run.values[measure.name]
            order = ""
            if value > 0 and last[1] > 0 and math.isfinite(value + last[1]) and step != last[0]:
                order = f"order {math.log(last[1] / value) / math.log(last[0] / step):.2f}"
            yield (trial.name, measure.name, milliseconds(step), _number(value),
                   measure.unit, order, "", f"{run.seconds:.2f} s")
            last = step, value


def _number(value: float) -> str:
    return "diverges" if math.isinf(value) else f"{value:.3g}"


if __name__ == "__main__":
    sys.exit(main())
