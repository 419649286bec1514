"""Expansion of the parts of scenes and assemblies."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from sandbox.errors import Problem, SceneError
from sandbox.scene.bodies import Body
from sandbox.scene.mechanism import ElementLists
from sandbox.scene.parts.expansion import Elements, Known, PartError
from sandbox.scene.parts.placement import Mover, Placement
from sandbox.scene.settings import Group
from sandbox.wording import quoted

if TYPE_CHECKING:
    from sandbox.scene.document import Assembly, Scene

PLACED = ("bodies", "joints", "springs", "tendons", "lines", "loads", "drives")
KINDS = tuple(kind for kind in ElementLists.model_fields if kind != "materials")
OWN = tuple(kind for kind in KINDS if kind not in ("drives", "contacts", "groups"))
"""Lists whose elements come before those of parts; a scene's contact rules come after."""


def expand_parts(scene: Scene | Assembly, around: Known) -> tuple[Elements, list[Problem]]:
    """The elements of a scene or assembly, not placed, with what is known around it."""
    elements = Elements(materials=tuple(scene.materials.items()),
                        **{kind: getattr(scene, kind) for kind in OWN})
    tendon_of = {name: tendon for part in scene.parts for name, tendon in part.tendon_names.items()}
    pulled = around.pulled | {leaf.name for part in scene.parts for leaf in part.leaves}
    problems: list[Problem] = []
    pullers: dict[tuple[str, tuple[float, float]], str] = {}
    first: dict[str, int] = {}
    for i, part in enumerate(scene.parts):
        if first.setdefault(part.name, i) != i:
            problems.append(Problem("duplicate-name", f"the name {quoted(part.name)} is taken by "
                                    f"parts[{first[part.name]}]", f"$.parts[{i}].name",
                                    allowed="a unique name for every part"))
        for j, leaf in enumerate(part.leaves):
            key, path = (leaf.name.removesuffix(".tendon"), leaf.at), f"$.parts[{i}].pulls[{j}]"
            if key in pullers:  # a tendon has one end
                problems.append(Problem("set-twice", f"{leaf.name!r} is pulled already, by "
                                        f"{pullers[key]}", path=path))
            pullers.setdefault(key, path)
    failed: set[str] = set()
    for i, part in sorted(enumerate(scene.parts), key=lambda item: bool(item[1].leaves)):
        try:
            elements = part.expand(Known(
                elements, tendon_of, frozenset(failed), pulled, around.outside, around.near))
        except PartError as error:
            failed.add(part.name)
            problems += [dataclasses.replace(problem, path=f"$.parts[{i}]{problem.path}")
                         for problem in error.problems]
        except (SceneError, ArithmeticError) as error:
            failed.add(part.name)
            reasons = [each.message for each in error.problems] if isinstance(error, SceneError) \
                else ["its numbers are too large or too small"]
            problems += [Problem("bad-part", f"this part cannot be built: {why}", f"$.parts[{i}]")
                         for why in reasons]
    drives = [drive.model_copy(update={"tendon": tendon_of[drive.target[1]]})
              if drive.target[0].among == "tendons" and drive.target[1] in tendon_of else drive
              for drive in scene.drives]
    return Elements(**elements | {
        "drives": (*drives, *elements["drives"]), "contacts": elements["contacts"] + scene.contacts,
        "groups": elements["groups"] + scene.groups}), problems


def placed(
    name: str, inner: Elements, placement: Placement, outside: Callable[[str], Body | None],
) -> Elements:
    """The elements ``inner`` of the assembly ``name``, placed and under their names outside."""
    place = Mover(name, inner, placement, outside)
    resized = Mover(name, inner, Placement(scale=placement.scale), outside)
    problems: list[Problem] = []
    found: dict[str, Any] = {"materials": tuple(
        (f"{name}.{key}", each) for key, each in inner["materials"])}
    for kind in KINDS:
        moved = []
        for i, element in enumerate(inner[kind]):
            try:
                moved.append((place if kind in PLACED else resized).element(
                    element, f".{kind}[{i}]"))
            except PartError as error:
                problems += error.problems
        found[kind] = tuple(moved)
    if problems:
        raise PartError(problems)
    found["groups"] += (Group(name=name, bodies=tuple(body.name for body in found["bodies"])),)
    return Elements(**found)
