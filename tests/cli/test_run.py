"""``sandbox run``: files, exit codes, and what it says, from the user's side."""

from __future__ import annotations

import json
import re

import pytest

from sandbox.cli.commands import invoke
from sandbox.cli.console import COMPILING, NOT_CACHED, Console, monitored
from sandbox.cli.options import safe_name
from sandbox.engine.compiling import report_began, report_compiled
from sandbox.engine.entry_points import CalledFromPython
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording

NUMBERS = {"run.json", "run.npz", "contacts.csv", "tendons.csv", "joints.csv", "bodies.csv",
           "drives.csv"}
"""The files of the contract."""


def test_run_writes_the_files_of_the_contract(sandbox, scene, tmp_path):
    output = sandbox("run", scene(), "--no-render")
    assert (output.code, output.err) == (0, "")
    directory = tmp_path / "renders" / "ball"
    assert {path.name for path in directory.iterdir()} >= NUMBERS
    assert not list(directory.glob("*.gif"))
    assert Recording.load(directory).complete
    row, count, checks, place = output.out.splitlines()[1:]
    assert row.split()[0:2] == ["ball.contact.fy", "mean"]
    assert row.split()[-2:] == ["N", "pass"]
    assert "0.097119 to 0.099081" in row  # m g -+ 1 %
    assert count == "1 of 1 expectations passed"
    assert re.fullmatch(r"\d+ checks passed; --audit lists them", checks)
    assert place.startswith("Results in renders/ball: run.json, ")
    output = sandbox("run", scene(), "--no-render", "--audit")
    assert "is F = m a for every body?" in output.out
    kept = json.loads((directory / "run.json").read_text())
    assert {"momentum.force", "energy.created"} <= {f["name"] for f in kept["audit"]}
    output = sandbox("run", scene(), "--no-render", "--quiet")
    assert (output.code, output.out, output.err) == (0, "", "")


@pytest.mark.parametrize(("name", "directory"), [
    ("my hand", "my_hand"), ("../../elsewhere", "elsewhere"), ("/etc", "etc"), ("..", "scene"),
    ("v1.2-b", "v1.2-b"),
])
def test_a_name_stays_below_renders(name, directory):
    assert safe_name(name) == directory


def test_json_is_one_object_on_a_clean_stdout(sandbox, scene):
    output = sandbox("run", scene(), "--no-render", "--json")
    result = json.loads(output.out)
    assert (output.code, result["exit_code"], result["status"]) == (0, 0, "done")
    assert result["complete"] is True
    assert set(result["files"]) >= NUMBERS
    verdict, = result["expectations"]
    assert verdict["ok"] is True
    assert verdict["value"] == pytest.approx(0.0981, rel=0.01)
    assert result["wall_s"]["simulate"] > 0
    output = sandbox("run", scene(run={"stp": 1, "duration": -1}), "--json")
    result = json.loads(output.out)
    assert (output.code, result["exit_code"], result["status"]) == (2, 2, "input")
    assert {error["path"] for error in result["errors"]} == {"$.run.stp", "$.run.duration"}
    assert all(error["line"] == 1 and error["file"].endswith("ball.json")
               for error in result["errors"])


def test_pictures_are_drawn_by_default_and_old_ones_do_not_stay(sandbox, scene, tmp_path):
    directory = tmp_path / "out"
    output = sandbox("run", scene(), "--out", directory)
    assert output.code == 0, output.err
    assert (directory / "animation.gif").read_bytes().startswith(b"GIF89a")
    assert sandbox("render", directory, "--out", directory / "frames").code == 0
    assert sorted((directory / "frames").glob("*.png"))
    assert sandbox("run", scene(), "--out", directory, "--no-render").code == 0
    assert not (directory / "animation.gif").exists()
    assert not (directory / "frames").exists()


GAIN = 4 * 0.01 / 5e-4**2
"""Of a controller [N/m]: a spring of h w = 2 on the ball."""


def runaway(scene, gain=1.1 * GAIN, **run):
    """A controller so strong that what it undoes in a step is more than there was.

    It acts on the pose before the step that it pushes in: from h w = 1 on, let alone above 2, each
    push finds the ball further on the other side.
    """
    side = {"type": "force", "name": "side", "body": "ball", "direction": [1, 0], "value": 0}
    law = {"type": "feedback", "name": "law", "writes": "side", "rate": 2000,
           "value": f"={gain} * (0.001 - ball.x)"}
    return scene(drives=[side], controllers=[law], run={"duration": 1, **run})


def test_a_scene_that_blows_up_exits_3_and_keeps_what_was_recorded(sandbox, scene, tmp_path):
    output = sandbox("run", runaway(scene), "--out", tmp_path / "out")
    assert output.code == 3
    assert "diverged at t = " in output.err
    assert "ball" in output.err.splitlines()[-1]
    assert "law" in output.err.splitlines()[-1]
    assert not (tmp_path / "out" / "run.json").exists()
    assert Recording.load(tmp_path / "out").complete is False
    assert json.loads((tmp_path / "out" / "run.incomplete.json").read_text())["complete"] is False


@pytest.mark.parametrize(("place", "why"), [
    ("file", "it is a file"), ("file/below", "Not a directory"),
    ("/proc/nowhere", "No such file or directory"), ("link", "it is a broken link"),
])
def test_an_unwritable_directory_is_refused_before_simulating(
    sandbox, scene, tmp_path, monkeypatch, place, why,
):
    def must_not_run(*arguments, **options):
        raise AssertionError("simulated before the directory was tried")

    monkeypatch.setattr("sandbox.cli.run.simulate", must_not_run)
    (tmp_path / "file").write_text("in the way")
    (tmp_path / "link").symlink_to("nowhere")
    output = sandbox("run", scene(), "--out", place)
    assert output.code == 2
    assert f"cannot write into {place}: {why}" in output.err
    assert len(output.err.splitlines()) == 1


def test_a_fault_of_sandbox_is_one_line_and_exits_70(sandbox, scene, monkeypatch):
    def broken(*arguments, **options):
        raise ZeroDivisionError("in the engine\nwith more lines")

    monkeypatch.setattr("sandbox.cli.run.simulate", broken)
    output = sandbox("run", scene(), "--no-render")
    assert output.code == 70
    assert "ZeroDivisionError: in the engine" in output.err
    assert len(output.err.splitlines()) == 1


@pytest.mark.parametrize("where", [
    "sandbox.scene.read.load.read_scene", "sandbox.engine.inspect.look_over",
    "sandbox.cli.run.save_data", "sandbox.picture.film.render",
    "sandbox.cli.run.save_summary",
])
def test_ctrl_c_at_any_moment_exits_130_and_leaves_no_sign_of_completion(
    sandbox, scene, monkeypatch, tmp_path, where,
):
    def interrupted(*arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(where, interrupted)
    output = sandbox("run", scene(), "--out", "out")
    assert output.code == 130
    assert output.err.splitlines()[-1].startswith("error: interrupted")
    assert not (tmp_path / "out" / "run.json").exists()


@pytest.mark.parametrize(("where", "stop"), [
    ("sandbox.picture.film.render", KeyboardInterrupt),
    ("sandbox.cli.run.audit", KeyboardInterrupt),
    ("sandbox.picture.film.render", MemoryError)])
def test_a_stop_while_drawing_or_auditing_keeps_the_old_run(
    sandbox, scene, monkeypatch, tmp_path, where, stop,
):
    def stopped(*arguments, **options):
        raise stop

    out = tmp_path / "out"
    assert sandbox("run", scene(title="old"), "--out", out).code == 0
    before = {path: path.read_bytes() for path in out.iterdir()}
    monkeypatch.setattr(where, stopped)
    output = sandbox("run", scene(title="new"), "--out", out)
    assert "marked incomplete; the run that was in" in output.err
    assert {path: path.read_bytes() for path in out.iterdir() if path.is_file()} == before
    output = sandbox("run", scene(title="new"), "--out", tmp_path / "none")
    assert output.err.count("marked incomplete") == 1
    assert output.code == (130 if stop is KeyboardInterrupt else 2)
    for place in (out / "incomplete", tmp_path / "none"):
        kept = Recording.load(place)
        assert (kept.complete, len(kept), kept.mechanism.title) == (False, 50, "new")
        assert json.loads((place / "run.incomplete.json").read_text())["complete"] is False
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    assert sandbox("run", scene(title="newer"), "--out", out).code == 0
    assert {path.name for path in out.iterdir()} == {path.name for path in before}


def test_a_new_run_removes_pictures_of_the_old_one(sandbox, scene, tmp_path):
    assert sandbox("run", scene(), "--no-render", "--out", "out").code == 0
    for words in (("render", "out", "--out", "out/end.png"), ("bounds", "out"),
                  ("plot", "out", "ball.y"), ("plot", "out", "ball.y", "--out", "out/y.svg"),
                  ("plot", "out", "ball.y", "--out", "elsewhere.png")):
        assert sandbox(*words).code == 0
    made = [tmp_path / "out" / name for name in
            ("end.png", "contact_bounds.csv", "plot.png", "y.svg")]
    assert all(path.exists() for path in made)
    (tmp_path / "out" / "mine.png").touch()
    assert sandbox("run", scene(), "--no-render", "--out", "out").code == 0
    assert not any(path.exists() for path in made)
    assert (tmp_path / "out" / "mine.png").exists()
    assert (tmp_path / "elsewhere.png").exists()


def test_compilation_is_announced_once(monkeypatch, scene, capfd, tmp_path):
    """Before the first compilation and after the last one; not with --quiet."""
    monkeypatch.chdir(tmp_path)

    def compiles(*arguments, **options):
        report_began()
        report_began()
        return simulate(*arguments, **options)

    monkeypatch.setattr("sandbox.cli.run.simulate", compiles)
    for words, announced in (([], 1), (["--json"], 1), (["--quiet"], 0)):
        capfd.readouterr()
        assert invoke(["run", str(scene()), "--no-render", *words]) == 0
        err = capfd.readouterr().err
        assert err.count(COMPILING) == err.count("Compiled in") == announced
    monkeypatch.setattr(CalledFromPython, "cached", False)
    with monitored(Console()):
        report_began()
        report_compiled(12.4)
    assert capfd.readouterr().err.splitlines() == [NOT_CACHED, "Compiled in 12 s"]
