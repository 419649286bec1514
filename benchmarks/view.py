"""The live view of the four-finger hand: what a frame costs; in a browser, how soon it is seen."""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from benchmarks.measure import Figure
from sandbox.scene.read.load import read_scene
from sandbox.web.session import FRAME, Found, Session

SCENE = "adaptive_grasp"
PROBE = """() => {
  const paint = sandbox.paint.bind(sandbox), { send } = sandbox.link, sent = new Map();
  sandbox.waits = [];
  sandbox.costs = [];
  sandbox.link.send = (text) => { sent.set(JSON.parse(text).id, performance.now()); send(text); };
  sandbox.paint = () => {
    const began = performance.now();
    paint();
    sandbox.costs.push(performance.now() - began);
    for (const [id, at] of sent) {
      if (!(id <= sandbox.answered)) continue;
      sandbox.waits.push(performance.now() - at);
      sent.delete(id);
    }
  };
}"""
"""Note the script's time for each frame and the time from each request to its picture [ms]."""


def figures(*, quick: bool = False) -> list[Figure]:
    """A frame's cost; with playwright and Chromium also frames and sliders in a browser."""
    return [*_costs(20 if quick else 60), *_seen(quick=quick)]


def _costs(frames: int) -> list[Figure]:
    def read(overrides: Mapping[str, Any]) -> Found:
        return Found(read_scene(SCENE, overrides=overrides))

    session = Session(read, {}, Path)
    steps, told = [], []
    for _ in range(frames):
        began = time.perf_counter()
        session.advance(FRAME, budget=1.0)
        between = time.perf_counter()
        session.frame()
        steps.append(between - began)
        told.append(time.perf_counter() - between)
    return [Figure("steps of a frame", 1e3 * median(steps), "ms"),
            Figure("what a frame tells", 1e3 * median(told), "ms"),
            Figure("share of a processor", (median(steps) + median(told)) / FRAME, "", most=0.5),
            Figure("bytes of a frame", len(session.frame()), "")]


def _seen(*, quick: bool) -> list[Figure]:
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        return []
    chromium = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
    if chromium is None:
        return []
    words = [sys.executable, "-m", "sandbox", "view", SCENE, "--no-browser"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as served:
        assert served.stdout is not None
        address = served.stdout.readline().strip()
        try:
            with sync_playwright() as driver:
                browser = driver.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
                page = browser.new_page(viewport={"width": 1280, "height": 900})
                page.goto(address)
                return _measured(page, 1.0 if quick else 10.0, 20 if quick else 150)
        finally:
            served.send_signal(signal.SIGINT)
            served.wait(30)


def _measured(page: Any, seconds: float, moves: int) -> list[Figure]:
    while not page.evaluate("!!(globalThis.sandbox && sandbox.drawn > 30)"):
        page.wait_for_timeout(50)
    page.evaluate(PROBE)
    look = "[sandbox.frame.t, sandbox.drawn, performance.now() / 1000]"
    before = np.array(page.evaluate(look))
    page.wait_for_timeout(1e3 * seconds)
    motion, drawn, passed = np.array(page.evaluate(look)) - before
    slider = page.locator("[data-control='actuator']")
    for value in np.linspace(5, 25, moves):
        slider.fill(f"{value:.3f}")
        page.wait_for_timeout(30)
    waits = page.evaluate("sandbox.waits")
    cost = page.evaluate("sandbox.costs.slice(-300)")
    return [
        Figure("frames drawn a second", drawn / passed, "1/s", least=55.0),
        Figure("motion for each second", motion / passed, "", least=0.95),
        Figure("script of a frame", median(cost), "ms"),
        Figure("slider to picture, median", float(np.percentile(waits, 50)), "ms", most=30.0),
        Figure("slider to picture, 95 of 100", float(np.percentile(waits, 95)), "ms"),
    ]
