import os
from pathlib import Path

import numpy as np
import pygame
import pytest
from PIL import Image

import sandbox
from sandbox.picture.frame import Picture
from sandbox.picture.frames import Frames
from sandbox.picture.palette import FORCE
from sandbox.picture.paper import paint_picture, pixels
from sandbox.scene.mechanism import Mechanism
from tests.draw.painted import frames_of

from .conftest import recording

GOLDEN = Path(__file__).parent / "golden"
SMALL = (320, 240)


@pytest.mark.parametrize("painter", ["film", "paper"])
@pytest.mark.parametrize(("name", "t"), [
    ("hand", 2.0), ("zoo", 0.3), ("finger", 2.0), ("four_bar", 0.1), ("hydraulic_lift", 0.1),
    ("capstan", 0.1)])
def test_golden_pictures(name, t, painter, request):
    """Pictures stay as they were looked at; fonts may differ by their smoothing."""
    run = request.getfixturevalue(f"{name}_run") if t != 0.1 else sandbox.simulate(
        sandbox.load_scene(name, overrides={"run.duration": 0.1}))
    made = Picture(run, size=SMALL)
    picture = Frames(made).draw(t) if painter == "film" else pixels(
        made.size, made.type, lambda paper: paint_picture(made, paper, t))
    path = GOLDEN / f"{name}_{painter}.png"
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


@pytest.mark.parametrize("newton", [1.0, 3.0])
def test_arrows_are_drawn_to_scale(newton):
    run = one_arrow([newton, 0.0], force_scale=0.05)
    renderer = frames_of(run)
    origin = renderer.picture.camera.to_pixels(np.zeros(2))
    row = round(float(origin[1]))
    left, right, _, _ = extent(renderer.draw(0.1)[row - 2:row + 3], FORCE)
    # 1 N is 0.05 m is 40 pixels; both ends fall on pixels, the point is thin
    assert right - left == pytest.approx(40 * newton, abs=2.5)
    assert left == pytest.approx(origin[0], abs=1.5)


def test_forces_are_of_the_nearest_sample():
    renderer = frames_of(one_arrow([2.0, 0.0], force_scale=0.05))
    assert not (renderer.draw(0.04)[40:500] == FORCE).all(axis=2).any()
    assert (renderer.draw(0.06)[40:500] == FORCE).all(axis=2).any()
    assert (renderer.draw(0.14)[40:500] == FORCE).all(axis=2).any()
    assert not (renderer.draw(0.16)[40:500] == FORCE).all(axis=2).any()


def test_a_picture_does_not_depend_on_those_before(hand_run):
    used = frames_of(hand_run, size=SMALL)
    for t in (0.0, 2.0, 0.3, 1.3):
        used.draw(t)
    fresh = frames_of(hand_run, size=SMALL)
    assert (used.draw(0.8) == fresh.draw(0.8)).all()


def test_only_touched_cells_are_redrawn_and_nothing_is_missed(zoo_run):
    """Scaling the whole enlarged picture down gives the frame that cells were pieced into."""
    renderer = frames_of(zoo_run, size=(400, 300))
    picture = renderer.draw(0.4).astype(int)
    scaled = pygame.transform.smoothscale(renderer.painter.large, (400, 300))
    whole = pygame.surfarray.array3d(scaled).transpose(1, 0, 2).astype(int)
    covered = np.zeros((300, 400), bool)
    for rect in renderer._written:
        covered[rect.top:rect.bottom, rect.left:rect.right] = True
    stage = renderer._stage
    apart = np.abs(picture - whole).max(axis=2)
    apart[covered] = 0
    assert apart[stage.top:stage.bottom].max() <= 1


@pytest.mark.parametrize("size", [(64, 64), (64, 400), (900, 70), (1600, 1200)])
def test_any_size_has_a_picture(size, finger_run):
    assert frames_of(finger_run, size=size).draw(1.0).shape == (*size[::-1], 3)


def test_an_empty_scene_has_a_picture():
    mechanism = Mechanism(name="empty")
    run = recording(mechanism, np.array([0.0]), np.zeros((1, 0, 3)))
    assert frames_of(run, size=SMALL).draw(0.0).shape == (240, 320, 3)
