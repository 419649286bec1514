"""Contact forces: arrows to one scale, values beside them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import Canvas, Label, Moment, Spots
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.geometry import arrow
from sandbox.draw.film.palette import BACKGROUND, FORCE, Colour
from sandbox.draw.film.scales import ForceScale, decimals, number
from sandbox.numeric import Array
from sandbox.samples.contacts import contacts_on, said_of

XY = tuple[float, float]

FINE = ((4.4, 11), (2.4, 10))
"""Shaft's and head's width of a slim arrow, its rim's and its own [points]."""
SHORTEST = 2.5
"""Arrows that are shorter are left out [points]."""
LABELLED = 0.12
"""Forces above this fraction of the reference get their value written beside them."""
MOST_LABELS = 24
AROUND, BEHIND = (0.0, 0.6, -0.6, 1.1, -1.1, 1.6, -1.6, 2.2, -2.2), (0.0, 0.6, -0.6, 1.1, -1.1)
"""Directions from an arrow's tip and from its tail in which its value is tried, against its own
and against that turned round [rad]."""


class ContactDrawer:
    """Draws the force of every touching pair, on one of the two (:func:`contacts_on`)."""

    def __init__(self, run: Filmed, scale: ForceScale, bodies: Sequence[int] | None = None) -> None:
        """``bodies`` are those that forces are shown of, all by default."""
        self._scale = scale
        arrays = run.arrays
        self._on, self._force = contacts_on(run.model, arrays)
        other = arrays["contact_body"] + arrays["contact_other"] - self._on
        self._point, samples = arrays["contact_point"], arrays["contact_sample"]
        if bodies is not None:
            kept = np.isin(arrays["contact_body"], bodies) | np.isin(
                arrays["contact_other"], bodies)
            self._on, self._force = self._on[kept], self._force[kept]
            self._point, samples, other = self._point[kept], samples[kept], other[kept]
        self._first = np.searchsorted(samples, np.arange(len(run.time) + 1))
        self.words = said_of(run.model, self._on, other)
        """For the legend: whom they act on."""

    def largest(self, samples: Iterable[int]) -> float:
        """The largest force of some samples [N]; 0 without any."""
        rows = (self._force[self._first[k]:self._first[k + 1]] for k in samples)
        return max((float(np.hypot(*force.T).max(initial=0.0)) for force in rows), default=0.0)

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
        told = np.round(sizes, decimals(self._scale.reference))
        return clip.whole(ends).tobytes() + told.tobytes()

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """The arrows; their values go to the canvas as labels."""
        if self._scale.metres == 0:
            return
        tails, tips, sizes = self.arrows(moment.sample)
        tails, tips = canvas.camera.to_pixels(tails), canvas.camera.to_pixels(tips)
        for k in reversed(range(len(sizes))):
            tail, tip = tuple(tails[k].tolist()), tuple(tips[k].tolist())
            if math.dist(tail, tip) < SHORTEST * canvas.unit:
                continue
            force_arrow(canvas, tail, tip, cut=sizes[k] > self._scale.longest)
            self._busy(canvas, tail, tip)
        for k in range(min(len(sizes), MOST_LABELS)):
            if sizes[k] >= LABELLED * self._scale.reference:
                canvas.labels.append(arrow_label(
                    canvas, tuple(tails[k]), tuple(tips[k]),
                    number(float(sizes[k]), self._scale.reference), "N", FORCE))

    @staticmethod
    def _busy(canvas: Canvas, tail: XY, tip: XY) -> None:
        """Keep labels off an arrow but for its tail."""
        side = round(3 * canvas.unit / canvas.enlarged)
        for fraction in (0.3, 0.55, 0.75, 1.0):
            x = (tail[0] + fraction * (tip[0] - tail[0])) / canvas.enlarged
            y = (tail[1] + fraction * (tip[1] - tail[1])) / canvas.enlarged
            canvas.busy.append((clip.near(x) - side, clip.near(y) - side, 2 * side, 2 * side))


def force_arrow(canvas: Canvas, tail: XY, tip: XY, *, cut: bool = False) -> None:
    """A contact force."""
    slim_arrow(canvas, FORCE, tail, tip, cut=cut)


def slim_arrow(canvas: Canvas, colour: Colour, tail: XY, tip: XY, *, cut: bool = False) -> None:
    """A slim arrow with a white rim; two white bars where its length was cut."""
    canvas.touch_path((tail, tip), 7)
    for own, (shaft, head) in zip((BACKGROUND, colour), FINE, strict=True):
        clip.polygon(canvas.surface, own,
                     arrow(tail, tip, shaft * canvas.unit, head * canvas.unit))
    if cut:
        cut_bars(canvas, tail, tip)


def cut_bars(canvas: Canvas, tail: XY, tip: XY, half: float = 4.5) -> None:
    """Two white bars across the shaft of an arrow that would be longer, ``half`` points wide."""
    length = math.dist(tail, tip)
    if not length > 0:
        return
    ux, uy = (tip[0] - tail[0]) / length, (tip[1] - tail[1]) / length
    reach, lean = half * canvas.unit, 2 * canvas.unit
    for fraction in (0.40, 0.50):
        x, y = tail[0] + fraction * (tip[0] - tail[0]), tail[1] + fraction * (tip[1] - tail[1])
        clip.line(canvas.surface, BACKGROUND,
                  (x + uy * reach - ux * lean, y - ux * reach - uy * lean),
                  (x - uy * reach + ux * lean, y + ux * reach + uy * lean), canvas.width(1.8))


def arrow_label(canvas: Canvas, tail: XY, tip: XY, value: str, unit: str, colour: Colour, *,
                alone: bool = False, required: bool = False) -> Label:
    """An arrow's value, which may stand off on a line, or in a list with others at its tip."""
    return Label(value, label_spots(canvas, tail, tip), colour, unit=unit, alone=alone,
                 required=required, at=(tip[0] / canvas.enlarged, tip[1] / canvas.enlarged))


def label_spots(canvas: Canvas, tail: XY, tip: XY) -> Spots:
    """Places for a text beside an arrow [pixels of the finished picture], best first.

    About its tip, then behind its tail: arrows into one body crowd where they point.
    """
    length = math.dist(tail, tip) or 1.0
    ux, uy = (tip[0] - tail[0]) / length, (tip[1] - tail[1]) / length
    k, clear = canvas.enlarged, 2 * canvas.unit / canvas.enlarged

    def spots(half_x: float, half_y: float) -> Iterator[XY]:
        for (px, py), ahead, angles in ((tip, 1.0, AROUND), (tail, -1.0, BEHIND)):
            for angle in angles:
                c, s = ahead * math.cos(angle), ahead * math.sin(angle)
                dx, dy = c * ux - s * uy, s * ux + c * uy
                # the text's middle lies where its box just clears the end
                reach = min(half_x / max(abs(dx), 1e-6), half_y / max(abs(dy), 1e-6)) + clear
                yield px / k + dx * reach, py / k + dy * reach

    return spots
