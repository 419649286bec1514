"""The directory that a run writes into."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

from sandbox.errors import OutputError


def default_directory(name: str) -> Path:
    """``renders/<scene name>`` here; a name cannot lead anywhere else."""
    return Path("renders") / (re.sub(r"[^\w.-]+", "_", name).strip("._") or "scene")


def prepare(directory: Path) -> None:
    """Make sure that files can be written into a directory, before any work is done.

    Raises:
        OutputError: it cannot be made, or not be written into.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=directory) as trial:
            trial.write(b"\0")
    except OSError as error:
        raise OutputError(f"cannot write into {directory}: {error.strerror or error}") from None


def written(directory: Path) -> list[str]:
    """The files of a run that are there, ``run.json`` first."""
    from sandbox.recording.new_run import FILES, FILMS, FRAMES, PAGE

    names = [name for name in (*FILES, *FILMS, PAGE) if (directory / name).is_file()]
    return [*names, f"{FRAMES}/"] if (directory / FRAMES).is_dir() else names
