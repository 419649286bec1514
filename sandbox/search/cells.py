"""Where an answer changes in a line or a square, by dividing only cells whose points disagree.

A coarse grid is asked first. Every cell with different answers on its border is halved along each
way (a bisection, of two dimensions a quadtree: Finkel and Bentley, Acta Inf. 4 (1974) 1-9), and so
is a larger neighbour on whose side a new point answers otherwise. So all cells with a boundary in
them are equally small in the end, and it goes on from each to the next. What lies between points of
the coarse grid and touches none of them is not found.

Points lie on a lattice of whole numbers, a sheet number first: several sheets are asked together.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.numeric import Array, Integers

HOLDS, FAILS, SILENT, UNDECIDED = 1, 0, -1, 2
"""Answers: it holds, it does not, the run tells nothing; a cell whose points disagree."""
Node = tuple[int, ...]
"""Of the lattice: its sheet, then its place along each way."""
Edge = tuple[Node, Node]
"""Two neighbours with different answers, the one that is first in order first."""
Ask = Callable[[Sequence[Node]], Sequence[int]]


@dataclass(frozen=True)
class Cell:
    """An interval or a square of the lattice."""

    corner: Node
    """Its first one."""
    size: int

    def corners(self) -> list[Node]:
        """All of them, [2 or 4]."""
        return [self._moved(way, self.size) for way in self._ways()]

    def halves(self) -> list[Cell]:
        """The cells that it is divided into, [2 or 4]."""
        half = self.size // 2
        return [Cell(self._moved(way, half), half) for way in self._ways()]

    def border(self) -> Iterator[Node]:
        """All points of the lattice on its border."""
        sheet, *place = self.corner
        if len(place) == 1:
            yield from self.corners()
            return
        for step in range(self.size):
            for i, j in ((step, 0), (self.size, step), (self.size - step, self.size),
                         (0, self.size - step)):
                yield sheet, place[0] + i, place[1] + j

    def _ways(self) -> list[tuple[int, ...]]:
        return list(itertools.product((0, 1), repeat=len(self.corner) - 1))

    def _moved(self, way: tuple[int, ...], by: int) -> Node:
        sheet, *place = self.corner
        return (sheet, *(at + by * step for at, step in zip(place, way, strict=True)))


@dataclass(frozen=True)
class Divided:
    """What is known of all cells in the end."""

    cells: tuple[Cell, ...]
    answers: Mapping[Node, int]
    side: int
    """Of a sheet, in units of the lattice."""
    lacking: int
    """Points of the next division, for which there is no room; 0 if all were made."""

    def of(self, cell: Cell) -> int | None:
        """The one answer of a cell; None if it is undecided."""
        first, *others = (self.answers[corner] for corner in cell.corners())
        return first if all(other == first for other in others) and \
            not _mixed(cell, self.answers) else None

    def edges(self, cell: Cell) -> list[Edge]:
        """The edges of a cell between what holds and what does not."""
        nodes = cell.corners()
        pairs = [(0, 1)] if len(nodes) == 2 else [(0, 1), (0, 2), (1, 3), (2, 3)]
        return [(nodes[a], nodes[b]) for a, b in pairs
                if {self.answers[nodes[a]], self.answers[nodes[b]]} == {HOLDS, FAILS}]

    def states(self, sheet: int) -> Integers:
        """The answer in each unit of the lattice, [side] or [side, side]; UNDECIDED where none."""
        found = np.empty((self.side,) * (len(self.cells[0].corner) - 1), dtype=int)
        for cell in self.cells:
            if cell.corner[0] == sheet:
                answer = self.of(cell)
                found[tuple(slice(at, at + cell.size) for at in cell.corner[1:])] = \
                    UNDECIDED if answer is None else answer
        return found

    @property
    def crossed(self) -> list[Edge]:
        """All edges of smallest cells between what holds and what does not, in order."""
        least = min(cell.size for cell in self.cells)
        return sorted({edge for cell in self.cells if cell.size == least
                       for edge in self.edges(cell)})


def divide(ask: Ask, *, sheets: int, ways: int, coarse: int, levels: int, most: int) -> Divided:
    """Find where the answer changes.

    Args:
        ask: answers at nodes, in their order; no node is asked for twice.
        sheets: how many lines or squares.
        ways: 1 or 2, their dimension.
        coarse: cells along each way at first.
        levels: how often they are halved at most.
        most: nodes in all; a division that would need more is not made, as a whole.
    """
    size = 2 ** levels
    cells = [Cell((sheet, *(size * at for at in place)), size) for sheet in range(sheets)
             for place in itertools.product(range(coarse), repeat=ways)]
    answers: dict[Node, int] = {}
    _learn(ask, answers, _new(cells, answers))
    lacking = 0
    while size > 1 and not lacking:
        size //= 2
        before = cells
        while split := {cell for cell in cells if cell.size > size and _mixed(cell, answers)}:
            cells = [part for cell in cells
                     for part in (cell.halves() if cell in split else [cell])]
            new = _new(cells, answers)
            if len(answers) + len(new) > most:
                cells, lacking = before, len(new)
                break
            _learn(ask, answers, new)
    return Divided(tuple(cells), answers, coarse * 2 ** levels, lacking)


def _new(cells: Sequence[Cell], answers: Mapping[Node, int]) -> list[Node]:
    return sorted({node for cell in cells for node in cell.corners()} - answers.keys())


def _learn(ask: Ask, answers: dict[Node, int], nodes: Sequence[Node]) -> None:
    answers.update(zip(nodes, ask(nodes), strict=True))


def _mixed(cell: Cell, answers: Mapping[Node, int]) -> bool:
    return len({answers[node] for node in cell.border() if node in answers}) > 1


def trace(found: Divided, sheet: int) -> list[Array]:
    """The boundary between what holds and what does not, through the middles of crossed edges.

    Args:
        found: of squares.
        sheet: which of them.

    Returns:
        polylines [n, 2], 0 to 1 along each way; a closed one ends where it begins.
    """
    least = min(cell.size for cell in found.cells)
    joined: dict[Edge, list[Edge]] = {}
    for cell in found.cells:
        if cell.size != least or cell.corner[0] != sheet:
            continue
        for one, other in _segments(cell, found):
            joined.setdefault(one, []).append(other)
            joined.setdefault(other, []).append(one)
    lines = []
    while joined:  # open ones from an end, what is left is closed
        start = min((edge for edge in joined if len(joined[edge]) == 1), default=min(joined))
        line = [start]
        while after := joined.get(line[-1]):
            following = after[0]
            _part(joined, line[-1], following)
            line.append(following)
        lines.append(np.array([np.mean(edge, axis=0)[1:] for edge in line]) / found.side)
    return lines


def _segments(cell: Cell, found: Divided) -> list[tuple[Edge, Edge]]:
    """Pairs of crossed edges of a cell that the boundary goes between."""
    crossed = found.edges(cell)
    if len(crossed) < 4:  # with a silent corner it may be one alone, which leads nowhere
        return [(crossed[0], crossed[1])] if len(crossed) == 2 else []
    left, low, high, right = crossed
    # a saddle: corners that hold are kept apart, so that no bridge is claimed that nobody saw
    if found.answers[cell.corners()[0]] == HOLDS:
        return [(left, low), (high, right)]
    return [(left, high), (low, right)]


def _part(joined: dict[Edge, list[Edge]], one: Edge, other: Edge) -> None:
    for here, there in ((one, other), (other, one)):
        joined[here].remove(there)
        if not joined[here]:
            del joined[here]
