"""Files are whole or not there, whatever happens while they are written."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import sandbox
from sandbox import whole_files
from sandbox.errors import OutputError
from sandbox.whole_files import tidy, write_whole, written_whole

PACKAGE = Path(sandbox.__file__).parent


def names(directory: Path) -> list[str]:
    return sorted(path.name for path in directory.iterdir())


def test_a_text_is_written_with_its_directories(tmp_path: Path) -> None:
    write_whole(tmp_path / "a" / "b.csv", "x\nµ\n")
    assert (tmp_path / "a" / "b.csv").read_bytes() == "x\nµ\n".encode()
    assert names(tmp_path / "a") == ["b.csv"]


@pytest.mark.parametrize("stop", [KeyboardInterrupt, ValueError])
def test_what_stops_half_way_leaves_the_old_file(
    tmp_path: Path, stop: type[BaseException],
) -> None:
    write_whole(tmp_path / "a.csv", "old")

    def write() -> None:
        with written_whole(tmp_path / "a.csv") as part:
            part.write_text("ne")
            assert part.suffix == ".csv"
            raise stop

    with pytest.raises(stop):
        write()
    assert names(tmp_path) == ["a.csv"]
    assert (tmp_path / "a.csv").read_text() == "old"


def test_errors_of_the_system_name_the_file(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"cannot write .*a.csv: No space left on device"), \
            written_whole(tmp_path / "a.csv"):
        raise OSError(28, "No space left on device")
    with pytest.raises(OutputError, match=r"cannot write .*: Is a directory"):
        write_whole(tmp_path, "x")
    assert names(tmp_path) == []


def test_what_is_no_file_is_not_replaced(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_whole(pipe, "through")
        assert os.read(reader, 100) == b"through"
    finally:
        os.close(reader)
    assert pipe.is_fifo()


def killed_while_writing(path: Path) -> None:
    script = ("import os, pathlib, signal, sys\n"
              "from sandbox.whole_files import written_whole\n"
              "with written_whole(pathlib.Path(sys.argv[1])) as part:\n"
              "    part.write_text('half')\n"
              "    os.kill(os.getpid(), signal.SIGKILL)\n")
    subprocess.run([sys.executable, "-c", script, str(path)], check=False, cwd=PACKAGE.parent)


def test_what_a_killed_process_left_goes_with_the_next_file(tmp_path: Path) -> None:
    """Whatever its name was; what older versions left, too."""
    killed_while_writing(tmp_path / "film.gif")
    killed_while_writing(tmp_path / "run.json")
    (tmp_path / ".run.4711.part.npz").write_text("half")
    (tmp_path / ".run.4712-0123abcd.part").mkdir()
    (tmp_path / ".run.mine.part.npz").write_text("mine")
    assert len(names(tmp_path)) == 4
    write_whole(tmp_path / "a.csv", "x")
    assert names(tmp_path) == [".run.mine.part.npz", "a.csv"]


def test_what_is_being_written_stays(tmp_path: Path) -> None:
    with written_whole(tmp_path / "a.csv") as first, written_whole(tmp_path / "a.csv") as second:
        assert first != second
        first.write_text("1")
        second.write_text("2")
        tidy(tmp_path)
        assert first.exists()
        assert second.exists()
    assert names(tmp_path) == ["a.csv"]
    assert (tmp_path / "a.csv").read_text() == "1"


def test_a_part_that_is_tidied_away_before_it_is_locked_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:
    made: list[Path] = []
    touch = Path.touch

    def tidied(path: Path) -> None:
        touch(path)
        made.append(path)
        if len(made) == 1:
            tidy(tmp_path)

    monkeypatch.setattr(Path, "touch", tidied)
    write_whole(tmp_path / "a.csv", "x")
    assert len(made) == 2
    assert names(tmp_path) == ["a.csv"]


def test_a_file_is_on_the_disk_before_it_is_moved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen: list[tuple[bool, bool]] = []
    path = tmp_path / "a.csv"
    flush = whole_files.flush

    def watched(what: Path) -> None:
        seen.append((what.is_dir(), path.exists()))
        flush(what)

    monkeypatch.setattr(whole_files, "flush", watched)
    write_whole(path, "x")
    assert seen == [(False, False), (True, True)]
