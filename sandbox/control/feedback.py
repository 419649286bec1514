"""A drive that follows an expression of quantities, which is the controller's one reading."""

from __future__ import annotations

from collections.abc import Sequence

from sandbox.control.law import Memoryless


class Feedback(Memoryless):
    """Wants its reading."""

    __slots__ = ()

    def act(
        self, t: float, readings: Sequence[float], targets: Sequence[float],
        applied: Sequence[float],
    ) -> list[float]:
        """The value of the expression."""
        return [readings[0]]
