"""Goals whose best points are known."""

import numpy as np
import pytest

import sandbox
from sandbox.errors import SandboxError
from tests.sweeps.scenes import PUCK

SCENE = {**PUCK, "run": {"duration": "2 ms", "step": "1 ms"},
         "parameters": {**PUCK["parameters"], "a": 1, "b": 1}}
KEEP = ["bowl==(a - 0.3) ** 2 + 4 * (b + 0.2) ** 2", "tilt==(a - 1) ** 2 + b ** 2", "side==a"]
VARY = {"parameters.a": "-2:2", "parameters.b": "-2:2"}


def best(**more):
    return sandbox.search.best(SCENE, **{"vary": VARY, "keep": KEEP, "runs": 120, **more})


def test_cma_es_finds_the_bottom_of_a_bowl():
    found = best(least="bowl")
    choice, = found.best
    assert choice.values["parameters.a"] == pytest.approx(0.3, abs=0.05)
    assert choice.values["parameters.b"] == pytest.approx(-0.2, abs=0.05)
    assert found.certified
    assert found.runs == len(found.history) == 120
    assert "at half" not in found.certificate


@pytest.mark.parametrize("sampler", ["cmaes", "tpe"])
def test_a_condition_moves_the_best_to_its_limit(sampler):
    found = best(least="bowl", where="side > 1", sampler=sampler, runs=100)
    choice, = found.best
    assert 1 <= choice.values["parameters.a"] < 1.15
    assert choice.objectives["bowl"] >= 0.49
    assert choice.excess <= 0


def test_several_goals_have_a_front():
    found = best(least=["bowl", "tilt"], runs=200)
    assert len(found.best) > 5
    for choice in found.best:
        assert not any(all(other.objectives[name] < choice.objectives[name]
                           for name in choice.objectives) for other in found.best)
    middle = min(found.best, key=lambda each: abs(each.values["parameters.a"] - 0.65))
    assert middle.objectives["tilt"] < 0.6
    assert found.certified


def test_a_search_resumes_from_its_results(tmp_path, monkeypatch):
    seen = []
    from sandbox.sweeps.job import Log

    add = Log.add
    monkeypatch.setattr(Log, "add", lambda self, row: (seen.append(row), add(self, row)))
    first = best(least="bowl", runs=12, out=tmp_path)
    done = len(seen)
    further = best(least="bowl", runs=20, out=tmp_path)
    assert np.array_equal(further.history[:12], first.history)
    assert len(seen) - done <= 8 + 5
    seen.clear()
    assert best(least="bowl", runs=20, out=tmp_path).best == further.best
    assert seen == []


@pytest.mark.parametrize(("more", "words"), [
    ({}, "to minimise or maximise"),
    ({"least": "bowl", "most": "bowl"}, "'bowl' cannot be minimised and maximised"),
    ({"least": "bowl", "runs": 10**12}, "the search has 1 000 000 000 000 runs"),
    ({"least": "none", "keep": ["none==sqrt(a - 99)"], "runs": 5},
     "no run of 5 has an answer: none: '=sqrt"),
    ({"least": "bowl", "where": "side > 7", "runs": 20}, "no run of 20 meets all conditions"),
    ({"least": "bowl", "vary": {"parameters.a": "normal(1, 2)"}}, "has a distribution"),
])
def test_wrong_optimisations_are_refused(more, words):
    with pytest.raises(SandboxError) as error:
        best(**more)
    assert words in str(error.value)
