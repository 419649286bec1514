"""The directory that a run writes into."""

from __future__ import annotations

import contextlib
import re
import tempfile
from pathlib import Path

from sandbox.cli.failures import os_message
from sandbox.errors import OutputError
from sandbox.whole_files import remove

PICTURES = ("animation.gif", "animation.mp4")
FRAMES = "frames"
ENDINGS = ("png", "svg", "pdf")
PLOTS = ("plot", "finger-control")
"""What ``sandbox plot`` calls its pictures."""


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


def clear_pictures(directory: Path) -> None:
    """Remove the pictures that an earlier run left: they would show another motion.

    Raises:
        OutputError: they cannot be removed.
    """
    try:
        for name in (*PICTURES, *(f"{plot}.{ending}" for plot in PLOTS for ending in ENDINGS)):
            remove(directory / name)
        for picture in (directory / FRAMES).glob("*.png"):
            picture.unlink()
        with contextlib.suppress(OSError):
            (directory / FRAMES).rmdir()
    except OSError as error:
        raise OutputError(os_message(error)) from None


def written(directory: Path) -> list[str]:
    """The files of a run that are there, ``run.json`` first."""
    from sandbox.recording.store import FILES

    names = [name for name in (*FILES, *PICTURES) if (directory / name).is_file()]
    return [*names, f"{FRAMES}/"] if (directory / FRAMES).is_dir() else names
