"""Lines of text for the terminal."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

from sandbox.errors import Problem
from sandbox.wording import printable

MAX_PAGES = 3  # codes, elements, and pages that one line names
REFERENCE = re.compile(r"docs/(?:elements|parts)\.md#(\w+)")  # what ``sandbox explain`` prints


def table(head: Sequence[str], rows: Sequence[Sequence[str]], *, right: str = "") -> list[str]:
    """Format rows as columns two spaces apart; ``right`` marks right-aligned columns by ``>``."""
    lines = [[printable(cell) for cell in line] for line in ([head] if head else []) + [*rows]]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    sides = right.ljust(len(widths), "<")
    return [
        "  ".join(f"{cell:{side}{width}}" for cell, side, width
                  in zip(line, sides, widths, strict=True)).rstrip()
        for line in lines
    ]


def shown(value: float, how: str) -> str:
    """A number as text, ``-`` if it is not finite."""
    return format(value, how) if math.isfinite(value) else "-"


def first_of(names: Sequence[str], most: int) -> str:
    """The first names of a list, and the number of others."""
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")


def pages_line(problems: Sequence[Problem]) -> list[str]:
    """The line that names the explanations of some problems, or none."""
    return see(*(each.code for each in problems), fields=[each.fields for each in problems])


def see(*codes: str, fields: Iterable[str] = ()) -> list[str]:
    """The line that names the explanations of some codes and fields, or none."""
    words, pages = [*dict.fromkeys(codes)][:MAX_PAGES], list[str]()
    for page in [*filter(None, dict.fromkeys(fields))][:MAX_PAGES]:
        match = REFERENCE.fullmatch(page)
        (words if match else pages).append(match[1] if match else page)
    return [", ".join([f"see 'sandbox explain {' '.join(words)}'", *pages])] if words else []
