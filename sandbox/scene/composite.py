"""Elements of your own: classes that combine existing elements, as types of ``parts``."""

from __future__ import annotations

import dataclasses
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any, TypeVar, Union

from pydantic import Field

from sandbox.elements.element import tag_of
from sandbox.elements.registry import members
from sandbox.errors import Problem, SandboxError, SceneError
from sandbox.scene.document import ASSEMBLED, Assembly, Part, Scene
from sandbox.scene.parts.assembly import expand_parts
from sandbox.scene.parts.expansion import Elements, Known, PartError, PartSpec
from sandbox.values.numbers import Items
from sandbox.wording import quoted


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
        """All elements so far, and those of :meth:`elements`.

        Raises:
            PartError: :meth:`elements` failed, or returned something invalid.
        """
        try:
            whole = Assembly(**{"name": self.name, **self.elements()})
        except SceneError as error:
            raise self._wrong([f"{error.source}{str(each).removeprefix('$')}"
                               for each in error.problems]) from None
        except Exception as error:  # whatever the class raises
            raise self._wrong([f"{type(error).__name__}: {error}"]) from None
        if other := sorted(whole.model_fields_set.difference(("type", "name", *ASSEMBLED))):
            raise self._wrong([f"{quoted(other[0])} is no list of elements"])
        inner, problems = expand_parts(whole, known.pulled, known.outside, known.near)
        if problems:
            raise self._wrong([str(each) for each in problems])
        names = (each.name for kind in dataclasses.fields(inner)
                 if kind.name not in ("contacts", "materials")
                 for each in getattr(inner, kind.name))
        if foreign := [name for name in names if not name.startswith(f"{self.name}.")]:
            raise self._wrong([f"the name {quoted(foreign[0])} must begin with "
                               f"{quoted(f'{self.name}.')}"])
        return known.elements + inner

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

    Raises:
        SandboxError: the file cannot be read or run, or registers nothing.
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
        raise SandboxError(_message(error, path), code="bad-elements") from None
    _files[str(path)] = source
    return partial(_restore, before, files)


def _restore(types: dict[str, type[Composite]], files: dict[str, bytes]) -> None:
    global _registered, _files
    _registered, _files = types, files
    _set_types()


def _message(error: Exception, path: Path) -> str:
    """The message of an exception that the file at a path raised, with its line."""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__)
             if frame.filename == str(path)]
    said = " ".join(str(error).split())
    if isinstance(error, SyntaxError):
        lines, said = [error.lineno], error.msg
    place = f"{path}:{lines[-1]}" if lines else str(path)
    return f"{place}: {said}" if isinstance(error, SandboxError) else \
        f"{place}: {type(error).__name__}: {said}"
