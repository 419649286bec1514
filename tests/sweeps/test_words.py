"""What is varied and kept, in the words of a command line."""

import pytest

from sandbox.errors import SceneError
from sandbox.search.question import asked_in
from sandbox.sweeps.plan import plan_of
from sandbox.sweeps.schema import study_schema
from sandbox.sweeps.words import kept_from, looked_at, varied_from
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


@pytest.mark.parametrize("search", [False, True])
def test_a_study_file_may_say_it_in_the_same_words(search):
    texts = {"parameters.push": "2 N:8 N", "parameters.m": "normal(0.5 kg, 0.05 kg)"}
    groups = [[{"over": over, "design": "sobol", "count": 8}] for over in (
        texts, {path: varied_from(text) for path, text in texts.items()})]
    studies = [{"scene": PUCK, "vary": vary, "keep": {"v": "puck.vx"}} for vary in groups]
    if search:
        one, other = (asked_in(study).space.over for study in studies)
    else:
        one, other = (plan_of(study).points.axes for study in studies)
    assert one == other


@pytest.mark.parametrize("read", [plan_of, asked_in])
def test_words_of_a_study_file_that_say_nothing_are_named(read):
    with pytest.raises(SceneError) as caught:
        read({"scene": PUCK, "vary": {"parameters.push": "nrmal(1, 2)"}})
    problem, = caught.value.problems
    assert "there is no distribution 'nrmal'" in problem.message
    assert problem.hint == "'normal'"
    assert problem.path.startswith("$.vary")


def test_the_schema_has_words_too():
    over = study_schema()["$defs"]["Varying"]["properties"]["over"]
    assert {"string"} == {each["type"] for each in over["additionalProperties"]["anyOf"]
                          if "type" in each}


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


def test_names_of_what_is_kept():
    assert kept_from("tip = max tip.x") == ("tip", "max tip.x")
    assert kept_from("ratio==a / b") == ("ratio", "=a / b")
    assert kept_from("max tip.x") == ("max tip.x", "max tip.x")
    for wrong in ("", "=a", "tip="):
        with pytest.raises(WrongValueError):
            kept_from(wrong)
