"""``sandbox export``: a scene as a model for another program."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.atomic_files import write_atomic
from sandbox.cli.console import Console
from sandbox.cli.options import OUT, limit_option, scene_options
from sandbox.cli.scenes import load, scene_argument, scene_path
from sandbox.errors import SceneError

if TYPE_CHECKING:
    from sandbox.scene.read.limits import Limits


def read_format(ctx: click.Context, param: click.Parameter, word: str) -> str:
    """Check the name of a format.

    Raises:
        BadParameter: it is unknown; with a suggestion.
    """
    from sandbox.export import FORMATS
    from sandbox.wording import listed, meant, quoted

    if word not in FORMATS:
        raise click.BadParameter(
            f"{quoted(word)} is no format to export to.{meant(word, FORMATS)} "
            f"Allowed: {listed(FORMATS)}.", ctx, param)
    return word


@click.command()
@scene_argument
@click.option("--format", "--to", "form", metavar="FORMAT", default="mjcf", show_default=True,
              callback=read_format,
              help="Format: mjcf, a model for MuJoCo, or pymunk, a script in Python.")
@click.option("--out", type=OUT, metavar="FILE", help="File to write; stdout by default.")
@click.option("--without", multiple=True, metavar="NAME",
              help="Leave out an element and all that depends on it; patterns such as 'tree.*' "
                   "too. Repeatable.")
@scene_options
@limit_option
def export(
    scene: str, form: str, out: Path | None, without: tuple[str, ...],
    overrides: dict[str, Any], limits: Limits,
) -> None:
    """Export SCENE as a MuJoCo model (MJCF), or as a Python script for pymunk.

    Elements without a counterpart are named, and nothing is written unless
    --without leaves them out. Other differences are printed to stderr.
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
        console.warn(f"{loaded.name}: note: {note}")
    if made.left_out:
        console.warn(f"left out: {', '.join(made.left_out)}")
    if out is not None:
        console.say(f"wrote {out}")
