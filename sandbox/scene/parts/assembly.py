"""Expansion of the parts of scenes and assemblies; placement and names of an assembly."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable
from fnmatch import fnmatchcase
from functools import cache
from itertools import accumulate
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, get_args, get_origin

from sandbox.errors import Problem, SceneError
from sandbox.scene.bodies import Body
from sandbox.scene.mechanism import ElementLists
from sandbox.scene.parts.expansion import Elements, Known, PartError
from sandbox.scene.parts.placement import Mover, Placement
from sandbox.scene.settings import Group
from sandbox.values.expressions import RESERVED
from sandbox.values.spec import Spec
from sandbox.wording import NearMisses, is_pattern

if TYPE_CHECKING:
    from sandbox.scene.document import Assembly, Scene

PLACED = ("bodies", "joints", "springs", "tendons", "lines", "loads", "drives")
KINDS = tuple(kind for kind in ElementLists.model_fields if kind != "materials")
OWN = tuple(kind for kind in KINDS if kind not in ("drives", "contacts", "groups"))
"""Lists whose elements come before those of parts; a scene's contact rules come after."""
TEXTS = ("because", "unit", "title", "about")  # fields of plain text
_DOTTED = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*(?!\w|\s*\()")
SpecType = TypeVar("SpecType", bound=Spec)


def expand_parts(
    scene: Scene | Assembly, pulled: frozenset[str] = frozenset(),
    outside: Callable[[str], Body | None] = lambda name: None, near: NearMisses | None = None,
) -> tuple[Elements, list[Problem]]:
    """The elements of a scene or assembly, not placed; outer trees pull ``pulled``."""
    elements = Elements(materials=tuple(scene.materials.items()),
                        **{kind: getattr(scene, kind) for kind in OWN})
    tendon_of = {name: tendon for part in scene.parts for name, tendon in part.tendon_names.items()}
    pulled |= {leaf.name for part in scene.parts for leaf in part.leaves}
    problems: list[Problem] = []
    pullers: dict[tuple[str, tuple[float, float]], str] = {}
    for i, part in enumerate(scene.parts):
        for j, leaf in enumerate(part.leaves):
            key, path = (leaf.name.removesuffix(".tendon"), leaf.at), f"$.parts[{i}].pulls[{j}]"
            if key in pullers:  # a tendon has one end
                problems.append(Problem("set-twice", f"{leaf.name!r} is pulled already, by "
                                        f"{pullers[key]}", path=path))
            pullers.setdefault(key, path)
    failed: set[str] = set()
    near = near or NearMisses()
    for i, part in sorted(enumerate(scene.parts), key=lambda item: bool(item[1].leaves)):
        try:
            elements = part.expand(Known(
                elements, tendon_of, frozenset(failed), pulled, outside, near))
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
    own = {body.name: body for body in inner["bodies"]}
    place = Mover(placement, own, outside)
    resized = Mover(Placement(scale=placement.scale), own, outside)
    naming = _Naming(name, inner)
    problems: list[Problem] = []
    found: dict[str, Any] = {}
    for kind in KINDS:
        elements = list(inner[kind])
        for i, element in enumerate(elements):
            try:
                if kind in PLACED:
                    move = place.body if kind == "bodies" else place.element
                    element = move(element, f".{kind}[{i}]")
                elif kind == "controllers":
                    element = resized.spec(element)
                elements[i] = naming.spec(element)
            except PartError as error:
                problems += error.problems
        found[kind] = tuple(elements)
    if problems:
        raise PartError(problems)
    found["groups"] += (Group(name=name, bodies=tuple(body.name for body in found["bodies"])),)
    found["materials"] = tuple((f"{name}.{key}", each) for key, each in inner["materials"])
    return Elements(**found)


class _Naming:
    """From names inside an assembly to names of the scene."""

    def __init__(self, prefix: str, inner: Elements) -> None:
        self.prefix = prefix
        self.names = frozenset(
            [name for name, _ in inner["materials"]]
            + [each.name for kind in KINDS if kind != "contacts" for each in inner[kind]])

    def of(self, name: str) -> str:
        """A name in the scene: it, or its first part up to a dot, may be the assembly's."""
        own = any(begin in self.names for begin in accumulate(name.split("."), "{}.{}".format))
        return f"{self.prefix}.{name}" if own else name

    def text(self, text: str) -> str:
        """A field's text: a name, a pattern of names, a pair, a quantity, an expression."""
        if text.lstrip().startswith("="):
            return _DOTTED.sub(lambda match: match.group() if match.group() in RESERVED else
                               self.of(match.group()), text)
        if "/" in text:
            return "/".join(self.text(side) for side in text.split("/"))
        if is_pattern(text):
            fits = any(fnmatchcase(name, text) or fnmatchcase(f"{name}.x", text)
                       for name in self.names)
            return f"{self.prefix}.{text}" if fits else text
        return self.of(text)

    def spec(self, spec: SpecType) -> SpecType:
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
    annotation = model.model_fields[field].annotation
    if get_origin(annotation) is Annotated:
        annotation = get_args(annotation)[0]
    return any(get_origin(each) is Literal for each in (annotation, *get_args(annotation)))
