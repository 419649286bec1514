"""``sandbox export``: scenes for MuJoCo and pymunk."""

from __future__ import annotations

from pathlib import Path

from sandbox.atomic_files import write_atomic
from sandbox.cli.console import Console
from sandbox.cli.options import Source
from sandbox.errors import SceneError
from sandbox.export import export_mechanism


def export(scene: Source, form: str, out: Path | None, without: tuple[str, ...]) -> None:
    """Write a scene in another format, or print it."""
    loaded = scene.load()
    try:
        made = export_mechanism(loaded.mechanism, format=form, without=without)
    except SceneError as error:
        raise SceneError(error.problems, loaded.name) from None
    console = Console()
    if out is None:
        console.document(made.text.rstrip("\n"))
    else:
        write_atomic(out, made.text)
        console.say(f"wrote {out}")
    console.warn(*(f"{loaded.name}: note: {note}" for note in made.notes))
    if made.left_out:
        console.warn(f"left out: {', '.join(made.left_out)}")
