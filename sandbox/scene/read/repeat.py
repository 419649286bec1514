"""``repeat``: the number of copies of a list entry, and their positions."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from sandbox.scene.bodies import SHAPES
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.scopes import Scope, unknown_key, wrong_index
from sandbox.values.expressions import RESERVED
from sandbox.values.numbers import number_from
from sandbox.wording import WrongValueError, kind_of, listed, number_text, quoted

KEYS = ("count", "list", "index", "line", "circle")
LYING = ("bodies", "parts", *SHAPES, "guides")
"""Lists whose entries lie somewhere, so that a line or circle can move them."""
Names = dict[str, float | str]
Vec = tuple[float, float]


@dataclass(frozen=True)
class Copies:
    """A ``repeat`` that was read."""

    rows: list[Names]
    """Of each copy the names and values that hold in it."""
    index: str = "i"
    line: Vec | None = None
    """From one copy to the next [m]."""
    circle: Vec | None = None
    """Centre of a full turn [m]."""
    scope: Scope = field(default_factory=Scope)

    def label(self, number: int) -> str:
        """The label of a copy in messages."""
        name, value = next(iter(self.rows[number].items()))
        return f"{name} = {value if isinstance(value, str) else format(value, 'g')}"

    def moved(self, entry: dict[str, Any], number: int, among: str) -> dict[str, Any]:
        """A copy of an entry, moved along the line or round the circle.

        Raises:
            WrongValueError: it lies nowhere, or follows a path of its own.
        """
        if self.line is None and self.circle is None:
            return entry
        if among not in LYING:
            raise WrongValueError("bad-repeat", f"an entry of {quoted(among)} has no position, so "
                                  "it cannot have 'line' or 'circle'",
                                  allowed=f"entries of {listed(LYING)}; others use the index in "
                                  "their names")
        if "path" in entry:
            raise WrongValueError("bad-repeat", "a body with a path is not moved by a line or "
                                  "circle", allowed="the body in an assembly, and that repeated")
        turn = math.tau * number / len(self.rows) if self.circle is not None else 0.0
        result = dict(entry)
        for key in _points(entry, among):
            default = [0, 0]
            result[key] = self._each(entry.get(key, default), number, turn)
        if turn and (among in ("bodies", "parts") or entry.get("type") == "box"):
            result["angle"] = self._read(entry.get("angle", 0.0), "angle", turn)
        return result

    def _each(self, value: Any, number: int, turn: float) -> Any:
        """A point or a list of points; what is neither is left for the models to refuse."""
        if not isinstance(value, list) or not value:
            return value
        if isinstance(value[0], list):
            return [self._each(point, number, turn) for point in value]
        try:
            x, y = (number_from(each, "length", self.scope.known) for each in value)
        except ValueError:
            return value
        if self.circle is not None:
            cx, cy = self.circle
            c, s = math.cos(turn), math.sin(turn)
            x, y = cx + c * (x - cx) - s * (y - cy), cy + s * (x - cx) + c * (y - cy)
        if self.line is not None:
            x, y = x + number * self.line[0], y + number * self.line[1]
        return [x, y]

    def _read(self, value: Any, dimension: str, more: float) -> Any:
        try:
            return number_from(value, dimension, self.scope.known) + more
        except ValueError:
            return value


def _points(entry: Mapping[str, Any], among: str) -> Iterator[str]:
    """The keys of an entry for its position."""
    if among in SHAPES and "points" in entry:
        yield "points"
    elif among in SHAPES and "end" in entry:
        yield from ("start", "end")
    else:
        yield "at"


def read_repeat(value: Any, scope: Scope, limits: Limits) -> Copies:
    """Read the value of a ``repeat``.

    A whole number is that of the copies, counted by ``i`` from 0.

    Raises:
        RepeatError: what is wrong with it, and the key that it is wrong with.
    """
    if not isinstance(value, dict):
        return Copies(_counted(value, "i", scope, limits, ""), scope=scope)
    for key in value:
        if key not in KEYS:
            raise RepeatError(unknown_key(key, KEYS), (key,), key=True)
    index = value.get("index", "i")
    if wrong := wrong_index(index, scope, RESERVED):
        raise RepeatError(wrong, ("index",) if "index" in value else ())
    if ("count" in value) == ("list" in value):
        raise RepeatError(WrongValueError("bad-repeat",
                                          "a repeat needs either 'count' or 'list'"), ())
    for key in ("line", "circle"):
        if key in value and not (isinstance(value[key], list) and len(value[key]) == 2):
            what = "the step from one copy to the next" if key == "line" else "the centre"
            raise RepeatError(WrongValueError(
                "wrong-type", f"{what} is expected here, got {kind_of(value[key])}",
                allowed="two lengths [x, y]"), (key,))
    if "line" in value and "circle" in value:
        raise RepeatError(WrongValueError(
            "bad-repeat", "'line' and 'circle' exclude each other"), ("circle",))
    rows = (_counted(value["count"], index, scope, limits, "count") if "count" in value
            else _listed(value["list"], index, scope, limits))
    return Copies(rows, index, _vector(value, "line", scope), _vector(value, "circle", scope),
                  scope)


class RepeatError(Exception):
    """What is wrong with a ``repeat``, and where in it."""

    def __init__(
        self, error: WrongValueError, path: tuple[str | int, ...], *, key: bool = False,
    ) -> None:
        super().__init__(str(error))
        self.error, self.path, self.key = error, path, key


def _counted(value: Any, index: str, scope: Scope, limits: Limits, key: str) -> list[Names]:
    path = (key,) if key else ()
    if not key and (wrong := wrong_index(index, scope, RESERVED)):
        raise RepeatError(wrong, path)
    try:
        count = number_from(value, "ratio", scope.known)
    except WrongValueError as wrong:
        if not (isinstance(value, str) and value.lstrip().startswith("=")):
            wrong = WrongValueError("bad-repeat", f"{kind_of(value)} is not a number of copies",
                                    allowed=_wanted(limits))
        raise RepeatError(wrong, path) from None
    if not (count == int(count) and count >= 1):
        raise RepeatError(WrongValueError("bad-repeat", f"{number_text(count)} is not a number of "
                                          "copies", allowed=_wanted(limits)), path)
    _few_enough(count, limits, path)
    return [{index: float(i)} for i in range(int(count))]


def _wanted(limits: Limits) -> str:
    return (f"a whole number from 1 to {limits.elements}, an expression of parameters that gives "
            "one, or an object with 'count' or 'list'")


def _few_enough(count: float, limits: Limits, path: tuple[str, ...]) -> None:
    if count > limits.elements:
        raise RepeatError(WrongValueError(
            "limit-exceeded",
            f"{number_text(count)} copies are more than a scene may have elements",
            allowed=f"at most {limits.elements} (the limit 'elements', raised by "
            "--limit elements=N)",
        ), path)


def _listed(value: Any, index: str, scope: Scope, limits: Limits) -> list[Names]:
    if not isinstance(value, list) or not value:
        raise RepeatError(WrongValueError(
            "wrong-type", f"expected a list with an entry for each copy, got {kind_of(value)}"
            + (" without entries" if value == [] else "")), ("list",))
    _few_enough(len(value), limits, ("list",))
    rows: list[Names] = []
    for number, entry in enumerate(value):
        if isinstance(entry, dict):
            rows.append({index: float(number), **_row(entry, index, scope, number)})
        else:
            rows.append({index: _value(entry, scope, ("list", number))})
    return rows


def _row(entry: Mapping[str, Any], index: str, scope: Scope, number: int) -> Names:
    """The names and values of one object of a list."""
    row: Names = {}
    for name, given in entry.items():
        path = ("list", number, name)
        if name == index:
            raise RepeatError(WrongValueError(
                "duplicate-name", f"the name {quoted(name)} is that of the index, which counts the "
                "entries", allowed="another name, or another \"index\""), path, key=True)
        if wrong := wrong_index(name, scope, RESERVED):
            raise RepeatError(wrong, path, key=True)
        row[name] = _value(given, scope, path)
    return row


def _value(given: Any, scope: Scope, path: tuple[str | int, ...]) -> float | str:
    """A number, or else a word."""
    try:
        return float(number_from(given, None, scope.known))
    except WrongValueError as error:
        if isinstance(given, str) and given.isidentifier():
            return given
        raise RepeatError(error, path) from None


def _vector(value: Mapping[str, Any], key: str, scope: Scope) -> Vec | None:
    if key not in value:
        return None
    found = []
    for i, each in enumerate(value[key]):
        try:
            found.append(number_from(each, "length", scope.known))
        except WrongValueError as error:
            raise RepeatError(error, (key, i)) from None
    return found[0], found[1]
