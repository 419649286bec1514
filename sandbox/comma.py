"""Tables of studies as comma-separated text."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable


def comma_separated(
    names: Iterable[str], rows: Iterable[Iterable[object]], *, digits: int | None = None,
) -> str:
    """A head and its rows, a line each; cells with a comma are quoted, None is empty.

    Args:
        names: of the columns.
        rows: cells; floats are written so that they are read back as the same.
        digits: to which floats are rounded instead.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(names)
    writer.writerows([_cell(cell, digits) for cell in row] for row in rows)
    return text.getvalue()


def _cell(cell: object, digits: int | None) -> object:
    if not isinstance(cell, float):  # numpy's are, too
        return cell
    return repr(float(cell)) if digits is None else f"{cell:.{digits}g}"
