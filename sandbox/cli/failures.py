"""From an exception to an exit code and what the user is told; never a traceback."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import click

from sandbox.cli.console import Console, StdoutError
from sandbox.cli.exits import Exit
from sandbox.errors import Interrupted, Problem, SandboxError, SceneError, SimulationDiverged
from sandbox.wording import WrongValueError

MOST_PAGES = 3
"""Pages about codes, and pages about fields, that one line names."""


def guard(work: Callable[[], int], console: Console) -> int:
    """Do the work of a command; its exit code, or that of what went wrong.

    A stdout that cannot be written to is told on stderr, ``--json`` or not.
    """
    try:
        return _guarded(work, console)
    except StdoutError as error:
        return report(error, Console())


def _guarded(work: Callable[[], int], console: Console) -> int:
    """What :func:`guard` does, but for what happens to stdout.

    The last branch is the one place that catches everything: a fault of
    sandbox is told in one line, with the exception's type, and exits 70.
    """
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
        return report_problems(console, Exit.INPUT, [Problem(
            "cannot-write", os_message(error), path="")])
    except RecursionError:
        return report_problems(console, Exit.INPUT, [Problem(
            "limit-exceeded", "nested too deeply", path="")])
    except Exception as error:
        return report_problems(console, Exit.BUG, [Problem(
            "internal-error",
            f"a fault of sandbox itself ({type(error).__name__}: {first_line(error)}); "
            "please report it with the scene (SANDBOX_DEBUG=1 shows where)", path="")])


def report(error: SandboxError, console: Console, **more: Any) -> int:
    """Tell an error that sandbox raised on purpose; its exit code."""
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
    """Tell an option or argument that click refused; its exit code."""
    if isinstance(error, click.UsageError) and error.ctx is not None and not console.as_json:
        console.error(*error.ctx.get_usage().splitlines(),
                      f"Try '{error.ctx.command_path} --help' for help.", "")
    cause = error.__cause__ or error.__context__
    code = cause.code if isinstance(cause, SandboxError | WrongValueError) else "bad-option"
    return report_problems(console, Exit.INPUT, [Problem(code, error.format_message(), path="")])


def report_problems(
    console: Console, code: Exit, problems: list[Problem], *, source: str = "", **more: Any,
) -> int:
    """Print problems, one a line, or one JSON object with them all; returns ``code``."""
    if console.as_json:
        console.result_json({
            "status": code.name.lower(), "exit_code": int(code),
            "errors": [problem_data(problem, source) for problem in problems], **more,
        })
    else:
        console.error(*(one_line(problem, source) for problem in problems))
        if code != Exit.INTERRUPTED:  # who pressed Ctrl-C knows what it means
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
    """``file:line:col: path: message``, or ``error: message`` where there is no place."""
    source = problem.file or source
    if not source and not problem.path:
        return f"error: {problem.message}"
    return f"{source}:{problem}" if source else str(problem)


def problem_data(problem: Problem, source: str = "") -> dict[str, Any]:
    """A problem as JSON data; what is empty is left out."""
    data = {"code": problem.code, "message": problem.text, "file": problem.file or source,
            "path": problem.path,
            "line": problem.line, "column": problem.column, "element": problem.element,
            "allowed": problem.allowed, "hint": problem.hint,
            "fields": problem.fields}
    return {key: value for key, value in data.items() if value or key == "message"}


def os_message(error: OSError) -> str:
    """What the system said, with the file's name: ``renders/x/run.npz: No space left …``."""
    where = f"{error.filename}: " if error.filename else ""
    return f"{where}{error.strerror or error}"


def first_line(error: BaseException) -> str:
    """The first line of an exception's message, at most 200 characters."""
    return (str(error).splitlines() or [""])[0][:200]

