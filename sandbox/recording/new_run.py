"""The directory of a run while it is written: the old run stays whole until the new one is.

A new run is written into a hidden directory within that of the run, which is locked, and moved into
place by renames. Meanwhile a mark ``run.incomplete.json`` stands for ``run.json``, for a process
that is killed in between. A stopped run does not replace a complete one: see :data:`BESIDE`.
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
import signal
import threading
from collections.abc import Iterator
from pathlib import Path

from sandbox import atomic_files as files
from sandbox.atomic_files import flush, locked, write_atomic
from sandbox.errors import OutputError

SUMMARY, INCOMPLETE, ARCHIVE, CONTACTS, IMPACTS, BOUNDS = (
    "run.json", "run.incomplete.json", "run.npz", "contacts.csv", "impacts.csv",
    "contact_bounds.csv")
FILES = (SUMMARY, INCOMPLETE, ARCHIVE, CONTACTS, IMPACTS, BOUNDS,
         *(f"{kind}.csv" for kind in ("tendons", "joints", "bodies", "drives", "springs", "lines",
                                      "valves", "loads", "meters")))
FILMS = ("animation.gif", "animation.mp4")
PAGE = "report.html"  # What ``sandbox report`` writes
FRAMES, FRAME = "frames", "frame_?????.png"  # Where pictures of a film go, and what they are called
BESIDE = "incomplete"  # Where a run that was stopped is put if a complete one is there
OWN = (*FILES, *FILMS, PAGE, "plot.png", "plot.svg", "plot.pdf")
MADE, MAX_MADE = ".made", 1_000_000  # A list of other files made of the run; its bytes
MARK = {"format": 1, "complete": False,
        "reason": "stopped while the files of a new run were put in place of an older one's"}


class NewRun:
    """A run that is written into ``aside`` until :meth:`publish` puts it into ``directory``."""

    def __init__(self, directory: Path, aside: Path) -> None:
        self.directory, self.aside = directory, aside

    def publish(self, *, stopped: bool = False) -> Path:
        """Put the run in place of what was there, and return where it is; other files stay.

        A run that was ``stopped`` by Ctrl-C, an error or a full disk is put into :data:`BESIDE` if
        a complete run is there. Up to the first move an error leaves the old run untouched.
        """
        stays = stopped and (self.directory / SUMMARY).exists()
        here = self.directory / BESIDE if stays else self.directory
        try:
            names = self._ready(here)
            with _uninterrupted():
                self._move(here, names)
        except OSError as error:
            left, place = self.aside.with_name(self.aside.name.strip(".")), ""
            with contextlib.suppress(OSError):
                self.aside.rename(left)
                place = f"; the new run's files are in {left}"
            raise OutputError(f"cannot write {error.filename or here}: "
                              f"{error.strerror or error}{place}") from None
        return here

    def _ready(self, here: Path) -> list[Path]:
        """The new files, relative, all on the disk and with nothing in their way."""
        names = sorted(path.relative_to(self.aside) for path in self.aside.rglob("*")
                       if path.is_file())
        for name in names:
            if (here / name).is_dir():
                raise IsADirectoryError(errno.EISDIR, "it is a directory", str(here / name))
            (here / name).parent.mkdir(parents=True, exist_ok=True)
            if name.parts[0] != FRAMES:  # pictures can be made again
                flush(self.aside / name)
        if Path(SUMMARY) in names:
            write_atomic(self.aside / INCOMPLETE, json.dumps(MARK, indent=2) + "\n")
        flush(self.aside)
        return names

    def _move(self, here: Path, names: list[Path]) -> None:
        """Renames only: nothing that needs room on the disk."""
        aside = self.aside
        (aside / INCOMPLETE).replace(here / INCOMPLETE)
        (here / SUMMARY).unlink(missing_ok=True)
        flush(here)
        for name in sorted(_own(here) - {*names, Path(INCOMPLETE)}):
            (here / name).unlink(missing_ok=True)
        for name in names:
            if name not in (Path(SUMMARY), Path(INCOMPLETE)):
                (aside / name).replace(here / name)
        for folder in (FRAMES, f"{BESIDE}/{FRAMES}", BESIDE):
            with contextlib.suppress(OSError):
                (here / folder).rmdir()
        flush(here)
        if Path(SUMMARY) in names:
            (aside / SUMMARY).replace(here / SUMMARY)
            (here / INCOMPLETE).unlink(missing_ok=True)
            flush(here)


@contextlib.contextmanager
def writing(directory: Path) -> Iterator[NewRun]:
    """A directory in which only this writer may put a run; unpublished files are removed."""
    with contextlib.ExitStack() as held:
        try:
            directory.mkdir(parents=True, exist_ok=True)
            if held.enter_context(locked(directory)) is False:
                raise OutputError(f"another run is being written into {directory}: wait for its "
                                  "end, or name another directory", code="runs-in-use")
            files.remove_stale(directory)
            aside = files.temporary_path(directory / "run", held, directory=True)
        except OSError as error:
            why = str(error.strerror or error)
            if isinstance(error, FileExistsError):
                why = "it is a file" if directory.exists() else "it is a broken link"
            raise OutputError(f"cannot write into {directory}: {why}") from None
        try:
            yield NewRun(directory, aside)
        except OutputError as error:  # name the final place of the file
            raise OutputError(str(error).replace(str(aside), str(directory))) from None


@contextlib.contextmanager
def _uninterrupted() -> Iterator[None]:
    """Delay Ctrl-C to the end; it reaches the main thread alone."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    pending: list[int] = []
    handler = signal.signal(signal.SIGINT, lambda number, _: pending.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler or signal.SIG_DFL)
        if pending:
            signal.raise_signal(signal.SIGINT)


def made(path: Path) -> None:
    """Remember a file that was made of the run in its directory, so that it goes with the run."""
    directory = path.parent
    if path.name in OWN or not path.is_file() or not (directory / ARCHIVE).is_file():
        return
    with files.output_errors(directory / MADE), locked(directory) as ours:
        if ours is False:  # a new run is being written and decides on the files here
            return
        names = sorted({*_made(directory), path.name})
        write_atomic(directory / MADE, json.dumps(names, indent=1) + "\n")


def _own(directory: Path) -> set[Path]:
    """What is there of a run and was made of it, relative."""
    names = {Path(name) for name in (*OWN, MADE, *_made(directory))}
    if not (directory / FRAMES).is_symlink():
        names |= {path.relative_to(directory) for path in (directory / FRAMES).glob(FRAME)}
    if (directory / BESIDE).is_dir() and not (directory / BESIDE).is_symlink():
        names |= {BESIDE / name for name in _own(directory / BESIDE)}
    return {name for name in names if os.path.lexists(directory / name)
            and ((directory / name).is_symlink() or not (directory / name).is_dir())}


def _made(directory: Path) -> list[str]:
    """Names that were noted and are there; only plain ones, so that none leads elsewhere."""
    path = directory / MADE
    try:
        short = path.is_file() and path.stat().st_size <= MAX_MADE
        names = json.loads(path.read_text(encoding="utf-8")) if short else []
    except (OSError, ValueError, RecursionError):
        return []
    return [name for name in names if isinstance(name, str) and name == Path(name).name
            and (directory / name).is_file()] if isinstance(names, list) else []
