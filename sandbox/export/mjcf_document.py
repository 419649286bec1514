"""A MuJoCo model in the making: its sections, the tree, and what the bodies still have to hold."""

from __future__ import annotations

import dataclasses
import xml.etree.ElementTree as ET

from sandbox.export.freedoms import Freedom, freedoms
from sandbox.export.names import Names
from sandbox.export.omission import elements
from sandbox.export.tree import Tree
from sandbox.export.xmltext import add, element
from sandbox.scene.elements.joints import Pin
from sandbox.scene.geometry import Vec, pose_of, to_world
from sandbox.scene.mechanism import Mechanism

SECTIONS = ("compiler", "option", "default", "asset", "worldbody", "contact", "equality", "tendon",
            "actuator", "sensor", "keyframe")
WORLD = "world"
"""MuJoCo's own name of what does not move."""


class Draft:
    """Sections by name; sites and wheels by the body that will hold them ("" is the world)."""

    def __init__(self, mechanism: Mechanism, tree: Tree) -> None:
        self.mechanism = mechanism
        self.tree = tree
        self.bodies = {body.name: body for body in mechanism.bodies}
        self.names = Names({WORLD, *(each.name for each in elements(mechanism))})
        self.root = ET.Element("mujoco", {"model": mechanism.name or "mechanism"})
        self.sections = {name: add(self.root, name) for name in SECTIONS}
        self.held: dict[str, list[ET.Element]] = {name: [] for name in ("", *self.bodies)}
        self.turns: set[str] = set()
        """Pins that close a loop and have a tendon of their own name for their angle."""
        self.notes: list[str] = []
        self.body_names = {
            name: self.names.made("body", name) if name == WORLD else name for name in self.bodies}
        self.moves = {name: self._named(freedoms(link, self.bodies))
                      for name, link in tree.links.items()}

    def _named(self, moves: list[Freedom]) -> list[Freedom]:
        """Coordinates under names that no other joint of the model has."""
        return [
            dataclasses.replace(move, name=self.names.made("joint", move.name))
            if move.made else move for move in moves
        ]

    def coordinates(self) -> list[Freedom]:
        """All coordinates as MuJoCo numbers them: down one branch of the tree after the other."""
        children: dict[str, list[str]] = {name: [] for name in ("", *self.tree.links)}
        for name, link in self.tree.links.items():
            children[link.parent].append(name)
        found: list[Freedom] = []
        waiting = children[""][::-1]
        while waiting:
            name = waiting.pop()
            found += self.moves[name]
            waiting += children[name][::-1]
        return found

    def assembled(self, body: str, point: Vec) -> Vec:
        """A body's point in the world [m] where MuJoCo starts: with every joint assembled."""
        for link in self.tree.line(body):
            point = to_world(link.pose, point)
        return point

    def carried(self, pin: Pin) -> bool:
        """Whether a pin is a joint of the tree; otherwise it closes a loop."""
        return any(move.pin is pin for name in (pin.a, pin.b) for move in self.moves[name])

    def site(self, body: str, wanted: str, at: Vec = (0.0, 0.0), **more: str | float) -> str:
        """Put a site on a body; its name."""
        name = self.names.made("site", wanted)
        self.held[body].append(element("site", name=name, pos=(*at, 0.0), **more))
        return name

    def world(self, body: str, point: Vec) -> Vec:
        """A body's point in the world at t = 0 [m], as the scene has it."""
        return to_world(pose_of(self.bodies[body]), point)

    def sense(self, kind: str, wanted: str, **what: str) -> None:
        """Add a sensor."""
        add(self.sections["sensor"], kind, name=self.names.made("sensor", wanted), **what)
