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

from sandbox.cli.check import ready
from sandbox.cli.console import Console, Exit, monitored
from sandbox.cli.options import RENDERS, Source, safe_name
from sandbox.errors import optional
from sandbox.web.session import Found, Session


def view(scene: Source, port: int | None, no_browser: bool) -> int:
    """Serve a scene until Ctrl-C."""
    optional("websockets.sync.server", "'sandbox-mechanics[view]'")
    from sandbox.web.server import Server
    console = Console()

    def read(changed: Mapping[str, Any]) -> Found:
        loaded, _, warnings = ready(dataclasses.replace(scene, overrides=changed))
        return Found(loaded, warnings)

    def session() -> Session:
        return Session(read, dict(scene.overrides), lambda name: RENDERS / safe_name(name))

    with monitored(console):
        first = session()
    console.warn(*first.warnings)

    def started(server: Server) -> None:
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
        Server(session, first, title=title, port=port or 0).serve(started)
    return Exit.INTERRUPTED
