"""Expansion of the parts of scenes and assemblies; placement and names of an assembly."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Iterable
from fnmatch import fnmatchcase
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, get_args, get_origin

from sandbox.elements.registry import Drive
from sandbox.errors import Problem, SceneError
from sandbox.scene.bodies import Body
from sandbox.scene.parts.expansion import Elements, Known, PartError
from sandbox.scene.parts.placement import Mover, Placement
from sandbox.scene.settings import Group
from sandbox.values.expressions import RESERVED
from sandbox.values.spec import Spec
from sandbox.wording import NearMisses

if TYPE_CHECKING:
    from sandbox.scene.document import Assembly, Scene

PLACED = ("bodies", "joints", "springs", "tendons", "lines", "loads", "drives")
SpecType = TypeVar("SpecType", bound=Spec)


def expand_parts(
    scene: Scene | Assembly, pulled: frozenset[str] = frozenset(),
    outside: Callable[[str], Body | None] = lambda name: None, near: NearMisses | None = None,
) -> tuple[Elements, list[Problem]]:
    """All elements of a scene or an assembly, not placed yet, and its problems.

    Args:
        scene: the scene or assembly.
        pulled: parts and tendons that trees outside pull, by their names in it.
        outside: finds a body around an assembly, in the frame of its surroundings.
        near: finds similar names.
    """
    elements = Elements(
        bodies=scene.bodies, joints=scene.joints, springs=scene.springs, tendons=scene.tendons,
        lines=scene.lines, valves=scene.valves, loads=scene.loads,
        controllers=scene.controllers, events=scene.events, meters=scene.meters,
        materials=tuple(scene.materials.items()))
    tendon_of = {name: tendon for part in scene.parts for name, tendon in part.tendon_names.items()}
    pulled |= {leaf.name for part in scene.parts for leaf in part.leaves}
    problems = _pulled_twice(scene)
    failed: set[str] = set()
    near = near or NearMisses()
    for i, part in sorted(enumerate(scene.parts), key=lambda item: bool(item[1].leaves)):
        try:
            elements = part.expand(Known(
                elements, tendon_of, frozenset(failed), pulled, outside, near))
        except PartError as error:
            failed.add(part.name)
            problems += [
                dataclasses.replace(problem, path=f"$.parts[{i}]{problem.path}")
                for problem in error.problems
            ]
        except (SceneError, ArithmeticError) as error:
            failed.add(part.name)
            problems += [Problem("bad-part",
                                 f"this part cannot be built: {why}", path=f"$.parts[{i}]")
                         for why in _reasons(error)]
    own = tuple(_resolved(drive, tendon_of) for drive in scene.drives)
    return dataclasses.replace(
        elements, drives=own + elements.drives, contacts=elements.contacts + scene.contacts,
        groups=elements.groups + scene.groups), problems


def _reasons(error: SceneError | ArithmeticError) -> list[str]:
    """Why an element of a part is invalid."""
    if isinstance(error, ArithmeticError):
        return ["its numbers are too large or too small"]
    return [problem.message for problem in error.problems]


def _pulled_twice(scene: Scene | Assembly) -> list[Problem]:
    """Tendons that two trees pull, or one tree twice: a tendon has one end."""
    problems: list[Problem] = []
    seen: dict[tuple[str, tuple[float, float]], str] = {}
    for i, part in enumerate(scene.parts):
        for j, leaf in enumerate(part.leaves):
            key = (leaf.name.removesuffix(".tendon"), leaf.at)
            if key in seen:
                problems.append(Problem("set-twice", f"{leaf.name!r} is pulled already, by "
                                        f"{seen[key]}", path=f"$.parts[{i}].pulls[{j}]"))
            seen.setdefault(key, f"$.parts[{i}].pulls[{j}]")
    return problems


def _resolved(drive: Drive, tendon_of: dict[str, str]) -> Drive:
    reference, name = drive.target
    if reference.among == "tendons" and name in tendon_of:
        return drive.model_copy(update={"tendon": tendon_of[name]})
    return drive


def placed(
    name: str, inner: Elements, placement: Placement, outside: Callable[[str], Body | None],
) -> Elements:
    """The elements of the assembly ``name`` as the scene has them.

    Args:
        name: the assembly's.
        inner: its elements as they are written, its parts spelled out.
        placement: where it is.
        outside: finds a body of the scene by its name.

    Raises:
        PartError: elements on bodies that are not there; all of them.
    """
    moved = _moved(inner, placement, outside)
    naming = Naming(name, _names(inner))
    found = Elements(**{
        kind.name: tuple(naming.spec(each) for each in getattr(moved, kind.name))
        for kind in dataclasses.fields(Elements) if kind.name != "materials"
    }, materials=tuple((f"{name}.{key}", material) for key, material in inner.materials))
    whole = Group(name=name, bodies=tuple(body.name for body in found.bodies))
    return found + Elements(groups=(whole,))


def _moved(
    inner: Elements, placement: Placement, outside: Callable[[str], Body | None],
) -> Elements:
    """The elements, placed; references of joints to the scene are kept."""
    own = {body.name: body for body in inner.bodies}
    place = Mover(placement, own, outside)
    resized = Mover(Placement(scale=placement.scale), own, outside)
    problems: list[Problem] = []
    changed: dict[str, Any] = {
        "controllers": tuple(resized.spec(each) for each in inner.controllers),
    }
    for kind in PLACED:
        elements = []
        for i, element in enumerate(getattr(inner, kind)):
            try:
                elements.append(place.body(element, f".bodies[{i}]") if kind == "bodies"
                                else place.element(element, f".{kind}[{i}]"))
            except PartError as error:
                problems += error.problems
        changed[kind] = tuple(elements)
    if problems:
        raise PartError(problems)
    return dataclasses.replace(inner, **changed)


def _names(inner: Elements) -> Iterable[str]:
    """All names that are the assembly's own."""
    for kind in dataclasses.fields(Elements):
        if kind.name == "materials":
            yield from (name for name, _ in inner.materials)
        elif kind.name != "contacts":
            yield from (each.name for each in getattr(inner, kind.name))


TEXTS = ("because", "unit", "title", "about")
"""Fields that hold words for people."""
_DOTTED = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*(?!\w|\s*\()")



class Naming:
    """From names inside an assembly to names of the scene."""

    def __init__(self, prefix: str, names: Iterable[str]) -> None:
        self.prefix = prefix
        self.names = frozenset(names)

    def has(self, name: str) -> bool:
        """Whether a name, or its first part up to a dot, belongs to the assembly."""
        words = name.split(".")
        return any(".".join(words[:count]) in self.names for count in range(1, len(words) + 1))

    def of(self, name: str) -> str:
        """A name as the scene has it."""
        return f"{self.prefix}.{name}" if self.has(name) else name

    def text(self, text: str) -> str:
        """A field's text: a name, a pattern of names, a pair, a quantity, an expression."""
        if text.lstrip().startswith("="):
            return _DOTTED.sub(lambda match: self._read(match.group()), text)
        if "/" in text:
            return "/".join(self.text(side) for side in text.split("/"))
        if any(char in text for char in "*?["):
            fits = any(fnmatchcase(name, text) or fnmatchcase(f"{name}.x", text)
                       for name in self.names)
            return f"{self.prefix}.{text}" if fits else text
        return self.of(text)

    def _read(self, name: str) -> str:
        return name if name in RESERVED else self.of(name)

    def spec(self, spec: SpecType) -> SpecType:
        """An element under its name in the scene."""
        changed = {}
        for name in type(spec).model_fields:
            if name in TEXTS or name in spec.LOCAL or _is_choice(type(spec), name):
                continue
            value = getattr(spec, name)
            new = f"{self.prefix}.{value}" if name == "name" else self._value(value)
            if new is not value:
                changed[name] = new
        return spec.model_copy(update=changed) if changed else spec

    def _value(self, value: Any) -> Any:
        if isinstance(value, str):
            return self.text(value)
        if isinstance(value, Spec):
            return self.spec(value)
        if isinstance(value, tuple) and any(isinstance(v, (str, Spec, tuple)) for v in value):
            return tuple(self._value(entry) for entry in value)
        if isinstance(value, dict):
            return {self.text(key): self._value(entry) for key, entry in value.items()}
        return value


@cache
def _is_choice(model: type[Spec], field: str) -> bool:
    """Whether a field is one of a few words and names nothing."""
    return _has_literal(model.model_fields[field].annotation)


def _has_literal(annotation: Any) -> bool:
    if get_origin(annotation) is Annotated:
        annotation = get_args(annotation)[0]
    return get_origin(annotation) is Literal or any(
        get_origin(each) is Literal for each in get_args(annotation))
