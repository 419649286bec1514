"""A drive that follows a value over time."""

from __future__ import annotations

from collections.abc import Sequence

from sandbox.control.law import Memoryless


class Schedule(Memoryless):
    """Wants its target."""

    __slots__ = ()

    def act(
        self, t: float, readings: Sequence[float], targets: Sequence[float],
        applied: Sequence[float],
    ) -> list[float]:
        """The target as it is now."""
        return [targets[0]]
