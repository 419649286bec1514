"""``sandbox list``, ``new``, ``check`` and ``export``: shipped scenes, checks, other formats."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.atomic_files import write_atomic
from sandbox.cli.console import Console, Exit, pages_line, problem_data
from sandbox.cli.options import (
    OUT,
    SCENE,
    Source,
    complete_scene,
    refuse_blocking,
    takes,
    title_of,
)
from sandbox.errors import OutputError, Problem, SceneError
from sandbox.wording import meant, quoted

if TYPE_CHECKING:
    from sandbox.scene.read.limits import Limits
    from sandbox.scene.read.load import Loaded

@click.command("list")
@takes("json")
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


@click.command()
@click.option("--format", "--to", "form", type=click.Choice(["mjcf", "pymunk"]), default="mjcf",
              show_default=True, help="A model for MuJoCo, or a script in Python for pymunk.")
@click.option("--out", type=OUT, metavar="FILE", help="File to write; stdout by default.")
@click.option("--without", multiple=True, metavar="NAME",
              help="Leave out elements and all that depends on them, as in 'tree.*'. Repeatable.")
@takes(*SCENE)
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


@click.command()
@click.argument("scenes", metavar="SCENE...", nargs=-1, shell_complete=complete_scene)
@click.option("--strict", is_flag=True, help="Let warnings fail the check.")
@click.option("--expand", is_flag=True, help="Print the one SCENE as plain elements, a scene, too.")
@click.option("--schema", is_flag=False, flag_value="scene", metavar="[KIND]",
              type=click.Choice(["scene", "study"]),
              help="Print the JSON Schema of scenes, for editors; 'study' for that of study files.")
@takes("set", "elements", "limit", "json")
def check(
    scenes: tuple[str, ...], overrides: dict[str, Any], limits: Limits, strict: bool, expand: bool,
    schema: str | None, console: Console,
) -> int:
    """Validate scenes, and estimate the cost of a run.

    Looks for joints that are not assembled, bodies that overlap, tendon guides
    that coincide, springs and dampers too strong for the step, springs that can
    snap over centre, and unknown quantities. Exits 2 if a scene cannot be run;
    with --strict on warnings, too.
    """
    if schema:
        from sandbox.scene.reference import scene_schema
        from sandbox.sweeps.spec import study_schema

        found = study_schema() if schema == "study" else scene_schema()
        console.document(json.dumps(found, indent=2, ensure_ascii=False))
        return Exit.DONE
    if not scenes:
        raise click.UsageError("Missing argument 'SCENE...'.")
    sources = [Source(word, overrides, limits) for word in scenes]
    if expand:
        from sandbox.scene.expand import to_json

        if len(scenes) > 1:
            raise click.UsageError("Got unexpected extra scenes: --expand prints one.")
        console.document(to_json(sources[0].load().mechanism))
        return Exit.DONE
    text = Console(quiet=console.as_json)
    reports = [report_of(source, text) for source in sources]
    good = all(report["ok"] and not (strict and report["findings"]) for report in reports)
    code = Exit.DONE if good else Exit.INPUT
    return console.finish({"scenes": reports}, code=code) if console.as_json else code


def report_of(source: Source, console: Console) -> dict[str, Any]:
    """Check one scene and print the findings; returns them as JSON data."""
    from sandbox.engine.inspect_hands import reaches
    from sandbox.model.compile import compile_mechanism

    report: dict[str, Any] = {"scene": source.word, "ok": True, "errors": [], "findings": [],
                              "estimate": None, "notes": []}
    lines, others = list[str](), list[Problem]()
    try:
        loaded = source.load()
        found, takes = source.inspect(loaded)
        others = [problem for problem in found if not problem.blocks]
        lines = inspection_lines(others, loaded)
        report |= {"findings": inspection_data(others, loaded), "estimate": takes.data}
        refuse_blocking(found, loaded)
        report["notes"] = list(reaches(compile_mechanism(loaded.mechanism)))
    except SceneError as error:
        report |= {"ok": False, "errors": [problem_data(problem, error.source)
                                           for problem in error.problems]}
        lines = [*(problem.at(error.source) for problem in error.problems), *lines]
        others = [*error.problems, *others]
    if lines:
        console.warn(*lines)
    else:
        console.say(f"{source.word}: ok")
    if report["ok"]:
        console.say(*(f"{source.word}: {line}" for line in (
            takes, *(f"note: {note}" for note in report["notes"]))))
    console.warn(*pages_line(others))
    return report


def inspection_lines(problems: list[Problem], loaded: Loaded) -> list[str]:
    """Format problems, one a line; those that differ only in numbers of names share one."""
    groups: dict[str, list[Problem]] = {}
    for problem in problems:
        groups.setdefault(re.sub(r"(?<=[A-Za-z_])\d+", "#", str(problem)), []).append(problem)
    placed = loaded.placed(first for first, *_ in groups.values())
    return [
        f"{first.at(loaded.name)}{f' (and so for {others} more)' if others else ''}"
        for first, others in zip(placed, (len(group) - 1 for group in groups.values()), strict=True)
    ]


def inspection_data(problems: list[Problem], loaded: Loaded) -> list[dict[str, Any]]:
    """Warnings with their places, as JSON data."""
    names = ("code", "severity", "element", "message", "advice", "path", "line", "column")
    return [{**{name: getattr(problem, name) for name in names},
             "file": problem.file or loaded.name} for problem in loaded.placed(problems)]
