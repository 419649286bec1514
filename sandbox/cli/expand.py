"""``sandbox expand``: a scene spelled out as plain elements."""

from __future__ import annotations

from typing import Any

import click

from sandbox.cli.console import Console
from sandbox.cli.options import limit_options, override_option
from sandbox.cli.scenes import complete_scene, load, scene_path


@click.command()
@click.argument("scene", shell_complete=complete_scene)
@override_option
@limit_options
def expand(scene: str, overrides: dict[str, Any], **limits: Any) -> None:
    """Print SCENE as plain bodies, joints and tendons.

    Assemblies, templates, parameters and units are gone; what is printed is
    itself a scene.
    """
    from sandbox.scene.expand import to_json

    loaded = load(scene_path(scene), overrides=overrides, limits=limits)
    Console().document(to_json(loaded.mechanism))
