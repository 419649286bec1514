"""Indices that are known: of Ishigami's function and of a sum, through scenes that keep them."""

import numpy as np
import pytest

import sandbox
from sandbox.errors import SandboxError
from tests.sweeps.scenes import PUCK

SCENE = {**PUCK, "run": {"duration": "2 ms", "step": "1 ms"},
         "parameters": {**PUCK["parameters"], "a": 1, "b": 1, "c": 1}}
PATHS = ("parameters.a", "parameters.b", "parameters.c")


def index_values(found, name, word):
    by_path = {each.path: each for each in found.influences[name]}
    return (np.array([by_path[path].values[word] for path in PATHS]),
            np.array([by_path[path].halves.get(word, 0.0) for path in PATHS]))


def test_sobols_indices_of_ishigamis_function():
    found = sandbox.search.sensitivity(
        SCENE, vary=dict.fromkeys(PATHS, f"{-np.pi}:{np.pi}"), count=64,
        keep=["y==sin(a) + 7 * sin(b) ** 2 + 0.1 * c ** 4 * sin(a)"])
    assert found.runs == 64 * 5
    for word, truth in (("first", [0.3139, 0.4424, 0.0]), ("total", [0.5576, 0.4424, 0.2437])):
        values, halves = index_values(found, "y", word)
        assert (halves > 0).all()
        assert (np.abs(values - truth) <= 1.5 * halves + 0.01).all()
    assert found.certified
    assert found.influences["y"][-1].path == "parameters.c"


def test_morris_tells_slopes_of_a_sum_exactly():
    found = sandbox.search.sensitivity(
        SCENE, vary=dict.fromkeys(PATHS, "0:2"), keep=["y==a + 3 * b", "product==a * c"],
        method="morris", count=8)
    assert found.runs == 8 * 4
    values, _ = index_values(found, "y", "mu_star")
    assert values == pytest.approx([2, 6, 0], abs=1e-9)
    sigma, _ = index_values(found, "y", "sigma")
    assert sigma == pytest.approx([0, 0, 0], abs=1e-9)
    assert index_values(found, "product", "sigma")[0][0] > 0.1


@pytest.mark.parametrize(("more", "fragment"), [
    ({"method": "sobl"}, "method: 'sobl' is not"),
    ({"count": 100}, "a power of 2, not 100. Allowed: 64, 128"),
    ({"vary": {"parameters.a": "0:1"}}, "two paths or more"),
    ({"keep": ["y==sqrt(-1 - a)"], "count": 4}, "too few runs have an answer"),
])
def test_wrong_sensitivity_requests_are_refused(more, fragment):
    words = {"vary": dict.fromkeys(PATHS, "0:1"), "keep": ["y==a"], **more}
    with pytest.raises(SandboxError) as error:
        sandbox.search.sensitivity(SCENE, **words)
    assert fragment in str(error.value)


@pytest.mark.parametrize("method", ["sobol", "morris"])
def test_the_same_seed_gives_the_same_points_and_intervals(method, tmp_path):
    """The seed 0, too, which SALib takes for none; in its directory nothing is run again."""
    vary, seen = dict.fromkeys(PATHS, "-1:1"), []
    for _ in range(2):
        found = sandbox.search.sensitivity(SCENE, vary=vary, keep=["y==a + 2 * b * c"], count=8,
                                           method=method, out=tmp_path)
        seen.append([vars(each) for each in found.influences["y"]])
        lines = (tmp_path / "rows" / "00000.jsonl").read_bytes().count(b"\n")
        seen.append(lines)
    assert seen[:2] == seen[2:]
    assert (tmp_path / "found.png").read_bytes().startswith(b"\x89PNG")
