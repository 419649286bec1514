"""``repeat``: the number of copies of a list entry, and their positions."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from sandbox.scene.bodies import SHAPES
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.origins import Origin
from sandbox.scene.read.scopes import Scope, check_name, unknown_key
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
    scope: Scope
    line: Vec | None = None
    """From one copy to the next [m]."""
    circle: Vec | None = None
    """Centre of a full turn [m]."""

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
            result[key] = self._each(entry.get(key, [0, 0]), number, turn)
        if turn and (among in ("bodies", "parts") or entry.get("type") == "box"):
            angle = entry.get("angle", 0.0)
            numbers = self._read([angle], "angle")
            result["angle"] = numbers[0] + turn if numbers else angle
        return result

    def _each(self, value: Any, number: int, turn: float) -> Any:
        """A point or a list of points; what is neither is left for the models to refuse."""
        if not isinstance(value, list) or not value:
            return value
        if isinstance(value[0], list):
            return [self._each(point, number, turn) for point in value]
        if len(numbers := self._read(value, "length")) != 2:
            return value
        x, y = numbers
        if self.circle is not None:
            cx, cy = self.circle
            c, s = math.cos(turn), math.sin(turn)
            x, y = cx + c * (x - cx) - s * (y - cy), cy + s * (x - cx) + c * (y - cy)
        if self.line is not None:
            x, y = x + number * self.line[0], y + number * self.line[1]
        return [x, y]

    def _read(self, values: list[Any], dimension: str) -> list[float]:
        """The numbers of some values; none if one is wrong."""
        try:
            return [number_from(each, dimension, self.scope.known) for each in values]
        except ValueError:
            return []


def _points(entry: Mapping[str, Any], among: str) -> tuple[str, ...]:
    """The keys of an entry for its position."""
    if among in SHAPES and "points" in entry:
        return ("points",)
    return ("start", "end") if among in SHAPES and "end" in entry else ("at",)


def read_repeat(value: Any, scope: Scope, limits: Limits, place: Origin) -> Copies:
    """Read the value of a ``repeat``, which is at a place.

    A whole number is that of the copies, counted by ``i`` from 0.

    Raises:
        RefusedError: it is wrong.
    """
    given = value if isinstance(value, dict) else {"count": value}
    for key in given:
        with place.to(key).refusing(key=True):
            if key not in KEYS:
                raise unknown_key(key, KEYS)
    index = given.get("index", "i")
    with (place.to("index") if "index" in given else place).refusing():
        check_name(index, "an index", scope.parameters)
    with place.refusing():
        if ("count" in given) == ("list" in given):
            raise WrongValueError("bad-repeat", "a repeat needs either 'count' or 'list'")
    with place.to("circle").refusing():
        if "line" in given and "circle" in given:
            raise WrongValueError("bad-repeat", "'line' and 'circle' exclude each other")
    line, circle = (_vector(given, key, what, scope, place.to(key)) for key, what in (
        ("line", "the step from one copy to the next"), ("circle", "the centre")))
    if "list" in given:
        rows = list(_listed(given["list"], index, scope, limits, place.to("list")))
    else:
        with (place.to("count") if given is value else place).refusing():
            rows = [{index: float(i)} for i in range(_count(given["count"], scope, limits))]
    return Copies(rows, scope, line, circle)


def _count(value: Any, scope: Scope, limits: Limits) -> int:
    wanted = (f"a whole number from 1 to {limits.elements}, an expression of parameters that gives "
              "one, or an object with 'count' or 'list'")
    try:
        count = number_from(value, "ratio", scope.known)
    except WrongValueError:
        if isinstance(value, str) and value.lstrip().startswith("="):
            raise
        raise WrongValueError("bad-repeat", f"{kind_of(value)} is not a number of copies",
                              allowed=wanted) from None
    if not (count == int(count) and count >= 1):
        raise WrongValueError("bad-repeat", f"{number_text(count)} is not a number of copies",
                              allowed=wanted)
    _check_few(count, limits)
    return int(count)


def _check_few(count: float, limits: Limits) -> None:
    if count > limits.elements:
        raise WrongValueError(
            "limit-exceeded",
            f"{number_text(count)} copies are more than a scene may have elements",
            allowed=f"at most {limits.elements} (the limit 'elements', raised by "
            "--limit elements=N)")


def _listed(
    value: Any, index: str, scope: Scope, limits: Limits, place: Origin,
) -> Iterator[Names]:
    """The names and values of each entry of a list."""
    with place.refusing():
        if not isinstance(value, list) or not value:
            raise WrongValueError(
                "wrong-type", f"expected a list with an entry for each copy, got {kind_of(value)}"
                + (" without entries" if value == [] else ""))
        _check_few(len(value), limits)
    for number, entry in enumerate(value):
        here = place.to(number)
        if not isinstance(entry, dict):
            yield {index: _value(entry, scope, here)}
            continue
        row: Names = {index: float(number)}
        for name, given in entry.items():
            with here.to(name).refusing(key=True):
                if name == index:
                    raise WrongValueError(
                        "duplicate-name", f"the name {quoted(name)} is that of the index, which "
                        "counts the entries", allowed="another name, or another \"index\"")
                check_name(name, "an index", scope.parameters)
            row[name] = _value(given, scope, here.to(name))
        yield row


def _value(given: Any, scope: Scope, place: Origin) -> float | str:
    """A number, or else a word."""
    with place.refusing():
        try:
            return float(number_from(given, None, scope.known))
        except WrongValueError:
            if isinstance(given, str) and given.isidentifier():
                return given
            raise


def _vector(
    given: Mapping[str, Any], key: str, what: str, scope: Scope, place: Origin,
) -> Vec | None:
    if key not in given:
        return None
    with place.refusing():
        if not (isinstance(given[key], list) and len(given[key]) == 2):
            raise WrongValueError(
                "wrong-type", f"{what} is expected here, got {kind_of(given[key])}",
                allowed="two lengths [x, y]")
    found = []
    for i, each in enumerate(given[key]):
        with place.to(i).refusing():
            found.append(number_from(each, "length", scope.known))
    return found[0], found[1]
