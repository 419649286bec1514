"""Stills on paper: as wide as a column, with letters that are read there, and their surround."""

import re

import pytest
from PIL import Image

import sandbox
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.headline import MOST, Headline
from sandbox.draw.film.legend import items_for
from sandbox.draw.film.options import check_view, view_of
from sandbox.draw.film.paper import LETTERS, PrintSize, paper_of
from sandbox.draw.film.sheet import Text
from sandbox.draw.film.typesetter import Typesetter
from sandbox.draw.film.video import render
from sandbox.errors import OutputError

SIZE = re.compile(r"([0-9.]+)px")


def letters(path):
    """Sizes of all letters [pt], and width and height [mm] of an SVG."""
    text = path.read_text()
    sides = [float(re.search(rf'<svg[^>]*? {side}="([0-9.]+)pt"', text)[1]) / 72 * 25.4
             for side in ("width", "height")]
    return [float(size) for size in SIZE.findall(text)], sides


@pytest.mark.parametrize(("word", "paper"), [
    ("85mm", PrintSize(85)), ("8.5 cm", PrintSize(85)), ("85mmx70mm", PrintSize(85, 70)),
    ("85 x 70 mm", PrintSize(85, 70)), ("3.5in", PrintSize(3.5 * 25.4)),
    ("8.5cm × 70mm", PrintSize(85, 70)),
    ("800x600", None), ("2x", None), ("85", None), ((800, 600), None), ("mm", None),
])
def test_a_size_on_paper_has_a_unit(word, paper):
    found = paper_of(word)
    assert found == paper if paper is None else (found.width, found.height) == pytest.approx(
        (paper.width, paper.height) if paper.height else (paper.width, None))


@pytest.mark.parametrize("word", ["3mm", "85mmx1mm", "2000mm"])
def test_what_no_page_has_is_refused(word):
    with pytest.raises(OutputError, match="25 to 650 mm"):
        paper_of(word)


@pytest.mark.parametrize("word", ["85mm", "85mmx70mm", "180mm"])
@pytest.mark.parametrize("more", [{}, {"strip": 3}, {"meters": ["finger1.mcp.angle"]}])
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


def test_a_still_on_paper_has_pixels_enough_for_print_and_says_how_large_it_is(
    finger_run, tmp_path,
):
    file, = render(finger_run, tmp_path / "a.png", size="85mmx70mm")
    with Image.open(file) as picture:
        assert picture.size == (1004, 827)
        assert picture.info["dpi"] == pytest.approx((300, 300), abs=0.1)


def test_without_a_height_a_still_is_as_high_as_what_it_shows(finger_run, tmp_path):
    heights = []
    for show in ("", "-names"):
        file, = render(finger_run, tmp_path / "a.svg", size="85mm", show=show or None, bare=True)
        heights.append(letters(file)[1][1])
    box = FrameRenderer(finger_run, size=(1004, 3000), unit=1.0, bare=True)
    assert heights[0] == pytest.approx(85 * box.needs / 1004, rel=0.05)


def test_a_film_has_no_size_on_paper(finger_run, tmp_path):
    with pytest.raises(OutputError, match=r"a film has pixels.*\.svg"):
        render(finger_run, tmp_path / "a.gif", size="85mm")


def test_scales_stay_where_title_time_and_signs_go(finger_run):
    kinds = [{}, {"bare": True}, {"scales": True}]
    told = [{word.face.text for word in FrameRenderer(finger_run, **kind).sheet(0.5).words
             if isinstance(word, Text)} for kind in kinds]
    full, bare, scales = told
    lost = full - scales
    assert bare < scales < full
    assert {"spring", "t = 0.500 s"} & full <= lost
    assert any(text.endswith(" mm") for text in scales - bare)


def test_the_legend_of_a_still_has_no_line_for_what_it_does_not_show(finger_run):
    at, after = finger_run.time[0], finger_run.time[-1]
    sense = [FrameRenderer(finger_run, moments=[t]).content for t in (at, after)]
    whole = FrameRenderer(finger_run).content
    for t, content in zip((at, after), sense, strict=True):
        sample = 0 if t == at else -1
        assert ("stop" in content.signs) == bool(finger_run.arrays["joint_stop"][sample].any())
        assert content.signs <= whole.signs | {"fixed"}
    assert not (sense[0].cut and sense[0].contact == 0)
    assert items_for(whole, 1000.0, 1.0)


def test_a_long_title_is_set_smaller_or_in_lines(finger_run):
    type_ = Typesetter(20)
    title = "A finger of three phalanges that closes round an object without a plan"
    room = type_.width(title, 22)
    assert Headline.of(title, type_, room, 25).lines == (title,)
    assert 20 <= Headline.of(title, type_, room, 25).size <= 22
    narrow = Headline.of(title, type_, room // 2, 25)
    assert " ".join(narrow.lines) == title
    assert 1 < len(narrow.lines) <= MOST
    assert all(type_.width(line, narrow.size) <= room // 2 for line in narrow.lines)
    tight = Headline.of(title, type_, room // 6, 25)
    assert len(tight.lines) <= MOST
    assert tight.lines[-1].endswith("...")
    assert Headline.of("", type_, room, 25).lines == ("",)


def test_a_view_may_be_fitted_to_a_group(finger_run):
    group = finger_run.mechanism.groups[0]
    views = [view_of(finger_run.mechanism.view, {"bodies": names})
             for names in ([group.name], list(group.bodies))]
    for view in views:
        check_view(finger_run, view)
    cameras = [FrameRenderer(finger_run, view=view).camera for view in views]
    assert cameras[0] == cameras[1]
    with pytest.raises(OutputError, match="follow: no body's name"):
        check_view(finger_run, view_of(finger_run.mechanism.view, {"follow": group.name}))


def test_a_scene_may_name_a_group_as_what_its_picture_is_fitted_to():
    scene = {"bodies": [{"name": "a", "mass": 1, "shapes": [{"type": "circle", "radius": 0.01}]},
                        {"name": "b", "mass": 1, "inertia": 1}],
             "groups": [{"name": "both", "bodies": ["a", "b"]}], "view": {"bodies": ["both"]}}
    assert sandbox.load_scene(scene).view.bodies == ("both",)
    with pytest.raises(sandbox.SceneError, match="no body's name matches 'bath'"):
        sandbox.load_scene({**scene, "view": {"bodies": ["bath"]}})
