"""``sandbox list``: the scenes that come with the package; and how a scene argument is found."""

from __future__ import annotations

import json
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.shell_completion import CompletionItem

from sandbox.cli.console import Console, table
from sandbox.cli.options import chosen_limits

if TYPE_CHECKING:
    from sandbox.scene.read.load import Loaded


@click.command("list")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def list_scenes(as_json: bool) -> None:
    """List the scenes that come with sandbox, folder by folder."""
    from sandbox.scene.library import folder_of, shipped_scenes

    console = Console(as_json=as_json)
    scenes = [{"name": name, "folder": folder_of(path), "title": title_of(path), "path": str(path)}
              for name, path in shipped_scenes().items()]
    if as_json:
        console.result_json({"scenes": scenes})
        return
    head, *lines = table(["scene", "title"], [[s["name"], s["title"]] for s in scenes])
    console.result(head)
    for folder, named in groupby(zip(scenes, lines, strict=True), lambda pair: pair[0]["folder"]):
        console.result(*(["", f"{folder}:"] if folder else []), *(line for _, line in named))


def title_of(path: Path) -> str:
    """The title in a scene's file, read without validating it; empty if it has none."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return ""
    return str(data.get("title", "")) if isinstance(data, dict) else ""


def complete_scene(
    ctx: click.Context, param: click.Parameter, incomplete: str,
) -> list[CompletionItem]:
    """Shipped scenes by name, and files."""
    from sandbox.scene.library import shipped_scenes

    named = [CompletionItem(name, help=title_of(path)) for name, path in shipped_scenes().items()
             if name.startswith(incomplete)]
    return [*named, CompletionItem(incomplete, type="file")]


def scene_path(word: str) -> Path:
    """The file of a scene that was given as a path or as a shipped scene's name.

    Raises:
        SceneError: neither; with a near miss.
    """
    from sandbox.scene.library import find_scene, shipped_scenes

    shipped = shipped_scenes()
    if word in shipped and not Path(word).is_file():  # a directory of that name hides no scene
        return shipped[word]
    return find_scene(word)


def load(path: Path, *, overrides: dict[str, Any], limits: dict[str, Any]) -> Loaded:
    """A file's scene and mechanism, changed by ``--set``, within the limits as options raised them.

    Raises:
        SceneError: with every problem found.
    """
    from sandbox.scene.read.load import read_scene

    return read_scene(path, overrides=overrides, limits=chosen_limits(limits))

