"""Slips in what a command makes a study of, told by the option as it was typed."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace

from sandbox.errors import Problem, SceneError


@contextmanager
def told_as_typed(
    vary: Mapping[str, str], keep: Sequence[str], option: str = "--vary",
) -> Iterator[None]:
    """Tell problems of the study that was made of a command's words at these words.

    Args:
        vary: what each path is given.
        keep: what is kept of each run.
        option: by which it is told what is varied.

    Raises:
        SceneError: of a file as it is; of the words with ``--vary pull=2:8:x`` as its path.
    """
    try:
        yield
    except SceneError as error:
        if error.source:
            raise
        raise SceneError([_typed(each, vary, keep, option) for each in error.problems]) from None


def _typed(
    problem: Problem, vary: Mapping[str, str], keep: Sequence[str], option: str,
) -> Problem:
    from sandbox.scene.read.paths import parse_path

    head, *steps = (*parse_path(problem.path), "", "") if problem.path.startswith("$") else ("",)
    word = ""
    if head == "vary":
        path = next((step for step in steps if step in vary), None)
        word = f"{path}={vary[str(path)]}" if path else ""
    elif head == "keep":
        option = "--keep"
        word = next((text for text in keep if steps[0] in (text, text.partition("=")[0].strip())),
                    "")
    elif head in ("set", "design", "count", "seed"):
        option = f"--{head}"
    else:
        return problem
    return replace(problem, path=f"{option} {shlex.quote(word)}" if word else option, fields="")
