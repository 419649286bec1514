"""Runs on one page have arrows of one scale."""

from __future__ import annotations

import json
import re
from typing import Any

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.show.one_scale import put_to_one_scale
from sandbox.show.page import report
from tests.draw.conftest import hand


def heads(page: str) -> list[dict[str, Any]]:
    return [json.loads(text) for text in re.findall(r"data-run>(.*?)</script>", page)]


def arrows(head: dict[str, Any]) -> dict[str, tuple[float, float]]:
    found = {part["l"]: (part["metres"], part["longest"]) for part in head["parts"]
             if part["k"] == "vectors"}
    return found | {"contacts": (head["scale"]["metres"], head["scale"]["longest"])}


def test_arrows_of_runs_beside_each_other_have_the_scale_of_the_largest() -> None:
    run = hand()
    small, large = (Recording(run.mechanism, {
        **run.arrays, "body_velocity": k * np.ones_like(run.arrays["body_velocity"]),
        "contact_force": k * run.arrays["contact_force"]}, run.info) for k in (1, 3))
    [one], [two] = (heads(report([run])) for run in (small, large))
    assert arrows(one)["velocity"][0] > arrows(two)["velocity"][0]
    both = heads(report([small, large]))
    assert arrows(both[0]) == arrows(both[1])
    for name in ("velocity", "contacts"):
        assert arrows(both[0])[name] == arrows(two)[name]
    assert both[0]["box"] == both[1]["box"]


def test_pictures_are_fitted_to_all_runs_unless_one_is_much_smaller() -> None:
    def boxes(*widths: float) -> list[list[float]]:
        found: list[dict[str, Any]] = [{"box": [0.0, 0.0, width, 1.0], "parts": [],
                                        "scale": {"metres": 0.0}} for width in widths]
        put_to_one_scale(found)
        return [one["box"] for one in found]

    assert boxes(2.0, 3.0) == [[0, 0, 3, 1]] * 2
    assert boxes(1.0, 3.0) == [[0, 0, 1, 1], [0, 0, 3, 1]]
