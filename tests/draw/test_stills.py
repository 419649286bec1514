"""Stills are the frames of the film, in every format: both come from the same drawers."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.meters import HUES, dials
from sandbox.draw.film.options import view_of
from sandbox.draw.film.shapes import DrawnLines, FilledCircle, FilledPolygon, Hatching
from sandbox.draw.film.sheet import Text
from sandbox.draw.film.stills import instants
from sandbox.draw.film.strip import strip_sheet
from sandbox.draw.film.vector import save_vector
from sandbox.draw.film.video import render
from sandbox.errors import OutputError
from sandbox.scene.layers import LAYERS

SMALL = (320, 240)
SVG = "{http://www.w3.org/2000/svg}"


def everything(run, **more):
    return view_of(run.mechanism.view, {"size": SMALL, "show": list(LAYERS), **more})


@pytest.fixture(params=["hand", "zoo", "finger"])
def run(request, hand_run, zoo_run, finger_run):
    return {"hand": hand_run, "zoo": zoo_run, "finger": finger_run}[request.param]


def test_a_sheet_is_painted_to_the_very_pixels_of_the_film(run):
    renderer = FrameRenderer(run, view=everything(run))
    for t in (0.0, 0.7, 2.0):
        sheet = renderer.sheet(t)
        assert np.array_equal(sheet.painted(), renderer.draw(t))
    fresh = FrameRenderer(run, view=everything(run))
    assert np.array_equal(sheet.painted(), fresh.draw(2.0))


def test_laid_on_any_ground_what_is_see_through_is_the_picture(zoo_run):
    """Colour c of opacity a on a ground g is a c + (1 - a) g, by the definition of opacity."""
    sheet = FrameRenderer(zoo_run, view=everything(zoo_run), enlarge=4).sheet(0.7)
    pixels = sheet.see_through().astype(float)
    opacity = pixels[..., 3:] / 255
    for ground in ((255, 255, 255), (0, 0, 0), (20, 120, 220)):
        laid = opacity * pixels[..., :3] + (1 - opacity) * np.array(ground)
        # colour and opacity are rounded, and so are the two pictures they are made from: half of
        # one each, and smoothing and blending of text by whole numbers one more
        assert np.abs(laid - sheet.painted(ground)).max() <= 3
    assert pixels[0, 0, 3] == 0
    assert (pixels[..., 3] == 255).mean() > 0.01


def numbers(path):
    return np.array([float(v) for v in re.findall(r"-?[\d.]+(?:e-?\d+)?", path)]).reshape(-1, 2)


def test_an_svg_has_every_shape_and_every_text_where_the_sheet_has_it(zoo_run, tmp_path):
    sheet = FrameRenderer(zoo_run, view=everything(zoo_run), enlarge=4).sheet(0.7)
    save_vector(sheet, tmp_path / "a.svg")
    root = ElementTree.parse(tmp_path / "a.svg").getroot()
    assert [float(root.get(k).removesuffix("pt")) for k in ("width", "height")] == [240.0, 180.0]
    texts = [(each.text, float(each.get("x")) / 0.75, float(each.get("y")) / 0.75)
             for each in root.iter(f"{SVG}text")]
    words = [word for word in sheet.words if isinstance(word, Text)]
    assert [text for text, *_ in texts] == [word.face.text for word in words]
    for (_, x, y), word in zip(texts, words, strict=True):
        assert (x, y) == pytest.approx((word.at[0] + word.face.rim,
                                        word.at[1] + word.face.baseline), abs=1e-4)
    paths = [each for each in root.iter(f"{SVG}path") if each.get("clip-path")]
    assert len(paths) == len(sheet.laid)
    for path, laid in zip(paths, sheet.laid, strict=True):
        colour = "#{:02x}{:02x}{:02x}".format(*laid.shape.colour[:3])
        assert colour in path.get("style")
        match laid.shape:
            case FilledPolygon(_, corners):
                found, corners = numbers(path.get("d")), np.asarray(corners) / 4 * 0.75
                if np.array_equal(corners[0], corners[-1]):  # z goes back there
                    corners = corners[:-1]
                assert found == pytest.approx(corners, abs=1e-4)
            case DrawnLines(_, _, width, _) | Hatching(_, _, width, _):
                drawn = re.search(r"stroke-width: ([\d.]+)", path.get("style"))
                assert float(drawn[1] if drawn else 1.0) == pytest.approx(width / 4 * 0.75)
            case FilledCircle(_, centre, radius):
                found = numbers(path.get("d"))
                reach = np.array([found.min(axis=0), found.max(axis=0)]) / 0.75 * 4
                assert reach == pytest.approx(
                    np.array([np.subtract(centre, radius), np.add(centre, radius)]), abs=1e-2)


def test_equal_runs_give_equal_files(finger_run, tmp_path):
    for ending in ("svg", "pdf", "png"):
        one, two = (tmp_path / f"{name}.{ending}" for name in "ab")
        assert render(finger_run, one, at=0.5, size=SMALL) == [one]
        render(finger_run, two, at="500 ms", size=SMALL)
        assert one.read_bytes() == two.read_bytes()
    assert b"FreeSans" in (tmp_path / "a.pdf").read_bytes()


def test_times_are_seconds_texts_with_units_and_the_two_ends(finger_run):
    last = float(finger_run.time[-1])
    asked = [0.5, "0.5", "0.5 s", " 500ms", np.float64(0.5), "start", "end"]
    found = instants(finger_run, asked)
    assert [each.time for each in found] == [0.5] * 5 + [0.0, last]
    assert [each.word for each in found] == ["0.5s"] * 5 + ["start", "end"]


@pytest.mark.parametrize(("asked", "told"), [
    (99, "at=99: the run lasts from 0 s to "), (-0.1, "the run lasts from 0 s"),
    ("ende", "did you mean 'end'"), ("0.5 N", "at='0.5 N'"), (True, "at=True"),
    ([], "empty list"), (float("nan"), "finite"), (None, "at=None"),
])
def test_what_is_no_time_of_the_run_is_refused(finger_run, asked, told):
    with pytest.raises(OutputError, match=re.escape(told)):
        instants(finger_run, asked)


def test_several_moments_are_several_files(finger_run, tmp_path):
    files = render(finger_run, tmp_path / "a.png", at=[0.25, "end"], size=SMALL)
    assert [file.name for file in files] == ["a_0.25s.png", "a_end.png"]
    folder = render(finger_run, tmp_path / "new", at=["start", 1], size=SMALL)
    assert [file.name for file in folder] == ["still_start.png", "still_1s.png"]
    end = float(finger_run.time[-1])
    last = FrameRenderer(finger_run, size=SMALL, enlarge=4, moments=[0.25, end]).draw(end)
    with Image.open(files[1]) as picture:
        assert np.array_equal(np.asarray(picture), last)


def test_a_size_may_be_a_factor(finger_run, tmp_path):
    wide, high = finger_run.mechanism.view.size
    render(finger_run, tmp_path / "a.png", size="0.5x", at="end")
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.size == (wide // 2, high // 2)
    for word in ("x", "2", "1e9x", "..x"):
        with pytest.raises(OutputError, match="size="):
            render(finger_run, tmp_path / "b.png", size=word)


def test_frames_may_be_see_through_and_an_mp4_not(finger_run, tmp_path):
    short = finger_run.part(0, 30)
    render(short, tmp_path / "frames", size=SMALL, transparent=True)
    with Image.open(tmp_path / "frames" / "frame_00000.png") as frame:
        assert (frame.mode, frame.getpixel((0, 0))[3]) == ("RGBA", 0)
    with pytest.raises(OutputError, match=r"transparent asks for .* no \.mp4 has; allowed: \.gif"):
        render(short, tmp_path / "a.mp4", transparent=True)
    for how in ({"at": 0.0}, {"strip": True}):
        with pytest.raises(OutputError, match=rf"{next(iter(how))} asks for .*\.png, \.svg"):
            render(short, tmp_path / "a.gif", **how)


def test_a_gif_may_be_see_through(finger_run, tmp_path):
    """Each frame covers what the still of that moment does, and nothing of those before."""
    part = finger_run.part(0, 400)
    render(part, tmp_path / "a.gif", size=SMALL, transparent=True, speed=1.0, bare=True)
    with Image.open(tmp_path / "a.gif") as film:
        count = film.n_frames
        for k in (0, count // 2, count - 1):
            film.seek(k)
            shown = np.asarray(film.convert("RGBA")).astype(int)
            t = min(k / part.mechanism.view.fps, float(part.time[-1]))
            still = FrameRenderer(part, size=SMALL, bare=True).sheet(t).see_through().astype(int)
            assert np.array_equal(shown[..., 3] > 0, still[..., 3] >= 128)
            apart = np.abs(shown - still)[..., :3][shown[..., 3] > 0]
            assert apart.mean() < 4
    assert count > 5
    with pytest.raises(OutputError, match=r"no picture can have the ending '\.bmp'"):
        render(part, tmp_path / "a.bmp", at=0.0)


@pytest.mark.parametrize("strip", [0, 1, 25, -2])
def test_a_strip_has_a_few_pictures(finger_run, tmp_path, strip):
    with pytest.raises(OutputError, match="2 to 24"):
        render(finger_run, tmp_path / "a.png", strip=strip)
    with pytest.raises(OutputError, match=r"2 to 24|and at say both"):
        render(finger_run, tmp_path / "a.png", strip=3, at=[0.0])


def test_bare_pictures_have_no_words_around(finger_run):
    full, bare = (FrameRenderer(finger_run, size=SMALL, bare=bare) for bare in (False, True))
    told = [word.face.text for word in bare.sheet(0.5).words if isinstance(word, Text)]
    assert not any(text.startswith("t = ") for text in told)
    assert finger_run.mechanism.title not in told
    assert bare.camera.pixel[1] == SMALL[1] / 2 > full.camera.pixel[1]


@pytest.mark.parametrize("count", [2, 24])
@pytest.mark.parametrize("size", [(1600, 500), (700, 900)])
def test_a_strip_has_the_size_that_is_asked_for_and_times_that_do_not_meet(finger_run, size, count):
    times = np.linspace(0, 1.234, count).tolist()
    sheet = strip_sheet(finger_run, times, finger_run.mechanism.view, enlarge=1, size=size)
    assert sheet.size == size
    words = [word for word in sheet.words if isinstance(word, Text)]
    assert all(word.rect.left >= 0 and word.rect.right <= size[0]
               and word.rect.bottom <= size[1] for word in words)
    told = [word for word in words if re.fullmatch(r"(t = )?\d+(\.\d+)? s", word.face.text)]
    assert len({word.face.text for word in told}) == count
    for one in told:
        assert len(one.rect.collidelistall([other.rect for other in told])) == 1


def test_a_strips_meters_have_a_cursor_for_each_picture(finger_run):
    """The curve is whole, with a dot and a number at each of the times."""
    meter = f"{finger_run.mechanism.tendons[0].name}.tension"
    view = view_of(finger_run.mechanism.view, {"meters": [meter]})
    times = [0.1, 0.5, 1.0]
    sheet = strip_sheet(finger_run, times, view, enlarge=1)
    told = [word.face.text for word in sheet.words if isinstance(word, Text)]
    samples = [int(np.argmin(np.abs(finger_run.time - t))) for t in times]
    dial, = dials(finger_run, view)
    values = ", ".join(dial.texts(s)[0].removesuffix(" N") for s in samples)
    assert f"{values} N" in told
    dots = [laid.shape.centre[0] for laid in sheet.laid if isinstance(laid.shape, FilledCircle)
            and laid.part[2:] == sheet.get_size() and tuple(laid.shape.colour) == HUES[0]]
    assert len(dots) == 3
    apart = np.diff(dots)
    assert apart[0] / apart[1] == pytest.approx(0.8, abs=1e-6)
