"""The page of a report: how large it is, how long it takes to write, how a browser plays it."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from statistics import median

from benchmarks.measure import Figure, interleaved, mechanism, seconds
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import load_scene
from sandbox.web.page import report

RESTLESS = "=pull * (0.55 + 0.45 * sin(2 * pi * 2.3 * t))"
"""A pull that never lets the hand rest."""
PARTS = 600
READY = "globalThis.sandbox && performance.getEntriesByName('ready').map((e) => e.startTime)[0]"
"""Milliseconds from the opening of a page until all is drawn."""
PLAY = """() => {
  const redraw = sandbox.redraw.bind(sandbox);
  for (const name of ["names", "drives"]) sandbox.stages[0].layers.add(name);
  sandbox.costs = [];
  sandbox.redraw = () => {
    const began = performance.now();
    redraw();
    sandbox.costs.push(performance.now() - began);
  };
  sandbox.toggle();
}"""
"""Play with names and drives, and note the script's time for each frame [ms]."""
DRAWN = "[sandbox.costs.length, performance.now() / 1000]"


def _seen(html: str, most: float, *, quick: bool) -> list[Figure]:
    """How soon a browser shows a page, frames per second, script per frame, if there is one.

    ``most`` is the limit of the script's time for a frame [ms].
    """
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
        page.evaluate(PLAY)
        page.wait_for_timeout(500)
        before = page.evaluate(DRAWN)
        page.wait_for_timeout(500 if quick else 5000)
        drawn, passed = (b - a for a, b in zip(before, page.evaluate(DRAWN), strict=True))
        costs = page.evaluate("sandbox.costs")
        browser.close()
    return [Figure("  ready after it is opened", median(ready) / 1e3, "s", most=1.0),
            Figure("  frames drawn a second", drawn / passed, "1/s", least=55.0),
            Figure("  script of a frame", median(costs), "ms", most=most)]


def _many_parts() -> Recording:
    """Boxes that turn without contact."""
    return simulate(load_scene({
        "name": "many", "run": {"duration": 0.5, "step": 1e-3}, "bodies": [
            {"name": f"b{k}", "mass": 1, "at": [0.03 * (k % 30), 0.03 * (k // 30)],
             "angular_velocity": 6, "shapes": [{"type": "box", "size": [0.02, 0.01]}]}
            for k in range(PARTS)]}))


def figures(*, quick: bool = False) -> list[Figure]:
    """Of ten seconds of the four-finger hand that never rests, of its own two, of many parts."""
    restless = simulate(mechanism("adaptive_grasp", {
        "run.duration": 1.0 if quick else 10.0, "drives[0].value": {"expression": RESTLESS}}))
    short = simulate(mechanism("adaptive_grasp", {"run.duration": 0.5 if quick else 2.0}))
    found = []
    for name, run, size, script in (
            ("restless", restless, 5.0, 0.7), ("at rest in the end", short, None, 0.7),
            (f"{PARTS} parts", _many_parts(), None, 1000 / 60)):

        def write(run: Recording = run) -> float:
            fresh = run.part(0, len(run))  # the first look works out what later ones reuse
            return seconds(lambda: report([fresh]))

        took = interleaved([write], 1 if quick else 5)[0]
        html = report([run])
        found += [Figure(f"page, {name}", len(html.encode()) / 1e6, "MB", most=size),
                  Figure(f"  written, {name}", took, "s", most=1.0),
                  *_seen(html, script, quick=quick)]
    return found
