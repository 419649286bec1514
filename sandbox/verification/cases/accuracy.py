"""Order of accuracy of every element that carries force."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.study.exact_motions import elements
from sandbox.study.orders import STEPS, ExactMotion, Order, measure
from sandbox.verification.cases.case import Case, Check, Findings

MARGIN = 0.3
"""Of an order between two steps: the next term of the error, C' h^(p+1), at these steps."""
ELEMENTS = {element.name: element for element in elements()}
RUN = f"h = {', '.join(f'{1e3 * h:g}' for h in STEPS)} ms"


@cache
def measured(name: str) -> Order:
    """What was measured of an element."""
    return measure(ELEMENTS[name])


def _of(element: ExactMotion) -> Case:
    def measure() -> Findings:
        found = measured(element.name)
        errors = "/".join(f"{error:.2g}" for error in found.errors)
        return Findings([Check(
            f"order from h = {1e3 * a:g} to {1e3 * b:g} ms", "1", element.theory, order,
            MARGIN if order < element.theory else 4.0,
            f"the next term of the error may make it less; more is no fault; errors {errors} "
            f"{element.unit}")
            for a, b, order in zip(element.steps, element.steps[1:], found.orders, strict=False)])

    name = "_".join("".join(c if c.isalnum() else " " for c in element.name).split()).lower()
    return Case(f"order_{name}", f"Order of accuracy: {element.name}", element.solution, RUN,
                f"largest error of the motion at three steps; theory: order {element.theory:g}. "
                f"{element.why[0].upper()}{element.why[1:]}", measure)


def _overview() -> Findings:
    shown = {name: measured(name) for name in ELEMENTS}
    slow = sum(min(o.orders) < o.element.theory - MARGIN for o in shown.values())
    rows = np.arange(len(shown), dtype=np.float64)
    orders = np.array([o.orders for o in shown.values()])
    curves = [Curve(f"from {1e3 * a:g} to {1e3 * b:g} ms", orders[:, i], rows, "points")
              for i, (a, b) in enumerate(pairwise(STEPS))]
    theory = Curve("theory", np.array([e.theory for e in ELEMENTS.values()]), rows, "ticks")
    return Findings(
        [Check("elements that fall short of the theory", "1", 0.0, float(slow), 0.0,
               f"by more than {MARGIN:g}, which the next term of the error may take")],
        [Panel("Measured order", "order of accuracy [1]", "", [*curves, theory],
               rows=list(ELEMENTS))])


CASES = (
    Case("orders", "Order of accuracy: overview", "e(h) = C hᵖ", f"every element below at {RUN}",
         "how the largest error falls with the step, against orders 1 and 2", _overview),
    *(_of(element) for element in ELEMENTS.values()),
)
