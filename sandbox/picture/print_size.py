"""Sizes on paper: a still as wide as a column, with letters that are read there."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

from sandbox.errors import OutputError
from sandbox.picture.typesetter import EM
from sandbox.wording import quoted

PRINT_PER_INCH = 300
"""Pixels; what is printed needs no more."""
LETTERS = 7.0
"""No letter is smaller [pt]."""
UNITS = {"mm": 1.0, "cm": 10.0, "in": 25.4}
"""Millimetres in each."""
LEAST, MOST = 25.0, 650.0
"""Of a width or a height [mm]."""
FINE = 0.75
"""Of lines and marks, in what would go with such letters: they are printed as fine as that."""
_NUMBER, _UNIT = r"\s*([0-9]+\.?[0-9]*|\.[0-9]+)\s*", f"({'|'.join(UNITS)})"
_FORM = re.compile(f"{_NUMBER}(?:{_UNIT}?\\s*[x×]{_NUMBER})?{_UNIT}\\s*", re.IGNORECASE)


@dataclass(frozen=True)
class PrintSize:
    """How large a still is printed."""

    width: float
    """[mm]"""
    height: float | None = None
    """[mm]; None for as high as what is shown."""

    @property
    def pixels(self) -> int:
        """Across."""
        return round(self.width / UNITS["in"] * PRINT_PER_INCH)

    @property
    def pixels_down(self) -> int | None:
        """If it is said how high it is."""
        return None if self.height is None else round(self.height / UNITS["in"] * PRINT_PER_INCH)

    @property
    def least(self) -> int:
        """The smallest type, as a typesetter counts it."""
        return math.ceil(LETTERS / 72 * PRINT_PER_INCH / EM)

    def unit(self, type_: int) -> float:
        """Pixels per point of lines and marks, where such a size of type goes with one."""
        return FINE * self.least / type_

    def per_inch(self, across: int) -> float:
        """Pixels per inch of a picture that is so many pixels wide."""
        return across * UNITS["in"] / self.width


def paper_of(size: Any) -> PrintSize | None:
    """``85mm``, ``85mm x 70mm`` or ``3.35in`` as a size on paper; None for what is none.

    Raises:
        OutputError: too small, or too large.
    """
    found = _FORM.fullmatch(size) if isinstance(size, str) else None
    if found is None:
        return None
    first, own, second, unit = found.groups()
    scale = UNITS[unit.lower()]
    width = float(first) * (UNITS[own.lower()] if own else scale)
    paper = PrintSize(width, None if second is None else float(second) * scale)
    if any(not LEAST <= side <= MOST for side in (paper.width, paper.height or LEAST)):
        raise OutputError(f"{quoted(size)}: a picture on paper is {LEAST:g} to {MOST:g} mm "
                          "wide and high", code="bad-picture")
    return paper
