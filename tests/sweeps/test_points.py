"""Values of the runs of a sweep, and the short texts for values and results."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy import stats

from sandbox.sweeps.spec import SweepSpec, number_of, parse_statistic, parse_values, points_of
from sandbox.wording import WrongValueError


def points(vary, **more):
    groups = vary if isinstance(vary, list) else [{"over": vary, **more}]
    return points_of(SweepSpec.model_validate({"scene": "x", "vary": groups}).dimensions())


def numbers(found, path):
    return np.array([number_of(point[path]) for point in found])


def test_a_grid_is_all_with_all_and_the_last_changes_fastest():
    found = points({"a": [1, 2], "b": {"from": 0, "to": 1, "count": 3}})
    assert [tuple(point.values()) for point in found] == [
        (1, 0), (1, 0.5), (1, 1), (2, 0), (2, 0.5), (2, 1)]


def test_a_log_scale_goes_in_even_ratios_and_ends_where_it_is_to_end():
    values = numbers(points({"a": {"from": 1, "to": 1000, "count": 4, "scale": "log"}}), "a")
    assert values == pytest.approx([1, 10, 100, 1000], rel=1e-14)
    assert (values[0], values[-1]) == (1, 1000)


def test_paired_paths_go_hand_in_hand_and_groups_are_nested():
    found = points([{"over": {"a": [1, 2], "b": ["x", "y"]}, "design": "paired"},
                    {"over": {"c": [10, 20, 30]}}])
    assert [tuple(point.values()) for point in found] == [
        (1, "x", 10), (1, "x", 20), (1, "x", 30), (2, "y", 10), (2, "y", 20), (2, "y", 30)]


@pytest.mark.parametrize("design", ["latin_hypercube", "sobol", "halton"])
def test_designs_fill_the_space_evenly(design):
    found = points({"a": {"from": 0, "to": 1}, "b": {"from": 5, "to": 9}}, design=design, count=64)
    a, b = numbers(found, "a"), (numbers(found, "b") - 5) / 4
    # a stratified sample of n has at least one point in each of n/4 strata; a random one has not
    for values in (a, b):
        assert np.histogram(values, 16, (0, 1))[0].min() >= 1
        assert abs(values.mean() - 0.5) < 1 / 64 + 0.01


@pytest.mark.parametrize(("written", "theirs"), [
    ({"distribution": "uniform", "from": "2 N", "to": "4 N"}, stats.uniform(2, 2)),
    ({"distribution": "normal", "mean": 3, "std": 0.2}, stats.norm(3, 0.2)),
    ({"distribution": "normal", "mean": 0, "std": 1, "from": -1, "to": 2},
     stats.truncnorm(-1, 2)),
    ({"distribution": "log_uniform", "from": 1, "to": 100}, stats.loguniform(1, 100)),
    ({"distribution": "log_normal", "median": 2, "sigma": 0.5}, stats.lognorm(0.5, scale=2)),
    ({"distribution": "triangular", "from": 0, "peak": 1, "to": 4},
     stats.triang(0.25, 0, 4)),
    ({"distribution": "exponential", "mean": 3}, stats.expon(scale=3)),
    ({"distribution": "scipy", "name": "gamma", "shapes": [2], "loc": 1, "scale": 3},
     stats.gamma(2, 1, 3)),
])
def test_random_numbers_have_their_distribution(written, theirs):
    values = numbers(points({"a": written}, count=2000), "a")
    # Kolmogorov and Smirnov: 2000 numbers of another distribution would be refused at 1e-3
    assert stats.kstest(values, theirs.cdf).pvalue > 1e-3


@pytest.mark.parametrize(("vary", "more", "words"), [
    ({"a": {"from": 1, "to": 2}}, {}, "has no count"),
    ({"a": [1, 2], "b": [1]}, {"design": "paired"}, "as many values each: 'a' 2, 'b' 1"),
    ({"a": {"from": "1 N", "to": "2 mm", "count": 2}}, {}, "a force and a length"),
    ({"a": {"from": 0, "to": 2, "count": 2, "scale": "log"}}, {}, "greater than 0"),
    ({"a": {"distribution": "normal", "mean": 1}}, {"count": 3}, "needs 'std'"),
    ({"a": {"distribution": "scipy", "name": "gama"}}, {"count": 3}, "no continuous distribution"),
    ({"a": {"distribution": "uniform", "from": 0, "to": 1}}, {"design": "grid"}, "cannot choose"),
    ({"a": ["=b"]}, {}, "unknown name 'b'"),
])
def test_wrong_values_are_refused(vary, more, words):
    with pytest.raises(ValidationError) as error:
        points(vary, **more)
    message = " ".join(each["msg"] for each in error.value.errors())
    assert words in message, message


@pytest.mark.parametrize(("text", "meant"), [
    ("2:8:7", {"from": 2, "to": 8, "count": 7}),
    ("2 N : 8 N : 7", {"from": "2 N", "to": "8 N", "count": 7}),
    ("1:100:3:log", {"from": 1, "to": 100, "count": 3, "scale": "log"}),
    ("1, 2 N, disc", [1, "2 N", "disc"]),
    ("[1, [2, 3]]", [1, [2, 3]]),
    ("normal(3, std=1, to=5)", {"distribution": "normal", "mean": 3, "std": 1, "to": 5}),
    ("=a / 2, =a", ["=a / 2", "=a"]),
])
def test_texts_of_values(text, meant):
    assert parse_values(text) == meant


@pytest.mark.parametrize(("text", "meant"), [
    ("disc.x", {"final": "disc.x"}),
    ("disc.x at 0.5 s", {"quantity": "disc.x", "at": "0.5 s"}),
    ("mean a/b.normal over last 0.2 s", {"mean": "a/b.normal", "over": "last 0.2 s"}),
    ("max disc.x over 10 ms : 0.5", {"max": "disc.x", "over": [0.01, 0.5]}),
])
def test_texts_of_results(text, meant):
    assert parse_statistic(text) == meant


@pytest.mark.parametrize(("read", "text", "words"), [
    (parse_values, "1:2:3:4", "too many"),
    (parse_values, "nrmal(1, 2)", "'normal'"),
    (parse_statistic, "mx disc.x", "did you mean 'max'"),
    (parse_statistic, "max disc.x over always", "no window"),
])
def test_texts_that_are_refused(read, text, words):
    with pytest.raises(WrongValueError) as error:
        read(text)
    assert words in str(error.value)
