"""Stills are the frames of the film, in every format and on paper."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from sandbox.errors import OutputError
from sandbox.picture.film import instants, render
from sandbox.picture.frame import Picture, Strip
from sandbox.picture.meters import HUES, Meter
from sandbox.picture.options import LETTERS, PrintSize, paper_of, view_of
from sandbox.picture.paper import pixels

SMALL = (320, 240)
SVG = "{http://www.w3.org/2000/svg}"


def test_an_svg_keeps_its_words_and_has_the_size_of_the_picture(zoo_run, tmp_path):
    render(zoo_run, tmp_path / "a.svg", at=0.7, size=SMALL)
    root = ElementTree.parse(tmp_path / "a.svg").getroot()
    assert [float(root.get(k).removesuffix("pt")) for k in ("width", "height")] == [240.0, 180.0]
    words = [each.text for each in root.iter(f"{SVG}text")]
    assert {zoo_run.mechanism.title, "t = 0.700 s"} <= set(words)


def test_equal_runs_give_equal_files(finger_run, tmp_path):
    for ending in ("svg", "pdf"):
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
    last = pixels(Picture(finger_run, size=SMALL, moments=[0.25, end]), end)
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
            drawn = pixels(Picture(part, size=SMALL, bare=True), t, transparent=True).astype(int)
            assert np.array_equal(shown[..., 3] > 0, drawn[..., 3] >= 128)
            apart = np.abs(shown - drawn)[..., :3][shown[..., 3] > 0]
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


class Words:
    """A painter that keeps the plain texts and drops all else."""

    enlarge = 1

    def __init__(self):
        self.found, self.dots = [], []

    def write(self, corner, words, size, ink):
        self.found.append((words, corner, size))

    def disc(self, centre, radius, fill, edge, width, *, hatch=0.0):
        self.dots.append((centre, fill))

    def __getattr__(self, name):
        return lambda *args, **options: None


def test_bare_pictures_have_no_words_around(finger_run):
    full, bare = (Picture(finger_run, size=SMALL, bare=bare) for bare in (False, True))
    assert full.title.lines == (finger_run.mechanism.title,)
    assert full.legend
    assert (bare.title, bare.legend) == (None, [])
    assert bare.camera.pixel[1] == SMALL[1] / 2 > full.camera.pixel[1]


@pytest.mark.parametrize(("size", "count"), [((1600, 500), 24), ((700, 900), 2)])
def test_a_strip_has_the_size_that_is_asked_for_and_times_that_do_not_meet(finger_run, size, count):
    times = np.linspace(0, 1.234, count).tolist()
    strip = Strip(finger_run, times, finger_run.mechanism.view, size=size)
    assert strip.size == size
    words = Words()
    strip.paint(words)
    told = [(x, y, x + strip.type.width(text, high)) for text, (x, y), high in words.found
            if re.fullmatch(r"(t = )?\d+(\.\d+)? s", text)]
    assert len(told) == count
    assert all(left >= 0 and right <= size[0] for left, _, right in told)
    for one in told:
        assert sum(one[0] < other[2] and other[0] < one[2] and one[1] == other[1]
                   for other in told) == 1


def test_a_strips_meters_have_a_cursor_for_each_picture(finger_run):
    """The curve is whole, with a dot and a number at each of the times."""
    meter = f"{finger_run.mechanism.tendons[0].name}.tension"
    view = view_of(finger_run.mechanism.view, {"meters": [meter]})
    times, words = [0.1, 0.5, 1.0], Words()
    Strip(finger_run, times, view).paint(words)
    samples = [int(np.argmin(np.abs(finger_run.time - t))) for t in times]
    dial = Meter(finger_run, view.meters[0])
    values = ", ".join(dial.texts(dial.values[:, [s]])[0].removesuffix(" N") for s in samples)
    assert f"{values} N" in [text for text, *_ in words.found]
    dots = [centre[0] for centre, fill in words.dots if fill == HUES[0]]
    assert len(dots) == 3
    apart = np.diff(dots)
    assert apart[0] / apart[1] == pytest.approx(0.8, abs=1e-6)


FONT_SIZE = re.compile(r"([0-9.]+)px")


def letters(path):
    """Sizes of all letters [pt], and width and height [mm] of an SVG."""
    text = path.read_text()
    sides = [float(re.search(rf'<svg[^>]*? {side}="([0-9.]+)pt"', text)[1]) / 72 * 25.4
             for side in ("width", "height")]
    return [float(size) for size in FONT_SIZE.findall(text)], sides


@pytest.mark.parametrize(("word", "paper"), [
    ("85 x 70 mm", PrintSize(85, 70)), ("3.5in", PrintSize(3.5 * 25.4)),
    ("8.5cm × 70mm", PrintSize(85, 70)), ("800x600", None), ((800, 600), None), ("mm", None),
])
def test_a_size_on_paper_has_a_unit(word, paper):
    found = paper_of(word)
    assert found == paper if paper is None else (found.width, found.height) == pytest.approx(
        (paper.width, paper.height) if paper.height else (paper.width, None))


@pytest.mark.parametrize(("word", "more"), [("85mm", {}), ("85mmx70mm", {"strip": 3})])
def test_no_letter_of_a_still_on_paper_is_smaller_than_seven_points(
    finger_run, tmp_path, word, more,
):
    file, = render(finger_run, tmp_path / "a.svg", size=word, **more)
    sizes, (width, height) = letters(file)
    assert sizes
    assert min(sizes) >= LETTERS == 7.0  # points, as the docs say
    assert width == pytest.approx(paper_of(word).width, abs=0.01)
    if paper_of(word).height:
        assert height == pytest.approx(70, abs=0.1)


def test_a_film_has_no_size_on_paper(finger_run, tmp_path):
    with pytest.raises(OutputError, match=r"a film has pixels.*\.svg"):
        render(finger_run, tmp_path / "a.gif", size="85mm")
