"""What a picture is fitted to: what stays, what leaves up to its leaving, what a view asks for."""

import numpy as np
import pytest

from sandbox.errors import OutputError
from sandbox.picture.bounds import ROOM, body_box, groups_of
from sandbox.picture.options import view_of
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.settings import View

from .conftest import frames_of, recording

N = 101
TIME = np.linspace(0, 1, N)
DISC = [{"type": "circle", "radius": 0.05}]
FLOOR = {"name": "floor", "motion": "fixed", "role": "ground",
         "shapes": [{"type": "box", "size": [1, 0.1]}]}


def world(*bodies, joints=(), springs=(), ways=None, view=None, **given):
    """The floor and these bodies, each on its way [n, 2] m from its ``at``."""
    mechanism = Mechanism.model_validate({
        "bodies": [FLOOR, *bodies], "joints": list(joints), "springs": list(springs),
        "view": view or {}})
    pose = np.zeros((N, len(bodies) + 1, 3))
    for k, body in enumerate(mechanism.bodies):
        pose[:, k, :2] = body.at
        pose[:, k, :2] += (ways or {}).get(body.name, 0)
    return recording(mechanism, TIME, pose, **given)


def body(name, at, **more):
    return {"name": name, "at": at, "mass": 1, "shapes": DISC, **more}


def falling(depth=20.0):
    """From rest for 0.5 s, then down with even acceleration."""
    way = np.zeros((N, 2))
    late = TIME > 0.5
    way[late, 1] = -depth * ((TIME[late] - 0.5) / 0.5) ** 2
    return way


def shelf(motion):
    path = {"path": {"y": {"table": [[0, 0], [1, 0]]}}} if motion == "scheduled" else {"mass": 1}
    return {"name": "shelf", "at": [0, 0.3], "motion": motion, **path,
            "shapes": [{"type": "box", "size": [0.5, 0.02]}]}


@pytest.mark.parametrize("motion", ["dynamic", "scheduled"])
def test_a_shelf_that_drops_away_does_not_shrink_the_rest(motion):
    """However deep it falls, no more than its room below the floor is shown of that."""
    boxes = [body_box(world(shelf(motion), ways={"shelf": falling(depth)}))
             for depth in (0.0, 20.0, 2000.0)]
    assert boxes[0].size[1] == pytest.approx(0.36)  # from -0.05 to 0.31
    # the last sample within: at most its room of a floor 1 m wide, and its thickness
    assert all(box.y0 >= -0.05 - ROOM - 0.02 for box in boxes)
    assert all(box.y1 == pytest.approx(0.31) for box in boxes)


def test_what_comes_back_or_comes_later_is_shown_all_the_way():
    up = np.stack((0 * TIME, 3 * np.sin(np.pi * TIME)), axis=1)
    assert body_box(world(body("ball", [0, 0.1]), ways={"ball": up})).y1 == pytest.approx(
        3.15, abs=0.01)
    down = np.stack((0 * TIME, -2 * TIME), axis=1)
    assert body_box(world(body("ball", [0, 2.1]), ways={"ball": down})).y1 == pytest.approx(2.15)


def test_what_is_tied_stays():
    """By a spring or a rod; not once that is let go."""
    away = np.stack((5 * TIME, 0 * TIME), axis=1)
    spring = {"type": "linear", "name": "s", "a": "floor", "b": "ball", "stiffness": 1}
    free = world(body("ball", [0, 0.1]), ways={"ball": away})
    tied = world(body("ball", [0, 0.1]), springs=[spring], ways={"ball": away})
    assert groups_of(free)[1].tolist() == [True, False]
    assert groups_of(tied)[1].tolist() == [True, True]
    assert body_box(tied).x1 == pytest.approx(5.05)
    assert body_box(free).x1 < 0.5 + ROOM + 0.2


def test_a_picture_that_follows_a_body_keeps_it_where_it_is():
    """The ground passes: its right end is where the body's way says."""
    ways = {"ball": np.stack((9 * TIME, 0 * TIME), axis=1)}
    run = world(body("ball", [0, 0.1]), ways=ways, view={"follow": "ball", "width": 4.0})
    renderer = frames_of(run, size=(400, 300))
    edges = []
    for t in (0.0, 0.1, 0.2):
        picture = renderer.draw(t).astype(int)
        camera = renderer.picture.camera
        floor, ball = camera.to_pixels(np.array([[0, -0.03], [0, 0.1]])).astype(int)
        seen = np.flatnonzero((picture[ball[1]] < 240).any(axis=1))
        assert (seen.min() + seen.max()) / 2 == pytest.approx(200, abs=2)
        edges.append(np.flatnonzero((picture[floor[1]] < 240).any(axis=1)).max())
    # 100 pixels a metre: the floor's right end passes by 90 pixels in a tenth of a second
    assert edges[0] - edges[1] == pytest.approx(90, abs=2)


def test_what_a_view_names_has_to_be_there():
    import sandbox

    run = world(body("ball", [0, 0.1]))
    for option, given in (("follow", "bal"), ("bodies", ["bal"]), ("show", {"axes": ["bal"]})):
        with pytest.raises(OutputError, match=rf"{option}.*'bal'. Did you mean 'ball'\? Allowed: "):
            sandbox.render(run, "never.png", **{option: given})
    with pytest.raises(OutputError, match="no layer named 'trace'; did you mean 'traces'"):
        sandbox.render(run, "never.png", show="trace")


def test_a_picture_of_some_bodies_shows_these_and_not_their_cables_or_others_traces():
    """By name or by role; a window of the scene's and what is traced elsewhere do not count."""
    far = {"body": "floor", "at": [-30, 0]}
    cable = {"name": "cord", "guides": [far, {"body": "ball", "at": [20, 0]}]}
    run = world(body("ball", [0, 0.1], role="object"), body("other", [9, 9]), ways={}, view={
        "traces": [{"body": "other"}], "centre": [5, 5], "width": 50})
    view = run.mechanism.view
    for pattern in ("ball", "role:object", "role:obj*"):
        box = body_box(run, view_of(view, {"bodies": pattern}))
        assert (box.x0, box.x1, box.y0, box.y1) == pytest.approx((-0.05, 0.05, 0.05, 0.15))
        found = view_of(view, {"bodies": pattern})
        assert (found.centre, found.width) == (None, None)
    mechanism = Mechanism.model_validate({
        "bodies": [FLOOR, body("ball", [0, 0.1])], "tendons": [cable],
        "view": {"bodies": ["ball"]}})
    pose = np.zeros((N, 2, 3))
    pose[:, 1, :2] = 0, 0.1
    assert body_box(recording(mechanism, TIME, pose)).size[0] == pytest.approx(0.1)


SLIDER = {"type": "slot", "name": "ways", "a": "floor", "b": "slider", "start": [-0.5, 0.1],
          "end": [0.5, 0.1]}
LIFTER = {"type": "linear", "name": "spring", "a": "floor", "b": "lifter", "on_a": [0.2, 0.9],
          "on_b": [0, 0], "stiffness": 10, "rest_length": 0.1}


def machine(reach, **more):
    """A slider that goes to and fro by ``reach`` [m], and a lifter on a spring above it."""
    ways = {"slider": np.stack((reach * np.sin(9 * TIME), 0 * TIME), axis=1),
            "lifter": np.stack((0 * TIME, 0.05 * np.sin(9 * TIME)), axis=1)}
    return world(body("slider", [0, 0.1]), body("lifter", [0.2, 0.6]), joints=[SLIDER],
                 springs=[LIFTER], ways=ways, **more)


def test_a_picture_that_follows_a_part_of_a_machine_holds_all_of_it():
    """Lifter and the spring's upper end are tied to the slider by the floor alone."""
    run = machine(0.1)
    alone, along = body_box(run), body_box(run, view_of(run.mechanism.view, {"follow": "slider"}))
    assert (along.y0, along.y1) == pytest.approx((alone.y0, alone.y1))
    assert along.y1 == pytest.approx(0.9)
    # the slider keeps its place, so that all else goes to and fro
    assert (along.x0, along.x1) == pytest.approx((alone.x0 - 0.1, alone.x1 + 0.1), abs=1e-3)


def test_a_still_of_some_bodies_is_fitted_to_where_they_are_then():
    ways = {"ball": np.stack((9 * TIME, 0 * TIME), axis=1)}
    run = world(body("ball", [0, 0.1]), ways=ways, view={"bodies": ["ball"]})
    box = body_box(run, moments=[0.5])
    assert (box.x0, box.x1) == pytest.approx((4.45, 4.55))
    assert body_box(run).size[0] == pytest.approx(9.1)


def test_the_picture_has_room_for_traces():
    """A point 0.5 m from the middle of a body that turns once."""
    pose = np.zeros((N, 1, 3))
    pose[:, 0, 2] = 2 * np.pi * TIME
    for traces, width in (([{"body": "arm", "at": [0.5, 0]}], 1.0), ([], 0.01)):
        mechanism = Mechanism.model_validate({"view": {"traces": traces}, "bodies": [
            {"name": "arm", "mass": 1, "shapes": [{"type": "circle", "radius": 0.005}]}]})
        assert body_box(recording(mechanism, TIME, pose)).size[0] == pytest.approx(width, rel=0.01)


@pytest.mark.parametrize(("given", "width"), [
    ({"size": (800, 300)}, 0.8), ({"size": (400, 600)}, 0.4), ({"size": "2x"}, 0.4),
    ({"size": (800, 300), "width": 0.4}, 0.4)])
def test_a_picture_of_another_shape_shows_all_of_the_window(given, width):
    """0.4 m x 0.3 m at 400 x 300: twice as wide at the same height, unless the width is given."""
    view = View.model_validate({"centre": [0, 0], "width": 0.4, "size": [400, 300]})
    assert view_of(view, given).width == pytest.approx(width)
