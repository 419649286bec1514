"""Atomic output: a file is written under a temporary name, flushed, and moved into place.

After an error, a full disk or Ctrl-C the previous file remains. A killed process can leave a
temporary file (``.run.4711-1f2e3d4c.part.npz`` for ``run.npz``). Its writer held it locked, so an
unlocked one is stale: the next write into the same directory removes it.
"""

from __future__ import annotations

import contextlib
import errno
import json
import math
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from sandbox.errors import OutputError
from sandbox.wording import quoted

try:
    import fcntl
except ImportError:  # Windows: nothing is locked, and no stale file is removed
    fcntl = None  # type: ignore[assignment]

TEMPORARY = re.compile(r"\..+\.\d+(-[0-9a-f]{8})?\.part(\.\w+)?")


def output_path(given: object, what: str) -> Path:
    """The path given for ``what``, such as ``"a recording"``.

    Raises:
        OutputError: it is not a path, or empty, which would be the working directory.
    """
    text = os.fspath(given) if isinstance(given, os.PathLike) else given
    if not isinstance(text, str) or not text.strip() or "\0" in text:
        raise OutputError(f"{quoted(given)} is no place for {what}; pass a path such as "
                          "'renders/hand', or '.' for the working directory")
    return Path(text)


@contextlib.contextmanager
def atomic_file(path: Path, *, durable: bool = True) -> Iterator[Path]:
    """Yield a temporary path with the same suffix, and move it to ``path`` at the end.

    Parent directories are made. A device such as ``/dev/stdout`` is written directly. ``durable``
    also flushes the file and its directory to the disk, and removes stale temporary files.
    """
    with output_errors(path):
        if path.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if path.exists() and not path.is_file():
            yield path
            return
        if not path.parent.exists():  # a parent that is a file is reported by the next access
            path.parent.mkdir(parents=True, exist_ok=True)
        if durable:
            remove_stale(path.parent)
        with contextlib.ExitStack() as stack:
            temporary = temporary_path(path, stack)
            yield temporary
            if durable:
                flush(temporary)
            temporary.replace(path)
        if durable:
            flush(path.parent)


def write_atomic(path: Path, text: str) -> None:
    """Write a text in UTF-8, with the same bytes on every platform."""
    with atomic_file(path) as temporary:
        temporary.write_bytes(text.encode())


def json_text(value: Any, **options: Any) -> str:
    """A value as JSON: null for numbers that are not finite; arrays are lists, paths are text."""
    return json.dumps(_plain(value), allow_nan=False, **{"ensure_ascii": False, **options})


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(entry) for entry in value]
    if isinstance(value, Path):
        return str(value)
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write_csv(path: Path, rows: Iterable[Iterable[Any]]) -> None:
    """Write rows as CSV in UTF-8, with the same bytes on every platform."""
    import csv
    with atomic_file(path) as temporary, \
            temporary.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


def temporary_path(path: Path, stack: contextlib.ExitStack, *, directory: bool = False) -> Path:
    """Make a temporary file or directory beside a path, locked until ``stack`` removes it."""
    while True:
        temporary = path.with_name(
            f".{path.stem}.{os.getpid()}-{os.urandom(4).hex()}.part{path.suffix}")
        temporary.mkdir() if directory else temporary.touch()
        stack.callback(_remove, temporary)
        with contextlib.suppress(FileNotFoundError):  # another process may remove it before
            if stack.enter_context(locked(temporary)) is not False and temporary.exists():
                return temporary


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        import shutil  # slow to load
        shutil.rmtree(path, ignore_errors=True)
    else:
        with contextlib.suppress(OSError):
            path.unlink(missing_ok=True)


@contextlib.contextmanager
def locked(path: Path) -> Iterator[bool | None]:
    """Lock a file or directory: True, False if it is locked already, None without locks."""
    if fcntl is None:
        yield None
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        result: bool | None = True
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            result = False if isinstance(error, BlockingIOError) else None
        yield result
    finally:
        os.close(handle)


def remove_stale(directory: Path) -> None:
    """Remove the temporary files of killed processes from a directory."""
    with contextlib.suppress(OSError):
        for path in [Path(entry.path) for entry in os.scandir(directory)
                     if TEMPORARY.fullmatch(entry.name)]:
            with contextlib.suppress(OSError), locked(path) as stale:
                if stale:
                    _remove(path)


def flush(path: Path) -> None:
    """Flush a file to the disk, or the names in a directory where the system can do so."""
    directory = path.is_dir()
    with contextlib.suppress(OSError) if directory else contextlib.nullcontext():
        handle = os.open(path, os.O_RDONLY if directory else os.O_RDWR)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


@contextlib.contextmanager
def output_errors(path: Path) -> Iterator[None]:
    """Replace an OSError by an OutputError that names ``path``."""
    try:
        yield
    except OSError as error:
        raise OutputError(f"cannot write {path}: {error.strerror or error}") from None
