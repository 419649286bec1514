"""Pictures of renders/gallery/ that are no runs: sketches, and pages in a browser.

``python docs/make_gallery.py NAME`` draws them, as all others.
"""

from __future__ import annotations

import contextlib
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import sandbox
from sandbox.cli.entry import invoke
from sandbox.draw.figure.style import BLUE, INK, ORANGE, SLATE, new_figure, save_figure
from sandbox.draw.film.palette import ROLES


@contextlib.contextmanager
def page_of(address: str) -> Iterator[Any]:
    """A page in a Chromium that shows nothing, once it is ready (of the extra ``dev``)."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        browser = driver.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 960, "height": 620})
        page.goto(address)
        yield page
        browser.close()


def report_page(path: Path) -> None:
    """The page of ``sandbox report``, of a finger that closes."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "report.html"
        sandbox.simulate(sandbox.load_scene("single_finger")).save(folder)
        invoke(["report", folder, "--out", str(file), "--quiet"])
        with page_of(f"{file.as_uri()}#t=0.3") as page:
            page.wait_for_selector("html[data-ready]", state="attached")
            page.wait_for_timeout(500)
            page.screenshot(path=path)


def view_page(path: Path) -> None:
    """The page of ``sandbox view``, while a finger is pulled by the mouse."""
    words = [sys.executable, "-m", "sandbox", "view", "single_finger", "--no-browser"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as serves:
        address = serves.stdout.readline().strip() if serves.stdout else ""
        with page_of(address) as page:
            page.wait_for_timeout(4000)
            x, y = page.evaluate("""(() => {
                const { bodies } = sandbox.head, box = document.querySelector(".sheet canvas");
                const i = bodies.findIndex((body) => body.name === "finger.distal");
                const [x, y] = sandbox.stage.at([i, ...bodies[i].centre]);
                const { left, top } = box.getBoundingClientRect();
                return [left + x, top + y];
            })()""")
            page.mouse.move(x, y)
            page.mouse.down()
            page.mouse.move(x + 90, y - 20, steps=5)
            page.wait_for_timeout(800)
            page.screenshot(path=path)
        serves.send_signal(signal.SIGINT)


def way_of_the_data(path: Path) -> None:
    """The stations of docs/extending.md, and what leads from one to the next."""
    sketch = new_figure(66.0)
    sketch.set_layout_engine("none")
    axes = sketch.add_axes((0, 0, 1, 1), xlim=(0, 120), ylim=(0, 66))
    axes.axis("off")
    places = {"scene.json": (16, 58), "Scene": (56, 58), "Mechanism": (100, 58),
              "Model, State": (100, 32), "Recording": (56, 32), "film, figure": (16, 40),
              "files, report": (16, 24), "verdict, audit": (16, 8), "laws": (100, 8)}
    boxes = {name: axes.text(x, y, name, color=INK, ha="center", va="center", fontsize=10, bbox={
        "boxstyle": "round,pad=0.5", "facecolor": "white", "edgecolor": SLATE})
        for name, (x, y) in places.items()}
    sketch.canvas.draw()  # only now boxes know how large they are
    for start, end, word, right, up in (
            ("scene.json", "Scene", "load", 1, 2), ("Scene", "Mechanism", "expand", -1, 2),
            ("Mechanism", "Model, State", "compile", 9, -1),
            ("Model, State", "Recording", "step", 0, 2), ("Recording", "film, figure", "", 0, 0),
            ("Recording", "files, report", "", 0, 0), ("Recording", "verdict, audit", "", 0, 0),
            ("Model, State", "laws", "readings", -11, -1),
            ("laws", "Model, State", "drives", 9, -1)):
        (x, y), (u, v) = places[start], places[end]
        aside = 2 * ((start == "laws") - (end == "laws"))
        axes.annotate("", (u + aside, v), (x + aside, y), arrowprops={
            "arrowstyle": "-|>", "color": SLATE, "linewidth": 1.2, "shrinkA": 1, "shrinkB": 1,
            "patchA": boxes[start].get_bbox_patch(), "patchB": boxes[end].get_bbox_patch()})
        axes.text((x + u) / 2 + right, (y + v) / 2 + up, word, color=BLUE, ha="center", fontsize=10)
    save_figure(sketch, path)


def finger_arms(path: Path) -> None:
    """The lengths of the closed form on docs/tutorial/finger.md, drawn to scale, 1 mm as 1 mm."""
    turns = -np.arctan2(3, 4) - np.array([0, 2 * np.arctan2(18, 24)])
    (first, second), disc = np.stack([np.cos(turns), np.sin(turns)], 1), np.array([9.6, -37.2])
    mcp, pip, foot = np.zeros(2), 48 * first, (18 + 48 * first @ second) * second
    sketch = new_figure(92.0)
    sketch.set_layout_engine("none")  # it would make room for axes, and there are none
    axes = sketch.add_axes((0, 0, 1, 1), xlim=(-46, 74), ylim=(-72, 20))
    axes.axis("off")

    def line(start: Any, end: Any, colour: str, mm: float, **how: Any) -> None:
        axes.plot(*np.transpose([start, end]), color=colour, linewidth=mm * 72 / 25.4,
                  **{"solid_capstyle": "round", **how})

    def arrow(start: Any, end: Any, text: str, aside: Any, colour: str, head: str) -> None:
        axes.annotate("", end, start, arrowprops={
            "arrowstyle": head, "color": colour, "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0})
        axes.text(*(0.5 * (start + end) + aside), text, ha="center", va="center", color=colour,
                  fontsize=10)

    phalanx, thing = ([f"#{bytes(colour).hex()}" for colour in (ROLES[role].edge, ROLES[role].fill)]
                      for role in ("phalanx", "object"))
    axes.plot(*disc, "o", color=thing[1], markeredgecolor=thing[0], markersize=32 * 72 / 25.4)
    for start, end in ((mcp, pip), (pip, pip + 30 * second)):
        for colour, mm in zip(phalanx, (16.4, 15.6), strict=True):
            line(start, end, colour, mm)
        line(start, end, phalanx[0], 0.2, linestyle=(0, (6, 4)))
    for start, way, out, far, name in ((mcp, first, (0.6, 0.8), 30, "1"),
                                       (pip, second, (0.936, -0.352), 18, "2")):
        side, touch = np.array(out), start + far * way
        line(start, start + 14 * side, SLATE, 0.15)
        line(touch, touch + 14 * side, SLATE, 0.15)
        arrow(start + 13 * side, touch + 13 * side, f"$k_{name}$", 4 * side, SLATE, "<|-|>")
        arrow(touch - 24 * side, touch - 8 * side, f"$f_{name}$", 4 * way, BLUE, "-|>")
        axes.plot(*start, "o", color="white", markeredgecolor=INK, markersize=5)
    line(foot - 6 * np.array([0.936, -0.352]), disc, BLUE, 0.2, linestyle=(0, (6, 4)))
    arrow(mcp, foot, "$k_2 + l_1 \\cos\\,\\theta_2$", np.array([-15, 0]), ORANGE, "<|-|>")
    save_figure(sketch, path)
