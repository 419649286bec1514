import itertools
import os
from pathlib import Path

import numpy as np
import pygame
import pytest
from PIL import Image

import sandbox
from sandbox.draw.film.canvas import Label, spots_at
from sandbox.draw.film.forces import ContactDrawer
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.labels import place_label
from sandbox.draw.film.palette import FORCE, PUSH, STOP, TENSION, tension_colour
from sandbox.draw.film.scales import ForceScale, force_scale, number
from sandbox.draw.film.sheet import Text
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

from .conftest import hand, recording, zoo

GOLDEN = Path(__file__).parent / "golden"
SMALL = (320, 240)


@pytest.mark.parametrize(("name", "t"), [("hand", 0.0), ("hand", 0.7), ("hand", 2.0),
                                         ("zoo", 0.3), ("finger", 2.0)])
def test_golden_pictures(name, t, hand_run, zoo_run, finger_run):
    """Pictures stay as they were looked at; fonts may differ by their smoothing."""
    run = {"hand": hand_run, "zoo": zoo_run, "finger": finger_run}[name]
    picture = FrameRenderer(run, size=SMALL).draw(t)
    path = GOLDEN / f"{name}_{t:g}.png"
    if os.environ.get("SANDBOX_UPDATE_GOLDEN") == "1":
        GOLDEN.mkdir(exist_ok=True)
        Image.fromarray(np.ascontiguousarray(picture)).save(path)
    golden = np.asarray(Image.open(path).convert("RGB")).astype(int)
    apart = np.abs(picture - golden)
    # measured: one arrow less of twelve changes the mean by 0.063 and 0.063 % of the pixels,
    # tension colours for a scale 20 % off the mean by 0.073
    assert apart.mean() < 0.06
    assert (apart.max(axis=2) > 48).mean() < 0.0006


def one_arrow(force, **view):
    """A disc with one contact force at the origin, and another far away to fix the view."""
    mechanism = Mechanism.model_validate({
        "name": "arrow", "bodies": [
            {"name": "disc", "mass": 1, "at": [0, 0.3],
             "shapes": [{"type": "circle", "radius": 0.01}]},
            {"name": "floor", "motion": "fixed", "at": [0, -0.3],
             "shapes": [{"type": "circle", "radius": 0.01}]}],
        "view": {"centre": [0, 0], "width": 1.0, "size": [800, 600], **view}})
    pose = np.zeros((3, 2, 3))
    pose[:, 0, 1], pose[:, 1, 1] = 0.3, -0.3
    return recording(
        mechanism, np.array([0.0, 0.1, 0.2]), pose,
        contact_sample=np.array([1]), contact_body=np.array([0]), contact_other=np.array([1]),
        contact_point=np.zeros((1, 2)), contact_force=np.array([force]),
        contact_normal=np.array([[1.0, 0.0]]), contact_gap=np.zeros(1))


def extent(picture, colour):
    """First and last column and row that show ``colour``."""
    rows, columns = np.nonzero(np.abs(picture.astype(int) - colour).max(axis=2) < 60)
    return columns.min(), columns.max(), rows.min(), rows.max()


@pytest.mark.parametrize("newton", [1.0, 2.0, 3.0])
def test_arrows_are_drawn_to_scale(newton):
    run = one_arrow([newton, 0.0], force_scale=0.05)
    renderer = FrameRenderer(run)
    renderer._type.render = lambda text, **kw: pygame_blank()
    picture = renderer.draw(0.1)[40:500]
    left, right, _, _ = extent(picture, FORCE)
    # 1 N is 0.05 m is 40 pixels; both ends fall on pixels, the point is thin
    assert right - left == pytest.approx(40 * newton, abs=2.5)
    origin = renderer.camera.to_pixels(np.zeros(2))
    assert left == pytest.approx(origin[0], abs=1.5)


def pygame_blank():
    return pygame.Surface((1, 1), pygame.SRCALPHA, 32)


def test_arrows_point_along_the_force():
    renderer = FrameRenderer(one_arrow([0.0, 2.0], force_scale=0.05))
    renderer._type.render = lambda text, **kw: pygame_blank()
    _, _, top, bottom = extent(renderer.draw(0.1)[40:500, 380:420], FORCE)
    assert bottom - top > 60
    assert bottom + 40 == pytest.approx(renderer.camera.to_pixels(np.zeros(2))[1], abs=1.5)


def test_forces_are_of_the_nearest_sample():
    renderer = FrameRenderer(one_arrow([2.0, 0.0], force_scale=0.05))
    assert not (renderer.draw(0.04)[40:500] == FORCE).all(axis=2).any()
    assert (renderer.draw(0.06)[40:500] == FORCE).all(axis=2).any()
    assert (renderer.draw(0.14)[40:500] == FORCE).all(axis=2).any()
    assert not (renderer.draw(0.16)[40:500] == FORCE).all(axis=2).any()


def test_a_jerk_does_not_shrink_every_arrow():
    n = 400
    force = np.tile([2.0, 0.0], (n, 1))
    force[5] = [500.0, 0.0]
    run = recording(
        one_arrow([1, 0]).mechanism, np.arange(n) * 1e-3, np.zeros((n, 2, 3)),
        contact_sample=np.arange(n), contact_body=np.zeros(n, int),
        contact_other=np.ones(n, int), contact_force=force, contact_point=np.zeros((n, 2)),
        contact_normal=np.tile([1.0, 0.0], (n, 1)), contact_gap=np.zeros(n))
    scale = force_scale(run, 1.0)
    assert scale.reference == 2.0
    assert scale.metres == pytest.approx(0.085 / 2)
    _, tips, sizes = ContactDrawer(run, scale).arrows(5)
    assert sizes.tolist() == [500.0]
    assert tips[0, 0] == pytest.approx(1.5 * 0.085)


def test_where_there_are_only_blows_they_give_the_scale():
    """What rounding leaves between balls that touch without a force is none."""
    n = 400
    force = np.tile([5e-13, 0.0], (n, 1))
    force[5] = [500.0, 0.0]
    run = recording(
        one_arrow([1, 0]).mechanism, np.arange(n) * 1e-3, np.zeros((n, 2, 3)),
        contact_sample=np.arange(n), contact_body=np.zeros(n, int),
        contact_other=np.ones(n, int), contact_force=force, contact_point=np.zeros((n, 2)),
        contact_normal=np.tile([1.0, 0.0], (n, 1)), contact_gap=np.zeros(n))
    assert force_scale(run, 1.0).reference == 500.0


def test_what_flies_off_a_view_of_a_given_width_makes_no_arrow_longer():
    """1 N over 85 mm of a view 1 m wide, at t = 0, wherever the other body goes."""
    lengths = []
    for way in (2.0, 10.0, 100.0):
        pose = np.zeros((11, 2, 3))
        pose[:, 1, 1] = -way * np.linspace(0, 1, 11)
        given = one_arrow([1.0, 0.0])
        contacts = {key: value for key, value in given.arrays.items() if "contact" in key}
        run = recording(given.mechanism, np.linspace(0, 0.2, 11), pose, **contacts)
        renderer = FrameRenderer(run)
        renderer._type.render = lambda text, **kw: pygame_blank()
        left, right, _, _ = extent(renderer.draw(0.02)[40:500], FORCE)
        lengths.append(right - left)
    assert lengths == pytest.approx([0.085 * 800] * 3, abs=2.5)


def test_largest_forces_come_first():
    run = recording(
        one_arrow([1, 0]).mechanism, np.arange(3.0), np.zeros((3, 2, 3)),
        contact_sample=np.array([1, 1, 2]), contact_body=np.zeros(3, int),
        contact_other=np.ones(3, int), contact_point=np.zeros((3, 2)),
        contact_force=np.array([[1.0, 0], [0, 3.0], [9.0, 0]]),
        contact_normal=np.tile([1.0, 0.0], (3, 1)), contact_gap=np.zeros(3))
    assert ContactDrawer(run, ForceScale(0.1, 10.0)).arrows(1)[2].tolist() == [3.0, 1.0]


def test_poses_between_samples_are_interpolated():
    run = zoo(samples=11)
    renderer = FrameRenderer(run, size=SMALL)
    time, poses = run.time, run.arrays["body_pose"]
    moment = renderer._moment(renderer._pool, 0.25 * time[3] + 0.75 * time[4])
    assert moment.pose == pytest.approx(0.25 * poses[3] + 0.75 * poses[4])
    assert moment.sample == 4
    before, after = (renderer._moment(renderer._pool, t) for t in (-1.0, 99.0))
    assert (before.pose == poses[0]).all()
    assert (after.pose == poses[-1]).all()


def test_a_picture_does_not_depend_on_those_before(hand_run):
    used = FrameRenderer(hand_run, size=SMALL)
    for t in (0.0, 2.0, 0.3, 1.3):
        used.draw(t)
    fresh = FrameRenderer(hand_run, size=SMALL)
    assert (used.draw(0.8) == fresh.draw(0.8)).all()


@pytest.mark.parametrize(("t", "alike"), [(1.1, False), (1.3, False), (1.5, True), (1.9, True)])
def test_numbers_of_a_film_look_for_clear_ground_while_nothing_moves(t, alike):
    """The hand is held from 1.2 s on: 0.2 s later numbers stand where those of a still do."""
    moving = hand()
    poses = moving.arrays["body_pose"].copy()
    poses[moving.time >= 1.2] = poses[moving.time >= 1.2][0]
    run = Recording(moving.mechanism, dict(moving.arrays) | {"body_pose": poses}, moving.info)
    film, still = FrameRenderer(run, bare=True), FrameRenderer(run, bare=True, moments=[t])
    places = [[(word.face.text, word.at) for word in renderer.sheet(t).words
               if isinstance(word, Text) and word.face.text.endswith(" N")]
              for renderer in (film, still)]
    assert len(places[0]) > 6
    assert (places[0] == places[1]) is alike
    assert np.array_equal(film.draw(t), film.sheet(t).painted())


def test_only_touched_cells_are_redrawn_and_nothing_is_missed(zoo_run):
    """Scaling the whole enlarged picture down gives the frame that cells were pieced into."""
    renderer = FrameRenderer(zoo_run, size=(400, 300))
    picture = renderer.draw(0.4).astype(int)
    whole = pygame.surfarray.array3d(
        pygame.transform.smoothscale(renderer._large, (400, 300))).transpose(1, 0, 2).astype(int)
    covered = np.zeros((300, 400), bool)
    for rect in renderer._written:
        covered[rect.top:rect.bottom, rect.left:rect.right] = True
    stage = renderer._stage
    apart = np.abs(picture - whole).max(axis=2)
    apart[covered] = 0
    assert apart[stage.top:stage.bottom].max() <= 1


def test_everything_lies_on_the_stage(hand_run):
    renderer = FrameRenderer(hand_run, size=(400, 300))
    for t in (0.0, 1.0, 2.0):
        pixels = renderer._moment(renderer._pool, t).pixels / renderer.enlarged
        assert pixels.min(axis=0) == pytest.approx([200, 150], abs=200)
        assert (pixels[:, 1] > renderer._stage.top).all()
        assert (pixels[:, 1] < renderer._stage.bottom).all()


def test_stop_shows_only_when_it_acts(finger_run):
    renderer = FrameRenderer(finger_run)
    stage = slice(40, 540)
    assert not (renderer.draw(1.0)[stage] == STOP).all(axis=2).any()
    assert (renderer.draw(1.5)[stage] == STOP).all(axis=2).any()


def test_tension_is_told_by_colour(finger_run):
    renderer = FrameRenderer(finger_run)
    top = renderer._carried.largest
    assert top == 4.0
    assert (renderer.draw(2.0)[40:540] == tension_colour(3.75 / top)).all(axis=2).sum() > 50


@pytest.mark.parametrize("ramp", [TENSION, PUSH])
def test_tension_ramps_darken_all_along(ramp):
    light = [0.2126 * r + 0.7152 * g + 0.0722 * b for r, g, b in ramp]
    assert all(b < a + 6 for a, b in itertools.pairwise(light))
    assert light[-1] < light[0] - 80


def test_what_pushes_has_colours_of_its_own():
    assert tension_colour(-1) == tension_colour(-3) == PUSH[-1]
    assert tension_colour(7) == TENSION[-1]
    assert TENSION[0] == PUSH[0] == tension_colour(0)
    run = sandbox.simulate(sandbox.load_scene("truss"))
    renderer = FrameRenderer(run)
    picture = renderer.draw(0.5)[40:340]
    top = renderer._carried.largest
    for bar, tension in (("roof1", -1440.0), ("floor2", 1200.0)):
        assert run[f"{bar}.tension"][-1] == pytest.approx(tension, rel=1e-3)
        assert (picture == tension_colour(tension / top)).all(axis=2).sum() > 50
    assert renderer.tension_colours == TENSION + PUSH


def test_links_without_a_load_are_white():
    """Without gravity and load nothing but rounding is left, which makes no scale."""
    run = sandbox.simulate(sandbox.load_scene("truss", overrides={
        "parameters.load": 0, "gravity": [0, 0]}))
    renderer = FrameRenderer(run)
    assert renderer._carried.largest == 0.0
    assert not renderer._carried.pushes
    words = {item.before for row in renderer._legend for item in row}
    assert not any(word.startswith(("pushes", "tension")) for word in words)


@pytest.mark.parametrize("size", [(64, 64), (64, 400), (900, 70), (1600, 1200)])
def test_any_size_has_a_picture(size, finger_run):
    assert FrameRenderer(finger_run, size=size).draw(1.0).shape == (*size[::-1], 3)


def test_an_empty_scene_has_a_picture():
    mechanism = Mechanism(name="empty")
    run = recording(mechanism, np.array([0.0]), np.zeros((1, 0, 3)))
    assert FrameRenderer(run, size=SMALL).draw(0.0).shape == (240, 320, 3)


def test_a_view_beside_everything_is_blank_but_has_its_title():
    run = hand(fingers=1, samples=11, centre=[50.0, 50.0], width=0.1, size=[400, 300])
    picture = FrameRenderer(run).draw(1.0)
    assert (picture[40:250] == 255).all()
    assert (picture[:30] != 255).any()


def test_labels_take_the_first_free_place():
    stage = pygame.Rect(0, 0, 100, 100)
    label = Label("x", spots_at((5, 5), (50, 50), (50, 80)))
    assert place_label(label, (20, 10), stage, []).center == (50, 50)
    taken = [pygame.Rect(45, 45, 5, 5)]
    assert place_label(label, (20, 10), stage, taken).center == (50, 80)
    full = [stage]
    assert place_label(label, (20, 10), stage, full) is None
    required = Label("x", spots_at((5, 5)), required=True)
    assert place_label(required, (20, 10), stage, full).topleft == (0, 0)


@pytest.mark.parametrize(("value", "reference", "text"), [
    (0.5839, 1.0, "0.58"), (15.0, 15.0, "15.0"), (151.2, 400.0, "151"),
    (0.0123, 0.05, "0.012"), (0.00021, 0.0004, "0.00021"), (0.0, 0.0, "0.00")])
def test_numbers_have_the_decimals_of_their_scale(value, reference, text):
    assert number(value, reference) == text
