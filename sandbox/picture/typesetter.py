"""Texts as small pictures, and titles."""

from __future__ import annotations

import textwrap
from bisect import bisect_right
from functools import lru_cache
from typing import NamedTuple

import pygame

from sandbox.picture.palette import BACKGROUND, INK, Colour, Painter
from sandbox.wording import printable

FINER = 4  # letters are drawn this many times larger, then scaled down
MAX_LETTERS = 1000  # of a text; no picture is as wide
MAX_LINES, SHARE = 3, 0.25  # of a title: lines; for several, the share of a picture's height
HEAD, LINE = 2.2, 1.25  # height of a header, and from line to line of a title [sizes of type]


class Typesetter:
    """Texts as small pictures, in a type of ``size``, and at ``least`` so large [pixels]."""

    def __init__(self, size: int, least: int = 0) -> None:
        pygame.font.init()
        self.size, self.least = max(size, least), least
        self._fonts: dict[int, pygame.Font] = {}

    def scaled(self, factor: float, lines: float = 1.0) -> int:
        """A size of type in that of the ordinary one, or the height of so many lines of it."""
        return max(round(lines * self.least), round(factor * lines * self.size))

    def font(self, size: int) -> pygame.Font:
        """The font that travels with pygame, the same on every machine, :data:`FINER` as large."""
        if size not in self._fonts:
            self._fonts[size] = pygame.font.Font(None, FINER * size)
        return self._fonts[size]

    def width(self, text: str, size: int | None = None) -> int:
        """How long the text is in pixels."""
        return round(self.font(size or self.size).size(letters(text))[0] / FINER)

    def height(self, size: int) -> int:
        """The height of a line in pixels."""
        return round(self.font(size).get_height() / FINER)

    def half(self, text: str, size: int) -> tuple[float, float]:
        """Half the width and height of the text with a rim [pixels]."""
        rim = rim_of(size)
        return self.width(text, size) / 2 + rim, self.height(size) / 2 + rim

    def baseline(self, size: int) -> float:
        """The baseline below the top of a line [pixels]."""
        return self.font(size).get_ascent() / FINER

    def render(self, text: str, *, size: int | None = None, colour: Colour = INK,
               halo: bool = False) -> pygame.Surface:
        """The text with a see-through ground, and with a white rim where ``halo``."""
        size = size or self.size
        return _face(self.font(size), letters(text), colour, rim_of(size) if halo else 0)


def rim_of(size: int) -> int:
    """The width of the rim of letters [pixels]."""
    return max(1, round(size / 9))


@lru_cache(2000)
def _face(font: pygame.Font, text: str, colour: Colour, rim: int) -> pygame.Surface:
    """Letters drawn larger and scaled down: small ones keep their shapes and spacing."""
    # accents alone take no room, and pygame draws no text without
    large = font.render(text if font.size(text)[0] else " ", True, colour)
    width, height = large.get_size()
    # an even ground of the text's colour, so that scaling mixes the opacity alone
    even = pygame.Surface((width, height), pygame.SRCALPHA, 32)
    even.fill((*colour, 0))
    even.blit(large, (0, 0), special_flags=pygame.BLEND_RGBA_MAX)
    wide, high = max(1, round(width / FINER)), max(1, round(height / FINER))
    face = pygame.transform.smoothscale(even, (wide, high))
    if not rim:
        return face
    whole = pygame.Surface((wide + 2 * rim, high + 2 * rim), pygame.SRCALPHA, 32)
    ground = _face(font, text, BACKGROUND, 0)
    whole.blits([(ground, (rim + dx, rim + dy)) for dx in range(-rim, rim + 1)
                 for dy in range(-rim, rim + 1) if dx * dx + dy * dy <= rim * rim + 1])
    whole.blit(face, (rim, rim))
    return whole


def ellipsis(type_: Typesetter, text: str, room: int, size: int) -> str:
    """``text`` cut to ``room`` pixels, with three dots where something is missing."""
    text = letters(text)
    if type_.width(text, size) <= room:
        return text
    kept = bisect_right(range(1, len(text)), room,
                        key=lambda length: type_.width(text[:length] + "...", size))
    return text[:kept].rstrip() + "..." if kept else ""


@lru_cache(4000)
def letters(text: str) -> str:
    """The printable form of a text, of at most :data:`MAX_LETTERS`."""
    return printable(text[:MAX_LETTERS])[:MAX_LETTERS]


class Headline(NamedTuple):
    """A title, set."""

    lines: tuple[str, ...]
    size: int  # of its type
    high: int  # the header [finished pixels]

    @classmethod
    def of(cls, title: str, type_: Typesetter, room: int, size: int, high: float) -> Headline:
        """``title`` in ``room`` pixels of a picture so ``high``, in type of ``size`` if it fits."""
        free = (SHARE * high - HEAD * type_.size) / (LINE * type_.size)
        most = int(min(max(1.0, 1 + free), MAX_LINES))
        title = letters(title)
        fits = next((s for s in range(size, type_.size - 1, -1) if type_.width(title, s) <= room),
                    None)
        size = fits or type_.size
        chars = len(title) if fits else int(0.95 * len(title) * room / type_.width(title, size))
        lines = tuple(ellipsis(type_, line, room, size) for line in textwrap.wrap(
            title, max(9, chars), max_lines=most, placeholder="..."))
        more = max(len(lines) - 1, 0) * round(LINE * size)
        return cls(lines, size, round(HEAD * type_.size) + more)

    def write(self, painter: Painter, type_: Typesetter, left: int) -> None:
        """Write the lines, ``left`` pixels from the edge."""
        step = round(LINE * self.size)
        for k, line in enumerate(self.lines):
            height = type_.height(self.size)
            first = (self.high - (len(self.lines) - 1) * step - height) // 2 + 1
            painter.write((left, first + k * step), line, self.size, INK)
