"""What a page draws, read as its reader does, against the arrays of the recording."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sandbox.picture import palette
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Happened
from sandbox.show.page import report
from sandbox.show.points import css
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


@pytest.mark.nightly
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


@pytest.mark.nightly
def test_a_trace_is_the_way_that_was_gone(tab, run):
    told = drawn_on(tab)
    way = [placed(told)(one) for one in world(run.arrays["body_pose"], 4, (0.0, 0.01))[:AT + 1]]
    path = next(up(call[1]) for call in told["found"] if call[0] == "line"
                and COLOURS.get(call[2]) == "TRACE" and len(call[1]) > 2)
    assert path[[0, -1]] == pytest.approx(np.array([way[0], way[-1]]), abs=0.1)
    assert max(min(math.dist(at, one) for one in way) for at in path) < 0.1


@pytest.mark.nightly
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


@pytest.mark.nightly
def test_marks_and_bands_of_verdicts_are_where_the_run_has_them(opened, run):
    data = run.mechanism.model_dump(mode="json", by_alias=True)
    data["events"] = [{"name": "enough", "at": 0.25, "set": {"push": 1}}]
    data["expect"] = [{"mean": "tip.y", "above": 9, "over": [0.4, 0.6]},
                      {"final": "tip.y", "above": 0.1}]
    told = Recording(type(run.mechanism).model_validate(data), run.arrays, replace(
        run.info, events=(Happened("enough", 0.25),)))
    tab = opened(report([told], plots=["tip.y"]))
    assert "1 of 2 expectations passed" in tab.locator(".verdict").inner_text()
    inside = [k for k, t in enumerate(run.time) if 0.4 <= t <= 0.6]
    tab.evaluate("sandbox.hold(0.1)")
    for key, t in (("n", 0.25), ("n", run.time[inside[-1]]), ("p", 0.25)):
        tab.keyboard.press(key)
        assert tab.evaluate("sandbox.t") == pytest.approx(t, abs=1e-6)
    marks = [float(mark.get_attribute("style").split()[1].rstrip("%;"))
             for mark in tab.locator(".mark").all()]
    assert marks == pytest.approx([25 / run.time[-1], 100 * run.time[inside[-1]] / run.time[-1]],
                                  abs=0.01)
    [band, _] = tab.evaluate("sandbox.plots[0].bands.map((b) => [b.from, b.to])")
    assert band == pytest.approx(run.time[[inside[0], inside[-1]]].tolist())
