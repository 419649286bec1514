"""A simulated hand and finger, and a made-up collection of elements that moves by formula."""

from functools import cache

import numpy as np
import pytest

from sandbox.elements.arrays import CONTACT, PER_SAMPLE, STATIC, dtype_of, shape_of, sizes
from sandbox.engine.simulate import simulate
from sandbox.picture.frame import Picture
from sandbox.picture.frames import Frames
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import planned
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene
from sandbox.scene.settings import View


def recording(mechanism, time, pose, **given):
    """All keys a recording has, zero where not given."""
    axes = sizes(mechanism, n=len(time), m=len(given.get("contact_gap", ())))
    arrays = {key: np.zeros(shape_of(key, axes), dtype=dtype_of(key))
              for key in (*PER_SAMPLE, *STATIC, *CONTACT)}
    for key in ("body_mass", "body_inertia"):
        arrays[key] += 1
    return Recording(mechanism, {**arrays, "time": time, "body_pose": pose, **given},
                     planned(mechanism.run))


def frames_of(run, *, enlarge=2, **options):
    return Frames(Picture(run, **options), enlarge)


@cache
def hand(rate=100, scene="adaptive_grasp"):
    """Four fingers that close on discs, sampled at a rate [Hz], without view and expectations."""
    run = simulate(load_scene(scene, overrides={"run.sample_rate": rate}))
    plain = {"name": "hand", "view": View(), "expect": ()}
    return Recording(run.mechanism.model_copy(update=plain), run.arrays, run.info)


def zoo_mechanism():
    """One of every kind of element."""
    return Mechanism.model_validate({
        "name": "zoo", "title": "One of every kind",
        "bodies": [
            {"name": "frame", "motion": "fixed"},
            {"name": "floor", "motion": "fixed", "role": "ground", "at": [0.05, -0.06],
             "shapes": [{"type": "box", "size": [0.26, 0.02]}]},
            {"name": "crank", "mass": 0.1, "inertia": 1e-4, "at": [0, 0]},
            {"name": "coupler", "mass": 0.1, "at": [0.02, 0], "shapes": [
                {"type": "box", "size": [0.07, 0.01], "at": [0.03, 0]}]},
            {"name": "slider", "mass": 0.1, "at": [0.08, 0], "shapes": [
                {"type": "box", "size": [0.02, 0.014]}]},
            {"name": "wheel", "mass": 0.1, "role": "pulley", "at": [0.0, 0.06],
             "shapes": [{"type": "circle", "radius": 0.012}]},
            {"name": "weight", "mass": 0.1, "role": "object", "at": [0.06, 0.03], "shapes": [
                {"type": "polygon", "points": [[-0.01, -0.01], [0.01, -0.01], [0, 0.012]]}]},
            {"name": "balloon", "motion": "fixed", "role": "object", "at": [0.12, -0.03],
             "shapes": [{"type": "circle", "radius": 0.01}]},
            {"name": "block", "mass": 0.1, "at": [0.13, 0.06], "shapes": [
                {"type": "box", "size": [0.016, 0.016], "angle": 0.4}]},
            {"name": "lid", "mass": 0.1, "at": [0.13, 0.074], "shapes": [
                {"type": "box", "size": [0.03, 0.006]}]},
        ],
        "joints": [
            {"type": "pin", "name": "crank_pin", "a": "frame", "b": "crank", "on_b": [0, 0]},
            {"type": "pin", "name": "knee", "a": "crank", "b": "coupler", "on_b": [0, 0]},
            {"type": "pin", "name": "wrist", "a": "coupler", "b": "slider", "on_b": [0, 0]},
            {"type": "slot", "name": "guide", "a": "frame", "b": "slider", "start": [0.04, 0],
             "end": [0.1, 0], "turns": False},
            {"type": "pin", "name": "axle", "a": "frame", "b": "wheel", "on_b": [0, 0]},
            {"type": "rod", "name": "rod", "a": "frame", "b": "block", "on_a": [0.17, 0.03],
             "on_b": [0, 0]},
            {"type": "rope", "name": "rope", "a": "weight", "b": "block", "longest": 0.085},
            {"type": "rope", "name": "strut", "a": "floor", "b": "balloon", "longest": 0.06,
             "shortest": 0.02, "on_a": [-0.03, 0.01], "on_b": [-0.01, 0]},
            {"type": "weld", "name": "weld", "a": "block", "b": "lid", "on_b": [0, -0.003]},
        ],
        "springs": [
            {"type": "linear", "name": "coil", "a": "floor", "b": "weight", "on_a": [0, 0.01],
             "on_b": [0, -0.01], "stiffness": 100},
            {"type": "rotary", "name": "clock", "joint": "crank_pin", "stiffness": 0.1},
        ],
        "tendons": [
            {"name": "belt", "guides": [
                {"body": "frame", "at": [-0.05, 0.02]},
                {"body": "wheel", "radius": 0.012, "side": "right"},
                {"body": "frame", "at": [0.05, 0.075], "radius": 0.006, "side": "left"},
                {"body": "weight", "at": [0, 0.012]}]},
            {"name": "idle", "guides": [{"body": "frame", "at": [-0.06, 0.0]},
                                        {"body": "crank"}]},
        ],
        "drives": [
            {"type": "force", "name": "push", "body": "slider", "direction": [1, 0], "value": 2},
            {"type": "torque", "name": "motor", "joint": "axle", "value": 0.1},
            {"type": "radius", "name": "swell", "body": "balloon", "value": 0.01},
        ],
    })


def zoo(samples=51):
    """The zoo in motion: a crank-slider, a turning wheel, a swelling disc."""
    mechanism = zoo_mechanism()
    time = (np.arange(samples) + 0.5) / samples
    pose = np.zeros((samples, len(mechanism.bodies), 3))
    pose[:] = [[*b.at, b.angle] for b in mechanism.bodies]
    index = {b.name: i for i, b in enumerate(mechanism.bodies)}
    turn = 2 * np.pi * time
    knee = 0.02 * np.column_stack((np.cos(turn), np.sin(turn)))
    reach = knee[:, 0] + np.sqrt(0.06**2 - knee[:, 1] ** 2)
    pose[:, index["crank"], 2] = turn
    pose[:, index["coupler"], :2] = knee
    pose[:, index["coupler"], 2] = np.arctan2(-knee[:, 1], reach - knee[:, 0])
    pose[:, index["slider"], 0] = reach
    pose[:, index["wheel"], 2] = turn
    drive = np.column_stack((2 * np.sin(turn), np.full(samples, 0.1), 0.01 + 0.006 * time))
    tension = np.column_stack((1 + time, np.zeros(samples)))
    return recording(mechanism, time, pose, drive_value=drive, tendon_tension=tension)


@pytest.fixture(scope="session")
def hand_run():
    return hand()


@pytest.fixture(scope="session")
def finger_run():
    return hand(scene="single_finger")


@pytest.fixture(scope="session")
def zoo_run():
    return zoo()
