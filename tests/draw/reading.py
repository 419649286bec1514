"""A picture read as its reader does: arrows measured by the legend, numbers where they stand.

What it should show is worked out here from the arrays of the recording alone. Films and pages are
held to the same: whoever reads one gives it as :class:`Seen`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sandbox.scene.mechanism import Mechanism

from .conftest import recording

N, AT = 41, 30
"""Samples, and the one that is looked at."""
LIMIT, LEAST = 1.5, 0.12
"""Of a reference: arrows of more are cut; from which on a value is written beside an arrow."""


class Drawn(NamedTuple):
    """An arrow in pixels, y up."""

    tail: np.ndarray
    tip: np.ndarray
    cut: bool


class Seen(NamedTuple):
    """What is found on a picture, in its pixels, y up."""

    arrows: dict[str, list[Drawn]]
    """By the name of their colour; those of the legend left out."""
    lengths: dict[str, float]
    """Pixels for each unit of what arrows of a colour show, as the legend has it."""
    words: list[tuple[str, str, np.ndarray]]
    """Texts, their colours, and where their middles are."""
    scale: float
    """Pixels for each metre, as the scale bar has it."""


class Shown(NamedTuple):
    """An arrow that should be there."""

    tail: np.ndarray
    """[m]"""
    value: np.ndarray
    reference: float
    text: str


def bench() -> Mechanism:
    """An arm on a post, a box that is held, two loads, drives that pull backwards."""
    return Mechanism.model_validate({
        "name": "bench", "title": "Bench",
        "bodies": [
            {"name": "floor", "motion": "fixed", "shapes": [
                {"type": "box", "size": [0.4, 0.02], "at": [0, -0.01]}]},
            {"name": "box", "mass": 1, "at": [-0.1, 0.02], "role": "object", "shapes": [
                {"type": "box", "size": [0.06, 0.04]}]},
            {"name": "post", "motion": "fixed", "at": [0.05, 0.1], "shapes": [
                {"type": "box", "size": [0.02, 0.02], "at": [-0.02, 0]}]},
            {"name": "arm", "mass": 1, "centre": [0.04, 0.01], "at": [0.05, 0.1], "shapes": [
                {"type": "capsule", "end": [0.1, 0], "radius": 0.008}]},
            {"name": "tip", "mass": 1, "at": [0.15, 0.1], "shapes": [
                {"type": "circle", "radius": 0.012}]},
            {"name": "ball", "mass": 1, "at": [0.0, 0.03], "shapes": [
                {"type": "circle", "radius": 0.01}]}],
        "joints": [
            {"type": "pin", "name": "pin", "a": "post", "b": "arm", "on_b": [0, 0],
             "positive": "clockwise", "limits": [-1, 1]},
            {"type": "pin", "name": "end", "a": "arm", "b": "tip", "on_b": [0, 0],
             "positive": "clockwise"},
            {"type": "rod", "name": "rod", "a": "floor", "b": "ball", "on_a": [0.1, 0.0]}],
        "tendons": [
            {"name": "cord", "guides": [{"body": "floor", "at": [-0.18, 0.14]}, {"body": "tip"}]},
            {"name": "line", "guides": [{"body": "floor", "at": [-0.18, 0.1]}, {"body": "box"}]}],
        "loads": [{"type": "drag", "name": "air", "bodies": ["tip"], "linear": 1},
                  {"type": "drag", "name": "oil", "bodies": ["box"], "linear": 1}],
        "drives": [
            {"type": "force", "name": "push", "body": "tip", "direction": [0.6, 0.8], "value": 3},
            {"type": "torque", "name": "twist", "joint": "pin", "value": 1},
            {"type": "motor", "name": "motor", "joint": "end", "value": 1, "torque": 1},
            {"type": "force", "name": "shove", "body": "ball", "direction": [1, 0], "value": 3}],
        "view": {"size": [900, 700], "traces": [{"body": "tip", "at": [0.0, 0.01]}],
                 "show": {"velocity": ["*"], "acceleration": ["*"], "reactions": ["*"]}}})


def everything():
    """The bench in motion, where everything acts, each a little otherwise in every sample."""
    mechanism, rng = bench(), np.random.default_rng(5)
    time = np.linspace(0.0, 1.03, N)  # round times lie between samples
    pose = np.zeros((N, 6, 3))
    pose[:] = [[*b.at, b.angle] for b in mechanism.bodies]
    turn = 0.6 * time
    pose[:, 3, 2] = turn
    pose[:, 4, :2] = [0.05, 0.1] + 0.1 * np.stack((np.cos(turn), np.sin(turn)), axis=1)
    pose[:, 4, 2] = -0.5 * time
    pose[:, 5, 0] += 0.02 * time
    centre = np.zeros((6, 2))
    centre[2], centre[3] = (-0.02, 0.0), (0.04, 0.01)

    def about(*shape, size=1.0):
        return size * rng.uniform(0.5, 1.0, (N, *shape)) * rng.choice([-1, 1], shape)

    still = np.array([0, 1, 0, 1, 1, 1])[:, None]
    load, drive = about(2, 2, size=4.0), about(4, size=3.0)
    load[AT, 0] *= 4  # cut
    drive[AT] = -abs(drive[AT])
    drive[AT, 3] = -30.0  # cut
    force = about(3, 2, size=6.0)
    ball = pose[:, 5, :2] - [0.1, 0.0]
    force[:, 2] = 5.0 * ball / np.hypot(*ball.T)[:, None]  # pushes it away from the floor
    rows = np.repeat(np.arange(N), 3)
    body, other = np.tile([5, 1, 3], N), np.tile([1, 0, 5], N)
    point = np.stack([pose[:, 5, :2] - [0.01, 0], pose[:, 1, :2] - [0.01, 0.02],
                      pose[:, 5, :2] + [0.004, 0.01]], axis=1).reshape(-1, 2)
    contact = about(3, 2, size=8.0)
    contact[AT, 1] = [3.0, 40.0]  # cut
    velocity, acceleration = about(6, 3, size=0.3) * still, about(6, 3, size=5.0) * still
    velocity[AT, 4] *= 4
    torque = np.full((N, 4), np.nan)
    torque[:, 2] = -0.4 * time
    stop = np.full((N, 3), np.nan)
    stop[:, 0] = 0.2
    return recording(
        mechanism, time, pose, body_centre=centre, body_inertia=np.full(6, 1e-4),
        joint_reaction=np.hypot(force[..., 0], force[..., 1]), body_velocity=velocity,
        body_acceleration=acceleration, joint_force=force, joint_stop=stop,
        drive_value=drive, drive_torque=torque, tendon_tension=np.column_stack(
            (1 + time, 4 - time)), load_force=load,
        contact_sample=rows, contact_body=body, contact_other=other, contact_point=point,
        contact_force=contact.reshape(-1, 2),
        contact_normal=np.tile([0.0, 1.0], (3 * N, 1)), contact_gap=np.zeros(3 * N),
        contact_merged=np.ones(3 * N))


def world(pose, body, at):
    """A point of a body [m], [..., 2]."""
    x, y, angle = (pose[..., body, k] for k in range(3))
    c, s = np.cos(angle), np.sin(angle)
    return np.stack((x + c * at[0] - s * at[1], y + s * at[0] + c * at[1]), axis=-1)


def _usual(sizes, time):
    """What nine samples and a half of ten do not exceed; half of the run's end does not."""
    weight = np.gradient(time)

    def quantile(some, share):
        order = np.argsort(sizes[some])
        below = np.cumsum(weight[some][order])
        return sizes[some][order][np.searchsorted(below, share * below[-1] * (1 - 1e-12))]

    return max(quantile(sizes > 0, 0.95), quantile(time >= time[-1] - 0.1 * np.ptp(time), 0.5))


def _arrows(tails, values, time, unit):
    """Those of a sample by the largest of each: tails [k, 2] m, values [n, k, 2]."""
    sizes = np.hypot(values[..., 0], values[..., 1])
    usual = _usual(sizes.max(axis=1), time)
    decimals = 2 if usual < 10 else 1 if usual < 100 else 0
    return [Shown(np.array(tail), value, usual, f"{math.hypot(*value):.{decimals}f} {unit}")
            for tail, value in zip(tails, values[AT], strict=True)]


def expected(run) -> dict[str, list[Shown]]:
    """Arrows by the name of their colour, at the sample that is looked at."""
    a, time = run.arrays, run.time
    pose = a["body_pose"][AT]
    # whom contacts act on: the object, else what moves more. The ball presses the box, the floor
    # presses the box, the ball is pressed by the arm, which goes farther than the ball
    sign = np.array([-1.0, 1.0, 1.0])
    contacts = a["contact_force"].reshape(N, 3, 2) * sign[None, :, None]
    marks = [(4, (0.0, 0.01)), (1, (0.0, 0.0)), (3, (0.04, 0.01)), (5, (0.0, 0.0))]
    places = [world(pose, body, at) for body, at in marks]
    moved, gained = [], []
    for body, at in marks:
        r = world(a["body_pose"], body, at) - world(a["body_pose"], body, a["body_centre"][body])
        v, g = a["body_velocity"][:, body], a["body_acceleration"][:, body]
        across = np.stack((-r[:, 1], r[:, 0]), axis=1)
        moved.append(v[:, :2] + v[:, 2:] * across)
        gained.append(g[:, :2] + g[:, 2:] * across - v[:, 2:] ** 2 * r)
    hinges = a["joint_force"][:, :2]  # on the arm, which moves more than the post; then on the tip
    return {
        "FORCE": _arrows(a["contact_point"].reshape(N, 3, 2)[AT], contacts, time, "N"),
        "VELOCITY": _arrows(places, np.stack(moved, axis=1), time, "m/s"),
        "ACCELERATION": _arrows(places, np.stack(gained, axis=1), time, "m/s²"),
        "REACTION": _arrows([world(pose, 3, (0, 0)), world(pose, 4, (0, 0))], hinges, time, "N"),
    }


def straight(run) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Loads and forces of drives, to the scale of the contact forces: words, tail [m], force."""
    a = run.arrays
    pose = a["body_pose"][AT]
    value = a["drive_value"][AT, 0]
    return [("air", world(pose, 4, (0, 0)), a["load_force"][AT, 0]),
            ("oil", world(pose, 1, (0, 0)), a["load_force"][AT, 1]),
            ("push", world(pose, 4, (0, 0)), value * np.array([0.6, 0.8])),
            ("shove", world(pose, 5, (0, 0)), a["drive_value"][AT, 3] * np.array([1.0, 0.0]))]


def check_arrows(seen: Seen, run, to_pixels, shortest: float) -> None:
    """Each arrow begins where it should, is as long as the legend says, and none is besides.

    Args:
        seen: what is on the picture.
        run: :func:`everything`.
        to_pixels: of a point [m] in the picture's pixels, y up.
        shortest: arrows up to this may be left out [pixels].
    """
    for colour, wanted in expected(run).items():
        per, drawn = seen.lengths[colour], list(seen.arrows[colour])
        for one in sorted(wanted, key=lambda each: -math.hypot(*each.value)):
            size = math.hypot(*one.value)
            cut = size > LIMIT * one.reference
            way = one.value * per * min(1.0, LIMIT * one.reference / size)
            if math.hypot(*way) < shortest:
                continue
            tail = to_pixels(one.tail)
            near = [each for each in drawn if math.dist(each.tail, tail) < 1
                    and math.dist(each.tip, tail + way) < 1]
            assert near, (colour, one, tail, way, drawn)
            assert near[0].cut == cut, (colour, one)
            drawn = [each for each in drawn if each is not near[0]]
        assert not drawn, (colour, drawn)


def check_straight(seen: Seen, run, to_pixels) -> None:
    """The same of loads and forces of drives, which go by the scale of the contact forces."""
    usual = expected(run)["FORCE"][0].reference
    for words, at, force in straight(run):
        size, tail = math.hypot(*force), to_pixels(at)
        way = force * seen.lengths["FORCE"] * min(1.0, LIMIT * usual / size)
        near = [each for each in seen.arrows["DRIVE"] if math.dist(each.tail, tail) < 1
                and math.dist(each.tip, tail + way) < 1]
        assert near, (words, tail, way, seen.arrows["DRIVE"])
        assert near[0].cut == (size > LIMIT * usual), words
        assert any(text.startswith(f"{words} {size:.1f}"[:-1]) for text, _, _ in seen.words), words


def check_words(seen: Seen, run, to_pixels, reach: float) -> None:
    """A number beside an arrow is that of the arrow, no more than ``reach`` pixels from it."""
    for colour, wanted in expected(run).items():
        texts = {one.text for one in wanted}
        for text, own, middle in seen.words:
            if own != colour:
                continue
            assert text in texts, (colour, text, texts)
            [one] = [each for each in wanted if each.text == text]
            size = math.hypot(*one.value)
            way = one.value * seen.lengths[colour] * min(1.0, LIMIT * one.reference / size)
            tail = to_pixels(one.tail)
            assert min(math.dist(middle, tail), math.dist(middle, tail + way)) < reach, (text, own)
            assert size >= LEAST * one.reference
