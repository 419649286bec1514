"""The server of the live view: who is let in, what is sent, when a file changes; no browser."""

from __future__ import annotations

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
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from sandbox.cli.view import view
from sandbox.errors import OutputError, SandboxError
from sandbox.scene.read.load import read_scene
from sandbox.web.page import html_page, script
from sandbox.web.session import Found, Session
from tests.cli.conftest import FIRST_RUN

from .test_session import PULLED

served = pytest.importorskip("sandbox.web.server", reason="the extra 'view' is not installed")
client = pytest.importorskip("websockets.sync.client")
START, Server = served.START, served.Server


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    file = tmp_path / "pulled.json"
    file.write_text(json.dumps(PULLED))

    def session() -> Session:
        return Session(lambda overrides: Found(read_scene(file, overrides=overrides)), {},
                       lambda name: tmp_path / name)

    made = Server(session, session(), title="pulled & <b>")
    with made.listening():
        yield made


def connected(server: Server, **more: Any) -> Any:
    more = {"origin": f"http://127.0.0.1:{server.port}", **more}
    return client.connect(server.address.replace("http", "ws"), **more)


def next_json(line: Any, *, working: bool = False) -> dict[str, Any]:
    """The next text, but no display list; that something takes long only if asked."""
    while True:
        message = line.recv(timeout=60)
        if isinstance(message, bytes):
            line.send('{"seen": 1000000}')
        elif "relisted" not in (found := json.loads(message)) and (
                working or "working" not in found):
            return dict(found)


def fetched(address: str, **headers: str) -> tuple[int, dict[str, str], str]:
    try:
        with urllib.request.urlopen(urllib.request.Request(address, headers=headers)) as answer:
            return answer.status, dict(answer.headers), answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, {}, error.read().decode()


def test_the_page_is_for_who_knows_the_token(server: Server) -> None:
    root = f"http://127.0.0.1:{server.port}/"
    status, headers, text = fetched(server.address)
    assert (status, text) == (200, html_page("pulled & <b>", script(START, "live.js")))
    assert "<title>pulled &amp; &lt;b&gt;</title>" in text
    assert b"a\\udcff" in html_page("a\udcff", "").encode()
    policy = headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert headers["Cache-Control"] == "no-store"
    assert text.isascii()
    for path in ("", "x", server.token[:-1], f"{server.token}/x", "favicon.ico"):
        assert fetched(root + path)[0] == 403
    # a name that somebody let lead to 127.0.0.1, or another port of a line through SSH
    for host in ("evil.example", "localhost:1"):
        status, _, text = fetched(server.address, Host=host)
        assert status == 403
        assert f"answers to 127.0.0.1:{server.port} and localhost:{server.port} only" in text
        assert "token" not in text


def test_another_page_is_not_let_in(server: Server, caplog: pytest.LogCaptureFixture) -> None:
    """Nor a header that is sent twice; the terminal stays silent."""
    from websockets.exceptions import InvalidStatus

    for more in ({"origin": "http://evil.example"}, {"origin": None}):
        with pytest.raises(InvalidStatus, match="403"):
            connected(server, **more)
    with connected(server, origin=f"http://localhost:{server.port}"):
        pass
    if sys.platform == "linux":  # where all of 127 is this machine
        with socket.socket() as other, pytest.raises(OSError, match="refused"):
            other.connect(("127.0.0.2", server.port))
    own = f"127.0.0.1:{server.port}"
    upgrade = ("Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13",
               "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==")
    for lines in ((f"Host: {own}", "Host: evil.example"), (
            f"Host: {own}", *upgrade, f"Origin: http://{own}", "Origin: http://evil.example")):
        with socket.create_connection(("127.0.0.1", server.port)) as line:
            head = "\r\n".join((f"GET /{server.token} HTTP/1.1", *lines))
            line.sendall(f"{head}\r\n\r\n".encode())
            with line.makefile("rb") as answer:
                assert answer.readline().split()[1] in (b"400", b"403")
    assert caplog.records == []


def test_no_more_frames_are_under_way_than_the_line_holds(server: Server) -> None:
    with connected(server) as line:
        for said in ("1e999", "[" * 5000, '"x"', "null"):  # which does no harm
            line.send('{"seen": ' + said + "}")
        assert "head" in next_json(line)
        frames = 0
        with contextlib.suppress(TimeoutError):
            while True:
                frames += isinstance(line.recv(timeout=0.5), bytes)
        assert frames == served.MAX_UNSEEN  # nothing was said to be seen
        line.send('{"seen": 4}')
        assert isinstance(line.recv(timeout=5), bytes)


def test_each_tab_plays_for_itself_and_what_is_asked_is_answered(
    server: Server, tmp_path: Path,
) -> None:
    with connected(server) as one, connected(server) as other:
        for line in (one, other):
            assert "head" in next_json(line)
            assert next_json(line)["status"]["playing"]
        one.send('{"do": "pause"}')
        assert not next_json(one)["status"]["playing"]
        other.send('{"set": "winhc", "value": 1}')
        assert "winch" in next_json(other)["error"]
        one.send("no JSON")
        assert "JSON" in next_json(one)["error"]
        one.send('{"save": "run"}')
        assert "running it again" in next_json(one)["said"]
        one.send('{"set": "winhc", "value": 1}')  # is answered meanwhile, or after it
        said = [next_json(one), next_json(one)]
        assert sum("winch" in each.get("error", "") for each in said) == 1
        assert sum("the run is in" in each.get("said", "") for each in said) == 1
        assert (tmp_path / "pulled_played" / "run.json").is_file()


def test_what_takes_long_in_a_tab_is_told_and_holds_up_no_other(
    server: Server, monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One goes back for as long as it takes the other to be sent frames."""
    go_on, back = threading.Event(), Session._back

    def slow(self: Session) -> list[dict[str, Any]]:
        assert go_on.wait(60)
        return back(self)

    monkeypatch.setattr(Session, "_back", slow)
    with connected(server) as one, connected(server) as other:
        next_json(one), next_json(one)
        one.send('{"do": "back"}')
        assert next_json(one, working=True) == {"working": True}
        for _ in range(20):
            while not isinstance(other.recv(timeout=60), bytes):
                pass
            other.send('{"seen": 1000000}')
        go_on.set()
        said = [next_json(one, working=True) for _ in range(3)]
        assert {"working": False} in said
        assert {"status", "controls"} < {name for each in said for name in each}


def test_only_so_many_tabs_play(server: Server) -> None:
    with contextlib.ExitStack() as tabs:
        for _ in range(served.MAX_TABS):
            last = tabs.enter_context(connected(server))
            assert "head" in next_json(last)
        with connected(server) as more:
            assert f"{served.MAX_TABS} tabs run" in next_json(more)["error"]
        last.close()
        while True:  # once it is closed there is room
            with connected(server) as again:
                if "head" in next_json(again):
                    break


def test_a_file_that_is_saved_is_read_anew(server: Server, tmp_path: Path) -> None:
    file = tmp_path / "pulled.json"
    with connected(server) as line:
        next_json(line), next_json(line)
        file.write_text(json.dumps({**PULLED, "title": "another"}))
        assert next_json(line)["head"]["title"] == "another"
        assert next_json(line)["status"]["trouble"] == ""
        file.write_text("{")
        trouble = next_json(line)["status"]["trouble"]
        assert "pulled.json:1" in trouble
        assert str(tmp_path) not in trouble
        with connected(server) as another:  # a page that is opened now
            assert "pulled.json:1" in next_json(another)["error"]


def test_a_port_that_is_taken_and_a_library_that_is_missing_are_said(
    server: Server, monkeypatch: pytest.MonkeyPatch,
) -> None:
    second = Server(lambda: server._first[0], server._first[0], title="", port=server.port)
    with pytest.raises(OutputError, match=f"port {server.port}"), second.listening():
        pass
    monkeypatch.setitem(sys.modules, "websockets.sync.server", None)
    with pytest.raises(SandboxError, match=r"pip install 'sandbox-mechanics\[view\]'"):
        view(None, None, no_browser=True)


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
