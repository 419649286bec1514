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


def test_going_back_moves_sliders_to_what_they_were(view: View) -> None:
    view.until("sandbox.frame.t > 0.6")
    view.page.keyboard.press("Space")
    view.until("!sandbox.playing")
    pull = view.page.locator("[data-typed='parameters.pull']")
    before = pull.input_value()
    view.page.click("#step")
    pull.fill("11 N")
    pull.press("Enter")
    view.until("sandbox.controls.rows.get('actuator').box.querySelector('input').max > 0")
    there = view.get("sandbox.frame.t")
    view.page.click("#step")
    view.until(f"sandbox.frame.t > {there}")
    assert pull.input_value() == "11"
    view.page.click("#back")
    view.until(f"sandbox.frame.t < {there} + 1e-6")
    view.until(f"document.querySelector(\"[data-typed='parameters.pull']\").value === '{before}'")


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
    view.until("sandbox.meters.time.length > 20")
    assert view.get("sandbox.meters.time.every((t, i, all) => !i || t > all[i - 1])")
    assert view.page.locator("[data-typed='parameters.pitch']").input_value() == "12"
    view.page.locator("[data-typed='parameters.pitch']").fill("3 N")
    view.page.keyboard.press("Enter")
    view.until("sandbox.said.textContent.includes('unit of force')")
    box = view.page.locator("#said").bounding_box()
    assert box["y"] + box["height"] <= 900
    drawn = view.get("sandbox.frame.t")
    view.get("sandbox.send({ speed: 0.5 })")  # a status comes: the error stays
    view.until(f"sandbox.speeds.value === '0.5' && sandbox.frame.t > {drawn} + 0.1")
    assert "unit of force" in view.get("sandbox.said.textContent")
    for typed, said in (("abc", "is not a number with a unit"), ("5 kg", "is a unit of mass")):
        view.page.locator("[data-typed='actuator']").fill(typed)
        view.page.keyboard.press("Enter")
        view.until(f"sandbox.said.textContent.includes({said!r})")


DRAG = """async () => {
  const slider = document.querySelector("[data-control='parameters.pitch']");
  const own = sandbox.link.send, ids = [], stages = new Set();
  let most = 0;
  sandbox.link.send = (text) => {
    const asked = JSON.parse(text);
    if (asked.set) ids.push(asked.id);
    most = Math.max(most, ids.filter((id) => sandbox.sent.has(id)).length);
    own(text);
  };
  for (let k = 1; k <= 60; k++) {
    slider.value = 105 + k / 2;
    slider.dispatchEvent(new Event("input"));
    await new Promise((done) => setTimeout(done, 20));
    if (sandbox.frame) stages.add(sandbox.stage);
    if (document.querySelectorAll(".sheet canvas").length !== 1) throw new Error("no picture");
  }
  return { asked: ids.length, most, pictures: stages.size };
}"""


def test_a_slider_that_is_dragged_has_one_request_under_way_and_ends_at_the_last_value(
    view: View,
) -> None:
    found = view.page.evaluate(DRAG)
    assert found["most"] == 1
    assert 1 < found["pictures"] <= found["asked"] < 60
    view.until("sandbox.head.controls.find((c) => c.name === 'parameters.pitch').value === 135")


def test_warnings_stand_in_place_and_a_run_that_diverges_says_why(
    browser: Any, serve: Callable[..., str], tmp_path: Path,
) -> None:
    view = View(browser, serve("slider_crank"))
    assert not view.page.locator("#warned").is_visible()
    for typed, said in (("200 mm", "not assembled at t = 0"), ("30 mm", "")):
        view.page.locator("[data-typed='parameters.r']").fill(typed)
        view.page.keyboard.press("Enter")
        view.until(f"sandbox.warned.textContent.includes({said!r})"
                   f" && sandbox.warned.hidden === {str(not said).lower()}")
    view.done()
    file = tmp_path / "kicked.json"
    file.write_text(json.dumps({
        "name": "kicked", "bodies": [{"name": "ball", "mass": 0.05, "shapes": [
            {"type": "circle", "radius": 0.01}]}], "drives": [
            {"type": "force", "name": "kick", "body": "ball", "direction": [1, 0], "value": 0.1}]}))
    view = View(browser, serve(str(file)))
    span = "(({ min, max }) => [+min, +max])(document.querySelector(\"[data-control='kick']\"))"
    assert view.get(span) == [0, 0.2]
    for typed in ("1e9", "0.1"):
        view.page.locator("[data-typed='kick']").fill(typed)
        view.page.keyboard.press("Enter")
        view.until("!sandbox.playing && /diverged at .* ball: its/.test(sandbox.state.value)")
        view.page.wait_for_timeout(100)
    assert view.get(span) == [0, 2]
    view.page.click("#reset")
    view.until("sandbox.state.value === '' && sandbox.frame.t < 0.1")
    assert view.get(span) == [0, 0.2]
    view.page.click("#play")
    view.until("sandbox.playing && sandbox.frame.t > 0.1")
    view.done()


def test_meters_and_traces_keep_what_was_before_the_instant_gone_back_to(view: View) -> None:
    view.page.locator("[data-layer='traces']").check()
    view.until("sandbox.frame.t > 1")
    view.page.click("#back")
    view.until("!sandbox.playing && !sandbox.working")
    view.page.wait_for_timeout(100)
    there, times, trail, points = view.get(
        "[sandbox.frame.t, sandbox.meters.time, sandbox.instants, sandbox.ways[0].way.length]")
    assert times[-1] == trail[-1] == there
    for instants in (times, trail):
        assert instants[0] < 0.2
        assert np.all(np.diff(instants) > 0)
    assert points == 2 * len(trail)
    assert all(len(row) == len(times) for row in view.get("sandbox.meters.rows"))


def test_what_rests_is_a_straight_line_and_what_moves_no_stairs(view: View) -> None:
    """Of a value that is told as float32, its last digits are not spread over a plot."""
    view.page.keyboard.press("Space")
    view.until("!sandbox.playing && sandbox.frame")
    view.page.wait_for_timeout(200)
    plot = "sandbox.meters.plots[0]"
    for last, span in ((3.750001, (3.75e-4, 10.0)), (3.76, (0.01, 0.02)), (4.75, (1.0, 2.0))):
        view.get(f"{plot}.set([0, 1], {plot}.of.map(() => [3.75, {last}]))")
        low, high = view.get(f"[{plot}.u.scales.y.min, {plot}.u.scales.y.max]")
        assert low < 3.75 < last < high
        assert span[0] < high - low < span[1]
    assert view.get(f"{plot}.u.series[1].pxAlign") == 0


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
    view.until("sandbox.frame.t > 0.2 && sandbox.meters.plots.length === 1")
    view.page.fill("#add", "finger1.*.angle")
    view.page.keyboard.press("Enter")
    view.until("sandbox.meters.watched.length > 5")
    view.until("sandbox.meters.plots.length === 2"
               " && sandbox.meters.plots[1].u.data[1].some((v) => v !== null)")
    view.page.locator(".plot .close").first.click()
    view.until("sandbox.meters.plots.length === 1")
    view.page.mouse.click(*view.place("finger4.proximal"))
    view.until("sandbox.meters.watched.some((w) => w.name.startsWith('finger4.proximal.'))")
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
    view.until("sandbox.state.classList.contains('bad')")
    assert "mine.json:1" in view.get("sandbox.state.textContent")
    file.write_text(json.dumps({**data, "title": "mended"}))
    view.until("document.querySelector('h1').textContent === 'mended'")
    assert view.get("sandbox.state.textContent") == ""
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


@pytest.fixture
def limited(browser: Any, serve: Callable[..., str], tmp_path: Path) -> Iterator[View]:
    """A crank with a motor whose torque no frame tells; its view follows the crank, slowly."""
    file = tmp_path / "crank.json"
    file.write_text(json.dumps({
        "format": 1, "parameters": {"arm": "100 mm"}, "run": {"duration": 1},
        "bodies": [{"name": "frame", "motion": "fixed"},
                   {"name": "crank", "mass": 1, "shapes": [
                       {"type": "capsule", "end": ["=arm", 0], "radius": 0.01}]}],
        "joints": [{"type": "pin", "name": "shaft", "a": "frame", "b": "crank", "on_b": [0, 0]}],
        "drives": [{"type": "motor", "name": "motor", "joint": "shaft", "value": "30 rpm",
                    "torque": 5}],
        "view": {"follow": "crank", "speed": 0.3, "meters": ["crank.angle", "motor.work"]}}))
    made = View(browser, serve(str(file)), viewport={"width": 1280, "height": 900})
    yield made
    made.done()


def test_a_beginning_anew_keeps_whom_the_camera_goes_along_with(limited: View) -> None:
    page = limited.page
    assert limited.get("sandbox.stage.follow") == 1
    page.get_by_label("follow").select_option("-1")
    page.locator("[data-typed='parameters.arm']").fill("120 mm")
    limited.get("globalThis.first = sandbox.stage; 0")
    page.keyboard.press("Enter")
    limited.until("sandbox.stage !== first")
    assert limited.get("[sandbox.stage.follow, sandbox.follow.value]") == [-1, "-1"]


def test_a_meter_that_no_frame_tells_is_named_with_the_reason(limited: View) -> None:
    page, reason = limited.page, "'motor.work' is worked out after a run and cannot be read"
    assert reason in page.locator("#absent").inner_text()
    page.fill("#add", "motor.work")
    page.keyboard.press("Enter")
    limited.until(f"sandbox.said.textContent.includes(`{reason}`)")
    page.fill("#add", "motor.*")  # of several those that are told
    page.keyboard.press("Enter")
    limited.until("sandbox.meters.watched.some((one) => one.name === 'motor.value')")
    page.fill("#add", "motor.wrk")
    page.keyboard.press("Enter")
    limited.until("sandbox.said.textContent.includes('did you mean motor.work?')")


def test_a_drive_is_typed_in_a_unit_of_its_own(limited: View) -> None:
    typed = limited.page.locator("[data-typed='motor']")
    typed.fill("60 rpm")
    limited.page.keyboard.press("Enter")
    limited.until("Math.abs(sandbox.frame.drive[0] - 2 * Math.PI) < 1e-5")
    assert typed.input_value() == "6.283"
    typed.fill("60 N")
    limited.page.keyboard.press("Enter")
    limited.until("sandbox.said.textContent.includes('this is an angular speed')")
    assert typed.input_value() == "6.283"


@pytest.mark.parametrize("aside", [0, 9])
def test_a_drag_on_a_hinge_or_its_motor_pulls_the_body(limited: View, aside: float) -> None:
    limited.page.get_by_label("follow").select_option("-1")
    x, y = limited.get("sandbox.stage.at([1, 0, 0])")
    box = limited.page.locator(".sheet canvas").bounding_box()
    limited.page.mouse.move(box["x"] + x + aside, box["y"] + y)
    limited.page.mouse.down()
    limited.page.mouse.move(box["x"] + x + aside + 60, box["y"] + y - 40, steps=4)
    limited.until("sandbox.frame.hand === 1 && sandbox.frame.force_x > 0")
    assert limited.get("sandbox.stage.pan") == [0, 0]
    limited.page.mouse.up()
