"""The arrays of a recording, one row each: axes, unit, one sentence. SI.

Axes: n samples, nb bodies, nj joints, ns springs, nt tendons, nl lines, nv valves, nd drives, nm
meters, nk pairs of a load and a body, nf guides with friction, nw wheels that a tendon can lift
off, nr elements that can be released, m contact rows, p rows of means, each of nc forces, q rows
of mean contacts, k impacts.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sandbox.elements.element import NAMED

PIECE = 1 << 18  # numbers that are examined at a time: arrays may be larger than memory
Arrays = dict[str, NDArray[Any]]
Axes = tuple[str | int, ...]


@dataclass(frozen=True)
class Recorded:
    """An array of a recording; of 64-bit integers where ``points`` is set, else of floats."""

    name: str
    size: str  # names or lengths of its axes
    unit: str  # empty for numbers of rows and elements
    about: str
    # a row for each sample, once, for each contact, where there are meters; where samples are
    # several steps apart: for each sample with means of its own, each contact in its interval;
    # for each impact
    when: Literal[
        "sample", "once", "contact", "meters", "mean", "mean contact", "impact"] = "sample"
    also: Literal["", "nan", "inf"] = ""  # values besides finite ones: no value, or infinite
    points: str = ""  # the axis whose rows or elements its numbers name
    late: bool = False  # absent from the first recordings, then nan; so is every new array

    @cached_property
    def axes(self) -> Axes:
        """Names or lengths of its axes."""
        return tuple(int(axis) if axis.isdecimal() else axis for axis in self.size.split())


ARRAYS: tuple[Recorded, ...] = (
    Recorded("time", "n", "s", "time of poses and forces of a sample"),
    Recorded("body_pose", "n nb 3", "m, m, rad", "x, y, angle of the body's frame"),
    Recorded("body_velocity", "n nb 3", "m/s, m/s, rad/s", "of the centre of mass, and about it"),
    Recorded("body_acceleration", "n nb 3", "m/s^2, m/s^2, rad/s^2",
             "of the centre of mass, and about it"),
    Recorded("joint_angle", "n nj", "rad", "of `b` against `a`; nan unless a pin", also="nan"),
    Recorded("joint_rate", "n nj", "rad/s", "of that angle; nan unless a pin", also="nan"),
    Recorded("joint_length", "n nj", "m", "of an actuator; nan of others", also="nan", late=True),
    Recorded("joint_speed", "n nj", "m/s", "rate of that length", also="nan", late=True),
    Recorded("joint_reaction", "n nj", "N", "magnitude of the joint's reaction force", also="nan"),
    Recorded("joint_force", "n nj 2", "N", "on its body `b` by its body `a`, in the world; ends of "
                                           "grooves and ropes included", late=True),
    Recorded("joint_couple", "n nj", "N m", "on its body `b` by its body `a`, of welds and of what "
                                            "slides without turning; 0 of others", late=True),
    Recorded("joint_twist", "n nj 2", "N m",
             "moment on `a` and `b` besides that of these in the pose of the sample: joints answer "
             "an impact where it happens", late=True),
    Recorded("joint_stop", "n nj", "N m", "of the hard stop, in the joint's sense", also="nan"),
    Recorded("joint_damping", "n nj", "N m", "of the dampers, in the joint's sense", also="nan"),
    Recorded("joint_damping_work", "n nj", "J", "by these on the bodies since t = 0", also="nan"),
    Recorded("joint_friction", "n nj", "N m",
             "dry friction: of a pin its torque on `b`, in the joint's sense; of a slot its force "
             "on `b` [N], positive towards the groove's end; nan without", also="nan", late=True),
    Recorded("joint_friction_work", "n nj", "J", "since t = 0; nan without", also="nan", late=True),
    Recorded("joint_sticks", "n nj", "1", "1 while friction holds, else 0", also="nan", late=True),
    Recorded("spring_length", "n ns", "m", "of a rotary spring its hinge's angle [rad]"),
    Recorded("spring_force", "n ns", "N",
             "positive pulls, damper included; of a rotary spring the torque [N m], which is "
             "positive against a positive angle"),
    Recorded("spring_work", "n ns", "J", "done on the bodies since t = 0", also="nan"),
    Recorded("tendon_length", "n nt", "m", "along the path"),
    Recorded("tendon_tension", "n nt", "N",
             "never below 0; where guides hold it by friction, before its last guide"),
    Recorded("tendon_work", "n nt", "J", "done on the bodies since t = 0", also="nan"),
    Recorded("guide_friction", "n nf", "N", "tension after minus before the guide", late=True),
    Recorded("guide_slip", "n nf", "m",
             "length that has slid over such a guide since t = 0, towards the last guide; at the "
             "end of the step, half a step after the sample", late=True),
    Recorded("guide_lifted", "n nw", "", "1 while the tendon is off the wheel", late=True),
    Recorded("line_pressure", "n nl", "Pa", "gauge pressure", late=True),
    Recorded("line_volume", "n nl", "m^3", "of its chambers and hoses, by the poses", late=True),
    Recorded("line_flow", "n nl", "m^3/s",
             "into it, through valves and from drives; of a gas, at ambient pressure", late=True),
    Recorded("line_content", "n nl", "m^3",
             "content at ambient pressure, minus the volume at t = 0 at gauge pressure 0; at the "
             "end of the step", late=True),
    Recorded("line_spilled", "n nl", "m^3", "through its relief since t = 0", late=True),
    Recorded("line_work", "n nl", "J", "done on the bodies since t = 0", late=True),
    Recorded("line_ahead", "n nl", "s",
             "time after the sample at which volume and content match its pressure", late=True),
    Recorded("valve_flow", "n nv", "m^3/s", "from `a` to `b`", late=True),
    Recorded("valve_loss", "n nv", "J", "energy lost to throttling since t = 0", late=True),
    Recorded("load_force", "n nk 2", "N",
             "force of every load on every body that it acts on, in the world", late=True),
    Recorded("load_torque", "n nk", "N m", "the same about the body's centre of mass", late=True),
    Recorded("load_work", "n nk", "J", "done on the body since t = 0", late=True),
    Recorded("drive_value", "n nd", "the drive's",
             "current value; of a motor or `extend` that of the end of the step, half a step after "
             "the sample; of a rigid servo or `length` the target one step after it"),
    Recorded("drive_work", "n nd", "J", "done on the bodies since t = 0", also="nan"),
    Recorded("drive_torque", "n nd", "N m",
             "torque of a motor, brake or servo on its hinge, in the hinge's positive sense; force "
             "of `extend` and `length` on their actuator [N]; nan for other drives",
             also="nan", late=True),
    Recorded("drive_flow", "n nd", "m^3/s", "into its line; else nan", also="nan", late=True),
    Recorded("drive_power", "n nd", "W", "friction force at a conveyor surface times its speed; "
                                         "nan for other drives", also="nan", late=True),
    Recorded("held", "n nr", "1",
             "1 while engaged, 0 while released: of joints, springs and tendons that can be "
             "released, in this order; 0 also in the step in which it breaks", late=True),
    Recorded("solver_residual", "n 1", "m/s, rad/s",
             "largest residual of contacts, limits, friction and motors since the last sample",
             late=True),
    Recorded("body_centre", "nb 2", "m", "centre of mass in the body's frame", when="once"),
    Recorded("body_mass", "nb", "kg", "infinite unless free", when="once", also="inf"),
    Recorded("body_inertia", "nb", "kg m^2",
             "about the centre of mass; infinite unless free", when="once", also="inf"),
    Recorded("tendon_initial", "nt", "m", "length at t = 0", when="once"),
    Recorded("tendon_rest", "nt", "m", "rest length", when="once"),
    Recorded("contact_sample", "m", "", "row of `time`", when="contact", points="n"),
    Recorded("contact_body", "m", "", "that the force acts on", when="contact", points="nb"),
    Recorded("contact_other", "m", "", "the other body", when="contact", points="nb"),
    Recorded("contact_point", "m 2", "m", "point, in the world", when="contact"),
    Recorded("contact_force", "m 2", "N", "on the body by the other", when="contact"),
    Recorded("contact_normal", "m 2", "1", "unit vector into the body", when="contact"),
    Recorded("contact_gap", "m", "m", "gap; negative where they overlap", when="contact"),
    Recorded("contact_merged", "m", "1",
             "number of merged points; if 1, point, gap and normal are those of the two surfaces, "
             "else point and normal are resultants and the gap is the minimum",
             when="contact", late=True),
    Recorded("contact_twist", "m", "N m",
             "additional moment on the other body, from impacts between the poses of two steps",
             when="contact", late=True),
    Recorded("mean_sample", "p", "", "row of `time`: a sample whose mean may differ from the force "
                                     "of its step", when="mean", points="n"),
    Recorded("mean_force", "p nc", "N, N m",
             "means over the sample interval: for each joint `joint_force` (x, y), `joint_couple`, "
             "`joint_stop` and `joint_friction`, then `tendon_tension`, `guide_friction` and "
             "`drive_torque`; 0 where these are nan", when="mean"),
    Recorded("mean_contact_sample", "q", "",
             "row of `time`, one of `mean_sample`", when="mean contact", points="n"),
    Recorded("mean_contact_body", "q", "", "as contact_body", when="mean contact", points="nb"),
    Recorded("mean_contact_other", "q", "", "the other body", when="mean contact", points="nb"),
    Recorded("mean_contact_force", "q 7", "N m, N m, N, N, N, N, N",
             "means over the interval for each contact point: its position times the normal force "
             "magnitude (x, y), normal force (x, y), force (x, y), normal force magnitude",
             when="mean contact"),
    Recorded("impact_time", "k", "s",
             "time of the impact; without restitution the time of its step", when="impact"),
    Recorded("impact_body", "k", "", "that the impulse acts on", when="impact", points="nb"),
    Recorded("impact_other", "k", "", "the other body", when="impact", points="nb"),
    Recorded("impact_point", "k 2", "m", "point, in the world", when="impact"),
    Recorded("impact_impulse", "k 2", "N s", "on the body, of the whole step", when="impact"),
    Recorded("meter_value", "n nm", "the meter's",
             "if the scene has meters", when="meters", also="nan"),
)
METERS = "meter_value"  # optional: the meters, once they were evaluated
FORCES = 5  # means of each joint
ROWS = {"n": "time", "m": "contact_gap", "p": "mean_sample", "q": "mean_contact_sample",
        "k": "impact_time"}  # axes with an array of one number a row
LARGEST = 1e30  # larger than all simulated values; products of a few such numbers are finite
_BY_NAME = {row.name: row for row in ARRAYS}


def _axes(*when: str) -> dict[str, Axes]:
    return {row.name: row.axes for row in ARRAYS if row.when in when}


PER_SAMPLE, STATIC, CONTACT = _axes("sample"), _axes("once"), _axes("contact")
MEAN, MEAN_CONTACT, IMPACT = _axes("mean"), _axes("mean contact"), _axes("impact")
LAYOUT = _axes("sample", "once", "contact")  # arrays of every recording, except some late ones
OPTIONAL = ((METERS,), (*MEAN, *MEAN_CONTACT), tuple(IMPACT))  # of each set a file has all or none
IN_ORDER = ("contact_sample", "mean_sample", "mean_contact_sample", "impact_time")  # never fall
LATE = tuple(row.name for row in ARRAYS if row.late)


def dtype_of(key: str) -> type[np.float64] | type[np.int64]:
    """The element type of an array."""
    return np.int64 if _BY_NAME[key].points else np.float64


def sizes(mechanism: Any, **rows: int) -> dict[str, int]:
    """The length of every axis; those of :data:`ROWS` are 0 by default."""
    counts = {kind.axis: len(getattr(mechanism, name)) for name, kind in NAMED.items() if kind.axis}
    grips = sum(len(tendon.gripping) for tendon in mechanism.tendons)
    wheels = sum(len(tendon.lifting) for tendon in mechanism.tendons)
    forces = FORCES * counts["nj"] + counts["nt"] + grips + counts["nd"]
    return {**dict.fromkeys(ROWS, 0), **rows, "nc": forces, "nf": grips, "nw": wheels, **counts,
            "nk": len(mechanism.loaded), "nr": len(mechanism.releasable)}


def shape_of(key: str, size: Mapping[str, int]) -> tuple[int, ...]:
    """The shape of the array ``key`` for the given axis lengths."""
    return tuple(size[axis] if isinstance(axis, str) else axis for axis in _BY_NAME[key].axes)


def row_bytes(mechanism: Any, keys: Iterable[str]) -> int:
    """Bytes of one row of all these arrays together."""
    size = sizes(mechanism, **dict.fromkeys(ROWS, 1))
    return 8 * sum(math.prod(shape_of(key, size)) for key in keys)


def checked(mechanism: Any, given: Mapping[str, NDArray[Any]]) -> Arrays:
    """The arrays of a recording, read-only and without unknown ones; nan for missing late ones.

    Raises:
        ValueError: arrays that are missing, or have wrong shapes or indices.
    """
    wanted = [*LAYOUT, *(key for names in OPTIONAL if not given.keys().isdisjoint(names)
                         for key in names)]
    found: Arrays = {key: np.asarray(given[key], dtype=dtype_of(key)).view()
                     for key in wanted if key in given}
    _refuse(f"array {key!r} is missing" for key in wanted if key not in found and key not in LATE)
    size = sizes(mechanism, **{axis: found[key].size if key in found else 0
                               for axis, key in ROWS.items()})
    _refuse(f"array {key!r} has shape {array.shape}, expected {shape}"
            for key, array in found.items() if array.shape != (shape := shape_of(key, size)))
    _refuse(f"array {row.name!r} points outside 0..{size[row.points] - 1}" for row in ARRAYS
            if row.points and (array := found.get(row.name, np.empty(0))).size
            and (array.min() < 0 or array.max() >= size[row.points]))
    _refuse(f"array {key!r} is not in order" for key in IN_ORDER
            if key in found and (found[key][1:] < found[key][:-1]).any())
    # one nan in memory for all elements
    found |= {key: np.broadcast_to(np.nan, shape_of(key, size)) for key in LATE if key not in found}
    if "impact_time" not in found:
        found |= {key: np.zeros(shape_of(key, size), dtype_of(key)) for key in IMPACT}
    for array in found.values():
        array.setflags(write=False)
    return found


def _refuse(faults: Iterable[str]) -> None:
    if text := "; ".join(faults):
        raise ValueError(text)


def pieces(array: NDArray[Any]) -> Iterator[NDArray[Any]]:
    """Rows of an array in order, about :data:`PIECE` numbers at a time."""
    step = max(1, PIECE * len(array) // max(array.size, 1))
    for first in range(0, len(array) if array.size else 0, step):
        yield array[first:first + step]


def largest_size(array: NDArray[np.float64]) -> float:
    """Maximum absolute value, without nan; 0 of none."""
    return float(max(np.fmax.reduce(array, axis=None, initial=0.0),
                     -np.fmin.reduce(array, axis=None, initial=0.0)))
