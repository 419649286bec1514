"""Output files are complete or absent, whatever happens while they are written."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import sandbox
from sandbox.atomic_files import atomic_file, remove_stale, write_atomic
from sandbox.errors import OutputError

PACKAGE = Path(sandbox.__file__).parent


def names(directory: Path) -> list[str]:
    return sorted(path.name for path in directory.iterdir())


@pytest.mark.parametrize("stop", [KeyboardInterrupt, ValueError])
def test_an_interrupted_write_keeps_the_old_file(tmp_path: Path, stop: type[BaseException]) -> None:
    write_atomic(tmp_path / "a.csv", "old")

    def write() -> None:
        with atomic_file(tmp_path / "a.csv") as part:
            part.write_text("ne")
            assert part.suffix == ".csv"
            raise stop

    with pytest.raises(stop):
        write()
    assert names(tmp_path) == ["a.csv"]
    assert (tmp_path / "a.csv").read_text() == "old"


def test_system_errors_name_the_file(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"cannot write .*a.csv: No space left on device"), \
            atomic_file(tmp_path / "a.csv"):
        raise OSError(28, "No space left on device")
    with pytest.raises(OutputError, match=r"cannot write .*: Is a directory"):
        write_atomic(tmp_path, "x")
    assert names(tmp_path) == []


def test_a_pipe_is_written_directly(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_atomic(pipe, "through")
        assert os.read(reader, 100) == b"through"
    finally:
        os.close(reader)
    assert pipe.is_fifo()


def killed_while_writing(path: Path) -> None:
    script = ("import os, pathlib, signal, sys\n"
              "from sandbox.atomic_files import atomic_file\n"
              "with atomic_file(pathlib.Path(sys.argv[1])) as part:\n"
              "    part.write_text('half')\n"
              "    os.kill(os.getpid(), signal.SIGKILL)\n")
    subprocess.run([sys.executable, "-c", script, str(path)], check=False, cwd=PACKAGE.parent)


def test_the_next_write_removes_files_of_killed_processes(tmp_path: Path) -> None:
    """Those of older versions, too."""
    killed_while_writing(tmp_path / "film.gif")
    killed_while_writing(tmp_path / "run.json")
    (tmp_path / ".run.4711.part.npz").write_text("half")
    (tmp_path / ".run.4712-0123abcd.part").mkdir()
    (tmp_path / ".run.mine.part.npz").write_text("mine")
    assert len(names(tmp_path)) == 4
    write_atomic(tmp_path / "a.csv", "x")
    assert names(tmp_path) == [".run.mine.part.npz", "a.csv"]


def test_files_of_live_writers_stay(tmp_path: Path) -> None:
    with atomic_file(tmp_path / "a.csv") as first, atomic_file(tmp_path / "a.csv") as second:
        assert first != second
        first.write_text("1")
        second.write_text("2")
        remove_stale(tmp_path)
        assert first.exists()
        assert second.exists()
    assert names(tmp_path) == ["a.csv"]
    assert (tmp_path / "a.csv").read_text() == "1"


def test_a_temporary_file_that_is_removed_before_it_is_locked_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:
    made: list[Path] = []
    touch = Path.touch

    def tidied(path: Path) -> None:
        touch(path)
        made.append(path)
        if len(made) == 1:
            remove_stale(tmp_path)

    monkeypatch.setattr(Path, "touch", tidied)
    write_atomic(tmp_path / "a.csv", "x")
    assert len(made) == 2
    assert names(tmp_path) == ["a.csv"]
