"""The kinds of element, one row each; every room reads here what it has to know of a kind.

A row is found by the tag that a spec's ``type`` holds: ``JOINTS[joint.type]``. What
a row records is spelled out in :mod:`sandbox.elements.quantities`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

LEAST_RADIUS = 1e-9
"""Of a circle that a drive makes smaller [m]."""
ATMOSPHERE = 101325.0
"""What the surroundings press with [Pa]: a pressure of 0 is theirs."""
GRAZE = 1e-9
"""An angle of wrap [rad] below which a cord touches its wheel in one point."""


@dataclass(frozen=True)
class Named:
    """One of a mechanism's lists of elements that have names, all in one space."""

    one: str
    """What one element of it is called."""
    axis: str = ""
    """The axis of recorded arrays that counts them; empty where nothing has it."""


NAMED: Mapping[str, Named] = {
    "bodies": Named("body", "nb"), "joints": Named("joint", "nj"), "springs": Named("spring", "ns"),
    "tendons": Named("tendon", "nt"), "lines": Named("line", "nl"),
    "valves": Named("valve", "nv"), "loads": Named("load", "nk"), "drives": Named("drive", "nd"),
    "controllers": Named("controller"), "events": Named("event"), "groups": Named("group"),
    "meters": Named("meter", "nm"),
}
TIES = "ties"
"""As the list among which something is found: all of :data:`RELEASABLE`."""
HELD_ABOVE = 0.5
"""The value above which a drive holds."""
LISTS = ("bodies", "joints", "springs", "tendons", "lines", "valves", "loads", "drives",
         "controllers", "events", "contacts", "groups", "meters", "expect")
"""All lists of a mechanism, in its order."""
RELEASABLE = ("joints", "springs", "tendons")
"""Lists of what a run may let go, in the order in which recordings have these."""


@dataclass(frozen=True)
class Target:
    """The field of a spec that names what it acts on."""

    field: str
    among: str
    """The list in which it is found, or :data:`TIES`."""
    hinge: bool = False
    """Only a joint with an angle will do."""
    line: bool = False
    """Only a joint with a length that drives set will do."""


Keeps = Literal["point", "groove", "distance", "range", "gear", "rack", "roll"]
Gives = Literal["force", "torque", "push", "tension", "radius", "stiffness", "flow", "pressure",
                "opening", "surface", "hold"]


@dataclass(frozen=True)
class JointKind:
    """What every joint of a kind keeps of the motion of ``b`` against ``a``."""

    keeps: Keeps
    """Two points together; a point of ``b`` on a line of ``a``; two points at one distance, or
    between a least and a largest one; the teeth of two gears, or of a gear and a rack, together;
    two circles that touch and roll."""
    records: tuple[str, ...]
    line: bool = False
    """Whether it has a length: then it may have drives that push, and set that."""
    angle: bool = False
    """Whether it has an angle: then it may have stops, springs, torques, brakes and motors."""
    stopped: tuple[str, ...] = ()
    """What it records besides where it has stops."""
    loose: tuple[str, ...] = ()
    """What it records besides where its teeth have play."""
    rubs: str = ""
    """Unit of its dry friction; empty where it has none."""
    rubbed: tuple[str, ...] = ()
    """What it records besides where it has dry friction."""
    mujoco: str = ""
    """Why MuJoCo has no counterpart; empty where it has one."""
    mujoco_loop: str = ""
    """Why it has none where the joint closes a loop, though where it carries a body."""

    @property
    def forces(self) -> int:
        """Components of its reaction that are not known beforehand; along a line there is one."""
        return 2 if self.keeps in ("point", "roll") else 1

    @property
    def wheels(self) -> bool:
        """Whether its bodies push one another where two wheels meet, or a wheel and a rack."""
        return self.teeth or self.keeps == "roll"

    @property
    def teeth(self) -> bool:
        """Whether these are teeth, of two gears or of a gear and a rack."""
        return self.keeps in ("gear", "rack")

    @property
    def along_line(self) -> bool:
        """Whether it pushes and pulls along the line through its two points."""
        return self.keeps in ("distance", "range")


_TEETH = "teeth: what it couples are joint angles, which push no bearing"
_REACTION = ("reaction", "reaction_x", "reaction_y")
_MESH = (*_REACTION, "tangential", "radial")
_RUBBED = ("friction", "friction_work", "sticks")
JOINTS: Mapping[str, JointKind] = {
    "pin": JointKind("point", ("angle", "rate", *_REACTION, "damping", "damping_work"),
                     angle=True, stopped=("stop",), rubs="N m", rubbed=_RUBBED),
    "slot": JointKind("groove", _REACTION, rubs="N", rubbed=_RUBBED,
                      mujoco_loop="a groove that closes a loop"),
    "weld": JointKind("point", _REACTION),
    "rod": JointKind("distance", (*_REACTION, "tension")),
    "rope": JointKind("range", (*_REACTION, "tension")),
    "actuator": JointKind("range", ("length", "speed", *_REACTION), line=True),
    "gear": JointKind("gear", _MESH, loose=("gap",), mujoco=_TEETH),
    "rack": JointKind("rack", _MESH, loose=("gap",), mujoco=_TEETH),
    "roll": JointKind("roll", _MESH, mujoco="circles that roll on one another as a joint"),
}


@dataclass(frozen=True)
class SpringKind:
    """How springs of a kind act."""

    targets: tuple[Target, ...]
    unit: str
    """Of its stiffness."""
    dimension: str
    records: tuple[str, ...]
    straight: bool
    """From point to point; otherwise about a hinge."""
    mujoco: str = ""
    """Why MuJoCo has no counterpart; empty where it has one."""


SPRINGS: Mapping[str, SpringKind] = {
    "linear": SpringKind((Target("a", "bodies"), Target("b", "bodies")), "N/m", "stiffness",
                         ("length", "force", "work"), straight=True),
    "rotary": SpringKind((Target("joint", "joints", hinge=True),), "N m/rad", "rotary stiffness",
                         ("angle", "torque", "work"), straight=False),
}


@dataclass(frozen=True)
class DriveKind:
    """What drives of a kind set, and how the mechanism feels it."""

    target: Target
    gives: Gives
    """A force on a body, a torque between the two bodies of a hinge, a push between the two points
    of an actuator, and so on."""
    unit: str
    """Of its value; empty where that is its spring's."""
    dimension: str
    records: tuple[str, ...] = ("value", "work")
    floor: float = -math.inf
    """The least value that is in force: what is set below counts as this."""
    sole: str = ""
    """What no other drive may set of the same target; empty where several add up."""
    limited: bool = False
    """Whether the solver works out what it gives, up to a torque or force."""
    places: bool = False
    """Whether its value is a place that it goes to; otherwise, of a limited one, a rate or a
    limit."""
    latched: bool = False
    """Whether pymunk keeps its value from step to step, so that it must be given each change."""
    timely: Literal["pose", "end"] = "pose"
    """The instant of a step that its value is taken at: that of the pose, or the step's end."""
    twin: str = ""
    """Of drives of hinges the kind that does the same to an actuator, and the other way round."""
    mujoco: str = ""
    """Why MuJoCo has no counterpart; empty where it has one."""
    mujoco_varied: str = ""
    """Why it has none of a value that varies, though of a constant one."""


LOOSE = "what is let go, breaks or is taken up"
"""Why MuJoCo has none of these."""
FLUID = "fluid under pressure in lines"
"""Why MuJoCo has none of these."""
LAW = "a load by a law of a body's own motion"
"""Why it has none of these."""
_ON_HINGE = Target("joint", "joints", hinge=True)
_ON_LINE = Target("joint", "joints", line=True)
DRIVES: Mapping[str, DriveKind] = {
    "force": DriveKind(Target("body", "bodies"), "force", "N", "force"),
    "torque": DriveKind(_ON_HINGE, "torque", "N m", "torque", ("value", "work", "power"),
                        twin="push"),
    "pull": DriveKind(Target("tendon", "tendons"), "tension", "N", "force", floor=0.0,
                      sole="tension"),
    "radius": DriveKind(Target("body", "bodies"), "radius", "m", "length", floor=LEAST_RADIUS,
                        sole="radius", latched=True, mujoco="a radius that changes"),
    "stiffness": DriveKind(Target("spring", "springs"), "stiffness", "", "", ("value",), floor=0.0,
                           sole="stiffness", mujoco="a stiffness that is set"),
    "motor": DriveKind(_ON_HINGE, "torque", "rad/s", "angular speed",
                       ("value", "work", "torque", "power"), sole="motor", limited=True,
                       timely="end", twin="extend", mujoco="a motor of a set speed or with a line"),
    "brake": DriveKind(_ON_HINGE, "torque", "N m", "torque", ("value", "work", "torque", "power"),
                       floor=0.0, sole="brake", limited=True,
                       mujoco_varied="a brake that changes"),
    "servo": DriveKind(_ON_HINGE, "torque", "rad", "angle", ("value", "work", "torque", "power"),
                       sole="motor", limited=True, places=True, twin="length"),
    "push": DriveKind(_ON_LINE, "push", "N", "force", ("value", "work", "power"), twin="torque"),
    "extend": DriveKind(_ON_LINE, "push", "m/s", "speed", ("value", "work", "force", "power"),
                        sole="length", limited=True, timely="end", twin="motor",
                        mujoco="an actuator of a set speed"),
    "length": DriveKind(_ON_LINE, "push", "m", "length", ("value", "work", "force", "power"),
                        sole="length", limited=True, places=True, twin="servo"),
    "flow": DriveKind(Target("line", "lines"), "flow", "m^3/s", "flow", ("value", "work", "flow"),
                      mujoco=FLUID),
    "pressure": DriveKind(Target("line", "lines"), "pressure", "Pa", "pressure",
                          ("value", "work", "flow"), sole="pressure", mujoco=FLUID),
    "opening": DriveKind(Target("valve", "valves"), "opening", "1", "ratio", ("value",),
                         floor=0.0, sole="opening", mujoco=FLUID),
    "surface": DriveKind(Target("body", "bodies"), "surface", "m/s", "speed",
                         ("value", "work", "power"), sole="surface", timely="end",
                         mujoco="a surface that runs"),
    "hold": DriveKind(Target("element", TIES), "hold", "1", "ratio", ("value",), sole="hold",
                      mujoco=LOOSE),
}
ON_TENDON: Mapping[str, DriveKind] = {
    "stiffness": replace(DRIVES["stiffness"], target=Target("tendon", "tendons"), unit="N/m",
                         dimension="stiffness"),
}
"""Rows of drives that may name a tendon in place of what they act on by :data:`DRIVES`."""
