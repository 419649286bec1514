"""A made-up hand and a made-up collection of elements, moving by formula: no engine needed."""

import numpy as np
import pytest

from sandbox.elements.arrays import CONTACT, PER_SAMPLE, STATIC, dtype_of, shape_of, sizes
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import planned
from sandbox.scene.mechanism import Mechanism

MM = 1e-3
LENGTHS = (45 * MM, 26 * MM, 21 * MM)
RADII = (9 * MM, 8 * MM, 7.5 * MM)
GUIDES = ((-22, -14), (24, -8), (10, -3), (4, -1))
PITCH = 130 * MM


def arrays_for(mechanism, time, pose, **given):
    """All keys a recording has, zero where not given."""
    axes = sizes(mechanism, samples=len(time), contacts=len(given.get("contact_gap", ())))
    base = {
        key: np.zeros(shape_of(key, axes), dtype=dtype_of(key))
        for key in (*PER_SAMPLE, *STATIC, *CONTACT)
    }
    base |= {"time": time, "body_pose": pose}
    for key in ("body_mass", "body_inertia"):
        base[key] += 1
    return base | given


def recording(mechanism, time, pose, **given):
    return Recording(mechanism, arrays_for(mechanism, time, pose, **given),
                     planned(mechanism.run))


def _finger(k):
    name, x = f"finger{k + 1}", k * PITCH
    bodies = [{"name": f"{name}.palm", "motion": "fixed", "role": "palm", "at": [x, 0],
               "shapes": [{"type": "box", "size": [0.024, 0.026], "at": [-0.016, -0.004]}]}]
    joints, springs = [], []
    at, before = x, f"{name}.palm"
    parts = zip(("proximal", "middle", "distal"), ("mcp", "pip", "dip"), LENGTHS, RADII,
                (0, *LENGTHS[:2]), strict=True)
    for part, hinge, length, radius, offset in parts:
        body = f"{name}.{part}"
        bodies.append({"name": body, "mass": 0.01, "role": "phalanx", "at": [at, 0],
                       "shapes": [{"type": "capsule", "end": [length, 0], "radius": radius}]})
        joints.append({"type": "pin", "name": f"{name}.{hinge}", "a": before, "b": body,
                       "on_b": [0, 0], "positive": "clockwise", "limits": [0, 1.5]})
        springs.append({"type": "linear", "name": f"{name}.{hinge}_spring", "a": before,
                        "b": body, "on_a": [offset - 8 * MM, 8 * MM], "on_b": [8 * MM, 8 * MM],
                        "stiffness": 300})
        at, before = at + length, body
    names = [b["name"] for b in bodies]
    guides = [{"body": b, "at": [gx * MM, gy * MM]}
              for b, (gx, gy) in zip(names, GUIDES, strict=True)]
    return bodies, joints, springs, guides[::-1]


def hand_mechanism(fingers=4, title="Adaptive grasp of four sections", **view):
    """Fingers that close clockwise on discs, on a rocker tree above (to the left)."""
    bodies, joints, springs, tendons, groups = [], [], [], [], []
    for k in range(fingers):
        b, j, s, guides = _finger(k)
        bodies += b
        joints += j
        springs += s
        rocker = f"tree.rocker{k // 2 + 1}" if fingers > 1 else "anchor"
        side = (-0.065 if k % 2 == 0 else 0.065) if fingers > 1 else 0.0
        tendons.append({"name": f"finger{k + 1}.tendon",
                        "guides": [*guides, {"body": rocker, "at": [side, 0]}]})
        groups.append({"name": f"finger{k + 1}", "kind": "finger",
                       "bodies": [x["name"] for x in b]})
        bodies += [
            {"name": f"section{k + 1}.circle", "motion": "fixed", "role": "object",
             "at": [k * PITCH + 0.011, -0.0383 - 0.001 * k],
             "shapes": [{"type": "circle", "radius": (14 + 2 * k) * MM}]},
            {"name": f"section{k + 1}.square", "mass": 0.01, "role": "object",
             "at": [k * PITCH + 0.045, -0.075],
             "shapes": [{"type": "box", "size": [0.012, 0.012]}]},
        ]
    if fingers > 1:
        for k in range(fingers // 2):
            bodies.append({"name": f"tree.rocker{k + 1}", "mass": 0.01, "role": "rocker",
                           "at": [(2 * k + 0.5) * PITCH - 0.022, 0.08],
                           "shapes": [{"type": "capsule", "start": [-0.065, 0],
                                       "end": [0.065, 0], "radius": 0.004}]})
        bodies.append({"name": "tree.rocker3", "mass": 0.01, "role": "rocker",
                       "at": [1.5 * PITCH - 0.022, 0.12],
                       "shapes": [{"type": "capsule", "start": [-PITCH, 0],
                                   "end": [PITCH, 0], "radius": 0.004}]})
        for k in range(fingers // 2):
            tendons.append({"name": f"tree.link{k + 1}", "guides": [
                {"body": f"tree.rocker{k + 1}"},
                {"body": "tree.rocker3", "at": [-PITCH if k == 0 else PITCH, 0]}]})
    bodies.append({"name": "anchor", "motion": "fixed", "at": [1.5 * PITCH - 0.022, 0.16]
                   if fingers > 1 else [-0.07, -0.014]})
    if fingers > 1:
        tendons.append({"name": "tree.actuator",
                        "guides": [{"body": "tree.rocker3"}, {"body": "anchor"}]})
    drives = [{"type": "pull", "name": "actuator", "tendon": tendons[-1]["name"], "value": 15}]
    return Mechanism.model_validate({
        "name": "hand", "title": title, "bodies": bodies, "joints": joints, "springs": springs,
        "tendons": tendons, "drives": drives, "groups": groups, "view": view})


def hand(fingers=4, samples=201, **view):
    """The hand closing within 1 s and holding for another."""
    mechanism = hand_mechanism(fingers, **view)
    time = (np.arange(samples) + 0.5) * 2.0 / samples
    close = np.clip(time / 1.0, 0, 1)
    close = close * close * (3 - 2 * close)
    index = {b.name: i for i, b in enumerate(mechanism.bodies)}
    pose = np.zeros((samples, len(mechanism.bodies), 3))
    pose[:] = [[*b.at, b.angle] for b in mechanism.bodies]
    final = np.radians([35.0, 62.361, 49.276])
    rows = []
    for k in range(fingers):
        angle = np.zeros(samples)
        x, y = np.full(samples, k * PITCH), np.zeros(samples)
        for part, turn, length, radius in zip(("proximal", "middle", "distal"), final, LENGTHS,
                                              RADII, strict=True):
            angle = angle - turn * close
            i = index[f"finger{k + 1}.{part}"]
            pose[:, i] = np.column_stack((x, y, angle))
            normal = np.column_stack((-np.sin(angle), np.cos(angle)))
            middle = np.column_stack((x, y)) + length / 2 * np.column_stack(
                (np.cos(angle), np.sin(angle)))
            size = (0.6 + 0.3 * k) * np.clip((time - 0.9) / 0.3, 0, 1)
            rows += [(s, i, index[f"section{k + 1}.circle"], *(middle[s] - radius * normal[s]),
                      *(size[s] * normal[s]), *normal[s])
                     for s in np.flatnonzero(size > 0)]
            x, y = x + length * np.cos(angle), y + length * np.sin(angle)
    rows.sort()
    rows = np.array(rows)
    tension = np.full((samples, len(mechanism.tendons)), 3.75)
    if fingers > 1:
        tension[:, fingers:-1] = 7.5
        tension[:, -1] = 15.0
        for r, rate in ((1, 0.2), (2, -0.15), (3, 0.1)):
            pose[:, index[f"tree.rocker{r}"], 2] = rate * np.sin(3 * time)
    tension *= np.clip((time - 0.05) / 0.5, 0, 1)[:, None]
    stop = np.zeros((samples, len(mechanism.joints)))
    stop[time > 1.2, 2] = -0.05
    pull = 15.0 if fingers > 1 else 3.75
    drive = pull * np.clip(time / 0.5, 0, 1)[:, None]
    return recording(
        mechanism, time, pose, tendon_tension=tension, joint_stop=stop, drive_value=drive,
        contact_sample=rows[:, 0].astype(int), contact_body=rows[:, 1].astype(int),
        contact_other=rows[:, 2].astype(int), contact_point=rows[:, 3:5],
        contact_force=rows[:, 5:7], contact_normal=rows[:, 7:9],
        contact_gap=np.zeros(len(rows)))


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
    return hand(fingers=1, title="One finger on a disc")


@pytest.fixture(scope="session")
def zoo_run():
    return zoo()
