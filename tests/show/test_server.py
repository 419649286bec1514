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
import urllib.error
import urllib.request
from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest

from sandbox.errors import OutputError
from sandbox.scene.read.load import read_scene
from sandbox.show import server as served
from sandbox.show.server import Server, page
from sandbox.show.session import Session
from tests.cli.conftest import FIRST_RUN

from .test_session import PULLED

websockets = pytest.importorskip("websockets", reason="the extra 'view' is not installed")


def played_with(work: Callable[[Server], Awaitable[None]], file: Path) -> None:
    """Serve a scene's file while some work is done."""
    file.write_text(json.dumps(PULLED))

    def session() -> Session:
        return Session(lambda overrides: read_scene(file, overrides=overrides), {},
                       lambda name: file.parent / name)

    async def run() -> None:
        server = Server(session, session(), title="pulled & <b>")
        async with server.listening():
            await asyncio.wait_for(work(server), 60)

    asyncio.run(run())


def connected(server: Server, **more: Any) -> Any:
    more = {"origin": f"http://127.0.0.1:{server.port}", **more}
    return websockets.connect(server.address.replace("http", "ws"), **more)


async def next_json(socket_: Any) -> dict[str, Any]:
    while isinstance(message := await socket_.recv(), bytes):
        await socket_.send('{"seen": 1000000}')
    return dict(json.loads(message))


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
        # a name that somebody let lead to 127.0.0.1
        assert (await asyncio.to_thread(fetched, server.address, Host="evil.example"))[0] == 403

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


def test_a_file_that_is_saved_is_read_anew(tmp_path: Path) -> None:
    file = tmp_path / "pulled.json"

    async def work(server: Server) -> None:
        async with connected(server) as line:
            await next_json(line), await next_json(line)
            file.write_text(json.dumps({**PULLED, "title": "another"}))
            assert (await next_json(line))["head"]["title"] == "another"
            assert (await next_json(line))["status"]["trouble"] == ""
            file.write_text("{")
            assert "pulled.json:1" in (await next_json(line))["status"]["trouble"]
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


def test_a_wrong_scene_is_refused_before_anything_is_served(tmp_path: Path) -> None:
    file = tmp_path / "wrong.json"
    file.write_text(json.dumps({**PULLED, "gravity": [0, "down"]}))
    with started(str(file), "--no-browser") as process:
        out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (2, "")
    assert "gravity" in err
