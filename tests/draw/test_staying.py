"""What a picture is fitted to: what stays, what leaves up to its leaving, what a view asks for."""

import numpy as np
import pytest

from sandbox.draw.film.bounds import body_box
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.options import view_of
from sandbox.draw.film.staying import ROOM, anchored, groups_of, with_it
from sandbox.errors import OutputError
from sandbox.scene.mechanism import Mechanism

from .conftest import recording

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
    assert boxes[0].height == pytest.approx(0.36)  # from -0.05 to 0.31
    # the last sample within: at most its room of a floor 1 m wide, and its thickness
    assert all(box.y0 >= -0.05 - ROOM - 0.02 for box in boxes)
    assert all(box.y1 == pytest.approx(0.31) for box in boxes)


@pytest.mark.parametrize("size", [10.0, 500.0])
def test_a_floor_far_larger_than_what_is_on_it_does_not_shrink_that(size):
    """Of a floor that is more than twice as wide as the rest, half of that beside it is shown."""
    floor = {"name": "floor", "motion": "fixed", "at": [0, -0.05],
             "shapes": [{"type": "box", "size": [size, 0.1]}]}
    mechanism = Mechanism.model_validate({"bodies": [floor, body("a", [3, 0.05]),
                                                     body("b", [4, 0.05])]})
    pose = np.zeros((N, 3, 3))
    pose[:, :, :2] = [each.at for each in mechanism.bodies]
    box = body_box(recording(mechanism, TIME, pose))
    # the two discs are 1.1 m apart from side to side
    assert (box.x0, box.x1) == pytest.approx((2.95 - 0.55, 4.05 + 0.55))
    assert (box.y0, box.y1) == pytest.approx((-0.1, 0.1))


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
    assert anchored(free).tolist() == [True, False]
    assert anchored(tied).tolist() == [True, True]
    assert body_box(tied).x1 == pytest.approx(5.05)
    assert body_box(free).x1 < 0.5 + ROOM + 0.2


def test_what_is_let_go_no_longer_stays():
    mechanism = Mechanism.model_validate({
        "bodies": [FLOOR, body("ball", [0, 0.1])],
        "springs": [{"type": "linear", "name": "s", "a": "floor", "b": "ball", "stiffness": 1}],
        "events": [{"name": "cut", "at": 0.5, "release": "s"}]})
    for held, stays in ((1.0, True), (0.0, False)):
        run = recording(mechanism, TIME, np.zeros((N, 2, 3)), held=np.full((N, 1), held))
        assert anchored(run).tolist() == [True, stays]


def test_what_is_tied_together_is_a_group_and_the_ground_ties_nothing():
    pins = [{"type": "pin", "name": f"p{k}", "a": a, "b": b, "on_b": [0, 0]}
            for k, (a, b) in enumerate([("floor", "a"), ("a", "b"), ("floor", "c")])]
    run = world(*(body(name, [0, 0]) for name in "abcd"), joints=pins)
    groups = groups_of(run)
    assert groups[1] == groups[2]
    assert len({groups[k] for k in (0, 1, 3, 4)}) == 4
    assert anchored(run).tolist() == [True, True, True, True, False]


def test_where_nothing_stays_all_is_shown():
    boxes = np.zeros((3, 2, 4))
    boxes[2] = 1e6
    assert with_it(boxes, np.zeros(2, dtype=bool)).all()


def test_the_view_says_which_bodies_matter():
    ways = {"ball": np.stack((9 * TIME, 0 * TIME), axis=1)}
    found = {name: body_box(world(body("ball", [0, 0.1]), ways=ways, view={"bodies": [name]}))
             for name in ("ball", "floor", "*")}
    assert (found["ball"].x0, found["ball"].x1) == pytest.approx((-0.05, 9.05))
    assert found["floor"].width == pytest.approx(1.0)
    assert (found["*"].x0, found["*"].x1) == pytest.approx((-0.5, 9.05))


def test_a_picture_that_follows_a_body_keeps_it_where_it_is():
    """The ground passes: its right end is where the body's way says."""
    ways = {"ball": np.stack((9 * TIME, 0 * TIME), axis=1)}
    run = world(body("ball", [0, 0.1]), ways=ways, view={"follow": "ball", "width": 4.0})
    renderer = FrameRenderer(run, size=(400, 300))
    edges = []
    for t in (0.0, 0.1, 0.2):
        picture = renderer.draw(t).astype(int)
        floor, ball = renderer.camera.to_pixels(np.array([[0, -0.03], [0, 0.1]])).astype(int)
        seen = np.flatnonzero((picture[ball[1]] < 240).any(axis=1))
        assert (seen.min() + seen.max()) / 2 == pytest.approx(200, abs=2)
        edges.append(np.flatnonzero((picture[floor[1]] < 240).any(axis=1)).max())
    # 100 pixels a metre: the floor's right end passes by 90 pixels in a tenth of a second
    assert edges[0] - edges[1] == pytest.approx(90, abs=2)


def test_what_a_view_names_has_to_be_there():
    import sandbox

    run = world(body("ball", [0, 0.1]))
    for option, given in (("follow", "bal"), ("bodies", ["bal"]), ("show", {"axes": ["bal"]})):
        with pytest.raises(OutputError, match=rf"{option}: no body's name matches 'bal'; did you "
                                              r"mean 'ball'\? \(allowed: 'floor', 'ball'\)"):
            sandbox.render(run, "never.png", **{option: given})
    with pytest.raises(OutputError, match="no layer named 'trace'; did you mean 'traces'"):
        sandbox.render(run, "never.png", show="trace")


def test_to_follow_at_drawing_time_leaves_the_scenes_centre():
    view = world(body("ball", [0, 0]), view={"centre": [5, 5], "width": 2}).mechanism.view
    found = view_of(view, {"follow": "ball"})
    assert (found.centre, found.width) == (None, 2.0)
    assert view_of(view, {"follow": "ball", "centre": (1, 1)}).centre == (1.0, 1.0)
