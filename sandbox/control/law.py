"""What every control law is: something that begins, acts again and again, and reports.

A law knows numbers only: readings, targets and drive values come in the order
of the controller's ``reads`` and ``writes``, SI. Limits and rate limits are
applied outside; a law is told what came of what it wanted. Laws are plain
Python on floats: at the few numbers that a controller handles, an array costs
more than it saves.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol


class Law(Protocol):
    """What turns readings into drive values."""

    def begin(
        self, readings: Sequence[float], targets: Sequence[float], inputs: Sequence[float],
    ) -> None:
        """Begin, or begin anew after having been switched on.

        A law that is switched on during a run goes on from what its drives
        have, as far as it has a memory that can hold the difference.

        Args:
            readings: what the controller reads now, [number of readings].
            targets: what its signals say now, [number of targets].
            inputs: what its drives have now, [number of drives].
        """

    def act(
        self, t: float, readings: Sequence[float], targets: Sequence[float],
        applied: Sequence[float],
    ) -> list[float]:
        """What the law wants of its drives until it acts again.

        Args:
            t: the instant [s]; one period after the last act.
            readings: as in :meth:`begin`; at the first act after it the same.
            targets: as in :meth:`begin`.
            applied: what was in force since the last act, [number of drives]. It equals what
                was wanted, to the last bit, unless a limit or a rate limit cut it.

        Returns:
            One value for each drive, in its unit.
        """

    def report(self) -> dict[str, Any]:
        """What the law found out, as plain JSON data for ``run.json``; {} if nothing."""


class Memoryless:
    """The beginning and the end of a law that remembers nothing."""

    __slots__ = ()

    def begin(
        self, readings: Sequence[float], targets: Sequence[float], inputs: Sequence[float],
    ) -> None:
        """Nothing to prepare."""

    def report(self) -> dict[str, Any]:
        """Nothing to tell."""
        return {}
