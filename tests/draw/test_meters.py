"""Meters in the picture: right values, right places, room for the motion."""

import re

import numpy as np
import pytest

from sandbox.errors import OutputError
from sandbox.model.meters import check_shown
from sandbox.picture.film import render
from sandbox.picture.frame import Picture
from sandbox.picture.meters import Meter, _apart, _pieces
from sandbox.picture.options import check_view, view_of
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


def test_values_are_those_of_the_run_in_the_units_of_plots():
    run = turning(meters=["wheel.angle", "wheel.x", {"of": "=wheel.angle * t", "unit": "rad"},
                          {"of": "=t", "unit": "parsec"}])
    angle, x, squared, plain = [Meter(run, each) for each in run.mechanism.view.meters]
    assert angle.values[0] == pytest.approx(np.degrees(run.time))
    assert x.values[0] == pytest.approx(10.0)
    assert squared.values[0] == pytest.approx(np.degrees(run.time**2))
    assert [one.texts(one.values[:, [k]]) for one, k in (
        (angle, 200), (x, 3), (plain, 400))] == [["57°"], ["10.0 mm"], ["2.00 parsec"]]


@pytest.mark.parametrize(("spread", "aside"), [((0.0, 0.5), True), ((0.5, 0.0), False)])
def test_meters_stand_where_they_leave_the_motion_larger(spread, aside):
    """What is high leaves room at its side, what is wide below it."""
    run = turning(meters=["wheel.angle"], other=spread)
    picture = Picture(run)
    assert picture.aside is aside
    assert (picture.panel.rect.left > 400) is aside
    assert not picture.panel.rect.colliderect((*picture.stage[:2], *picture.stage.size))
    for meter in picture.panel.meters:
        assert picture.panel.rect.contains(meter.cell)


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


@pytest.mark.parametrize(("meter", "words"), [
    ({"off": "wheel.angle"}, "meters=.*unknown key 'off'"),
    ("wheel.angl", "[Dd]id you mean 'wheel.angle'"),
    ({"of": "wheel.angle", "range": [1, 1]}, r"'range' is \[lowest, highest\]"),
])
def test_meters_of_a_picture_replace_those_of_the_scene(tmp_path, meter, words):
    run = turning(meters=["wheel.x"])
    view = view_of(run.mechanism.view, {"meters": "twice"})
    assert [Meter(run, meter).title for meter in view.meters] == ["twice"]
    with pytest.raises(OutputError, match=words):
        render(run, tmp_path / "a.png", meters=[meter])


def test_curves_have_gaps_where_there_is_no_value_and_keep_their_peaks():
    x = np.linspace(0, 100, 10001)
    y = np.sin(x)
    y[5000], y[2000:3000] = 7.0, np.nan
    pieces = list(_pieces(x, y, 10))
    assert [(of[0], of[-1]) for of, _ in pieces] == [(10, 1999), (3000, 10000)]
    assert all((points == np.column_stack((x, y))[of]).all() for of, points in pieces)
    assert max(points[:, 1].max() for _, points in pieces) == 7.0
    assert sum(len(of) for of, _ in pieces) < 300
