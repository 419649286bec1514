"""``sandbox search`` from the command line, and searches in study files."""

import json

import pytest

import sandbox
from sandbox.cli.commands import invoke
from sandbox.errors import SceneError
from tests.sweeps.scenes import PUCK

STUDY = {"format": 1, "scene": PUCK, "vary": {"parameters.push": {"from": "1 N", "to": "6 N"}},
         "keep": {"v": "puck.vx", "x": "puck.x"}}
MEASURED = "time,x [mm]\n" + "".join(
    f"{t / 100},{1500 * (t / 100) ** 2 + (-1) ** t * 0.01}\n" for t in range(1, 10))
PUSH = ["--vary", "parameters.push=1 N:6 N"]


@pytest.fixture
def puck(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "puck.json").write_text(json.dumps(PUCK))
    return "puck.json"


@pytest.fixture
def written(tmp_path, monkeypatch):
    """Writes a study with a search; its name."""
    monkeypatch.chdir(tmp_path)

    def write(search, **more):
        (tmp_path / "study.json").write_text(json.dumps({**STUDY, **more, "search": search},
                                                        indent=1))
        return "study.json"

    return write


def test_a_threshold_and_its_files(puck, capsys):
    words = ["search", "threshold", puck, *PUSH, "--within", "0.1 N"]
    assert invoke(words) == 0
    fragment = capsys.readouterr().out
    assert "every expectation holds above parameters.push = 2.5" in fragment
    assert "half the step: the same" in fragment
    assert invoke([*words, "--json"]) == 0
    message = json.loads(capsys.readouterr().out)
    assert message["new"] == 0
    assert message["found"]["low"] < 2.5126 < message["found"]["high"]
    assert message["files"] == ["search.json", "table.csv", "table.parquet", "search.png"]
    assert message["directory"] == "searches/threshold/puck"


@pytest.mark.parametrize("words", [
    ["optimize", "--vary", "parameters.push=1 N:6 N:log", "--maximize", "v", "--where",
     "v < 0.3 m/s", "--runs", "6", "--sampler", "random"],
    ["sensitivity", *PUSH, "--vary", "parameters.m=1 kg:2 kg", "--method", "morris", "--count",
     "4"],
])
def test_search_json_has_a_study_that_asks_the_same(words, puck, capsys, tmp_path):
    kind, *rest = words
    out = ["--out", str(tmp_path / "out"), "--workers", "1"]
    assert invoke(["search", kind, puck, *rest, "--keep", "v=puck.vx", *out, "--quiet"]) == 0
    left = json.loads((tmp_path / "out" / "search.json").read_text())
    (tmp_path / "again.json").write_text(json.dumps(left["study"]))
    capsys.readouterr()
    assert invoke(["search", "again.json", *out, "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert again["new"] == 0
    assert again["found"] == left["found"]


def test_each_question_has_a_directory_of_its_own(puck, capsys):
    """A search that goes further continues in the same one."""
    def where(kind, *words, path="push=1 N:6 N"):
        assert invoke(["search", kind, puck, "--vary", f"parameters.{path}", "--keep", "v=puck.vx",
                       *words, "--json"]) == 0
        message = json.loads(capsys.readouterr().out)
        return message["directory"].rpartition("/")[2], message["new"]

    assert where("threshold", "--within", "1 N")[0] == "puck"
    assert where("threshold", "--within", "1 N", "--where", "v < 0.3 m/s")[0] == "puck-2"
    assert where("threshold", "--within", "1 N", path="push=2 N:6 N")[0] == "puck-3"
    assert where("threshold", "--within", "1 N") == ("puck", 0)
    assert where("threshold", "--within", "0.1 N")[0] == "puck"
    best = ("optimize", "--maximize", "v", "--sampler", "random")
    assert where(*best, "--runs", "4") == ("puck", 8)
    assert where(*best, "--runs", "6")[0] == "puck"
    assert where(*best, "--runs", "6", "--seed", "1")[0] == "puck-2"


def test_a_fit_reads_the_measurement_beside_its_file(written, capsys, tmp_path):
    (tmp_path / "x.csv").write_text(MEASURED)
    written({"fit": {"data": "x.csv", "match": {"x": "puck.x"}, "noise": {"x": "0.01 mm"}}})
    assert invoke(["search", "study.json", "--out", "out"]) == 0
    fragment = capsys.readouterr().out
    assert "noise of x: 1e-05" in fragment
    assert "fit.csv, found.png" in fragment
    parameter, = json.loads((tmp_path / "out/search.json").read_text())["found"]["parameters"]
    assert parameter["low"] < 3 < parameter["high"]


@pytest.mark.parametrize(("words", "fragment"), [
    ([], "Say which search: fit, optimize, sensitivity, threshold"),
    (["thresold", "puck.json"], "Did you mean 'threshold'?"),
    (["threshold", "puck.json"], "nothing is varied"),
    (["threshold", "puck.json", *PUSH, "--within", "1 mm"], "'mm' is a unit of length"),
    (["fit", "puck.json", "--vary", "parameters.push=1:6"], "--data: name the file"),
    (["fit", "puck.json", "--vary", "parameters.push=1:6", "--data", "no.csv", "--match", "x"],
     "not of the form column=quantity"),
    (["study.json", "--where", "v < 1"], "--where: study.json already defines this"),
    (["fit", "study.json"], "the study is a search of the kind threshold, not fit"),
    (["puck.json"], "puck.json is not a search"),
])
def test_wrong_command_lines_are_refused(puck, written, capsys, words, fragment, tmp_path):
    written({"threshold": {"where": "v < 0.3 m/s"}})
    assert invoke(["search", *words]) == 2
    error = capsys.readouterr().err
    assert fragment in error
    assert "Traceback" not in error
    assert not list((tmp_path / "searches").rglob("search.json"))


@pytest.mark.parametrize(("search", "more", "fragment"), [
    ({"bst": {}}, {}, "$.search.bst: unknown key 'bst'. Did you mean 'best'?"),
    ({"best": {"least": "v"}, "threshold": {}}, {}, "one search, not threshold and best"),
    ({"best": {"most": "vv"}}, {}, "$.search.best.most: no run keeps 'vv'; did you mean 'v'?"),
    ({"best": {"least": ["v"], "where": ["x > 1 m", "x > 1 N"]}}, {},
     "$.search.best.where[1]: 'x > 1 N': x is in m, and 'N' is a unit of force"),
    ({"fit": {"data": "none.csv"}}, {}, "$.search.fit.data: none.csv cannot be read"),
    ({"best": {"least": "v"}}, {"vary": {"parameters.push": {"from": "1 N", "to": "6 mm"}}},
     '$.vary["parameters.push"]: these are a force and a length'),
])
def test_mistakes_in_a_file_are_reported_with_their_line(written, search, more, fragment):
    with pytest.raises(SceneError) as caught:
        sandbox.search.study(written(search, **more))
    problem, = caught.value.problems
    assert fragment in str(problem)
    assert problem.line > 0
