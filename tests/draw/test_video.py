
import numpy as np
import pytest
from PIL import Image

from sandbox.errors import OutputError
from sandbox.picture import film as video
from sandbox.picture.film import GifWriter, render
from tests.draw.painted import frames_of

from .conftest import recording, zoo_mechanism

SMALL = (200, 150)


def test_frame_times_are_even_and_end_with_the_run(zoo_run):
    times = video.frame_times(zoo_run, fps=25, speed=1.0)
    assert times[:3] == [0.0, 0.04, 0.08]
    assert times[-1] == zoo_run.time[-1]
    assert len(times) == 26
    slow = video.frame_times(zoo_run, fps=50, speed=0.1, start=0.5)
    assert slow[1] - slow[0] == pytest.approx(0.002)
    assert slow[0] == 0.5


@pytest.mark.parametrize("fps", [20, 25, 50])
def test_gif_has_its_frames_and_durations(tmp_path, zoo_run, fps):
    render(zoo_run, tmp_path / "film.gif", size=SMALL, fps=fps)
    times = video.frame_times(zoo_run, fps=fps, speed=1.0)
    with Image.open(tmp_path / "film.gif") as film:
        assert film.size == SMALL
        assert film.n_frames == len(times)
        durations = []
        for k in range(film.n_frames):
            film.seek(k)
            durations.append(film.info["duration"])
    assert set(durations[:-1]) == {1000 // fps}
    assert durations[-1] == 1500
    assert [p.name for p in tmp_path.iterdir()] == ["film.gif"]


def test_gif_shows_the_frames(tmp_path, hand_run):
    render(hand_run, tmp_path / "film.gif", size=(400, 300), fps=20)
    renderer = frames_of(hand_run, size=(400, 300))
    times = video.frame_times(hand_run, fps=20, speed=1.0)
    with Image.open(tmp_path / "film.gif") as film:
        for k in (0, 13, 27, len(times) - 1):
            film.seek(k)
            shown = np.asarray(film.convert("RGB")).astype(int)
            apart = np.abs(shown - renderer.draw(times[k]))
            # 255 colours: flat ones are exact, edges come close
            assert apart.mean() < 0.5
            assert (apart.max(axis=2) > 40).mean() < 0.005


def test_frames_go_into_a_directory_and_replace_older_ones(tmp_path, zoo_run):
    folder = tmp_path / "frames"
    folder.mkdir()
    (folder / "frame_99999.png").write_bytes(b"old")
    (folder / "notes.txt").write_text("mine")
    shares = []
    render(zoo_run, folder, size=SMALL, fps=20, progress=shares.append)
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
        render(zoo_run, tmp_path / "wall" / name, size=SMALL)


def test_a_full_disk_leaves_the_old_film(tmp_path, zoo_run, monkeypatch):
    path = tmp_path / "film.gif"
    path.write_bytes(b"old")

    def full(self, frame, hundredths):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(GifWriter, "add", full)
    with pytest.raises(OutputError, match="No space left"):
        render(zoo_run, path, size=SMALL)
    assert path.read_bytes() == b"old"
    assert [p.name for p in tmp_path.iterdir()] == ["film.gif"]


def test_an_empty_run_is_refused(tmp_path):
    mechanism = zoo_mechanism()
    run = recording(mechanism, np.zeros(0), np.zeros((0, len(mechanism.bodies), 3)))
    with pytest.raises(OutputError, match="no samples"):
        render(run, tmp_path / "x.gif")


def test_a_film_has_no_more_frames_than_allowed(tmp_path, zoo_run):
    """However long a recording says that it is."""
    for path in (tmp_path / "film.gif", tmp_path / "frames"):
        with pytest.raises(OutputError, match=r"24.8 frames.*at most 20 .*--limit frames"):
            render(zoo_run, path, size=SMALL, fps=25, most_frames=20)
        render(zoo_run, path, size=(64, 64), fps=25, most_frames=30)
    long = recording(zoo_run.mechanism, zoo_run.time * 1e9, zoo_run.arrays["body_pose"])
    with pytest.raises(OutputError, match=r"would have 2.48e\+10 frames"):
        render(long, tmp_path / "long.gif")
