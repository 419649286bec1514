"""Meters in the picture: right values, right places, room for the motion."""

import re

import numpy as np
import pytest

from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.meters import HUES, _apart, _pieces, dials
from sandbox.draw.film.options import check_view, view_of
from sandbox.draw.film.shapes import DrawnLines, FilledCircle
from sandbox.draw.film.sheet import Text
from sandbox.draw.film.video import render
from sandbox.errors import OutputError
from sandbox.model.meters import check_shown
from sandbox.scene.mechanism import Mechanism

from .conftest import recording


def turning(duration=2.0, samples=401, other=(0.0, 0.1), rate=1.0, **view):
    """A wheel that turns at ``rate`` rad/s, and rests at x = 10 mm: angle = rate t, closed form."""
    mechanism = Mechanism.model_validate({
        "name": "wheel", "run": {"duration": duration},
        "bodies": [{"name": "wheel", "mass": 1, "at": [0.01, 0],
                    "shapes": [{"type": "circle", "radius": 0.01}]},
                   {"name": "other", "mass": 1, "at": [0, 0.1],
                    "shapes": [{"type": "circle", "radius": 0.01}]}],
        "meters": [{"name": "twice", "value": "=2 * t"}],
        "view": {"size": [800, 600], **view}})
    time = np.linspace(0.0, duration, samples)
    pose = np.zeros((samples, 2, 3))
    pose[:, 0, 0], pose[:, 0, 2], pose[:, 1, :2] = 0.01, rate * time, other
    return recording(mechanism, time, pose)


def texts(sheet):
    return [word.face.text for word in sheet.words if isinstance(word, Text)]


def test_values_are_those_of_the_run_in_the_units_of_plots():
    run = turning(meters=["wheel.angle", "wheel.x", {"of": "=wheel.angle * t", "unit": "rad"},
                          {"of": "=t", "unit": "parsec"}])
    angle, x, squared, plain = dials(run, run.mechanism.view)
    assert angle.values[0] == pytest.approx(np.degrees(run.time))
    assert x.values[0] == pytest.approx(10.0)
    assert squared.values[0] == pytest.approx(np.degrees(run.time**2))
    assert [angle.texts(200), x.texts(3), plain.texts(400)] == [["57°"], ["10.0 mm"],
                                                                 ["2.00 parsec"]]


@pytest.mark.parametrize("t", [0.0, 0.5, 2.0])
def test_the_dot_is_where_the_value_and_the_time_are(t):
    """Linear in time and in value between the ends of the frame: angle = t, shown 0 to 2 rad."""
    run = turning(meters=[{"of": "wheel.angle", "range": [0, 2]}])
    renderer = FrameRenderer(run)
    panel, k = renderer._panel, renderer.enlarged
    plot = panel._plot(panel._dials[0], panel._cells[0])
    sheet = renderer.sheet(t)
    dot = next(laid.shape for laid in sheet.laid
               if isinstance(laid.shape, FilledCircle) and laid.shape.colour == HUES[0])
    assert dot.centre == pytest.approx((k * (plot.left + plot.width * t / 2),
                                        k * (plot.bottom - plot.height * t / 2)), abs=1e-6)
    curves = [laid.shape for laid in sheet.laid
              if isinstance(laid.shape, DrawnLines) and laid.shape.colour == HUES[0]]
    # up to the cursor and no further
    assert all(np.asarray(curve.path)[:, 0].max() <= dot.centre[0] + 1e-6 for curve in curves)
    assert len(curves) == (t > 0)
    assert f"{np.degrees(t):.0f}"[:2] in texts(sheet)[-2]


@pytest.mark.parametrize(("spread", "aside"), [((0.0, 0.5), True), ((0.5, 0.0), False)])
def test_meters_stand_where_they_leave_the_motion_larger(spread, aside):
    """What is high leaves room at its side, what is wide below it."""
    run = turning(meters=["wheel.angle"], other=spread)
    renderer = FrameRenderer(run)
    assert renderer._aside is aside
    assert (renderer._panel.rect.left > 400) is aside
    assert not renderer._stage.colliderect(renderer._panel.rect)
    for cell in renderer._panel._cells:
        assert renderer._panel.rect.contains(cell)


def test_curves_are_named_by_what_differs():
    assert _apart(["finger1.tendon.tension", "finger2.tendon.tension"]) == (
        ["finger1", "finger2"], "finger*.tendon.tension")
    assert _apart(["f.mcp.angle", "f.pip.angle"]) == (["mcp", "pip"], "f.*p.angle")
    assert _apart(["a.x", "b.angle"]) == (["a.x", "b.angle"], "a.x, b.angle")
    assert _apart(["a", "a.b"])[0] == ["a", "a.b"]


@pytest.mark.parametrize(("meters", "path", "told"), [
    (["wheel.angel"], "$.view.meters[0].of[0]", "'wheel.angle'"),
    (["wheel.angle", "whel.*"], "$.view.meters[1].of[0]", "no quantity fits"),
    (["=wheel.angel * 2"], "$.view.meters[0].of[0]", "'wheel.angle'"),
    ([{"of": ["wheel.angle", "wheel.x"]}], "$.view.meters[0]", "'m', 'rad'"),
    (["*"], "$.view.meters[0]", "too many for one meter"),
])
def test_what_a_meter_cannot_show_is_told_with_its_place(meters, path, told):
    run = turning(meters=meters)
    problems = check_shown(run.mechanism)
    assert problems[0].path == path
    assert told in str(problems[0])
    with pytest.raises(OutputError, match=re.escape(path.removeprefix("$.view."))):
        check_view(run, run.mechanism.view)


def test_meters_of_a_picture_take_the_place_of_the_scenes(tmp_path):
    run = turning(meters=["wheel.x"])
    view = view_of(run.mechanism.view, {"meters": "twice"})
    assert [meter.of for meter in view.meters] == [("twice",)]
    assert texts(FrameRenderer(run, view=view).sheet(1.0)).count("twice") == 1
    render(run, tmp_path / "a.png", meters=[{"of": "wheel.angle", "title": "Turn"}])
    with pytest.raises(OutputError, match=r"meters=.*wanted|meters=.*allowed|meters="):
        render(run, tmp_path / "a.png", meters=[{"off": "wheel.angle"}])
    with pytest.raises(OutputError, match=r"did you mean|Did you mean 'wheel.angle'"):
        render(run, tmp_path / "a.png", meters=["wheel.angl"])
    with pytest.raises(OutputError, match=r"'range' is \[lowest, highest\]"):
        render(run, tmp_path / "a.png", meters=[{"of": "wheel.angle", "range": [1, 1]}])


@pytest.mark.parametrize("style", ["plot", "number"])
def test_meters_are_drawn_the_same_in_films_and_stills(style, hand_run):
    names = [f"finger1.{joint}.angle" for joint in ("mcp", "pip")]
    view = view_of(hand_run.mechanism.view, {
        "size": (640, 480), "meters": [{"of": name, "style": style} for name in names]})
    renderer = FrameRenderer(hand_run, view=view)
    for t in (0.0, 0.8, 0.8, 2.0, 0.3):
        assert np.array_equal(renderer.draw(t), renderer.sheet(t).painted())
    plain = FrameRenderer(hand_run, view=view_of(view, {"meters": []}))
    assert plain.camera.scale >= renderer.camera.scale


def test_curves_have_gaps_where_there_is_no_value_and_keep_their_peaks():
    x = np.linspace(0, 100, 10001)
    y = np.sin(x)
    y[5000], y[2000:3000] = 7.0, np.nan
    pieces = list(_pieces(x, y))
    assert [(piece[0][0], piece[0][-1]) for piece in pieces] == [
        (x[0], x[1999]), (x[3000], x[-1])]
    assert max(piece[1].max() for piece in pieces) == 7.0
    assert sum(len(piece[0]) for piece in pieces) < 300
