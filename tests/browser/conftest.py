"""A real browser, where playwright and a Chromium are there; else these tests are left out."""

import os
import shutil
import signal
import subprocess
import sys
import time

import pytest

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")
PATIENCE = 60.0
"""Seconds: ten times what it takes on a busy machine."""
STAGE = "(sandbox.stage || sandbox.stages[0])"
DESK = {"viewport": {"width": 1280, "height": 900}, "accept_downloads": True}
PHONE = {"viewport": {"width": 390, "height": 844}, "device_scale_factor": 2, "is_mobile": True,
         "has_touch": True, "color_scheme": "dark"}


@pytest.fixture(scope="module")
def browser():
    """One for a file of tests: while its driver lives, an event loop runs in this thread, and tests
    elsewhere that begin one of their own could not."""
    sync = pytest.importorskip(
        "playwright.sync_api", reason="no playwright: pip install 'sandbox-mechanics[dev]'")
    found = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip("no browser: install chromium from the system's packages")
    root = hasattr(os, "geteuid") and os.geteuid() == 0
    with sync.sync_playwright() as driver:
        running = driver.chromium.launch(
            executable_path=found, args=["--no-sandbox"] if root else [])
        yield running
        running.close()


@pytest.fixture
def tab_of(browser):
    """Opens an address in a tab. Errors, warnings and requests to elsewhere fail the test."""
    tabs = []

    def open_tab(address, *, clock=False, **options):
        tab = browser.new_context(**{**DESK, **options}).new_page()
        tabs.append(tab)
        tab.faults = []
        tab.on("console", lambda said: tab.faults.append(said.text)
               if said.type in ("error", "warning") else None)
        tab.on("pageerror", lambda error: tab.faults.append(str(error)))
        own = (address.rsplit("/", 1)[0], "data:", "blob:")
        tab.on("request", lambda asked: None if asked.url.startswith(own)
               else tab.faults.append(asked.url))
        if clock:
            tab.clock.install(time=0)
        tab.goto(address)
        return tab

    yield open_tab
    for tab in tabs:
        assert tab.faults == []
        tab.context.close()


@pytest.fixture
def opened(tab_of, tmp_path):
    """Opens the text of a report."""

    def open_page(text, *, at="", **options):
        path = tmp_path / "page.html"
        path.write_text(text, encoding="utf-8")
        tab = tab_of(path.as_uri() + at, **options)
        tab.wait_for_selector("html[data-ready]", state="attached")
        if options.get("clock"):  # from here on it moves by run_for alone
            tab.clock.pause_at(3600)
        return tab

    return open_page


@pytest.fixture
def served(tab_of, tmp_path):
    """Opens the live view of a scene."""
    processes = []

    def start(scene, **options):
        process = subprocess.Popen(
            [sys.executable, "-m", "sandbox", "view", str(scene), "--no-browser"], cwd=tmp_path,
            stdout=subprocess.PIPE, text=True)
        processes.append(process)
        tab = tab_of(process.stdout.readline().strip(), **options)
        until(tab, "globalThis.sandbox && sandbox.frame && sandbox.drawn > 2")
        return tab

    yield start
    for process in processes:
        process.send_signal(signal.SIGINT)
        with process:
            process.wait(PATIENCE)


def until(tab, expression):
    """Wait; playwright's own way needs what the policies of the pages forbid."""
    end = time.monotonic() + PATIENCE
    while not tab.evaluate(f"!!({expression})"):
        assert time.monotonic() < end, (expression, tab.faults)
        tab.wait_for_timeout(20)


def body_at(tab, name, x=None, y=None):
    """Where a point of a body is on the screen, by default its centre."""
    box = tab.locator(".sheet canvas").first.bounding_box()
    px, py = tab.evaluate(
        f"([name, ...at]) => {{ const s = {STAGE}, {{ bodies }} = s.head, "
        "i = bodies.findIndex((b) => b.name === name); "
        "return s.at([i, ...(at[0] === null ? bodies[i].centre : at)]); }", [name, x, y])
    return box["x"] + px, box["y"] + py
