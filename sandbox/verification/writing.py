"""What the pages of a report share: how it is carried out, cells, anchors, versions, checks."""

from __future__ import annotations

import math
import platform
from collections.abc import Callable, Sequence
from importlib.metadata import version
from typing import Any, TypeVar

import numpy as np

from sandbox import __version__
from sandbox.verification.cases.case import Check

What = TypeVar("What")
Result = TypeVar("Result")


def each(
    things: Sequence[What], work: Callable[[What], Result],
    progress: Callable[[float], None] | None,
) -> list[Result]:
    """Carry them out in order; ``progress`` is told the share that is done, 0 to 1."""
    results = []
    for i, one in enumerate(things):
        results.append(work(one))
        if progress is not None:
            progress((i + 1) / len(things))
    return results


def cell(text: str) -> str:
    """Text in a cell of a table."""
    return text.replace("|", "\\|")


def anchor(title: str) -> str:
    """What a link to a heading is."""
    return "".join(c for c in title.lower() if c.isalnum() or c in " -_").replace(" ", "-")


def versions() -> dict[str, str]:
    """Of the programs that the numbers come from."""
    return {"sandbox": __version__, "pymunk": version("pymunk"), "numpy": np.__version__,
            "python": platform.python_version()}


def check_data(check: Check) -> dict[str, Any]:
    """A check as JSON data; what is no number is null."""
    plain = {"what": check.what, "unit": check.unit, "expected": check.expected,
             "found": check.found, "off": check.off, "allowed": check.allowed, "ok": check.ok,
             "why": check.why}
    return {key: as_number(value) if isinstance(value, float) else value
            for key, value in plain.items()}


def as_number(value: float) -> float | None:
    """For JSON; None for what is no number."""
    return float(value) if math.isfinite(value) else None
