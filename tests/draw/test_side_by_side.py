from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sandbox.draw.film.palette import INK, ROLES
from sandbox.draw.film.side_by_side import Mark, common_box, draw_ends
from sandbox.errors import OutputError
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

from .conftest import hand, recording, zoo

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


def test_common_box_holds_every_run():
    box = common_box([discs((0.0, 0.0)), discs((0.5, 0.2)), discs((-0.1, 0.1), radius=0.05)])
    assert (box.x0, box.y0, box.x1, box.y1) == pytest.approx((-0.15, -0.01, 0.51, 0.21))


@pytest.fixture(scope="module")
def four_fingers():
    return hand()


def test_a_sign_finds_its_hinge_however_it_is_written(tmp_path: Path):
    """The hinge's place on either body is the same place."""
    pictures = []
    for place in ({"on_a": [0.05, 0]}, {"on_b": [-0.05, 0]}):
        mechanism = Mechanism.model_validate({
            "name": "arm", "bodies": [
                {"name": "wall", "motion": "fixed", "shapes": [
                    {"type": "box", "size": [0.02, 0.1]}]},
                {"name": "arm", "mass": 0.1, "at": [0.1, 0], "shapes": [
                    {"type": "box", "size": [0.1, 0.01]}]}],
            "joints": [{"type": "pin", "name": "p", "a": "wall", "b": "arm", **place}],
            "springs": [{"type": "rotary", "name": "s", "joint": "p", "stiffness": 0.1}]})
        run = recording(mechanism, np.array([0.0, 0.1]), np.array([[[0, 0, 0], [0.1, 0, 0]]] * 2))
        pictures.append(drawn([run], tmp_path / "out.png", marks=[{"s": Mark("L", strong=True)}]))
    np.testing.assert_array_equal(*pictures)


def test_signs_lie_on_blank_ground_beside_their_springs(tmp_path: Path, four_fingers):
    """Of a hand without names and contacts in the way, no line is covered by a sign."""
    springs = [s.name for s in four_fingers.mechanism.springs]
    marks = {name: Mark("I", strong=True) for name in springs[:6]}
    plain = drawn([four_fingers], tmp_path / "plain.png")
    signed = drawn([four_fingers], tmp_path / "signed.png", marks=[marks])
    changed = (plain != signed).any(axis=2)
    assert (plain[changed].min(axis=1) > 240).all()
    # discs of the same size, not one upon another
    dark = changed & (np.abs(signed - INK).max(axis=2) < 12)
    one = changed & drawn_change(tmp_path, four_fingers, springs[0], plain)
    assert changed.sum() == pytest.approx(6 * one.sum(), rel=0.01)
    assert dark.sum() > 0.6 * changed.sum()


def drawn_change(tmp_path: Path, run, spring: str, plain: np.ndarray) -> np.ndarray:
    signed = drawn([run], tmp_path / "one.png", marks=[{spring: Mark("I", strong=True)}])
    return (signed != plain).any(axis=2)


def test_a_sign_is_near_its_spring(tmp_path: Path):
    """A spring far from everything, with no hinge: the sign lies within its reach."""
    mechanism = Mechanism.model_validate({
        "name": "spring", "bodies": [
            {"name": "disc", "motion": "fixed", "at": [0, 0],
             "shapes": [{"type": "circle", "radius": 0.01}]},
            {"name": "other", "motion": "fixed", "at": [0.4, 0.2],
             "shapes": [{"type": "circle", "radius": 0.01}]}],
        "springs": [{"type": "linear", "name": "coil", "a": "disc", "b": "other",
                     "stiffness": 100}]})
    pose = np.zeros((2, 2, 3))
    pose[:, 1, :2] = 0.4, 0.2
    run = recording(mechanism, np.array([0.0, 0.1]), pose)
    plain = drawn([run], tmp_path / "a.png", width=800)
    signed = drawn([run], tmp_path / "b.png", width=800, marks=[{"coil": Mark("L")}])
    rows, columns = np.nonzero((plain != signed).any(axis=2))
    # the coil's middle is the panel's: 800 pixels show 0.42 m / 0.92, as high as 0.22 m / 0.42 m
    middle = np.array([400.0, 800 * 0.22 / 0.42 / 2])
    away = np.hypot(*(np.array([columns.mean(), rows.mean()]) - middle))
    size = columns.max() - columns.min() + 1
    assert 0.9 * size < away < 3 * size


def test_springs_of_every_kind_take_a_sign(tmp_path: Path):
    run = zoo()
    plain = drawn([run], tmp_path / "a.png")
    for name in ("coil", "clock"):
        signed = drawn([run], tmp_path / "b.png", marks=[{name: Mark("L")}])
        assert (plain != signed).any()


def test_what_is_compared_has_one_scale_and_one_legend(tmp_path: Path):
    """A tension, a force and a pull have one look in both: that of the scale of the larger ones."""
    one = hand()
    larger = {name: 3 * one.arrays[name] for name in (
        "tendon_tension", "contact_force", "drive_value")}
    other = Recording(one.mechanism, {**one.arrays, **larger}, one.info)
    small, large, mixed, turned = (drawn(runs, tmp_path / "a.png") for runs in (
        [one, one], [other, other], [one, other], [other, one]))
    half = mixed.shape[1] // 2
    high = mixed.shape[0] - 140
    assert (mixed[:high, half:] == large[:high, half:]).all()
    assert (mixed[-140:] == large[-140:]).all(), "the legend is that of the larger ones"
    assert (mixed[:high, :half] != small[:high, :half]).any(), "the smaller ones are paler"
    assert (turned[:high, :half] == large[:high, :half]).all()


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


def test_in_one_column_words_are_as_large_as_in_a_picture_of_one(tmp_path: Path, four_fingers):
    """Each drawing, and a legend that is the same of both, is what one run alone has."""
    said = {"labels": ["hand"], "width": 500, "columns": 1}
    one = drawn([four_fingers], tmp_path / "a.png", **said)
    two = drawn([four_fingers] * 2, tmp_path / "b.png", **said | {"labels": ["hand", "hand"]})
    wide = drawn([four_fingers] * 2, tmp_path / "c.png", **said | {"labels": ["hand", "hand"],
                                                                   "columns": 2})
    assert one.shape[1] == two.shape[1] == wide.shape[1] == 500
    drawing = two.shape[0] - one.shape[0]  # with the row of its label
    assert (two[:drawing] == one[:drawing]).all()
    assert (two[drawing:] == one).all()
    assert wide.shape[0] < one.shape[0]
    high = wide.shape[0] // 2
    assert (wide[:high, 5:250] == wide[:high, 255:]).all(), "the same hand beside it"


def test_words_may_be_larger_in_the_same_panes(tmp_path: Path, four_fingers):
    said = {"labels": ["", ""], "width": 640, "columns": 2}
    usual = drawn([four_fingers] * 2, tmp_path / "a.png", **said)
    large = drawn([four_fingers] * 2, tmp_path / "b.png", **said, words=2.0)
    assert large.shape[0] > usual.shape[0], "rows of labels and legend are higher"


def test_signs_and_a_note_that_do_not_fit_beside_each_other_have_two_rows(
    tmp_path: Path, four_fingers,
):
    def high(note: str) -> int:
        return drawn([four_fingers], tmp_path / "a.png", width=500, note=note,
                     key=[(Mark("L"), "700 N/m"), (Mark("I", strong=True), "2 N/m")]).shape[0]

    short, long = high("the same"), high(3 * "the same pull of the actuator ")
    assert long > short


def test_twice_the_same(tmp_path: Path, four_fingers):
    for name in ("a.png", "b.png"):
        drawn([four_fingers], tmp_path / name, labels=["hand"], note="note")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


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
