"""What only a process of its own can show: signals, pipes, full disks, start-up time."""

from __future__ import annotations

import json
import os
import pty
import re
import resource
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import sandbox
from sandbox.recording.recording import Recording

from .conftest import PAGES

COMMAND = [sys.executable, "-m", "sandbox"]
HOME = str(Path(sandbox.__file__).parents[1])
ENVIRONMENT = {**os.environ, "PYTHONPATH": HOME}
"""A process runs the same sandbox as the tests, wherever it starts."""


def run(*words: object, **options) -> subprocess.CompletedProcess[str]:
    done = subprocess.run([*COMMAND, *map(str, words)], capture_output=True, text=True,
                          timeout=60, env=ENVIRONMENT, **options)
    assert "Traceback" not in done.stdout + done.stderr
    return done


def slow(scene) -> Path:
    """A run of 8 million steps, with few samples; something pushes, so that nothing rests."""
    push = {"type": "force", "name": "push", "body": "ball", "direction": [1, 0],
            "value": "=1e-4 * sin(7 * t)"}
    return scene(run={"duration": 200, "step": 2.5e-5, "sample_rate": 100}, view={"speed": 10},
                 expect=[], drives=[push])


def interrupted(words: list[str], directory: Path) -> tuple[int, str, str]:
    """Run with a terminal for stderr, send Ctrl-C once the bar is at 1 %; code, stdout, stderr."""
    terminal, end = pty.openpty()
    process = subprocess.Popen([*COMMAND, *words], stdout=subprocess.PIPE, stderr=end,
                               cwd=directory, text=True, env=ENVIRONMENT)
    os.close(end)
    seen = out = ""
    with process:
        while piece := _read(terminal):
            seen += piece
            if re.search(r"[1-9]%", seen) and process.returncode is None:
                process.send_signal(signal.SIGINT)
                out, _ = process.communicate(timeout=20)
    os.close(terminal)
    return process.returncode, out, seen


def _read(terminal: int) -> str:
    """What stands in the terminal; empty once the other end is closed."""
    try:
        return os.read(terminal, 4096).decode()
    except OSError:
        return ""


def test_ctrl_c_keeps_what_was_recorded_and_marks_it_incomplete(scene, tmp_path):
    code, out, err = interrupted(["run", str(slow(scene)), "--out", "kept", "--no-render",
                                  "--limit", "steps=9e6"],
                                 tmp_path)
    assert code == 130
    assert "Traceback" not in out + err
    assert "Simulating  [" in err
    assert "interrupted at t = " in err
    recording = Recording.load(tmp_path / "kept")
    assert not recording.complete
    assert 0 < recording.time[-1] < 200
    assert not (tmp_path / "kept" / "run.json").exists()
    summary = json.loads((tmp_path / "kept" / "run.incomplete.json").read_text())
    assert summary["complete"] is False


def test_a_full_disk_leaves_no_complete_run_and_the_file_that_was_there(scene, tmp_path):
    def small_disk() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (8_000, 8_000))

    (tmp_path / "out").write_text("old")
    for words in (("run", scene(run={"duration": 1}, expect=[]), "--no-render", "--out", "full"),
                  ("export", "adaptive_grasp", "--out", "out")):
        done = run(*words, cwd=tmp_path, preexec_fn=small_disk)
        assert done.returncode == 2
        last = PAGES.sub("", done.stderr).splitlines()[-1]
        assert re.search(r"cannot write (full/|out: ).*too large", last, re.IGNORECASE)
    assert not (tmp_path / "full" / "run.json").exists()
    assert not list((tmp_path / "full").glob("*.part"))
    assert (tmp_path / "out").read_text() == "old"


@pytest.mark.parametrize("within", [
    "import pressed",  # a module that turns what comes in it into an error of its own
    "exec('import os; os.kill(os.getpid(), 2)')",  # after it Python would end by the signal
    "class Gone:\n    def __del__(self): os.kill(os.getpid(), 2)\nGone()"])  # where it is lost
def test_ctrl_c_exits_130_wherever_it_comes(tmp_path, within):
    (tmp_path / "pressed.py").write_text(
        "import os\ntry:\n    os.kill(os.getpid(), 2)\n"
        "except BaseException as error:\n    raise ImportError('broken') from None\n")
    work = f"import os, time\n{within}\ntime.sleep(1)"
    command = ("import sandbox.cli, sandbox.cli.commands as entry; entry.commands.main = "
               f"lambda *a, **k: exec({work!r}, {{}}); sandbox.cli.main([])")
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True,
                          timeout=60, env=ENVIRONMENT, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (130, "error: interrupted\n")


@pytest.mark.parametrize("words", [
    ["run", "single_finger", "--set", "run.duration=0.01", "--no-render", "--json"],
    ["check", "nothing", "--json"]])
def test_a_full_disk_behind_stdout_is_reported_on_stderr(words, tmp_path):
    """With ``--json`` too, which has no other way; 1 would mean that an expectation failed."""
    with Path("/dev/full").open("w") as full:
        done = subprocess.run([*COMMAND, *words], stdout=full, stderr=subprocess.PIPE, text=True,
                              timeout=60, env=ENVIRONMENT, cwd=tmp_path)
    assert done.returncode == 2
    assert PAGES.sub("", done.stderr).splitlines()[-1] == (
        "error: cannot write to stdout: No space left on device")


def test_json_is_json_in_any_encoding(scene):
    done = subprocess.run([*COMMAND, "check", str(scene(**{"Grüße": 1})), "--json"],
                          capture_output=True, timeout=60,
                          env={**ENVIRONMENT, "PYTHONIOENCODING": "ascii"})
    assert done.returncode == 2
    assert "Grüße" in json.loads(done.stdout)["scenes"][0]["errors"][0]["message"]
