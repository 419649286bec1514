"""What is varied and kept, in the words of a command line."""

import pytest

from sandbox.errors import SceneError
from sandbox.search.question import asked_in
from sandbox.sweeps.plan import plan_of
from sandbox.sweeps.words import looked_at, varied_from
from sandbox.wording import WrongValueError
from tests.sweeps.scenes import PUCK


@pytest.mark.parametrize(("text", "meant"), [
    ("2:8:7", {"from": 2, "to": 8, "count": 7}),
    ("2 N : 8 N : 7", {"from": "2 N", "to": "8 N", "count": 7}),
    ("1:100:3:log", {"from": 1, "to": 100, "count": 3, "scale": "log"}),
    ("1:100:log", {"from": 1, "to": 100, "scale": "log"}),
    ("2:8", {"from": 2, "to": 8}),
    ("1, 2 N, disc", [1, "2 N", "disc"]),
    ("5", [5]),
    ("[1, [2, 3]]", [1, [2, 3]]),
    ('{"from": 1, "to": 2}', {"from": 1, "to": 2}),
    ("normal(3 N, 0.2 N)", {"distribution": "normal", "mean": "3 N", "std": "0.2 N"}),
    ("normal(3, std=1, to=5)", {"distribution": "normal", "mean": 3, "std": 1, "to": 5}),
    ("=a / 2, =a", ["=a / 2", "=a"]),
])
def test_what_is_varied(text, meant):
    assert varied_from(text) == meant


@pytest.mark.parametrize("read", [plan_of, asked_in])
def test_words_of_a_study_file_that_say_nothing_are_named(read):
    with pytest.raises(SceneError) as caught:
        read({"scene": PUCK, "vary": {"parameters.push": "nrmal(1, 2)"}})
    problem, = caught.value.problems
    assert "there is no distribution 'nrmal'" in problem.message
    assert problem.hint == "'normal'"
    assert problem.path.startswith("$.vary")


@pytest.mark.parametrize(("text", "said"), [
    ("", "no values"), ("1:2:3:4", "too many"), ("1:2:lgo", "how many"), ("[1", "not JSON"),
    ("nrmal(1, 2)", "'normal'"), ("exponential(1, 2)", "no more than mean"),
])
def test_what_says_nothing_is_refused(text, said):
    with pytest.raises(WrongValueError) as error:
        varied_from(text)
    assert said in str(error.value)


@pytest.mark.parametrize(("text", "meant"), [
    ("disc.x", {"final": "disc.x"}),
    ("disc.x at 0.5 s", {"quantity": "disc.x", "at": "0.5 s"}),
    ("mean a/b.normal over last 0.2 s", {"mean": "a/b.normal", "over": "last 0.2 s"}),
    ("max disc.x over 10 ms : 0.5", {"max": "disc.x", "over": [0.01, 0.5]}),
])
def test_what_is_kept(text, meant):
    assert looked_at(text) == meant


@pytest.mark.parametrize(("text", "said"), [
    ("mx disc.x", "did you mean 'max'"), ("max disc.x over always", "no window"),
    ("max disc.x over 1:2 over 3:4", "more than one"),
])
def test_what_is_no_statistic_is_refused(text, said):
    with pytest.raises(WrongValueError) as error:
        looked_at(text)
    assert said in str(error.value)
