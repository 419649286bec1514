"""The live view in a real browser: four smoke checks by day, the rest with ``-m nightly``."""

import json

import numpy as np
import pytest

import sandbox
from tests.browser.conftest import PHONE, body_at, until
from tests.web.test_page import EVIL

pytest.importorskip("websockets", reason="the extra 'view' is not installed")
nightly = pytest.mark.nightly
SAID = "document.querySelector('#said').value"
CRANK = {
    "format": 1, "parameters": {"arm": "100 mm"}, "run": {"duration": 100},
    "bodies": [{"name": "frame", "motion": "fixed"},
               {"name": "crank", "mass": 1, "shapes": [
                   {"type": "capsule", "end": ["=arm", 0], "radius": 0.01}]},
               {"name": "ball", "at": [0, -0.1], "mass": 0.05,
                "shapes": [{"type": "circle", "radius": 0.01}]}],
    "joints": [{"type": "pin", "name": "shaft", "a": "frame", "b": "crank", "on_b": [0, 0]}],
    "drives": [{"type": "motor", "name": "motor", "joint": "shaft", "value": "30 rpm", "torque": 5},
               {"type": "force", "name": "kick", "body": "ball", "direction": [1, 0],
                "value": 0.1}],
    "view": {"follow": "crank", "speed": 0.3, "meters": ["crank.angle", "motor.work"]}}
DRAG = """async () => {
  const slider = document.querySelector("[data-control='parameters.pitch']");
  const own = sandbox.link.send, ids = [], stages = new Set();
  let most = 0, moves = 0;
  sandbox.link.send = (text) => {
    const asked = JSON.parse(text);
    if (asked.set) ids.push(asked.id);
    most = Math.max(most, ids.filter((id) => id > sandbox.answered).length);
    own(text);
  };
  while (moves < 60 || (stages.size < 2 && moves < 3000)) {   // a busy machine takes longer
    slider.value = 105 + (++moves % 60 || 60) / 2;
    slider.dispatchEvent(new Event("input"));
    await new Promise((done) => setTimeout(done, 20));
    if (sandbox.frame) stages.add(sandbox.stage);
    if (document.querySelectorAll(".sheet canvas").length !== 1) throw new Error("no picture");
  }
  slider.value = 135;
  slider.dispatchEvent(new Event("input"));
  return { asked: ids.length, most, moves, pictures: stages.size };
}"""


def pose(tab, body):
    return np.array(tab.evaluate(
        "(name) => { const i = sandbox.head.bodies.findIndex((b) => b.name === name);"
        " return [...sandbox.frame.pose.slice(3 * i, 3 * i + 3)]; }", body))


def pull(tab, at, right, up):
    """Take hold at a place and go so many pixels, without letting go."""
    tab.mouse.move(*at)
    tab.mouse.down()
    tab.mouse.move(at[0] + right, at[1] - up, steps=5)


def set_typed(tab, name, text):
    tab.locator(f"[data-typed='{name}']").fill(text)
    tab.keyboard.press("Enter")


@pytest.fixture
def crank(served, tmp_path):
    """A motor whose work no frame tells; the view follows the crank, slowly."""
    file = tmp_path / "crank.json"
    file.write_text(json.dumps({**CRANK, "title": EVIL}))
    return served(file, viewport={"width": 1280, "height": 720})


def test_it_runs_is_pulled_ends_steps_back_and_resets(served):
    tab = served("adaptive_grasp")
    tab.locator("[data-layer='traces']").check()
    until(tab, "sandbox.frame.t > 1.2")  # it lies still, and the mouse finds it
    tab.select_option("#speed", "0.1")
    before = pose(tab, "finger2.distal")
    pull(tab, body_at(tab, "finger2.distal"), 80, 60)
    until(tab, "sandbox.frame.hand >= 0 && Math.abs(sandbox.frame.force_x) > 0.05")
    until(tab, "!sandbox.playing")
    tab.select_option("#speed", "1")
    assert np.abs(pose(tab, "finger2.distal") - before).max() > 0.005
    tab.mouse.up()
    assert "The scene ends at 2 s." in tab.evaluate("sandbox.state.value")
    until(tab, "Math.abs(sandbox.frame.t - 2) < 1e-3")  # the frames before may still come
    there, before = tab.evaluate("sandbox.frame.t"), pose(tab, "finger1.distal")
    set_typed(tab, "parameters.pull", "22 N")
    tab.click("#step")
    # a quarter of the pull each
    until(tab, f"sandbox.frame.t > {there} && [...sandbox.rows.values()][0].at(-1) > 5.4")
    assert tab.evaluate("sandbox.frame.t") - there == pytest.approx(1 / 60, abs=1e-3)
    tab.click("#back")
    until(tab, f"Math.abs(sandbox.frame.t - {there}) < 1e-6")
    assert np.array_equal(pose(tab, "finger1.distal"), before)
    for instants in tab.evaluate("[sandbox.time, sandbox.instants]"):
        assert instants[-1] == tab.evaluate("sandbox.frame.t")
        assert np.all(np.diff(instants) > 0)
    until(tab, "document.querySelector(\"[data-typed='parameters.pull']\").value === '15'")
    tab.select_option("#speed", "0.25")
    tab.click("#play")
    until(tab, f"sandbox.playing && !sandbox.state.value && sandbox.frame.t > {there} + 0.05")
    tab.keyboard.press("r")
    until(tab, f"sandbox.frame.t < {there}")


def test_a_dragged_slider_has_one_request_under_way_and_ends_at_the_last_value(served):
    tab = served("adaptive_grasp")
    found = tab.evaluate(DRAG)
    assert found["most"] == 1
    assert 1 < found["pictures"] <= 1 + found["asked"] < found["moves"]  # one is there before
    until(tab, "sandbox.head.controls.find((c) => c.name === 'parameters.pitch').value === 135")


def test_errors_stay_in_sight_until_the_next_action_and_a_hinge_is_pulled(crank, tmp_path):
    file = tmp_path / "crank.json"
    assert crank.evaluate("document.querySelector('h1').textContent") == EVIL
    assert crank.evaluate("[window.pwned ?? 0, document.images.length]") == [0, 0]
    set_typed(crank, "parameters.arm", "3 N")
    until(crank, f"{SAID}.includes('unit of force')")
    for text in ("{", json.dumps({**CRANK, "title": "mended"})):
        file.write_text(text)
        until(crank, f"sandbox.state.value.includes('crank.json:1') === {json.dumps(text == '{')}")
        box = crank.locator("#said").bounding_box()
        assert box["y"] + box["height"] <= 720
        assert "unit of force" in crank.evaluate(SAID)
    until(crank, "document.querySelector('h1').textContent === 'mended'")
    crank.click("#play")
    until(crank, f"!sandbox.playing && {SAID} === ''")
    crank.get_by_label("follow").select_option("-1")
    crank.wait_for_timeout(100)
    x, y = body_at(crank, "crank", 0, 0)  # the hinge, with the mark of its motor
    for aside in (0, 9):
        pull(crank, (x + aside, y), 60, 40)
        until(crank, "sandbox.frame.hand === 1")
        crank.mouse.up()
        until(crank, "sandbox.frame.hand < 0")
    assert crank.evaluate("sandbox.stage.pan") == [0, 0]


def test_what_was_played_is_saved_and_runs_again(served, tmp_path):
    tab = served("adaptive_grasp")
    until(tab, "sandbox.frame.t > 1")
    pull(tab, body_at(tab, "finger3.distal"), 60, 40)
    until(tab, "sandbox.frame.hand >= 0 && sandbox.frame.force_x > 0.01")
    tab.mouse.up()
    tab.locator("[data-control='actuator']").fill("9")
    until(tab, "Math.abs(sandbox.frame.drives[0] - 9) < 1e-3 && !sandbox.playing")
    with tab.expect_download() as got:
        tab.click("#save-scene")
    file = tmp_path / "mine.json"
    got.value.save_as(file)
    first, second = (sandbox.simulate(sandbox.load_scene(file)) for _ in range(2))
    assert all(first.arrays[key].tobytes() == second.arrays[key].tobytes() for key in first.arrays)
    assert first.time[-1] == pytest.approx(tab.evaluate("sandbox.frame.t"), abs=2e-3)
    index = [body.name for body in first.mechanism.bodies].index("finger3.distal")
    assert first.arrays["body_pose"][-1, index] == pytest.approx(
        pose(tab, "finger3.distal"), abs=2e-3)
    assert first["hand1.x.value"].max() > 0.01
    tab.click("#save-run")
    until(tab, f"{SAID}.includes('the run is in')")
    assert (tmp_path / "renders" / "adaptive_grasp_played" / "run.json").is_file()


@nightly
def test_a_new_beginning_keeps_the_camera_and_a_divergence_is_told(crank):
    crank.get_by_label("follow").select_option("-1")
    crank.locator("canvas").first.focus()
    crank.keyboard.press("+")
    zoom = crank.evaluate("globalThis.first = sandbox.stage; sandbox.stage.zoom")
    set_typed(crank, "parameters.arm", "12 cm")
    until(crank, "sandbox.stage !== first && sandbox.time.length > 5")
    assert crank.evaluate("[sandbox.stage.follow, sandbox.stage.zoom]") == [-1, zoom]
    span = "(({ min, max }) => [+min, +max])(document.querySelector(\"[data-control='kick']\"))"
    assert crank.evaluate(span) == [0, 0.2]
    set_typed(crank, "kick", "1e9")
    until(crank, "!sandbox.playing && /diverged at .* ball: its/.test(sandbox.state.value)")
    assert crank.evaluate(span) == [0, 2]
    crank.click("#reset")
    until(crank, "sandbox.state.value === '' && sandbox.frame.t < 0.1")
    assert crank.evaluate(span) == [0, 0.2]


@nightly
@pytest.mark.parametrize("scene", ["coupler_curve", "pneumatic_hand", "finger_dual_control"])
def test_every_layer_is_shown_on_a_phone_in_the_dark(served, scene):
    tab = served(scene, **PHONE)
    assert tab.evaluate("document.documentElement.scrollWidth <= screen.width")
    assert tab.evaluate("sandbox.stage.night")
    tab.get_by_text("layers", exact=True).click()
    for box in tab.locator("[data-layer]").all():
        box.check()
    tab.evaluate("sandbox.ask({ do: 'run' })")  # it may have come to its end
    until(tab, f"sandbox.drawn > {tab.evaluate('sandbox.drawn')} + 5")
