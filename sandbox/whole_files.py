"""Files that are whole or not there: written beside their place, then moved there.

The one way in which the package writes. A disk that fills, an error or Ctrl-C
leaves nothing; a process that is killed can leave a part, which its name tells
(``.run.4711.part.npz`` of ``run.npz``) and :func:`remove` takes away.
"""

from __future__ import annotations

import contextlib
import errno
import os
import re
from collections.abc import Iterator
from pathlib import Path

from sandbox.errors import OutputError


@contextlib.contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """Gives a temporary path with the same ending and moves it to ``path`` when all went well.

    Directories on the way are made. What is no file and no directory, such as
    ``/dev/stdout``, is written to as it stands: it must not be replaced.

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
        part = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
        try:
            yield part
            part.replace(path)
        finally:
            with contextlib.suppress(OSError):
                part.unlink(missing_ok=True)


def write_whole(path: Path, text: str) -> None:
    """Write a text, UTF-8 and with the same bytes on every platform.

    Raises:
        OutputError: the file cannot be written; nothing is left behind.
    """
    with written_whole(path) as part:
        part.write_bytes(text.encode())


def remove(path: Path) -> None:
    """Remove a file if it is there, and what killed processes left of it.

    Raises:
        OutputError: it cannot be removed.
    """
    left = re.compile(re.escape(f".{path.stem}.") + r"\d+\.part" + re.escape(path.suffix))
    with plainly(path):
        path.unlink(missing_ok=True)
        for other in path.parent.iterdir() if path.parent.is_dir() else ():
            if left.fullmatch(other.name):
                other.unlink(missing_ok=True)


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
