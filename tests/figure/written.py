"""What is written in a figure, and whether it can be read."""

from __future__ import annotations

from itertools import combinations
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text


def texts(figure: Any) -> list[str]:
    """Everything that is written, ticks left out."""
    return [artist.get_text() for artist in written(figure)]


def written(figure: Any) -> list[Text]:
    """The texts themselves."""
    FigureCanvasAgg(figure).draw()
    ticks = {id(label) for axes in figure.axes
             for axis in (axes.xaxis, axes.yaxis)
             for label in axis.get_ticklabels(which="both")}
    return [artist for artist in figure.findobj(Text) if artist.get_text().strip()
            and artist.get_visible() and id(artist) not in ticks
            and (artist.axes is None or artist.axes.get_visible())]


def clashes(figure: Any) -> list[str]:
    """Texts that overlap, or that leave the page."""
    boxes = [(artist.get_text(), artist.get_window_extent()) for artist in written(figure)]
    found = [f"{a!r} on {b!r}" for (a, one), (b, other) in combinations(boxes, 2)
             if one.overlaps(other)]
    width, height = figure.canvas.get_width_height()
    return found + [name for name, box in boxes if box.x0 < 0 or box.y0 < 0
                    or box.x1 > width or box.y1 > height]
