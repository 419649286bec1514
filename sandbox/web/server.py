"""The live view on this machine: one page, one WebSocket for each tab, a session behind each.

It listens on 127.0.0.1 only. The page's address holds a random token; all else is refused, and so
are requests of other sites (by their Origin and Host). The page may load nothing.

Each tab has a thread of its own, which alone touches its session: a tab that takes long, to step
back or to read a file again, does not delay other tabs. 60 times a second the thread handles the
messages of its tab, lets the session's time pass and sends a frame. It sends one only while few
frames are unanswered: half as many again as the line holds. So there is never a queue.
"""

from __future__ import annotations

import contextlib
import html
import http
import json
import math
import secrets
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sandbox.errors import OutputError, SandboxError
from sandbox.web.page import LIVE, script, source_hash, styles
from sandbox.web.session import FRAME, Answer, Later, Session
from sandbox.wording import printable

if TYPE_CHECKING:
    from websockets.http11 import Request, Response
    from websockets.sync.server import ServerConnection

HOST = "127.0.0.1"
INSTALL = "pip install 'sandbox-mechanics[view]'"
FEWEST_UNDER_WAY = 4
LATE = 0.1
"""A page that is this far behind the clock [s] skips the time that it missed."""
LOOK_AT_FILES = 0.5
"""Seconds between two checks whether the scene's files have changed."""
LONG = 0.3
"""Seconds after which the page says that the session is busy."""
SHORTEST_WAIT = 1e-3
"""Seconds to wait for a message where a frame is late."""
MOST_TABS = 8
"""Pages at once: each steps a scene of its own."""
MOST_BYTES = 1 << 16
"""Of a message."""
START = '\nlive(document.querySelector("main"), socketLink(location.href));\n'
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width,initial-scale=1">
<title>{title}</title><link rel="icon" href="data:,">
<style>{styles}</style></head>
<body><main><noscript>This page draws with a script, which is off.</noscript></main>
<script type="module">{script}</script></body></html>
"""


class Server:
    """Serves a scene until it is told to stop.

    Args:
        session: makes a session; each tab gets its own.
        first: the session of the first tab, which was made to see whether the scene can be used.
        title: of the page.
        port: to listen on; 0 for a free one.
    """

    def __init__(
        self, session: Callable[[], Session], first: Session, *, title: str, port: int = 0,
    ) -> None:
        self._session, self._first, self._title = session, [first], title
        self.port, self.token = port, secrets.token_urlsafe(16)
        self._stopping, self._room = threading.Event(), threading.Semaphore(MOST_TABS)

    @property
    def address(self) -> str:
        """Of the page."""
        return f"http://{HOST}:{self.port}/{self.token}"

    def _hosts(self) -> list[str]:
        return [f"{HOST}:{self.port}", f"localhost:{self.port}"]

    def serve(self, ready: Callable[[Server], None]) -> None:
        """Serve until Ctrl-C; ``ready`` is called when it listens.

        Raises:
            OutputError: the port cannot be used.
        """
        with self.listening(), contextlib.suppress(KeyboardInterrupt):
            ready(self)
            while True:  # without a timeout Windows would not notice Ctrl-C
                time.sleep(1)

    @contextlib.contextmanager
    def listening(self) -> Iterator[None]:
        """Listen within a ``with`` statement.

        Raises:
            OutputError: the port cannot be used.
        """
        serve = needed()
        try:
            server = serve(self._tab, HOST, self.port, process_request=self._asked,
                           compression=None, max_size=MOST_BYTES, close_timeout=1)
        except OSError as error:
            raise OutputError(f"cannot listen on port {self.port}: {error.strerror}; "
                              "without --port a free one is found", code="cannot-listen") from None
        self.port = server.socket.getsockname()[1]
        thread = threading.Thread(target=server.serve_forever, name="server")
        thread.start()
        try:
            yield
        finally:
            self._stopping.set()
            server.shutdown()
            thread.join()

    # -- the page ---------------------------------------------------------------------------

    def _asked(self, connection: ServerConnection, request: Request) -> Response | None:
        """The page for who knows the token; None lets a WebSocket in."""
        path = request.path.partition("?")[0].removeprefix("/")
        known = secrets.compare_digest(path.encode(), self.token.encode())
        if not _is_one_of(request.headers.get_all("Host"), self._hosts()):
            return connection.respond(http.HTTPStatus.FORBIDDEN, (
                f"this view answers to {' and '.join(self._hosts())} only: ask for it by one of "
                "these, through SSH with the same port on both sides\n"))
        if not known:
            return connection.respond(http.HTTPStatus.FORBIDDEN, "wrong or missing token\n")
        if request.headers.get("Upgrade", "").lower() == "websocket":
            if _is_one_of(request.headers.get_all("Origin"),
                          [f"http://{host}" for host in self._hosts()]):
                return None
            return connection.respond(http.HTTPStatus.FORBIDDEN, "asked for by another page\n")
        answer = connection.respond(http.HTTPStatus.OK, page(self._title))
        for name, value in self._headers().items():
            if name in answer.headers:
                del answer.headers[name]
            answer.headers[name] = value
        return answer

    def _headers(self) -> dict[str, str]:
        sources = " ".join(f"ws://{host}" for host in self._hosts())
        return {
            "Content-Type": "text/html; charset=utf-8", "Cache-Control": "no-store",
            "Referrer-Policy": "no-referrer", "X-Content-Type-Options": "nosniff",
            "Content-Security-Policy":
                f"default-src 'none'; script-src {source_hash(code())}; "
                f"style-src {source_hash(styles())}; img-src data: blob:; media-src blob:; "
                f"connect-src {sources}; base-uri 'none'; form-action 'none'; "
                "frame-ancestors 'none'"}

    # -- one tab ----------------------------------------------------------------------------

    def _tab(self, connection: ServerConnection) -> None:
        """Play with a tab until it is closed, in a thread of its own."""
        from websockets.exceptions import ConnectionClosed

        with contextlib.suppress(ConnectionClosed):
            if not self._room.acquire(blocking=False):
                self._refuse(connection, f"{MOST_TABS} pages play with this scene already; close "
                                         "one, and load this page again")
                return
            try:
                _Tab(connection, self._first.pop() if self._first else self._session()).play(
                    self._stopping)
            except SandboxError as error:  # the file has become wrong
                self._refuse(connection, f"{error}\nmend it, and load this page again")
            finally:
                self._room.release()

    def _refuse(self, connection: ServerConnection, why: str) -> None:
        """Say why a page does not play, and wait until it is closed."""
        connection.send(json.dumps({"error": why}))
        while not self._stopping.is_set():
            with contextlib.suppress(TimeoutError):
                connection.recv(timeout=LOOK_AT_FILES)


class _Tab:
    """A page that shows one session."""

    def __init__(self, connection: ServerConnection, session: Session) -> None:
        self.connection, self.session = connection, session
        self.sent: dict[int, float] = {}
        """When the frames that the page has not confirmed were sent."""
        self.round_trip = 0.0
        self._shown: tuple[int, int] | None = None
        self._files, self._checked = _stamps(session), 0.0
        self._saving: list[threading.Thread] = []

    def say(self, *answers: Answer) -> None:
        for answer in answers:
            self.connection.send(json.dumps(answer, allow_nan=False))

    @contextlib.contextmanager
    def _busy(self) -> Iterator[None]:
        """Say so if what is done within takes long."""
        told: list[bool] = []

        def tell() -> None:
            told.append(True)
            self.say({"working": True})

        timer = threading.Timer(LONG, tell)
        timer.start()
        try:
            yield
        finally:
            timer.cancel()
            timer.join()
            if told:
                self.say({"working": False})

    def play(self, stopping: threading.Event) -> None:
        """Answer messages and send frames until the page is closed."""
        from websockets.protocol import State

        self.session.closed = lambda: (
            stopping.is_set() or self.connection.protocol.state is not State.OPEN)
        try:
            with self._busy():
                answers = [self.session.head(), self.session.status()]
            self.say(*answers)
            due = before = time.perf_counter()
            while not stopping.is_set():
                due = max(due + FRAME, time.perf_counter() - LATE)
                self.listen(due)
                now = time.perf_counter()
                self.go_on(min(now - before, LATE))
                before = now
                if now > self._checked + LOOK_AT_FILES:
                    self._checked = now
                    self.reload()
        finally:
            for thread in self._saving:
                thread.join()

    def listen(self, until: float) -> None:
        """Handle the messages that come until a time of the clock."""
        with contextlib.suppress(TimeoutError):
            while True:
                self.hear(self.connection.recv(
                    timeout=max(until - time.perf_counter(), SHORTEST_WAIT)))

    def hear(self, message: str | bytes) -> None:
        if self._seen(message):
            return
        with self._busy():
            answers = self.session.hear(message)
        for answer in answers:
            if callable(answer):
                self._saving.append(threading.Thread(target=self._save, args=(answer,)))
                self._saving[-1].start()
            else:
                self.say(answer)

    def _save(self, save: Later) -> None:
        """Save a run while the page plays on; also if the page is closed meanwhile."""
        from websockets.exceptions import ConnectionClosed

        answer = save()
        with contextlib.suppress(ConnectionClosed):
            self.say(answer)

    def _seen(self, message: str | bytes) -> bool:
        """Whether it only says that a frame was drawn; then that is noted."""
        if not isinstance(message, str) or not message.startswith('{"seen":'):
            return False
        with contextlib.suppress(ValueError, TypeError, OverflowError, RecursionError):
            seen = int(json.loads(message)["seen"])
            if seen in self.sent:
                took = time.perf_counter() - self.sent[seen]
                self.round_trip += 0.2 * (took - self.round_trip)
            self.sent = {seq: at for seq, at in self.sent.items() if seq > seen}
        return True

    def go_on(self, seconds: float) -> None:
        """Let time pass; send what has changed, and a frame if the line has room for one."""
        session = self.session
        if session.playing:
            session.advance(seconds)
            if not session.playing:
                self.say(session.status())
        state = session.live.steps, session.ack
        most = max(FEWEST_UNDER_WAY, math.ceil(1.5 * self.round_trip / FRAME))
        if state == self._shown or len(self.sent) >= most:
            return
        self._shown = state
        self.say(*session.relisted())
        frame = session.frame()
        self.sent[session.seq] = time.perf_counter()
        self.connection.send(frame)

    def reload(self) -> None:
        """Read the scene again if one of its files has changed."""
        session, before = self.session, self._files
        self._files = _stamps(session)
        if before == self._files:
            return
        with self._busy():
            answers = [session.head()] if session.reload() else []
        self._files = _stamps(session)
        self.say(*answers, session.status())


def _is_one_of(said: list[str], known: list[str]) -> bool:
    """Whether a header was sent once, and says what is known."""
    return len(said) == 1 and said[0] in known


def _stamps(session: Session) -> dict[Path, int]:
    """When each file of a scene was written last."""
    source = session.loaded.origins.source.path
    found = {}
    for path in [*([source] if source else []), *session.loaded.files]:
        with contextlib.suppress(OSError):
            found[path] = path.stat().st_mtime_ns
    return found


def code() -> str:
    """The script of the page."""
    return script(*LIVE) + START


def page(title: str) -> str:
    """The page; whatever it shows comes by the WebSocket."""
    return PAGE.format(title=html.escape(printable(title)), styles=styles(), script=code())


def needed() -> Any:
    """What serves.

    Raises:
        OutputError: it is not installed; with how to.
    """
    try:
        from websockets.sync.server import serve
    except ImportError:
        raise OutputError(f"the live view needs websockets 14 or newer: {INSTALL}",
                          code="missing-package") from None
    return serve
