"""A small mechanism with every kind of element, and a recording of it with known numbers."""

import mmap
from dataclasses import replace

import numpy as np

from sandbox.elements.arrays import CONTACT, PER_SAMPLE, STATIC, dtype_of, shape_of, sizes
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Outcome
from sandbox.scene.mechanism import Mechanism

N = 20
H = 0.01
INFO = Outcome(step=H, sample_rate=1 / H, versions={"sandbox": "0"}, wall={"simulate": 0.25})
BOX = {"type": "box", "size": [0.1, 0.01]}
PALM, PROXIMAL, DISTAL, DISC, PLATE = range(5)


def capsule(name, x):
    return {"name": name, "mass": 0.01, "at": [x, 0],
            "shapes": [{"type": "capsule", "end": [0.03, 0], "radius": 0.005}]}


def mechanism(**changes):
    content = {
        "name": "sample", "title": "A sample", "run": {"duration": N * H, "step": H},
        "bodies": [
            {"name": "palm", "motion": "fixed", "shapes": [BOX]},
            capsule("finger1.proximal", 0), capsule("finger1.distal", 0.03),
            {"name": "disc", "mass": 0.1, "shapes": [{"type": "circle", "radius": 0.02}]},
            {"name": "plate", "motion": "scheduled", "path": {"x": 0.5}, "shapes": [BOX]},
            {"name": "rocker", "mass": 0.1, "inertia": 1e-4},
        ],
        "joints": [
            {"type": "pin", "name": "finger1.mcp", "a": "palm", "b": "finger1.proximal",
             "on_a": [0, 0], "limits": [0, 1.5]},
            {"type": "pin", "name": "finger1.pip", "a": "finger1.proximal",
             "b": "finger1.distal", "on_a": [0.03, 0]},
            {"type": "rope", "name": "leash", "a": "palm", "b": "disc", "longest": 0.1},
        ],
        "springs": [
            {"type": "linear", "name": "return", "a": "palm", "b": "finger1.proximal",
             "stiffness": 100},
            {"type": "rotary", "name": "coil", "joint": "finger1.pip", "stiffness": 0.1},
        ],
        "tendons": [{"name": "finger1.tendon", "guides": [
            {"body": "palm"}, {"body": "finger1.distal"}]}],
        "drives": [
            {"type": "pull", "name": "actuator", "tendon": "finger1.tendon", "value": 3},
            {"type": "torque", "name": "twist", "joint": "finger1.pip", "value": 0.1},
            {"type": "force", "name": "push", "body": "disc", "direction": [1, 0], "value": 1},
            {"type": "radius", "name": "swell", "body": "disc", "value": 0.02},
        ],
        "groups": [{"name": "finger1", "kind": "finger",
                    "bodies": ["finger1.proximal", "finger1.distal"]}],
        **changes,
    }
    return Mechanism.model_validate(content)


def arrays(mech, *, contacts=(), n=N):
    """Every array filled with distinct numbers; contact rows are
    (sample, body, other, (fx, fy), (nx, ny))."""
    size = sizes(mech, n=n, m=len(contacts))
    result = {}
    for rank, key in enumerate([*PER_SAMPLE, *STATIC]):
        shape = shape_of(key, size)
        count = int(np.prod(shape))
        result[key] = (np.arange(count, dtype=float) / 7 + rank).reshape(shape)
    result["time"] = (np.arange(n) + 0.5) * H
    for key in CONTACT:
        result[key] = np.zeros(shape_of(key, size), dtype_of(key))
    for row, (sample, body, other, force, normal) in enumerate(contacts):
        result["contact_sample"][row] = sample
        result["contact_body"][row] = body
        result["contact_other"][row] = other
        result["contact_force"][row] = force
        result["contact_normal"][row] = normal
        result["contact_merged"][row] = 1 + row % 2
        result["contact_point"][row] = (0.001 * row, -0.002 * row)
    return result


def recording(*, contacts=(), n=N, info=None, mech=None, **changes):
    mech = mech or mechanism(**{"run": {"duration": max(n, N) * H, "step": H}, **changes})
    return Recording(mech, arrays(mech, contacts=contacts, n=n), replace(INFO, **(info or {})))


S = 0.5 ** 0.5
CONTACTS = [
    # the distal phalanx pressed up by the disc: 3 N normal, tangential along -x
    (1, DISTAL, DISC, (-0.5, 3.0), (0.0, 1.0)),
    # the phalanges touch each other: inside the finger
    (1, PROXIMAL, DISTAL, (0.0, -1.0), (0.0, -1.0)),
    # an oblique normal: force (2, 0) on the proximal along (1, 1)/sqrt 2
    (2, PROXIMAL, DISC, (2.0, 0.0), (S, S)),
    (2, DISC, PALM, (0.25, 4.0), (0.0, 1.0)),
    # a touch without force
    (3, DISTAL, DISC, (0.0, 5e-7), (0.0, 1.0)),
]


def mapped(array):
    """Whether an array lies in a file."""
    while array is not None and not isinstance(array, mmap.mmap):
        array = array.base
    return array is not None
