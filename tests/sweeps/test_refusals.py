"""Wrong sweeps are refused with one message before anything runs."""

import json
import re
from pathlib import Path

import pytest

import sandbox
from sandbox.cli.commands import invoke
from sandbox.errors import SandboxError, SceneError
from sandbox.sweeps.plan import plan_of, study_file
from sandbox.sweeps.sweep import study_data
from tests.sweeps.scenes import PUCK


@pytest.mark.parametrize(("more", "words"), [
    ({"vary": {"bodies[puk].mass": "1:2:2"}}, "Did you mean 'puck'"),
    ({"vary": {"parameters.m": "-1:2:4"}}, "must be greater than 0"),
    ({"vary": {"parameters.push": "1 kg:2 kg:2"}}, "'kg' is a unit of mass, and 'push' is in 'N'"),
    ({"keep": ["a==b"]}, "unknown name 'b'"),
    ({"keep": ["id=puck.x"]}, "another column"),
    ({"set": {"parameters.push": 3}}, "values twice"),
    ({"keep": ["=a"]}, "'=a' names no result"),
])
def test_wrong_studies_are_refused_before_anything_runs(more, words):
    with pytest.raises(SceneError, match=re.escape(words)):
        plan_of(study_data(PUCK, **{"vary": {"parameters.push": "1:2:2"}, **more}))


def problems(**words):
    with pytest.raises(SceneError) as caught:
        plan_of(study_data(PUCK, **{"keep": ["v=puck.vx"], **words}))
    return caught.value.problems


@pytest.mark.parametrize("workers", [-1, 10**5])
def test_more_workers_than_processors_can_do_with(workers, tmp_path: Path):
    words = {"vary": {"parameters.push": "1 N:2 N"}, "keep": ["v=puck.vx"], "workers": workers,
             "out": tmp_path / "out"}
    with pytest.raises(SandboxError, match=f"cannot start {workers} worker processes .allowed: 1"):
        sandbox.sweep(PUCK, **words, design="random", count=2)
    with pytest.raises(SandboxError, match=f"cannot start {workers} worker processes .allowed: 1"):
        sandbox.search.threshold(PUCK, **words, where="v > 0.1")
    assert not (tmp_path / "out" / "rows").exists()


@pytest.mark.parametrize(("text", "fragment"), [
    ('{"scene": "x.json", "vary": {"p": [1, NaN]}}', "NaN is not a number"),
    ('{"scene": "x.json", "vary": ' + "[" * 60 + "]" * 60 + "}", "nested deeper"),
    ('{"vary": 1, "vary": 2}', "is repeated"),
    ("", "study.json"),
])
def test_a_study_that_cannot_be_read_says_why(text, fragment, tmp_path: Path, monkeypatch, capsys):
    """And not that it varies nothing."""
    monkeypatch.chdir(tmp_path)
    Path("study.json").write_text(text)
    with pytest.raises(SceneError):
        study_file("study.json")
    for words in (["sweep"], ["search", "threshold"]):
        assert invoke([*words, "study.json"]) == 2
        reported = capsys.readouterr().err
        assert fragment in reported
        assert "nothing is varied" not in reported


@pytest.mark.parametrize(("window", "fragment"), [
    ("last 9 s", "the window is the last 9 s, the run has 0.1 s"),
    ("0.05 : 0.2", "the window ends at 0.2 s, the run at 0.1 s"),
])
def test_a_window_that_no_run_has_is_refused_before_anything_runs(window, fragment):
    push, keep = {"parameters.push": [1, 2]}, [f"v=mean puck.vx over {window}"]
    problem, = problems(vary=push, keep=keep)
    assert (problem.message, problem.path) == (fragment, '$.keep["v"]')
    problem, = problems(vary={"run.duration": ["50 ms", "100 ms"]}, keep=keep)
    assert problem.message == fragment
    assert [*plan_of(study_data(PUCK, keep=["*.vx"], vary=push)).job.keep] == ["puck.vx"]
    for words in ({"vary": {"run.duration": ["50 ms", "9 s", "1 s"]}},
                  {"vary": push, "set": {"run.duration": "9 s"}},
                  {"vary": {"parameters.push": [1, 90]}, "set": {"run.duration": "=push / 10"}}):
        assert len(plan_of(study_data(PUCK, keep=keep, **words))) in (2, 3)


@pytest.mark.parametrize("design", [None, "sobol"])
def test_a_count_that_a_design_would_not_use_is_refused(design):
    """Not dropped: who writes four values of one path means to have four."""
    over = {"parameters.push": "1:4:4", "parameters.m": "normal(0.5 kg, 0.05 kg)"}
    problem, = problems(vary=over, design=design, count=8)
    assert problem.message == (
        "'parameters.push' has its own count 4, but a design "
        f"'{design or 'random'}' chooses 8 points for all paths together")
    assert "a group in a study file" in problem.allowed
    one, other = ({path: values} for path, values in over.items())
    assert len(plan_of(study_data(PUCK, keep=["v=puck.vx"], vary=[
        {"over": one}, {"over": other, "design": design, "count": 8}]))) == 32


@pytest.mark.parametrize(("words", "reported"), [
    (["sweep", "--vary", "parameters.push=1:4:x"], "--vary parameters.push: 'x' is not"),
    (["sweep", "--vary", "parameters.push=1:4:3", "--keep", "v=puck.vz"],
     "--keep v: no run has the quantity 'puck.vz'"),
    (["search", "threshold", "--vary", "parameters.push=1:x"],
     "--vary parameters.push: 'x' is not a number with a unit"),
    (["sweep", "--vary", "parameters.push=1:4:3", "--set", "run.stp=1"],
     "puck.json:$.run.stp: unknown key"),
])
def test_command_line_errors_quote_the_option(tmp_path: Path, monkeypatch, capsys, words, reported):
    monkeypatch.chdir(tmp_path)
    Path("puck.json").write_text(json.dumps(PUCK))
    place = 1 if words[0] == "sweep" else 2
    assert invoke([*words[:place], "puck.json", *words[place:]]) == 2
    fragment, page = capsys.readouterr().err.splitlines()
    assert fragment.startswith(reported)
    assert page.startswith("see 'sandbox explain ")


def test_failed_expectations_are_counted(tmp_path, capsys):
    scene = tmp_path / "puck.json"
    scene.write_text(json.dumps(PUCK))
    words = ["sweep", str(scene), "--vary", "parameters.push=1, 2, 3, 4", "--workers", "1",
             "--out", str(tmp_path / "out")]
    assert invoke(words) == 0
    assert ("2 of 4 runs miss expectations: puck.vx (2)\n") in capsys.readouterr().out
    assert invoke([*words, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["missed"] == 2
