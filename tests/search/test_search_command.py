"""``sandbox search`` from the command line."""

import json

import pytest

from sandbox.cli.entry import invoke
from tests.sweeps.scenes import PUCK


@pytest.fixture
def puck(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "puck.json").write_text(json.dumps(PUCK))
    return "puck.json"


def test_a_threshold_is_told_and_written(puck, capsys, tmp_path):
    words = ["search", "threshold", puck, "--vary", "parameters.push=1 N:6 N", "--within", "0.1 N"]
    assert invoke(words) == 0
    said = capsys.readouterr().out
    assert "what the scene expects holds above parameters.push = 2.5" in said
    assert "half the step: the same" in said
    assert invoke([*words, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["new"] == 0
    assert told["found"]["low"] < 2.5126 < told["found"]["high"]
    assert told["files"] == ["search.json", "table.csv", "table.parquet", "search.png"]
    assert (tmp_path / "searches" / "threshold" / "puck" / "search.png").is_file()


@pytest.mark.parametrize("words", [
    ["threshold", "--vary", "parameters.push=1 N:6 N",
     "--vary", "parameters.m=normal(1 kg, 0.1 kg)", "--where", "v < 0.3 m/s",
     "--runs", "8", "--seed", "3", "--within", "2 N"],
    ["best", "--vary", "parameters.push=1 N:6 N:log", "--most", "v", "--where", "v < 0.3 m/s",
     "--runs", "6", "--sampler", "random"],
    ["sensitivity", "--vary", "parameters.push=1 N:6 N", "--vary", "parameters.m=1 kg:2 kg",
     "--method", "morris", "--count", "4"],
])
def test_what_was_asked_is_a_study_that_asks_it_again(words, puck, capsys, tmp_path):
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


def test_each_question_has_a_directory_of_its_own(puck, capsys, tmp_path):
    """More of the same goes on in the same one, as after Ctrl-C, before anything was found."""
    def where(*words, kind="threshold", path="push=1 N:6 N"):
        assert invoke(["search", kind, puck, "--vary", f"parameters.{path}", "--keep", "v=puck.vx",
                       *words, "--json"]) == 0
        told = json.loads(capsys.readouterr().out)
        return told["directory"].rpartition("/")[2], told["new"]

    assert invoke(["search", "threshold", puck, "--vary", "parameters.push=1 mm:6 mm"]) == 2
    capsys.readouterr()
    assert where("--within", "1 N")[0] == "puck"
    assert where("--within", "1 N", "--where", "v < 0.3 m/s")[0] == "puck-2"
    assert where("--within", "1 N", path="push=2 N:6 N")[0] == "puck-3"
    (tmp_path / "searches" / "threshold" / "puck" / "search.json").unlink()
    assert where("--within", "1 N") == ("puck", 0)
    assert where("--within", "0.1 N")[0] == "puck"
    assert where("--within", "0.1 N", "--where", "v < 0.3 m/s")[0] == "puck-2"
    best = ("--most", "v", "--sampler", "random")
    assert where(*best, "--runs", "4", kind="best")[0] == "puck"
    assert where(*best, "--runs", "6", kind="best")[0] == "puck"
    assert where(*best, "--runs", "6", "--seed", "1", kind="best")[0] == "puck-2"


def test_a_fit_reads_what_was_measured(puck, capsys, tmp_path):
    (tmp_path / "x.csv").write_text("time,x [mm]\n" + "".join(
        f"{t / 100},{1500 * (t / 100) ** 2 + (-1) ** t * 0.01}\n" for t in range(1, 10)))
    words = ["search", "fit", puck, "--data", "x.csv", "--match", "x=puck.x", "--vary",
             "parameters.push=1 N:6 N"]
    assert invoke([*words, "--json"]) == 0
    parameter, = json.loads(capsys.readouterr().out)["found"]["parameters"]
    assert parameter["low"] < 3 < parameter["high"]
    assert invoke([*words, "--noise", "x=0.01 mm"]) == 0
    said = capsys.readouterr().out
    assert "noise of x: 1e-05" in said
    assert "fit.csv, found.png" in said


@pytest.mark.parametrize(("words", "said"), [
    ([], "Say which search: best, fit, robustness, sensitivity, threshold"),
    (["thresold", "puck.json"], "Did you mean 'threshold'?"),
    (["threshold", "puck.json"], "say what is varied"),
    (["threshold", "puck.json", "--vary", "parameters.push=3:6"], "has no threshold at its ends"),
    (["threshold", "puck.json", "--vary", "parameters.push=1:6", "--within", "x"], "'x'"),
    (["best", "puck.json", "--vary", "parameters.push=1:6"], "least or most"),
    (["fit", "puck.json", "--vary", "parameters.push=1:6", "--data", "no.csv"], "cannot be read"),
    (["fit", "puck.json", "--vary", "parameters.push=1:6", "--data", "no.csv", "--match", "x"],
     "not of the form name=value"),
    (["sensitivity", "puck.json", "--vary", "parameters.push=1:6"], "two paths or more"),
])
def test_what_is_wrong_is_told_in_a_line(puck, capsys, words, said):
    assert invoke(["search", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert "Traceback" not in error
