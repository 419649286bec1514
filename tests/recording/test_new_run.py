"""One writer a directory, and the old run whole until the new one is."""

from __future__ import annotations

import json
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from sandbox.errors import OutputError
from sandbox.recording.new_run import NewRun, writing
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Status

from .sample import recording

TESTS = Path(__file__).parents[1]


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def contents(folder):
    return {str(path.relative_to(folder)): path.read_bytes()
            for path in sorted(folder.rglob("*")) if path.is_file()}


def worker(folder, body):
    """A process of its own that has a recording ``run`` titled 'new' and the path ``folder``."""
    script = ("import os, pathlib, signal, sys, threading, time\n"
              f"sys.path.insert(0, {str(TESTS)!r})\n"
              "from recording.sample import recording\n"
              "from sandbox.errors import OutputError\n"
              "from sandbox.recording import new_run, store\n"
              f"folder = pathlib.Path({str(folder)!r})\n"
              "run = recording(title='new')\n" + body)
    return subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


def finish(process):
    out, err = process.communicate(timeout=60)
    return process.returncode, out, err


def test_a_second_writer_is_told_and_the_first_is_not_disturbed(tmp_path):
    body = ("with new_run.writing(folder) as new:\n"
            "    print('here', flush=True)\n"
            "    time.sleep(1.5)\n"
            "run.save(folder)\n")
    process = worker(tmp_path, body)
    assert process.stdout.readline() == "here\n"
    with pytest.raises(OutputError, match=f"another run is being written into {tmp_path}: wait"):
        recording().save(tmp_path)
    assert finish(process) == (0, "", "")
    assert Recording.load(tmp_path).mechanism.title == "new"
    recording().save(tmp_path)
    assert Recording.load(tmp_path).mechanism.title == "A sample"


MOVES = 24
"""More than the system calls that change a directory in a swap."""


def killed_at(folder, call):
    """A save that is killed at its n-th change of names; the process's exit code."""
    body = ("count = 0\n"
            "def counted(event, arguments):\n"
            "    global count\n"
            "    if event in ('os.rename', 'os.remove', 'os.rmdir') and moving:\n"
            "        count += 1\n"
            f"        if count == {call}: os.kill(os.getpid(), signal.SIGKILL)\n"
            "moving = False\n"
            "original = new_run.NewRun._move\n"
            "def move(*arguments):\n"
            "    global moving\n"
            "    moving = True\n"
            "    original(*arguments)\n"
            "    moving = False\n"
            "new_run.NewRun._move = move\n"
            "sys.addaudithook(counted)\n"
            "run.save(folder)\n")
    return finish(worker(folder, body))[0]


@pytest.mark.nightly
def test_a_swap_killed_at_any_move_is_whole_or_marked(tmp_path):
    recording(title="old").save(tmp_path / "old")
    recording(title="new").save(tmp_path / "new")
    whole = {which: contents(tmp_path / which) for which in ("old", "new")}
    seen = set()
    for call in range(1, MOVES, 2):
        folder = tmp_path / "run"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(tmp_path / "old", folder)
        code = killed_at(folder, call)
        if (folder / "run.json").exists():
            found = {name: data for name, data in contents(folder).items()
                     if not name.startswith(".") and name != "run.incomplete.json"}
            which = Recording.load(folder).mechanism.title
            assert without_walls(found) == without_walls(whole[which]), call
        else:
            which = "marked"
            assert json.loads((folder / "run.incomplete.json").read_text())["complete"] is False
            assert Recording.load(folder).info.status is Status.UNFINISHED
        seen.add(which)
        if code == 0:
            break
        recording(title="next").save(folder)
        assert names(folder) == names(tmp_path / "old")
    assert code == 0
    assert seen == {"old", "marked", "new"}


def without_walls(files):
    said = json.loads(files["run.json"])
    del said["wall_s"]
    return {**files, "run.json": said}


def test_ctrl_c_in_the_swap_does_not_stop_it(tmp_path):
    recording(title="old").save(tmp_path)
    body = ("flush = new_run.flush\n"
            "def slow(path):\n"
            "    time.sleep(0.02)\n"
            "    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:\n"
            "        os.kill(os.getpid(), signal.SIGINT)\n"
            "    flush(path)\n"
            "new_run.flush = slow\n"
            "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
            "try:\n    run.save(folder)\n"
            "except KeyboardInterrupt:\n    print('stopped')\n")
    code, out, _ = finish(worker(tmp_path, body))
    assert (code, out) == (0, "stopped\n")
    again = Recording.load(tmp_path)
    assert (again.complete, again.mechanism.title) == (True, "new")
    assert "run.incomplete.json" not in names(tmp_path)


def test_a_killed_save_leaves_the_old_run_and_what_the_next_one_clears(tmp_path):
    recording(title="old").save(tmp_path)
    before = contents(tmp_path)
    body = ("store.contact_rows = lambda run: os.kill(os.getpid(), signal.SIGKILL)\n"
            "run.save(folder)\n")
    assert finish(worker(tmp_path, body))[0] == -signal.SIGKILL
    left = [name for name in names(tmp_path) if name.startswith(".")]
    assert len(left) == 1
    assert {name: data for name, data in contents(tmp_path).items()
            if not name.startswith(".")} == before
    with writing(tmp_path):
        assert left[0] not in names(tmp_path)


def test_two_runs_in_one_directory_are_refused(tmp_path):
    recording(title="a").save(tmp_path / "a")
    recording(title="b").save(tmp_path / "b")
    shutil.copy(tmp_path / "a" / "run.npz", tmp_path / "b" / "run.npz")
    with pytest.raises(OutputError, match=r"run\.json and run\.npz are of different runs"):
        Recording.load(tmp_path / "b")


@pytest.mark.parametrize("noted", [
    '["../mine.txt", "sub/mine.txt", "sub", 3]', "[", "[" * 100_000])
def test_notes_of_what_was_made_lead_nowhere_else(tmp_path, noted):
    folder = tmp_path / "run"
    recording().save(folder)
    (folder / "sub").mkdir()
    for mine in (tmp_path / "mine.txt", folder / "sub" / "mine.txt", folder / "mine.txt"):
        mine.write_text("mine")
    (folder / ".made").write_text(noted)
    recording().save(folder)
    assert (tmp_path / "mine.txt").exists()
    assert (folder / "sub" / "mine.txt").exists()
    assert (folder / "mine.txt").exists()


def test_something_in_the_way_is_told_before_the_old_run_is_touched(tmp_path):
    recording(title="old", springs=[]).save(tmp_path)
    before = contents(tmp_path)
    (tmp_path / "springs.csv").mkdir()
    with pytest.raises(OutputError, match=r"cannot write .*springs\.csv: it is a dir") as told:
        recording().save(tmp_path)
    left = str(told.value).partition("the new run's files are in ")[2]
    assert Recording.load(left).complete
    shutil.rmtree(left)
    assert contents(tmp_path) == before


@pytest.mark.parametrize("error", [ZeroDivisionError("in a move"), OSError(5, "the disk is gone")])
def test_what_cannot_be_put_in_place_is_left_where_it_is_told(tmp_path, monkeypatch, error):
    def move(self, here, names):
        raise error

    folder = tmp_path / "run"
    recording(title="old").save(folder)
    before = contents(folder)
    monkeypatch.setattr(NewRun, "_move", move)
    with pytest.raises(OutputError if isinstance(error, OSError) else ZeroDivisionError) as caught:
        recording(title="new").save(folder)
    assert Recording.load(folder).mechanism.title == "old"
    if isinstance(error, OSError):
        left = str(caught.value).partition("the new run's files are in ")[2]
        monkeypatch.undo()
        assert Recording.load(left).mechanism.title == "new"
        shutil.rmtree(left)
    assert contents(folder) == before


def test_pictures_elsewhere_stay(tmp_path):
    """A link that stands where frames go leads to what is not ours, whatever it is called."""
    elsewhere, folder = tmp_path / "elsewhere", tmp_path / "run"
    elsewhere.mkdir()
    (elsewhere / "frame_00000.png").touch()
    recording().save(folder)
    (folder / "frames").symlink_to(elsewhere)
    recording().save(folder)
    assert (elsewhere / "frame_00000.png").exists()
    (folder / "frames").unlink()
    (folder / "frames").mkdir()
    (folder / "frames" / "holiday.png").touch()
    (folder / "frames" / "frame_00001.png").touch()
    recording().save(folder)
    assert names(folder / "frames") == ["holiday.png"]
