"""Names of an assembly's elements in the scene: its own name, a dot, and what they are inside it.

What names an element of the assembly follows it, wherever it stands: in a field, in a pattern, in
an expression. A name that the assembly does not have is left as it is: it is the scene's.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from fnmatch import fnmatchcase
from functools import cache
from typing import Annotated, Any, Literal, TypeVar, get_args, get_origin

from sandbox.values.expressions import RESERVED
from sandbox.values.spec import Spec

TEXTS = ("because", "unit", "title", "about")
"""Fields that hold words for people."""
_DOTTED = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*(?!\w|\s*\()")

SpecType = TypeVar("SpecType", bound=Spec)


class Naming:
    """From names inside an assembly to names of the scene."""

    def __init__(self, prefix: str, names: Iterable[str]) -> None:
        self.prefix = prefix
        self.names = frozenset(names)

    def has(self, name: str) -> bool:
        """Whether a name, or what it begins with up to a dot, is the assembly's own."""
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
