"""The expansion of parts: plain elements by kind, in order."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from sandbox.errors import Problem, SceneError
from sandbox.scene.bodies import Body
from sandbox.scene.mechanism import ElementLists
from sandbox.values.numbers import Name, Point
from sandbox.values.paths import JsonPath
from sandbox.values.spec import Spec
from sandbox.wording import NearMisses, quoted

if TYPE_CHECKING:
    from sandbox.scene.document import Assembly, Scene

OWN = tuple(kind for kind in ElementLists.model_fields
            if kind not in ("materials", "drives", "contacts", "groups"))
"""Lists whose elements come before those of parts; a scene's contact rules come after."""


class Elements(dict[str, tuple[Any, ...]]):
    """Plain elements of a mechanism by kind, in order; materials are pairs of name and material.

    ``paths`` tells where each was written; it is that of the part for one that the part makes.
    """

    def __init__(
        self, paths: Mapping[str, Sequence[JsonPath]] = {}, **lists: tuple[Any, ...],
    ) -> None:
        super().__init__({kind: lists.get(kind, ()) for kind in ElementLists.model_fields})
        self.paths = {kind: paths.get(kind) or [()] * len(self[kind]) for kind in self}

    def __add__(self, other: Elements) -> Elements:
        return Elements({kind: [*self.paths[kind], *other.paths[kind]] for kind in self},
                        **{kind: self[kind] + other[kind] for kind in self})

    @property
    def tendon_of(self) -> dict[str, str]:
        """The tendons that parts made, which drives and trees name by the part, by these names."""
        return {each.name.removesuffix(".tendon"): each.name
                for each, path in zip(self["tendons"], self.paths["tendons"], strict=True)
                if path[-2:-1] == ("parts",) and each.name.endswith(".tendon")}

    def body(self, name: str) -> Body | None:
        """The body of that name."""
        return next((body for body in self["bodies"] if body.name == name), None)


@dataclass
class PartError(Exception):
    """Problems of one part; their paths start at the part itself."""

    problems: list[Problem]


@dataclass(frozen=True)
class Known:
    """Elements and names that a part may refer to while it is expanded."""

    elements: Elements = field(default_factory=Elements)  # all elements so far
    failed: frozenset[str] = frozenset()
    """Parts that could not be built; parts that depend on them are not reported."""
    pulled: frozenset[str] = frozenset()  # parts and tendons that trees pull, by their names here
    outside: Callable[[str], Body | None] = lambda name: None
    """Returns a body outside an assembly, in the frame of its surroundings."""
    near: NearMisses = field(default_factory=NearMisses)


class Leaf(Spec):
    """A leaf of a tree: a finger, a tendon (at its last guide), or a point of a body."""

    name: Name
    """Name of a finger, a tendon, a tree or a body."""
    at: Point = (0.0, 0.0)
    """Of a body: the point that is pulled, in its frame [m]."""


class PartSpec(Spec):
    """The base of parts."""

    name: Name
    """Its name, with which those of its elements begin."""

    @property
    def leaves(self) -> tuple[Leaf, ...]:
        """What it pulls; a part that pulls others is expanded after them."""
        return ()

    def expand(self, known: Known) -> Elements:
        """All elements so far, and those of the part."""
        raise NotImplementedError


def expand_parts(scene: Scene | Assembly, around: Known) -> Elements:
    """The elements of a scene or assembly, not placed, with what is known around it.

    Raises:
        PartError: problems of its parts; their paths start at the scene or assembly.
    """
    def written(*kinds: str) -> Elements:
        lists = {kind: getattr(scene, kind) for kind in kinds}
        return Elements({kind: [(kind, i) for i in range(len(lists[kind]))] for kind in kinds},
                        **lists)

    elements = written(*OWN) + Elements(materials=tuple(scene.materials.items()))
    pulled = around.pulled | {leaf.name for part in scene.parts for leaf in part.leaves}
    problems: list[Problem] = []
    pullers: dict[tuple[str, tuple[float, float]], str] = {}
    first: dict[str, int] = {}
    for i, part in enumerate(scene.parts):
        if first.setdefault(part.name, i) != i:
            problems.append(Problem("duplicate-name", f"the name {quoted(part.name)} is taken by "
                                    f"parts[{first[part.name]}]", f".parts[{i}].name",
                                    allowed="a unique name for every part"))
        for j, leaf in enumerate(part.leaves):
            key, path = (leaf.name.removesuffix(".tendon"), leaf.at), f".parts[{i}].pulls[{j}]"
            if key in pullers:  # a tendon has one end
                problems.append(Problem("set-twice", f"{leaf.name!r} is pulled already, by "
                                        f"${pullers[key]}", path=path))
            pullers.setdefault(key, path)
    failed: set[str] = set()
    for i, part in sorted(enumerate(scene.parts), key=lambda item: bool(item[1].leaves)):
        try:
            expanded = part.expand(Known(
                elements, frozenset(failed), pulled, around.outside, around.near))
            expanded.paths = {kind: [*known, *(("parts", i, *path) for path in
                                               expanded.paths[kind][len(known):])]
                              for kind, known in elements.paths.items()}
            elements = expanded
        except PartError as error:
            failed.add(part.name)
            problems += [dataclasses.replace(problem, path=f".parts[{i}]{problem.path}")
                         for problem in error.problems]
        except (SceneError, ArithmeticError) as error:
            failed.add(part.name)
            reasons = [each.message for each in error.problems] if isinstance(error, SceneError) \
                else ["its numbers are too large or too small"]
            problems += [Problem("bad-part", f"this part cannot be built: {why}", f".parts[{i}]")
                         for why in reasons]
    if problems:
        raise PartError(problems)
    own, tendon_of = written("drives"), elements.tendon_of
    own["drives"] = tuple(
        drive.model_copy(update={"tendon": tendon_of[drive.target[1]]})
        if drive.target[0].among == "tendons" and drive.target[1] in tendon_of else drive
        for drive in scene.drives)
    return own + elements + written("contacts", "groups")
