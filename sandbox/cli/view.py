"""``sandbox view``: an interactive viewer in the browser."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.check import inspect_scene, inspection_lines, refuse_blocking
from sandbox.cli.console import Console, compilation_notices
from sandbox.cli.failures import Exit, pages_line
from sandbox.cli.options import limit_option, scene_options
from sandbox.cli.runs import default_directory
from sandbox.cli.scenes import load, scene_argument, scene_path

if TYPE_CHECKING:
    from sandbox.scene.read.limits import Limits
    from sandbox.web.server import Server


@click.command()
@scene_argument
@scene_options
@click.option("--port", type=click.IntRange(0, 65535), default=0, metavar="N",
              help="Port to listen on; by default a free one.")
@click.option("--no-browser", is_flag=True, help="Only print the address.")
@limit_option
def view(
    scene: str, overrides: dict[str, Any], port: int, no_browser: bool, limits: Limits,
) -> int:
    """Open SCENE in the browser: run, pause, pull bodies, move sliders.

    Serves a page on this machine only, until Ctrl-C. The scene is reloaded when
    its file is saved. A session can be saved as a scene that reproduces it
    exactly. Needs the extra 'view'.
    """
    from sandbox.web.server import Server, needed
    from sandbox.web.session import Found, Session

    needed()
    console, path = Console(), scene_path(scene)

    def read(changed: Mapping[str, Any]) -> Found:
        loaded = load(path, overrides=dict(changed), limits=limits)
        problems = inspect_scene(loaded, limits).problems
        refuse_blocking(problems, loaded)
        return Found(loaded, [*inspection_lines(problems, loaded), *pages_line(problems)])

    def session() -> Session:
        return Session(read, overrides, default_directory)

    with compilation_notices(console):
        first = session()
    console.warn(*first.warnings)

    def ready(server: Server) -> None:
        console.say(server.address, f"from another machine: {ssh_line(server.port)}",
                    "Ctrl-C ends it")
        sys.stdout.flush()
        if not no_browser and has_browser():
            import webbrowser

            webbrowser.open(opened.enter_context(redirect_to(server.address)).as_uri())

    with contextlib.ExitStack() as opened:
        title = first.scene.title or first.scene.name
        Server(session, first, title=title, port=port).serve(ready)
    return Exit.INTERRUPTED


@contextlib.contextmanager
def redirect_to(address: str) -> Iterator[Path]:
    """A temporary file, readable by its owner only, that redirects a browser to an address.

    An address in the browser's own arguments could be read by all who may list processes.
    """
    import html
    import tempfile

    from sandbox.atomic_files import write_atomic

    link = html.escape(address, quote=True)
    with tempfile.TemporaryDirectory(prefix="sandbox-") as folder:
        file = Path(folder, "view.html")
        write_atomic(file, (
            '<!doctype html><meta charset="utf-8"><meta name="referrer" content="no-referrer">'
            f'<meta http-equiv="refresh" content="0; url={link}"><title>sandbox view</title>'
            f'<a href="{link}">to the view</a>\n'))
        file.chmod(0o600)
        yield file


def ssh_line(port: int) -> str:
    """The command that forwards the page to another machine, at the same address."""
    import getpass
    import platform

    return f"ssh -N -L {port}:127.0.0.1:{port} {getpass.getuser()}@{platform.node()}"


def has_browser() -> bool:
    """Whether a browser window can be opened."""
    if os.environ.get("SSH_CONNECTION"):
        return False
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
