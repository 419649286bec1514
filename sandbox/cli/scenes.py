"""``sandbox list``, ``sandbox new``: shipped scenes; ``sandbox export``: to other programs."""

from __future__ import annotations

from pathlib import Path

import click

from sandbox.atomic_files import write_atomic
from sandbox.cli.console import Console
from sandbox.cli.options import Source, title_of
from sandbox.errors import OutputError, SceneError
from sandbox.scene.library import folder_of, scene_topics, shipped_scenes
from sandbox.wording import meant, quoted


def list_scenes(console: Console) -> int:
    """Print the scenes by topic."""
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


def new(name: str, out: Path | None) -> None:
    """Copy a scene with all that it includes."""
    from sandbox.scene.read.limits import Limits
    from sandbox.sweeps.job import make_bundle
    scenes = shipped_scenes()
    if name not in scenes:
        raise click.BadParameter(
            f"there is no shipped scene {quoted(name)} to start from; 'sandbox list' names them."
            + meant(name.removesuffix(".json"), scenes), param_hint="NAME")
    source, target = scenes[name], out or Path()
    target = target / source.name if target.is_dir() else target
    missing = {}
    for file, content in make_bundle(source, {}, Limits())[0].files.items():
        path = target if file == source.name else target.parent / file
        text = content.decode().replace('"$schema": "../scene.schema.json"',
                                        '"$schema": "./scene.schema.json"', 1)
        if path == target or not path.is_file() or path.read_bytes() != text.encode():
            missing[path] = text
    for path in missing:
        if path.exists() or path.is_symlink():
            raise OutputError(f"{path} exists already and is not overwritten; "
                              "--out FILE gives the scene another place")
    for path, text in reversed(missing.items()):  # the scene last, after all that it includes
        write_atomic(path, text)
    Console().say(*(f"wrote {path}" for path in missing), f"next: sandbox run {target}")


def export(scene: Source, form: str, out: Path | None, without: tuple[str, ...]) -> None:
    """Write a scene in another format, or print it."""
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
