"""Events of runs on figures: grey lines, and their names in rows so that none covers another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count
from typing import Any

from sandbox.draw.figure import style
from sandbox.recording.recording import Recording

MOST, LONGEST = 8, 20
"""Events that are marked at most; characters of a name, and no more than reach half-way."""
LETTER = 0.6 * style.TINY * style.MM_PER_POINT
LINE = 1.3 * style.TINY * style.MM_PER_POINT
"""Width of a name's character, height of a row of names [mm]."""


@dataclass(frozen=True)
class EventMark:
    """An event of the run, and where its name stands in the first panel."""

    name: str
    time: float
    """[s]"""
    right: bool
    """Whether the name stands to the right of the line."""
    row: int
    """Of the name, from the top."""


def marks_of(run: Recording, *, width: float, begin: float = 0.0,
             end: float | None = None) -> list[EventMark]:
    """The events and breaks of a run between two times; [] if too many.

    Args:
        run: the recording.
        width: of the axes [mm].
        begin: what of the run is shown begins here [s].
        end: and ends here [s]; with the run by default.
    """
    end = run.time[-1] if end is None else end
    happened = [event for event in run.info.marked if begin <= event.time <= end]
    if len(happened) > MOST:
        return []
    longest = min(LONGEST, int(width / 2 / LETTER) - 1)
    found: list[EventMark] = []
    taken: list[tuple[int, float, float]] = []
    for event in happened:
        name, time = event.event, event.time
        name = name if len(name) <= longest else f"{name[:longest - 1]}…"
        at, wide = (time - begin) / (end - begin), LETTER / width * (len(name) + 1)
        right = at + wide <= 1
        low, high = (at, at + wide) if right else (at - wide, at)
        row = next(row for row in count() if not any(
            row == other and low < stop and start < high for other, start, stop in taken))
        taken.append((row, low, high))
        found.append(EventMark(name, time, right, row))
    return found


def draw_marks(grid: Sequence[Any], marks: Sequence[EventMark]) -> None:
    """A grey line for each event in every panel."""
    for axes in grid:
        for mark in marks:
            axes.axvline(mark.time, color=style.GREY, linewidth=0.8, zorder=1.5)


def draw_names(axes: Any, marks: Sequence[EventMark], *, height: float) -> None:
    """Names of events at their lines, in room made for them at the top of axes of a height [mm]."""
    if not marks:
        return
    low, high = axes.get_ylim()
    room = LINE / height * (1 + max(mark.row for mark in marks))
    axes.set_ylim(low, low + (high - low) / (1 - room))
    for mark in marks:
        axes.annotate(style.plain(mark.name), (mark.time, 1 - LINE / height * mark.row),
                      xycoords=("data", "axes fraction"), textcoords="offset points",
                      xytext=(2 if mark.right else -2, 0), va="top",
                      ha="left" if mark.right else "right", fontsize=style.TINY, color=style.QUIET,
                      bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5})
