"""The figure of a robustness map, from what was found."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from sandbox.draw.figure.regions import RegionAxis, RegionPanel, draw_regions
from sandbox.search.regions_found import RobustnessFound
from sandbox.sweeps.points import number_of

MOST = 30
"""Letters of a closed form that have room in a legend."""


def draw_robustness(found: RobustnessFound, path: Path) -> None:
    """Draw the maps of a search, a panel each.

    Raises:
        OutputError: the file cannot be written.
    """
    draw_regions(path, region_panels(found),
                 title=f"{found.title}: {found.condition} in {100 * found.share:.3g} % of the map",
                 closed=closed_words(found))


def closed_words(found: RobustnessFound) -> str:
    """What the line of a closed form is called; itself where it is short."""
    text = f"{found.closed_form} = 0"
    return "" if not found.closed_form else text if len(text) <= MOST else "closed form"


def region_panels(
    found: RobustnessFound, labels: Mapping[str, str] | None = None, head: str = "",
) -> list[RegionPanel]:
    """Its maps as panels of a figure.

    Args:
        found: the maps.
        labels: what paths are called, in place of their last word.
        head: above the only map; above each of several it is followed by its value.
    """
    labels = labels or {}
    axes = [RegionAxis(labels.get(path, path.rpartition(".")[2]), unit)
            for path, unit in zip(found.paths, found.units, strict=True)]
    columns = found.table.varied
    runs = np.array([columns[path] for path in found.paths], dtype=float).T
    panels = []
    for sheet in found.sheets:
        here = np.ones(len(runs), dtype=bool)
        title = head
        if found.listed:
            value = number_of(sheet.at)
            here = np.array([each == value for each in columns[found.listed]], dtype=bool)
            name = labels.get(found.listed, found.listed.rpartition(".")[2])
            title = f"{head}{name} {sheet.at}"
        panels.append(RegionPanel(
            title, tuple(axes), sheet.ways, sheet.states, sheet.boundary, runs[here],
            ~found.table.done[here], found.table.doubtful[here], sheet.form))
    return panels
