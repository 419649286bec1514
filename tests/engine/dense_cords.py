"""Cords that guides hold by friction, from textbook forms that take complex numbers too.

Between two circles of radii r (counter-clockwise round them positive) whose centres are d apart a
cord runs straight over L, along the direction b:

    L^2 = d^2 - (r_2 - r_1)^2,     b = bearing(d) - atan((r_2 - r_1) / L)
    P = L + r_2 (t_2 - b) - r_1 (t_1 - b)                   t the angles of the circles' bodies

P, summed over a span, is its length as if it were tied to the circles at its ends, up to a
constant; over the straight pieces and the arcs between them alone it is what hangs free.
"""

from __future__ import annotations

import itertools
import math
from typing import Any, NamedTuple

import numpy as np

from sandbox.model.model import Model
from sandbox.scene.elements.tendons import Guide, Tendon

from .dense_wheels import bearing


class Piece(NamedTuple):
    """A span: numbers of a tendon's guides, and which of those that hold it are at its ends."""

    guides: list[int]
    into: int | None
    out_of: int | None


def pieces(tendon: Tendon) -> list[Piece]:
    """The spans of a tendon that guides hold, in its order; none where none hold it."""
    count = len(tendon.guides)
    holds = [k for k, guide in enumerate(tendon.guides)
             if guide.friction > 0 and (tendon.closed or 0 < k < count - 1)]
    if tendon.closed:
        if len(holds) < 2:
            return []
        turns = zip(holds, [*holds[1:], holds[0] + count], strict=True)
        return [Piece([k % count for k in range(a, b + 1)], a, b % count) for a, b in turns]
    ends = [0, *holds, count - 1]
    return [Piece(list(range(a, b + 1)), a if a else None, b if b < count - 1 else None)
            for a, b in itertools.pairwise(ends)] if holds else []


class Cord:
    """A tendon of a model: lengths, bends and what is in its spans."""

    def __init__(self, model: Model, number: int, start: np.ndarray) -> None:
        self.model, self.tendon = model, model.mechanism.tendons[number]
        self.number, self.pieces = number, pieces(self.tendon)
        self.names = model.names.body
        self.start = start
        count = len(self.tendon.guides)
        self.legs = range(count if self.tendon.closed else count - 1)
        ways = [np.real(self._centre(start, k + 1) - self._centre(start, k)) for k in self.legs]
        self.lines = [math.atan2(y, x) for x, y in ways]
        self.begin = [float(np.real(self.leg(start, k)[1])) for k in self.legs]
        free = [self.hangs(start, piece) for piece in self.pieces]
        arcs = sum(self._arc(start, k) for k in self.held)
        own = self.tendon
        path = float(np.real(sum(free) + arcs))  # what hangs, and what lies on what holds it
        rest = path if own.rest_length is None else own.rest_length
        if own.pretension is not None:
            rest = path - own.pretension / own.stiffness
        self.rest = rest + own.slack
        share = (self.rest / path if self.rest <= path
                 else 1 + (self.rest - path) / float(np.real(sum(free))))
        self.inside = [float(np.real(length)) * share for length in free]

    @property
    def held(self) -> list[int]:
        """The guides that hold it, in its order."""
        return [piece.into for piece in self.pieces if piece.into is not None]

    def guide(self, k: int) -> Guide:
        return self.tendon.guides[k % len(self.tendon.guides)]

    def radius(self, k: int) -> float:
        guide = self.guide(k)
        return guide.radius if guide.side == "left" else -guide.radius

    def leg(self, q: np.ndarray, k: int) -> tuple[Any, Any]:
        """Length and direction of the straight piece behind a guide."""
        one, two = self._centre(q, k), self._centre(q, k + 1)
        d, over = two - one, self.radius(k + 1) - self.radius(k)
        square = (d**2).sum()
        straight = np.sqrt(square - over**2)
        return straight, bearing(d, self.lines[k]) - np.arctan(over / straight)

    def _centre(self, q: np.ndarray, k: int) -> np.ndarray:
        guide = self.guide(k)
        body = self.names[guide.body]
        x, y, angle = q[body]
        dx, dy = np.asarray(guide.at) - self.model.bodies.centre[body]
        c, s = np.cos(angle), np.sin(angle)
        return np.array([x + c * dx - s * dy, y + s * dx + c * dy])

    def turn(self, q: np.ndarray, k: int) -> Any:
        """By how much the cord turns counter-clockwise at a guide between two pieces."""
        ahead, behind = k % len(self.legs), (k - 1) % len(self.legs)
        turn = self.leg(q, ahead)[1] - self.leg(q, behind)[1]
        begin = self.begin[ahead] - self.begin[behind]
        if self.radius(k) == 0:
            return math.remainder(float(np.real(turn)), math.tau)
        side = math.copysign(1.0, self.radius(k))
        return turn - begin + side * (side * begin % math.tau + math.tau * self.guide(k).turns)

    def bend(self, q: np.ndarray, k: int) -> float:
        """The angle of friction at a guide, none off its wheel."""
        turn = float(np.real(self.turn(q, k)))
        return abs(turn) if self.radius(k) == 0 else max(
            0.0, math.copysign(1.0, self.radius(k)) * turn)

    def _arc(self, q: np.ndarray, k: int) -> Any:
        return self.radius(k) * self.turn(q, k) if self.radius(k) else 0.0

    def hangs(self, q: np.ndarray, piece: Piece) -> Any:
        """What of a span lies between the circles at its ends."""
        legs = self._legs(piece)
        return (sum(self.leg(q, k)[0] for k in legs)
                + sum(self._arc(q, k) for k in piece.guides[1:-1]))

    def _legs(self, piece: Piece) -> list[int]:
        return [k % len(self.legs) for k in piece.guides[:-1]]

    def wound(self, q: np.ndarray, piece: Piece) -> Any:
        """What the circles at the ends of a span have wound up since t = 0."""
        def over(q: np.ndarray) -> Any:
            total = 0.0
            for end, leg, sign in ((0, 0, -1.0), (-1, -1, 1.0)):
                k = piece.guides[end]
                angle = q[self.names[self.guide(k).body], 2]
                total += sign * self.radius(k) * (angle - self.leg(q, self._legs(piece)[leg])[1])
            return total
        return over(q) - over(self.start)

    def length(self, q: np.ndarray, piece: Piece) -> Any:
        """Of a span as if tied at its ends; what they wound up counts."""
        return self.hangs(q, piece) + self.wound(q, piece)
