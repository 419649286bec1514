"""The report page in a real browser: six smoke checks by day, the rest with ``-m nightly``."""

import fnmatch
import io
import re

import numpy as np
import pytest
from PIL import Image

from sandbox.elements.arrays import LATE
from sandbox.figure.style import shown_as
from sandbox.recording.recording import Recording
from sandbox.web.page import CONSTANTS, FoundOut, report, text_of
from tests.browser.conftest import PHONE, STAGE, body_at, until
from tests.draw.conftest import hand, zoo
from tests.draw.conftest import recording as made_up
from tests.web.test_page import EVIL

nightly = pytest.mark.nightly
TITLES = ".plot figcaption span"


@pytest.fixture(scope="module")
def run():
    return hand()


@pytest.fixture(scope="module")
def page(run):
    return report([run], plots=["finger1.mcp.angle", "tree.tendon.tension"])


def changed_run(run, arrays=(), **changes):
    """The run with other fields of its scene and other arrays."""
    data = run.mechanism.model_dump(mode="json", by_alias=True)
    data |= {key: {**(data["view"] or {}), **value} if key == "view" else value
             for key, value in changes.items()}
    mechanism = type(run.mechanism).model_validate(data)
    return Recording(mechanism, {**run.arrays, **dict(arrays)}, run.info)


def with_meters(run, *meters, **changes):
    return changed_run(run, **changes, meters=[
        {"name": name, "value": value, "unit": unit} for name, value, unit in meters])


def pixels(tab):
    shot = tab.locator(".sheet canvas").first.screenshot()
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), int)


def changed(one, other):
    return int((np.abs(one - other).max(axis=2) > 40).sum())


def poses(tab, stage=STAGE):
    return np.array(tab.evaluate(
        f"[...{stage}.pose].slice(0, 3 * {stage}.head.bodies.length)")).reshape(-1, 3)


def truth(run, t):
    """Poses by straight lines between samples."""
    flat = run.arrays["body_pose"].reshape(len(run), -1)
    return np.array([np.interp(t, run.time, column) for column in flat.T]).reshape(-1, 3)


def test_it_opens_at_the_start_with_play_in_view_or_where_the_address_says(opened, run):
    mechanism = run.mechanism.model_copy(update={"about": "A long text. " * 100})
    text = report([Recording(mechanism, run.arrays, run.info)])
    tab = opened(text, viewport={"width": 1280, "height": 720})
    assert tab.evaluate("sandbox.t") == 0  # as films
    box = tab.locator("#play").bounding_box()
    assert box["y"] + box["height"] <= 720
    assert tab.locator("h1").inner_text() == "Adaptive grasp of four sections"
    assert tab.locator(".loading").count() == 0
    tab.evaluate("sandbox.hold(0.5)")
    until(tab, "location.hash === '#t=0.5'")
    assert opened(text, at="#t=1.25").evaluate("sandbox.t") == pytest.approx(1.25)


def test_scrubbing_shows_the_poses_of_the_recording(opened, page, run):
    tab = opened(page)
    step = np.ptp(run.arrays["body_pose"], axis=0).max() / 65534
    drawn = pixels(tab)
    for t in (float(run.time[77]), 0.5 * float(run.time[40] + run.time[41]), 0.9):
        tab.locator("#scrub").fill(str(t))
        assert np.abs(poses(tab) - truth(run, t)).max() <= step
    shown = pixels(tab)
    assert changed(shown, drawn) > 500
    tab.locator("[data-layer=bodies]").uncheck()
    assert changed(pixels(tab), shown) > 500
    low, high = float(run.time[0]), float(run.time[-1])
    over, line = (tab.locator(name).first.bounding_box() for name in (".u-over", ".now"))
    assert line["x"] == pytest.approx(
        over["x"] + (0.9 - low) / (high - low) * over["width"], abs=0.02 * over["width"])
    tab.locator(".u-over").first.click(position={"x": 0.25 * over["width"], "y": 30})
    assert tab.evaluate("sandbox.t") == pytest.approx(low + 0.25 * (high - low), abs=0.1)
    near = int(np.abs(run.time - tab.evaluate("sandbox.t")).argmin())
    assert float(tab.locator(".plot output b").first.inner_text()) == pytest.approx(
        np.degrees(run["finger1.mcp.angle"][near]), rel=2e-3)


def test_play_speed_loop_and_keys(opened, run):
    tab = opened(report([changed_run(run, view={"speed": 0.5})]), clock=True)
    tab.evaluate("sandbox.hold(0.1)")
    tab.click("#play")
    tab.clock.run_for(800)
    assert tab.evaluate("sandbox.t") == pytest.approx(0.5, abs=0.05)  # three frames of a sixtieth
    tab.keyboard.press("]")
    tab.clock.run_for(400)
    moved = tab.evaluate("sandbox.t")
    assert moved == pytest.approx(0.9, abs=0.1)
    tab.keyboard.press("Space")
    tab.clock.run_for(300)
    assert tab.evaluate("sandbox.t") == moved
    tab.evaluate("sandbox.hold(1.9)")
    tab.click("#play")
    tab.clock.run_for(300)
    assert tab.evaluate("sandbox.playing && sandbox.t < 0.3")
    tab.keyboard.press("l")
    tab.clock.run_for(2500)
    assert tab.evaluate("!sandbox.playing && sandbox.t === sandbox.last")
    tab.keyboard.press("Shift+ArrowLeft")
    tab.keyboard.press("ArrowRight")
    assert tab.evaluate("sandbox.t") == pytest.approx(
        float(run.time[-1]) - 9 / run.info.sample_rate)
    tab.keyboard.press("?")
    assert "loop" in tab.locator("dialog.help").inner_text()
    assert "n, p" not in tab.locator("dialog.help").inner_text()  # there are no marks


def test_the_pointer_tells_opens_plots_zooms_and_moves(opened, page):
    tab = opened(page, at="#t=0.4")
    x, y = body_at(tab, "finger2.proximal", 0.02, 0.002)
    tab.mouse.move(x, y)
    assert tab.locator(".tip").inner_text().split("\n")[0] == "finger2.proximal"
    assert re.search(r'contact.normal [0-9.]+ N', tab.locator(".tip").inner_text())
    scale = tab.evaluate(f"{STAGE}.scale")
    tab.mouse.wheel(0, -300)
    until(tab, f"{STAGE}.scale > 1.5 * {scale}")
    assert body_at(tab, "finger2.proximal", 0.02, 0.002) == pytest.approx((x, y), abs=1.5)
    tab.mouse.down()
    tab.mouse.move(x + 60, y + 25, steps=4)
    tab.mouse.up()
    assert body_at(tab, "finger2.proximal", 0.02, 0.002) == pytest.approx((x + 60, y + 25), abs=3)
    tab.get_by_label("follow").select_option("finger2.distal")
    before = body_at(tab, "finger2.distal")
    tab.evaluate("sandbox.hold(0.9)")
    assert body_at(tab, "finger2.distal") == pytest.approx(before, abs=0.5)
    tab.evaluate("sandbox.hold(0.4)")
    tab.get_by_label("follow").select_option("-1")
    tab.keyboard.press("0")
    assert tab.evaluate(f"{STAGE}.scale") == pytest.approx(scale)
    tab.mouse.click(*body_at(tab, "finger2.proximal", 0.02, 0.002))
    count = tab.locator(".plot").count()
    assert count > 2
    box = tab.locator("#add")
    box.fill("finger2.*.angle")
    box.press("Enter")
    assert tab.locator(".plot").count() == count + 1
    tab.locator(".plot .close").last.click()
    assert tab.locator(".plot").count() == count
    box.fill("finger*.angle")  # more than a plot of eight curves can show
    box.press("Enter")
    curves = tab.evaluate("sandbox.plots.flatMap((p) => p.key.split(' '))")
    angles = fnmatch.filter(tab.evaluate("[...sandbox.runs[0].keys()]"), "finger*.angle")
    assert len(angles) > 8
    assert set(angles) <= set(curves)
    box.fill("finger2.mcp.angel")
    box.press("Enter")
    assert "did you mean finger2.mcp.angle?" in tab.locator(".said").inner_text()


def taken(tab):
    """The size of the picture that is saved."""
    with tab.expect_download() as saved:
        tab.get_by_role("button", name="picture").click()
    with Image.open(saved.value.path()) as picture:
        assert len(picture.convert("RGB").getcolors(1 << 20)) > 50
        return picture.size


def test_two_runs_lie_side_by_side_or_over_each_other(opened, run):
    slow = changed_run(run, {"time": 2 * run.time},
                       view={"show": ["-contacts", "-tensions", "-springs", "-drives"]})
    tab = opened(report([run, slow], plots=["finger1.mcp.angle"]))
    tab.evaluate("sandbox.hold(0.8)")
    assert np.abs(poses(tab, "sandbox.stages[1]") - truth(run, 0.4)).max() < 1e-4
    assert len(set(tab.evaluate("sandbox.stages.map((s) => s.foot)"))) == 1
    legend = "sandbox.stages[0].rows.flat().map(({ after }) => after)"
    assert {"1 N contact force", "15 N", "cut short", "stop", "drive, not to scale"} < set(
        tab.evaluate(legend))
    wide, high = taken(tab)
    tab.get_by_role("button", name="over each other").click()
    assert tab.locator(".sheet canvas:visible").count() == 1
    assert tab.locator(".sheet h2").count() == 2
    one = tab.evaluate("sandbox.stages[0].canvas.clientWidth")
    assert (taken(tab)[0], wide) == pytest.approx((one, one), abs=2)
    assert high < taken(tab)[1]
    assert tab.locator(".plot figcaption output b").count() == 2


def test_one_of_every_kind_is_drawn_and_hostile_names_stay_text(opened):
    run = with_meters(zoo(), ("sum", "=crank.x", EVIL), title=EVIL, about=EVIL)
    tab = opened(report([run], [FoundOut(source=EVIL)], plots=["sum"]))
    for box in tab.locator("[data-layer]").all():
        box.check()
    for t in (0.1, 0.4, 0.9):
        tab.locator("#scrub").fill(str(t))
    assert tab.evaluate("window.pwned") is None
    assert tab.locator("h1").inner_text().startswith("</script>")
    assert (tab.locator("img").count(), tab.locator("script").count()) == (0, 3)
    assert tab.evaluate("""() => new Promise((done) => {
        const s = document.createElement('script'); s.textContent = 'window.put = 1';
        document.body.append(s); setTimeout(() => done(window.put === undefined), 30); })""")
    assert "Content Security Policy" in tab.faults.pop()


def test_a_phone_in_the_dark_shows_verdict_and_picture_before_what_is_folded(opened):
    name = "long.name.of.what.is.expected"
    tab = opened(report([with_meters(hand(), (name, "=t", "N"), expect=[
        {"final": name, "below": 1e-3, "because": "it is so"}])]), **PHONE)
    # of innerWidth no test can tell: it grows with what is too wide
    assert tab.evaluate("document.documentElement.scrollWidth <= screen.width")
    assert tab.locator(".verdict.bad").inner_text() == "0 of 1 expectations passed"
    for word in ("FAIL", "0 to 0.001", "at most 0.001"):
        for cell in tab.locator(f"td:has-text('{word}')").all():
            box = cell.bounding_box()
            assert box["x"] + box["width"] <= 390
    assert not tab.locator(".layers").is_visible()
    tab.get_by_text("layers", exact=True).click()
    assert tab.locator("[data-layer=bodies]").is_visible()
    assert np.median(pixels(tab)) < 60
    tab.emulate_media(color_scheme="light")
    assert np.median(pixels(tab)) > 200


@nightly
def test_a_pattern_fits_what_it_fits_in_python(browser, run):
    names = [*run.names(), *run.match("section*/finger*.normal")]
    swapped = [re.sub(r"(.*)/(.*)\.(\w+)", r"\2/\1.\3", name) for name in names]
    tab = browser.new_page()
    for pattern in (
            "finger2.*.angle", "finger?.mcp.angle", "finger[13].mcp.angle", "finger[!13].mcp.angle",
            "finger[2-3].mcp.angle", "finger[3-2].mcp.angle", "finger[]1].mcp.angle", "finger[1",
            "*/section*.normal", "section1*/finger*.normal", "*.normal", "Finger*", "*.m[c-d]p.*",
            "finger1.mcp.angle", "*", "f*.(x)", "[^f]inger1*", "[", "*[!e]"):
        found = tab.evaluate(f"([p, names]) => {{ {CONSTANTS} {text_of('data.js')}; "
                             "return matching(p, names); }", [pattern, names])
        known = set(run.match(pattern))
        assert found == [name for name, other in zip(names, swapped, strict=True)
                         if name in known or other in known], pattern
    tab.close()


@nightly
def test_a_page_opens_with_the_meters_of_the_scene(opened, run):
    metered = changed_run(run, view={"meters": [
        {"of": ["finger1.mcp.angle", "finger2.mcp.angle"], "title": "two hinges", "range": [-1, 3]},
        {"of": "=tree.tendon.tension / 2", "unit": "N", "style": "number", "title": "half"}]})
    tab = opened(report([metered]), at="#t=0.9")
    assert tab.locator(TITLES).all_inner_texts()[:2] == ["two hinges [deg]", "half [N]"]
    assert tab.evaluate("[sandbox.plots[0].u.scales.y.min, sandbox.plots[0].u.scales.y.max]") == (
        pytest.approx(np.degrees([-1, 3])))
    assert not tab.locator(".plot .uplot").nth(1).is_visible()
    told = float(tab.locator(".plot").nth(1).locator("output b").inner_text())
    assert told == pytest.approx(
        float(np.interp(0.9, run.time, run["tree.tendon.tension"])) / 2, rel=0.02)
    asked = opened(report([metered], plots=["finger3.mcp.angle"]))
    assert asked.locator(TITLES).all_inner_texts() == ["finger3.mcp.angle [deg]"]


@nightly
def test_a_film_is_recorded(opened, page):
    tab = opened(page)
    tab.locator("#speed").select_option("0.1")
    with tab.expect_download() as saved:
        tab.get_by_role("button", name="film").click()
        until(tab, "sandbox.filming && sandbox.t > 0.03")
        tab.get_by_role("button", name="stop the film").click()
    assert saved.value.suggested_filename.startswith("hand.")
    assert saved.value.path().stat().st_size > 1000


@nightly
def test_runs_that_lack_something_are_drawn_without_it(opened):
    """Arrays of an older run, a single sample, no motion, what is no number."""
    run = zoo()
    less = {name: array for name, array in run.arrays.items() if name not in LATE}
    body = next(body for body in run.mechanism.model_dump(mode="json", by_alias=True)["bodies"]
                if body["motion"] == "fixed")
    still = type(run.mechanism).model_validate({"name": "still", "bodies": [body]})
    pose, force = run.arrays["body_pose"].copy(), np.full_like(run.arrays["tendon_tension"], 1e30)
    pose[30:] = np.nan
    for one in (Recording(run.mechanism, less, run.info), run.part(0, 1),
                made_up(still, run.time, np.zeros((len(run), 1, 3))),
                changed_run(run, {"body_pose": pose, "tendon_tension": force})):
        tab = opened(report([one]))
        for share in (0.1, 0.5, 0.59, 0.99):
            tab.evaluate("(w) => sandbox.hold(w * sandbox.last)", share)


@nightly
def test_a_quantity_has_the_unit_that_figures_and_films_give_it(browser):
    tab = browser.new_page()
    for unit in ("1", "rad", "rad/s", "rad/s^2", "m", "m/s", "N", "N m", "N/m", "Pa", "J", "m^3/s",
                 "C"):
        for most in (0.0, 1e-7, 0.499, 0.5, 12.0):
            found = tab.evaluate(f"([unit, most]) => {{ {CONSTANTS} {text_of('data.js')} "
                                 "return shownAs(unit, most); }", [unit, most])
            shown = shown_as(unit, np.array([most, -most / 2]))
            assert found == {"factor": pytest.approx(shown.factor), "unit": shown.unit,
                             "sign": shown.sign}
    tab.close()
