"""Everything that can go wrong and be told to a user: one short tree."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sandbox.recording.recording import Recording


class SandboxError(Exception):
    """Base of every error that sandbox raises on purpose."""


@dataclass(frozen=True)
class Problem:
    """One thing wrong with an input, with all that is needed to mend it.

    ``path`` is a JSON path such as ``$.bodies[0].mass``; ``line`` and
    ``column`` count from 1 and are 0 where the file has no such place.
    """

    message: str
    path: str = "$"
    line: int = 0
    column: int = 0
    allowed: str = ""
    hint: str = ""

    def __str__(self) -> str:
        place = f"{self.line}:{self.column}: " if self.line else ""
        allowed = f" Allowed: {self.allowed}." if self.allowed else ""
        hint = f" Did you mean {self.hint}?" if self.hint else ""
        stop = "." if (allowed or hint) and not self.message.endswith(".") else ""
        return f"{place}{self.path}: {self.message}{stop}{allowed}{hint}"


@dataclass(eq=False)
class SceneError(SandboxError):
    """A scene that cannot be used; carries every problem found, not the first."""

    problems: list[Problem]
    source: str = ""

    def __str__(self) -> str:
        head = f"{self.source}:" if self.source else ""
        return "\n".join(f"{head}{problem}" for problem in self.problems)


class OutputError(SandboxError):
    """A file or directory that cannot be read or written."""


@dataclass(eq=False)
class SimulationDiverged(SandboxError):
    """The numbers of a simulation stopped being numbers, or ran away.

    ``recording`` holds what was recorded before, marked incomplete.
    """

    time: float
    culprit: str
    reason: str
    recording: Recording | None = field(default=None, repr=False)

    def __str__(self) -> str:
        return f"the simulation diverged at t = {self.time:.6g} s: {self.culprit}: {self.reason}"


@dataclass(eq=False)
class Interrupted(SandboxError):
    """Ctrl-C in the middle of a simulation.

    ``recording`` holds what was recorded before, marked incomplete.
    """

    time: float
    recording: Recording | None = field(default=None, repr=False)

    def __str__(self) -> str:
        return f"interrupted at t = {self.time:.6g} s"
