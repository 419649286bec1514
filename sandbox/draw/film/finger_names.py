"""Names of fingers beside them, where nothing passes during the whole run."""

from __future__ import annotations

from collections.abc import Callable

import pygame

from sandbox.draw.film import clip
from sandbox.model.model import Model
from sandbox.numeric import Array

Place = tuple[str, pygame.Rect]
MOST_HITS = 0
"""Passing points that a name may have below it."""


def finger_names(model: Model) -> list[tuple[str, int]]:
    """Names of the finger groups with the body each begins with."""
    index = model.names.body
    return [(group.name, index[group.bodies[0]]) for group in model.mechanism.groups
            if group.kind == "finger" and group.bodies and group.bodies[0] in index]


def place_names(
    names: list[tuple[str, int]], hinges: dict[int, tuple[float, float]], passing: Array,
    measure: Callable[[str], tuple[int, int]], stage: pygame.Rect, reach: float,
) -> list[Place]:
    """A free rectangle for every name; a name that finds none is left out.

    Args:
        names: what to write, and of which body.
        hinges: where each of these bodies begins [finished pixels].
        passing: all places [n, 2] that are drawn on at some time [finished pixels].
        measure: width and height of a text [pixels].
        stage: where names may lie.
        reach: how far from the hinge a name is looked for first [pixels].
    """
    placed: list[Place] = []
    for text, body in names:
        width, height = measure(text)
        x, y = hinges[body]
        for rect in _spots(x, y, width, height, reach):
            grown = rect.inflate(6, 4)
            inside = ((passing[:, 0] >= grown.left) & (passing[:, 0] < grown.right)
                      & (passing[:, 1] >= grown.top) & (passing[:, 1] < grown.bottom))
            free = stage.contains(rect) and int(inside.sum()) <= MOST_HITS
            if free and rect.collidelist([other for _, other in placed]) < 0:
                placed.append((text, rect))
                break
    return placed


def _spots(x: float, y: float, width: int, height: int, reach: float) -> list[pygame.Rect]:
    found = []
    for k in range(1, 5):
        r = reach * k / 2
        for dx, dy in ((0, -1), (-1, -1), (1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1)):
            cx = x + dx * (r + width / 2)
            cy = y + dy * (r + height / 2)
            found.append(pygame.Rect(clip.near(cx - width / 2), clip.near(cy - height / 2),
                                     width, height))
    return found
