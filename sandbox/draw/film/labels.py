"""Where values and names go on a picture: each beside what it tells of, none on another.

Numbers of arrows that end at one place are written as one list. One that finds no room beside its
arrow stands farther off, on a thin line.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import pygame

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import LEAST_TYPE, Label
from sandbox.draw.film.leaders import OF_NUMBERS, TIP, leader, ways_from
from sandbox.draw.film.linework import Linework
from sandbox.draw.film.palette import lighter
from sandbox.draw.film.sheet import Hair, Text
from sandbox.draw.film.typesetter import Typesetter

VALUE = 1.1
"""Size of type of values, in those of the legend."""
ONE_PLACE = 13.0
"""Arrows that end no farther apart are told of in one list [points]."""
MOST_LISTED = 4
OFF, LATER = 0.8, 0.1
"""What standing off is worth, and a later one of the places beside [lines that a text hides]."""


def place_labels(labels: Sequence[Label], type_: Typesetter, unit: float, stage: pygame.Rect,
                 taken: list[pygame.Rect], avoided: Sequence[pygame.Rect] = (),
                 drawn: Linework | None = None) -> Iterator[Text | Hair]:
    """Those that find room, each after its line where it stands off.

    Args:
        labels: what is to be written.
        type_: of the legend.
        unit: pixels of the finished picture per point.
        stage: where texts may lie [finished pixels].
        taken: where none may; what is placed is added.
        avoided: where one may only if it finds no other place beside what it tells of.
        drawn: of a picture that stands: texts hide as little of it as they can. In one that moves
            they would jump about.
    """
    size = max(LEAST_TYPE, type_.scaled(VALUE))
    for label in sorted(listed_together(labels, unit), key=lambda each: not each.required):
        face = type_.render(f"{label.text} {label.unit}".strip(), size=size, colour=label.colour,
                            halo=True)
        placing = _Placing(label, face.get_size(), stage, taken, avoided, unit)
        rect, off = placing.first() if drawn is None else placing.clearest(drawn)
        if rect is not None:
            if off and label.at is not None:
                yield Hair(lighter(label.colour, 0.35), *leader(rect, label.at, unit, TIP))
            taken.append(rect)
            yield Text(face, rect.topleft)


@dataclass(frozen=True)
class _Placing:
    """Where a text may lie."""

    label: Label
    size: tuple[int, int]
    stage: pygame.Rect
    taken: list[pygame.Rect]
    avoided: Sequence[pygame.Rect]
    unit: float

    def first(self) -> tuple[pygame.Rect | None, bool]:
        """The first place beside what it tells of, else the nearest that stands off; which."""
        label, size, stage = self.label, self.size, self.stage
        rect = free_spot(label, size, stage, [*self.taken, *self.avoided])
        rect = rect or place_label(label, size, stage, self.taken)
        return (rect, False) if rect else (next(self._aside(), None), True)

    def clearest(self, drawn: Linework) -> tuple[pygame.Rect | None, bool]:
        """Where it hides least for what it stands off, and whether it does."""
        found: tuple[pygame.Rect | None, bool] = (None, False)
        least = math.inf
        for k, rect in enumerate(self._beside()):
            cost = drawn.under(rect) + LATER * k + (rect.collidelist(self.avoided) >= 0)
            if cost < least:
                found, least = (rect, False), cost
        for rect in self._aside():  # nearest first
            cost = OFF + self._gap(rect)
            if cost >= least:
                break
            cost += drawn.under(rect)
            if cost < least:
                found, least = (rect, True), cost
        return found if found[0] else self.first()

    def _beside(self) -> Iterator[pygame.Rect]:
        for x, y in self.label.spots(self.size[0] / 2, self.size[1] / 2):
            rect = _about(x, y, self.size)
            if self.stage.contains(rect) and rect.collidelist(self.taken) < 0:
                yield rect

    def _gap(self, rect: pygame.Rect) -> float:
        """From what it tells of to the text, in heights of the text."""
        (x0, y0), at = leader(rect, self.label.at or rect.center, 0.0, 0.0)
        return math.dist((x0, y0), at) / self.size[1]

    def _aside(self) -> Iterator[pygame.Rect]:
        """Free places that stand off, nearest first, whose lines cross no other text."""
        at = self.label.at
        if at is None or not self.stage.collidepoint(at):
            return
        for dx, dy in ways_from(self.size, self.unit, OF_NUMBERS):
            rect = _about(at[0] + dx, at[1] + dy, self.size)
            if self.stage.contains(rect) and rect.collidelist(self.taken) < 0:
                start, end = leader(rect, at, self.unit, TIP)
                if not any(other.width > self.size[1] and other.clipline(start, end)
                           for other in self.taken):
                    yield rect


def listed_together(labels: Sequence[Label], unit: float) -> list[Label]:
    """The labels, those of one colour and unit at one place as a list with commas."""
    found: list[Label] = []
    for label in labels:
        same = next((k for k, other in enumerate(found) if _joins(label, other, unit)), None)
        if same is None:
            found.append(label)
        else:
            found[same] = replace(found[same], text=f"{found[same].text}, {label.text}")
    return found


def _joins(label: Label, other: Label, unit: float) -> bool:
    return (label.at is not None and other.at is not None and not label.alone
            and not other.alone and label.colour == other.colour
            and label.unit == other.unit and other.text.count(",") + 1 < MOST_LISTED
            and math.dist(label.at, other.at) < ONE_PLACE * unit)


def place_label(label: Label, size: tuple[int, int], stage: pygame.Rect,
                taken: list[pygame.Rect]) -> pygame.Rect | None:
    """The first of its spots that is free; of one that is required the first, if none is."""
    if (free := free_spot(label, size, stage, taken)) is not None or not label.required:
        return free
    first = next((_about(x, y, size) for x, y in label.spots(size[0] / 2, size[1] / 2)), None)
    return first.clamp(stage) if first is not None and stage.colliderect(first) else None


def free_spot(label: Label, size: tuple[int, int], stage: pygame.Rect,
              taken: Sequence[pygame.Rect]) -> pygame.Rect | None:
    """The first of the label's spots on the stage that touches nothing taken, if there is one."""
    every = (_about(x, y, size) for x, y in label.spots(size[0] / 2, size[1] / 2))
    return next((rect for rect in every
                 if stage.contains(rect) and rect.collidelist(taken) < 0), None)


def _about(x: float, y: float, size: tuple[int, int]) -> pygame.Rect:
    return pygame.Rect(clip.near(x - size[0] / 2), clip.near(y - size[1] / 2), *size)
