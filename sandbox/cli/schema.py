"""``sandbox schema``: the JSON Schema of scenes, and of study files."""

from __future__ import annotations

import json
from pathlib import Path

import click

from sandbox.cli.console import Console
from sandbox.cli.options import OUT
from sandbox.whole_files import write_whole


@click.command()
@click.option("--study", is_flag=True, help="That of study files, which 'sandbox sweep' runs.")
@click.option("--out", type=OUT, help="Write it to this file.")
def schema(study: bool, out: Path | None) -> None:
    """Print the JSON Schema of scenes.

    An editor completes and checks a scene whose "$schema" names it.
    """
    if study:
        from sandbox.sweeps.spec import study_schema

        made = study_schema()
    else:
        from sandbox.scene.schema import scene_schema

        made = scene_schema()
    text = json.dumps(made, indent=2, ensure_ascii=False)
    if out is None:
        Console().document(text)
        return
    write_whole(out, text + "\n")
