"""Loads: slim arrows in the colour of drives, and what liquids stand in."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import Canvas, Moment
from sandbox.draw.film.drives import SLIM
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.forces import arrow_label, cut_bars
from sandbox.draw.film.geometry import arrow
from sandbox.draw.film.palette import BACKGROUND, DRIVE, LIQUID, LIQUID_EDGE
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.scales import ForceScale, decimals, number, rounding, shared, typical
from sandbox.numeric import Array

XY = tuple[float, float]
TELLING = 6
"""Of no more than so many loads on bodies the values are written."""
APART = 4.0
"""How many times as large contact forces may be, or as small, and have one scale with loads."""
LOAD_LENGTH = 0.11
"""Length of a load's arrow that is typical of the large ones, as a fraction of the picture's
width."""
FAINT, SHORTEST = 0.02, 5.0
"""Arrows below this share of typical ones are left out, and those too short for a head [points]."""


class LoadDrawer:
    """Draws the force of each load on each body, from where it acts.

    To the scale of the contact forces where these are about as large, else to one of their own.
    """

    def __init__(self, run: Filmed, pool: PointPool, length: float, scale: ForceScale,
                 bodies: Sequence[int] | None = None, beside: Sequence[Filmed] = ()) -> None:
        """``length`` of a usual arrow where loads have a scale of their own [m].

        ``bodies`` are those whose loads are shown, all by default. Runs ``beside`` have one scale.
        """
        loads, arrays = run.model.loads, run.arrays
        self._force, self._torque = arrays["load_force"], arrays["load_torque"]
        self._places = [pool.add(int(body), at).start
                        for body, at in zip(loads.body, loads.at, strict=True)]
        self._lifts = [law is None for law in loads.law]
        self._names = [run.mechanism.loads[i].name for i in loads.load]
        self._scale = shared(load_scale(each, length, scale) for each in (run, *beside))
        self._shown = range(len(self._places)) if bodies is None else np.flatnonzero(
            np.isin(loads.body, bodies)).tolist()

    @property
    def scale(self) -> ForceScale:
        """That of the arrows; of length 0 where no load is shown."""
        sizes = np.hypot(*self._force[:, list(self._shown)].reshape(-1, 2).T)
        return self._scale if np.nan_to_num(sizes).max(initial=0.0) > 0 else ForceScale(0.0, 0.0)

    def arrows(self, world: Array, sample: int) -> list[tuple[int, XY, XY, float]]:
        """Every arrow's load, tail and tip [m], and size [N], for pooled points of a sample."""
        found = []
        for i in self._shown:
            force, place = self._force[sample, i], self._places[i]
            size = float(math.hypot(*force))
            if not size > FAINT * self._scale.reference or self._scale.metres == 0:
                continue
            x, y = world[place].tolist()
            if self._lifts[i]:  # it acts at the middle of what is under the level
                x += float(self._torque[sample, i] / force[1])
            shown = force * (min(1.0, self._scale.longest / size) * self._scale.metres)
            found.append((i, (x, y), (x + float(shown[0]), y + float(shown[1])), size))
        return found

    def key(self, canvas: Canvas, moment: Moment) -> bytes:
        """Equal for moments whose arrows look the same."""
        arrows = self.arrows(moment.world, moment.sample)
        ends = np.array([end for _, tail, tip, _ in arrows for end in (tail, tip)]).reshape(-1, 2)
        return (clip.whole(canvas.camera.to_pixels(ends)).tobytes()
                + np.round([size for *_, size in arrows],
                           decimals(self._scale.reference)).tobytes())

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """The arrows; of a few loads with names and values."""
        for i, tail, tip, size in self.arrows(moment.world, moment.sample):
            a, b = canvas.camera.to_pixels(np.array([tail, tip])).tolist()
            if math.dist(a, b) < SHORTEST * canvas.unit:
                continue
            load_arrow(canvas, a, b, cut=size > self._scale.longest)
            if len(self._shown) <= TELLING:
                text = f"{self._names[i]} {number(size, self._scale.reference)} N"
                canvas.labels.append(arrow_label(canvas, tuple(a), tuple(b), text, "", DRIVE,
                                                 alone=True))


def load_scale(run: Filmed, length: float, scale: ForceScale) -> ForceScale:
    """How long the arrows of loads are.

    ``length`` is that of a usual one where loads have a scale of their own [m], ``scale`` that of
    the contact forces.
    """
    force = run.arrays["load_force"]
    size = np.nan_to_num(np.hypot(force[..., 0], force[..., 1]))
    usual = typical(size.max(axis=1, initial=0.0), run.time)
    if usual <= rounding(run):  # as drag of what is at rest, whose speed is what rounding leaves
        return ForceScale(0.0, 0.0)
    alike = usual / APART <= scale.reference <= usual * APART
    return scale if scale.metres > 0 and alike else ForceScale(
        length / usual, usual)


def load_arrow(canvas: Canvas, tail: XY, tip: XY, *, cut: bool = False) -> None:
    """A slim arrow with a white rim; two white bars where its length was cut."""
    canvas.touch_path((tail, tip), 12)
    for colour, (w, h) in zip((BACKGROUND, DRIVE), SLIM, strict=True):
        clip.polygon(canvas.surface, colour, arrow(tail, tip, w * canvas.unit, h * canvas.unit))
    if cut:
        cut_bars(canvas, tail, tip, 5.5)


def draw_liquids(canvas: Canvas, run: Filmed) -> None:
    """What stands below the level of every liquid."""
    width, height = canvas.surface.get_size()
    for level in sorted(set(run.model.loads.level[np.isfinite(run.model.loads.level)].tolist()),
                        reverse=True):
        y = min(max(float(canvas.camera.to_pixels(np.array([[0.0, level]]))[0, 1]), -10.0),
                height + 10.0)
        clip.polygon(canvas.surface, LIQUID, [(0, y), (width, y), (width, height), (0, height)])
        clip.line(canvas.surface, LIQUID_EDGE, (0, y), (width, y), canvas.width(1.4))
