"""Files are whole or not there, whatever happens while they are written."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import sandbox
from sandbox.errors import OutputError
from sandbox.recording import store
from sandbox.whole_files import remove, write_whole, written_whole

from .recording.sample import recording

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


def test_what_a_killed_process_left_is_known_and_removed(tmp_path: Path) -> None:
    """Only of this file: another's part may be in the making."""
    killed_while_writing(tmp_path / "run.npz")
    killed_while_writing(tmp_path / "run.json")
    assert len(names(tmp_path)) == 2
    (tmp_path / ".run.mine.part.npz").write_text("mine")
    remove(tmp_path / "run.npz")
    assert [re.sub(r"\d+", "0", name) for name in names(tmp_path)] == [
        ".run.0.part.json", ".run.mine.part.npz"]
    remove(tmp_path / "nowhere" / "run.npz")


def test_a_run_clears_what_a_killed_one_left(tmp_path: Path) -> None:
    """The names are those of the test above."""
    for path in map(Path, store.FILES):
        (tmp_path / f".{path.stem}.4711.part{path.suffix}").write_text("half")
    recording().save(tmp_path)
    assert [name for name in names(tmp_path) if name.startswith(".")] == []


def test_nothing_else_writes_files() -> None:
    """Besides what fills a part, and array files that are gone with the process."""
    writing = re.compile(r"write_text\(|write_bytes\(|open\([^)]*[\"'][wax]b?\+?[\"']"
                         r"|\.replace\([a-z_]*path\)|np\.save|to_csv")
    assert {str(path.relative_to(PACKAGE)) for path in PACKAGE.rglob("*.py")
            if writing.search(path.read_text(encoding="utf-8"))} == {
        "whole_files.py", "recording/store.py", "draw/film/video.py", "recording/builder.py"}
