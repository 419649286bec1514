"""A MuJoCo model in the making: its sections, the tree, and what the bodies still have to hold."""

from __future__ import annotations

import dataclasses
import xml.etree.ElementTree as ET
from collections import defaultdict

from sandbox.export.freedoms import Freedom, freedoms
from sandbox.export.names import UniqueNames
from sandbox.export.tree import Tree, pose
from sandbox.export.xmltext import add, element
from sandbox.model.model import NONE, Model
from sandbox.scene.geometry import Vec, to_world

SECTIONS = ("compiler", "option", "default", "asset", "worldbody", "contact", "equality", "tendon",
            "actuator", "sensor", "keyframe")
WORLD = "world"
"""MuJoCo's own name of what does not move."""


@dataclasses.dataclass
class Hinge:
    """What springs and drives of the scene do in a hinge."""

    springs: list[int] = dataclasses.field(default_factory=list)
    """Rotary ones, by number."""
    brake: float | None = None
    """The torque up to which it is held [N m]; None without a brake."""
    driven: bool = False
    """Whether a torque drives it."""


class Draft:
    """Sections by name; what stands on a body by the body's number, ``NONE`` for the world."""

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
        """Sites and wheels, until the bodies are written."""
        self.hinges: dict[int, Hinge] = defaultdict(Hinge)
        """By the number of the joint."""
        self.controls: list[float] = []
        """Of every actuator its value at the end of the run."""
        self.notes: list[str] = []
        self.body_names = [
            self.names.made("body", name) if name == WORLD else name for name in model.bodies.name]
        self.moves = {body: self._named(freedoms(model, link))
                      for body, link in tree.links.items()}
        self._world_frame = ""

    def _named(self, moves: list[Freedom]) -> list[Freedom]:
        """Coordinates under names that no other joint of the model has."""
        return [
            dataclasses.replace(move, name=self.names.made("joint", move.name))
            if move.made else move for move in moves
        ]

    def coordinates(self) -> list[Freedom]:
        """All coordinates as MuJoCo numbers them: down one branch of the tree after the other."""
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
        """A body's point in the world [m] where MuJoCo starts: with every joint assembled."""
        for link in self.tree.line(body):
            point = to_world(link.pose, point)
        return point

    def carried(self, joint: int) -> bool:
        """Whether a joint is one of the tree; otherwise it closes a loop."""
        return any(link.joint == joint for link in self.tree.links.values())

    def site(self, body: int, wanted: str, at: Vec = (0.0, 0.0), **more: str | float) -> str:
        """Put a site on a body; its name."""
        name = self.names.made("site", wanted)
        self.on_body[body].append(element("site", name=name, pos=(*at, 0.0), **more))
        return name

    def world_frame(self) -> str:
        """The site whose axes are the world's; made when it is first asked for."""
        self._world_frame = self._world_frame or self.site(NONE, "frame")
        return self._world_frame

    def world(self, body: int, point: Vec) -> Vec:
        """A body's point in the world at t = 0 [m], as the scene has it."""
        return to_world(pose(self.model, body), point)

    def sense(self, kind: str, wanted: str, **what: str) -> None:
        """Add a sensor."""
        add(self.sections["sensor"], kind, name=self.names.made("sensor", wanted), **what)
