from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sandbox.draw.film.palette import INK, ROLES
from sandbox.draw.film.side_by_side import Mark, draw_ends
from sandbox.errors import OutputError
from sandbox.scene.mechanism import Mechanism

from .conftest import hand, recording

DISC = np.array(ROLES["object"].fill)


def discs(*places: tuple[float, float], radius: float = 0.01):
    """Fixed discs, at rest."""
    mechanism = Mechanism.model_validate({"name": "discs", "bodies": [
        {"name": f"disc{k}", "motion": "fixed", "role": "object", "at": list(at),
         "shapes": [{"type": "circle", "radius": radius}]} for k, at in enumerate(places)]})
    pose = np.zeros((2, len(places), 3))
    pose[:, :, :2] = places
    return recording(mechanism, np.array([0.0, 0.1]), pose)


def drawn(recordings, path, *, labels=None, marks=None, **how) -> np.ndarray:
    count = len(recordings)
    draw_ends(recordings, labels or [""] * count, marks or [{}] * count, path, **how)
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def extent(picture: np.ndarray, colour: np.ndarray) -> tuple[int, int, int, int]:
    """First and last column and row that show ``colour``."""
    rows, columns = np.nonzero(np.abs(picture - colour).max(axis=2) < 12)
    return columns.min(), columns.max(), rows.min(), rows.max()


def test_one_scale_and_one_place(tmp_path: Path):
    """A disc of 10 mm alone, and the same disc with another 0.3 m away: drawn alike in both."""
    runs = [discs((0.0, 0.0)), discs((0.0, 0.0), (0.3, -0.1))]
    picture = drawn(runs, tmp_path / "out.png", width=1200)
    high = 210  # above the legend, whose "fixed" has the colour of what is fixed here
    left, right = picture[:high, :600], picture[:high, 600:]
    alone = extent(left, DISC)
    first = extent(right[:, :300], DISC)
    assert first == alone
    # 320 mm of discs fill 92 % of a panel of 600 pixels: 20 mm are 34.5 pixels, less the outline
    wide = alone[1] - alone[0] + 1
    assert 0.02 * 0.92 * 600 / 0.32 - 6 < wide <= 0.02 * 0.92 * 600 / 0.32


@pytest.fixture(scope="module")
def four_fingers():
    return hand()


def test_labels_note_and_key_are_written(tmp_path: Path, four_fingers):
    bare = drawn([four_fingers, four_fingers], tmp_path / "a.png")
    full = drawn([four_fingers, four_fingers], tmp_path / "b.png", labels=["left", "right"],
                 note="the same pull", key=[(Mark("L"), "700 N/m")])
    assert full.shape[0] > bare.shape[0]
    high = bare.shape[0] - 140
    assert (full[:high] == bare[:high]).all(), "words are below the drawings"
    dark = [[(np.abs(half - INK).max(axis=2) < 40).sum() for half in np.split(p[high:], 2, axis=1)]
            for p in (bare, full)]
    assert (np.subtract(dark[1], dark[0]) > 40).all(), "a bold word of four or five letters"


def test_bad_input(tmp_path: Path, four_fingers):
    path = tmp_path / "out.png"
    with pytest.raises(ValueError, match="at least one"):
        draw_ends([], [], [], path)
    with pytest.raises(ValueError, match="2 recordings need as many labels"):
        draw_ends([four_fingers] * 2, ["one"], [{}, {}], path)
    with pytest.raises(ValueError, match="not there: nothing"):
        draw_ends([four_fingers], ["one"], [{"nothing": Mark("L")}], path)
    with pytest.raises(OutputError, match="no samples"):
        draw_ends([_empty(four_fingers)], ["one"], [{}], path)
    assert not path.exists()


def _empty(run):
    """A recording that was stopped before its first sample."""
    return recording(run.mechanism, np.zeros(0), np.zeros((0, len(run.mechanism.bodies), 3)))
