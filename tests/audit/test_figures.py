"""What a figure is, and the worst of many comparisons."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.audit.figures import Figure, Worst, figure_data, judged, missing


def of(worst: Worst) -> Figure:
    return worst.figure("name", "m", why="{count}: {where}", source="(1)", none="nothing")


def test_the_worst_is_what_comes_closest_to_its_tolerance_and_not_the_largest():
    worst = Worst()
    worst.add("first", np.array([1.0, 3.0]), np.array([10.0, 40.0]))
    worst.add("second", np.array([0.1, 0.3, 0.2]), 2.0)
    assert of(worst) == Figure("name", 0.3, "m", 2.0, "pass", "2: second", "(1)")
    worst.add("third", np.array([0.3]), 2.0)  # as near: the one before stays
    worst.add("fourth", np.array([9.0, 4.5]), np.array([1.0, 30.0]), np.array([False, True]))
    worst.add("fifth", np.array([9.0]), 1.0, np.array([False]))
    worst.add("sixth", np.zeros(0), 1.0)
    assert of(worst) == Figure("name", 0.3, "m", 2.0, "pass", "4: second", "(1)")
    worst.add("seventh", np.array([0.0, 2.5]), 2.0)
    assert of(worst).verdict == "look"
    assert of(worst).why == "5: seventh"


def test_no_error_at_all_is_a_pass_and_no_comparison_none():
    worst = Worst()
    assert of(worst) == missing("name", why="nothing", source="(1)") or math.isnan(of(worst).value)
    assert (of(worst).verdict, of(worst).why) == ("not computed", "nothing")
    worst.add("only", np.zeros(3), 1e-12)
    assert of(worst) == Figure("name", 0.0, "m", 1e-12, "pass", "1: only", "(1)")


def test_an_error_that_is_no_number_is_the_worst_of_all():
    worst = Worst()
    worst.add("large", np.array([50.0]), 1.0)
    worst.add("odd", np.array([0.0, math.nan, 0.5]), np.array([1.0, 1.0, 2.0]))
    worst.add("larger", np.array([70.0]), 1.0)
    figure = of(worst)
    assert math.isnan(figure.value)
    assert (figure.verdict, figure.why) == ("look", "3: odd")


@pytest.mark.parametrize(("value", "threshold", "verdict"), [
    (1.0, 1.0, "pass"), (math.nextafter(1.0, 2.0), 1.0, "look"), (math.nan, 1.0, "look"),
    (0.0, math.inf, "look"), (math.inf, math.inf, "look"), (-1.0, 0.0, "pass")])
def test_a_figure_passes_up_to_its_threshold_if_both_are_numbers(value, threshold, verdict):
    assert judged("name", value, "m", threshold, why="w", source="s").verdict == verdict


def test_what_is_no_number_is_null_in_json():
    figure = judged("name", math.inf, "m", 1.0, why="w", source="s")
    assert figure_data(figure) == {"name": "name", "value": None, "unit": "m", "threshold": 1.0,
                                   "verdict": "look", "why": "w", "source": "s"}
