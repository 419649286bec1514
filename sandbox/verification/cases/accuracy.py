"""Order of accuracy of every element that carries force."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.numeric import Array
from sandbox.study.exact_motions import elements
from sandbox.study.orders import EXACT, STEPS, ExactMotion, Order, measure
from sandbox.verification.cases.case import Case, Check, Findings

MARGIN = 0.3
"""Of an order between two steps: the next term of the error, C' h^(p+1), at these steps."""
ELEMENTS = {element.name: element for element in elements()}
RUN = f"h = {', '.join(f'{1e3 * h:g}' for h in STEPS)} ms"


@cache
def measured(name: str) -> Order:
    """What was measured of an element."""
    return measure(ELEMENTS[name])


def _exact(found: Order) -> list[Check]:
    """No error at any step but rounding."""
    element = found.element
    return [Check(f"largest error at h = {1e3 * step:g} ms", element.unit, 0.0, error,
                  element.floor, "what rounding may leave")
            for step, error in zip(element.steps, found.errors, strict=True)]


def _falls(found: Order) -> list[Check]:
    """The order that theory says, between any two steps."""
    element, errors = found.element, "/".join(f"{error:.2g}" for error in found.errors)
    return [Check(
        f"order from h = {1e3 * a:g} to {1e3 * b:g} ms", "1", element.theory, order,
        MARGIN if order < element.theory else 4.0,
        f"the next term of the error may make it less; more is no fault; errors {errors} "
        f"{element.unit}")
        for (a, b), order in zip(pairwise(element.steps), found.orders, strict=True)]


def _of(element: ExactMotion) -> Case:
    exact = element.theory == EXACT

    def measure() -> Findings:
        return Findings((_exact if exact else _falls)(measured(element.name)))

    name = "_".join("".join(c if c.isalnum() else " " for c in element.name).split()).lower()
    return Case(f"order_{name}", f"Order of accuracy: {element.name}", element.solution, RUN,
                f"largest error of the motion at three steps; theory: "
                f"{'exact' if exact else f'order {element.theory:g}'}. "
                f"{element.why[0].upper()}{element.why[1:]}", measure)


def _overview() -> Findings:
    shown = {name: measured(name) for name in ELEMENTS}
    slow = sum(min(o.orders) < o.element.theory - MARGIN for o in shown.values())
    rows = np.arange(len(shown), dtype=np.float64)
    orders = np.array([o.orders for o in shown.values()])
    theory = np.array([o.element.theory for o in shown.values()])
    curves = [Curve(f"from {1e3 * a:g} to {1e3 * b:g} ms", _finite(orders[:, i]), rows, "points")
              for i, (a, b) in enumerate(pairwise(STEPS))]
    return Findings(
        [Check("elements that fall short of the theory", "1", 0.0, float(slow), 0.0,
               f"by more than {MARGIN:g}, which the next term of the error may take, or by an "
               "error above rounding where it says none")],
        [Panel("Measured order", "order of accuracy [1]", "",
               [*curves, Curve("theory", _finite(theory), rows, "ticks")],
               rows=[f"{name}: exact" if element.theory == EXACT else name
                     for name, element in ELEMENTS.items()])])


def _finite(orders: Array) -> Array:
    """What is exact has no order to draw."""
    return np.where(np.isfinite(orders), orders, np.nan)


CASES = (
    Case("orders", "Order of accuracy: overview", "e(h) = C hᵖ", f"every element below at {RUN}",
         "how the largest error falls with the step, against order 2; some are exact", _overview),
    *(_of(element) for element in ELEMENTS.values()),
)
