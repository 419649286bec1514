"""The Scene: a mechanism as its author wrote it, with parameters, templates and parts.

Users may register further types of parts: classes that combine existing elements.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any, Literal, TypeVar, Union

from pydantic import Field

from sandbox.elements.element import tag_of
from sandbox.elements.registry import members
from sandbox.errors import Problem, SandboxError, SceneError
from sandbox.scene.bodies import Body
from sandbox.scene.mechanism import ElementLists, Mechanism
from sandbox.scene.parts.expansion import Elements, Known, PartError, PartSpec, expand_parts
from sandbox.scene.parts.finger import Finger
from sandbox.scene.parts.placement import Mirror, Mover, placed
from sandbox.scene.parts.section import Section
from sandbox.scene.parts.trees import PulleyTree, RockerTree
from sandbox.values.numbers import POSITIVE, Angle, Items, Name, Number, Point, Quantity
from sandbox.values.spec import TYPE
from sandbox.wording import quoted


class PlacedPart(PartSpec):
    """The name and the placement of an assembly."""

    type: Literal["assembly"] = TYPE
    name: Name
    """Its name; the names of its elements begin with it and a dot."""
    at: Point = (0.0, 0.0)
    """Its origin, in the world or in the assembly that it is part of."""
    angle: Angle = 0.0
    """Rotation about its origin."""
    mirror: Mirror | None = None
    """Sides to mirror, about its origin. Hinges then count the opposite sense as positive, so their
    angles, stops and drives do not change."""
    scale: Annotated[Number, POSITIVE] = 1.0
    """Factor of lengths in the plane and of speeds, and its square of inertias. Masses, forces,
    stiffnesses, ``thickness``, areas of pistons and volumes do not change."""


class Assembly(ElementLists, PlacedPart):
    """Elements and parts that are scaled, then mirrored, turned and moved as one.

    They are written as in a scene, about an origin of their own. In the scene their names begin
    with the assembly's: its ``jaw`` is ``left.jaw``. Names that it does not have are the scene's.
    Its loads are those of the world, not turned. A mirror changes a body's ``x`` and ``angle``, not
    those of hinges. Its contact rules come before the scene's; its bodies are a group of its name.
    """

    parts: Items[Part] = ()
    """Its parts, assemblies among them."""

    def expand(self, known: Known) -> Elements:
        """All elements so far, and its own, placed and under their names outside."""
        begin, before = f"{self.name}.", known.elements

        def outside(name: str) -> Body | None:
            return before.body(name) or known.outside(name)

        pulled = frozenset(name.removeprefix(begin) for name in known.pulled
                           if name.startswith(begin))
        inner = expand_parts(self, Known(pulled=pulled, outside=outside, near=known.near))
        return before + placed(Mover(
            self.name, inner, outside, self.at, self.angle, self.mirror, self.scale))


Part = Annotated[Finger | RockerTree | PulleyTree | Section | Assembly, Field(discriminator="type")]


class Scene(Mechanism):
    """The whole file: a mechanism, with parameters, templates and parts."""

    schema_: Annotated[str | None, Field(alias="$schema")] = None
    """Location of the JSON Schema of scenes, for editors."""
    parameters: dict[Name, Quantity] = Field(default_factory=dict)
    """Named numbers, for expressions such as ``"=pull / 4"``, which see them in SI."""
    templates: dict[Name, dict[str, Any]] = Field(default_factory=dict)
    """Templates by name: ``{"digit": {"type": "finger", ...}}``. An entry with ``"like": "digit"``
    takes all keys of that template and overrides them with its own, object by object; lists are
    replaced whole. A template may itself have a ``like``."""
    parts: Items[Part] = ()
    """Fingers, trees, assemblies; ``sandbox check --expand`` shows their elements."""


Assembly.model_rebuild()
KEYS = tuple(field.alias or name for name, field in Scene.model_fields.items())
"""The keys of a scene's file."""
ASSEMBLED = tuple(key for key in KEYS if key in Assembly.model_fields and key != "name")
"""Keys of an included scene that its assembly takes."""


class Composite(PartSpec):
    """The base of elements of your own, which combine existing ones.

    A subclass has fields, a ``type`` such as ``type: Literal["strut"]`` and :meth:`elements`;
    :func:`register` makes it a type of ``parts``.
    """

    def elements(self) -> Mapping[str, Sequence[Any]]:
        """Its elements by list, as in a scene: ``{"springs": [LinearSpring(...)]}``.

        Their names begin with :attr:`name` and a dot. Entries are elements of
        :mod:`sandbox.build` or objects as in a scene's file.
        """
        raise NotImplementedError

    def expand(self, known: Known) -> Elements:
        """All elements so far, and those of :meth:`elements`."""
        try:
            whole = Assembly(**{"name": self.name, **self.elements()})
            inner = expand_parts(whole, known)
        except (SceneError, PartError) as error:
            source = error.source if isinstance(error, SceneError) else ""
            raise self._wrong([f"{source}{str(each).removeprefix('$')}"
                               for each in error.problems]) from None
        except Exception as error:  # whatever the class raises
            raise self._wrong([f"{type(error).__name__}: {error}"]) from None
        if other := sorted(whole.model_fields_set.difference(("type", "name", *ASSEMBLED))):
            raise self._wrong([f"{quoted(other[0])} is no list of elements"])
        names = (each.name for kind, elements in inner.items()
                 if kind not in ("contacts", "materials") for each in elements)
        if foreign := [name for name in names if not name.startswith(f"{self.name}.")]:
            raise self._wrong([f"the name {quoted(foreign[0])} must begin with "
                               f"{quoted(f'{self.name}.')}"])
        return known.elements + Elements({}, **inner)

    def _wrong(self, reasons: list[str]) -> PartError:
        return PartError([Problem("bad-part", f"{type(self).__name__}.elements(): {reason}", "")
                          for reason in reasons])


Kind = TypeVar("Kind", bound=type[Composite])
BUILT_IN = members(Part)
_registered: dict[str, type[Composite]] = {}
_files: dict[str, bytes] = {}


def registered() -> tuple[type[Composite], ...]:
    """All registered classes."""
    return tuple(_registered.values())


def element_files() -> dict[str, bytes]:
    """The contents of all files that :func:`load_elements` has loaded, by path."""
    return dict(_files)


def register(kind: Kind) -> Kind:
    """Make a subclass of :class:`Composite` a type of ``parts`` in scenes; a class decorator.

    A class of the same module and name replaces an earlier one.

    Raises:
        SandboxError: no such class, or its type is in use.
    """
    if not (isinstance(kind, type) and issubclass(kind, Composite) and tag_of(kind)):
        raise SandboxError(f"{quoted(getattr(kind, '__name__', kind))} cannot be registered "
                           "(allowed: a subclass of sandbox.Composite with a field such as "
                           "type: Literal[\"strut\"])")
    tag, place = tag_of(kind), (kind.__module__, kind.__qualname__)
    taken = next((other for other in (*BUILT_IN, *registered()) if tag_of(other) == tag), None)
    if taken and (taken.__module__, taken.__qualname__) != place:
        raise SandboxError(f"the type {quoted(tag)} is already that of {taken.__name__}; choose "
                           "another type")
    _registered[tag] = kind
    _set_types()
    return kind


def _set_types() -> None:
    """Let the ``parts`` of scenes and assemblies be of all registered types."""
    union: Any = Union[(*BUILT_IN, *registered())]
    for model in (Assembly, Scene):
        model.model_fields["parts"].annotation = Items[
            Annotated[union, Field(discriminator="type")]]
        model.model_rebuild(force=True)


def load_elements(path: Path, source: bytes | None = None) -> Callable[[], None]:
    """Run a Python file that registers elements; a function that takes them back.

    Args:
        path: the file.
        source: its contents, where the file itself may not exist.
    """
    before, files = dict(_registered), dict(_files)
    module = ModuleType(f"elements of {path}")
    module.__file__ = str(path)
    sys.modules[module.__name__] = module  # pydantic and inspect look it up
    try:
        source = path.read_bytes() if source is None else source
        exec(compile(source, str(path), "exec"), vars(module))  # noqa: S102  the user's own file
        if _registered == before:
            raise SandboxError("it registers no element; write @sandbox.register above its class")
    except Exception as error:  # whatever the file raises
        _restore(before, files)
        lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__)
                 if frame.filename == str(path)]
        said = " ".join(str(error).split())
        if isinstance(error, SyntaxError):
            lines, said = [error.lineno], error.msg
        if not isinstance(error, SandboxError):
            said = f"{type(error).__name__}: {said}"
        place = f"{path}:{lines[-1]}" if lines else str(path)
        raise SandboxError(f"{place}: {said}", code="bad-elements") from None
    _files[str(path)] = source
    return partial(_restore, before, files)


def _restore(types: dict[str, type[Composite]], files: dict[str, bytes]) -> None:
    global _registered, _files
    _registered, _files = types, files
    _set_types()
