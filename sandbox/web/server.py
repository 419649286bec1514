"""The live view on this machine: one page, one WebSocket for each tab, a session behind each.

It listens on 127.0.0.1 only. The page's address holds a token drawn by chance; all else is refused,
and so is what another site asks for (its Origin and Host are looked at). The page may load nothing.

Each tab has a thread of its own, which alone touches its session: what takes long there (going
back, another beginning, a file that is read anew) does not delay other tabs.

A clock of 60/s lets the session's time pass. A frame is sent while fewer than so many are under
way, as many as the line holds and half as many more: there is never a queue.
"""

from __future__ import annotations

import asyncio
import concurrent.futures
import contextlib
import functools
import html
import http
import json
import math
import secrets
import signal
import time
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any, TypeVar

from sandbox.errors import OutputError, SandboxError
from sandbox.web.files import LIVE, script, source_hash, styles
from sandbox.web.session import FRAME, Answer, Later, Session
from sandbox.wording import printable

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection
    from websockets.http11 import Request, Response

T = TypeVar("T")
HOST = "127.0.0.1"
INSTALL = "pip install 'sandbox-mechanics[view]'"
FEWEST_UNDER_WAY = 4
LATE = 0.1
"""Seconds behind the clock from which on time that passed is given up."""
LOOK_AT_FILES = 0.5
"""Seconds between two looks at whether the scene's files have changed."""
LONG = 0.3
"""Seconds from which on it is told that something is being worked on."""
MOST_TABS = 8
"""Pages that play at once: each steps a scene of its own."""
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
        self._stop, self._stopping = asyncio.Event(), False
        self._tabs = 0

    @property
    def address(self) -> str:
        """Of the page."""
        return f"http://{HOST}:{self.port}/{self.token}"

    def _hosts(self) -> list[str]:
        return [f"{HOST}:{self.port}", f"localhost:{self.port}"]

    def stop(self) -> None:
        """End :meth:`serve`."""
        self._stop.set()

    async def serve(self, ready: Callable[[Server], None]) -> None:
        """Serve until :meth:`stop`, or Ctrl-C; ``ready`` is called when it listens.

        Raises:
            OutputError: the port cannot be had.
        """
        loop = asyncio.get_running_loop()

        def pressed(_number: int, _frame: FrameType | None) -> None:
            if self._stopping:  # pressed again: something takes long
                raise KeyboardInterrupt
            self._stopping = True
            loop.call_soon_threadsafe(self.stop)

        before = signal.signal(signal.SIGINT, pressed)
        try:
            async with self.listening():
                ready(self)
                await self._stop.wait()
        finally:
            signal.signal(signal.SIGINT, before)

    @contextlib.asynccontextmanager
    async def listening(self) -> AsyncIterator[None]:
        """While this lasts it listens.

        Raises:
            OutputError: the port cannot be had.
        """
        serve = needed()
        try:
            server = await serve(self._tab, HOST, self.port, process_request=self._asked,
                                 compression=None, max_size=MOST_BYTES, close_timeout=1)
        except OSError as error:
            raise OutputError(f"cannot listen on port {self.port}: {error.strerror}; "
                              "without --port a free one is found", code="cannot-listen") from None
        self.port = next(iter(server.sockets)).getsockname()[1]
        try:
            yield
        finally:
            server.close()
            await server.wait_closed()

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

    async def _tab(self, connection: ServerConnection) -> None:
        if self._tabs >= MOST_TABS:
            await _refuse(connection, f"{MOST_TABS} pages play with this scene already; close one, "
                                      "and load this page again")
            return
        self._tabs += 1
        thread = concurrent.futures.ThreadPoolExecutor(1, "tab")
        try:
            await self._play(connection, thread)
        finally:
            self._tabs -= 1
            thread.shutdown(wait=False, cancel_futures=True)

    async def _play(
        self, connection: ServerConnection, thread: concurrent.futures.Executor,
    ) -> None:
        """Let a tab play until it is closed."""
        from websockets.exceptions import ConnectionClosed

        try:
            session = self._first.pop() if self._first else (
                await asyncio.get_running_loop().run_in_executor(thread, self._session))
        except SandboxError as error:  # its file is wrong by now
            await _refuse(connection, f"{error}\nmend it, and load this page again")
            return
        tab = _Tab(connection, session, thread)
        tasks = [asyncio.create_task(work()) for work in (tab.listen, tab.pace, tab.watch_files)]
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            for task in done:
                task.result()  # what went wrong in it is not lost
        except ConnectionClosed:
            pass
        finally:
            session.closed = True
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, *tab.saving, return_exceptions=True)


async def _refuse(connection: ServerConnection, why: str) -> None:
    """Say why a page does not play, and wait until it is closed."""
    await connection.send(json.dumps({"error": why}))
    await connection.wait_closed()


class _Tab:
    """One page that looks at one session."""

    def __init__(
        self, connection: ServerConnection, session: Session, thread: concurrent.futures.Executor,
    ) -> None:
        self.connection, self.session, self._thread = connection, session, thread
        self.sent: dict[int, float] = {}
        """When frames were sent that are under way."""
        self.round_trip = 0.0
        self._shown: tuple[int, int] | None = None
        self._files = _stamps(session)
        self._long = 0
        """Things under way that take long."""
        self.saving: list[asyncio.Task[None]] = []
        """Runs under way to disk."""

    async def say(self, *answers: Answer) -> None:
        for answer in answers:
            await self.connection.send(json.dumps(answer, allow_nan=False))

    async def _off(self, work: Callable[..., T], *words: Any, **more: Any) -> T:
        """What the session's thread makes of some work; that it takes long is told."""
        call = functools.partial(work, *words, **more)
        doing = asyncio.get_running_loop().run_in_executor(self._thread, call)
        done, _ = await asyncio.wait([doing], timeout=LONG)
        if not done:
            await self._tell_working(+1)
            await asyncio.wait([doing])
            await self._tell_working(-1)
        return doing.result()

    async def _tell_working(self, more: int) -> None:
        """Say it when the first thing takes long, and when none does any more."""
        before, self._long = self._long, self._long + more
        if bool(before) != bool(self._long):
            await self.say({"working": bool(self._long)})

    async def listen(self) -> None:
        session = self.session
        await self.say(*await self._off(lambda: [session.head(), session.status()]))
        async for message in self.connection:
            if self._seen(message):
                continue
            for answer in await self._off(session.hear, message):
                if callable(answer):
                    self.saving.append(asyncio.create_task(self._save(answer)))
                else:
                    await self.say(answer)

    async def _save(self, save: Later) -> None:
        """Save a run, beside what else the page asks; it is saved even if nobody waits for it."""
        from websockets.exceptions import ConnectionClosed

        answer = await asyncio.to_thread(save)
        with contextlib.suppress(ConnectionClosed):
            await self.say(answer)

    def _seen(self, message: str | bytes) -> bool:
        """Whether it says only that a frame was drawn; then that is noted."""
        if not isinstance(message, str) or not message.startswith('{"seen":'):
            return False
        with contextlib.suppress(ValueError, TypeError, OverflowError, RecursionError):
            seen = int(json.loads(message)["seen"])
            now = time.perf_counter()
            if seen in self.sent:
                took = now - self.sent[seen]
                self.round_trip += 0.2 * (took - self.round_trip)
            self.sent = {seq: at for seq, at in self.sent.items() if seq > seen}
        return True

    async def pace(self) -> None:
        due, before = time.perf_counter(), time.perf_counter()
        while True:
            due += FRAME
            now = time.perf_counter()
            if now > due + LATE:
                due = now
            await asyncio.sleep(max(0.0, due - now))
            now = time.perf_counter()
            passed, before = min(now - before, LATE), now
            most = max(FEWEST_UNDER_WAY, math.ceil(1.5 * self.round_trip / FRAME))
            told, frame = await self._off(self._pass, passed, room=len(self.sent) < most)
            await self.say(*told)
            if frame is not None:
                self.sent[self.session.seq] = time.perf_counter()
                await self.connection.send(frame)

    def _pass(self, seconds: float, *, room: bool) -> tuple[list[Answer], bytes | None]:
        """Let time pass; what there is to say then, and a frame of what has changed."""
        session = self.session
        was = session.playing
        if was:
            session.advance(seconds)
        told = [session.status()] if was and not session.playing else []
        state = session.live.steps, session.ack
        if state == self._shown or not room:
            return told, None
        self._shown = state
        return [*told, *session.relisted()], session.frame()

    async def watch_files(self) -> None:
        while True:
            await asyncio.sleep(LOOK_AT_FILES)
            await self.say(*await self._off(self._reloaded))

    def _reloaded(self) -> list[Answer]:
        """Read the scene anew if one of its files has changed; what there is to say then."""
        session, before = self.session, self._files
        self._files = _stamps(session)
        if before == self._files:
            return []
        good = session.reload()
        self._files = _stamps(session)
        return [*([session.head()] if good else []), session.status()]


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
        from websockets.asyncio.server import serve
    except ImportError:
        raise OutputError(f"the live view needs websockets 14 or newer: {INSTALL}",
                          code="missing-package") from None
    return serve
