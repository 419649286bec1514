"""A figure that a notebook shows; matplotlib's own it shows only once pyplot is loaded."""

from __future__ import annotations

import io

from matplotlib.figure import Figure

DPI = 110
"""In a notebook, whose columns are some 900 pixels wide."""


class ShownFigure(Figure):
    """A figure of matplotlib with a picture of itself for notebooks."""

    def _repr_png_(self) -> bytes:
        file = io.BytesIO()
        self.savefig(file, format="png", dpi=DPI, metadata={"Software": None})
        return file.getvalue()
