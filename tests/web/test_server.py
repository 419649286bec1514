"""The server of the live view: who is let in, what is sent, when a file changes; no browser."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest

from sandbox.errors import OutputError
from sandbox.scene.read.load import read_scene
from sandbox.web import server as served
from sandbox.web.server import Server, page
from sandbox.web.session import Found, Session
from tests.cli.conftest import FIRST_RUN

from .test_session import PULLED

websockets = pytest.importorskip("websockets", reason="the extra 'view' is not installed")


def played_with(work: Callable[[Server], Awaitable[None]], file: Path) -> None:
    """Serve a scene's file while some work is done."""
    file.write_text(json.dumps(PULLED))

    def session() -> Session:
        return Session(lambda overrides: Found(read_scene(file, overrides=overrides)), {},
                       lambda name: file.parent / name)

    async def run() -> None:
        server = Server(session, session(), title="pulled & <b>")
        async with server.listening():
            await asyncio.wait_for(work(server), 60)

    asyncio.run(run())


def connected(server: Server, **more: Any) -> Any:
    more = {"origin": f"http://127.0.0.1:{server.port}", **more}
    return websockets.connect(server.address.replace("http", "ws"), **more)


async def next_json(socket_: Any, *, working: bool = False) -> dict[str, Any]:
    """The next text, but no display list; that something takes long only if asked."""
    while True:
        message = await socket_.recv()
        if isinstance(message, bytes):
            await socket_.send('{"seen": 1000000}')
        elif "relisted" not in (found := json.loads(message)) and (
                working or "working" not in found):
            return dict(found)


async def until_silent(socket_: Any) -> AsyncIterator[str | bytes]:
    """What comes until nothing does for half a second."""
    with contextlib.suppress(TimeoutError):
        while True:
            yield await asyncio.wait_for(socket_.recv(), 0.5)


def fetched(address: str, **headers: str) -> tuple[int, dict[str, str], str]:
    try:
        with urllib.request.urlopen(urllib.request.Request(address, headers=headers)) as answer:
            return answer.status, dict(answer.headers), answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, {}, error.read().decode()


def test_the_page_is_for_who_knows_the_token(tmp_path: Path) -> None:
    async def work(server: Server) -> None:
        root = f"http://127.0.0.1:{server.port}/"
        status, headers, text = await asyncio.to_thread(fetched, server.address)
        assert status == 200
        assert text == page("pulled & <b>")
        assert "<title>pulled &amp; &lt;b&gt;</title>" in text
        policy = headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy
        assert "unsafe" not in policy
        assert headers["Cache-Control"] == "no-store"
        assert text.isascii()
        for path in ("", "x", server.token[:-1], f"{server.token}/x", "favicon.ico"):
            assert (await asyncio.to_thread(fetched, root + path))[0] == 403
        # a name that somebody let lead to 127.0.0.1, or another port of a line through SSH
        for host in ("evil.example", "localhost:1"):
            status, _, text = await asyncio.to_thread(fetched, server.address, Host=host)
            assert status == 403
            assert f"answers to 127.0.0.1:{server.port} and localhost:{server.port} only" in text
            assert "token" not in text

    played_with(work, tmp_path / "pulled.json")


def test_a_title_with_half_a_character_is_spelled_out() -> None:
    assert b"a\\udcff" in page("a\udcff").encode()


def test_a_wrong_word_of_what_was_seen_does_no_harm(tmp_path: Path) -> None:
    async def work(server: Server) -> None:
        async with connected(server) as line:
            for said in ("1e999", "[" * 5000, '"x"', "null"):
                await line.send('{"seen": ' + said + "}")
            await line.send('{"do": "pause"}')
            while (await next_json(line)).get("status", {}).get("playing", True):
                pass

    played_with(work, tmp_path / "pulled.json")


def test_another_page_is_not_let_in(tmp_path: Path) -> None:
    async def work(server: Server) -> None:
        for more in ({"origin": "http://evil.example"}, {"origin": None}):
            with pytest.raises(websockets.exceptions.InvalidStatus, match="403"):
                async with connected(server, **more):
                    pass
        async with connected(server, origin=f"http://localhost:{server.port}"):
            pass
        if sys.platform == "linux":  # where all of 127 is this machine
            with socket.socket() as other, pytest.raises(OSError, match="refused"):
                other.connect(("127.0.0.2", server.port))

    played_with(work, tmp_path / "pulled.json")


def test_a_header_that_is_sent_twice_is_refused_without_a_word_in_the_terminal(
    tmp_path: Path, caplog: pytest.LogCaptureFixture,
) -> None:
    async def work(server: Server) -> None:
        own = f"127.0.0.1:{server.port}"
        upgrade = ("Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13",
                   "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==")
        for lines in ((f"Host: {own}", "Host: evil.example"), (
                f"Host: {own}", *upgrade, f"Origin: http://{own}", "Origin: http://evil.example")):
            reader, writer = await asyncio.open_connection("127.0.0.1", server.port)
            head = "\r\n".join((f"GET /{server.token} HTTP/1.1", *lines))
            writer.write(f"{head}\r\n\r\n".encode())
            assert b" 403 " in await reader.readline()
            writer.close()
        assert caplog.records == []

    played_with(work, tmp_path / "pulled.json")


def test_no_more_frames_are_under_way_than_the_line_holds(tmp_path: Path) -> None:
    async def work(server: Server) -> None:
        async with connected(server) as line:
            assert "head" in await next_json(line)
            frames = [message async for message in until_silent(line) if isinstance(message, bytes)]
            assert len(frames) == served.FEWEST_UNDER_WAY  # nothing was said to be seen
            await line.send('{"seen": 4}')
            assert isinstance(await asyncio.wait_for(line.recv(), 5), bytes)

    played_with(work, tmp_path / "pulled.json")


def test_each_tab_plays_for_itself_and_what_is_asked_is_answered(tmp_path: Path) -> None:
    async def work(server: Server) -> None:
        async with connected(server) as one, connected(server) as other:
            for line in (one, other):
                assert "head" in await next_json(line)
                assert (await next_json(line))["status"]["playing"]
            await one.send('{"do": "pause"}')
            assert not (await next_json(one))["status"]["playing"]
            await other.send('{"set": "winhc", "value": 1}')
            assert "winch" in (await next_json(other))["error"]
            await one.send("no JSON")
            assert "JSON" in (await next_json(one))["error"]
            await one.send('{"save": "run"}')
            assert "running it again" in (await next_json(one))["said"]
            await one.send('{"set": "winhc", "value": 1}')  # is answered meanwhile, or after it
            said = [await next_json(one), await next_json(one)]
            assert sum("winch" in each.get("error", "") for each in said) == 1
            assert sum("the run is in" in each.get("said", "") for each in said) == 1
            assert (tmp_path / "pulled_played" / "run.json").is_file()

    played_with(work, tmp_path / "pulled.json")


def test_what_takes_long_in_a_tab_is_told_and_holds_up_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One goes back for as long as it takes the other to be sent frames."""
    go_on, threads, back = threading.Event(), [], Session._back

    def slow(self: Session) -> list[dict[str, Any]]:
        threads.append(threading.current_thread())
        assert go_on.wait(60)
        return back(self)

    monkeypatch.setattr(Session, "_back", slow)

    async def work(server: Server) -> None:
        async with connected(server) as one, connected(server) as other:
            await next_json(one), await next_json(one)
            await one.send('{"do": "back"}')
            assert await next_json(one, working=True) == {"working": True}
            for _ in range(20):
                while not isinstance(await other.recv(), bytes):
                    pass
                await other.send('{"seen": 1000000}')
            go_on.set()
            said = [await next_json(one, working=True) for _ in range(3)]
            assert {"working": False} in said
            assert {"status", "controls"} < {name for each in said for name in each}
            assert threads[0] is not threading.main_thread()

    played_with(work, tmp_path / "pulled.json")


def test_only_so_many_tabs_play(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(served, "MOST_TABS", 1)

    async def work(server: Server) -> None:
        async with connected(server) as one:
            assert "head" in await next_json(one)
            async with connected(server) as other:
                assert "1 pages play" in (await next_json(other))["error"]
        while True:  # once it is closed there is room
            async with connected(server) as again:
                if "head" in await next_json(again):
                    break

    played_with(work, tmp_path / "pulled.json")


def test_a_file_that_is_saved_is_read_anew(tmp_path: Path) -> None:
    file = tmp_path / "pulled.json"

    async def work(server: Server) -> None:
        async with connected(server) as line:
            await next_json(line), await next_json(line)
            file.write_text(json.dumps({**PULLED, "title": "another"}))
            assert (await next_json(line))["head"]["title"] == "another"
            assert (await next_json(line))["status"]["trouble"] == ""
            file.write_text("{")
            trouble = (await next_json(line))["status"]["trouble"]
            assert "pulled.json:1" in trouble
            assert str(tmp_path) not in trouble
            async with connected(server) as another:  # a page that is opened now
                assert "pulled.json:1" in (await next_json(another))["error"]

    played_with(work, file)


def test_a_port_that_is_taken_and_a_library_that_is_missing_are_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:
    async def work(server: Server) -> None:
        second = Server(lambda: server._first[0], server._first[0], title="", port=server.port)
        with pytest.raises(OutputError, match=f"port {server.port}"):
            async with second.listening():
                pass

    played_with(work, tmp_path / "pulled.json")
    monkeypatch.setitem(sys.modules, "websockets.asyncio.server", None)
    with pytest.raises(OutputError, match=r"pip install 'sandbox-mechanics\[view\]'"):
        served.needed()


def started(*words: str, **more: Any) -> subprocess.Popen[str]:
    return subprocess.Popen([sys.executable, "-m", "sandbox", "view", *words], text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, **more)


@pytest.mark.skipif(os.name == "nt", reason="Ctrl-C reaches the tests, too")
def test_the_command_says_the_address_and_ends_by_ctrl_c(tmp_path: Path) -> None:
    file = tmp_path / "pulled.json"
    file.write_text(json.dumps(PULLED))
    with started(str(file), "--no-browser", "--set", "parameters.pull=2 N") as process:
        assert process.stdout is not None
        address, line = process.stdout.readline().strip(), process.stdout.readline()
        port = address.split(":")[2].split("/")[0]
        assert f"ssh -N -L {port}:127.0.0.1:{port} " in line
        assert fetched(address)[0] == 200
        process.send_signal(signal.SIGINT)
        assert process.wait(20) == 130
        assert process.stderr is not None
        assert re.sub(FIRST_RUN, "", process.stderr.read()) == ""


@pytest.mark.skipif(os.name == "nt", reason="Ctrl-C reaches the tests, too")
def test_the_browser_is_given_a_file_and_not_the_address(tmp_path: Path) -> None:
    scene, given, browser = (tmp_path / name for name in ("pulled.json", "given", "browser"))
    scene.write_text(json.dumps(PULLED))
    browser.write_text(f'#!/bin/sh\necho "$@" > {given}.new\ncat "${{1#file://}}" >> {given}.new\n'
                       f"mv {given}.new {given}\n")
    browser.chmod(0o700)
    machine = {key: value for key, value in os.environ.items() if key != "SSH_CONNECTION"}
    with started(str(scene), env={**machine, "DISPLAY": ":0", "BROWSER": str(browser)}) as process:
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        while not given.exists():
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        assert process.wait(20) == 130
    word, text = given.read_text().split("\n", 1)
    assert word.startswith("file://")
    assert address.split("/")[-1] not in word
    assert address in text
    assert not Path(word.removeprefix("file://")).exists()
