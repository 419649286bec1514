"""What a page knows of a run: how it begins, whom it follows; windows of verdicts."""

import numpy as np
import pytest

from sandbox.samples.expectations import verdicts
from sandbox.web.drawing import drawing, listed
from sandbox.web.page import FoundOut, told_apart, words
from tests.draw.conftest import hand


def test_every_verdict_has_the_window_of_its_own_expectation():
    run = hand()
    data = run.mechanism.model_dump(mode="json", by_alias=True)
    data["expect"] = [
        {"mean": "tree.tendon.tension", "over": [0.2, 0.4], "above": -1},
        {"max": "no.such.quantity", "above": -1},
        {"final": "finger?.tendon.tension", "above": -1},
        {"mean": "tree.tendon.tension", "over": [1.0, 1.5], "above": -1}]
    mechanism = type(run.mechanism).model_validate(data)
    run = type(run)(mechanism, run.arrays, run.info)
    told = words(run, FoundOut(verdicts(run)))["expect"]
    assert [one["quantity"] for one in told] == [
        "tree.tendon.tension", "no.such.quantity", *(f"finger{k}.tendon.tension" for k in
                                                       (1, 2, 3, 4)), "tree.tendon.tension"]
    step = float(run.time[1] - run.time[0])
    for one, (start, end) in ((told[0], (0.2, 0.4)), (told[-1], (1.0, 1.5))):
        assert 0 <= one["over"][0] - start <= step
        assert 0 <= end - one["over"][1] <= step
    for one in told[2:6]:  # a last value is taken at the end
        assert one["over"] == [float(run.time[-1])] * 2


def test_a_page_begins_where_the_run_does_and_follows_whom_the_scene_does():
    """From the first sample on a camera counts how far it has gone along."""
    run = hand()
    view = run.mechanism.view.model_copy(update={"follow": "finger2.distal"})
    run = type(run)(run.mechanism.model_copy(update={"view": view}), run.arrays, run.info)
    head = drawing(run, *listed(run))
    assert head["view"]["follow"] == "finger2.distal"
    rest = np.array(head["rest"]).reshape(-1, 3)[:len(run.mechanism.bodies)]
    assert rest == pytest.approx(run.arrays["body_pose"][0], abs=1e-5)
    assert np.abs(rest - run.arrays["body_pose"][-1]).max() > 0.1

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
