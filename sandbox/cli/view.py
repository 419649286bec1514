"""``sandbox view``: play with a scene in the browser."""

from __future__ import annotations

import contextlib
import dataclasses
import getpass
import html
import os
import platform
import sys
import tempfile
import webbrowser
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sandbox.cli.check import inspection_lines
from sandbox.cli.console import Console, Exit, compilation_notices, pages_line
from sandbox.cli.options import RENDERS, Source, refuse_blocking, safe_name
from sandbox.web.server import Server, needed
from sandbox.web.session import Found, Session


def view(scene: Source, port: int, no_browser: bool) -> int:
    """Serve a scene until Ctrl-C."""
    needed()
    console = Console()

    def read(changed: Mapping[str, Any]) -> Found:
        loaded = dataclasses.replace(scene, overrides=changed).load()
        problems = scene.inspect(loaded).problems
        refuse_blocking(problems, loaded)
        return Found(loaded, [*inspection_lines(problems, loaded), *pages_line(problems)])

    def session() -> Session:
        return Session(read, dict(scene.overrides), lambda name: RENDERS / safe_name(name))

    with compilation_notices(console):
        first = session()
    console.warn(*first.warnings)

    def ready(server: Server) -> None:
        console.say(server.address, "from another machine: ssh -N -L "
                    f"{server.port}:127.0.0.1:{server.port} {getpass.getuser()}@{platform.node()}",
                    "Ctrl-C ends it")
        sys.stdout.flush()
        if not no_browser and has_window and not os.environ.get("SSH_CONNECTION"):
            folder = opened.enter_context(tempfile.TemporaryDirectory(prefix="sandbox-"))
            file, link = Path(folder, "view.html"), html.escape(server.address, quote=True)
            file.touch(0o600)  # other users could read an address among the browser's arguments
            file.write_text(
                '<!doctype html><meta charset="utf-8"><meta name="referrer" content="no-referrer">'
                f'<meta http-equiv="refresh" content="0; url={link}"><title>sandbox view</title>'
                f'<a href="{link}">to the view</a>\n')
            webbrowser.open(file.as_uri())

    has_window = sys.platform in ("win32", "darwin") or bool(
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    with contextlib.ExitStack() as opened:
        title = first.scene.title or first.scene.name
        Server(session, first, title=title, port=port).serve(ready)
    return Exit.INTERRUPTED
