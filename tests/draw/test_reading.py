"""Stills read as their reader does, against the arrays of the recording."""

import contextlib
import math
import re
import zlib

import numpy as np
import pytest

from sandbox.draw.film import palette
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.shapes import DrawnLines, FilledCircle, FilledPolygon
from sandbox.draw.film.sheet import Text
from sandbox.draw.film.video import save_picture
from sandbox.scene.settings import ShownMeter

from .reading import AT, Drawn, Seen, check_arrows, check_straight, check_words, everything

COLOURS = {getattr(palette, name): name for name in (
    "FORCE", "VELOCITY", "ACCELERATION", "REACTION", "DRIVE", "STOP", "INK")}
WORDS = {"FORCE": "contact force", "VELOCITY": "velocity", "ACCELERATION": "acceleration",
         "REACTION": "hinge force"}


@pytest.fixture(scope="module")
def run():
    return everything()


@pytest.fixture(scope="module")
def still(run):
    """The renderer and its sheet at the sample that is looked at."""
    frames = FrameRenderer(run, unit=1.0)
    return frames, frames.sheet(float(run.time[AT]))


def up(points, k):
    """Finished pixels, y up, of enlarged ones."""
    return np.asarray(points, float).reshape(-1, 2) / k * [1, -1]


def bars(shapes, tail, tip, k):
    """Whether two lines in the ground's colour cross an arrow at 0.4 and 0.5 of it."""
    middles = [up(s.path, k).mean(axis=0) for s in shapes if isinstance(s, DrawnLines)
               and tuple(s.colour) == palette.BACKGROUND and len(s.path) == 2]
    return all(any(math.dist(tail + w * (tip - tail), each) < 0.6 for each in middles)
               for w in (0.4, 0.5))


def seen_on(frames, sheet):
    """What is on a still."""
    k, shapes = frames.enlarged, [each.shape for each in sheet.laid]
    arrows = {name: [] for name in COLOURS.values()}
    legend = {}
    words = [(word.face.text, COLOURS.get(tuple(word.face.colour), ""),
              np.array(word.rect.center) * [1, -1]) for word in sheet.words
             if isinstance(word, Text)]
    for i, shape in enumerate(shapes):
        name = COLOURS.get(tuple(shape.colour)[:3])
        if isinstance(shape, FilledPolygon) and len(shape.corners) == 7 and name:
            corners = up(shape.corners, k)
            tail, tip = (corners[0] + corners[6]) / 2, corners[3]
            one = Drawn(tail, tip, bars(shapes[i + 1:i + 3], tail, tip, k))
            (legend.setdefault(name, []) if -tail[1] > frames._foot else arrows[name]).append(one)
    lengths = {name: math.dist(legend[name][0].tail, legend[name][0].tip) / next(
        float(text.split()[0]) for text, _, _ in words if f" {after}" in text)
        for name, after in WORDS.items()}
    bar = next(up(s.path, k) for s in shapes if isinstance(s, DrawnLines)
               and tuple(s.colour) == palette.INK and -up(s.path, k)[0, 1] > frames._foot)
    metres = next(float(text.split()[0]) * {"mm": 1e-3, "m": 1.0}[text.split()[1]]
                  for text, _, _ in words if text.endswith((" mm", " m")))
    return Seen(arrows, lengths, words, float(np.ptp(bar[:, 0])) / metres)


def placed(frames):
    """Pixels, y up, of points in metres."""
    camera = frames.camera
    return lambda at: np.array([camera.pixel[0] + camera.scale * (at[0] - camera.centre[0]),
                                -camera.pixel[1] + camera.scale * (at[1] - camera.centre[1])])


def test_arrows_are_as_long_as_the_legend_says_and_those_that_are_cut_say_so(still, run):
    seen = seen_on(*still)
    check_arrows(seen, run, placed(still[0]), shortest=5.5)
    check_straight(seen, run, placed(still[0]))


def test_a_number_stands_beside_its_own_arrow(still, run):
    check_words(seen_on(*still), run, placed(still[0]), reach=90)


def test_the_scale_bar_is_as_long_as_it_says(still):
    frames, _ = still
    assert seen_on(*still).scale == pytest.approx(frames.camera.scale, rel=0.01)


def test_torques_and_motors_turn_the_way_that_their_values_have(still, run):
    """Both are negative, about hinges that are positive with the clock: against the clock."""
    frames, sheet = still
    k, shapes = frames.enlarged, [each.shape for each in sheet.laid]
    pose = run.arrays["body_pose"][AT]
    pin, end = (placed(frames)(pose[body, :2]) for body in (3, 4))

    def sense(about, base, tip):
        (x, y), (dx, dy) = base - about, tip - base
        return math.copysign(1, x * dy - y * dx)

    bent = [(up(s.corners, k)[[0, 6]].mean(axis=0), up(s.corners, k)[3]) for s in shapes
            if isinstance(s, FilledPolygon) and tuple(s.colour) == palette.DRIVE
            and len(s.corners) == 7]
    [torque] = [one for one in bent if 8 < math.dist(one[0], pin) < 25 > math.dist(one[1], pin)]
    assert sense(pin, *torque) == 1
    heads = [up(s.corners, k) for s in shapes if isinstance(s, FilledPolygon)
             and tuple(s.colour) == palette.DRIVE and len(s.corners) == 3]
    [head] = [one for one in heads if math.dist(one[0], end) < 25]
    assert sense(end, head[1:].mean(axis=0), head[0]) == 1


def test_a_stop_sits_on_the_side_from_which_it_pushes(still, run):
    """It turns the arm with the clock, away from the post on its left: it sits above."""
    frames, sheet = still
    [wedge] = [up(each.shape.corners, frames.enlarged) for each in sheet.laid
               if isinstance(each.shape, FilledPolygon) and tuple(each.shape.colour) == palette.STOP
               and up(each.shape.corners, frames.enlarged)[0, 1] > -frames._foot]
    assert wedge[0] == pytest.approx(placed(frames)(run.arrays["body_pose"][AT, 3, :2]), abs=0.1)
    way = wedge[1:].mean(axis=0) - wedge[0]
    assert way[1] > 0.8 * math.hypot(*way)


def test_cords_and_rods_have_the_colours_of_the_legends_ramp(still, run):
    frames, sheet = still
    words = [text for text, _, _ in seen_on(*still).words]
    top = next(float(text.split()[0]) for text in words if text.endswith("N pulls"))
    assert f"pushes {top:g} N" in words
    pose, ramp = run.arrays["body_pose"][AT], list(palette.TENSION)
    for body, y, tension in ((4, 0.14, 1 + run.time[AT]), (1, 0.1, 4 - run.time[AT])):
        ends = [placed(frames)(at) for at in ((-0.18, y), pose[body, :2])]
        [colour] = {tuple(s.shape.colour) for s in sheet.laid
                    if isinstance(s.shape, FilledPolygon) and tuple(s.shape.colour) in ramp
                    and math.dist(up(s.shape.corners, frames.enlarged).mean(axis=0),
                                  np.mean(ends, axis=0)) < 2}
        assert ramp.index(colour) / (len(ramp) - 1) == pytest.approx(
            tension / top, abs=0.51 / (len(ramp) - 1))


def test_a_body_that_is_followed_stays_and_the_rest_goes_past_it(run):
    frames = FrameRenderer(run, unit=1.0, view=run.mechanism.view.model_copy(
        update={"follow": "tip", "centre": None}))
    found = []
    for k in (0, AT):
        shapes = [each.shape for each in frames.sheet(float(run.time[k])).laid]
        discs = [s for s in shapes if isinstance(s, FilledCircle) and s.radius > 5 * frames.unit]
        scale = frames.camera.scale
        [post] = {tuple(up(s.corners, frames.enlarged).mean(axis=0).round(3)) for s in shapes
                  if isinstance(s, FilledPolygon) and len(s.corners) == 4
                  and np.ptp(up(s.corners, frames.enlarged), axis=0) == pytest.approx(
                      np.array([0.02, 0.02]) * scale, abs=2)}
        [tip] = {tuple(up(s.centre, frames.enlarged)[0].round(3)) for s in discs
                 if s.radius / frames.enlarged == pytest.approx(0.012 * scale, rel=0.05)
                 and s.centre[0] > 900}
        found.append((np.array(tip), np.array(post)))
    gone = run.arrays["body_pose"][AT, 4, :2] - run.arrays["body_pose"][0, 4, :2]
    assert found[1][0] == pytest.approx(found[0][0], abs=1)
    assert found[1][1] - found[0][1] == pytest.approx(-frames.camera.scale * gone, abs=1)


def test_meters_have_numbers_at_their_own_ends(run):
    view = run.mechanism.view.model_copy(update={"meters": (
        ShownMeter.model_validate({"of": "push.value", "range": [-4, 8]}),)})
    frames = FrameRenderer(run, unit=1.0, view=view)
    sheet = frames.sheet(float(run.time[AT]))
    words = {text: at for text, _, at in seen_on(frames, sheet).words}
    high, low = (next(at for text, at in words.items() if text in each)
                 for each in (("8", "8 N", "8.0"), ("-4", "-4 N", "-4.0", "\N{MINUS SIGN}4")))
    assert high[1] > low[1] + 30
    begin, end = words["0 s"], words["1.03 s"]
    assert end[0] > begin[0] + 100


def test_the_stamp_is_the_time_and_what_drives_give_is_told(still, run):
    texts = [text for text, _, _ in seen_on(*still).words]
    assert f"t = {run.time[AT]:.3f} s" in texts
    assert f"motor {run.arrays['drive_torque'][AT, 2]:.3f} N m" in texts
    assert f"twist {run.arrays['drive_value'][AT, 1]:.3g} N m" in texts
    assert "-5.00 N" in texts  # the rod pushes


def test_a_pdf_has_every_arrow_where_the_sheet_has_it(run, tmp_path):
    """Of its page's program the filled shapes of seven corners, by their colours."""
    frames = FrameRenderer(run)
    sheet = frames.sheet(float(run.time[AT]))
    save_picture(run, tmp_path / "still.pdf", t=float(run.time[AT]))
    streams = re.findall(rb"stream\r?\n(.*?)\r?\nendstream", (tmp_path / "still.pdf").read_bytes(),
                         re.DOTALL)
    programs = []
    for stream in streams:
        with contextlib.suppress(zlib.error):
            programs.append(zlib.decompress(stream).decode("latin1"))
    numbers, colour, kept, path, found = [], (), [], [], []
    for word in max(programs, key=len).split():
        try:
            numbers.append(float(word))
            continue
        except ValueError:
            pass
        if word in ("rg", "g"):
            colour = tuple(round(255 * v) for v in (numbers[-3:] if word == "rg"
                                                    else 3 * numbers[-1:]))
        elif word == "q":
            kept.append(colour)
        elif word == "Q":
            colour = kept.pop()
        elif word in ("m", "l"):
            path = [*([] if word == "m" else path), numbers[-2:]]
        elif word == "f" and len(path) == 7:
            found.append((colour, np.array(path)))
        numbers = []
    k, point = frames.enlarged, 0.75  # of an inch 72, of pixels 96
    corner = np.array([0.0, point * frames.size[1]])
    wanted = [(tuple(s.shape.colour), up(s.shape.corners, k) * point + corner)
              for s in sheet.laid if isinstance(s.shape, FilledPolygon)
              and len(s.shape.corners) == 7]
    assert len(found) == len(wanted) > 20
    for (own, corners), (colour, there) in zip(found, wanted, strict=True):
        assert own == colour
        assert corners == pytest.approx(there, abs=0.01)
