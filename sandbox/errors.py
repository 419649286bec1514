"""Exceptions and diagnostics of the package, each with a code of :data:`sandbox.codes.CODES`."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
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
            self.code = Problem(code, message).code  # which is checked

    def _render_traceback_(self) -> list[str]:
        """Return the traceback that IPython shows: lines outside the package, and the message."""
        import linecache
        from traceback import walk_tb
        cause = self.__cause__.__traceback__ if self.__cause__ else None
        lines = [f"line {line}: {linecache.getline(frame.f_code.co_filename, line).strip()}"
                 for frame, line in (*walk_tb(self.__traceback__), *walk_tb(cause))
                 if frame.f_globals.get("__name__", "").partition(".")[0] not in
                 ("sandbox", "IPython")]
        return [*dict.fromkeys(lines), f"{type(self).__name__}: {self}"]


def optional(module: str, install: str = "'sandbox-mechanics[studies]'") -> Any:
    """Import an optional module; without it, an error with the argument of ``pip install``."""
    try:
        return import_module(module)
    except ImportError:
        raise SandboxError(f"this needs {module}: pip install {install}",
                           code="missing-package") from None


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
        if self.code not in CODES:
            raise KeyError(f"no diagnostic has the code {self.code!r}")

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

    def at(self, source: str) -> str:
        """``file:line:col: path: message``, or ``error: message`` without a place."""
        if source := self.file or source:
            return f"{source}:{self}"
        return str(self) if self.path else f"error{self}"

    def __str__(self) -> str:
        severity = "" if self.severity == "error" else f"{self.severity}: "
        where = f"{severity}{self.element or self.path}"
        if self.line:
            where = f"{self.line}:{self.column}: {severity}{self.path}"
            if self.element and self.path != f"$.{self.element}":  # a setting: in the path
                where += f": {self.element}"
        allowed = f" Allowed: {self.allowed}." if self.allowed else ""
        hint = f" Did you mean {self.hint}?" if self.hint else ""
        stop = "." if (allowed or hint) and not self.text.endswith(".") else ""
        return f"{where}: {self.text}{stop}{hint}{allowed}"


class SceneError(SandboxError):
    """A scene that cannot be used, with all problems found.

    ``code`` is that of the first problem.
    """

    def __init__(self, problems: list[Problem], source: str = "") -> None:
        self.problems, self.source, self.code = problems, source, problems[0].code

    def __str__(self) -> str:
        return "\n".join(problem.at(self.source) for problem in self.problems)


class OutputError(SandboxError):
    """A file or directory that cannot be read or written, or a picture that cannot be drawn."""

    code = "cannot-write"


class RunEnded(SandboxError):
    """Base class of errors that end a run.

    ``time`` is that of the last step [s]; ``recording`` holds the samples until then, marked
    incomplete.
    """

    text: ClassVar[str]  # the message, with attributes in braces
    outcome: ClassVar[str] = "{}"  # why the run is not complete, with the message in the braces

    def __init__(self, time: float, culprit: str = "", reason: str = "") -> None:
        self.time, self.culprit, self.reason = time, culprit, reason
        self.recording: Recording | None = None

    def __str__(self) -> str:
        return self.text.format(**vars(self))


class SimulationDiverged(RunEnded):
    """Values of a simulation became infinite, undefined or very large."""

    code = "diverged"
    text = "the simulation diverged at t = {time:.6g} s: {culprit}: {reason}"


class Jammed(SimulationDiverged):
    """A scheduled body pushes against something that cannot move."""

    code = "jammed"
    text = "the mechanism jammed at t = {time:.6g} s: {reason}"


class RecordingFull(RunEnded):
    """A run exceeds the limit of recorded bytes, contacts included."""

    code = "limit-exceeded"
    text = ("stopped at t = {time:.6g} s: samples and contacts recorded until then take more than "
            "{reason} (the limit 'recorded_bytes', raised by --limit recorded_bytes=N, or "
            "simulate(recorded_bytes=...))")
    outcome = "more was recorded than the limit 'recorded_bytes' allows"

    def __init__(self, time: float, most: float) -> None:
        super().__init__(time, reason=f"{most:,.0f} bytes".replace(",", " "))


class ControllerFailed(RunEnded):
    """A Python controller raised an exception, its ``__cause__``, or returned invalid values."""

    code = "controller-failed"
    text = "controller {culprit!r}: act() at t = {time:.6g} s {reason}"
    outcome = "a controller failed: {}"


class Interrupted(RunEnded):
    """Ctrl-C during a simulation."""

    code = "interrupted"
    text = "interrupted at t = {time:.6g} s"
    outcome = "interrupted"
