"""A figure that a notebook shows; matplotlib's own it shows only once pyplot is loaded."""

from __future__ import annotations

import io

from matplotlib.figure import Figure


class ShownFigure(Figure):
    """A figure of matplotlib with a picture of itself for notebooks."""

    def _repr_png_(self) -> bytes:
        """Half as fine as in a file: a notebook's column is some 900 pixels wide."""
        file = io.BytesIO()
        self.savefig(file, format="png", dpi=self.dpi / 2, metadata={"Software": None})
        return file.getvalue()
