"""Exit codes, and how exceptions become messages; never a traceback."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import IntEnum
from typing import Any

import click

from sandbox.cli.console import Console, StdoutError
from sandbox.errors import Interrupted, Problem, SandboxError, SceneError, SimulationDiverged
from sandbox.wording import WrongValueError

MOST_PAGES = 3
"""Pages about codes, and pages about fields, that one line names."""


class Exit(IntEnum):
    """Exit codes of every ``sandbox`` command."""

    DONE = 0
    """Done, and every expectation passed."""
    FAILED = 1
    """An expectation failed."""
    INPUT = 2
    """The input is wrong: a scene, an option, a file, a directory."""
    DIVERGED = 3
    """The simulation diverged."""
    BUG = 70
    """Internal error (EX_SOFTWARE of sysexits.h)."""
    INTERRUPTED = 130
    """Ctrl-C (128 + SIGINT)."""


def guard(work: Callable[[], int], console: Console) -> int:
    """Run a command; its exit code, or that of the error it raised.

    An unwritable stdout is reported on stderr, with ``--json`` too.
    """
    try:
        return _guarded(work, console)
    except StdoutError as error:
        return report(error, Console())


def _guarded(work: Callable[[], int], console: Console) -> int:
    """Report every exception but :class:`StdoutError`; unexpected ones are internal errors."""
    try:
        return work()
    except StdoutError:
        raise
    except SandboxError as error:
        return report(error, console)
    except click.ClickException as error:
        return report_usage(error, console)
    except (KeyboardInterrupt, click.Abort):
        return report_problems(console, Exit.INTERRUPTED, [
            Problem("interrupted", "interrupted", path="")])
    except MemoryError:
        return report_problems(
            console, Exit.INPUT, [Problem(
                "out-of-memory", "not enough memory for this", path="")])
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        return report_problems(console, Exit.INPUT, [Problem(
            "cannot-write", f"{where}{error.strerror or error}", path="")])
    except RecursionError:
        return report_problems(console, Exit.INPUT, [Problem(
            "limit-exceeded", "nested too deeply", path="")])
    except Exception as error:
        first = (str(error).splitlines() or [""])[0][:200]
        return report_problems(console, Exit.BUG, [Problem(
            "internal-error",
            f"internal error ({type(error).__name__}: {first}); please report it with the scene "
            "(SANDBOX_DEBUG=1 shows the traceback)", path="")])


def report(error: SandboxError, console: Console, **more: Any) -> int:
    """Report an error that sandbox raised on purpose; its exit code."""
    if isinstance(error, SceneError):
        return report_problems(console, Exit.INPUT, error.problems, source=error.source, **more)
    code = Exit.INPUT
    if isinstance(error, SimulationDiverged):
        code = Exit.DIVERGED
    elif isinstance(error, Interrupted):
        code = Exit.INTERRUPTED
    problems = [Problem(error.code, line, path="") for line in str(error).splitlines() or [""]]
    return report_problems(console, code, problems, **more)


def report_usage(error: click.ClickException, console: Console) -> int:
    """Report a wrong option or argument; its exit code."""
    if isinstance(error, click.UsageError) and error.ctx is not None and not console.as_json:
        console.error(*error.ctx.get_usage().splitlines(),
                      f"Try '{error.ctx.command_path} --help' for help.", "")
    cause = error.__cause__ or error.__context__
    code = cause.code if isinstance(cause, SandboxError | WrongValueError) else "bad-option"
    return report_problems(console, Exit.INPUT, [Problem(code, error.format_message(), path="")])


def report_problems(
    console: Console, code: Exit, problems: list[Problem], *, source: str = "", **more: Any,
) -> int:
    """Print problems, one a line, or all in one JSON object; returns ``code``."""
    if console.as_json:
        console.result_json({
            "status": code.name.lower(), "exit_code": int(code),
            "errors": [problem_data(problem, source) for problem in problems], **more,
        })
    else:
        console.error(*(one_line(problem, source) for problem in problems))
        if code != Exit.INTERRUPTED:
            console.warn(*pages_line(problems))
    return code


def pages_line(problems: list[Problem]) -> list[str]:
    """The line that names the pages of the docs about some problems, or none."""
    return see((each.code for each in problems), [each.fields for each in problems])


def see(codes: Iterable[str], fields: Iterable[str] = ()) -> list[str]:
    """The line that names the pages of the docs about some codes and fields, or none."""
    pages = [f"docs/messages.md#{code}" for code in dict.fromkeys(codes)][:MOST_PAGES]
    pages += list(filter(None, dict.fromkeys(fields)))[:MOST_PAGES]
    return [f"see {', '.join(pages)}"] if pages else []


def one_line(problem: Problem, source: str = "") -> str:
    """``file:line:col: path: message``, or ``error: message`` without a place."""
    source = problem.file or source
    if not source and not problem.path:
        return f"error{problem}"  # the place is empty
    return f"{source}:{problem}" if source else str(problem)


def problem_data(problem: Problem, source: str = "") -> dict[str, Any]:
    """A problem as JSON data, without empty values."""
    data = {"code": problem.code, "message": problem.text, "file": problem.file or source,
            "path": problem.path,
            "line": problem.line, "column": problem.column, "element": problem.element,
            "allowed": problem.allowed, "hint": problem.hint,
            "fields": problem.fields}
    return {key: value for key, value in data.items() if value or key == "message"}
