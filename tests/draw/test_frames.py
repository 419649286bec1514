"""Frames of films, and the files that they are written to."""

import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import sandbox
from sandbox.errors import OutputError
from sandbox.picture import film as video
from sandbox.picture.film import render
from sandbox.picture.frame import Picture
from sandbox.picture.frames import Frames
from sandbox.picture.palette import TOKENS
from sandbox.picture.paper import pixels
from sandbox.scene.mechanism import Mechanism

from .conftest import frames_of, recording, zoo_mechanism

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
    picture = Frames(made).draw(t) if painter == "film" else pixels(made, t)
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
    left, right, _, _ = extent(renderer.draw(0.1)[row - 2:row + 3], TOKENS["force"][0])
    # 1 N is 0.05 m is 40 pixels; both ends fall on pixels, the point is thin
    assert right - left == pytest.approx(40 * newton, abs=2.5)
    assert left == pytest.approx(origin[0], abs=1.5)


def test_forces_are_of_the_nearest_sample():
    renderer = frames_of(one_arrow([2.0, 0.0], force_scale=0.05))
    assert not (renderer.draw(0.04)[40:500] == TOKENS["force"][0]).all(axis=2).any()
    assert (renderer.draw(0.06)[40:500] == TOKENS["force"][0]).all(axis=2).any()
    assert (renderer.draw(0.14)[40:500] == TOKENS["force"][0]).all(axis=2).any()
    assert not (renderer.draw(0.16)[40:500] == TOKENS["force"][0]).all(axis=2).any()


def test_a_picture_does_not_depend_on_those_before(hand_run):
    used = frames_of(hand_run, size=SMALL)
    for t in (0.0, 2.0, 0.3, 1.3):
        used.draw(t)
    fresh = frames_of(hand_run, size=SMALL)
    assert (used.draw(0.8) == fresh.draw(0.8)).all()


@pytest.mark.parametrize("size", [(64, 400), (900, 70)])
def test_any_size_has_a_picture(size, finger_run):
    assert frames_of(finger_run, size=size).draw(1.0).shape == (*size[::-1], 3)


def test_an_empty_scene_has_a_picture():
    mechanism = Mechanism(name="empty")
    run = recording(mechanism, np.array([0.0]), np.zeros((1, 0, 3)))
    assert frames_of(run, size=SMALL).draw(0.0).shape == (240, 320, 3)


FILM = (200, 150)


def test_frame_times_are_even_and_end_with_the_run(zoo_run):
    times = video.frame_times(zoo_run, fps=25, speed=1.0)
    assert times[:3] == [0.0, 0.04, 0.08]
    assert times[-1] == zoo_run.time[-1]
    assert len(times) == 26
    slow = video.frame_times(zoo_run, fps=50, speed=0.1, start=0.5)
    assert slow[1] - slow[0] == pytest.approx(0.002)
    assert slow[0] == 0.5


def test_gif_shows_the_frames_for_their_durations(tmp_path, hand_run):
    render(hand_run, tmp_path / "film.gif", size=(400, 300), fps=20)
    renderer = frames_of(hand_run, size=(400, 300))
    times = video.frame_times(hand_run, fps=20, speed=1.0)
    durations = []
    with Image.open(tmp_path / "film.gif") as film:
        assert (film.size, film.n_frames) == ((400, 300), len(times))
        for k in range(film.n_frames):
            film.seek(k)
            durations.append(film.info["duration"])
            if k in (0, 13, len(times) - 1):
                shown = np.asarray(film.convert("RGB")).astype(int)
                apart = np.abs(shown - renderer.draw(times[k]))
                # 255 colours: flat ones are exact, edges come close
                assert apart.mean() < 0.5
                assert (apart.max(axis=2) > 40).mean() < 0.005
    assert durations == [50] * (len(times) - 1) + [1500]
    assert [p.name for p in tmp_path.iterdir()] == ["film.gif"]


def test_frames_go_into_a_directory_and_replace_older_ones(tmp_path, zoo_run):
    folder = tmp_path / "frames"
    folder.mkdir()
    (folder / "frame_99999.png").write_bytes(b"old")
    (folder / "notes.txt").write_text("mine")
    shares = []
    render(zoo_run, folder, size=FILM, fps=20, progress=shares.append)
    names = sorted(p.name for p in folder.iterdir())
    assert names[:2] == ["frame_00000.png", "frame_00001.png"]
    assert names[-1] == "notes.txt"
    assert len(names) == 21 + 1
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_mp4_has_its_frames(tmp_path, zoo_run):
    iio = pytest.importorskip("imageio.v3")
    pytest.importorskip("av")
    render(zoo_run, tmp_path / "film.mp4", size=(201, 151), fps=20)
    frames = iio.imread(tmp_path / "film.mp4", plugin="pyav")
    assert frames.shape == (21, 150, 200, 3)
    fresh = frames_of(zoo_run, size=(200, 150)).draw(zoo_run.time[-1])
    assert np.abs(frames[-1].astype(int) - fresh).mean() < 6


@pytest.mark.parametrize("name", ["film.gif", "still.png", "frames"])
def test_a_place_that_cannot_be_written(tmp_path, zoo_run, name):
    (tmp_path / "wall").write_text("a file, not a directory")
    with pytest.raises(OutputError, match="cannot write"):
        render(zoo_run, tmp_path / "wall" / name, size=FILM)


def test_an_empty_run_is_refused(tmp_path):
    mechanism = zoo_mechanism()
    run = recording(mechanism, np.zeros(0), np.zeros((0, len(mechanism.bodies), 3)))
    with pytest.raises(OutputError, match="no samples"):
        render(run, tmp_path / "x.gif")


def test_a_film_has_no_more_frames_than_allowed(tmp_path, zoo_run):
    """However long a recording says that it is."""
    for path in (tmp_path / "film.gif", tmp_path / "frames"):
        with pytest.raises(OutputError, match=r"24.8 frames.*at most 20 .*--limit frames"):
            render(zoo_run, path, size=FILM, fps=25, most_frames=20)
        render(zoo_run, path, size=(64, 64), fps=25, most_frames=30)
    long = recording(zoo_run.mechanism, zoo_run.time * 1e9, zoo_run.arrays["body_pose"])
    with pytest.raises(OutputError, match=r"would have 2.48e\+10 frames"):
        render(long, tmp_path / "long.gif")
