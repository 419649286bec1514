"""What a picture shows by layers: each is there when it is asked for and gone when it is not."""


import numpy as np
import pytest

from sandbox.picture.frame import Picture
from sandbox.picture.options import view_of
from sandbox.picture.palette import TOKENS
from sandbox.scene.layers import LAYERS
from sandbox.scene.mechanism import Mechanism

from .conftest import frames_of, recording

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
    return frames_of(RUN, size=view.size, view=view).draw(0.5)[36:330].astype(int)


@pytest.fixture(scope="module")
def usual():
    return picture(None)


@pytest.mark.parametrize("layer", LAYERS)
def test_every_layer_changes_the_picture(layer, usual):
    """One that did nothing would be a word without a meaning."""
    switched = picture(f"-{layer}" if LAYERS[layer].default else layer)
    assert (np.abs(switched - usual).max(axis=2) > 40).sum() > 20


@pytest.mark.parametrize(("layer", "token"), [
    ("velocity", "velocity"), ("acceleration", "acceleration"), ("reactions", "reaction"),
    ("axes", "axes")])
def test_each_has_its_colour_of_the_bodies_that_are_named(layer, token, usual):
    def count(pixels):
        return int((np.abs(pixels - TOKENS[token][0]).max(axis=2) < 25).sum())

    named, every = picture({layer: ["tip"]}), picture([layer])
    assert count(usual) < 8 < count(named) < count(every)


def test_the_legend_says_whose_forces_and_whether_any_is_cut():
    found = told(RUN)
    assert any(word.endswith(" N contact force on the object") for word in found)
    assert "cut short" not in found
    blow = machine()
    blow.arrays["contact_force"] = blow.arrays["contact_force"].copy()
    blow.arrays["contact_force"][5] *= 1e4
    assert "cut short" in told(blow)
    pulled = machine()
    pulled.arrays["drive_value"] = pulled.arrays["drive_value"].copy()
    pulled.arrays["drive_value"][5] *= 1e4
    pulled.arrays["drive_value"][7] = np.nan  # which hides nothing
    assert "cut short" in told(pulled)
    assert "cut short" not in told(pulled, show=["-drives"])
    assert [word for word in told(blow) if "contact" in word] == [
        word for word in found if "contact" in word]


def test_what_rounding_leaves_has_no_scale():
    """2e-15 N in a cord, in a contact and in a hinge are nothing: the legend has none of them."""
    run, strong = machine(), machine()
    for key in ("tendon_tension", "contact_force", "joint_force"):
        run.arrays[key] = 1e-15 * run.arrays[key]

    before, after = (" ".join(told(each, show=["reactions"])) for each in (strong, run))
    for word in ("tension", "contact force", "joint force"):
        assert word in before
        assert word not in after
    assert "slack" in after


def told(run, **view):
    """What a picture's legend says."""
    drawn = Picture(run, size=(1200, 800), view=view_of(run.mechanism.view, view))
    return [f"{item.before} {item.after}".strip() for row in drawn.legend for item in row]
