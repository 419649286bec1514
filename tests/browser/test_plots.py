"""Plots of a page: what they are called, in which units and sizes, what a phone shows of them."""

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from sandbox.audit.figures import Figure
from sandbox.draw.figure.strands import strands
from sandbox.draw.figure.style import shown_as
from sandbox.recording.recording import Recording
from sandbox.show.header import FoundOut
from sandbox.show.page import report
from sandbox.show.sizes import declared
from sandbox.show.web_files import text_of
from tests.draw.conftest import hand, zoo

PHONE = {"viewport": {"width": 390, "height": 844}, "is_mobile": True, "has_touch": True}
TITLES = ".plot figcaption span"


def with_meters(run, *meters, **more):
    data = run.mechanism.model_dump(mode="json", by_alias=True)
    data["meters"] = [{"name": name, "value": value, "unit": unit} for name, value, unit in meters]
    mechanism = type(run.mechanism).model_validate({**data, **more})
    return Recording(mechanism, run.arrays, run.info)


@pytest.fixture(scope="module")
def many():
    """A page with a plot of eight curves, and one of two runs."""
    run = with_meters(hand(), *((f"part{k}.with.a.name.as.long.as.some.are", f"={k} * t", "N")
                                for k in range(1, 9)))
    return report([run], plots=[f"part{k}.with.a.name.as.long.as.some.are" for k in range(1, 9)])


def test_a_plot_of_several_is_called_as_they_are_whatever_their_unit(opened):
    run = with_meters(zoo(), ("a.torque", "=t", "N m"), ("b.torque", "=2 * t", "N m"))
    tab = opened(report([run], plots=["a.torque", "b.torque"]))
    assert tab.locator(TITLES).all_inner_texts() == ["torque [N m]"]


@pytest.mark.parametrize("unit", [
    "1", "rad", "rad/s", "rad/s^2", "m", "m/s", "N", "N m", "N/m", "Pa", "J", "m^3/s", "C"])
@pytest.mark.parametrize("most", [0.0, 1e-7, 0.499, 0.5, 12.0])
def test_a_quantity_has_the_unit_that_figures_and_films_give_it(opened, browser, unit, most):
    tab = browser.new_page()
    found = tab.evaluate(f"([unit, most]) => {{ {declared()} {text_of('units.js')} "
                         "return shownAs(unit, most); }", [unit, most])
    tab.close()
    shown = shown_as(unit, np.array([most, -most / 2]))
    assert found == {"factor": pytest.approx(shown.factor), "unit": shown.unit,
                     "sign": shown.sign}


def test_what_is_read_off_a_plot_is_shown_as_figures_show_it(opened):
    """Its axis, its value and its bands, and what stands beside the pointer; what is sent is SI."""
    run = with_meters(hand(), ("turn", "=0.1 * t", "rad"), ("way", "=0.01 * t", "m"), expect=[
        {"final": "turn", "below": 0.1, "over": [0.5, 1.0]}])
    tab = opened(report([run], plots=["turn", "way"]), at="#t=1")
    assert tab.locator(TITLES).all_inner_texts() == ["turn [deg]", "way [mm]"]
    told = [float(text) for text in tab.locator(".plot output b").all_inner_texts()]
    assert told == pytest.approx([0.1 * 180 / np.pi, 10], rel=2e-3)
    assert tab.evaluate("sandbox.plots[0].u.scales.y.max") > 5
    assert tab.evaluate("sandbox.series[0].told('turn', 1)").endswith("\u00b0")
    assert tab.evaluate("sandbox.series[0].told('way', 1)") == "10 mm"


def test_curves_that_would_lie_flat_beside_others_have_plots_of_their_own(opened):
    run = with_meters(zoo(), *((f"{name}.size", value, "N") for name, value in (
        ("large", "=1e4 * t"), ("none", "=0 * t"), ("small", "=t"), ("half", "=0.5 * t"))))
    tab = opened(report([run], plots=[f"{name}.size" for name in (
        "small", "large", "none", "half")]))
    assert tab.evaluate("sandbox.plots.map((one) => one.key)") == [
        "large.size none.size", "small.size half.size"]


def test_curves_that_coincide_are_taken_apart_as_figures_do_it(opened, browser):
    random, x = np.random.default_rng(5), np.linspace(0.0, 1.0, 300)
    tab = browser.new_page()
    for _ in range(20):
        base = np.cumsum(random.normal(0.0, 0.01, (2, 300)), axis=1)
        parted = np.cumsum(random.random((3, 300)) < 0.01, axis=1) % 2
        lines = [*base, *(np.where(part, *base) for part in parted)]
        found = tab.evaluate(f"([x, lines]) => {{ {declared()} {text_of('strands.js')} "
                             "return strands(x, lines); }", [x.tolist(), np.array(lines).tolist()])
        told = [[(one["first"], one["rank"], one["turns"]) for one in line] for line in found]
        assert told == [[(one.first, one.rank, one.turns) for one in line]
                        for line in strands([(x, line) for line in lines])]
        assert [[one["last"] + 1 for one in line[:-1]] for line in found] == [
            [one["first"] for one in line[1:]] for line in found]
    assert tab.evaluate(f"() => {{ {declared()} {text_of('strands.js')} "
                        "return filled([null, 1, null, null, 4, NaN], [0, 1, 2, 3, 4, 5], "
                        "[0, 1, 2, 3, 4, 5]).map((v) => (Number.isNaN(v) ? null : v)); }") == [
        None, 1, 2, 3, 4, None]
    tab.close()


@pytest.mark.parametrize("other", ["=t", "=min(t, 0.5)"])
def test_of_curves_that_coincide_each_is_seen(opened, other):
    run = with_meters(hand(), ("one.f", "=t", "N"), ("two.f", other, "N"))
    tab = opened(report([run], plots=["one.f", "two.f"]))
    shot = np.asarray(Image.open(io.BytesIO(tab.locator(".plot canvas").screenshot())), int)
    left = shot[:, 60:shot.shape[1] // 2 - 60, :3]  # without the words where curves end
    blue, orange = (left @ axis > 60 for axis in ((-1, 0, 1), (1, 0, -1)))
    assert 0.5 < blue.sum() / orange.sum() < 2


def test_dashed_curves_stay_dashed_where_they_coincide(opened):
    """Of two runs the ink is the run, the dash the quantity."""
    run = with_meters(hand(), ("one.f", "=t", "N"), ("two.f", "=2 - t", "N"))
    tab = opened(report([run, run], plots=["one.f", "two.f"]))
    turns = tab.evaluate("""async () => {
        const { u } = sandbox.plots[0], { ctx } = u, own = ctx.setLineDash, found = [];
        ctx.setLineDash = (dash) => { found.push(dash); own.call(ctx, dash); };
        u.redraw();
        await new Promise((done) => setTimeout(done, 50));
        delete ctx.setLineDash;
        return found.filter(([on, off]) => on && on === off).length;
    }""")
    assert turns == 2  # of the first, solid in both runs


@pytest.mark.parametrize("size", [PHONE, {"viewport": {"width": 1280, "height": 900}}],
                         ids=["phone", "desk"])
def test_every_curve_has_its_name_and_its_value_however_narrow_the_plot(opened, many, size):
    tab = opened(many, **size)
    cells = tab.locator(".plot output b")
    texts = cells.all_inner_texts()
    assert [text[:5] for text in texts] == [f"part{k}" for k in range(1, 9)]
    edge = tab.locator(".plot").bounding_box()
    for number in tab.locator(".plot output data").all():
        box = number.bounding_box()
        assert box["width"] > 5
        assert edge["x"] <= box["x"]
        assert box["x"] + box["width"] <= edge["x"] + edge["width"]


def test_a_phone_shows_verdicts_and_picture_before_what_is_folded(opened):
    run = with_meters(hand(), ("long.name.of.what.is.expected", "=t", "N"), expect=[
        {"final": "long.name.of.what.is.expected", "below": 1e-3, "because": "it is so"}])
    tab = opened(report([run]), **PHONE)
    for word in ("FAIL", "0 to 0.001", "at most 0.001"):
        for cell in tab.locator(f"td:has-text('{word}')").all():
            box = cell.bounding_box()
            assert box["x"] + box["width"] <= 390
    assert tab.locator("td", has_text="FAIL").count() == 1
    assert not tab.locator(".layers").is_visible()
    tab.get_by_text("layers", exact=True).click()
    assert tab.locator("[data-layer=bodies]").is_visible()


def test_the_time_stands_below_the_drawing(opened):
    tab = opened(report([hand()]), **PHONE)
    y, h, foot = tab.evaluate("""() => {
        const s = sandbox.stages[0], own = s.ctx.fillText, found = [];
        s.ctx.fillText = (text, x, y) => {
            if (text.startsWith("t = ")) found.push(y);
            own.call(s.ctx, text, x, y);
        };
        sandbox.show();
        delete s.ctx.fillText;
        return [...found, s.h, s.foot];
    }""")
    assert h - foot < y < h


def test_drawings_beside_each_other_stand_at_one_height(opened):
    run = hand()
    other = with_meters(run, view={**run.mechanism.view.model_dump(mode="json"),
                                   "show": ["-contacts", "-tensions", "-springs", "-drives"]})
    tab = opened(report([run, other]), at="#t=0.5")
    rows = tab.evaluate("sandbox.stages.map((s) => s.rows.length)")
    assert rows[0] != rows[1]
    assert len(set(tab.evaluate("sandbox.stages.map((s) => s.foot)"))) == 1
    tops = [canvas.bounding_box()["y"] for canvas in tab.locator(".sheet canvas").all()]
    assert tops[0] == tops[1]


def test_a_figure_that_asks_for_a_look_is_neither_good_nor_bad(opened):
    run = with_meters(hand(), expect=[])
    look = Figure("energy", 2.0, "J", 1.0, "look", "why", "source")
    well = replace(look, name="momentum", value=0.5, verdict="pass")
    tab = opened(report([run], [FoundOut(figures=[well, look, well])]))
    rows = [row.is_visible() for row in tab.locator("td[data-of='figure']").all()]
    assert rows == [True, False, False]  # the others are folded
    assert tab.locator(".verdict.look").inner_text() == "1 figure of the audit asks for a look"
    assert tab.locator("tr.look").count() == 1
    nothing = opened(report([run]))
    assert nothing.locator(".verdict").get_attribute("class").split() == ["verdict"]


def test_a_page_judges_what_nobody_has_judged(opened):
    run = with_meters(hand(), ("one", "=t", "s"), expect=[{"final": "one", "below": 1e-3}])
    tab = opened(report([run]))
    assert tab.locator(".verdict.bad").inner_text() == "0 of 1 expectations hold"


def test_a_page_begins_at_the_speed_of_its_view(opened):
    run = hand()
    slow = with_meters(run, view={**run.mechanism.view.model_dump(mode="json"), "speed": 0.3})
    tab = opened(report([slow]))
    assert tab.evaluate("[sandbox.speed, sandbox.speeds.value]") == [0.3, "0.3"]
    tab.keyboard.press("]")
    assert tab.evaluate("[sandbox.speed, sandbox.speeds.value]") == [0.5, "0.5"]
    tab.keyboard.press("[")
    assert tab.evaluate("sandbox.speed") == 0.3


def test_bands_of_several_runs_are_those_of_each_in_its_colour(opened):
    one, two = (with_meters(hand(), ("one", f"={k} * t", "s"),
                            expect=[{"max": "one", "below": 9 * k, "above": 0}]) for k in (1, 2))
    bands = "sandbox.plots[0].bands.map((b) => [b.high, b.ink, b.word, b.ok])"
    assert opened(report([one, two])).evaluate(bands) == [
        [9, 0, "expected (1)", True], [18, 1, "expected (2)", True]]
    assert opened(report([one, one])).evaluate(bands) == [[9, None, "", True]]
    assert opened(report([two])).evaluate(bands) == [[18, None, "", True]]
    mean = with_meters(hand(), ("one", "=t", "s"), expect=[{"mean": "one", "below": 9}])
    assert opened(report([mean])).evaluate(bands) == [[9, None, "mean", True]]
