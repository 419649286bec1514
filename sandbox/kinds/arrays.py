"""The arrays of a recording, one row each: axes, unit, one sentence. SI.

Axes: n samples, nb bodies, nj joints, ns springs, nt tendons, nd drives, nm
meters (each in the mechanism's order) and m contact rows. From here come the
layout of recordings, the count of their bytes and the table in docs/files.md.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sandbox.kinds.elements import NAMED

Arrays = dict[str, NDArray[Any]]
Axes = tuple[str | int, ...]


@dataclass(frozen=True)
class Recorded:
    """An array of a recording."""

    name: str
    axes: Axes
    unit: str
    """Empty for numbers of rows and elements."""
    about: str
    when: Literal["sample", "once", "contact", "meters"] = "sample"
    """A row for each sample, one for the run, one for each contact, or where there are meters."""
    element: type[np.float64] | type[np.int64] = np.float64
    late: bool = False
    """Not in the first recordings: where it is missing it reads as nan. Every new array is."""


ARRAYS: tuple[Recorded, ...] = (
    Recorded("time", ("n",), "s", "the instant of the poses and forces of a sample"),
    Recorded("body_pose", ("n", "nb", 3), "m, m, rad", "x, y, angle of the body's frame"),
    Recorded("body_velocity", ("n", "nb", 3), "m/s, m/s, rad/s",
             "of the centre of mass, and about it"),
    Recorded("body_acceleration", ("n", "nb", 3), "m/s^2, m/s^2, rad/s^2",
             "of the centre of mass, and about it"),
    Recorded("joint_angle", ("n", "nj"), "rad", "of `b` against `a`; nan unless a pin"),
    Recorded("joint_rate", ("n", "nj"), "rad/s", "of that angle; nan unless a pin"),
    Recorded("joint_reaction", ("n", "nj"), "N", "size of the force that the joint carries"),
    Recorded("joint_force", ("n", "nj", 2), "N",
             "on its body `b` by its body `a`, in the world; ends of grooves and ropes included",
             late=True),
    Recorded("joint_couple", ("n", "nj"), "N m",
             "on its body `b` by its body `a`, of welds and of what slides without turning; 0 of "
             "others", late=True),
    Recorded("joint_stop", ("n", "nj"), "N m",
             "torque of the hard stop, in the joint's sense; nan without limits"),
    Recorded("joint_damping", ("n", "nj"), "N m",
             "torque of the dampers, in the joint's sense; nan unless a pin"),
    Recorded("joint_damping_work", ("n", "nj"), "J",
             "done by the dampers on the bodies since t = 0; nan unless a pin"),
    Recorded("spring_length", ("n", "ns"), "m", "of a rotary spring its hinge's angle [rad]"),
    Recorded("spring_force", ("n", "ns"), "N",
             "positive pulls, damper included; of a rotary spring the torque [N m], which is "
             "positive against a positive angle"),
    Recorded("spring_work", ("n", "ns"), "J", "done on the bodies since t = 0"),
    Recorded("tendon_length", ("n", "nt"), "m", "along the path"),
    Recorded("tendon_tension", ("n", "nt"), "N", "never below 0"),
    Recorded("tendon_work", ("n", "nt"), "J", "done on the bodies since t = 0"),
    Recorded("drive_value", ("n", "nd"), "the drive's",
             "the value in force; of a motor that of its step's end, half a step after the sample"),
    Recorded("drive_work", ("n", "nd"), "J", "done on the bodies since t = 0"),
    Recorded("drive_torque", ("n", "nd"), "N m",
             "what a motor or brake gave its hinge, in the hinge's positive sense; nan for other "
             "drives", late=True),
    Recorded("body_centre", ("nb", 2), "m", "centre of mass in the body's frame", "once"),
    Recorded("body_mass", ("nb",), "kg", "infinite for what does not move freely", "once"),
    Recorded("body_inertia", ("nb",), "kg m^2",
             "about the centre of mass; infinite for what does not move freely", "once"),
    Recorded("tendon_initial", ("nt",), "m", "length at t = 0", "once"),
    Recorded("tendon_rest", ("nt",), "m", "length up to which it is slack", "once"),
    Recorded("contact_sample", ("m",), "", "which row of `time`", "contact", np.int64),
    Recorded("contact_body", ("m",), "", "the body that the force acts on", "contact", np.int64),
    Recorded("contact_other", ("m",), "", "the body that it comes from", "contact", np.int64),
    Recorded("contact_point", ("m", 2), "m", "where, in the world", "contact"),
    Recorded("contact_force", ("m", 2), "N", "on the body by the other", "contact"),
    Recorded("contact_normal", ("m", 2), "1", "unit vector into the body", "contact"),
    Recorded("contact_gap", ("m",), "m", "negative where they overlap", "contact"),
    Recorded("contact_merged", ("m",), "1",
             "how many points of touch the row stands for; of one alone place, gap and normal are "
             "those of the two surfaces, of more their means, the least gap and the place that "
             "gives all moments", "contact", late=True),
    Recorded("meter_value", ("n", "nm"), "the meter's", "if the scene has meters", "meters"),
)
METERS = "meter_value"
"""Optional: the meters, once they were evaluated."""
_BY_NAME = {row.name: row for row in ARRAYS}


def _axes(*when: str) -> dict[str, Axes]:
    return {row.name: row.axes for row in ARRAYS if row.when in when}


PER_SAMPLE, STATIC, CONTACT = _axes("sample"), _axes("once"), _axes("contact")
LAYOUT = _axes("sample", "once", "contact")
"""What every recording has, in memory; files of older ones may lack what is ``late``."""
LATE = tuple(row.name for row in ARRAYS if row.late)
"""What files of older recordings may lack."""


def dtype_of(key: str) -> type[np.float64] | type[np.int64]:
    """The element type of an array."""
    return _BY_NAME[key].element


def sizes(mechanism: Any, *, samples: int, contacts: int = 0) -> dict[str, int]:
    """The length of every axis; ``mechanism`` has its elements in lists."""
    counts = {kind.axis: len(getattr(mechanism, name)) for name, kind in NAMED.items() if kind.axis}
    return {"n": samples, "m": contacts, **counts}


def shape_of(key: str, size: Mapping[str, int]) -> tuple[int, ...]:
    """The shape of the array ``key`` for the given axis lengths."""
    return tuple(size[axis] if isinstance(axis, str) else axis for axis in _BY_NAME[key].axes)


def sample_bytes(mechanism: Any) -> int:
    """Bytes that one sample of ``mechanism`` takes, contact rows and meters left out."""
    size = sizes(mechanism, samples=1)
    return sum(math.prod(shape_of(key, size)) * np.dtype(dtype_of(key)).itemsize
               for key in PER_SAMPLE)


def contact_bytes() -> int:
    """Bytes that a contact of a sample takes."""
    size = {"m": 1}
    return sum(math.prod(shape_of(key, size)) * np.dtype(dtype_of(key)).itemsize
               for key in CONTACT)


def completed(mechanism: Any, arrays: Mapping[str, NDArray[Any]]) -> Arrays:
    """Arrays as today's recordings have them: what came late is nan where it lacks.

    What older recordings hold besides is left out.
    """
    result = {key: arrays[key] for key in (*LAYOUT, METERS) if key in arrays}
    lacking = [key for key in LATE if key not in arrays]
    if lacking and "time" in arrays:
        rows = arrays["contact_gap"].size if "contact_gap" in arrays else 0
        size = sizes(mechanism, samples=arrays["time"].size, contacts=rows)
        result |= {key: np.full(shape_of(key, size), np.nan) for key in lacking}
    return result


def faults(mechanism: Any, arrays: Mapping[str, NDArray[Any]]) -> list[str]:
    """What is wrong with a set of arrays: missing ones, wrong shapes or types, wild indices."""
    missing = [f"array {key!r} is missing" for key in LAYOUT
               if key not in arrays and key not in LATE]
    if missing:
        return missing
    size = sizes(mechanism, samples=arrays["time"].size, contacts=arrays["contact_gap"].size)
    found = []
    for key in [*LAYOUT, METERS]:
        if key not in arrays:
            continue
        array, shape = arrays[key], shape_of(key, size)
        if array.shape != shape:
            found.append(f"array {key!r} has shape {array.shape}, expected {shape}")
        elif array.dtype != dtype_of(key):
            found.append(f"array {key!r} holds {array.dtype}, expected {np.dtype(dtype_of(key))}")
    return found or _wild(arrays, size)


def _wild(arrays: Mapping[str, NDArray[Any]], size: Mapping[str, int]) -> list[str]:
    found = []
    for key, axis in (("contact_sample", "n"), ("contact_body", "nb"), ("contact_other", "nb")):
        array = arrays[key]
        if array.size and not (array.min() >= 0 and array.max() < size[axis]):
            found.append(f"array {key!r} points outside 0..{size[axis] - 1}")
    if not found and np.any(np.diff(arrays["contact_sample"]) < 0):
        found.append("array 'contact_sample' is not in order")
    return found
