"""Where values and names go on a picture: each beside what it tells of, none on another.

Numbers of arrows that end at one place are written as one list. One that finds no room beside its
arrow stands farther off, on a thin line.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import pygame

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import LEAST_TYPE, XY, Label
from sandbox.draw.film.palette import lighter
from sandbox.draw.film.sheet import Hair, Text
from sandbox.draw.film.typesetter import Typesetter

VALUE = 1.1
"""Size of type of values, in those of the legend."""
ONE_PLACE = 13.0
"""Arrows that end no farther apart are told of in one list [points]."""
MOST_LISTED = 4
NEAREST, FARTHEST, FURTHER = 16.0, 88.0, 9.0
"""From where a line ends to the nearest point of its text: the least, the most, and steps between
[points]."""
WAYS = 16
"""Directions in which it is looked for."""
RIM, END = 1.5, 2.5
"""A line begins so far from its text, and ends so far before what it tells of [points]."""


def place_labels(labels: Sequence[Label], type_: Typesetter, unit: float, stage: pygame.Rect,
                 taken: list[pygame.Rect], avoided: Sequence[pygame.Rect] = (),
                 ) -> Iterator[Text | Hair]:
    """Those that find room, each after its line where it stands off.

    Args:
        labels: what is to be written.
        type_: of the legend.
        unit: pixels of the finished picture per point.
        stage: where texts may lie [finished pixels].
        taken: where none may; what is placed is added.
        avoided: where one may only if it finds no other place beside what it tells of.
    """
    size = max(LEAST_TYPE, type_.scaled(VALUE))
    for label in sorted(listed_together(labels, unit), key=lambda each: not each.required):
        face = type_.render(f"{label.text} {label.unit}".strip(), size=size, colour=label.colour,
                            halo=True)
        rect = next((spot for spot in (
            free_spot(label, face.get_size(), stage, [*taken, *avoided]),
            place_label(label, face.get_size(), stage, taken)) if spot is not None), None)
        if rect is None and label.at is not None and stage.collidepoint(label.at):
            rect = _aside(label.at, face.get_size(), stage, taken, unit)
            if rect is not None:
                yield Hair(lighter(label.colour, 0.35), *leader(rect, label.at, unit, END))
        if rect is not None:
            taken.append(rect)
            yield Text(face, rect.topleft)


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


def _aside(at: XY, size: tuple[int, int], stage: pygame.Rect, taken: list[pygame.Rect],
           unit: float) -> pygame.Rect | None:
    """The nearest free place whose line crosses no other text."""
    for dx, dy in ways_from(size, unit, (NEAREST, FARTHEST, FURTHER), WAYS):
        rect = _about(at[0] + dx, at[1] + dy, size)
        if stage.contains(rect) and rect.collidelist(taken) < 0:
            start, end = leader(rect, at, unit, END)
            if not any(other.width > size[1] and other.clipline(start, end) for other in taken):
                return rect
    return None


def ways_from(size: tuple[int, int], unit: float, reach: tuple[float, float, float],
              ways: int) -> list[XY]:
    """From a point to the middle of a text of a size, nearest first, upwards first.

    ``reach`` is the least and the most from the point to the text, and the steps between [points].
    """
    least, most, step = reach
    found = []
    for k in range(int((most - least) / step) + 1):
        gap = (least + k * step) * unit
        for n in range(ways):
            # to either side by turns, so that texts are above rather than below
            turn = math.tau / ways * (n // 2 + 1) * (1 if n % 2 else -1) if n else 0.0
            dx, dy = math.sin(turn), -math.cos(turn)
            found.append((dx * gap + _sign(dx) * size[0] / 2, dy * gap + _sign(dy) * size[1] / 2))
    return found


def _sign(value: float) -> float:
    return 0.0 if abs(value) < 1e-9 else math.copysign(1.0, value)


def leader(rect: pygame.Rect, at: XY, unit: float, before: float) -> tuple[XY, XY]:
    """A line from a text to so many points before what it tells of."""
    x = min(max(at[0], rect.left), rect.right)
    y = min(max(at[1], rect.top), rect.bottom)
    dx, dy = at[0] - x, at[1] - y
    length = max(math.hypot(dx, dy), 1e-9)
    start, end = RIM * unit / length, max(0.0, 1.0 - before * unit / length)
    return (x + start * dx, y + start * dy), (x + end * dx, y + end * dy)
