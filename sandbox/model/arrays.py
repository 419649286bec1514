"""The arrays of a recording: their names, types and shapes, told once.

Axes: n samples, nb bodies, nj joints, ns springs, nt tendons, nd drives, nm
meters (each in the mechanism's order) and m contact rows. Everything is SI.
The meaning of each array is told by :class:`sandbox.recording.recording.Recording`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.scene.mechanism import Mechanism

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Arrays = dict[str, NDArray[Any]]

PER_SAMPLE: dict[str, tuple[str | int, ...]] = {
    "time": ("n",),
    "body_pose": ("n", "nb", 3), "body_velocity": ("n", "nb", 3),
    "body_acceleration": ("n", "nb", 3), "body_shift": ("n", "nb", 3),
    "joint_angle": ("n", "nj"), "joint_rate": ("n", "nj"), "joint_reaction": ("n", "nj"),
    "joint_stop": ("n", "nj"), "joint_damping": ("n", "nj"), "joint_damping_work": ("n", "nj"),
    "spring_length": ("n", "ns"), "spring_force": ("n", "ns"), "spring_work": ("n", "ns"),
    "tendon_length": ("n", "nt"), "tendon_tension": ("n", "nt"), "tendon_work": ("n", "nt"),
    "drive_value": ("n", "nd"), "drive_work": ("n", "nd"), "drive_torque": ("n", "nd"),
}
STATIC: dict[str, tuple[str | int, ...]] = {
    "body_centre": ("nb", 2), "body_mass": ("nb",), "body_inertia": ("nb",),
    "tendon_initial": ("nt",), "tendon_rest": ("nt",),
}
CONTACT: dict[str, tuple[str | int, ...]] = {
    "contact_sample": ("m",), "contact_body": ("m",), "contact_other": ("m",),
    "contact_point": ("m", 2), "contact_force": ("m", 2), "contact_normal": ("m", 2),
    "contact_gap": ("m",),
}
METERS = "meter_value"
"""Optional, [n, nm]: the meters, once they were evaluated."""
INTEGER = ("contact_sample", "contact_body", "contact_other")
LAYOUT = {**PER_SAMPLE, **STATIC, **CONTACT}


def dtype_of(key: str) -> type[np.float64] | type[np.int64]:
    """The element type of an array."""
    return np.int64 if key in INTEGER else np.float64


def sizes(mechanism: Mechanism, *, samples: int, contacts: int = 0) -> dict[str, int]:
    """The length of every axis."""
    return {
        "n": samples, "m": contacts, "nb": len(mechanism.bodies), "nj": len(mechanism.joints),
        "ns": len(mechanism.springs), "nt": len(mechanism.tendons), "nd": len(mechanism.drives),
        "nm": len(mechanism.meters),
    }


def shape_of(key: str, size: Mapping[str, int]) -> tuple[int, ...]:
    """The shape of the array ``key`` for the given axis lengths."""
    axes = ("n", "nm") if key == METERS else LAYOUT[key]
    return tuple(size[axis] if isinstance(axis, str) else axis for axis in axes)


def faults(mechanism: Mechanism, arrays: Mapping[str, NDArray[Any]]) -> list[str]:
    """What is wrong with a set of arrays: missing ones, wrong shapes or types, wild indices."""
    missing = [f"array {key!r} is missing" for key in LAYOUT if key not in arrays]
    if missing:
        return missing
    size = sizes(mechanism, samples=arrays["time"].size, contacts=arrays["contact_gap"].size)
    found = []
    for key in [*LAYOUT, *([METERS] if METERS in arrays else [])]:
        array, shape = arrays[key], shape_of(key, size)
        if array.shape != shape:
            found.append(f"array {key!r} has shape {array.shape}, expected {shape}")
        elif array.dtype != dtype_of(key):
            found.append(f"array {key!r} holds {array.dtype}, expected {np.dtype(dtype_of(key))}")
    return found or _wild(arrays, size)


def _wild(arrays: Mapping[str, NDArray[Any]], size: Mapping[str, int]) -> list[str]:
    found = []
    for key, axis in zip(INTEGER, ("n", "nb", "nb"), strict=True):
        array = arrays[key]
        if array.size and not (array.min() >= 0 and array.max() < size[axis]):
            found.append(f"array {key!r} points outside 0..{size[axis] - 1}")
    if not found and np.any(np.diff(arrays["contact_sample"]) < 0):
        found.append("array 'contact_sample' is not in order")
    return found
