"""What is asked wrongly of a search is told in one line, before anything runs where it can be."""


import numpy as np
import pytest

import sandbox
from sandbox.errors import SandboxError
from sandbox.scene.read.limits import Limits
from sandbox.scene.values.units import parse_quantity
from sandbox.search.bisection import bisect
from sandbox.search.logistic import posterior
from tests.sweeps.scenes import PUCK

SCENE = {**PUCK, "run": {"duration": "2 ms", "step": "1 ms"}}
PUSH = {"parameters.push": "1 N:6 N"}
TWO = {**PUSH, "parameters.m": "1 kg:2 kg"}
KEEP = ["v=puck.vx"]


@pytest.fixture
def _nothing_runs(monkeypatch):
    def run(*_, **__):
        raise AssertionError("something ran")
    monkeypatch.setattr("sandbox.search.asking.Evaluator", run)


@pytest.mark.usefixtures("_nothing_runs")
@pytest.mark.parametrize(("kind", "words", "said"), [
    ("threshold", {"vary": PUSH, "where": "v > 0", "within": parse_quantity("1 mm", None)},
     "is in N, and 'mm' is a unit of length"),
    ("threshold", {"vary": PUSH, "where": "v > 0", "seed": -1}, "a seed is a number from 0"),
    ("threshold", {"vary": {**PUSH, "parameters.m": "normal(1 kg, -1 kg)"}, "where": "v > 0"},
     '$.vary["parameters.m"]: std must be greater than 0'),
    ("threshold", {"vary": {"parameters.push": "1 N:6 N:7"}, "where": "v > 0"},
     "'parameters.push' has a count, 7, and a search chooses its points itself. Allowed: the "
     "range without its count"),
    ("robustness", {"over": {"parameters.m": {"from": 1, "to": 2, "count": 3}}, "holds": "v > 0"},
     "'parameters.m' has a count, 3"),
    ("best", {"vary": PUSH, "least": "v", "most": "v"}, "'v' cannot be least and most"),
    ("best", {"vary": PUSH, "least": "v", "seed": 2**32}, "not 4294967296"),
    ("best", {"vary": PUSH, "least": "v", "runs": 10**12}, "the search has 1 000 000 000 000 runs"),
    ("sensitivity", {"vary": TWO, "count": 2**30}, "the search has 4 294 967 296 runs"),
    ("sensitivity", {"vary": TWO, "count": 8, "limits": Limits(runs=31)}, "has 32 runs"),
    ("sensitivity", {"vary": TWO, "method": "morris", "count": 8, "seed": 2**70}, "a seed is"),
    ("sensitivity", {"vary": TWO, "keep": ["v=puck.vx", "v=puck.x"]}, "have the name 'v'"),
    ("threshold", {"vary": PUSH, "keep": ["met=puck.vx"], "where": "met > 0"},
     "'met' is another column of the table"),
    ("robustness", {"over": TWO, "holds": "v > 0", "runs": 10**12}, "the search has 1 000"),
    ("robustness", {"over": TWO, "holds": "v > 0", "seed": -1}, "a seed is a number from 0"),
    ("robustness", {"over": TWO, "holds": "v > 0", "within": 5e-324}, "no narrower than 1/2048"),
    ("robustness", {"over": TWO, "holds": "v > 0", "boundary": "nn"}, "unknown name 'nn'"),
])
def test_what_is_refused(kind, words, said):
    with pytest.raises(SandboxError) as caught:
        getattr(sandbox.search, kind)(SCENE, **{"keep": KEEP, **words})
    assert said in str(caught.value)


def test_runs_without_an_answer_say_why():
    keep = ["v=puck.vx", "none==sqrt(v - 1000)"]
    with pytest.raises(SandboxError, match="no run of 5 has an answer: none: '=sqrt"):
        sandbox.search.best(SCENE, vary=PUSH, keep=keep, least="none", runs=5)
    with pytest.raises(SandboxError, match="0 of 16 can be used: none: '=sqrt"):
        sandbox.search.sensitivity(SCENE, vary=TWO, keep=keep, count=4)


def test_a_bracket_is_as_narrow_as_asked_for():
    """Two halvings at a time lead to widths 1/4, 1/16, …; 0.2 takes the second."""
    found = bisect(lambda shares: [share < 0.3 for share in shares], 0.2)
    assert (found.low, found.high) == (0.25, 0.3125)


def test_where_more_of_the_starts_hold_is_further_on_the_side_that_holds():
    """By symmetry half of them hold at 0.5; by the curve p at 0.5 + w ln(p / (1 - p))."""
    shares = np.array([0.2, 0.3, 0.4, 0.4, 0.6, 0.6, 0.7, 0.8])
    held = np.array([False, False, False, True, False, True, True, True])
    left = posterior(shares, held, rises=True)
    assert left.level(0.5)[1] == pytest.approx(0.5, abs=1e-5)
    assert left.level(0.9)[1] > 0.55
    assert left.level(0.1)[1] == pytest.approx(1 - left.level(0.9)[1], abs=1e-3)
    falls = posterior(shares, ~held, rises=False)
    assert falls.level(0.9)[1] < 0.45
