"""The catalogue: every quantity of a run of a mechanism, with its unit.

A name is ``<element>.<quantity>``; the element is the longest element name that leaves a quantity
which that element has. Pairs, ``<body>/<body>.normal``, are found but not listed.
``solver.residual`` is found but not listed either: it belongs to the run.
"""

from __future__ import annotations

import difflib
import fnmatch
import itertools
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from sandbox.elements.element import NAMED, RELEASABLE, Element
from sandbox.elements.quantities import BOND_QUANTITIES, GRASP, USUAL, by_telling, quantities_of
from sandbox.elements.registry import KINDS
from sandbox.errors import SandboxError
from sandbox.scene.bodies import Body
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import MAX_COMPARED, is_pattern, listed, nearest, quoted

PAIR, SOLVER = quantities_of("pair"), quantities_of("solver")
MAX_QUANTITIES = len(quantities_of("body")) + len(GRASP)  # in a message: all of an object


class UnknownQuantityError(SandboxError, KeyError):
    """A name that is not in the catalogue."""

    code = "unknown-quantity"

    def __init__(self, name: str, near: str = "", lacking: str = "") -> None:
        super().__init__(name)
        self.name, self.near, self.lacking = name, near, lacking

    def __str__(self) -> str:
        if self.lacking:
            return f"unknown quantity {self.name!r}: {self.lacking}"
        what = "no quantity fits" if is_pattern(self.name) else "unknown quantity"
        return f"{what} {self.name!r}" + (f"; did you mean {self.near!r}?" if self.near else "")


@dataclass(frozen=True)
class CatalogueEntry:
    """A named part of a mechanism and its quantities."""

    kind: str  # ``body``, ``joint``, ... as in NAMED
    index: int  # place among its kind in the mechanism; of a load in ``Mechanism.loaded``
    quantities: Mapping[str, str]  # with units; a meter's only quantity has an empty name


@dataclass(frozen=True)
class Source:
    """Where a quantity comes from."""

    kind: str  # that of a CatalogueEntry, or ``pair``
    index: int
    quantity: str
    unit: str
    other: int = -1  # the other body of a pair


def _full(name: str, quantity: str) -> str:
    return f"{name}.{quantity}" if quantity else name


class Catalogue:
    """All quantities of a mechanism; looking one up costs microseconds."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.elements: dict[str, CatalogueEntry] = {}
        for name, element in _elements(mechanism):
            self.elements.setdefault(name, element)
        self.hinted = 0  # number of problems of unknown names so far
        self._bodies = {body.name: index for index, body in enumerate(mechanism.bodies)}

    @cached_property
    def units(self) -> dict[str, str]:
        """Name to unit of every quantity except pairs, kind by kind in the mechanism's order."""
        return {_full(name, quantity): unit for name, element in self.elements.items()
                for quantity, unit in element.quantities.items()}

    @cached_property
    def telling(self) -> list[str]:
        """The same names, the quantities of each element in the order in which they are shown."""
        return [_full(name, quantity) for name, element in self.elements.items()
                for quantity in by_telling(element.quantities)]

    @cached_property
    def usual(self) -> dict[str, list[str]]:
        """The quantities shown first, by kind: one of each meter, of each tendon, and so on."""
        bodies = self.mechanism.bodies
        return {kind: [_full(name, quantity) for name, element in self.elements.items()
                       if element.kind == kind and quantity in element.quantities
                       and not (kind == "body" and bodies[element.index].motion == "fixed")]
                for kind, quantity in USUAL.items()}

    def find(self, name: str) -> Source:
        """Where a quantity comes from; UnknownQuantityError if it is not in the catalogue."""
        if (source := self._found(name)) is None:
            raise UnknownQuantityError(name, self.near(name), self.lacking(name))
        return source

    def __contains__(self, name: str) -> bool:
        return self._found(name) is not None

    def match(self, pattern: str) -> list[str]:
        """The names that fit a pattern (:mod:`fnmatch`, case matters), in catalogue order.

        A pattern with ``/`` finds each pair that can touch once, if possible moving body first.
        """
        if not is_pattern(pattern):
            return [pattern] if pattern in self else []
        if "/" in pattern:
            return list(self._match_pairs(pattern))
        return list(filter(re.compile(fnmatch.translate(pattern)).match, self.units))

    @cached_property
    def _words(self) -> list[str]:
        words = dict.fromkeys(word for name in self.units for word in name.split("."))
        return list(itertools.islice(words, MAX_COMPARED))

    def near(self, name: str) -> str:
        """A quantity or a pattern that fits, with one word corrected."""
        if "/" in name and not is_pattern(name):
            lists: list[Collection[str]] = [self._bodies, self._bodies, PAIR]
            one, other, last = (word if word in known else nearest(word, known)
                                for word, known in zip(pair_parts(name), lists, strict=True))
            return pair if (pair := f"{one}/{other}.{last}") in self else ""
        for head, element in () if is_pattern(name) else self._prefixes(name):
            if close := nearest(name[len(head) + 1:], element.quantities):
                return f"{head}.{close}"
        words = name.split(".")
        for i, word in reversed(list(enumerate(words))):
            for close in [] if is_pattern(word) else difflib.get_close_matches(word, self._words):
                mended = ".".join([*words[:i], close, *words[i + 1:]])
                if self.match(mended):
                    return mended
        return nearest(name, self.units)

    def lacking(self, name: str) -> str:
        """Why an element lacks a quantity that others of its kind have; empty of other names."""
        head, _, quantity = name.rpartition(".")
        if head in self._bodies and quantity in GRASP:
            body = self.mechanism.bodies[self._bodies[head]]
            if body.role != "object":
                return (f"only bodies with the role 'object' have it, {quoted(head)} has the role "
                        f"{quoted(body.role)}")
            if not body.shapes:
                return f"{quoted(head)} has no shapes, and nothing can touch it"
            if GRASP[quantity].of_free:
                return f"{quoted(head)} does not move freely, so it has no grasp quantities"
        for head, entry in self._prefixes(name):
            kind, index, quantity = f"{entry.kind}s", entry.index, name[len(head) + 1:]
            if kind not in KINDS:
                continue
            if kind == "loads":
                index = self.mechanism.loaded[index][0]
            element: Element = getattr(self.mechanism, kind)[index]
            need = "'breaks_at', or an event that releases it" if (
                quantity in BOND_QUANTITIES and kind in RELEASABLE) else element.needed(quantity)
            if need:
                return f"{quoted(head)} has it only with {need}"
        return ""

    def allowed(self, name: str) -> str:
        """Quantities of the element that an unknown name begins with, or all elements."""
        if "/" in name or is_pattern(name):
            return ""
        for head, element in self._prefixes(name):
            if own := [f"{head}.{quantity}" for quantity in element.quantities if quantity]:
                return listed(own, most=MAX_QUANTITIES)
        return f"a quantity of {listed(self.elements)}" if self.elements else ""

    def _prefixes(self, name: str) -> Iterator[tuple[str, CatalogueEntry]]:
        """The element names that ``name`` begins with, longest first."""
        head = name
        while head:
            if head in self.elements:
                yield head, self.elements[head]
            head = head.rpartition(".")[0]

    def _found(self, name: str) -> Source | None:
        if "/" in name:
            first, second, quantity = pair_parts(name)
            body, other = self._bodies.get(first), self._bodies.get(second)
            return None if (body is None or other is None or body == other or quantity not in PAIR
                            ) else Source("pair", body, quantity, PAIR[quantity], other)
        for head, element in self._prefixes(name):
            quantity = name[len(head) + 1:]
            if quantity in element.quantities:
                return Source(element.kind, element.index, quantity, element.quantities[quantity])
        head, _, quantity = name.partition(".")
        return Source("solver", 0, quantity, SOLVER[quantity]) if (
            head == "solver" and quantity in SOLVER) else None

    def _match_pairs(self, pattern: str) -> Iterator[str]:
        """Names of pairs in the order of their bodies, each pair spelled one way."""
        # the one / of a name is that of its pattern, so the halves match separately
        first, second = (re.compile(fnmatch.translate(half)).match
                         for half in pattern.split("/", maxsplit=1))
        begins = {body.name: first(body.name) for body in self.mechanism.bodies if body.shapes}
        ends = {name: [each for each in PAIR if second(f"{name}.{each}")] for name in begins}
        some = [body for body in self.mechanism.bodies
                if begins.get(body.name) or ends.get(body.name)]
        for a, b in itertools.combinations(some, 2):
            if "dynamic" in (a.motion, b.motion):
                pair = (b.name, a.name) if a.motion == "fixed" else (a.name, b.name)
                for quantity in PAIR:
                    fits = [f"{one}/{other}.{quantity}" for one, other in (pair, pair[::-1])
                            if begins[one] and quantity in ends[other]]
                    yield from fits[:1]


def pair_parts(pair: str) -> tuple[str, str, str]:
    """The two bodies and the quantity in the name of one of a pair."""
    first, _, rest = pair.partition("/")
    second, _, quantity = rest.rpartition(".")
    return first, second, quantity


def _elements(mechanism: Mechanism) -> Iterator[tuple[str, CatalogueEntry]]:
    units = {key: row.unit for key, row in BOND_QUANTITIES.items()}
    bonds = dict.fromkeys(mechanism.releasable, units)
    for i, body in enumerate(mechanism.bodies):
        yield body.name, CatalogueEntry("body", i, quantities_of("body") | grasp_of(body))
    for kind in KINDS:
        if kind == "loads":
            for i, (load, on) in enumerate(mechanism.loaded):
                name = f"{mechanism.loads[load].name}.{mechanism.bodies[on].name}"
                yield name, CatalogueEntry("load", i, mechanism.loads[load].quantities(mechanism))
        elif NAMED[kind].axis:
            for i, element in enumerate(getattr(mechanism, kind)):
                yield element.name, CatalogueEntry(NAMED[kind].one, i, element.quantities(
                    mechanism) | bonds.get(element.name, {}))
    for i, group in enumerate(mechanism.groups):
        yield group.name, CatalogueEntry("group", i, quantities_of("group"))
    for i, meter in enumerate(mechanism.meters):
        yield meter.name, CatalogueEntry("meter", i, {"": meter.unit})


def grasp_of(body: Body) -> dict[str, str]:
    """Additional quantities of an object, with units."""
    if body.role != "object" or not body.shapes:
        return {}
    return {name: row.unit for name, row in GRASP.items()
            if body.motion == "dynamic" or not row.of_free}


class MixedUnitsError(SandboxError, ValueError):
    """A pattern that fits quantities of several units, which are no columns of one array."""

    code = "bad-quantity"
