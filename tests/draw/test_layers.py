"""What a picture shows by layers: each is there when it is asked for and gone when it is not."""

import re

import numpy as np
import pytest

from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.options import view_of
from sandbox.draw.film.palette import (
    ACCELERATION,
    AXES,
    REACTION,
    TENSION,
    VELOCITY,
    tension_colour,
)
from sandbox.draw.film.tensions import SLACK_FRACTION, tensions_of
from sandbox.kinds.layers import LAYERS, asked, shown
from sandbox.scene.mechanism import Mechanism

from .conftest import recording

N = 21


def machine():
    """An arm on a pin with a spring, a cord, a drive, a load, a box on a floor; all of them act."""
    mechanism = Mechanism.model_validate({
        "bodies": [
            {"name": "floor", "motion": "fixed", "shapes": [
                {"type": "box", "size": [0.4, 0.02], "at": [0, -0.01]}]},
            {"name": "box", "mass": 1, "at": [-0.1, 0.02], "role": "object", "shapes": [
                {"type": "box", "size": [0.06, 0.04]}]},
            {"name": "post", "motion": "fixed", "at": [0.05, 0.1]},
            {"name": "arm", "mass": 1, "at": [0.05, 0.1], "shapes": [
                {"type": "capsule", "end": [0.1, 0], "radius": 0.008}]},
            {"name": "tip", "mass": 1, "at": [0.15, 0.1], "shapes": [
                {"type": "circle", "radius": 0.012}]}],
        "joints": [{"type": "pin", "name": "pin", "a": "post", "b": "arm", "on_b": [0, 0]},
                   {"type": "pin", "name": "end", "a": "arm", "b": "tip", "on_b": [0, 0]}],
        "springs": [{"type": "linear", "name": "coil", "a": "floor", "b": "arm",
                     "on_a": [0.12, 0], "on_b": [0.07, 0], "stiffness": 1}],
        "tendons": [{"name": "cord", "guides": [{"body": "floor", "at": [-0.18, 0.14]},
                                                {"body": "tip"}]}],
        "loads": [{"type": "drag", "name": "air", "bodies": ["tip"], "linear": 1}],
        "drives": [{"type": "force", "name": "push", "body": "tip", "direction": [0, 1],
                    "value": 3}],
        "groups": [{"name": "index", "kind": "finger", "bodies": ["arm", "tip"]}],
        "view": {"size": [480, 400]}})
    time = np.linspace(0, 1, N)
    pose = np.zeros((N, 5, 3))
    pose[:] = [[*b.at, b.angle] for b in mechanism.bodies]
    turn = 0.4 * time
    pose[:, 3, 2] = turn
    pose[:, 4, :2] = [0.05, 0.1] + 0.1 * np.stack((np.cos(turn), np.sin(turn)), axis=1)
    velocity = np.zeros((N, 5, 3))
    velocity[:, 3:, 1], velocity[:, 3, 2] = 0.04, 0.4
    return recording(
        mechanism, time, pose, body_velocity=velocity, body_acceleration=2 * velocity,
        joint_force=np.full((N, 2, 2), [3.0, 2.0]), drive_value=np.full((N, 1), 3.0),
        tendon_tension=np.full((N, 1), 4.0), load_force=np.full((N, 1, 2), [-2.0, 0.0]),
        contact_sample=np.arange(N), contact_body=np.full(N, 1), contact_other=np.zeros(N, int),
        contact_point=np.tile([-0.1, 0.0], (N, 1)), contact_force=np.tile([0.0, 9.81], (N, 1)),
        contact_normal=np.tile([0.0, 1.0], (N, 1)), contact_gap=np.zeros(N),
        contact_merged=np.full(N, 2.0))


RUN = machine()


def picture(show):
    view = view_of(RUN.mechanism.view, {"show": show, "centre": (0, 0.06), "width": 0.45})
    return FrameRenderer(RUN, size=view.size, view=view).draw(0.5)[36:330].astype(int)


@pytest.fixture(scope="module")
def usual():
    return picture(None)


@pytest.mark.parametrize("layer", LAYERS)
def test_every_layer_changes_the_picture(layer, usual):
    """One that did nothing would be a word without a meaning."""
    switched = picture(f"-{layer}" if LAYERS[layer].default else layer)
    assert (np.abs(switched - usual).max(axis=2) > 40).sum() > 20


def test_nothing_is_left_without_layers():
    assert (picture("-all") == 255).all()


@pytest.mark.parametrize(("layer", "colour"), [
    ("velocity", VELOCITY), ("acceleration", ACCELERATION), ("reactions", REACTION),
    ("axes", AXES)])
def test_each_has_its_colour_of_the_bodies_that_are_named(layer, colour, usual):
    def count(pixels):
        return int((np.abs(pixels - colour).max(axis=2) < 25).sum())

    named, every = picture({layer: ["tip"]}), picture([layer])
    assert count(usual) < 8 < count(named) < count(every)


def test_what_is_asked_for_when_drawing_is_added_to_the_scenes():
    view = RUN.mechanism.view.model_copy(update={"show": asked(["axes", "-contacts"])})
    found = view_of(view, {"show": "contacts,velocity"})
    assert set(shown(found.show, traced=False)) == {
        *(name for name, layer in LAYERS.items() if layer.default), "axes", "velocity"}


def test_the_legend_says_whose_forces_and_whether_any_is_cut():
    def words(run):
        return [item.after for row in FrameRenderer(run)._legend for item in row]

    found = words(RUN)
    assert any(word.endswith(" N contact force on the object") for word in found)
    assert "larger, cut short" not in found
    blow = machine()
    blow.arrays["contact_force"] = blow.arrays["contact_force"].copy()
    blow.arrays["contact_force"][5] *= 1e4
    assert "larger, cut short" in words(blow)
    pulled = machine()
    pulled.arrays["drive_value"] = pulled.arrays["drive_value"].copy()
    pulled.arrays["drive_value"][5] *= 1e4
    pulled.arrays["drive_value"][7] = np.nan  # which hides nothing
    assert "larger, cut short" in words(pulled)
    assert "larger, cut short" not in told(pulled, show=["-drives"])
    assert [word for word in words(blow) if "contact" in word] == [
        word for word in found if "contact" in word]


def test_without_tensions_cords_are_grey_and_those_that_hang_stay_dashed():
    carried = tensions_of(RUN)
    plain = carried.hidden()
    assert {carried.level(float(each)) > 0.1 for each in carried.pieces.ravel()} == {True}
    assert {tension_colour(each / plain.largest) for each in plain.pieces.ravel()} == {TENSION[0]}
    assert (plain.pieces > SLACK_FRACTION * plain.largest).all()
    slack = carried._replace(pieces=np.zeros((2, 1))).hidden()
    assert (slack.pieces == 0).all()


def test_what_rounding_leaves_has_no_scale():
    """2e-15 N in a cord, in a contact and in a hinge are nothing: the legend has none of them."""
    run, strong = machine(), machine()
    for key in ("tendon_tension", "contact_force", "joint_force"):
        run.arrays[key] = 1e-15 * run.arrays[key]

    def told(run):
        view = view_of(run.mechanism.view, {"show": ["reactions"]})
        return " ".join(f"{item.before} {item.after}" for row in FrameRenderer(
            run, view=view)._legend for item in row)

    for word in ("tension", "contact force", "hinge force"):
        assert word in told(strong)
        assert word not in told(run)
    assert "slack" in told(run)


def told(run, **view):
    """What a picture's legend says."""
    drawn = FrameRenderer(run, view=view_of(run.mechanism.view, view))
    return [f"{item.before} {item.after}".strip() for row in drawn._legend for item in row]


def test_the_legend_has_a_scale_of_loads_and_says_what_drives():
    assert any(re.fullmatch(r"[\d.]+ N load", word) for word in told(RUN))
    assert not any("load" in word for word in told(RUN, show=["-loads"]))
    assert any(re.fullmatch(r"[\d.]+ N driving force", word) for word in told(RUN))
    assert not any("driving" in word for word in told(RUN, show=["-drives"]))
    own = [word for word in told(RUN, show=["-contacts"]) if "driving" in word]
    assert own == ["driving force"], "without contact forces there is no such scale"
    idle = machine()
    idle.arrays["drive_value"] = 0 * idle.arrays["drive_value"]
    assert not any("driving" in word for word in told(idle))


def test_the_legend_tells_of_contact_forces_only_if_a_picture_shows_one():
    """A blow of one sample between two frames has an arrow in none of them."""
    blow = machine()
    of, time = blow.arrays["contact_sample"], blow.time
    assert any("contact force" in word for word in told(blow))
    seen = FrameRenderer(blow, moments=[float(time[3])])._drawn_samples()
    assert seen == [3]
    blow.arrays["contact_force"] = np.where(
        (of == 3)[:, None], blow.arrays["contact_force"], 0.0)
    for at, there in ((3, True), (6, False)):
        content = FrameRenderer(blow, moments=[float(time[at])]).content
        assert (content.contact > 0) is there


def test_the_legend_says_on_which_body_hinge_forces_act():
    (word,) = [word for word in told(RUN, show=["reactions"]) if "hinge force" in word]
    assert re.fullmatch(r"[\d.]+ N hinge force on (the object|what moves more).*", word)


def test_what_is_fixed_looks_in_the_legend_as_it_does_in_the_picture():
    run = machine()
    bodies = run.mechanism.bodies
    fixed = [k for k, body in enumerate(bodies) if body.motion == "fixed" and body.shapes]
    painted = [body.model_copy(update={"colour": "#ff8800"}) if k in fixed else body
               for k, body in enumerate(bodies)]
    mechanism = run.mechanism.model_copy(update={"bodies": painted})
    assert FrameRenderer(recording(mechanism, run.time, run.arrays["body_pose"])
                         ).content.fixed.fill == (255, 136, 0)
