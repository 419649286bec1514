"""The title above a picture: in smaller type or in several lines where it finds no room in one."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from sandbox.picture.painter import SheetPainter
from sandbox.picture.palette import INK
from sandbox.picture.typesetter import Typesetter, ellipsis

MOST = 3
"""Lines; what does not find room in them is left out."""
SHARE = 0.25
"""Of a picture's height that a title of several lines takes at most."""
HEAD, LINE = 2.2, 1.25
"""Height of a header of one line, in the ordinary type, and from line to line, in the title's."""


@dataclass(frozen=True)
class Headline:
    """A title, set."""

    lines: tuple[str, ...]
    size: int
    """Of its type."""
    high: int
    """The header [finished pixels]."""

    @classmethod
    def of(cls, title: str, type_: Typesetter, room: int, size: int, high: float = math.inf,
           ) -> Headline:
        """``title`` in ``room`` pixels of a picture so ``high``, in type of ``size`` if it fits."""
        free = (SHARE * high - HEAD * type_.size) / (LINE * type_.size)
        most = int(min(max(1.0, 1 + free), MOST))
        fits = next((s for s in range(size, type_.size - 1, -1) if type_.width(title, s) <= room),
                    None)
        lines = (title,) if fits else tuple(_wrapped(title, type_, room, most))
        size = fits or type_.size
        return cls(lines, size, round(HEAD * type_.size) + (len(lines) - 1) * round(LINE * size))

    def write(self, painter: SheetPainter, type_: Typesetter, left: int) -> None:
        """Write the lines, ``left`` pixels from the edge."""
        step = round(LINE * self.size)
        for k, line in enumerate(self.lines):
            height = type_.height(self.size)
            first = (self.high - (len(self.lines) - 1) * step - height) // 2 + 1
            painter.write((left, first + k * step), line, self.size, INK)


def _wrapped(title: str, type_: Typesetter, room: int, most: int) -> Iterator[str]:
    """Lines of whole words."""
    line, words = "", title.split()
    for count in range(1, most + 1):
        while words and (count == most
                         or type_.width(f"{line} {words[0]}".strip(), type_.size) <= room
                         or not line):
            line = f"{line} {words.pop(0)}".strip()
        if line:
            yield ellipsis(type_, line, room, type_.size)
        line = ""
