"""Names that hold in a piece of a scene: the index of a ``repeat``, parameters of an assembly."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from sandbox.values.expressions import parse_expression, unknown_name
from sandbox.wording import WrongValueError, near, quoted

_BRACES = re.compile(r"\{\{|\}\}|\{([^{}]*)\}")
_NAME = re.compile(r"[A-Za-z]\w*")


@dataclass(frozen=True)
class Scope:
    """What texts of a piece may name."""

    parameters: Mapping[str, float] = field(default_factory=dict)
    """The file's own, SI: they stay in expressions, but may be asked for here."""
    numbers: Mapping[str, float] = field(default_factory=dict)
    """Put in expressions for their names."""
    words: Mapping[str, str] = field(default_factory=dict)
    """Entries of a repeat's list that are no numbers; for braces only."""
    tables: Mapping[str, Any] = field(default_factory=dict)
    """The file's, by their calls."""
    renamed: Mapping[str, str] | None = None
    """Of a file that is included: from its tables' names to those that they have in the scene."""
    braces: bool = False
    """Whether ``{i}`` means something: inside a ``repeat`` it does."""

    @property
    def known(self) -> dict[str, float]:
        """Every number that has a name here."""
        return {**self.parameters, **self.numbers}

    def naming(self, values: Mapping[str, float | str], *, braces: bool) -> Scope:
        """The scope inside, with more names, before those of the same name around it."""
        words = {name: value for name, value in values.items() if isinstance(value, str)}
        numbers = {name: value for name, value in values.items() if not isinstance(value, str)}
        return replace(
            self, braces=self.braces or braces,
            words={**{k: v for k, v in self.words.items() if k not in numbers}, **words},
            numbers={**{k: v for k, v in self.numbers.items() if k not in words}, **numbers})

    def text(self, text: str) -> str:
        """A text with the scope's values in it.

        Raises:
            WrongValueError: braces that hold no known name.
        """
        if self.braces and ("{" in text or "}" in text):
            text = _BRACES.sub(self._filled, text)
        if not text.lstrip().startswith("=") or not (
                self.numbers or self.words or self.renamed is not None):
            return text
        try:
            expression = parse_expression(text)
        except WrongValueError:
            return text  # the models say what is wrong with it
        for name in sorted(expression.names & set(self.words)):
            raise WrongValueError("bad-expression", f"{quoted(name)} is text; an expression needs "
                                  "numbers", allowed=f"{{{name}}} inside of a name")
        if self.renamed is not None:
            expression.check_tables(self.tables)
        if not (expression.names & set(self.numbers) or
                (self.renamed is not None and expression.tables)):
            return text
        return f"={expression.bind(self.numbers, self.renamed).text}"

    def _filled(self, match: re.Match[str]) -> str:
        inner = match.group(1)
        if inner is None:
            return match.group()[0]  # two braces are one
        if inner.strip() in self.words:
            return self.words[inner.strip()]
        known = self.known
        expression = parse_expression(inner)
        for name in sorted(expression.names):
            if name in self.words:
                raise WrongValueError("bad-expression",
                                      f"{quoted(name)} is text; an expression needs numbers")
            if name not in known:
                raise unknown_name(name, {**known, **self.words})
        value = float(expression.evaluate({**self.tables, **known}))
        return str(int(value)) if value == int(value) and abs(value) < 1e15 else f"{value:g}"


def wrong_index(name: Any, scope: Scope, reserved: frozenset[str]) -> WrongValueError | None:
    """Why a name cannot be that of an index, or None."""
    if not isinstance(name, str) or not _NAME.fullmatch(name) or "__" in name or len(name) > 100:
        return WrongValueError("invalid-name", f"{quoted(name)} is not the name of an index",
                               allowed="a letter, then letters, digits and single _")
    if name in reserved:
        means = "the time" if name == "t" else "a constant, a function or a word of expressions"
        return WrongValueError("invalid-name",
                               f"{quoted(name)} cannot be an index: it already means {means}")
    if name in scope.parameters:
        return WrongValueError("duplicate-name", f"the name {quoted(name)} is that of a parameter "
                               "already", allowed='another one for the index: "index": "j"')
    return None


def unknown_key(key: str, known: tuple[str, ...]) -> WrongValueError:
    """The refusal of a key that is none of those known."""
    return WrongValueError("unknown-key", f"unknown key {quoted(key)}", allowed=", ".join(known),
                           hint=near(key, known))
