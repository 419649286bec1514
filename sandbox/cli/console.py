"""Output of the commands: results to stdout, notices and errors to stderr; exit codes.

Lines are printed with control characters escaped, so that no untrusted scene can move the cursor or
forge a line. Exceptions become messages, never a traceback.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import re
import sys
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import click

from sandbox.errors import OutputError, Problem, RunEnded, SandboxError, SceneError
from sandbox.wording import WrongValueError, printable

if TYPE_CHECKING:
    from click._termui_impl import ProgressBar

MAX_PAGES = 3  # codes, elements, and pages that one line names
REFERENCE = re.compile(r"docs/(?:elements|parts)\.md#(\w+)")  # what ``sandbox explain`` prints
BAR_AFTER = 1.0  # seconds before a progress bar appears
LINE_EVERY = 30.0  # longest time between two lines of progress [s]
COMPILE_TIME = "10 to 30 s"  # time that compiling takes; the docs quote it
COMPILING = f"Compiling the solver (first run of such a scene, {COMPILE_TIME}) …"
NOT_CACHED = (f"Compiling the solver ({COMPILE_TIME}) in every run, since neither the installation "
              "nor the user's cache is writable. Set NUMBA_CACHE_DIR to a writable folder.")


def table(head: Sequence[str], rows: Sequence[Sequence[str]], *, right: str = "") -> list[str]:
    """Format rows as columns two spaces apart; ``right`` marks right-aligned columns by ``>``.

    Without rows there is no table. An empty head is left out.
    """
    lines = [[printable(cell) for cell in line] for line in ([head] if head else []) + [*rows]]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    sides = right.ljust(len(widths), "<")
    return ["  ".join(f"{cell:{side}{width}}" for cell, side, width
                      in zip(line, sides, widths, strict=True)).rstrip()
            for line in lines if rows]


def shown(value: float, how: str) -> str:
    """A number as text, ``-`` if it is not finite."""
    return format(value, how) if math.isfinite(value) else "-"


def first_of(names: Sequence[str], most: int, *, between: str = ", ") -> str:
    """The first names of a list, and the number of others."""
    more = len(names) - most
    return between.join(names[:most]) + (f" and {more} more" if more > 0 else "")


def see(*about: Problem | str) -> list[str]:
    """The line that names the explanations of some problems or codes, or none."""
    problems = [Problem(each, "") if isinstance(each, str) else each for each in about]
    words, pages = list(dict.fromkeys(each.code for each in problems))[:MAX_PAGES], list[str]()
    fields = dict.fromkeys(each.fields for each in problems)
    for page in [*filter(None, fields)][:MAX_PAGES]:
        match = REFERENCE.fullmatch(page)
        (words if match else pages).append(match[1] if match else page)
    return [", ".join([f"see 'sandbox explain {' '.join(words)}'", *pages])] if words else []


class Exit(IntEnum):
    """Exit codes of every ``sandbox`` command."""

    DONE = 0  # and every expectation passed
    FAILED = 1  # an expectation failed
    INPUT = 2  # the input is wrong: a scene, an option, a file, a directory
    DIVERGED = 3  # the simulation diverged
    BUG = 70  # internal error (EX_SOFTWARE of sysexits.h)
    INTERRUPTED = 130  # Ctrl-C (128 + SIGINT)


class StdoutError(OutputError):
    """Stdout cannot be written to. The error is reported on stderr, with ``--json`` too."""


@dataclass(frozen=True)
class Console:
    """Output of one command."""

    as_json: bool = False  # reserves stdout for one JSON object
    quiet: bool = False  # suppresses all but errors and documents

    def say(self, *lines: object) -> None:
        """Print lines to stdout; to stderr with ``--json``, nothing with ``--quiet``."""
        if self.as_json:
            self.warn(*map(str, lines))
        elif lines and not self.quiet:
            _write("\n".join(printable(str(line)) for line in lines))

    def warn(self, *lines: str) -> None:
        """Print lines to stderr, unless quiet."""
        if lines and not self.quiet:
            self.error(*lines)

    def error(self, *lines: str) -> None:
        """Print errors to stderr."""
        _write("\n".join(map(printable, lines)), to_stderr=True)

    def document(self, text: str) -> None:
        """Print a whole file to stdout; characters that cannot be printed are escaped."""
        unicode = (getattr(sys.stdout, "encoding", None) or "utf-8").lower().startswith("utf")
        _write("".join(
            char if char in "\n\t" or (char.isprintable() and (unicode or char.isascii()))
            else json.dumps(char)[1:-1] for char in text))

    def finish(
        self, data: Mapping[str, Any], lines: Iterable[object] = (), code: Exit = Exit.DONE,
    ) -> Exit:
        """Print the result of a command, ``lines`` or with ``--json`` one object; its exit code."""
        if self.as_json:
            from sandbox.atomic_files import json_text
            whole = {"status": code.name.lower(), "exit_code": int(code), **data}
            self.document(json_text(whole, indent=2))
        else:
            self.say(*lines)
        return code


def _write(text: str, *, to_stderr: bool = False) -> None:
    """Print text. A closed pipe (``| head``) or an unwritable stderr is ignored."""
    stream = sys.stderr if to_stderr else sys.stdout
    encoding = getattr(stream, "encoding", None) or "utf-8"
    try:
        click.echo(text.encode(encoding, "backslashreplace").decode(encoding), err=to_stderr)
    except OSError as error:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())  # or the buffer fails once more at exit
        os.close(nowhere)
        if not to_stderr and not isinstance(error, BrokenPipeError):
            raise StdoutError(f"cannot write to stdout: {error.strerror or error}") from None


def report(error: BaseException, console: Console, **more: Any) -> Exit:
    """Print the problems of an error, one a line, or all in one JSON object; its exit code."""
    code, problems = _problems(error)
    source = error.source if isinstance(error, SceneError) else ""
    if console.as_json and not isinstance(error, StdoutError):
        errors = [problem_data(problem, source) for problem in problems]
        return console.finish({"errors": errors, **more}, code=code)
    if isinstance(error, click.UsageError) and error.ctx is not None:
        console.error(*error.ctx.get_usage().splitlines(),
                      f"Try '{error.ctx.command_path} --help' for help.", "")
    console.error(*(problem.at(source) for problem in problems))
    if {each.code for each in problems}.isdisjoint({"interrupted", "bad-option"}):
        console.warn(*see(*problems))
    return code


def _problems(error: BaseException) -> tuple[Exit, list[Problem]]:
    code = Exit.INPUT
    match error:
        case SceneError():
            return code, error.problems
        case SandboxError():
            if isinstance(error, RunEnded):
                code = {"diverged": Exit.DIVERGED, "jammed": Exit.DIVERGED,
                        "interrupted": Exit.INTERRUPTED}.get(error.code, code)
            return code, [Problem(error.code, line, "") for line in str(error).splitlines() or [""]]
        case KeyboardInterrupt() | click.Abort():
            code, name, text = Exit.INTERRUPTED, "interrupted", "interrupted"
        case click.ClickException():
            cause, text = error.__cause__ or error.__context__, error.format_message()
            name = cause.code if isinstance(cause, SandboxError | WrongValueError) else "bad-option"
        case MemoryError():
            name, text = "out-of-memory", "not enough memory for this"
        case OSError():
            where = f"{error.filename}: " if error.filename else ""
            name, text = "cannot-write", f"{where}{error.strerror or error}"
        case RecursionError():
            name, text = "limit-exceeded", "nested too deeply"
        case _:
            code, first = Exit.BUG, (str(error).splitlines() or [""])[0][:200]
            name = "internal-error"
            text = (f"internal error ({type(error).__name__}: {first}); please report it with the "
                    "scene (SANDBOX_DEBUG=1 shows the traceback)")
    return code, [Problem(name, text, "")]


def problem_data(problem: Problem, source: str = "") -> dict[str, Any]:
    """A problem as JSON data, without empty values."""
    placed = replace(problem, file=problem.file or source)
    names = ("code", "file", "path", "line", "column", "element", "allowed", "hint", "fields")
    return {"message": problem.text,
            **{name: value for name in names if (value := getattr(placed, name))}}


class Progress:
    """Progress of a command on stderr, without ``--quiet``.

    Call it with the fraction done, 0 to 1, for a bar that appears after a second on a terminal; use
    it as a context then. :meth:`note` prints lines of progress, for work of unknown length.
    """

    def __init__(self, label: str, console: Console) -> None:
        self._label, self._console = label, console
        self._terminal = sys.stderr.isatty() and not console.quiet
        self._start = time.monotonic()
        self._bar: ProgressBar[int] | None = None
        self._interval = BAR_AFTER if self._terminal else LINE_EVERY
        self._next = self._start + self._interval

    def __call__(self, fraction: float) -> None:
        """Draw the bar at a fraction, with the remaining time."""
        if self._terminal and time.monotonic() >= self._start + BAR_AFTER:
            if self._bar is None:
                self._bar = click.progressbar(length=1000, label=self._label, file=sys.stderr)
                self._bar.render_progress()
            self._bar.update(round(1000 * min(max(fraction, 0.0), 1.0)) - self._bar.pos)

    def note(self, line: str) -> None:
        """Print a line if one is due: on a terminal after 1, 3, 7, … s, elsewhere every 30 s."""
        if time.monotonic() >= self._next:
            self._interval = min(2 * self._interval, LINE_EVERY)
            self._next = time.monotonic() + self._interval
            self._console.warn(line)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        if self._bar is not None:
            self._bar.render_finish()
            self._bar = None


@contextlib.contextmanager
def monitored(console: Console, label: str = "", kept: Path | None = None) -> Iterator[Progress]:
    """Print progress, notices about compilation, and after Ctrl-C where finished runs are kept."""
    from sandbox.engine.compiling import on_compiling

    def began() -> None:
        from sandbox.engine.advance import advance
        console.warn(COMPILING if advance.cached else NOT_CACHED)

    def ended(seconds: float) -> None:
        bar.__exit__()
        console.warn(f"Compiled in {seconds:{'.0f' if seconds >= 1 else '.1g'}} s")

    try:
        with Progress("Compiling", console) as bar, on_compiling(began, ended, bar), \
                on_compiling(lambda: console.warn(COMPILING), ended, in_workers=True), \
                Progress(label, console) as progress:
            yield progress
    except KeyboardInterrupt:
        if kept:
            console.warn(f"stopped; finished runs are kept in {kept}, and the same command resumes")
        raise
