"""The live view in a real browser: it runs, is pulled and set, and what was played runs again."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.scene.library import shipped_scenes

pytest.importorskip("websockets", reason="the extra 'view' is not installed")
PATIENCE = 60.0
"""Seconds: ten times what it takes on a busy machine."""
HOSTILE = '</script><script>globalThis.pwned=1</script><img src=x onerror="globalThis.pwned=2">'


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Callable[..., str]]:
    """Starts ``sandbox view`` with some words; its address."""
    processes = []

    def start(*words: str) -> str:
        process = subprocess.Popen(
            [sys.executable, "-m", "sandbox", "view", *words, "--no-browser"], cwd=tmp_path,
            stdout=subprocess.PIPE, text=True)
        processes.append(process)
        assert process.stdout is not None
        return process.stdout.readline().strip()

    yield start
    for process in processes:
        process.send_signal(signal.SIGINT)
        with process:
            process.wait(PATIENCE)


class View:
    """A page that is open, and what its console said."""

    def __init__(self, browser: Any, address: str, **options: Any) -> None:
        self.bad: list[str] = []
        self.context = browser.new_context(accept_downloads=True, **options)
        self.page = page = self.context.new_page()
        page.on("console", lambda m: self.bad.append(m.text)
                if m.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: self.bad.append(str(error)))
        root = address.rsplit("/", 1)[0]
        page.on("request", lambda asked: self.bad.append(asked.url) if not asked.url.startswith(
            (root, "data:", "blob:")) else None)
        page.goto(address)
        self.until("globalThis.sandbox && sandbox.frame && sandbox.stats.drawn > 2")

    def get(self, expression: str) -> Any:
        return self.page.evaluate(expression)

    def until(self, expression: str) -> None:
        """Wait until something holds; the page's own rules forbid ``wait_for_function``."""
        end = time.monotonic() + PATIENCE
        while not self.get(f"!!({expression})"):
            assert time.monotonic() < end, (expression, self.bad, self.get("sandbox.said.value"))
            self.page.wait_for_timeout(20)

    def place(self, body: str) -> tuple[float, float]:
        """Where the middle of a body is on the page."""
        x, y = self.get(f"""(() => {{
            const i = sandbox.head.bodies.findIndex((b) => b.name === "{body}");
            return sandbox.stage.at([i, ...sandbox.head.bodies[i].centre]);
        }})()""")
        box = self.page.locator(".sheet canvas").bounding_box()
        return box["x"] + x, box["y"] + y

    def pose(self, body: str) -> Any:
        return np.array(self.get(f"""(() => {{
            const i = sandbox.head.bodies.findIndex((b) => b.name === "{body}");
            return [...sandbox.pose.slice(3 * i, 3 * i + 3)];
        }})()"""))

    def pull(self, body: str, right: float, up: float) -> None:
        """Take hold of a body and go so many pixels, without letting go."""
        x, y = self.place(body)
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        for share in np.linspace(0.2, 1, 5):
            self.page.mouse.move(x + share * right, y - share * up)

    def done(self) -> None:
        assert self.bad == []
        self.context.close()


@pytest.fixture
def view(browser: Any, serve: Callable[..., str]) -> Iterator[View]:
    made = View(browser, serve("adaptive_grasp"), viewport={"width": 1280, "height": 900})
    yield made
    made.done()


def test_it_runs_a_slider_changes_tensions_and_a_body_follows_the_mouse(view: View) -> None:
    began = view.get("sandbox.frame.t")
    view.until(f"sandbox.frame.t > {began} + 0.5")
    view.until("sandbox.frame.t > 0.6")
    view.page.locator("[data-control='actuator']").fill("6")
    view.until("Math.abs(sandbox.frame.tension[0] - 1.5) < 0.01")  # a quarter each
    view.page.locator("[data-typed='parameters.pull']").fill("22 N")
    view.page.keyboard.press("Enter")
    view.until("Math.abs(sandbox.frame.tension[0] - 5.5) < 0.01")
    assert view.get("sandbox.frame.t") > 0.6  # it went on
    view.until(f"sandbox.frame.t > {view.get('sandbox.frame.t')} + 0.6")  # it lies still
    before = view.pose("finger2.distal")
    view.pull("finger2.distal", 80, 60)
    view.until("sandbox.frame.hand >= 0 && Math.abs(sandbox.frame.force_x) > 0.05")
    view.page.wait_for_timeout(300)
    assert np.abs(view.pose("finger2.distal") - before).max() > 0.005
    view.page.mouse.up()
    view.until("sandbox.frame.hand < 0")


def test_pause_step_back_reset_and_speed(view: View) -> None:
    view.until("sandbox.frame.t > 0.3")
    view.page.keyboard.press("Space")
    view.until("!sandbox.playing")
    view.page.wait_for_timeout(200)
    there = view.get("sandbox.frame.t")
    view.page.wait_for_timeout(200)
    assert view.get("sandbox.frame.t") == there
    pose = view.pose("finger1.distal")
    view.page.click("#step")
    view.until(f"sandbox.frame.t > {there}")
    assert view.get("sandbox.frame.t") - there == pytest.approx(1 / 60, abs=1e-3)
    view.page.keyboard.press("ArrowLeft")
    view.until(f"Math.abs(sandbox.frame.t - {there}) < 1e-6")
    assert np.array_equal(view.pose("finger1.distal"), pose)
    view.page.select_option("#speed", "0.25")
    view.page.click("#play")
    view.until("sandbox.playing")
    view.page.keyboard.press("r")
    view.until(f"sandbox.frame.t < {there}")


def test_a_parameter_that_shapes_the_scene_and_a_wrong_one(view: View) -> None:
    view.until("sandbox.frame.t > 0.3")
    view.page.mouse.move(*view.place("finger1.proximal"))
    view.page.mouse.wheel(0, -200)
    zoom = view.get("sandbox.stage.zoom")
    assert zoom > 1
    palm = view.pose("finger1.palm")
    view.page.locator("[data-typed='parameters.pitch']").fill("12 cm")
    view.page.keyboard.press("Enter")
    view.until(f"Math.abs(sandbox.pose[1] - {palm[1]}) > 0.04")  # it is 3 pitches up
    assert view.get("sandbox.stage.zoom") == zoom
    view.until("sandbox.time.length > 20")
    assert view.get("sandbox.time.every((t, i, all) => !i || t > all[i - 1])")
    assert view.page.locator("[data-typed='parameters.pitch']").input_value() == "12"
    view.page.locator("[data-typed='parameters.pitch']").fill("3 N")
    view.page.keyboard.press("Enter")
    view.until("sandbox.said.textContent.includes('no force')")
    for typed in ("abc", "5 kg"):
        view.page.locator("[data-typed='actuator']").fill(typed)
        view.page.keyboard.press("Enter")
        view.until(f"sandbox.said.textContent.includes(\"'{typed}' is no finite number\")")


def test_what_was_played_is_saved_and_runs_again(view: View, tmp_path: Path) -> None:
    view.until("sandbox.frame.t > 1.5")  # it lies still, and the mouse finds it
    view.pull("finger3.distal", 60, 40)
    view.until("sandbox.frame.hand >= 0")
    view.page.locator("[data-control='actuator']").focus()
    view.page.wait_for_timeout(200)
    view.page.mouse.up()
    view.page.locator("[data-control='actuator']").fill("9")
    view.until("Math.abs(sandbox.frame.drive[0] - 9) < 1e-3")
    view.page.keyboard.press("Escape")
    view.page.click("#play")
    view.until("!sandbox.playing")
    view.page.wait_for_timeout(300)
    time_s, pose = view.get("sandbox.frame.t"), view.pose("finger3.distal")
    with view.page.expect_download() as got:
        view.page.click("#save-scene")
    file = tmp_path / "mine.json"
    got.value.save_as(file)
    first, second = (sandbox.simulate(sandbox.load_scene(file)) for _ in range(2))
    assert all(first.arrays[key].tobytes() == second.arrays[key].tobytes() for key in first.arrays)
    assert first.time[-1] == pytest.approx(time_s, abs=2e-3)
    index = [body.name for body in first.mechanism.bodies].index("finger3.distal")
    assert first.arrays["body_pose"][-1, index] == pytest.approx(pose, abs=2e-3)
    assert first["hand1.x.value"].max() > 0.01
    view.page.click("#save-run")
    view.until("sandbox.said.textContent.includes('the run is in')")
    assert (tmp_path / "renders" / "adaptive_grasp_played" / "run.json").is_file()
    with view.page.expect_download() as got:
        view.page.click("#picture")
    assert got.value.suggested_filename.endswith(".png")


def test_meters(view: View) -> None:
    view.until("sandbox.frame.t > 0.2 && sandbox.plots.length === 1")
    view.page.fill("#add", "finger1.*.angle")
    view.page.keyboard.press("Enter")
    view.until("sandbox.watched.length > 5")
    view.until("sandbox.plots.length === 2 && sandbox.plots[1].u.data[1].some((v) => v !== null)")
    view.page.locator(".plot .close").first.click()
    view.until("sandbox.plots.length === 1")
    view.page.mouse.click(*view.place("finger4.proximal"))
    view.until("sandbox.watched.some((w) => w.name.startsWith('finger4.proximal.'))")
    view.page.fill("#add", "finger1.pip.angel")
    view.page.keyboard.press("Enter")
    view.until("sandbox.said.textContent.includes('did you mean finger1.pip.angle')")


def test_a_saved_file_is_read_anew_and_faults_are_shown_in_place(
    browser: Any, serve: Callable[..., str], tmp_path: Path,
) -> None:
    file = tmp_path / "mine.json"
    data = json.loads(shipped_scenes()["single_finger"].read_text(encoding="utf-8"))
    data.pop("$schema", None)
    file.write_text(json.dumps({**data, "title": HOSTILE}))
    view = View(browser, serve(str(file)))
    assert view.get("document.querySelector('h1').textContent") == HOSTILE
    assert view.get("[globalThis.pwned, document.images.length]") == [None, 0]
    file.write_text("{")
    view.until("sandbox.said.classList.contains('bad')")
    assert "mine.json:1" in view.get("sandbox.said.textContent")
    file.write_text(json.dumps({**data, "title": "mended"}))
    view.until("document.querySelector('h1').textContent === 'mended'")
    assert view.get("sandbox.said.textContent") == ""
    view.done()


@pytest.mark.parametrize("scene", ["coupler_curve", "pneumatic_hand"])
def test_every_layer_can_be_shown(browser: Any, serve: Callable[..., str], scene: str) -> None:
    view = View(browser, serve(scene))
    for box in view.page.locator("[data-layer]").all():
        box.check()
    drawn = view.get("sandbox.stats.drawn")
    view.until(f"sandbox.stats.drawn > {drawn} + 5")
    assert view.get("sandbox.stage.layers.size") == view.page.locator("[data-layer]").count()
    view.done()


def test_a_wrong_token_is_refused(browser: Any, serve: Callable[..., str]) -> None:
    page = browser.new_page()
    assert page.goto(serve("single_finger")[:-2] + "xx").status == 403
    page.close()


def test_on_a_phone_and_in_the_dark_nothing_is_cut_off(
    browser: Any, serve: Callable[..., str],
) -> None:
    view = View(browser, serve("finger_dual_control"), viewport={"width": 390, "height": 844},
                device_scale_factor=2, is_mobile=True, has_touch=True, color_scheme="dark")
    assert view.get("document.documentElement.scrollWidth <= screen.width")
    assert view.get("sandbox.stage.dark")
    view.page.click("#play")
    view.until("!sandbox.playing")
    view.done()
