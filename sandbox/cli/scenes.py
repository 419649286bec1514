"""``sandbox list``, ``sandbox new`` and ``sandbox export``: the shipped scenes, other formats."""

from __future__ import annotations

import json
from pathlib import Path

import click

from sandbox.atomic_files import write_atomic
from sandbox.cli.console import Console
from sandbox.cli.options import OUT, Source, complete_scene, console_options, takes_scene, title_of
from sandbox.errors import OutputError, SceneError
from sandbox.wording import listed, meant, quoted


@click.command("list")
@console_options("json")
def list_scenes(console: Console) -> int:
    """List the scenes that come with sandbox, by topic."""
    from sandbox.scene.library import folder_of, scene_topics, shipped_scenes

    paths, topics = shipped_scenes(), scene_topics()
    topic = {name: each.title for each in topics for name in each.scenes}
    width, lines = max(map(len, paths)), []
    for each in topics:
        lines += [each.title, *(f"  {name:{width}}  {title_of(paths[name])}"
                                for name in each.scenes), ""]
    lines.append("'sandbox run NAME' runs one; 'sandbox new NAME' copies it, to change it.")
    return console.finish({"scenes": [
        {"name": name, "topic": topic.get(name, ""), "folder": folder_of(path),
         "title": title_of(path), "path": path} for name, path in paths.items()]}, lines)


@click.command()
@click.argument("name", shell_complete=complete_scene)
@click.option("--out", type=OUT, metavar="FILE",
              help="File or directory to write to; NAME.json by default.")
def new(name: str, out: Path | None) -> None:
    """Copy the shipped scene NAME, to start from.

    Included scenes and drawings are copied beside it. Nothing is overwritten.
    """
    from sandbox.scene.library import shipped_scenes
    from sandbox.scene.read.load import read_scene

    scenes = shipped_scenes()
    if name not in scenes:
        raise click.BadParameter(
            f"there is no shipped scene {quoted(name)} to start from; 'sandbox list' names them."
            + meant(name.removesuffix(".json"), scenes), param_hint="NAME")
    source, target = scenes[name], out or Path()
    target = target / source.name if target.is_dir() else target
    whole = [source, *read_scene(source).files]
    beside = [*whole[1:], *(path for scene in whole for path in _drawings(scene))]
    missing = {}
    for path, original in {target: source, **{target.parent / path.name: path
                                              for path in beside}}.items():
        text = original.read_text(encoding="utf-8").replace(
            '"$schema": "../scene.schema.json"', '"$schema": "./scene.schema.json"', 1)
        if path == target or not path.is_file() or path.read_bytes() != text.encode():
            missing[path] = text
    for path in missing:
        if path.exists() or path.is_symlink():
            raise OutputError(f"{path} exists already and is not overwritten; "
                              "--out FILE gives the scene another place")
    for path, text in reversed(missing.items()):  # the scene last, after all that it includes
        write_atomic(path, text)
    Console().say(*(f"wrote {path}" for path in missing), f"next: sandbox run {target}")


def _drawings(scene: Path) -> list[Path]:
    """The drawing files that a shipped scene names; they lie beside it."""
    found, waiting = set(), [json.loads(scene.read_text(encoding="utf-8"))]
    while waiting:
        entry = waiting.pop()
        if isinstance(entry, dict) and entry.get("type") == "drawing":
            found.add(scene.with_name(entry["file"]))
        if isinstance(entry, (dict, list)):
            waiting += entry.values() if isinstance(entry, dict) else entry
    return sorted(found)


def _read_format(ctx: click.Context, param: click.Parameter, word: str) -> str:
    """Check the name of a format."""
    from sandbox.export import FORMATS

    if word not in FORMATS:
        raise click.BadParameter(
            f"{quoted(word)} is no format to export to.{meant(word, FORMATS)} "
            f"Allowed: {listed(FORMATS)}.", ctx, param)
    return word


@click.command()
@click.option("--format", "--to", "form", metavar="FORMAT", default="mjcf", show_default=True,
              callback=_read_format,
              help="Format: mjcf, a model for MuJoCo, or pymunk, a script in Python.")
@click.option("--out", type=OUT, metavar="FILE", help="File to write; stdout by default.")
@click.option("--without", multiple=True, metavar="NAME",
              help="Leave out an element and all that depends on it; patterns such as 'tree.*' "
                   "too. Repeatable.")
@takes_scene
def export(scene: Source, form: str, out: Path | None, without: tuple[str, ...]) -> None:
    """Export SCENE as a MuJoCo model (MJCF), or as a Python script for pymunk.

    Elements without a counterpart are named, and nothing is written unless
    --without leaves them out. Other differences are printed to stderr.
    """
    from sandbox.export import export_mechanism

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
