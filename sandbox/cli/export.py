"""``sandbox export``: a scene as another program's model."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from sandbox.atomic_files import write_atomic
from sandbox.cli.console import Console
from sandbox.cli.options import OUT, limit_options, override_option
from sandbox.cli.scenes import complete_scene, load, scene_path
from sandbox.errors import SceneError


def read_format(ctx: click.Context, param: click.Parameter, word: str) -> str:
    """A format that can be written; others are refused with those that can."""
    from sandbox.export import FORMATS
    from sandbox.wording import listed, meant, quoted

    if word not in FORMATS:
        raise click.BadParameter(
            f"{quoted(word)} is no format to export to.{meant(word, FORMATS)} "
            f"Allowed: {listed(FORMATS)}.", ctx, param)
    return word


@click.command()
@click.argument("scene", shell_complete=complete_scene)
@click.option("--format", "form", metavar="FORMAT", default="mjcf", show_default=True,
              callback=read_format, help="What to write: mjcf, a model for MuJoCo.")
@click.option("--out", type=OUT, metavar="FILE",
              help="Write it to this file; printed by default.")
@click.option("--without", multiple=True, metavar="NAME",
              help="Leave an element out, with all that hangs on it; patterns such as 'tree.*' "
                   "too. May be given several times.")
@override_option
@limit_options
def export(
    scene: str, form: str, out: Path | None, without: tuple[str, ...],
    overrides: dict[str, Any], **limits: Any,
) -> None:
    """Write SCENE as a model for another program.

    Elements that have no counterpart there are named, and nothing is written
    unless --without leaves them out. What differs otherwise is told on stderr.
    """
    from sandbox.export import export_mechanism

    loaded = load(scene_path(scene), overrides=overrides, limits=limits)
    try:
        made = export_mechanism(loaded.mechanism, format=form, without=without)
    except SceneError as error:
        raise SceneError(error.problems, loaded.name) from None
    console = Console()
    if out is None:
        console.document(made.text.rstrip("\n"))
    else:
        write_atomic(out, made.text)
    for note in made.notes:
        console.warn(f"note: {note}")
    if made.left_out:
        console.warn(f"left out: {', '.join(made.left_out)}")
    if out is not None:
        console.say(f"wrote {out}")
