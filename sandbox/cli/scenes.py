"""``sandbox list`` and ``sandbox new``: the shipped scenes; and how SCENE arguments are read."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.shell_completion import CompletionItem

from sandbox.atomic_files import output_path, write_atomic
from sandbox.cli.console import Console
from sandbox.cli.options import json_option
from sandbox.errors import OutputError

if TYPE_CHECKING:
    from sandbox.scene.read.limits import Limits
    from sandbox.scene.read.load import Loaded


@click.command("list")
@json_option
def list_scenes(as_json: bool) -> None:
    """List the scenes that come with sandbox, by topic."""
    from sandbox.scene.library import folder_of, scene_topics, shipped_scenes

    console, paths = Console(as_json=as_json), shipped_scenes()
    if as_json:
        topic = {name: each.title for each in scene_topics() for name in each.scenes}
        console.result_json({"scenes": [
            {"name": name, "topic": topic.get(name, ""), "folder": folder_of(path),
             "title": title_of(path), "path": str(path)} for name, path in paths.items()]})
        return
    width = max(map(len, paths))
    for each in scene_topics():
        console.result(each.title, *(f"  {name:{width}}  {title_of(paths[name])}"
                                       for name in each.scenes), "")
    console.result("'sandbox run NAME' runs one; 'sandbox new NAME' copies it, to change it.")


def title_of(path: Path) -> str:
    """The title in a scene's file, read without validation; empty if it has none."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return ""
    return str(data.get("title", "")) if isinstance(data, dict) else ""


def complete_scene(
    ctx: click.Context, param: click.Parameter, incomplete: str,
) -> list[CompletionItem]:
    """Complete the names of shipped scenes, and files."""
    from sandbox.scene.library import shipped_scenes

    named = [CompletionItem(name, help=title_of(path)) for name, path in shipped_scenes().items()
             if name.startswith(incomplete)]
    return [*named, CompletionItem(incomplete, type="file")]


scene_argument = click.argument("scene", shell_complete=complete_scene)


def scene_path(word: str) -> Path:
    """The file of a scene given as a path or as the name of a shipped scene.

    Raises:
        SceneError: neither; with a suggestion.
    """
    from sandbox.scene.library import find_scene, shipped_scenes

    shipped = shipped_scenes()
    if word in shipped and not Path(word).is_file():  # a directory of that name hides no scene
        return shipped[word]
    return find_scene(word)


def load(path: Path, *, overrides: dict[str, Any], limits: Limits) -> Loaded:
    """Load a scene, changed by ``--set``, within limits.

    Raises:
        SceneError: with every problem found.
    """
    from sandbox.scene.read.load import read_scene

    return read_scene(path, overrides=overrides, limits=limits)


@click.command()
@click.argument("name", shell_complete=complete_scene)
@click.option("--out", metavar="FILE", help="File or directory to write to; NAME.json by default.")
def new(name: str, out: str | None) -> None:
    """Copy the shipped scene NAME, to start from.

    Included scenes and drawings are copied beside it. Nothing is overwritten.
    """
    from sandbox.scene.read.load import read_scene

    source = _shipped(name)
    target = output_path(out, "a scene") if out is not None else Path()
    target = target / source.name if target.is_dir() else target
    included = read_scene(source).files
    beside = [*included, *(path for scene in (source, *included) for path in _drawings(scene))]
    sources = {target: source} | {target.parent / path.name: path for path in beside}
    texts = {path: original.read_text(encoding="utf-8").replace(
        '"$schema": "../scene.schema.json"', '"$schema": "./scene.schema.json"', 1)
        for path, original in sources.items()}
    missing = {path: text for path, text in texts.items()
               if path == target or not _has_text(path, text)}
    for path in missing:
        if path.exists() or path.is_symlink():
            raise OutputError(f"{path} exists already and is not overwritten; "
                              "--out FILE gives the scene another place")
    for path, text in reversed(missing.items()):  # the scene last, after all that it includes
        write_atomic(path, text)
    console = Console()
    console.say(*(f"wrote {path}" for path in missing))
    console.say(f"next: sandbox run {target}")


def _shipped(name: str) -> Path:
    """The file of a shipped scene.

    Raises:
        BadParameter: there is none of that name; with a suggestion.
    """
    from sandbox.scene.library import shipped_scenes
    from sandbox.wording import meant, quoted

    scenes = shipped_scenes()
    if name not in scenes:
        raise click.BadParameter(
            f"there is no shipped scene {quoted(name)} to start from; 'sandbox list' names them."
            + meant(name.removesuffix(".json"), scenes), param_hint="NAME")
    return scenes[name]


def _drawings(scene: Path) -> list[Path]:
    """The drawing files that a shipped scene names; they lie beside it."""
    found, waiting = [], [json.loads(scene.read_text(encoding="utf-8"))]
    while waiting:
        entry = waiting.pop()
        if isinstance(entry, dict) and entry.get("type") == "drawing":
            found.append(scene.with_name(entry["file"]))
        if isinstance(entry, (dict, list)):
            waiting += entry.values() if isinstance(entry, dict) else entry
    return sorted(set(found))


def _has_text(path: Path, text: str) -> bool:
    """Whether a file exists with exactly this text."""
    try:
        return path.is_file() and path.read_text(encoding="utf-8") == text
    except (OSError, ValueError):
        return False
