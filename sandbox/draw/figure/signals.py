"""Recorded quantities against time, one panel for each unit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from sandbox.draw.figure import style
from sandbox.draw.figure.style import SideLabel
from sandbox.errors import OutputError
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.targets import track

LEAST, LABEL, SURROUND = 46.0, 4.2, 16.0
"""Height of a panel, of each of its labels, and of what is not panels [mm]."""
MOST = 40
"""Curves in a panel: more than these can be told apart by nobody, and a page ends."""
WORDS = {"rad": "angle", "rad/s": "angular speed", "rad/s^2": "angular acceleration",
         "m": "length", "m/s": "speed", "m/s^2": "acceleration", "N": "force", "N m": "torque",
         "N/m": "stiffness", "N m/rad": "stiffness", "J": "work", "1": "count"}
"""What a unit measures, for the label of its axis."""


def draw(run: Recording, quantities: Sequence[str], targets: Mapping[str, Array]) -> Any:
    """The figure.

    Args:
        run: the recording.
        quantities: names; those of one unit share a panel.
        targets: quantity to its target over time, shape [n], SI; drawn dashed.

    Raises:
        OutputError: too few samples, or too many curves for one panel.
        UnknownQuantityError: a name that the recording does not have.
    """
    if len(run) < 2:
        raise OutputError(f"the recording has {len(run)} samples, a plot needs at least 2")
    units: dict[str, list[str]] = {}
    for name in dict.fromkeys(quantities):
        units.setdefault(run.unit(name), []).append(name)
    for unit, names in units.items():
        if len(names) > MOST:
            raise OutputError(f"{len(names)} quantities in {unit or '1'} are too many for one "
                              f"panel: at most {MOST}")
    heights = [max(LEAST, LABEL * len(names) + LEAST / 4) for names in units.values()]
    figure = style.new_figure(sum(heights) + SURROUND)
    grid = list(figure.subplots(len(units), 1, sharex=True, squeeze=False, gridspec_kw={
        "height_ratios": heights}).ravel())
    for axes, height, (unit, names) in zip(grid, heights, units.items(), strict=True):
        _panel(axes, height, run, unit, names, targets)
    style.over_time(grid, len(grid), 1, run)
    style.title(figure, run.mechanism.title or run.mechanism.name)
    if any(name in targets for name in quantities):
        style.footnote(figure, "Dashed: targets.")
    return figure


def _panel(
    axes: Any, height: float, run: Recording, unit: str, names: Sequence[str],
    targets: Mapping[str, Array],
) -> None:
    tracks = {name: track(run, name, targets.get(name)) for name in names}
    rows = [row for _, value, target in tracks.values() for row in (value, target)
            if row is not None]
    shown = style.shown_as(unit, *rows)
    labels = []
    for i, (name, (time, value, target)) in enumerate(tracks.items()):
        hue = style.hue(i)
        axes.plot(time, shown.factor * value, color=hue, linewidth=style.LINE,
                  linestyle=style.DASHES[i // len(style.COLOURS) % len(style.DASHES)])
        if target is not None:
            axes.plot(time, shown.factor * target, color=hue, **style.TARGET)
        labels.append(SideLabel(shown.factor * _last(value), name, hue))
    style.roomy(axes, *(shown.factor * row for row in rows))
    word = WORDS.get(unit, "")
    axis = f"{word} [{shown.unit}]" if shown.unit else word
    style.dress(axes, "", axis.strip())
    style.powers(axes)
    style.label_side(axes, labels, height=height - 8)


def _last(row: Array) -> float:
    """The last value that is one; 0 if none is, so that the curve still has its name."""
    finite = row[~(row != row)]
    return float(finite[-1]) if len(finite) else 0.0
