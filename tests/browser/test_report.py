"""The page of a report in a browser: it moves, tells and lets nothing in."""

import io
import re

import numpy as np
import pytest
from PIL import Image

from sandbox.kinds.arrays import LATE
from sandbox.recording.recording import Recording
from sandbox.show.header import FoundOut
from sandbox.show.page import report
from sandbox.show.web_files import text_of
from tests.draw.conftest import hand, zoo
from tests.draw.conftest import recording as made_up
from tests.draw.test_unions import box_on_floor
from tests.show.test_page import EVIL

STAGE = "sandbox.stages[0]"


@pytest.fixture(scope="module")
def run():
    return hand()


@pytest.fixture(scope="module")
def page(run):
    return report([run], plots=["finger1.mcp.angle", "tree.actuator.tension"])


def pixels(tab):
    shot = tab.locator(".sheet canvas").first.screenshot()
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), int)


def changed(one, other):
    return int((np.abs(one - other).max(axis=2) > 40).sum())


def poses(tab):
    return np.array(tab.evaluate(f"[...{STAGE}.pose]")).reshape(-1, 3)


def truth(run, t):
    """Poses by straight lines between samples."""
    flat = run.arrays["body_pose"].reshape(len(run), -1)
    return np.array([np.interp(t, run.time, column) for column in flat.T]).reshape(-1, 3)


def body_at(tab, name, x, y):
    """Where a point of a body is on the screen."""
    box = tab.locator(".sheet canvas").first.bounding_box()
    px, py = tab.evaluate(
        f"([n, x, y]) => {STAGE}.at([{STAGE}.head.bodies.findIndex((b) => b.name === n), x, y])",
        [name, x, y])
    return box["x"] + px, box["y"] + py


def until(tab, expression):
    """Waits; playwright's own way of it needs what the page's policy forbids."""
    for _ in range(400):
        if tab.evaluate(expression):
            return
        tab.wait_for_timeout(25)
    raise AssertionError(f"never: {expression}")


def seek(tab, t):
    tab.locator("#scrub").fill(str(t))


def test_it_opens_without_a_fault_and_asks_for_nothing_else(opened, page):
    tab = opened(page)
    assert tab.faults == []
    assert tab.locator("h1").inner_text() == "Adaptive grasp of four sections"
    assert tab.locator(".plot").count() == 2


@pytest.mark.parametrize("about", ["", "A long text. " * 100])
def test_it_opens_at_the_start_with_play_in_view(opened, run, about):
    mechanism = run.mechanism.model_copy(update={"about": about})
    tab = opened(report([Recording(mechanism, run.arrays, run.info)]),
                 viewport={"width": 1280, "height": 720})
    assert tab.evaluate("sandbox.t") == pytest.approx(float(run.time[0]))
    box = tab.locator("#play").bounding_box()
    assert box["y"] + box["height"] <= 720


def test_scrubbing_moves_bodies_pixels_and_the_plots_cursor(opened, page, run):
    tab = opened(page)
    seek(tab, 0.2)
    before, drawn = poses(tab), pixels(tab)
    seek(tab, 0.9)
    assert np.abs(poses(tab) - before).max() > 0.1
    assert changed(pixels(tab), drawn) > 500
    assert tab.evaluate("sandbox.t") == pytest.approx(0.9, abs=1e-9)
    over, line = (tab.locator(name).first.bounding_box() for name in (".u-over", ".now"))
    low, high = float(run.time[0]), float(run.time[-1])
    share = (0.9 - low) / (high - low)
    assert line["x"] == pytest.approx(over["x"] + share * over["width"], abs=0.02 * over["width"])
    assert np.abs(poses(tab) - truth(run, 0.9)).max() < 1e-4  # half a step of 16 bits, twice


def test_poses_are_the_recordings_at_samples_and_between(opened, page, run):
    tab = opened(page)
    for t in (float(run.time[0]), float(run.time[77]), 0.5 * float(run.time[40] + run.time[41]),
              float(run.time[-1])):
        tab.evaluate("(t) => sandbox.hold(t)", t)
        step = np.ptp(run.arrays["body_pose"], axis=0).max() / 65534
        assert np.abs(poses(tab) - truth(run, t)).max() <= step


def test_play_moves_at_the_speed_that_is_set(opened, page):
    tab = opened(page, clock=True)
    tab.evaluate("sandbox.hold(0.1)")
    tab.click("#play")
    tab.clock.run_for(500)
    moved = tab.evaluate("sandbox.t")
    assert moved == pytest.approx(0.6, abs=0.05)  # three frames of a sixtieth
    tab.keyboard.press("[")
    tab.clock.run_for(400)
    assert tab.evaluate("sandbox.t") == pytest.approx(moved + 0.2, abs=0.05)
    tab.click("#play")
    still = tab.evaluate("sandbox.t")
    tab.clock.run_for(300)
    assert tab.evaluate("sandbox.t") == still


def test_it_begins_again_at_the_end_or_stays_there(opened, page, run):
    tab = opened(page, clock=True)
    tab.evaluate("sandbox.hold(1.9)")
    tab.click("#play")
    tab.clock.run_for(300)
    assert tab.evaluate("sandbox.playing")
    assert tab.evaluate("sandbox.t") < 0.3
    tab.keyboard.press("l")
    tab.clock.run_for(2500)
    assert not tab.evaluate("sandbox.playing")
    assert tab.evaluate("sandbox.t") == pytest.approx(float(run.time[-1]), abs=1e-6)


def test_keys_step_by_samples_and_go_to_the_ends(opened, page, run):
    tab = opened(page)
    tab.evaluate("sandbox.hold(1.0)")
    step = 1 / run.info.sample_rate
    tab.keyboard.press("ArrowRight")
    assert tab.evaluate("sandbox.t") == pytest.approx(1.0 + step)
    tab.keyboard.press("Shift+ArrowLeft")
    assert tab.evaluate("sandbox.t") == pytest.approx(1.0 - 9 * step)
    tab.keyboard.press("Home")
    assert tab.evaluate("sandbox.t") == pytest.approx(float(run.time[0]), abs=1e-6)
    tab.keyboard.press("?")
    assert tab.locator("dialog.help").is_visible()


def test_a_click_in_a_plot_goes_to_its_time(opened, page, run):
    tab = opened(page)
    over = tab.locator(".u-over").first
    box = over.bounding_box()
    over.click(position={"x": 0.25 * box["width"], "y": 30})
    low, high = float(run.time[0]), float(run.time[-1])
    assert tab.evaluate("sandbox.t") == pytest.approx(low + 0.25 * (high - low), abs=0.1)


def test_layers_hide_what_they_name(opened, page):
    tab = opened(page, at="#t=1.5")
    drawn = pixels(tab)
    for layer in ("contacts", "tendons", "springs", "bodies"):
        tab.locator(f"[data-layer={layer}]").uncheck()
        less = pixels(tab)
        assert changed(less, drawn) > 50, layer
        drawn = less
    tab.locator("[data-layer=coordinates]").check()
    assert changed(pixels(tab), drawn) > 200


def test_pointing_tells_and_a_click_opens_a_plot(opened, page):
    tab = opened(page, at="#t=0.4")
    tab.mouse.move(*body_at(tab, "finger2.proximal", 0.02, 0.002))
    assert tab.locator(".tip").inner_text().split("\n")[0] == "finger2.proximal"
    assert "contact.normal 0 N" in tab.locator(".tip").inner_text()
    count = tab.locator(".plot").count()
    tab.mouse.down()
    tab.mouse.up()
    assert tab.locator(".plot").count() > count
    tab.locator(".plot .close").last.click()
    assert tab.locator(".plot").count() < count + 2


def test_an_arrow_of_a_contact_opens_the_forces_of_its_pair(opened, page):
    tab = opened(page, at="#t=1.8")
    hit = tab.evaluate(f"""() => {{ const h = {STAGE}.hits.find((one) => one.part.k === 'contact');
        return [h.part.n, (h.pts[0][0] + h.pts[1][0]) / 2, (h.pts[0][1] + h.pts[1][1]) / 2]; }}""")
    box = tab.locator(".sheet canvas").first.bounding_box()
    tab.mouse.click(box["x"] + hit[1], box["y"] + hit[2])
    pair = set(hit[0].split("/"))
    title = tab.locator(".plot figcaption span").last.inner_text()
    assert set(title.split(".normal")[0].split("/")) == pair
    # a force between an object and another acts on the object
    assert hit[0].split("/")[0].startswith("section")


def test_the_wheel_zooms_where_the_pointer_is_and_a_drag_moves(opened, page):
    tab = opened(page, at="#t=0.4")
    x, y = body_at(tab, "finger2.proximal", 0.02, 0.0)
    tab.mouse.move(x, y)
    scale = tab.evaluate(f"{STAGE}.scale")
    tab.mouse.wheel(0, -300)
    until(tab, f"{STAGE}.scale > 1.5 * {scale}")
    assert body_at(tab, "finger2.proximal", 0.02, 0.0) == pytest.approx((x, y), abs=1.5)
    tab.mouse.down()
    tab.mouse.move(x + 60, y + 25, steps=4)
    tab.mouse.up()
    assert body_at(tab, "finger2.proximal", 0.02, 0.0) == pytest.approx((x + 60, y + 25), abs=3)
    tab.keyboard.press("0")
    assert tab.evaluate(f"{STAGE}.scale") == pytest.approx(scale)


def test_names_of_fingers_stand_apart_beside_their_hinges_and_leave_the_picture_as_it_is(
        opened, page, run):
    tab = opened(page, at="#t=0.8")
    tab.evaluate(f"{STAGE}.names = null; sandbox.hold(0.8)")
    assert np.abs(poses(tab) - truth(run, 0.8)).max() < 1e-4  # others were looked at meanwhile
    look = f"{STAGE}.names.all.map((one) => [...{STAGE}.at(one.at), ...one.away, ...one.half])"
    names = np.array(tab.evaluate(look))
    assert len(names) == 4
    size = tab.evaluate(f"[{STAGE}.w, {STAGE}.h - {STAGE}.foot]")
    middle = names[:, :2] + names[:, 2:4]
    low, high = middle - names[:, 4:], middle + names[:, 4:]
    assert (low >= 0).all()
    assert (high <= size).all()
    for i in range(4):
        for j in range(i):
            assert (low[i] >= high[j]).any() or (low[j] >= high[i]).any()
    away = names[:, 2:4].copy()
    tab.evaluate("sandbox.hold(0.3)")
    assert np.array_equal(np.array(tab.evaluate(look))[:, 2:4], away)  # they ride, and do not jump


def test_forces_along_a_flat_side_are_drawn_out_of_the_body(opened):
    tab = opened(report([box_on_floor(0.0)]))
    assert tab.evaluate("sandbox.replays[0].frame(0).patches.length") == 1
    drawn = pixels(tab)
    tab.locator("[data-layer=pressure]").check()
    more = pixels(tab)
    assert changed(more, drawn) > 200
    rows = np.flatnonzero((np.abs(more - drawn).max(axis=2) > 40).any(axis=1))
    box = tab.locator(".sheet canvas").first.bounding_box()
    ground = body_at(tab, tab.evaluate(f"{STAGE}.head.bodies[1].name"), 0.0, 0.0)[1] - box["y"]
    assert rows.min() > ground - 60
    assert rows.max() > ground + 5
    assert tab.faults == []


@pytest.mark.parametrize(("value", "told"), [
    ("=1e-16 * sin(9 * t)", ["-1", "0", "1"]), ("=10 + 1e-8 * sin(9 * t)", ["0", "5", "10"]),
    ("=10 + 1e-5 * sin(9 * t)", ["9.99999", "10", "10.00001"])])
def test_ticks_differ_and_what_rounding_leaves_is_flat(opened, value, told):
    run = zoo()
    data = run.mechanism.model_dump(mode="json", by_alias=True)
    data["meters"] = [{"name": "one", "value": value, "unit": "C"}]
    mechanism = type(run.mechanism).model_validate(data)
    tab = opened(report([Recording(mechanism, run.arrays, run.info)], plots=["one"]))
    assert tab.evaluate("sandbox.plots[0].u.axes[1]._values") == told
    assert tab.faults == []


def test_times_of_plots_lie_below_each_other_and_words_at_curves_get_room(opened, page):
    tab = opened(page)
    widths = "sandbox.plots.map((one) => one.u.over.clientWidth)"
    alone = tab.evaluate(widths)
    tab.locator("#add").fill("finger?.mcp.angle")
    tab.locator("#add").press("Enter")
    until(tab, "sandbox.plots.length === 3")
    together = tab.evaluate(widths)
    assert len(set(alone)) == len(set(together)) == 1
    assert together[0] < alone[0] - 20
    tab.locator(".plot .close").last.click()
    assert tab.evaluate(widths) == alone


def test_the_camera_follows_a_body(opened, page):
    tab = opened(page, at="#t=0.2")
    tab.get_by_label("follow").select_option("finger1.distal")
    centre = tab.evaluate(
        f"{STAGE}.head.bodies.find((body) => body.name === 'finger1.distal').centre")
    before = body_at(tab, "finger1.distal", *centre)
    seek(tab, 1.0)
    assert body_at(tab, "finger1.distal", *centre) == pytest.approx(before, abs=0.5)


def test_a_quantity_is_plotted_by_name_or_pattern_and_a_wrong_one_is_told(opened, page):
    tab = opened(page)
    box = tab.locator("#add")
    box.fill("finger2.*.angle")
    box.press("Enter")
    assert tab.locator(".plot").count() == 3
    box.fill("finger2.mcp.angel")
    box.press("Enter")
    assert "did you mean finger2.mcp.angle?" in tab.locator(".said").inner_text()


PATTERNS = ["finger2.*.angle", "finger?.mcp.angle", "finger[13].mcp.angle", "finger[!13].mcp.angle",
            "finger[2-3].mcp.angle", "finger[3-2].mcp.angle", "finger[]1].mcp.angle", "finger[1",
            "*/section*.normal", "section1*/finger*.normal", "*.normal", "Finger*", "*.m[c-d]p.*",
            "finger1.mcp.angle", "*", "f*.(x)", "[^f]inger1*", "[", "*[!e]"]


@pytest.mark.parametrize("pattern", PATTERNS)
def test_a_pattern_fits_what_it_fits_in_python(opened, browser, run, pattern):
    names = [*run.names(), *run.match("section*/finger*.normal")]
    tab = browser.new_page()
    found = tab.evaluate(f"([p, names]) => {{ {text_of('names.js')}; return matching(p, names); }}",
                         [pattern, names])
    tab.close()
    swapped = [re.sub(r"(.*)/(.*)\.(\w+)", r"\2/\1.\3", name) for name in names]
    known = set(run.match(pattern))
    assert found == [name for name, other in zip(names, swapped, strict=True)
                     if name in known or other in known]


def test_a_page_opens_with_the_meters_of_the_scene(opened, run):
    view = {"meters": [
        {"of": ["finger1.mcp.angle", "finger2.mcp.angle"], "title": "two hinges", "range": [-1, 3]},
        {"of": "=tree.actuator.tension / 2", "unit": "N", "style": "number", "title": "half"}]}
    data = run.mechanism.model_dump(mode="json", by_alias=True)
    data["view"] = {**data["view"], **view}
    mechanism = type(run.mechanism).model_validate(data)
    metered = Recording(mechanism, run.arrays, run.info)
    tab = opened(report([metered]), at="#t=0.9")
    titles = tab.locator(".plot figcaption span").all_inner_texts()
    assert titles[:2] == ["two hinges [deg]", "half [N]"]
    assert tab.evaluate("[sandbox.plots[0].u.scales.y.min, sandbox.plots[0].u.scales.y.max]") == (
        pytest.approx(np.degrees([-1, 3])))
    assert not tab.locator(".plot .uplot").nth(1).is_visible()
    half = float(np.interp(0.9, run.time, run["tree.actuator.tension"])) / 2
    told = float(tab.locator(".plot").nth(1).locator("output b").inner_text())
    assert told == pytest.approx(half, rel=0.02)
    assert tab.faults == []
    asked = opened(report([metered], plots=["finger3.mcp.angle"]))
    assert asked.locator(".plot figcaption span").all_inner_texts() == ["finger3.mcp.angle [deg]"]


def test_what_is_told_beside_the_pointer_is_what_the_plot_says(opened, page, run):
    tab = opened(page)
    for t in (0.3004, 0.5 * float(run.time[40] + run.time[41]) - 1e-4, float(run.time[60])):
        tab.evaluate("(t) => sandbox.hold(t)", t)
        told = tab.evaluate("sandbox.series[0].at('finger1.mcp.angle', sandbox.t)")
        near = int(np.abs(run.time - t).argmin())
        assert told == pytest.approx(float(run["finger1.mcp.angle"][near]), abs=1e-6)
        shown = tab.locator(".plot").first.locator("output b").first.inner_text()
        assert float(shown) == pytest.approx(np.degrees(told), rel=1e-3)


def test_the_address_names_the_instant(opened, page):
    tab = opened(page, at="#t=1.25")
    assert tab.evaluate("sandbox.t") == pytest.approx(1.25)
    tab.evaluate("sandbox.hold(0.5)")
    until(tab, "location.hash === '#t=0.5'")


def taken(tab):
    """The size of the picture that is saved; it is not empty where a stage is."""
    with tab.expect_download() as saved:
        tab.get_by_role("button", name="picture").click()
    with Image.open(saved.value.path()) as picture:
        shown = tab.evaluate("""(() => {
            const boxes = sandbox.stages.map((s) => s.canvas.getBoundingClientRect());
            const first = sandbox.stages[0].canvas.parentElement.getBoundingClientRect();
            return boxes.filter((b) => b.width).map((b) => [b.left - first.left, b.top - first.top,
                b.right - first.left, b.bottom - first.top]);
        })()""")
        for box in shown:
            part = picture.convert("RGB").crop([round(v) for v in box])
            assert len(part.getcolors(1 << 20)) > 50
        return picture.size


def test_a_picture_is_saved(opened, page):
    tab = opened(page, at="#t=1.25")
    with tab.expect_download() as saved:
        tab.get_by_role("button", name="picture").click()
    assert saved.value.suggested_filename == "hand_1.250s.png"
    with Image.open(saved.value.path()) as picture:
        assert picture.size[0] > 400


def test_in_a_notebook_it_plays_in_a_frame_that_reaches_nothing(browser, run):
    tab = browser.new_page(viewport={"width": 1100, "height": 900})
    faults = []
    tab.on("console", lambda said: faults.append(said.text))
    tab.on("pageerror", lambda error: faults.append(str(error)))
    tab.set_content(f"<title>notebook</title>{run.page('finger1.mcp.angle')._repr_html_()}")
    frame = tab.frame_locator("iframe")
    frame.locator("html[data-ready]").wait_for(state="attached")
    assert frame.locator(".plot figcaption span").all_text_contents() == ["finger1.mcp.angle [deg]"]
    inside = tab.frames[1]
    before = inside.evaluate("sandbox.t")
    frame.locator(".sheet canvas").focus()
    tab.keyboard.press("End")
    assert inside.evaluate("sandbox.t") > before
    assert inside.evaluate("(() => { try { return parent.document.title } catch { return '' } })()"
                           ) == ""
    assert inside.evaluate("origin") == "null"
    assert faults == []
    tab.close()


def test_a_film_is_recorded(opened, page):
    tab = opened(page)
    tab.locator("select[aria-label=speed], .bar select").first.select_option("0.1")
    with tab.expect_download() as saved:
        tab.get_by_role("button", name="film").click()
        until(tab, "sandbox.filming && sandbox.t > 0.03")
        assert tab.evaluate("sandbox.filming.canvas.width") == pytest.approx(
            tab.evaluate("sandbox.sheets.clientWidth"), abs=2)
        tab.get_by_role("button", name="stop the film").click()
    assert saved.value.suggested_filename.startswith("hand.")
    assert saved.value.path().stat().st_size > 1000


def test_runs_lie_side_by_side_or_over_each_other(opened, run):
    slow = Recording(run.mechanism, {**run.arrays, "time": 2 * run.time}, run.info)
    tab = opened(report([run, slow], plots=["finger1.mcp.angle"]))
    assert tab.faults == []
    assert tab.locator("canvas:visible").count() == 2 + tab.locator(".u-wrap canvas").count()
    tab.evaluate("sandbox.hold(0.8)")
    assert np.abs(np.array(tab.evaluate("[...sandbox.stages[1].pose]")).reshape(-1, 3)
                  - truth(run, 0.4)).max() < 1e-4
    wide, high = taken(tab)
    tab.get_by_role("button", name="over each other").click()
    assert tab.locator(".sheet canvas:visible").count() == 1
    assert [h.split("  ")[0] for h in tab.locator(".sheet h2").all_text_contents()] == ["1", "2"]
    one = tab.evaluate("sandbox.stages[0].canvas.clientWidth")
    assert taken(tab)[0] == pytest.approx(one, abs=2)
    assert wide == pytest.approx(one, abs=2)  # both beside each other filled the same width
    assert high < taken(tab)[1]
    assert tab.locator(".plot figcaption output b").count() == 2
    assert tab.faults == []


@pytest.mark.parametrize("how", [{}, {"java_script_enabled": True, "color_scheme": "dark"}])
def test_hostile_names_stay_text(opened, how):
    run = zoo()
    data = run.mechanism.model_dump(mode="json", by_alias=True)
    data |= {"title": EVIL, "about": EVIL}
    data["meters"] = [{"name": "sum", "value": "=crank.x", "unit": EVIL}]
    mechanism = type(run.mechanism).model_validate(data)
    tab = opened(report([Recording(mechanism, run.arrays, run.info)],
                        [FoundOut(source=EVIL)], plots=["sum"]), **how)
    assert tab.evaluate("window.pwned") is None
    assert tab.locator("h1").inner_text().startswith("</script>")
    assert tab.locator("img").count() == 0
    assert tab.locator("script").count() == 3
    assert tab.faults == []


def test_until_it_is_ready_it_says_so_and_without_a_script_why_it_never_is(
        opened, browser, page, tmp_path):
    assert opened(page).locator(".loading").count() == 0
    path = tmp_path / "slow.html"
    path.write_text(page.replace("await report(", "await new Promise(() => {}); await report("),
                    encoding="utf-8")
    for on, told in ((True, "loading"), (False, "This page draws with a script, which is off.")):
        context = browser.new_context(java_script_enabled=on)
        tab = context.new_page()
        tab.goto(path.as_uri())  # a script of another hash does not run
        assert tab.locator("main").inner_text().strip().rstrip("\u2026") == told
        context.close()


def test_the_policy_stops_a_script_that_is_put_in(opened, page):
    tab = opened(page)
    assert tab.evaluate("""() => new Promise((done) => {
        const s = document.createElement('script'); s.textContent = 'window.put = 1';
        document.body.append(s); setTimeout(() => done(window.put === undefined), 30); })""")


def test_a_phone_scrolls_down_only(opened, page):
    tab = opened(page, viewport={"width": 390, "height": 844}, device_scale_factor=2,
                 is_mobile=True, has_touch=True)
    # of innerWidth no test can tell: it grows with what is too wide
    assert tab.evaluate("document.documentElement.scrollWidth <= screen.width")
    assert tab.faults == []


def test_the_page_is_dark_where_the_reader_wants_it(opened, page):
    tab = opened(page, at="#t=1.5", color_scheme="dark")
    drawn = pixels(tab)
    assert np.median(drawn) < 60
    tab.emulate_media(color_scheme="light")
    assert np.median(pixels(tab)) > 200
    assert tab.faults == []


def test_an_older_run_is_drawn_without_what_it_lacks(opened):
    run = zoo()
    less = {name: array for name, array in run.arrays.items() if name not in LATE}
    tab = opened(report([Recording(run.mechanism, less, run.info)]), at="#t=0.5")
    whole = opened(report([run]), at="#t=0.5")
    assert tab.faults == []
    assert np.array_equal(poses(tab), poses(whole))


def test_a_run_of_one_sample_and_one_where_nothing_moves_are_shown(opened):
    run = zoo()
    assert opened(report([run.part(0, 1)])).faults == []
    still = run.mechanism.model_dump(mode="json", by_alias=True)
    still = {"name": "still", "bodies": [body for body in still["bodies"]
                                         if body["motion"] == "fixed"][:1]}
    mechanism = type(run.mechanism).model_validate(still)
    made = made_up(mechanism, run.time, np.zeros((len(run), 1, 3)))
    assert opened(report([made])).faults == []


def test_what_is_no_number_is_drawn_as_nothing(opened):
    run = zoo()
    pose, force = run.arrays["body_pose"].copy(), np.full_like(run.arrays["tendon_tension"], 1e30)
    pose[30:] = np.nan
    wild = Recording(run.mechanism, {**run.arrays, "body_pose": pose, "tendon_tension": force},
                     run.info)
    tab = opened(report([wild]))
    for t in (0.1, 0.5, 0.59, 0.99):
        seek(tab, t)
    assert tab.faults == []


def test_one_of_every_kind_is_drawn(opened):
    tab = opened(report([zoo()]), at="#t=0.5")
    for layer in ("velocity", "axes", "body_names", "coordinates"):
        tab.locator(f"[data-layer={layer}]").check()
    for t in (0.1, 0.4, 0.9):
        seek(tab, t)
    assert tab.faults == []
