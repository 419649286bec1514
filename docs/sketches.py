"""Drawings of renders/gallery/, and pages in a browser, for ``docs/make_gallery.py``."""

from __future__ import annotations

import contextlib
import json
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

import sandbox
from sandbox.cli.commands import invoke
from sandbox.figure.style import (
    BAND,
    BLUE,
    GREY,
    INK,
    ORANGE,
    QUIET,
    SLATE,
    new_figure,
    save_figure,
)
from sandbox.picture.palette import ROLES

DOCS = Path(__file__).parent
GRAVITY, GREEN = 9.81, "#cfe0d6"


def blank(figure: Any, box: tuple[float, float, float, float], x: Any, y: Any) -> Any:
    """Axes without lines in a part of a figure, 1 in x as long as 1 in y."""
    axes = figure.add_axes(box, xlim=x, ylim=y, aspect="equal")
    axes.axis("off")
    return axes


def arrow(axes: Any, start: Any, end: Any, colour: str, head: str = "-|>") -> None:
    """A line from a point to another with a head, or one at either end."""
    axes.annotate("", end, start, arrowprops={
        "arrowstyle": head, "color": colour, "linewidth": 1.6, "shrinkA": 0, "shrinkB": 0,
        "mutation_scale": 9})


def plain(axes: Any, x: str, y: str) -> None:
    """Two lines and small type, for a plot that is a sketch."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=7)
    axes.set_xlabel(x, fontsize=7.5)
    axes.set_ylabel(y, fontsize=7.5)


def groove(path: Path) -> None:
    """The disc of docs/audit.md in its groove, with three sets of contact forces that hold it."""
    figure = new_figure(48.0)
    figure.set_layout_engine("none")
    weight, mu, way = 0.2 * GRAVITY, 0.5, np.sqrt(0.5)
    least, most = (weight / (2 * way * (1 + sign * mu)) for sign in (1, -1))
    middle = weight / (2 * way)
    for k, (normal, words) in enumerate((
            (least, "friction upward"), (middle, "no friction"),
            (most, "friction downward"))):
        axes = blank(figure, (k / 3, 0, 1 / 3, 1), (-62, 62), (-46, 76))
        for side in (-1, 1):
            axes.plot([0, 56 * side], [-28.3, 27.7], color=GREY, linewidth=5,
                      solid_capstyle="round", zorder=1)
        axes.add_patch(_disc(0, 0, 18))
        arrow(axes, (0, 0), (0, -20 * weight), SLATE)
        rub = weight / 2 / way - normal
        for side in (-1, 1):
            at = np.array([side, -1]) * 18 * way
            force = normal * np.array([-side, 1]) * way + rub * np.array([side, 1]) * way
            arrow(axes, at, at + 20 * force, BLUE)
            axes.plot(*at, "o", color=BLUE, markersize=3)
        axes.text(0, 75, words, ha="center", va="top", fontsize=8.5, color=INK)
        axes.text(0, 62, f"each side presses: {normal:.2f} N", ha="center", va="top",
                  fontsize=8, color=QUIET)
        axes.text(3, -43, "weight", fontsize=7, color=SLATE)
    save_figure(figure, path)


def _disc(x: float, y: float, radius: float) -> Any:
    from matplotlib.patches import Circle

    return Circle((x, y), radius, facecolor=BAND, edgecolor=INK, linewidth=1.0, zorder=2)


def _box(x: float, y: float, width: float, height: float, fill: str) -> Any:
    from matplotlib.patches import FancyBboxPatch

    return FancyBboxPatch((x, y), width, height, boxstyle="round,pad=0,rounding_size=2",
                          facecolor=fill, edgecolor=INK, linewidth=1.0, zorder=2)


HOOK, LOAD, MAX_TURNS = 0.01, 0.5, 200


def iterated_tension() -> Any:
    """Tension [N] after each iteration of a solver that treats tendon and pin in turn."""
    cable = pin = 0.0
    found = [0.0]
    for _ in range(MAX_TURNS):
        cable = pin + HOOK * GRAVITY
        pin = (cable / HOOK) / (1 / HOOK + 1 / LOAD)
        found.append(cable)
    return np.array(found)


def hook(path: Path) -> None:
    """The weight on a light hook of docs/engine.md, with the tension of an iterative solver."""
    figure = new_figure(64.0)
    figure.set_layout_engine("none")
    sketch = blank(figure, (0.0, 0.0, 0.3, 1.0), (-20, 22), (-40, 34))
    sketch.plot([-12, 12], [30, 30], color=GREY, linewidth=5, solid_capstyle="butt")
    sketch.plot([0, 0], [30, 4], color=ORANGE, linewidth=2)
    sketch.add_patch(_disc(0, 1, 3))
    sketch.plot([0, 0], [-2, -10], color=INK, linewidth=2)
    sketch.add_patch(_box(-9, -30, 18, 20, BAND))
    for y, words in ((18, "tendon"), (0, "hook, 10 g"), (-7, "pin")):
        sketch.text(5, y, words, fontsize=7.5, color=INK, va="center")
    sketch.text(0, -20, "0.5 kg", fontsize=8, color=INK, ha="center", va="center")
    axes = figure.add_axes((0.4, 0.2, 0.57, 0.62))
    truth, turns = (HOOK + LOAD) * GRAVITY, iterated_tension()
    axes.plot(turns, color=ORANGE, linewidth=1.5)
    axes.plot([0, MAX_TURNS], [truth, truth], color=BLUE, linewidth=1.5)
    axes.plot(40, turns[40], "o", color=ORANGE, markersize=4)
    axes.text(46, turns[40] - 0.15, f"40 iterations: {turns[40]:.1f} N", fontsize=7.5, va="top",
              color=ORANGE)
    axes.text(MAX_TURNS, truth + 0.12, f"direct solver: {truth:.2f} N", fontsize=7.5, ha="right",
              va="bottom", color=BLUE)
    axes.set(xlim=(0, MAX_TURNS), ylim=(0, 5.9))
    axes.set_title("Tendon tension at rest", loc="left", fontsize=8.5, color=INK)
    plain(axes, "iterations", "tendon tension [N]")
    save_figure(figure, path)


def steps(path: Path) -> None:
    """Floor force on the ball of docs/convergence.md at h, h/2 and h/4."""
    page = (DOCS / "convergence.md").read_text(encoding="utf-8")
    scene = re.findall(r"^```json scene\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)[0]
    figure = new_figure(60.0)
    axes = figure.add_subplot()
    for part, colour in ((1, BLUE), (2, ORANGE), (4, SLATE)):
        run = sandbox.simulate(sandbox.load_scene(json.loads(scene), overrides={
            "run.step": 1e-3 / part, "run.sample_rate": 1e3 * part}))
        force = run["ball.contact.normal"]
        axes.plot(1e3 * run.time, force, color=colour, linewidth=1.3, marker="o", markersize=2)
        at = int(force.argmax())
        axes.annotate(f"{['h', 'h/2', '', 'h/4'][part - 1]}: {force[at]:.1f} N",
                      (1e3 * run.time[at], force[at]), (-5, 0), textcoords="offset points",
                      fontsize=8, color=colour, ha="right", va="center")
    axes.text(37.9, 0.45, "at rest: its weight, 0.0981 N", fontsize=8, color=INK,
              ha="right", va="bottom")
    axes.set(xlim=(28, 38), ylim=(0, None))
    plain(axes, "time [ms]", "force of the floor [N]")
    save_figure(figure, path)


def untrusted(path: Path) -> None:
    """An untrusted file: read as data, checked against ranges, run or refused."""
    figure = new_figure(44.0)
    figure.set_layout_engine("none")
    axes = blank(figure, (0, 0, 1, 1), (0, 120), (0, 44))
    for x, title, lines, fill in (
            (2, "untrusted file", "numbers, names,\nexpressions;\nno code", BAND),
            (33, "read", "its own grammar;\nlimited size\nand nesting", "white"),
            (64, "range check", "each number and\nderived values", "white")):
        axes.add_patch(_box(x, 12, 26, 22, fill))
        axes.text(x + 13, 29, title, ha="center", va="center", fontsize=8.5, color=INK)
        axes.text(x + 13, 20, lines, ha="center", va="center", fontsize=7, color=QUIET)
    for y, title, lines, fill in ((24, "a run", "limited in time", GREEN),
                                  (6, "errors", "one line each", BAND)):
        axes.add_patch(_box(95, y, 23, 14, fill))
        axes.text(106.5, y + 9, title, ha="center", va="center", fontsize=8.5, color=INK)
        axes.text(106.5, y + 4.5, lines, ha="center", va="center", fontsize=6.5, color=QUIET)
    for start, end in (((28, 23), (33, 23)), ((59, 23), (64, 23)), ((90, 26), (95, 31)),
                       ((90, 20), (95, 13))):
        arrow(axes, start, end, SLATE)
    save_figure(figure, path)


@contextlib.contextmanager
def page_of(address: str, high: int) -> Iterator[Any]:
    """A page in a Chromium that shows nothing, once it is ready (of the extra ``dev``).

    It is narrow, so that letters are read where the picture is.
    """
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        browser = driver.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 640, "height": high}, device_scale_factor=1.5)
        page.goto(address)
        yield page
        browser.close()


def report_page(path: Path) -> None:
    """The page of ``sandbox report``, of a finger that closes."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "report.html"
        sandbox.simulate(sandbox.load_scene("single_finger")).save(folder)
        invoke(["report", folder, "--out", str(file), "--quiet"])
        with page_of(f"{file.as_uri()}#t=0.3", 980) as page:
            page.wait_for_selector("html[data-ready]", state="attached")
            page.wait_for_timeout(500)
            page.screenshot(path=path)


def view_page(path: Path) -> None:
    """The page of ``sandbox view``, while a finger is pulled by the mouse."""
    words = [sys.executable, "-m", "sandbox", "view", "single_finger", "--no-browser"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as serves:
        address = serves.stdout.readline().strip() if serves.stdout else ""
        with page_of(address, 860) as page:
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
    """The data flow of docs/extending.md."""
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


SKETCHES: dict[str, Callable[[Path], None]] = {
    "audit_groove.png": groove, "engine_hook.png": hook, "certify_steps.png": steps,
    "untrusted.png": untrusted, "tutorial_finger_arms.png": finger_arms,
    "extending_way.png": way_of_the_data, "report_page.png": report_page,
    "view_page.png": view_page,
}
