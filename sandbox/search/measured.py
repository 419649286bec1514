"""What was measured: a CSV file with a column of times and columns of what was seen then.

Numbers are SI, or in the unit that stands in brackets behind a column's name: ``x [mm]``.
"""

from __future__ import annotations

import csv
import io
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sandbox.errors import SandboxError
from sandbox.numeric import Array
from sandbox.scene.values.units import factor_of
from sandbox.wording import WrongValueError, listed, or_near, quoted

TIMES = ("time", "t", "time_s", "t_s")
"""Names that a column of times may have."""
_WITH_UNIT = re.compile(r"\s*(.*?)\s*\[([^\[\]]+)\]\s*")
LARGEST = 20_000_000
"""Bytes of a file."""


@dataclass(frozen=True)
class Measurements:
    """Columns of a file, [n] each; nan where a cell is empty."""

    file: str
    time: Array
    """[s]."""
    columns: dict[str, Array]
    """SI, by name."""

    def column(self, name: str) -> Array:
        """A column by its name.

        Raises:
            SandboxError: there is none, with a near miss.
        """
        if name not in self.columns:
            raise SandboxError(f"{self.file} has no column {quoted(name)}"
                               f"{or_near(name, self.columns)} (it has "
                               f"{listed(list(self.columns))})", code="bad-measurements")
        return self.columns[name]


def read_measured(path: Path) -> Measurements:
    """Read a file.

    Raises:
        SandboxError: it cannot be read, has no times, or a cell is no number, with its line.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise SandboxError(f"{path} has more than {LARGEST} bytes", code="bad-measurements")
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", "") or "it is not UTF-8 text"
        raise SandboxError(f"{path} cannot be read: {why}", code="bad-measurements") from None
    rows = [row for row in csv.reader(io.StringIO(text)) if any(cell.strip() for cell in row)]
    if len(rows) < 2:
        raise SandboxError(f"{path} holds no measurements: a line of names, then numbers",
                           code="bad-measurements")
    heads = [_head(name, path) for name in rows[0]]
    names = [name for name, _ in heads]
    time = next((name for name in names if name.lower() in TIMES), None)
    if time is None:
        raise SandboxError(f"{path} has no column of times (allowed: {', '.join(TIMES)}; it has "
                           f"{listed(names)})", code="bad-measurements")
    if len(set(names)) < len(names):
        raise SandboxError(f"{path} has two columns of one name", code="bad-measurements")
    cells = np.array([_numbers(row, len(names), f"{path}, row {number}")
                      for number, row in enumerate(rows[1:], start=2)])
    columns = {name: cells[:, k] * factor for k, (name, factor) in enumerate(heads)}
    times = columns.pop(time)
    if np.isnan(times).any():
        raise SandboxError(f"{path}: a row has no time", code="bad-measurements")
    return Measurements(str(path), times, columns)


def _head(text: str, path: Path) -> tuple[str, float]:
    """A column's name, and what makes SI of its numbers: ``x [mm]`` is in millimetres."""
    match = _WITH_UNIT.fullmatch(text)
    if match is None:
        return text.strip(), 1.0
    try:
        return match[1], factor_of(match[2].strip(), None)
    except WrongValueError as error:
        raise SandboxError(f"{path}, row 1: {error}", code="bad-measurements") from None


def _numbers(row: list[str], count: int, where: str) -> list[float]:
    if len(row) != count:
        raise SandboxError(f"{where}: {len(row)} cells under {count} names",
                           code="bad-measurements")
    found = []
    for cell in row:
        try:
            found.append(float(cell) if cell.strip() else math.nan)
        except ValueError:
            raise SandboxError(f"{where}: {quoted(cell)} is no number",
                               code="bad-measurements") from None
        if math.isinf(found[-1]):
            raise SandboxError(f"{where}: {quoted(cell)} is not finite", code="bad-measurements")
    return found
