"""Contact forces: arrows to one scale, values beside them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pygame

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import Canvas, Filmed, Label, Moment
from sandbox.draw.film.geometry import arrow
from sandbox.draw.film.palette import BACKGROUND, FORCE
from sandbox.numeric import Array

XY = tuple[float, float]

REFERENCE = 0.085
"""Length of the reference force's arrow as a fraction of the picture's width."""
LONGEST = 1.5
"""Arrows are cut at this many times the reference and marked with a bar."""
LABELLED = 0.12
"""Forces above this fraction of the reference get their value written beside them."""
NOTHING = 1e-6
"""A lasting force below this fraction of the largest impact is what rounding leaves."""
MOST_LABELS = 24
MOST_ROWS = 2_000_000
"""Contact rows that the scale of forces is taken from; of more, every second, third and so on."""


@dataclass(frozen=True)
class ForceScale:
    """How long an arrow is."""

    metres: float
    """Length of a 1 N arrow [m]; 0 where there are no forces."""
    reference: float
    """[N] A force that is typical of the large ones of the run."""

    @property
    def longest(self) -> float:
        """[N] Forces above are cut."""
        return self.reference * LONGEST


def force_scale(run: Filmed, width: float) -> ForceScale:
    """The scale the view asks for, or one fitted to the run on a picture ``width`` [m] wide.

    The reference is the largest force of the last tenth of the run or the 95 %
    quantile of all, whichever is larger: impacts last a sample and would shrink
    everything else. Where there are only impacts, it is the largest.
    """
    every = slice(None, None, 1 + len(run.arrays["contact_force"]) // MOST_ROWS)
    sizes = np.hypot(*run.arrays["contact_force"][every].T)
    if not sizes.size or not sizes.max() > 0:
        return ForceScale(0.0, 0.0)
    late = sizes[run.arrays["contact_sample"][every] >= 0.9 * len(run.time)]
    reference = max(float(np.quantile(sizes, 0.95)), float(late.max(initial=0.0)))
    if reference < NOTHING * sizes.max():
        reference = float(sizes.max())
    if run.mechanism.view.force_scale > 0:
        return ForceScale(run.mechanism.view.force_scale, reference)
    return ForceScale(REFERENCE * width / reference, reference)


def number(value: float, reference: float) -> str:
    """A value with as many decimals as its scale deserves: three digits at ``reference``."""
    decimals = 2 if reference < 10 else 1 if reference < 100 else 0
    return f"{value:.{decimals}f}"


class ContactDrawer:
    """Draws the force on the moving body of every touching pair."""

    def __init__(self, run: Filmed, scale: ForceScale) -> None:
        self._scale = scale
        arrays = run.arrays
        self._point, self._force = arrays["contact_point"], arrays["contact_force"]
        self._first = np.searchsorted(arrays["contact_sample"], np.arange(len(run.time) + 1))

    def arrows(self, sample: int) -> tuple[Array, Array, Array]:
        """Tails, tips [k, 2] m and sizes [k] N of a sample, the largest force first."""
        rows = slice(self._first[sample], self._first[sample + 1])
        force, point = self._force[rows], self._point[rows]
        size = np.hypot(force[:, 0], force[:, 1])
        order = np.argsort(-size, kind="stable")
        force, point, size = force[order], point[order], size[order]
        cut = np.minimum(1.0, self._scale.longest / np.maximum(size, 1e-30))
        return point, point + force * (cut * self._scale.metres)[:, None], size

    def key(self, canvas: Canvas, moment: Moment) -> bytes:
        """Equal for moments whose arrows and values look the same."""
        tails, tips, sizes = self.arrows(moment.sample)
        ends = canvas.camera.to_pixels(np.concatenate((tails, tips)))
        return clip.whole(ends).tobytes() + np.round(sizes, 2).tobytes()

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """The arrows; their values go to the canvas as labels."""
        if self._scale.metres == 0:
            return
        tails, tips, sizes = self.arrows(moment.sample)
        tails, tips = canvas.camera.to_pixels(tails), canvas.camera.to_pixels(tips)
        for k in reversed(range(len(sizes))):
            tail, tip = tuple(tails[k].tolist()), tuple(tips[k].tolist())
            if math.dist(tail, tip) < 2.5 * canvas.unit:
                continue
            force_arrow(canvas, tail, tip, cut=sizes[k] > self._scale.longest)
            self._busy(canvas, tail, tip)
        for k in range(min(len(sizes), MOST_LABELS)):
            if sizes[k] >= LABELLED * self._scale.reference:
                text = f"{number(float(sizes[k]), self._scale.reference)} N"
                canvas.labels.append(Label(
                    text, label_spots(canvas, tuple(tails[k]), tuple(tips[k]), text), FORCE))

    @staticmethod
    def _busy(canvas: Canvas, tail: XY, tip: XY) -> None:
        """Keep labels off the outer half of an arrow."""
        side = round(3 * canvas.unit / canvas.enlarged)
        for fraction in (0.55, 0.75, 1.0):
            x = (tail[0] + fraction * (tip[0] - tail[0])) / canvas.enlarged
            y = (tail[1] + fraction * (tip[1] - tail[1])) / canvas.enlarged
            canvas.busy.append(pygame.Rect(clip.near(x) - side, clip.near(y) - side,
                                           2 * side, 2 * side))


def force_arrow(canvas: Canvas, tail: XY, tip: XY, *, cut: bool = False) -> None:
    """A contact force: a slim arrow with a white rim; a white bar where its length was cut."""
    canvas.touch_path((tail, tip), 7)
    clip.polygon(canvas.surface, BACKGROUND,
                 arrow(tail, tip, 4.4 * canvas.unit, 11 * canvas.unit))
    clip.polygon(canvas.surface, FORCE,
                 arrow(tail, tip, 2.4 * canvas.unit, 10 * canvas.unit))
    if cut:
        for fraction in (0.40, 0.50):
            x, y = tail[0] + fraction * (tip[0] - tail[0]), tail[1] + fraction * (tip[1] - tail[1])
            length = math.dist(tail, tip)
            nx, ny = -(tip[1] - tail[1]) / length, (tip[0] - tail[0]) / length
            ux, uy = ny, -nx
            reach, lean = 4.5 * canvas.unit, 2 * canvas.unit
            clip.line(canvas.surface, BACKGROUND,
                      (x - nx * reach - ux * lean, y - ny * reach - uy * lean),
                      (x + nx * reach + ux * lean, y + ny * reach + uy * lean),
                      canvas.width(1.8))


def label_spots(canvas: Canvas, tail: XY, tip: XY, text: str) -> Iterator[XY]:
    """Places for a text beside an arrow's tip [pixels of the finished picture], best first."""
    length = math.dist(tail, tip) or 1.0
    ux, uy = (tip[0] - tail[0]) / length, (tip[1] - tail[1]) / length
    u = canvas.unit / canvas.enlarged
    x, y = tip[0] / canvas.enlarged, tip[1] / canvas.enlarged
    half_x, half_y = 2.9 * u * len(text), 8 * u
    for angle in (0.0, 0.6, -0.6, 1.1, -1.1, 1.6, -1.6, 2.2, -2.2):
        c, s = math.cos(angle), math.sin(angle)
        dx, dy = c * ux - s * uy, s * ux + c * uy
        # the text's middle lies where its box just clears the tip
        reach = min(half_x / max(abs(dx), 1e-6), half_y / max(abs(dy), 1e-6)) + 3 * u
        yield x + dx * reach, y + dy * reach
