"""What a page says of a run: verdicts with the windows that they were taken over."""

from sandbox.samples.expectations import verdicts
from sandbox.show.header import FoundOut, words
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
