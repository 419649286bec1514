"""From a scene to its mechanism: every part spelled out as plain elements."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Iterator
from typing import Any

from sandbox.elements.registry import Drive
from sandbox.errors import Problem, SceneError
from sandbox.scene.bodies import Body
from sandbox.scene.document import Assembly, Part, Scene
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.parts.assembly import placed
from sandbox.scene.parts.expansion import Elements, PartError
from sandbox.scene.parts.finger import Finger, expand_finger
from sandbox.scene.parts.placement import Placement
from sandbox.scene.parts.section import Section, expand_section
from sandbox.scene.parts.trees import Known, PulleyTree, RockerTree, expand_tree
from sandbox.wording import NearMisses, quoted

LINE_WIDTH = 100  # of the printed mechanism


def expand(scene: Scene) -> Mechanism:
    """Expand a scene to its mechanism.

    Fingers and sections come first, in the order of the scene's parts, then
    the trees, which lead the fingers' tendons on. The scene's own contact
    rules come after those of its parts, so that the author's word counts. A
    pull drive that names a finger or a tree gets that part's tendon.

    Raises:
        SceneError: a part that names something unknown, or that cannot be built;
            every such problem, with the part's path. What is no scene.
    """
    if not isinstance(scene, Scene):
        raise SceneError([Problem("bad-argument", f"{quoted(scene)} is no scene", "scene",
                                  allowed="a scene from sandbox.load_scene")])
    elements, problems = _spelled_out(scene, _Outside())
    if problems:
        raise SceneError(problems)
    fields = {name: getattr(scene, name) for name in Mechanism.model_fields}
    fields |= {kind.name: getattr(elements, kind.name) for kind in dataclasses.fields(elements)}
    fields["materials"] = scene.materials | dict(elements.materials)
    fields["contacts"] = elements.contacts + scene.contacts
    fields["groups"] = elements.groups + scene.groups
    return Mechanism.model_construct(set(fields), **fields)


@dataclasses.dataclass(frozen=True)
class _Outside:
    """The surroundings of a scene or an assembly."""

    pulled: frozenset[str] = frozenset()
    """Parts and tendons that trees pull, by their names in it."""
    body: Callable[[str], Body | None] = lambda name: None
    """A body around it, in the frame of the assembly's surroundings."""
    near: NearMisses = dataclasses.field(default_factory=NearMisses)


def _spelled_out(scene: Scene | Assembly, around: _Outside) -> tuple[Elements, list[Problem]]:
    """All elements of a scene or an assembly where they are written, and what is wrong."""
    elements = Elements(
        bodies=scene.bodies, joints=scene.joints, springs=scene.springs, tendons=scene.tendons,
        lines=scene.lines, valves=scene.valves, loads=scene.loads,
        controllers=scene.controllers, events=scene.events, meters=scene.meters)
    tendon_of = dict(_tendons_of(scene))
    problems = _pulled_twice(scene)
    failed: set[str] = set()
    pulled = around.pulled | {leaf.name for part in scene.parts
                              if isinstance(part, RockerTree | PulleyTree) for leaf in part.pulls}
    for i, part in sorted(enumerate(scene.parts), key=lambda item: _is_tree(item[1])):
        try:
            known = Known(elements, tendon_of, frozenset(failed))
            elements = _with_part(part, pulled, known, around)
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
    return dataclasses.replace(elements, drives=own + elements.drives), problems


def _reasons(error: SceneError | ArithmeticError) -> list[str]:
    """Why an element of a part is invalid."""
    if isinstance(error, ArithmeticError):
        return ["its numbers are too large or too small"]
    return [problem.message for problem in error.problems]


def _tendons_of(scene: Scene | Assembly) -> Iterator[tuple[str, str]]:
    """The tendon of each finger and tree, those in assemblies too."""
    for part in scene.parts:
        if isinstance(part, Assembly):
            yield from ((f"{part.name}.{name}", f"{part.name}.{tendon}")
                        for name, tendon in _tendons_of(part))
        elif not isinstance(part, Section):
            yield part.name, f"{part.name}.tendon"


def _is_tree(part: Part) -> bool:
    return isinstance(part, RockerTree | PulleyTree)


def _with_part(
    part: Part, pulled: frozenset[str], known: Known, around: _Outside,
) -> Elements:
    elements = known.elements
    if isinstance(part, Assembly):
        return elements + _assembled(part, elements, pulled, around)
    if isinstance(part, Section):
        return elements + expand_section(part)
    if isinstance(part, Finger):
        palm = None
        if part.on is not None and (palm := elements.body(part.on)) is None:
            raise PartError([Problem(
                "name-not-found", f"no body before this finger is named {part.on!r}", path=".on",
                hint=around.near(part.on, (body.name for body in elements.bodies)))])
        led_on = part.name in pulled or known.tendon_of[part.name] in pulled
        return elements + expand_finger(part, palm=palm, pulled=led_on)
    return expand_tree(part, known)


def _assembled(
    assembly: Assembly, before: Elements, pulled: frozenset[str], around: _Outside,
) -> Elements:
    """The elements of an assembly, placed and renamed for the scene that contains it."""
    begin = f"{assembly.name}."
    placement = Placement(assembly.at, assembly.angle, assembly.mirror, assembly.scale)

    def outside(name: str) -> Body | None:
        return before.body(name) or around.body(name)

    inner, problems = _spelled_out(assembly, _Outside(
        frozenset(name.removeprefix(begin) for name in pulled if name.startswith(begin)), outside,
        around.near))
    if problems:
        raise PartError([dataclasses.replace(problem, path=problem.path.removeprefix("$"))
                         for problem in problems])
    inner = dataclasses.replace(
        inner, contacts=inner.contacts + assembly.contacts, groups=inner.groups + assembly.groups,
        materials=inner.materials + tuple(assembly.materials.items()))
    return placed(assembly.name, inner, placement, outside)


def _pulled_twice(scene: Scene | Assembly) -> list[Problem]:
    """A tendon has one end: two trees, or one tree twice, cannot pull it."""
    problems: list[Problem] = []
    seen: dict[tuple[str, tuple[float, float]], str] = {}
    for i, part in enumerate(scene.parts):
        if not isinstance(part, RockerTree | PulleyTree):
            continue
        for j, leaf in enumerate(part.pulls):
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


def to_json(mechanism: Mechanism) -> str:
    """The mechanism as a scene without parts; read again it gives an equal mechanism."""
    data = {"format": mechanism.format} | mechanism.model_dump(
        mode="json", by_alias=True, exclude_defaults=True, include=set(Mechanism.model_fields))
    return _printed(data, 0) + "\n"


def _printed(value: Any, depth: int) -> str:
    """JSON with every value on one line that fits there, all else an entry a line."""
    line = json.dumps(value, ensure_ascii=False, allow_nan=False)
    if not value or not isinstance(value, (dict, list)) or (
        depth and len(line) + 2 * depth <= LINE_WIDTH
    ):
        return line
    indent = "  " * (depth + 1)
    if isinstance(value, dict):
        entries = [f"{json.dumps(key)}: {_printed(item, depth + 1)}" for key, item in value.items()]
    else:
        entries = [_printed(item, depth + 1) for item in value]
    left, right = "{}" if isinstance(value, dict) else "[]"
    return f"{left}\n{indent}" + f",\n{indent}".join(entries) + f"\n{'  ' * depth}{right}"
