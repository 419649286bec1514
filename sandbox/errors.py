"""Exceptions and diagnostics of the package, each with a code of :data:`sandbox.codes.CODES`."""

from __future__ import annotations

import linecache
import traceback
from collections.abc import Iterator
from dataclasses import dataclass, field
from importlib import import_module
from types import TracebackType
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from sandbox.codes import CODES

if TYPE_CHECKING:
    from sandbox.recording.recording import Recording
    from sandbox.wording import WrongValueError


class SandboxError(Exception):
    """Base class of all errors that sandbox raises deliberately.

    ``code`` is the key of the error in :data:`sandbox.codes.CODES`; subclasses have a default.
    """

    code: str = "bad-argument"

    def __init__(self, message: str = "", *, code: str = "") -> None:
        super().__init__(message)
        if code:
            self.code = checked(code)

    def _render_traceback_(self) -> list[str]:
        """Return the traceback that IPython shows: lines outside the package, and the message."""
        lines = [*_own_lines(self.__traceback__),
                 *(_own_lines(self.__cause__.__traceback__) if self.__cause__ else ())]
        return [*dict.fromkeys(lines), f"{type(self).__name__}: {self}"]


def optional(module: str, install: str = "'sandbox-mechanics[studies]'") -> Any:
    """Import an optional module; without it, an error with the argument of ``pip install``."""
    try:
        return import_module(module)
    except ImportError:
        raise SandboxError(f"this needs {module}: pip install {install}",
                           code="missing-package") from None


def checked(code: str) -> str:
    """Return a code of a diagnostic; a KeyError if the table of codes does not have it."""
    if code not in CODES:
        raise KeyError(f"no diagnostic has the code {code!r}")
    return code


def _own_lines(trace: TracebackType | None) -> Iterator[str]:
    """Yield the lines of a traceback outside this package and IPython."""
    for frame, line in traceback.walk_tb(trace):
        if frame.f_globals.get("__name__", "").partition(".")[0] not in ("sandbox", "IPython"):
            yield f"line {line}: {linecache.getline(frame.f_code.co_filename, line).strip()}"


@dataclass(frozen=True)
class Problem:
    """A diagnostic; callers that know the scene or its file add a path, a line and a column."""

    code: str  # its key in :data:`sandbox.codes.CODES`
    message: str  # what is wrong
    path: str = "$"  # JSON path in the input, such as ``$.bodies[0].mass``
    line: int = 0  # from 1; 0 if unknown or not in a file
    column: int = 0  # from 1; 0 if unknown
    allowed: str = ""  # the values that are allowed
    hint: str = ""  # a similar name that exists
    key: bool = False  # whether the key at ``path`` is wrong, not its value
    file: str = ""  # the included file, if the problem is not in the main file
    element: str = ""  # name of the element, shown after its path
    advice: str = ""  # what to do, or the consequence
    fields: str = ""  # page that lists the fields of the element, such as ``docs/parts.md#leaf``
    severity: Literal["error", "warning"] = "error"
    """Errors are invalid input and end each command with exit code 2."""

    def __post_init__(self) -> None:
        checked(self.code)

    @classmethod
    def of(cls, error: WrongValueError, path: str, **more: Any) -> Problem:
        """Return the problem of a wrong value at a path; ``more`` are further fields."""
        return cls(**{"code": error.code, "message": error.message, "path": path,
                      "allowed": error.allowed, "hint": error.hint, **more})

    @property
    def blocks(self) -> bool:
        """Whether it prevents a simulation, as all errors do."""
        return self.severity == "error"

    @property
    def text(self) -> str:
        """The message and the advice."""
        return f"{self.message}; {self.advice}" if self.advice else self.message

    @property
    def where(self) -> str:
        """Line, column, path and element; only path or element without a file."""
        severity = "" if self.severity == "error" else f"{self.severity}: "
        if not self.line:
            return f"{severity}{self.element or self.path}"
        named = self.element and self.path != f"$.{self.element}"  # a setting: in the path
        return (f"{self.line}:{self.column}: {severity}{self.path}"
                f"{f': {self.element}' if named else ''}")

    def at(self, source: str) -> str:
        """``file:line:col: path: message``, or ``error: message`` without a place."""
        if source := self.file or source:
            return f"{source}:{self}"
        return str(self) if self.path else f"error{self}"

    def __str__(self) -> str:
        allowed = f" Allowed: {self.allowed}." if self.allowed else ""
        hint = f" Did you mean {self.hint}?" if self.hint else ""
        stop = "." if (allowed or hint) and not self.text.endswith(".") else ""
        return f"{self.where}: {self.text}{stop}{hint}{allowed}"


@dataclass(eq=False)
class SceneError(SandboxError):
    """A scene that cannot be used, with all problems found.

    ``code`` is that of the first problem.
    """

    problems: list[Problem]
    source: str = ""

    def __post_init__(self) -> None:
        self.code = self.problems[0].code

    def __str__(self) -> str:
        return "\n".join(problem.at(self.source) for problem in self.problems)


class OutputError(SandboxError):
    """A file or directory that cannot be read or written, or a picture that cannot be drawn."""

    code = "cannot-write"


@dataclass(eq=False)
class RunEnded(SandboxError):
    """Base class of errors that end a run.

    ``time`` is that of the last step [s]; ``recording`` holds the samples until then, marked
    incomplete.
    """

    text: ClassVar[str]  # the message, with fields in braces
    time: float
    recording: Recording | None = field(default=None, repr=False, kw_only=True)

    def __str__(self) -> str:
        return self.text.format(**vars(self))


@dataclass(eq=False)
class SimulationDiverged(RunEnded):
    """Values of a simulation became infinite, undefined or very large."""

    code = "diverged"
    text = "the simulation diverged at t = {time:.6g} s: {culprit}: {reason}"
    culprit: str
    reason: str


@dataclass(eq=False)
class Jammed(SimulationDiverged):
    """A scheduled body pushes against something that cannot move."""

    code = "jammed"
    text = "the mechanism jammed at t = {time:.6g} s: {reason}"


@dataclass(eq=False)
class RecordingFull(RunEnded):
    """A run exceeds the limit of recorded bytes, contacts included."""

    code = "limit-exceeded"
    most: float

    def __str__(self) -> str:
        most = f"{self.most:,.0f}".replace(",", " ")
        return (f"stopped at t = {self.time:.6g} s: samples and contacts recorded until then take "
                f"more than {most} bytes (the limit 'recorded_bytes', raised by "
                "--limit recorded_bytes=N, or simulate(recorded_bytes=...))")


@dataclass(eq=False)
class ControllerFailed(RunEnded):
    """A Python controller raised an exception, its ``__cause__``, or returned invalid values."""

    code = "controller-failed"
    text = "controller {controller!r}: act() at t = {time:.6g} s {reason}"
    controller: str
    reason: str


@dataclass(eq=False)
class Interrupted(RunEnded):
    """Ctrl-C during a simulation."""

    code = "interrupted"
    text = "interrupted at t = {time:.6g} s"
