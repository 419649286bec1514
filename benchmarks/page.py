"""The page of a report: how large it is, how long it takes to write, how a browser plays it."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from statistics import median

from benchmarks.measure import Figure, interleaved, mechanism, seconds
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.web.page import report

RESTLESS = "=pull * (0.55 + 0.45 * sin(2 * pi * 2.3 * t))"
"""A pull that never lets the hand rest."""
READY = "globalThis.sandbox && performance.getEntriesByName('ready').map((e) => e.startTime)[0]"
"""Milliseconds from the opening of a page until all is drawn."""
DRAWN = "[sandbox.drawn, performance.now() / 1000]"


def _seen(html: str, *, quick: bool) -> list[Figure]:
    """How soon a browser shows a page, and how many frames a second it plays, if there is one."""
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        return []
    chromium = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
    if chromium is None:
        return []
    with tempfile.TemporaryDirectory() as room, sync_playwright() as driver:
        path = Path(room) / "page.html"
        path.write_text(html, encoding="utf-8")
        browser = driver.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        ready = []
        for _ in range(1 if quick else 5):
            page = browser.new_page(viewport={"width": 1280, "height": 900})
            page.goto(path.as_uri() + "#t=0")
            while not (since := page.evaluate(READY)):
                page.wait_for_timeout(10)
            ready.append(since)
        page.evaluate("sandbox.toggle()")
        page.wait_for_timeout(500)
        before = page.evaluate(DRAWN)
        page.wait_for_timeout(500 if quick else 5000)
        drawn, passed = (b - a for a, b in zip(before, page.evaluate(DRAWN), strict=True))
        browser.close()
    return [Figure("  ready after it is opened", median(ready) / 1e3, "s", most=1.0),
            Figure("  frames drawn a second", drawn / passed, "1/s", least=55.0)]


def figures(*, quick: bool = False) -> list[Figure]:
    """Of ten seconds of the four-finger hand that never rests, and of its own two seconds."""
    restless = simulate(mechanism("adaptive_grasp", {
        "run.duration": 1.0 if quick else 10.0, "drives[0].value": {"expression": RESTLESS}}))
    short = simulate(mechanism("adaptive_grasp", {"run.duration": 0.5 if quick else 2.0}))
    found = []
    for name, run, most in (("restless", restless, 5.0), ("at rest in the end", short, None)):

        def write(run: Recording = run) -> float:
            fresh = run.part(0, len(run))  # the first look works out what later ones reuse
            return seconds(lambda: report([fresh]))

        took = interleaved([write], 1 if quick else 5)[0]
        html = report([run])
        size = len(html.encode()) / 1e6
        found += [Figure(f"page, {name}", size, "MB", most=most),
                  Figure(f"  written, {name}", took, "s", most=1.0),
                  *_seen(html, quick=quick)]
    return found
