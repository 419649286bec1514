"""Ways of points: where they went, as far as they have come, whatever they cross."""

import numpy as np
import pytest

import sandbox
from sandbox.draw.film.bounds import body_box
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.palette import TRACE, TRACES
from sandbox.draw.film.sheet import Text
from sandbox.errors import SceneError
from sandbox.scene.mechanism import Mechanism

from .conftest import recording

RADIUS = 0.04


def turning(turns=1.0, samples=101, traces=({"body": "arm", "at": [RADIUS, 0]},), **view):
    """An arm that turns about the middle, evenly, once in a second for each of ``turns``."""
    time = np.linspace(0, 1, samples)
    pose = np.zeros((samples, 1, 3))
    pose[:, 0, 2] = 2 * np.pi * turns * time
    return recording(Mechanism.model_validate({
        "bodies": [{"name": "arm", "mass": 1, "shapes": [{"type": "circle", "radius": 0.005}]}],
        "view": {"centre": [0, 0], "width": 0.12, "traces": list(traces), **view}}), time, pose)


def green(run, t, at):
    """Whether places [k, 2] of the world show the trace's colour at ``t``."""
    drawn = FrameRenderer(run, size=(480, 480))
    picture = drawn.draw(t).astype(int)
    found = []
    for x, y in drawn.camera.to_pixels(np.asarray(at, dtype=float)):
        near = picture[int(y) - 2:int(y) + 3, int(x) - 2:int(x) + 3].reshape(-1, 3)
        found.append(bool((np.abs(near - TRACE).max(axis=1) < 40).any()))
    return found


def on_circle(*degrees):
    angle = np.radians(degrees)
    return RADIUS * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def test_it_is_drawn_as_far_as_the_point_has_come():
    places = on_circle(30, 80, 130, 200, 300)
    assert green(turning(), 0.25, places) == [True, True, False, False, False]
    assert green(turning(), 1.0, places) == [True] * 5


def test_a_way_gone_twice_is_as_one_gone_once():
    """One outline around both would have its inside out."""
    places = on_circle(*range(5, 360, 15))
    assert all(green(turning(turns=2.0), 1.0, places))
    assert all(green(turning(turns=3.5), 1.0, places))


def test_time_may_go_back():
    drawn = FrameRenderer(turning(), size=(200, 200))
    first = drawn.draw(0.3).copy()
    drawn.draw(0.9)
    assert np.array_equal(drawn.draw(0.3), first)
    assert np.array_equal(FrameRenderer(turning(), size=(200, 200)).draw(0.3), first)


def test_without_traces_nothing_is_green():
    assert green(turning(traces=()), 1.0, on_circle(30, 200)) == [False, False]


def test_what_left_the_picture_or_is_no_number_is_left_out():
    run = turning(samples=11)
    run.arrays["body_pose"] = run.arrays["body_pose"].copy()
    run.arrays["body_pose"][3, 0, 0] = 1e8
    run.arrays["body_pose"][4, 0, 0] = np.nan
    assert green(run, 1.0, on_circle(324)) == [True]


def test_the_picture_has_room_for_it():
    view = {"centre": None, "width": None}
    far = turning(traces=[{"body": "arm", "at": [0.5, 0]}], **view)
    assert body_box(far).width == pytest.approx(1.0, rel=0.01)
    assert body_box(turning(traces=(), **view)).width < 0.02


def test_a_body_that_is_not_there_is_told():
    scene = {"bodies": [{"name": "hammer", "mass": 1, "inertia": 1}],
             "view": {"traces": [{"body": "hammer"}, {"body": "hamer"}]}}
    with pytest.raises(SceneError) as caught:
        sandbox.load_scene(scene)
    problem, = caught.value.problems
    assert problem.path == "$.view.traces[1].body"
    assert problem.hint == "'hammer'"


def test_more_than_a_picture_can_show_are_refused():
    scene = {"bodies": [{"name": "hammer", "mass": 1, "inertia": 1}],
             "view": {"traces": [{"body": "hammer"}] * 65}}
    with pytest.raises(SceneError, match="64"):
        sandbox.load_scene(scene)


def test_marks_stand_where_the_point_was_at_round_times():
    """Once round in a second, a mark each tenth: 36 degrees apart, on the chords of samples."""
    run = turning(samples=1001)
    renderer = FrameRenderer(run, size=(480, 480))
    traces = renderer._drawn_by.traces
    assert traces.interval == 0.1
    marks = traces._ways[0].marks
    assert marks == pytest.approx(on_circle(*range(36, 361, 36)), abs=1e-12)


def test_marks_of_a_run_that_begins_late_begin_after_it():
    run = turning()
    run.arrays["time"] = run.arrays["time"] + 1e6 + 0.03
    traces = FrameRenderer(run, size=(480, 480))._drawn_by.traces
    assert traces._times[0] == pytest.approx(1e6 + 0.1)
    assert len(traces._times) == 10


def test_ways_of_several_bodies_are_told_apart_by_colour_and_name():
    """In the bodies' own colours where each has another one; one alone has the usual colour."""
    def drawn(*colours, **view):
        bodies = [{"name": f"ball{k}", "mass": 1, "shapes": [{"type": "circle", "radius": 0.005}],
                   **({"colour": colour} if colour else {})} for k, colour in enumerate(colours)]
        traces = [{"body": body["name"]} for body in bodies]
        time = np.linspace(0, 1, 11)
        pose = np.zeros((11, len(bodies), 3))
        pose[:, :, 0] = 0.1 * time[:, None]
        pose[:, :, 1] = 0.05 * np.arange(len(bodies))
        run = recording(Mechanism.model_validate(
            {"bodies": bodies, "view": {"traces": traces, **view}}), time, pose)
        picture = FrameRenderer(run)
        words = [word.face.text for word in picture.sheet(1.0).words if isinstance(word, Text)]
        return picture._drawn_by.traces.colours, [word for word in words if "ball" in word]

    assert drawn("") == ([TRACE], [])
    colours, names = drawn("", "", "")
    assert colours == list(TRACES[:3])
    assert sorted(names) == ["ball0", "ball1", "ball2"]
    assert sorted(drawn("", "", show=["body_names"])[1]) == ["ball0", "ball1"]
    red, blue = drawn("#ff0000", "#0000ff")[0]
    assert red[0] > 100 > red[2]
    assert blue[2] > 100 > blue[0]
    assert drawn("#ff0000", "#ff0000")[0] == list(TRACES[:2])
