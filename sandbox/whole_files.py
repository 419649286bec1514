"""Files that are whole or not there: written beside their place, flushed, then moved there.

The one way in which the package writes. A disk that fills, an error or Ctrl-C
leaves the file that was there; a process that is killed can leave a part, which its name
tells (``.run.4711-1f2e3d4c.part.npz`` of ``run.npz``). Whoever makes a part holds it
locked, and the system lets go of what a dead process held: so parts without an owner are
known, and the next file that is written beside them takes them away (:func:`tidy`).
"""

from __future__ import annotations

import contextlib
import errno
import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

from sandbox.errors import OutputError
from sandbox.wording import quoted

try:
    import fcntl
except ImportError:  # a system without file locks: every part counts as nobody's
    fcntl = None  # type: ignore[assignment]

PART = re.compile(r"\..+\.\d+(-[0-9a-f]{8})?\.part(\.\w+)?")
"""What an unfinished file or directory is called; older versions had no second number."""


def place(given: object, what: str) -> Path:
    """The path that was given for ``what``, such as ``"a recording"``.

    An empty text is none: as a path it would be the working directory, and what lies there.

    Raises:
        OutputError: it is no path.
    """
    text = os.fspath(given) if isinstance(given, os.PathLike) else given
    if not isinstance(text, str) or not text.strip() or "\0" in text:
        raise OutputError(f"{quoted(given)} is no place for {what}; pass a path such as "
                          "'renders/hand', or '.' for the working directory")
    return Path(text)


@contextlib.contextmanager
def written_whole(path: Path, *, lasting: bool = True) -> Iterator[Path]:
    """Gives a temporary path with the same ending and moves it to ``path`` when all went well.

    Directories on the way are made, and the file is on the disk before it is moved, so that a
    machine that goes down leaves the old file or the new one. What is no file and no directory,
    such as ``/dev/stdout``, is written to as it stands: it must not be replaced.

    Args:
        path: where the file belongs.
        lasting: flush it, and look through its directory for what killed processes left. Not
            for one of many files, of which a caller takes care together.

    Raises:
        OutputError: the file cannot be written; nothing is left behind.
    """
    with plainly(path):
        if path.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if path.exists() and not path.is_file():
            yield path
            return
        if not path.parent.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
        if lasting:
            tidy(path.parent)
        with contextlib.ExitStack() as held:
            part = own_part(path, held)
            yield part
            if lasting:
                flush(part)
            part.replace(path)
        if lasting:
            flush(path.parent)


def write_whole(path: Path, text: str) -> None:
    """Write a text, UTF-8 and with the same bytes on every platform.

    Raises:
        OutputError: the file cannot be written; nothing is left behind.
    """
    with written_whole(path) as part:
        part.write_bytes(text.encode())


def own_part(path: Path, held: contextlib.ExitStack, *, directory: bool = False) -> Path:
    """Make an empty part of a file or directory beside it, locked until ``held`` removes it.

    Raises:
        OSError: it cannot be made.
    """
    while True:
        part = path.with_name(
            f".{path.stem}.{os.getpid()}-{os.urandom(4).hex()}.part{path.suffix}")
        part.mkdir() if directory else part.touch()
        held.callback(_remove, part)
        with contextlib.suppress(FileNotFoundError):
            if held.enter_context(locked(part)) is not False and part.exists():
                return part
        # someone tidied up just between: the next one


def _remove(part: Path) -> None:
    if part.is_dir() and not part.is_symlink():
        shutil.rmtree(part, ignore_errors=True)
    else:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)


@contextlib.contextmanager
def locked(path: Path) -> Iterator[bool | None]:
    """Holds a file or a directory as this writer's own, until the end of the block or process.

    Gives False if another one holds it, and None where the system knows no locks.

    Raises:
        OSError: it cannot be opened.
    """
    if fcntl is None:
        yield None
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        yield _lock(handle)
    finally:
        os.close(handle)


def _lock(handle: int) -> bool | None:
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks
        return None
    return True


def tidy(directory: Path) -> None:
    """Take away what writers that are no more left unfinished in a directory.

    What another process is writing stays, what cannot be removed, and all where there are no locks
    to tell by.
    """
    with contextlib.suppress(OSError):
        for left in [Path(entry.path) for entry in os.scandir(directory)
                     if PART.fullmatch(entry.name)]:
            with contextlib.suppress(OSError), locked(left) as ours:
                if ours:
                    _remove(left)


def flush(path: Path) -> None:
    """Have a file, or the names in a directory, on the disk and not in memory alone.

    Raises:
        OSError: the disk is full, or gone; of directories, which not every system flushes, none.
    """
    directory = path.is_dir()
    try:
        handle = os.open(path, os.O_RDONLY if directory else os.O_RDWR)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
    except OSError:
        if not directory:
            raise


@contextlib.contextmanager
def plainly(path: Path) -> Iterator[None]:
    """Tells errors of the operating system in one line that names ``path``.

    Raises:
        OutputError: in place of an OSError.
    """
    try:
        yield
    except OSError as error:
        raise OutputError(f"cannot write {path}: {error.strerror or error}") from None
