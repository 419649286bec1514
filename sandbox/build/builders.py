"""What makes the entries of a scene from keywords: one builder a model, its words the model's own.

What it returns is what a file would hold, so that builders, dictionaries and files mix. Only the
words are looked over here; what they are worth is for :func:`sandbox.load_scene`, which knows the
parameters that expressions name.
"""

from __future__ import annotations

import inspect
import keyword
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from typing import Any

from pydantic.fields import FieldInfo

from sandbox.errors import Problem, SceneError
from sandbox.scene.elements.spec import Spec
from sandbox.scene.schema import descriptions
from sandbox.wording import listed, meant, near, quoted

Entry = dict[str, Any]
FIRST = "name"
"""The one field that may be given without its word."""
TAG = "type"
"""The field that a builder fills in itself."""


class EntryBuilder:
    """Makes the data of one kind of entry: ``body("link", mass="10 g")``.

    Args:
        path: how it is called, below ``sandbox.build``.
        model: the spec of what it makes.
        tag: what ``type`` says of it; empty where it has none.
    """

    def __init__(self, path: str, model: type[Spec], tag: str = "") -> None:
        self.__name__, self.__qualname__ = path.rpartition(".")[2], path
        self.model, self._tag, self._path = model, tag, path

    @cached_property
    def fields(self) -> dict[str, str]:
        """What is written in Python, such as ``from_``, to the key in a scene."""
        keys = {name: field.alias or name for name, field in self.model.model_fields.items()
                if name != TAG}
        return {word_of(key): key for key in keys.values()}

    @cached_property
    def required(self) -> tuple[str, ...]:
        """Words that may not be left out."""
        return tuple(word for word, key in self.fields.items()
                     if self._field(key).is_required())

    @property
    def __signature__(self) -> inspect.Signature:
        """What editors and ``help`` show: words, and defaults as a file would have them."""
        kind = inspect.Parameter
        words = sorted(self.fields, key=lambda word: (word != FIRST, word not in self.required))
        return inspect.Signature([kind(
            word, kind.POSITIONAL_OR_KEYWORD if word == FIRST else kind.KEYWORD_ONLY,
            default=kind.empty if word in self.required else None) for word in words],
            return_annotation=Entry)

    @property
    def __doc__(self) -> str:  # type: ignore[override]
        """The model's own words, then its fields'."""
        said = descriptions(self.model)
        told = {word: said[name] for name, field in self.model.model_fields.items()
                if name in said and (word := word_of(field.alias or name)) in self.fields}
        rows = [f"    {word}: {_one_line(told[word])}" for word in self.fields if word in told]
        text = inspect.cleandoc(self.model.__doc__ or "")
        return "\n\n".join([*map(_one_line, text.split("\n\n")), "\n".join(["Args:", *rows])])

    def __call__(self, *given: Any, **words: Any) -> Entry:
        """The entry as a file would hold it; what is None is left out.

        Raises:
            SceneError: a word that it does not have, or one that is missing.
        """
        if len(given) > (FIRST in self.fields) or (given and FIRST in words):
            raise self._wrong(f"{len(given)} values without their words",
                              "only the name may stand alone, once" if FIRST in self.fields
                              else "words for all, such as " + listed(self.fields, most=3))
        if given:
            words = {FIRST: given[0], **words}
        problems = [Problem("unknown-key", f"there is no {quoted(word)}", self._where,
                            allowed=listed(self.fields, most=len(self.fields)),
                            hint=near(word, self.fields))
                    for word in words if word not in self.fields]
        if not problems and (lacking := [word for word in self.required
                                         if words.get(word) is None]):
            problems.append(Problem("missing-key", f"{listed(lacking)} must be given", self._where))
        if problems:
            raise SceneError(problems)
        entry = {TAG: self._tag} if self._tag else {}
        return entry | {self.fields[word]: plain(value) for word, value in words.items()
                        if value is not None}

    def __repr__(self) -> str:
        return f"<{self._where}{self.__signature__}>"

    @property
    def _where(self) -> str:
        return f"sandbox.build.{self._path}"

    def _field(self, key: str) -> FieldInfo:
        fields = self.model.model_fields
        return next(field for name, field in fields.items() if (field.alias or name) == key)

    def _wrong(self, what: str, allowed: str) -> SceneError:
        return SceneError([Problem("bad-argument", what, self._where, allowed=allowed)])


class Family:
    """Builders of one kind side by side: ``joint.pin``, ``joint.slot``."""

    def __init__(self, name: str, builders: Mapping[str, EntryBuilder]) -> None:
        self._name = name
        self._builders = dict(builders)
        self.__doc__ = f"{name.capitalize()}s: {', '.join(builders)}."

    def __getattr__(self, word: str) -> EntryBuilder:
        known = self.__dict__.get("_builders", {})
        if word in known:
            return known[word]  # type: ignore[no-any-return]
        if word.startswith("__"):
            raise AttributeError(word)
        raise AttributeError(missing(f"build.{self._name}", word, known))

    def __dir__(self) -> list[str]:
        return list(self._builders)

    def __iter__(self) -> Iterator[EntryBuilder]:
        return iter(self._builders.values())

    def __repr__(self) -> str:
        return f"<sandbox.build.{self._name}: {', '.join(self._builders)}>"


def missing(where: str, word: str, known: Iterable[str]) -> str:
    """What to say of a builder that there is not."""
    names = list(known)
    return (f"sandbox.{where} has no {quoted(word)}.{meant(word, names)}"
            f" Allowed: {listed(names, most=len(names))}.")


def word_of(key: str) -> str:
    """A key of a scene as a word of Python: ``from`` as ``from_``, ``$schema`` as ``schema``."""
    word = key.lstrip("$")
    return f"{word}_" if keyword.iskeyword(word) else word


def plain(value: Any) -> Any:
    """A value as JSON would hold it: lists for tuples and arrays."""
    listing: Callable[[], Any] | None = getattr(value, "tolist", None)
    if listing is not None:
        return listing()
    if isinstance(value, Mapping):
        return {key: plain(entry) for key, entry in value.items()}
    return [plain(entry) for entry in value] if isinstance(value, (list, tuple)) else value


def _one_line(text: str) -> str:
    return " ".join(text.split())
