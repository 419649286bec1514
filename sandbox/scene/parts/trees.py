"""Differentials: one pull shared among n leaves by a tree of rockers or of sliding pulleys."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import accumulate, groupby, pairwise
from typing import Annotated, Literal

from pydantic import Field

from sandbox.elements.joints import Rope, Slot
from sandbox.elements.tendons import RIGID, Guide, Tendon
from sandbox.errors import Problem
from sandbox.scene.bodies import Body, Capsule, Circle, Shape
from sandbox.scene.geometry import Vec, pose_of, to_world
from sandbox.scene.parts.expansion import Elements, Known, Leaf, PartError, PartSpec
from sandbox.scene.settings import ContactRule, Group
from sandbox.values.numbers import Angle, Damping, Items, Length, Mass, Name, Ratio, Stiffness
from sandbox.values.spec import TYPE, text_for
from sandbox.wording import NearMisses, refuse_if

MIN_DISTANCE = 1e-6  # between the strings of two leaves that need no eyes [m]
ACTUATOR_DISTANCE = 0.02  # from the root at the end of its travel to the actuator [m]


class _TreeSpec(PartSpec):
    name: Name
    """Its name; a pull drive that names it pulls ``<name>.tendon``."""
    pulls: Items[Annotated[Leaf, text_for(Leaf, "name")]] = Field(min_length=2, max_length=4096)
    """Names of fingers, tendons or bodies, in the order in which they lie side by side."""
    shares: Items[Ratio] | None = None
    """Shares of the pull, one for each leaf in any unit; by default equal."""
    direction: Angle = math.pi
    """Direction of the pull in the world [rad], counter-clockwise from +x; by default along -x."""
    pitch: Length | None = Field(default=None, ge=MIN_DISTANCE)
    """Distance of neighbouring strings, across the pull [m]; by default that of the leaves, or
    ``travel`` for leaves in one line along the pull. With a pitch each string passes two eyes of
    the tree's frame, ``gap`` behind the rearmost leaf, from its leaf's line to its own."""
    gap: Length = 0.06
    """From the rearmost leaf to the first level, along the pull [m]; with eyes, from it to them and
    from them to the first level."""
    level: Length = 0.04
    """From one level to the next, along the pull [m]."""
    travel: Length = 0.06
    """Travel of every wheel or rocker along the pull, to the end of its slot [m]."""
    mass: Mass = 0.005
    """Of each wheel or rocker [kg]."""
    stiffness: Stiffness = Field(default=RIGID, gt=0)
    """Tension per stretch of the strings [N/m]; the default counts as inextensible."""
    damping: Damping = 0.0
    """Tension per rate of stretch of the strings [N s/m]."""

    def _verify(self) -> None:
        refuse_if(self.shares is not None and (
            len(self.shares) != len(self.pulls) or min(self.shares) <= 0),
            "'shares' needs a positive number for each leaf", "out-of-range")

    @property
    def leaves(self) -> tuple[Leaf, ...]:
        return tuple(self.pulls)

    def expand(self, known: Known) -> Elements:
        assert isinstance(self, RockerTree | PulleyTree)
        return _Builder(self, known).build(known.elements + Elements())


class RockerTree(_TreeSpec):
    """Rockers on sliding pivots; a string at each end of a rocker."""

    type: Literal["rocker_tree"] = TYPE
    radius: Length = 0.003
    """Half the thickness of a rocker [m]."""
    links: Literal["tendon", "rope"] = "tendon"
    """Links of the levels: tendons, or slide-joint ropes. A string with eyes is a tendon."""


class PulleyTree(_TreeSpec):
    """Wheels on sliding centres; strings wound on their rims, equations (1)-(7)."""

    type: Literal["pulley_tree"] = TYPE


@dataclass
class Node:
    """A leaf, or a rocker or wheel with the two strings that it pulls."""

    number: int  # leaves from 0 as given, rockers from 1, lowest level first
    share: float  # of the whole pull
    across: float  # position of its string across the pull [m]
    along: float = 0.0  # position along the pull [m]
    height: int = 0
    below: tuple[Node, ...] = ()
    tendon: str = ""  # of a leaf: the tendon that the tree continues
    end: Guide | None = None  # of a leaf: the point that is pulled
    at: Vec = (0.0, 0.0)  # of a leaf: its place in the world [m]
    beside: float = 0.0  # of a leaf: its position across the pull [m]

    @property
    def arm(self) -> float:
        """The longer distance from its pivot to one of its strings [m]; 0 for a leaf."""
        return max((abs(node.across - self.across) for node in self.below), default=0.0)

    @property
    def rows(self) -> list[Node]:
        """Every rocker or wheel below and itself, lowest level first, in the order of leaves."""
        found = [node for child in self.below for node in child.rows] + [self] * bool(self.below)
        return sorted(found, key=lambda node: node.height)

    @property
    def has_eyes(self) -> bool:
        """Whether its string runs beside its leaf."""
        return not self.below and abs(self.across - self.beside) >= MIN_DISTANCE


class _Builder:
    """Expands a tree: a frame, rockers or wheels on slots along the pull, strings, a tendon."""

    def __init__(self, tree: RockerTree | PulleyTree, known: Known) -> None:
        self.tree = tree
        self.wheels = isinstance(tree, PulleyTree)
        c, s = (round(f(tree.direction), 15) for f in (math.cos, math.sin))
        self.axes = ((c, s), (-s, c))
        """Unit vectors along the pull and to its left; exact for right angles."""
        self.leaves = self._found(known)
        self.rearmost = max(leaf.along for leaf in self.leaves)
        self.root = self._planned()
        self.frame = Body(
            name=f"{tree.name}.frame", at=self._world(self.root.along, self.root.across),
            angle=tree.direction, motion="fixed", role="ground")

    def _found(self, known: Known) -> list[Node]:
        """The leaves, with strings straight behind them or, if these coincide, equally apart."""
        tree = self.tree
        tendons = {tendon.name: tendon for tendon in reversed(known.elements["tendons"])}
        bodies = {body.name: body for body in reversed(known.elements["bodies"])}
        tendon_of, shares = known.elements.tendon_of, tree.shares or (1.0,) * len(tree.pulls)
        found, problems, total, near = [], [], sum(shares), NearMisses()
        for i, (leaf, share) in enumerate(zip(tree.pulls, shares, strict=True)):
            tendon = tendons.get(tendon_of.get(leaf.name) or leaf.name)
            end = tendon.guides[-1] if tendon else Guide(body=leaf.name, at=leaf.at)
            body = bodies.get(end.body)
            if body is not None:
                at = to_world(pose_of(body), end.at)
                along, across = (at[0] * x + at[1] * y for x, y in self.axes)
                found.append(Node(i, share / total, across, along, at=at, beside=across, end=end,
                                  tendon=tendon.name if tendon else ""))
            elif known.failed.isdisjoint(accumulate(leaf.name.split("."), "{}.{}".format)):
                problems.append(Problem(
                    "name-not-found", f"no finger, tendon or body is named {leaf.name!r}",
                    path=f".pulls[{i}]",
                    hint=near(leaf.name, [*known.failed, *tendon_of, *tendons, *bodies])))
        if len(found) < len(tree.pulls):
            raise PartError(problems)
        order = sorted(found, key=lambda leaf: leaf.across)
        if tree.pitch or any(b.across - a.across < MIN_DISTANCE for a, b in pairwise(order)):
            pitch = tree.pitch or tree.travel
            first = (order[0].across + order[-1].across - pitch * (len(order) - 1)) / 2
            for rank, node in enumerate(order):
                node.across = first + pitch * rank
        return found

    def _planned(self) -> Node:
        """The root over the leaves, with the rockers or wheels of all levels."""
        def halved(nodes: list[Node]) -> Node:
            if len(nodes) == 1:
                return nodes[0]
            middle = (len(nodes) + 1) // 2
            below = (halved(nodes[:middle]), halved(nodes[middle:]))
            share = sum(node.share for node in below)
            return Node(0, share, sum(node.across * node.share for node in below) / share,
                        height=1 + max(node.height for node in below), below=below)

        leaves, gap = self.leaves, self.tree.gap
        root = halved(sorted(leaves, key=lambda node: node.across,
                             reverse=leaves[0].across > leaves[-1].across))
        along, rim = self.rearmost, 0.0
        for height, row in groupby(root.rows, key=lambda node: node.height):
            nodes = list(row)
            widest = max(node.arm for node in nodes) if self.wheels else 0.0
            first = gap * (1 + any(leaf.has_eyes for leaf in leaves))
            along = along + rim + (first if height == 1 else self.tree.level) + widest
            rim = widest
            for node in nodes:
                node.along = along
        for number, node in enumerate(root.rows):
            node.number = number + 1
        return root

    def build(self, elements: Elements) -> Elements:
        tree, nodes = self.tree, self.root.rows
        continued: dict[str, tuple[Guide, ...]] = {}
        strings: list[Tendon | Rope] = []
        for node in nodes:
            for child in node.below:
                if child.tendon:
                    continued[child.tendon] = (*continued.get(child.tendon, ()),
                                               *self._eyes(child), self._end(node, child))
                else:
                    strings.append(self._string(node, child))
        behind = (self.root.arm if self.wheels else 0.0) + tree.travel + ACTUATOR_DISTANCE
        actuator = Tendon(
            name=f"{tree.name}.tendon", stiffness=tree.stiffness, damping=tree.damping,
            guides=(Guide(body=self._name(self.root)),
                    Guide(body=self.frame.name, at=(behind, 0.0))))
        elements["tendons"] = tuple(
            tendon.model_copy(update={"guides": (*tendon.guides, *continued[tendon.name])})
            if tendon.name in continued else tendon for tendon in elements["tendons"])
        return elements + Elements(
            bodies=(self.frame, *map(self._body, nodes)),
            joints=(*map(self._slot, nodes), *(each for each in strings if isinstance(each, Rope))),
            tendons=(*(each for each in strings if isinstance(each, Tendon)), actuator),
            contacts=(ContactRule(between=(f"{tree.name}.*", "*"), collide=False),),
            groups=(Group(name=tree.name, kind=tree.type,
                          bodies=tuple(map(self._name, nodes))),))

    def _eyes(self, leaf: Node) -> tuple[Guide, ...]:
        """Guides of the frame from a leaf's line to that of its string, unless they are one."""
        along = self.rearmost + self.tree.gap - self.root.along
        return tuple(Guide(body=self.frame.name, at=(along, across - self.root.across))
                     for across in (leaf.beside, leaf.across) if leaf.has_eyes)

    def _world(self, along: float, across: float) -> Vec:
        (ax, ay), (bx, by) = self.axes
        return along * ax + across * bx, along * ay + across * by

    def _name(self, node: Node) -> str:
        return f"{self.tree.name}.{'pulley' if self.wheels else 'rocker'}{node.number}"

    def _body(self, node: Node) -> Body:
        """A rocker through its strings' ends, or a wheel, with two rims if its arms differ."""
        offsets = [child.across - node.across for child in node.below]
        shapes: tuple[Shape, ...]
        if isinstance(self.tree, RockerTree):
            start, end = (self._world(0.0, offset) for offset in offsets)
            shapes = (Capsule(start=start, end=end, radius=self.tree.radius),)
        else:
            radii = sorted((abs(offset) for offset in offsets), reverse=True)
            stepped = not math.isclose(*radii, rel_tol=1e-9)
            shapes = tuple(Circle(radius=r) for r in radii[:1 + stepped])
        return Body(
            name=self._name(node), at=self._world(node.along, node.across), shapes=shapes,
            mass=self.tree.mass, role="pulley" if self.wheels else "rocker")

    def _slot(self, node: Node) -> Slot:
        """Keeps the pivot on a line along the pull, so that the strings stay parallel."""
        along, across = node.along - self.root.along, node.across - self.root.across
        return Slot(
            name=f"{self._name(node)}_slot", a=self.frame.name, b=self._name(node),
            start=(along - self.tree.gap / 2, across), end=(along + self.tree.travel, across))

    def _end(self, node: Node, child: Node) -> Guide:
        """The end of the string of ``child``: the end of a rocker, or wound on a wheel."""
        offset = child.across - node.across
        if not self.wheels:
            return Guide(body=self._name(node), at=self._world(0.0, offset))
        side: Literal["left", "right"] = "right" if offset > 0 else "left"
        return Guide(body=self._name(node), radius=abs(offset), side=side)

    def _string(self, node: Node, child: Node) -> Tendon | Rope:
        """From a leaf's body, or from the pivot of the level before, to this level."""
        name, start, at = f"{self.tree.name}.string{child.number + 1}", child.end, child.at
        if start is None:
            name = f"{self.tree.name}.link{child.number}"
            start, at = Guide(body=self._name(child)), self._world(child.along, child.across)
        end, eyes = self._end(node, child), self._eyes(child)
        if isinstance(self.tree, RockerTree) and self.tree.links == "rope" and not eyes:
            return Rope(name=name, a=start.body, b=end.body, on_a=start.at, on_b=end.at,
                        longest=math.dist(at, self._world(node.along, child.across)))
        return Tendon(name=name, guides=(start, *eyes, end), stiffness=self.tree.stiffness,
                      damping=self.tree.damping)
