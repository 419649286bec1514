"""A MuJoCo model under construction: XML text, unique names, sections, elements on bodies."""

from __future__ import annotations

import dataclasses
import xml.etree.ElementTree as ET
from collections import defaultdict
from collections.abc import Iterable, Sequence
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


Value = str | float | Sequence[float] | None
"""Of an attribute: a word, a number, or numbers in a row; None leaves it out."""


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


class UniqueNames:
    """New names that differ from all names of the scene, by kind of object (joint, site …)."""

    def __init__(self, reserved: Iterable[str]) -> None:
        self._reserved = frozenset(reserved)
        self._given: dict[str, set[str]] = {}

    def made(self, kind: str, wanted: str) -> str:
        """The name ``wanted``, with ``_`` appended until it is free."""
        taken = self._given.setdefault(kind, set())
        name = wanted
        while name in taken or name in self._reserved:
            name += "_"
        taken.add(name)
        return name


SECTIONS = ("compiler", "option", "default", "asset", "worldbody", "contact", "equality", "tendon",
            "actuator", "sensor", "keyframe")
WORLD = "world"  # MuJoCo's name of the fixed frame


class Draft:
    """Sections by name, elements on bodies by index (``NONE`` for the world), and notes."""

    MAX_FORCE = 1e6
    """A force that no tendon reaches [N], as MuJoCo needs closed ranges."""

    def __init__(self, model: Model, tree: Tree) -> None:
        self.model = model
        self.mechanism = model.mechanism
        self.tree = tree
        elements = (model.bodies, model.joints, model.springs, model.tendons, model.drives)
        self.names = UniqueNames({WORLD, *(name for part in elements for name in part.name)})
        self.root = ET.Element("mujoco", {"model": self.mechanism.name or "mechanism"})
        self.sections = {name: add(self.root, name) for name in SECTIONS}
        self.on_body: dict[int, list[ET.Element]] = {
            body: [] for body in (NONE, *range(len(model.bodies.name)))}
        """Sites and pulleys, until the bodies are written."""
        self.coils: dict[int, list[int]] = defaultdict(list)  # Rotary springs of a hinge
        self.brakes: dict[int, float] = {}  # Torque of a hinge's brake [N m]
        self.driven: set[int] = set()  # Hinges with a torque
        self.controls: list[float] = []  # Value of every actuator at the end of the run
        self.notes: list[str] = []
        self.body_names = [
            self.names.made("body", name) if name == WORLD else name for name in model.bodies.name]
        self.moves = {body: [
            dataclasses.replace(move, name=self.names.made("joint", move.name))
            if move.made else move for move in freedoms(model, link)
        ] for body, link in tree.links.items()}  # Coordinates of every body, with unique names
        self._world_frame = ""

    def coordinates(self) -> list[Freedom]:
        """All coordinates in MuJoCo's order, depth first."""
        children: dict[int, list[int]] = {body: [] for body in (NONE, *self.tree.links)}
        for body, link in self.tree.links.items():
            children[link.parent].append(body)
        found: list[Freedom] = []
        waiting = children[NONE][::-1]
        while waiting:
            body = waiting.pop()
            found += self.moves[body]
            waiting += children[body][::-1]
        return found

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
        name = self.names.made("site", wanted)
        self.on_body[body].append(element("site", name=name, pos=(*at, 0.0), **more))
        return name

    def world_frame(self) -> str:
        """The name of a site with the axes of the world."""
        self._world_frame = self._world_frame or self.site(NONE, "frame")
        return self._world_frame

    def sense(self, kind: str, wanted: str, **what: str) -> None:
        """Add a sensor."""
        add(self.sections["sensor"], kind, name=self.names.made("sensor", wanted), **what)

    def target(self, drive: int) -> int:
        """The number of the element that a drive acts on."""
        return int(self.model.drives.target[drive])

    def drive_hinge(self, drive: int) -> dict[str, str]:
        """What an actuator of a hinge acts on: a joint, or the tendon of one that closes a loop."""
        joint = self.target(drive)
        self.driven.add(joint)
        return {"joint" if self.carried(joint) else "tendon": self.model.joints.name[joint]}

    def angle_offset(self, drive: int) -> float:
        """What the coordinate of a hinge that closes a loop lacks of its angle [rad]."""
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

        Args:
            drive: number of the drive.
            what: the tag of the actuator.
            gives: the quantity of the drive that its force is.
            attributes: of the actuator.
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
