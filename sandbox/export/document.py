"""A MuJoCo model under construction: XML text, unique names, sections, elements on bodies."""

from __future__ import annotations

import dataclasses
import xml.etree.ElementTree as ET
from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import cast

import numpy as np

from sandbox.export.tree import Freedom, Tree, angle_sum, freedoms
from sandbox.model.model import NONE, Model
from sandbox.scene.geometry import Vec, to_world
from sandbox.values.signals import Constant, values

DIGITS = 12


def number(value: float) -> str:
    """A number with :data:`DIGITS` digits; never ``-0``."""
    return f"{value + 0.0:.{DIGITS}g}" if value else "0"


# of an attribute: a word, a number, or numbers in a row; None leaves it out
Value = str | float | Sequence[float] | None


def element(tag: str, /, **attributes: Value) -> ET.Element:
    """A new element."""
    return ET.Element(tag, {
        key: _plain(value) if isinstance(value, str) else
        number(value) if isinstance(value, int | float) else " ".join(map(number, value))
        for key, value in attributes.items() if value is not None})


def add(parent: ET.Element, tag: str, /, **attributes: Value) -> ET.Element:
    """A new element (see :func:`element`) at the end of ``parent``."""
    made = element(tag, **attributes)
    parent.append(made)
    return made


def _plain(text: str, kept: str = "") -> str:
    """The text with blanks for characters that do not print, except ``kept``."""
    return "".join(c if c.isprintable() or c in kept else " " for c in text)


def comment(text: str) -> ET.Element:
    """A comment; text that XML forbids is replaced."""
    plain = _plain(text, "\n")
    while "--" in plain:
        plain = plain.replace("--", "- -")
    return cast("ET.Element", ET.Comment(f" {plain} "))


def document(root: ET.Element) -> str:
    """The text of a file, indented by two spaces; empty sections are dropped."""
    for section in list(root):
        if not len(section) and not section.attrib and not section.text:
            root.remove(section)
    ET.indent(root, "  ")
    return ET.tostring(root, encoding="unicode", xml_declaration=False) + "\n"


SECTIONS = ("compiler", "option", "default", "asset", "worldbody", "contact", "equality", "tendon",
            "actuator", "sensor", "keyframe")
WORLD = "world"  # MuJoCo's name of the fixed frame


class Draft:
    """Sections by name, elements on bodies by index (``NONE`` for the world), and notes."""

    MAX_FORCE = 1e6  # a force that no tendon reaches [N], as MuJoCo needs closed ranges

    def __init__(self, model: Model, tree: Tree) -> None:
        self.model, self.tree, self.mechanism = model, tree, model.mechanism
        elements = (model.bodies, model.joints, model.springs, model.tendons, model.drives)
        self._taken = {(kind, name) for part in elements for name in (WORLD, *part.name)
                       for kind in ("body", "joint", "site", "geom", "mesh", "sensor")}
        self.root = ET.Element("mujoco", {"model": self.mechanism.name or "mechanism"})
        self.sections = {name: add(self.root, name) for name in SECTIONS}
        # sites and pulleys, until the bodies are written
        self.on_body: dict[int, list[ET.Element]] = {
            body: [] for body in (NONE, *range(len(model.bodies.name)))}
        self.coils: dict[int, list[int]] = defaultdict(list)  # rotary springs of a hinge
        self.brakes: dict[int, float] = {}  # torque of a hinge's brake [N m]
        self.driven: set[int] = set()  # hinges with a torque
        self.controls: list[float] = []  # value of every actuator at the end of the run
        self.notes: list[str] = []
        self.body_names = [
            self.unique("body", name) if name == WORLD else name for name in model.bodies.name]
        # coordinates of every body, with unique names
        self.moves = {body: [
            dataclasses.replace(move, name=self.unique("joint", move.name))
            if move.made else move for move in freedoms(model, link)
        ] for body, link in tree.links.items()}
        self._world_frame = ""

    def unique(self, kind: str, name: str) -> str:
        """A new name of a joint, site ...: ``name``, with ``_`` appended until it is free."""
        while (kind, name) in self._taken:
            name += "_"
        self._taken.add((kind, name))
        return name

    def coordinates(self) -> Iterator[Freedom]:
        """All coordinates in MuJoCo's order, depth first."""
        waiting = [NONE]
        while waiting:
            body = waiting.pop()
            yield from self.moves.get(body, [])
            waiting += [child for child, link in self.tree.links.items()
                        if link.parent == body][::-1]

    def assembled(self, body: int, point: Vec) -> Vec:
        """A point of a body in the world [m], with every joint assembled as in MuJoCo."""
        for link in self.tree.line(body):
            point = to_world(link.pose, point)
        return point

    def carried(self, joint: int) -> bool:
        """Whether a joint carries a body; otherwise it closes a loop."""
        return any(link.joint == joint for link in self.tree.links.values())

    def site(self, body: int, wanted: str, at: Vec = (0.0, 0.0), **more: str | float) -> str:
        """Add a site to a body and return its name."""
        name = self.unique("site", wanted)
        self.on_body[body].append(element("site", name=name, pos=(*at, 0.0), **more))
        return name

    def world_frame(self) -> str:
        """The name of a site with the axes of the world."""
        self._world_frame = self._world_frame or self.site(NONE, "frame")
        return self._world_frame

    def sense(self, kind: str, wanted: str, **what: str) -> None:
        """Add a sensor."""
        add(self.sections["sensor"], kind, name=self.unique("sensor", wanted), **what)

    def target(self, drive: int) -> int:
        """The number of the element that a drive acts on."""
        return int(self.model.drives.target[drive])

    def drive_hinge(self, drive: int) -> dict[str, str]:
        """Attribute of an actuator of a hinge: its joint, or the tendon of a closed loop."""
        joint = self.target(drive)
        self.driven.add(joint)
        return {"joint" if self.carried(joint) else "tendon": self.model.joints.name[joint]}

    def angle_offset(self, drive: int) -> float:
        """Angle minus coordinate of a hinge that closes a loop [rad]."""
        return angle_sum(self.model, self.target(drive), self.tree, self.moves)[1]

    def final_value(self, drive: int) -> float:
        """Value of a drive at the end of the run, SI."""
        signal = self.mechanism.drives[drive].signal(self.mechanism)
        end = np.array([self.mechanism.run.duration])
        return float(values(signal, end, self.mechanism.functions)[0])

    def motor(
        self, drive: int, what: str = "motor", gives: str = "value", **attributes: Value,
    ) -> None:
        """Add an actuator whose control is the value of a drive; note a value that varies.

        ``what`` is its tag, ``gives`` the quantity of the drive that is its force.
        """
        section, name = self.sections["actuator"], self.model.drives.name[drive]
        signal = self.mechanism.drives[drive].signal(self.mechanism)
        end = self.final_value(drive)
        if not isinstance(signal, Constant):
            law = signal.model_dump_json(exclude_defaults=True)
            section.append(comment(f"{name} over time: {law}; {number(end)} at the end of the run"))
            self.notes.append(f"{name}: MuJoCo has no signals over time; the keyframe has the last "
                              f"value, {number(end)}")
        add(section, what, name=name, **attributes)
        self.controls.append(max(end, float(self.model.drives.floor[drive])))
        self.sense("actuatorfrc", f"{name}.{gives}", actuator=name)
