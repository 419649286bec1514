"""What a page draws, read from its stage, against the arrays of the recording."""

from dataclasses import replace

import numpy as np
import pytest

from sandbox.recording.recording import Recording
from sandbox.samples.contacts import contacts_on
from sandbox.samples.outcome import Happened
from sandbox.web.page import report
from tests.draw.conftest import hand, zoo

AT = int(hand().arrays["contact_sample"].max())

ARROWS = """(layer) => {
  const s = sandbox.stages[0];
  const item = s.list.items.find((one) => one.k === "arrows" && one.l === layer);
  return [s.ox, s.oy, s.scale, item.metres, item.most, item.least * s.u,
          s.vectors(item).map(([row, a, b]) => [...a, ...b])];
}"""


@pytest.fixture(scope="module")
def run():
    return hand()


@pytest.fixture
def tab(opened, run):
    shown = opened(report([run]), viewport={"width": 1280, "height": 1000})
    shown.evaluate("(t) => sandbox.hold(t)", float(run.time[AT]))
    return shown


def test_arrows_are_those_of_the_recording(tab, run):
    ox, oy, scale, metres, most, least, seen = tab.evaluate(ARROWS, "contacts")
    here = run.arrays["contact_sample"] == AT
    _, force = contacts_on(run.model, run.arrays)
    size = np.hypot(*force[here].T)
    shown = force[here] * (metres * np.minimum(1, most / np.maximum(size, 1e-30)))[:, None]
    tails = run.arrays["contact_point"][here]
    expected = np.column_stack([tails, tails + shown]) * scale * [1, -1, 1, -1] + [ox, oy, ox, oy]
    long = np.hypot(*(expected[:, 2:] - expected[:, :2]).T) >= least
    found = np.array(sorted(seen))
    assert long.any()
    assert found == pytest.approx(np.array(sorted(expected[long].tolist())), abs=0.2)
    largest = np.argmax(size * long)  # on top of the others; the pointer tells its force
    box = tab.locator("canvas").first.bounding_box()
    x0, y0, x1, y1 = expected[largest]
    tab.mouse.move(box["x"] + (x0 + 2 * x1) / 3, box["y"] + (y0 + 2 * y1) / 3)
    name, value = tab.locator(".tip").inner_text().split("\n")
    assert "/" in name
    assert float(value.removesuffix(" N")) == pytest.approx(size[largest], abs=0.0051)


def test_every_kind_of_item_is_seen_by_day_and_by_night(opened):
    """Without the items of one kind the picture differs; what is picked is an element's name."""
    run = zoo()
    tab = opened(report([run]))
    for layer in tab.evaluate("sandbox.head.layers.map((l) => l.name)"):
        tab.evaluate("(name) => sandbox.stages[0].layers.add(name)", layer)
    tab.evaluate("sandbox.hold(0.3)")
    for scheme in ("light", "dark"):
        tab.emulate_media(color_scheme=scheme)
        seen = tab.evaluate("""() => {
          const s = sandbox.stages[0], { canvas, list } = s, all = list.items, found = {};
          const [w, h] = [canvas.width, canvas.height];
          const copy = new OffscreenCanvas(w, h).getContext("2d", { willReadFrequently: true });
          const take = () => {
            sandbox.redraw(); copy.drawImage(canvas, 0, 0);
            return copy.getImageData(0, 0, w, h).data;
          };
          const whole = take();
          for (const kind of new Set(all.map((i) => i.k))) {
            list.items = all.filter((i) => i.k !== kind);
            const less = take();
            found[kind] = whole.reduce((sum, v, k) => sum + (Math.abs(v - less[k]) > 30), 0);
          }
          list.items = all;
          return found;
        }""")
        assert {"path", "line", "mark", "span", "spiral", "taut", "trail", "text"} <= set(seen)
        assert min(seen.values()) > 20, seen
    found = tab.evaluate("""() => {
      const s = sandbox.stages[0], names = new Set();
      for (let x = 0; x < s.w; x += 6) {
        for (let y = 0; y < s.h - s.foot; y += 6) names.add((s.pick(x, y) || {}).n);
      }
      return [...names].filter(Boolean);
    }""")
    assert len(found) > 3
    assert set(found) <= {name.split(".")[0] for name in run.names()} | {
        drive.name for drive in run.mechanism.drives} | {j.name for j in run.mechanism.joints}


def test_a_trace_is_the_way_that_was_gone(tab, run):
    (body, x, y), way = tab.evaluate("""() => {
      const item = sandbox.stages[0].list.items.find((one) => one.k === "trail");
      return [item.at, [...sandbox.runs[0].way(item)]];
    }""")
    px, py, angle = run.arrays["body_pose"][:, body].T
    c, s = np.cos(angle), np.sin(angle)
    expected = np.column_stack([px + c * x - s * y, py + s * x + c * y])
    assert np.array(way).reshape(-1, 2) == pytest.approx(expected, abs=1e-4)


@pytest.mark.nightly
def test_marks_and_bands_of_verdicts_are_where_the_run_has_them(opened, run):
    data = run.mechanism.model_dump(mode="json", by_alias=True)
    data["events"] = [{"name": "enough", "at": 0.25, "set": {"push": 1}}]
    data["expect"] = [{"mean": "finger1.distal.y", "above": 9, "over": [0.4, 0.6]},
                      {"final": "finger1.distal.y", "above": -9}]
    told = Recording(type(run.mechanism).model_validate(data), run.arrays, replace(
        run.info, events=(Happened("enough", 0.25),)))
    tab = opened(report([told], plots=["finger1.distal.y"]))
    assert "1 of 2 expectations passed" in tab.locator(".verdict").inner_text()
    inside = [k for k, t in enumerate(run.time) if 0.4 <= t <= 0.6]
    tab.evaluate("sandbox.hold(0.1)")
    for key, t in (("n", 0.25), ("n", run.time[inside[-1]]), ("p", 0.25)):
        tab.keyboard.press(key)
        assert tab.evaluate("sandbox.t") == pytest.approx(t, abs=1e-6)
    marks = [float(mark.get_attribute("style").split()[1].rstrip("%;"))
             for mark in tab.locator(".mark").all()]
    assert marks == pytest.approx(
        [100 * t / run.time[-1] for t in (0.25, run.time[inside[-1]])], abs=0.01)
    [band, _] = tab.evaluate("sandbox.plots[0].bands.map((b) => [b.from, b.to])")
    assert band == pytest.approx(run.time[[inside[0], inside[-1]]].tolist())
