"""The live view on this machine: one page, one WebSocket for each tab, a session behind each.

It listens on 127.0.0.1 only. The page's address holds a random token; all else is refused, and so
are requests of other sites (by their Origin and Host). The page may load nothing.

Each tab has a thread of its own, which alone uses its session: long work, such as a step back, does
not delay other tabs. 60 times a second the thread handles the messages of its tab, advances the
session and sends a frame, unless the page has not drawn the last few: so there is never a queue.
"""

from __future__ import annotations

import contextlib
import http
import json
import secrets
import socket
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.protocol import State
from websockets.sync.server import ServerConnection, serve
from websockets.typing import Origin

from sandbox.errors import OutputError, SandboxError
from sandbox.web.page import html_page, policy, script
from sandbox.web.session import FRAME, Answer, Session

HOST = "127.0.0.1"
MAX_UNSEEN = 6
"""Frames that the page has not drawn yet: enough for a line with a round trip of 0.1 s."""
LATE = 0.1  # a page that is this far behind the clock [s] skips the time that it missed
LOOK_AT_FILES = 0.5  # seconds between two checks whether the scene's files have changed
LONG = 0.3  # seconds after which the page says that the session is busy
SHORTEST_WAIT = 1e-3  # seconds to wait for a message where a frame is late
MAX_TABS = 8
MAX_BYTES = 1 << 16  # of a message
START = '\nglobalThis.sandbox = new Live(document.querySelector("main"));\n'


class Server:
    """Serves a scene until Ctrl-C.

    ``session`` makes the session of a tab; ``first``, made to check the scene, is that of the first
    one. ``port`` 0 is a free one.
    """

    def __init__(
        self, session: Callable[[], Session], first: Session, *, title: str, port: int = 0,
    ) -> None:
        self._session, self._first, self._title = session, [first], title
        self.port, self.token = port, secrets.token_urlsafe(16)
        self._stopping, self._room = threading.Event(), threading.Semaphore(MAX_TABS)

    @property
    def address(self) -> str:
        """Of the page."""
        return f"http://{HOST}:{self.port}/{self.token}"

    def serve(self, ready: Callable[[Server], None]) -> None:
        """Serve until Ctrl-C; call ``ready`` when it listens. OutputError if the port is taken."""
        with self.listening(), contextlib.suppress(KeyboardInterrupt):
            ready(self)
            while True:  # without a timeout Windows would not notice Ctrl-C
                time.sleep(1)

    @contextlib.contextmanager
    def listening(self) -> Iterator[None]:
        """Listen within a ``with`` statement; OutputError if the port is taken."""
        try:
            listener = socket.create_server((HOST, self.port))
        except OSError as error:
            raise OutputError(f"cannot listen on port {self.port}: {error.strerror}; "
                              "without --port a free one is found", code="cannot-listen") from None
        self.port = listener.getsockname()[1]
        server = serve(self._tab, sock=listener, process_request=self._answer, compression=None,
                       origins=[Origin(f"http://{host}") for host in self._hosts],
                       max_size=MAX_BYTES, close_timeout=1)
        thread = threading.Thread(target=server.serve_forever, name="server")
        thread.start()
        try:
            yield
        finally:
            self._stopping.set()
            server.shutdown()
            thread.join()

    @property
    def _hosts(self) -> list[str]:
        return [f"{HOST}:{self.port}", f"localhost:{self.port}"]

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """The page, without data, for requests with the token; None accepts a WebSocket."""
        hosts = request.headers.get_all("Host")
        if len(hosts) != 1 or hosts[0] not in self._hosts:
            return connection.respond(http.HTTPStatus.FORBIDDEN, (
                f"this view answers to {' and '.join(self._hosts)} only: use one of these, through "
                "SSH with the same port on both sides\n"))
        path = request.path.partition("?")[0].removeprefix("/")
        if not secrets.compare_digest(path.encode(), self.token.encode()):
            return connection.respond(http.HTTPStatus.FORBIDDEN, "wrong or missing token\n")
        if request.headers.get("Upgrade", "").lower() == "websocket":
            return None
        code = script(START, "live.js")
        answer = connection.respond(http.HTTPStatus.OK, html_page(self._title, code))
        del answer.headers["Content-Type"]
        sources = " ".join(f"ws://{host}" for host in self._hosts)
        answer.headers.update({
            "Content-Type": "text/html; charset=utf-8", "Cache-Control": "no-store",
            "Referrer-Policy": "no-referrer", "X-Content-Type-Options": "nosniff",
            "Content-Security-Policy":
                f"{policy(code)}; connect-src {sources}; frame-ancestors 'none'"})
        return answer

    def _tab(self, connection: ServerConnection) -> None:
        """Run the session of a tab until it is closed, in a thread of its own."""
        with contextlib.suppress(ConnectionClosed):
            if not self._room.acquire(blocking=False):
                self._refuse(connection, f"{MAX_TABS} tabs run this scene already; close one, and "
                                         "load this page again")
                return
            try:
                session = self._first.pop() if self._first else self._session()
                _Tab(connection, session, self._stopping).play()
            except SandboxError as error:  # the file has become wrong
                self._refuse(connection, f"{error}\ncorrect it, and load this page again")
            finally:
                self._room.release()

    def _refuse(self, connection: ServerConnection, why: str) -> None:
        """Send the reason for a refusal, and wait until the page is closed."""
        connection.send(json.dumps({"error": why}))
        while not self._stopping.is_set():
            with contextlib.suppress(TimeoutError):
                connection.recv(timeout=LOOK_AT_FILES)


class _Tab:
    """A page that shows one session."""

    def __init__(
        self, connection: ServerConnection, session: Session, stopping: threading.Event,
    ) -> None:
        self.connection, self.session, self.stopping = connection, session, stopping
        session.closed = lambda: stopping.is_set() or connection.protocol.state is not State.OPEN
        self.seen = 0  # the last frame that the page has drawn
        self._shown: tuple[int, int] | None = None
        self._files, self._checked = self._stamps(), 0.0
        self._saving: list[threading.Thread] = []

    def send(self, *answers: Answer) -> None:
        for answer in answers:
            self.connection.send(json.dumps(answer, allow_nan=False))

    @contextlib.contextmanager
    def _busy(self) -> Iterator[None]:
        """Tell the page that the session is busy if the work within takes long."""
        def tell() -> None:
            with contextlib.suppress(ConnectionClosed):
                self.send({"working": True})

        timer = threading.Timer(LONG, tell)
        timer.start()
        began = time.perf_counter()
        try:
            yield
        finally:
            timer.cancel()
            timer.join()
            if time.perf_counter() - began >= LONG:
                self.send({"working": False})

    def play(self) -> None:
        """Answer messages and send frames until the page is closed."""
        try:
            with self._busy():
                answers = [self.session.head(), self.session.status()]
            self.send(*answers)
            due = before = time.perf_counter()
            while not self.stopping.is_set():
                due = max(due + FRAME, time.perf_counter() - LATE)
                with contextlib.suppress(TimeoutError):
                    while True:
                        self._handle(self.connection.recv(
                            timeout=max(due - time.perf_counter(), SHORTEST_WAIT)))
                now = time.perf_counter()
                self._advance(min(now - before, LATE))
                before = now
                if now > self._checked + LOOK_AT_FILES:
                    self._checked = now
                    self._reload()
        finally:
            for thread in self._saving:
                thread.join()

    def _handle(self, message: str | bytes) -> None:
        if isinstance(message, str) and message.startswith('{"seen":'):
            with contextlib.suppress(ValueError, TypeError, OverflowError, RecursionError):
                self.seen = int(json.loads(message)["seen"])
            return
        with self._busy():
            answers = self.session.handle(message)
        for answer in answers:
            if callable(answer):
                self._saving.append(threading.Thread(target=self._save, args=(answer,)))
                self._saving[-1].start()
            else:
                self.send(answer)

    def _save(self, save: Callable[[], Answer]) -> None:
        """Save a run while the page plays on; also if the page is closed meanwhile."""
        answer = save()
        with contextlib.suppress(ConnectionClosed):
            self.send(answer)

    def _advance(self, seconds: float) -> None:
        """Advance the session; send changes, and a frame if the page has drawn the last ones."""
        session = self.session
        if session.playing:
            session.advance(seconds)
            if not session.playing:
                self.send(session.status())
        state = session.live.steps, session.ack
        if state != self._shown and session.seq - self.seen < MAX_UNSEEN:
            self._shown = state
            self.send(*session.relisted())
            self.connection.send(session.frame())

    def _reload(self) -> None:
        """Read the scene again if one of its files has changed."""
        session = self.session
        if self._files == self._stamps():
            return
        with self._busy():
            answers = [session.head()] if session.reload() else []
        self._files = self._stamps()
        self.send(*answers, session.status())

    def _stamps(self) -> dict[Path, int]:
        """Times of the last change of the scene's files."""
        loaded, found = self.session.loaded, {}
        source = loaded.origins.source.path
        for path in [*([source] if source else []), *loaded.files]:
            with contextlib.suppress(OSError):
                found[path] = path.stat().st_mtime_ns
        return found
