"""Searches that stand in study files."""

import json
from pathlib import Path

import jsonschema
import pytest

import sandbox
from sandbox.cli.entry import invoke
from sandbox.errors import SceneError
from sandbox.scene.read.paths import parse_path
from sandbox.sweeps.schema import study_schema
from tests.sweeps.scenes import PUCK

SPAN = {"from": "1 N", "to": "6 N"}
STUDY = {"format": 1, "scene": PUCK, "vary": {"parameters.push": SPAN},
         "keep": {"v": "puck.vx", "x": "puck.x"}}
MEASURED = "time,x [mm]\n" + "".join(
    f"{t / 100},{1500 * (t / 100) ** 2 + (-1) ** t * 0.01}\n" for t in range(1, 10))


@pytest.fixture
def written(tmp_path, monkeypatch):
    """Writes a study with a search, and has its name."""
    monkeypatch.chdir(tmp_path)

    def write(search, **more):
        (tmp_path / "study.json").write_text(json.dumps({**STUDY, **more, "search": search},
                                                        indent=1))
        return "study.json"

    return write


@pytest.mark.parametrize(("search", "same"), [
    ({"threshold": {"where": "v < 0.3 m/s", "within": "0.1 N"}},
     lambda: sandbox.search.threshold(PUCK, vary={"parameters.push": "1 N:6 N"}, within=0.1,
                                      keep=["v=puck.vx"], where="v < 0.3 m/s")),
    ({"best": {"least": ["v"], "where": ["x > 10 mm"], "runs": 20, "sampler": "tpe", "seed": 4}},
     lambda: sandbox.search.best(PUCK, vary={"parameters.push": "1 N:6 N"}, runs=20, seed=4,
                                 keep=["v=puck.vx", "x=puck.x"], least="v", where="x > 10 mm")),
    ({"robustness": {"holds": "v < 0.3 m/s", "coarse": 4, "probes": 2, "boundary": "3 - push"}},
     lambda: sandbox.search.robustness(PUCK, over={"parameters.push": "1 N:6 N"}, coarse=4,
                                       keep=["v=puck.vx"], holds="v < 0.3 m/s", probes=2,
                                       boundary="3 - push")),
])
def test_a_file_asks_what_words_ask(written, search, same):
    assert sandbox.search.study(written(search)).lines == same().lines


def test_a_fit_reads_data_beside_its_file(written, tmp_path):
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "x.csv").write_text(MEASURED)
    (tmp_path / written({"fit": {"data": "x.csv", "match": {"x": "puck.x"},
                                 "noise": {"x": "0.01 mm"}}})).rename(folder / "study.json")
    found = sandbox.search.study(folder / "study.json")
    assert found["parameters.push"].low < 3 < found["parameters.push"].high
    assert found.noise["x"] == pytest.approx(1e-5)


def test_the_command_needs_no_word_for_it(written, capsys, tmp_path):
    written({"threshold": {"where": "v < 0.3 m/s"}})
    assert invoke(["search", "study.json", "--within", "0.1 N", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["search"] == "threshold"
    assert told["found"]["low"] < 3.0 < told["found"]["high"]
    assert told["found"]["high"] - told["found"]["low"] < 0.1
    assert (tmp_path / "searches" / "threshold" / "study" / "search.json").is_file()
    assert invoke(["search", "threshold", "study.json", "--within", "0.1 N", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["new"] == 0


@pytest.mark.parametrize(("words", "said"), [
    (["search", "study.json", "--where", "v < 1"], "--where: study.json says this itself"),
    (["search", "study.json", "--vary", "parameters.m=1:2"], "--vary: study.json is a study file"),
    (["search", "fit", "study.json"],
     "$.search.threshold: the study is a search of the kind threshold, not fit"),
    (["sweep", "study.json"], "$.search: the study is a search"),
    (["search", "none.json"], "no such file"),
    (["search", "fit", "scene.json", "--vary", "parameters.push=1:2"], "--data: say which file"),
    (["search", "scene.json"], "scene.json does not say which search it is"),
])
def test_what_does_not_agree_with_the_file_is_refused(written, capsys, tmp_path, words, said):
    written({"threshold": {"where": "v < 0.3 m/s"}})
    (tmp_path / "scene.json").write_text(json.dumps(PUCK))
    assert invoke(words) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "searches").exists()


@pytest.mark.parametrize(("search", "more", "said"), [
    ({"bst": {}}, {}, "$.search.bst: unknown key 'bst'. Did you mean 'best'?"),
    ({}, {}, "$.search: a study is one search. Allowed: threshold, fit, best, sensitivity, "
     "robustness."),
    ({"best": {"least": "v"}, "threshold": {}}, {}, "one search, not threshold and best"),
    ({"best": {"least": ["v"], "sampler": "cmae"}}, {}, "$.search.best.sampler: 'cmae' is not"),
    ({"best": {}}, {}, "$.search.best: say what is to be least or most"),
    ({"best": {"most": "vv"}}, {}, "$.search.best.most: no run keeps 'vv'; did you mean 'v'?"),
    ({"best": {"least": ["v"], "where": ["x > 1 m", "x > 1 N"]}}, {},
     "$.search.best.where[1]: 'x > 1 N': x is in m, and 'N' is a unit of force"),
    ({"best": {"least": "v", "sampler": "cmaes"}}, {"vary": {"parameters.push": ["1 N", "2 N"]}},
     "$.search.best: cmaes looks for one goal over ranges"),
    ({"threshold": {"where": "v > 1", "within": "1 mm"}}, {},
     "$.search.threshold: 'within' of parameters.push is in N, and 'mm' is a unit of length"),
    ({"threshold": {"within": "-1 N"}}, {}, "$.search.threshold.within: must be greater than 0"),
    ({"sensitivity": {"count": 10}}, {}, "a power of 2, not 10. Allowed: 8, 16."),
    ({"fit": {}}, {}, "$.search.fit: 'data' is missing"),
    ({"robustness": {"holds": "vv < 1"}}, {}, "$.search.robustness.holds: no run keeps 'vv'"),
    ({"robustness": {"holds": "v < 1", "boundary": "pusch"}}, {},
     "$.search.robustness: the closed form: unknown name 'pusch'"),
    ({"fit": {"data": "no.csv"}}, {}, "$.search.fit.data: there is no file no.csv"),
    ({"best": {"least": "v"}}, {"vary": [{"over": {"parameters.pusch": SPAN}}]},
     '$.vary[0].over["parameters.pusch"]: cannot set'),
    ({"best": {"least": "v"}}, {"vary": {"parameters.push": {"from": "1 N", "to": "6 mm"}}},
     '$.vary["parameters.push"]: these are a force and a length'),
])
def test_what_is_wrong_is_told_with_its_place(written, search, more, said):
    with pytest.raises(SceneError) as caught:
        sandbox.search.study(written(search, **more))
    problem, = caught.value.problems
    assert said in str(problem)
    lines = Path("study.json").read_text().splitlines()[:problem.line]
    key = next(step for step in reversed(parse_path(problem.path)) if isinstance(step, str))
    assert f'"{key}"' in "".join(lines[-3:])  # an entry of a list stands a line or two below


def test_all_that_is_wrong_is_told_at_once(written):
    with pytest.raises(SceneError) as caught:
        sandbox.search.study(written({"best": {"least": ["a", "v"], "where": ["b > 1"]}}))
    assert {each.path for each in caught.value.problems} == {
        "$.search.best.least[0]", "$.search.best.where[0]"}


def test_the_schema_knows_the_words():
    validator = jsonschema.Draft202012Validator(study_schema())
    good = {**STUDY, "search": {"best": {"least": "v", "where": ["x > 1 m"], "sampler": "tpe"}}}
    assert list(validator.iter_errors(good)) == []
    assert list(validator.iter_errors({**STUDY, "search": {
        "threshold": {"within": "0.1 N"}}})) == []
    for search in ({"bst": {}}, {"best": {"sampler": "cmae", "least": "v"}}, {"fit": {}}):
        assert list(validator.iter_errors({**STUDY, "search": search}))
