"""``sandbox schema``: the JSON Schema of scenes."""

from __future__ import annotations

import json
from pathlib import Path

import click

from sandbox.cli.console import Console
from sandbox.cli.options import OUT
from sandbox.whole_files import write_whole


@click.command()
@click.option("--out", type=OUT, help="Write it to this file.")
def schema(out: Path | None) -> None:
    """Print the JSON Schema of scenes.

    An editor completes and checks a scene whose "$schema" names it.
    """
    from sandbox.scene.schema import scene_schema

    text = json.dumps(scene_schema(), indent=2, ensure_ascii=False)
    if out is None:
        Console().document(text)
        return
    write_whole(out, text + "\n")
