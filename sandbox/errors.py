"""Everything that can go wrong and be told to a user: one short tree."""

from __future__ import annotations

import linecache
from collections.abc import Iterator
from dataclasses import dataclass, field
from types import TracebackType
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from sandbox.recording.recording import Recording


class SandboxError(Exception):
    """Base of every error that sandbox raises on purpose."""

    def _render_traceback_(self) -> list[str]:
        """What a notebook shows: the lines of its author that led here, and the message.

        IPython asks for it. What went on inside of sandbox tells the author nothing.
        """
        led = [*_own_lines(self.__traceback__),
               *(_own_lines(self.__cause__.__traceback__) if self.__cause__ else ())]
        return [*dict.fromkeys(led), f"{type(self).__name__}: {self}"]


def _own_lines(trace: TracebackType | None) -> Iterator[str]:
    """The lines of a traceback that are neither of this package nor of the notebook."""
    while trace is not None:
        frame = trace.tb_frame
        if frame.f_globals.get("__name__", "").partition(".")[0] not in ("sandbox", "IPython"):
            code = linecache.getline(frame.f_code.co_filename, trace.tb_lineno).strip()
            yield f"line {trace.tb_lineno}: {code}"
        trace = trace.tb_next


@dataclass(frozen=True)
class Problem:
    """One thing wrong with an input, or questionable, with all that is needed to mend it.

    It is made where it is found. Who knows more of where that is, the scene behind the
    mechanism or the file behind the scene, gives it a nearer path, a line and a column.
    """

    message: str
    path: str = "$"
    """JSON path, such as ``$.bodies[0].mass``, in what was looked at."""
    line: int = 0
    """From 1; 0 where it is not known, or the file has no such place."""
    column: int = 0
    """From 1, or 0 as the line."""
    allowed: str = ""
    """What would be right."""
    hint: str = ""
    """The near miss of a name."""
    key: bool = False
    """Whether the key at ``path`` is wrong, and not its value."""
    file: str = ""
    """The file, where it is not the one that was asked for but one that this includes."""
    element: str = ""
    """The element that it is about, whose name is told besides its place."""
    advice: str = ""
    """What to do, or what comes of it."""
    fields: str = ""
    """Where the docs have the fields of what it stands in, as ``docs/parts.md#leaf``."""
    severity: Literal["error", "warning"] = "error"
    """An error is wrong input, with exit code 2 of every command; a warning deserves a look."""

    @property
    def blocks(self) -> bool:
        """Whether nothing can be simulated before it is mended: so it is with every error."""
        return self.severity == "error"

    @property
    def text(self) -> str:
        """The message and what to do about it."""
        return f"{self.message}; {self.advice}" if self.advice else self.message

    @property
    def where(self) -> str:
        """Line, column and path, and the element's name; by itself where no text is known."""
        severity = "" if self.severity == "error" else f"{self.severity}: "
        if not self.line:
            return f"{severity}{self.element or self.path}"
        named = self.element and self.path != f"$.{self.element}"  # of settings the path says it
        return (f"{self.line}:{self.column}: {severity}{self.path}"
                f"{f': {self.element}' if named else ''}")

    def __str__(self) -> str:
        allowed = f" Allowed: {self.allowed}." if self.allowed else ""
        hint = f" Did you mean {self.hint}?" if self.hint else ""
        stop = "." if (allowed or hint) and not self.text.endswith(".") else ""
        return f"{self.where}: {self.text}{stop}{hint}{allowed}"


@dataclass(eq=False)
class SceneError(SandboxError):
    """A scene that cannot be used; carries every problem found, not the first."""

    problems: list[Problem]
    source: str = ""

    def __str__(self) -> str:
        return "\n".join(f"{source}:{problem}" if (source := problem.file or self.source)
                         else str(problem) for problem in self.problems)


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
class Jammed(SimulationDiverged):
    """A body that moves on a schedule was driven against what cannot give way."""

    def __str__(self) -> str:
        return f"the mechanism jammed at t = {self.time:.6g} s: {self.reason}"


@dataclass(eq=False)
class RecordingFull(SandboxError):
    """A run recorded more than it may, contacts included.

    ``recording`` holds what was recorded before, marked incomplete.
    """

    time: float
    most: float
    recording: Recording | None = field(default=None, repr=False)

    def __str__(self) -> str:
        most = f"{self.most:,.0f}".replace(",", " ")
        return (f"stopped at t = {self.time:.6g} s: samples and contacts recorded until then take "
                f"more than {most} bytes (the limit 'recorded_bytes', raised by "
                "--limit recorded_bytes=N, or simulate(recorded_bytes=...))")


@dataclass(eq=False)
class ControllerFailed(SandboxError):
    """A controller in Python raised an exception, or returned what no drive can have.

    ``recording`` holds what was recorded before, marked incomplete; ``__cause__`` is the exception.
    """

    time: float
    controller: str
    reason: str
    recording: Recording | None = field(default=None, repr=False)

    def __str__(self) -> str:
        return f"controller {self.controller!r}: act() at t = {self.time:.6g} s {self.reason}"


@dataclass(eq=False)
class Interrupted(SandboxError):
    """Ctrl-C in the middle of a simulation.

    ``recording`` holds what was recorded before, marked incomplete.
    """

    time: float
    recording: Recording | None = field(default=None, repr=False)

    def __str__(self) -> str:
        return f"interrupted at t = {self.time:.6g} s"
