"""``sandbox view``: play with a scene in a browser, while it runs."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.compiling import compilation_notices
from sandbox.cli.console import Console
from sandbox.cli.exits import Exit
from sandbox.cli.inspection import inspection_lines, look_over, refuse_blocking
from sandbox.cli.options import chosen_limits, limit_options, override_option
from sandbox.cli.output import default_directory
from sandbox.cli.scenes import complete_scene, load, scene_path
from sandbox.pages import page_of, read_on

if TYPE_CHECKING:
    from sandbox.show.server import Server


@click.command()
@click.argument("scene", shell_complete=complete_scene)
@override_option
@click.option("--port", type=click.IntRange(0, 65535), default=0, metavar="N",
              help="Where to listen; by default a free port.")
@click.option("--no-browser", is_flag=True, help="Only say the address.")
@limit_options
def view(
    scene: str, overrides: dict[str, Any], port: int, no_browser: bool, **limits: Any,
) -> int:
    """Play with SCENE in a browser: run, pause, pull bodies, move sliders.

    Serves a page on this machine only, until Ctrl-C. The scene is read anew when
    its file is saved. What was played can be saved as a scene that runs again to
    the same bytes. Needs the extra 'view'.
    """
    import asyncio

    from sandbox.show.server import Server, needed
    from sandbox.show.session import Found, Session

    needed()
    console, path = Console(), scene_path(scene)

    def read(changed: Mapping[str, Any]) -> Found:
        loaded = load(path, overrides=dict(changed), limits=limits)
        problems = look_over(loaded, chosen_limits(limits)).problems
        refuse_blocking(problems, loaded)
        return Found(loaded, inspection_lines(problems, loaded))

    def session() -> Session:
        return Session(read, overrides, default_directory)

    with compilation_notices(console):
        first = session()
    console.warn(*first.warnings, *read_on(map(page_of, first.warnings)))

    def ready(server: Server) -> None:
        console.say(server.address, f"from another machine: {ssh_line(server.port)}",
                    "Ctrl-C ends it")
        sys.stdout.flush()
        if not no_browser and has_browser():
            import webbrowser

            webbrowser.open(opened.enter_context(leading_to(server.address)).as_uri())

    async def serve() -> None:
        title = first.scene.title or first.scene.name
        await Server(session, first, title=title, port=port).serve(ready)

    with contextlib.ExitStack() as opened:
        asyncio.run(serve())
    return Exit.INTERRUPTED


@contextlib.contextmanager
def leading_to(address: str) -> Iterator[Path]:
    """A file that leads a browser to an address, for its owner's eyes only, while this lasts.

    An address that is handed to the browser itself can be read by all who may list processes.
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
    """What to type on another machine to see the page there, at the same address."""
    import getpass
    import platform

    return f"ssh -N -L {port}:127.0.0.1:{port} {getpass.getuser()}@{platform.node()}"


def has_browser() -> bool:
    """Whether a window can be opened where somebody sees it."""
    if os.environ.get("SSH_CONNECTION"):
        return False
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
