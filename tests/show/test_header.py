"""What a page knows of a run: how it begins, whom it follows; windows of verdicts."""

import numpy as np
import pytest

from sandbox.samples.expectations import verdicts
from sandbox.show.header import FoundOut, drawing, words
from tests.draw.conftest import hand, hand_mechanism


def test_every_verdict_has_the_window_of_its_own_expectation():
    run = hand()
    data = hand_mechanism().model_dump(mode="json", by_alias=True)
    data["expect"] = [
        {"mean": "tree.actuator.tension", "over": [0.2, 0.4], "above": -1},
        {"max": "no.such.quantity", "above": -1},
        {"final": "finger?.tendon.tension", "above": -1},
        {"mean": "tree.actuator.tension", "over": [1.0, 1.5], "above": -1}]
    mechanism = type(run.mechanism).model_validate(data)
    run = type(run)(mechanism, run.arrays, run.info)
    told = words(run, FoundOut(verdicts(run)))["expect"]
    assert [one["quantity"] for one in told] == [
        "tree.actuator.tension", "no.such.quantity", *(f"finger{k}.tendon.tension" for k in
                                                       (1, 2, 3, 4)), "tree.actuator.tension"]
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
    mechanism = run.mechanism.model_copy(update={"view": view})
    head = drawing(type(run)(mechanism, run.arrays, run.info))
    assert head["view"]["follow"] == "finger2.distal"
    rest = np.array(head["rest"]).reshape(-1, 3)
    assert rest == pytest.approx(run.arrays["body_pose"][0], abs=1e-6)
    assert np.abs(rest - run.arrays["body_pose"][-1]).max() > 0.1
    largest = max(float(run.arrays["tendon_tension"].max()), 0.0)
    assert largest <= head["scale"]["tension"] < 1.4 * largest
