"""What runs beside each other are called."""

from __future__ import annotations

import pytest

from sandbox.show.apart import told_apart

NONE: dict[str, float] = {}


@pytest.mark.parametrize(("titles", "parameters", "sources", "told"), [
    (["a", "b"], [{"k": 1.0}, {"k": 2.0}], ["x", "y"], ["a", "b"]),
    (["a", "a"], [{"k": 1.0, "m": 3.0}, {"k": 2.0, "m": 3.0}], ["x", "y"], ["k = 1", "k = 2"]),
    (["a", "a"], [{"k": 1.0}, {"k": 1.0}], ["x", "y"], ["x", "y"]),
    (["a", "a"], [{"k": 1.0}, NONE], ["x", "y"], ["x", "y"]),
    (["a", "a"], [NONE, NONE], ["x", "x"], ["x", "x"]),
    (["a", "a"], [NONE, NONE], ["", ""], ["a", "a"]),
    (["a", "a", "b"], [{"k": 1.0}, {"k": 2.0}, NONE], ["x", "y", "z"], ["a: x", "a: y", "b: z"]),
    (["a", "a"], [dict.fromkeys("pqrs", 1 / 3), dict.fromkeys("pqrs", 2e-7)], ["", ""],
     ["p = 0.3333, q = 0.3333, r = 0.3333, \u2026", "p = 2e-07, q = 2e-07, r = 2e-07, \u2026"]),
    (["a"], [NONE], [""], ["a"]),
])
def test_titles_then_parameters_that_differ_then_places(
    titles: list[str], parameters: list[dict[str, float]], sources: list[str], told: list[str],
) -> None:
    assert told_apart(titles, parameters, sources) == told
