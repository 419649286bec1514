"""``sandbox new``: a shipped scene as a file of one's own."""

from __future__ import annotations

import json
from pathlib import Path

import click

from sandbox.atomic_files import output_path, write_atomic
from sandbox.cli.console import Console
from sandbox.cli.scenes import complete_scene
from sandbox.errors import OutputError


@click.command()
@click.argument("name", shell_complete=complete_scene)
@click.option("--out", metavar="FILE",
              help="Write it to this file, or into this directory; by default NAME.json here.")
def new(name: str, out: str | None) -> None:
    """Copy the shipped scene NAME, to start from.

    What it includes is copied beside it, and so are its drawings. Nothing is overwritten.
    """
    from sandbox.scene.read.load import read_scene

    source = _shipped(name)
    target = output_path(out, "a scene") if out is not None else Path()
    target = target / source.name if target.is_dir() else target
    included = read_scene(source).files
    beside = [*included, *(path for scene in (source, *included) for path in _drawings(scene))]
    wanted = {target: source} | {target.parent / path.name: path for path in beside}
    texts = {path: _as_own(original) for path, original in wanted.items()}
    missing = {path: text for path, text in texts.items()
               if path == target or not _is_same(path, text)}
    for path in missing:
        if path.exists() or path.is_symlink():
            raise OutputError(f"{path} exists already and is not overwritten; "
                              "--out FILE gives the scene another place")
    for path, text in reversed(missing.items()):  # the scene last, when all it includes is there
        write_atomic(path, text)
    console = Console()
    console.say(*(f"wrote {path}" for path in missing))
    console.say(f"next: sandbox run {target}")


def _shipped(name: str) -> Path:
    """The file of a shipped scene; another name is refused with a near miss."""
    from sandbox.scene.library import shipped_scenes
    from sandbox.wording import meant, quoted

    scenes = shipped_scenes()
    if name not in scenes:
        raise click.BadParameter(
            f"there is no shipped scene {quoted(name)} to start from; 'sandbox list' names them."
            + meant(name.removesuffix(".json"), scenes), param_hint="NAME")
    return scenes[name]


def _drawings(scene: Path) -> list[Path]:
    """The files of outlines that a shipped scene names; they lie beside it."""
    found, left = [], [json.loads(scene.read_text(encoding="utf-8"))]
    while left:
        entry = left.pop()
        if isinstance(entry, dict) and entry.get("type") == "drawing":
            found.append(scene.with_name(entry["file"]))
        if isinstance(entry, (dict, list)):
            left += entry.values() if isinstance(entry, dict) else entry
    return sorted(set(found))


def _as_own(path: Path) -> str:
    """The text of a shipped scene that names its schema beside it, whatever folder it came from."""
    return path.read_text(encoding="utf-8").replace(
        '"$schema": "../scene.schema.json"', '"$schema": "./scene.schema.json"', 1)


def _is_same(path: Path, text: str) -> bool:
    """Whether what a scene includes is there already, as it is shipped."""
    try:
        return path.is_file() and path.read_text(encoding="utf-8") == text
    except (OSError, ValueError):
        return False
