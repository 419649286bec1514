"""What a page draws, read as its reader does, against the arrays of the recording."""

import json
import math

import numpy as np
import pytest

from sandbox.draw.film import palette
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Happened
from sandbox.scene.mechanism import Mechanism
from sandbox.show.header import FoundOut
from sandbox.show.page import report
from sandbox.show.points import css
from tests.draw.conftest import recording
from tests.draw.reading import (
    AT,
    Drawn,
    Seen,
    check_arrows,
    check_straight,
    check_words,
    everything,
    world,
)

COLOURS = {css(getattr(palette, name)): name for name in (
    "FORCE", "VELOCITY", "ACCELERATION", "REACTION", "DRIVE", "STOP", "INK", "TRACE", "BACKGROUND")}
WORDS = {"FORCE": "contact force", "VELOCITY": "velocity", "ACCELERATION": "acceleration",
         "REACTION": "hinge force"}
RECORD = """() => {
  const s = sandbox.stages[0], found = [], own = {}, plain = (v) => JSON.parse(JSON.stringify(v));
  for (const name of ["arrow", "line", "area", "dot", "label"]) {
    own[name] = s[name];
    s[name] = (...words) => { found.push([name, ...plain(words)]); own[name].apply(s, words); };
  }
  const write = s.ctx.fillText;
  s.ctx.fillText = (text, x, y) => {
    found.push(["text", text, [x, y], s.ctx.fillStyle]); write.call(s.ctx, text, x, y);
  };
  sandbox.show();
  for (const name in own) delete s[name];
  delete s.ctx.fillText;
  return { found, ox: s.ox, oy: s.oy, scale: s.scale, foot: s.h - s.foot };
}"""


@pytest.fixture(scope="module")
def run():
    return everything()


@pytest.fixture
def tab(opened, run):
    shown = opened(report([run]), viewport={"width": 1280, "height": 1000})
    shown.evaluate("(t) => sandbox.hold(t)", float(run.time[AT]))
    return shown


def up(points):
    """Pixels, y up."""
    return np.asarray(points, float).reshape(-1, 2) * [1, -1]


def drawn_on(tab):
    """What is drawn on a page: calls in their order, and how points are placed."""
    return tab.evaluate(RECORD)


def placed(told):
    return lambda at: np.array([told["ox"] + told["scale"] * at[0],
                                -told["oy"] + told["scale"] * at[1]])


def seen_on(told):
    """The same as what is seen."""
    arrows, legend, words = {name: [] for name in COLOURS.values()}, {}, []
    calls = told["found"]
    for i, (kind, *given) in enumerate(calls):
        if kind == "arrow":
            tail, tip = up(given[0])[0], up(given[1])[0]
            lines = [up(c[1]).mean(axis=0) for c in calls[i + 1:i + 9]
                     if c[0] == "line" and COLOURS.get(c[2]) == "BACKGROUND"][:2]
            cut = len(lines) == 2 and all(math.dist(tail + w * (tip - tail), one) < 0.6
                                          for w, one in zip((0.4, 0.5), lines, strict=True))
            name = COLOURS[given[3]]
            (legend.setdefault(name, []) if -tail[1] > told["foot"] else arrows[name]).append(
                Drawn(tail, tip, cut))
        elif kind == "text":
            words.append((given[0], COLOURS.get(given[2], ""), up(given[1])[0]))
    lengths = {name: math.dist(legend[name][0].tail, legend[name][0].tip) / next(
        float(text.split()[0]) for text, _, _ in words if f" {after}" in text)
        for name, after in WORDS.items()}
    bar = next(up(c[1]) for c in calls if c[0] == "line" and COLOURS.get(c[2]) == "INK"
               and -up(c[1])[0, 1] > told["foot"])
    metres = next(float(text.split()[0]) * {"mm": 1e-3, "m": 1.0}[text.split()[1]]
                  for text, _, _ in words if text.endswith((" mm", " m")))
    return Seen(arrows, lengths, words, float(np.ptp(bar[:, 0])) / metres)


def areas_of(told, colour):
    """Corners of what is filled with a colour, above the legend."""
    found = [up(call[1]) for call in told["found"] if call[0] == "area"
             and isinstance(call[2], str) and COLOURS.get(call[2]) == colour]
    return [one for one in found if -one[0, 1] < told["foot"]]


def test_arrows_numbers_and_scales_are_those_of_the_recording(tab, run):
    told = drawn_on(tab)
    seen = seen_on(told)
    check_arrows(seen, run, placed(told), shortest=6.5)
    check_straight(seen, run, placed(told))
    check_words(seen, run, placed(told), reach=90)
    assert seen.scale == pytest.approx(told["scale"], rel=1e-6)
    texts = [text for text, _, _ in seen.words]
    assert f"t = {run.time[AT]:.3f} s" in texts
    labels = [call[1] for call in told["found"] if call[0] == "label"]
    assert f"motor {run.arrays['drive_torque'][AT, 2]:.3f} N m" in labels
    assert f"twist {run.arrays['drive_value'][AT, 1]:.3g} N m" in labels
    assert "-5.00 N" in labels  # the rod pushes


def test_what_turns_turns_the_way_that_its_value_has(tab, run):
    """Both are negative, about hinges that are positive with the clock: against the clock."""
    told = drawn_on(tab)
    pose = run.arrays["body_pose"][AT]
    pin, end = (placed(told)(pose[body, :2]) for body in (3, 4))
    areas = areas_of(told, "DRIVE")

    def sense(about, base, tip):
        (x, y), (dx, dy) = base - about, tip - base
        return math.copysign(1, x * dy - y * dx)

    [torque] = [one for one in areas if len(one) == 7
                and max(math.dist(one[3], pin), math.dist(one[0], pin)) < 30]
    assert sense(pin, (torque[0] + torque[6]) / 2, torque[3]) == 1
    [head] = [one for one in areas if len(one) == 3 and math.dist(one[0], end) < 30]
    assert sense(end, head[1:].mean(axis=0), head[0]) == 1
    # the stop turns the arm with the clock, away from the post on its left: it sits above
    [wedge] = areas_of(told, "STOP")
    way = wedge[1:].mean(axis=0) - wedge[0]
    assert wedge[0] == pytest.approx(pin, abs=0.1)
    assert way[1] > 0.8 * math.hypot(*way)


def test_a_trace_is_the_way_that_was_gone_marked_at_round_times(tab, run):
    told = drawn_on(tab)
    to_pixels = placed(told)
    way = world(run.arrays["body_pose"], 4, (0.0, 0.01))
    path = next(up(call[1]) for call in told["found"] if call[0] == "line"
                and COLOURS.get(call[2]) == "TRACE" and len(call[1]) > 2)
    assert path[0] == pytest.approx(to_pixels(way[0]), abs=0.1)
    assert path[-1] == pytest.approx(to_pixels(way[AT]), abs=0.1)
    off = [min(math.dist(at, to_pixels(one)) for one in way[:AT + 1]) for at in path]
    assert max(off) < 0.1
    dots = [up(call[1])[0] for call in told["found"] if call[0] == "dot"
            and COLOURS.get(call[3]) == "TRACE"]
    dots = [at for at in dots if -at[1] < told["foot"] and math.dist(at, path[-1]) > 0.1]
    times = 0.1 * np.arange(1, 8)
    marks = [to_pixels(np.array([np.interp(t, run.time, way[:, k]) for k in (0, 1)]))
             for t in times]
    # those are left out that are nearer to the last one than nine points
    assert len(dots) > 2
    assert dots[0] == pytest.approx(marks[0], abs=0.1)
    assert max(min(math.dist(at, one) for one in marks) for at in dots) < 0.1


def test_cords_are_coloured_each_by_its_own_tension(tab, run):
    """Of a scale that ends at 5 N."""
    told = drawn_on(tab)
    ramp = [css(colour) for colour in palette.TENSION]
    levels = {}
    for name, body, y in (("cord", 4, 0.14), ("line", 1, 0.1)):
        ends = [placed(told)(at) for at in ((-0.18, y), run.arrays["body_pose"][AT, body, :2])]
        [colour] = [call[2] for call in told["found"] if call[0] == "line" and len(call[1]) == 2
                    and call[2] in ramp and math.dist(up(call[1])[0], ends[0]) < 0.2
                    and math.dist(up(call[1])[1], ends[1]) < 0.2]
        levels[name] = ramp.index(colour) / (len(ramp) - 1)
    step = 1 / (len(ramp) - 1)
    assert levels["cord"] == pytest.approx((1 + run.time[AT]) / 5, abs=0.51 * step)
    assert levels["line"] == pytest.approx((4 - run.time[AT]) / 5, abs=0.51 * step)


def test_a_bar_has_the_number_and_the_colour_of_what_it_carries(opened, run):
    """What its pins pull it apart with: half of what acts on its end, less that on its start."""
    tab = opened(report([run]))
    tab.evaluate("(t) => sandbox.hold(t)", float(run.time[AT]))
    tab.locator("[data-layer=bars]").check()
    told = drawn_on(tab)
    pose, force = run.arrays["body_pose"][AT], run.arrays["joint_force"][AT]
    along = np.array([np.cos(pose[3, 2]), np.sin(pose[3, 2])])
    tension = float((-force[1] - force[0]) @ along / 2)
    top = tab.evaluate("sandbox.heads[0].scale.bars")
    assert abs(tension) > 0.05 * top
    labels = [call[1] for call in told["found"] if call[0] == "label"]
    assert f"{tension:.{2 if top < 10 else 1}f} N" in labels
    ramp = [css(c) for c in (palette.PUSH if tension < 0 else palette.TENSION)]
    ends = [placed(told)(world(pose, 3, at)) for at in ((0, 0), (0.1, 0))]
    colours = [call[2] for call in told["found"] if call[0] == "line" and len(call[1]) == 2
               and np.abs(up(call[1]) - ends).max() < 0.2]
    assert colours[-1] == ramp[min(len(ramp) - 1, round(abs(tension) / top * (len(ramp) - 1)))]


def odd():
    """A disc that swells, and two springs that only pull: one is shorter than at rest."""
    mechanism = Mechanism.model_validate({
        "bodies": [{"name": "floor", "motion": "fixed"},
                   {"name": "balloon", "motion": "fixed", "at": [0.1, 0.1],
                    "shapes": [{"type": "circle", "radius": 0.01}]},
                   {"name": "a", "mass": 1, "inertia": 1, "at": [0.05, 0]},
                   {"name": "b", "mass": 1, "inertia": 1, "at": [0, 0.05]}],
        "springs": [{"type": "linear", "name": name, "a": "floor", "b": name, "stiffness": 10,
                     "only": "pull", "rest_length": 0.05} for name in "ab"],
        "drives": [{"type": "radius", "name": "swell", "body": "balloon", "value": 0.01}]})
    time = np.linspace(0, 1, 11)
    pose = np.zeros((11, 4, 3))
    pose[:] = [[*b.at, b.angle] for b in mechanism.bodies]
    pose[:, 2, 0] -= 0.02 * time
    pose[:, 3, 1] += 0.02 * time
    return recording(mechanism, time, pose, drive_value=0.01 + 0.01 * time[:, None])


def test_a_disc_swells_and_a_spring_that_hangs_is_pale(opened):
    tab = opened(report([odd()]))
    tab.evaluate("sandbox.hold(0.5)")
    told = drawn_on(tab)
    to_pixels = placed(told)
    radii = [call[2] for call in told["found"] if call[0] == "dot"
             and math.dist(up(call[1])[0], to_pixels([0.1, 0.1])) < 0.1]
    assert max(radii) == pytest.approx(0.015 * told["scale"], rel=1e-4)
    colours = {}
    for name, end in (("a", (0.04, 0.0)), ("b", (0.0, 0.06))):
        [colours[name]] = {call[2] for call in told["found"] if call[0] == "line"
                           and len(call[1]) > 10
                           and math.dist(up(call[1])[-1], to_pixels(end)) < 0.1}
    assert colours == {"a": css(palette.SLACK), "b": css(palette.SPRING)}


def test_a_body_that_is_followed_stays_and_the_rest_goes_past_it(tab, run):
    tab.get_by_label("follow").select_option("tip")
    found = []
    for k in (0, AT):
        tab.evaluate("(t) => sandbox.hold(t)", float(run.time[k]))
        told = drawn_on(tab)
        found.append((placed(told)(run.arrays["body_pose"][k, 4, :2]), placed(told)([0, 0])))
    assert found[0][0] == pytest.approx(found[1][0], abs=0.5)
    gone = run.arrays["body_pose"][AT, 4, :2] - run.arrays["body_pose"][0, 4, :2]
    assert found[1][1] - found[0][1] == pytest.approx(-told["scale"] * gone, abs=0.5)
    assert abs(gone[1]) > 0.02


def test_to_follow_nobody_any_more_shows_what_is_shown_of_a_run_that_follows_nobody(opened, run):
    view = run.mechanism.view.model_copy(update={"centre": None, "width": None})

    def shown(follow):
        mechanism = run.mechanism.model_copy(update={"view": view.model_copy(
            update={"follow": follow})})
        tab = opened(report([Recording(mechanism, run.arrays, run.info)]))
        followed = drawn_on(tab)
        tab.get_by_label("follow").select_option("-1")
        tab.get_by_role("button", name="fit", exact=True).click()
        return followed, drawn_on(tab)

    (alone, still), (along, after) = shown(None), shown("tip")
    assert still == alone
    for name in ("ox", "oy", "scale"):
        assert after[name] == pytest.approx(alone[name], rel=0.02)
    assert along["scale"] != pytest.approx(alone["scale"], rel=0.02)


def test_pointing_tells_the_numbers_of_the_nearest_sample(opened, run):
    tab = opened(report([run], plots=["tip.y"]))
    for share, nearest in ((0.0, 7), (0.7, 8), (0.3, 7)):
        t = float(run.time[7] + share * (run.time[8] - run.time[7]))
        tab.evaluate("(t) => sandbox.hold(t)", t)
        value = tab.evaluate("sandbox.series[0].at('tip.y', sandbox.t)")
        assert value == pytest.approx(run["tip.y"][nearest], abs=1e-6)
    shown = tab.locator(".plot output b").first.inner_text()
    assert float(shown) == pytest.approx(1e3 * run["tip.y"][7], rel=1e-3)  # mm
    tab.evaluate("(t) => sandbox.hold(t)", float(run.time[AT]))
    row = next(row for row in tab.evaluate(f"sandbox.replays[0].frame({run.time[AT]}).contacts")
               if abs(row[3]) > 30)
    tab.evaluate("(row) => sandbox.tell(0, {k: 'contact', n: 'box/floor', b: 1, row},"
                 " {clientX: 5, clientY: 5})", row)
    assert tab.locator(".tip").inner_text().split("\n")[1] == "40.11 N"


def test_marks_verdicts_and_windows_are_those_of_the_run(opened, run):
    data = run.mechanism.model_dump(mode="json", by_alias=True)
    data["events"] = [{"name": "enough", "at": 0.25, "set": {"push": 1}}]
    data["expect"] = [{"mean": "tip.y", "above": 9, "over": [0.4, 0.6]},
                      {"final": "tip.y", "above": 0.1}]
    mechanism = type(run.mechanism).model_validate(data)
    told = Recording(mechanism, run.arrays, run.info.__class__(**{
        **vars(run.info), "events": (Happened("enough", 0.25),)}))
    tab = opened(report([told], [FoundOut(verdicts=told.verdicts)], plots=["tip.y"]))
    assert "1 of 2 expectations hold" in tab.locator(".verdict").inner_text()
    marks = {mark.get_attribute("title").split()[0]: mark.get_attribute("style")
             for mark in tab.locator(".mark").all()}
    end = float(run.time[-1])
    inside = [k for k, t in enumerate(run.time) if 0.4 <= t <= 0.6]
    share = {word: float(style.split()[1].rstrip("%;")) for word, style in marks.items()}
    assert share["enough"] == pytest.approx(25 / end, abs=0.01)
    assert share["tip.y"] == pytest.approx(100 * run.time[inside[-1]] / end, abs=0.01)
    tab.evaluate("sandbox.hold(0.1)")
    tab.keyboard.press("n")
    assert tab.evaluate("sandbox.t") == pytest.approx(0.25)
    tab.keyboard.press("n")
    assert tab.evaluate("sandbox.t") == pytest.approx(run.time[inside[-1]], abs=1e-6)
    tab.keyboard.press("p")
    assert tab.evaluate("sandbox.t") == pytest.approx(0.25)
    expect = json.loads(tab.evaluate("JSON.stringify(sandbox.heads[0].words.expect)"))
    assert [one["ok"] for one in expect] == [False, True]
    [[low, high]] = tab.evaluate("""async () => {
        const { u } = sandbox.plots[0], { ctx } = u, found = [], own = ctx.fillRect;
        ctx.fillRect = (x, y, w, h) => { found.push([x, x + w]); own.call(ctx, x, y, w, h); };
        u.redraw();
        await new Promise((done) => setTimeout(done, 100));
        delete ctx.fillRect;
        const at = (x) => u.posToVal((x - u.bbox.left) / devicePixelRatio, "x");
        return found.map(([a, b]) => [at(a), at(b)]);
    }""")[:1]
    assert low == pytest.approx(run.time[inside[0]], abs=0.01)
    assert high == pytest.approx(run.time[inside[-1]], abs=0.01)
    assert expect[0]["over"] == pytest.approx(run.time[[inside[0], inside[-1]]].tolist())
    assert expect[0]["value"] == pytest.approx(run["tip.y"][inside].mean(), rel=1e-4)
