"""Tendons: cords through their guides, coloured by tension; dashed where slack."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import Canvas, Moment
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.geometry import cord_path, cord_pieces
from sandbox.draw.film.joints import rub_mark
from sandbox.draw.film.palette import (
    LEVELS,
    PIN_FILL,
    PIN_RING,
    ROLES,
    SLACK,
    WHEEL,
    WHEEL_EDGE,
    Style,
    tension_colour,
)
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.springs import THICK, thickened
from sandbox.draw.film.tensions import SLACK_FRACTION, Tensions
from sandbox.model.model import NONE, Model
from sandbox.model.ties import held_of
from sandbox.numeric import Array, Flags
from sandbox.samples.cords import off_wheels
from sandbox.scene.bodies import Circle

XY = tuple[float, float]
CORD = 2.4
"""Width of a cord in points."""
WOUND = 1.5
"""How much of a cord that is wound on its end's wheel is shown [rad]."""
BARE = Style(WHEEL, WHEEL_EDGE)
"""Of wheels that are no circles of their bodies."""
CREEP, LEAST_SLIP = 1e-3, 1e-6
"""A cord that slides less from sample to sample than this share of its largest slide, or of this
slide [m], is held."""


@dataclass(frozen=True)
class _Cord:
    where: slice
    radii: list[float]
    """[m]"""
    senses: list[int]
    closed: bool
    around: Flags
    """Which of its wheels it goes all around."""
    pieces: slice
    """Its straight pieces, among those of all; where no guide holds it the last one alone."""
    wheels: list[int]
    """Those of its guides that it can lift off."""
    off: Flags
    """In which samples it is off these, [n, wheels]."""
    grips: dict[int, int]
    """Of each guide that holds it its number among all that do, in order."""
    stiffener: int
    """The drive that sets its stiffness, or -1."""
    stiffness: float
    """Its own [N/m]."""

    def width(self, moment: Moment) -> float:
        """In points: one that a drive makes stiffer is wider."""
        if self.stiffener == NONE:
            return CORD
        return CORD * thickened(float(moment.drives[self.stiffener]) / self.stiffness)


@dataclass(frozen=True)
class _Wheel:
    """A disc about a guide: its centre, and a point at angle 0 of its body."""

    centre: int
    radius: float
    """[m]"""
    style: Style
    marked: bool
    """Whether a line from the centre shows how it is turned."""


def stiffened_cord_symbol(canvas: Canvas, x: float, y: float, width: float) -> None:
    """A cord for the legend that a drive makes stiffer."""
    canvas.polyline(tension_colour(0.5), [(x, y), (x + width, y)], CORD * thickened(THICK[1]))


def slipping(way: Array) -> Flags:
    """In which samples a cord slides over each guide that holds it, [n, nf].

    Args:
        way: cord that has slid over it since t = 0 [m], [n, nf].
    """
    slid = np.abs(np.diff(way, axis=0, prepend=way[:1]))
    least = CREEP * np.maximum(slid.max(axis=0, initial=0.0), LEAST_SLIP)
    return np.asarray(slid > least, dtype=bool)


class TendonDrawer:
    """Draws every tendon with its guides."""

    def __init__(self, run: Filmed, tensions: Tensions, pool: PointPool) -> None:
        off = off_wheels(run.arrays)
        self._cords = [self._cord(run.model, k, pool, off)
                       for k in range(len(run.mechanism.tendons))]
        self._tension, self._largest = tensions.pieces, tensions.largest
        self._hold = held_of(run.model.ties.tendon, run.arrays["held"]).T
        """Which cords hold, [n, nt]."""
        self._of = run.model.tendons.stretch_tendon
        self._slips = slipping(run.arrays["guide_slip"])
        self._wheels = wheels_of(run.model, pool)
        self._eyes = [(k, i) for k, cord in enumerate(self._cords)
                      for i, r in zip(range(cord.where.start, cord.where.stop), cord.radii,
                                      strict=True) if r == 0]

    @staticmethod
    def _cord(model: Model, k: int, pool: PointPool, off: Flags) -> _Cord:
        spec, tendons = model.mechanism.tendons[k], model.tendons
        bodies = tendons.guide_body[tendons.guides(k)].tolist()
        where = [pool.add(body, [g.at]).start for body, g in zip(bodies, spec.path, strict=True)]
        own = np.flatnonzero(tendons.stretch_tendon == k)
        first = own[0] if len(tendons.gripped(k)) else own[-1]
        return _Cord(slice(where[0], where[-1] + 1), [g.radius for g in spec.path],
                     [1 if g.side == "right" else -1 for g in spec.path], spec.closed,
                     tendons.guide_turns[tendons.guides(k)] > 0,
                     slice(int(first), int(own[-1]) + 1), list(spec.lifting),
                     off[:, tendons.loose(k)],
                     dict(zip(spec.gripping, tendons.gripped(k).tolist(), strict=True)),
                     int(tendons.stiffener[k]),
                     float(tendons.stiffness[k]))

    def slack(self, samples: Sequence[int]) -> bool:
        """Whether any tendon is slack in any of the samples."""
        hold = self._hold[samples][:, self._of]
        return bool((hold & (self._tension[samples] <= SLACK_FRACTION * self._largest)).any())

    def key(self, moment: Moment) -> bytes:
        """Equal for moments whose cords have the same colours."""
        fraction = self._tension[moment.sample] / (self._largest or 1.0)
        levels = np.where(fraction <= SLACK_FRACTION, -1, np.floor(fraction * (LEVELS - 1) + 0.5))
        lifted = [cord.off[moment.sample].tobytes() for cord in self._cords]
        widths = np.array([cord.width(moment) for cord in self._cords])
        return b"".join((levels.astype(np.int16).tobytes(), *lifted, widths.tobytes(),
                         self._hold[moment.sample].tobytes(),
                         self._slips[moment.sample].tobytes()))

    def draw_wheels(self, canvas: Canvas, moment: Moment) -> None:
        """The wheels of guides, below the cords."""
        for wheel in self._wheels:
            centre, pixels = moment.points[wheel.centre], wheel.radius * canvas.camera.scale
            canvas.touch(centre, pixels / canvas.unit + 1)
            clip.circle(canvas.surface, wheel.style.edge, centre, pixels)
            clip.circle(canvas.surface, wheel.style.fill, centre,
                        max(1.0, pixels - 1.2 * canvas.unit))
            if wheel.marked:
                clip.line(canvas.surface, wheel.style.edge, centre, moment.points[wheel.centre + 1],
                          canvas.width(1.2))

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """The cords, the slack ones first, and the eyes they run through."""
        tensions = self._tension[moment.sample]
        tight = [float(tensions[cord.pieces].max()) for cord in self._cords]
        for k in np.argsort(tight, kind="stable"):
            cord = self._cords[k]
            if not self._hold[moment.sample, k]:
                continue
            off = {w for w, is_off in zip(cord.wheels, cord.off[moment.sample], strict=True)
                   if is_off}
            on = [i for i in range(len(cord.radii)) if i not in off]
            pieces = tensions[cord.pieces]
            if len(pieces) > 1:
                pieces = pieces[on[:-1]]
            paths = self._paths(canvas, moment, cord, on)
            if len(pieces) == 1:
                pieces = np.repeat(pieces, len(paths))
            for path, tension in zip(paths, pieces, strict=True):
                self._draw_path(canvas, path, float(tension), cord.width(moment))
            if len(paths) > 1:
                self._draw_grips(canvas, moment, cord, dict(zip(on[1:], paths, strict=False)))
        for i in (i for k, i in self._eyes if self._hold[moment.sample, k]):
            canvas.ring(PIN_FILL, PIN_RING, moment.points[i], 2.7, 1.0)

    def _draw_grips(self, canvas: Canvas, moment: Moment, cord: _Cord,
                    before: dict[int, list[XY]]) -> None:
        """Collars where guides hold the cord; ``before`` each guide is the path that ends there."""
        for guide, grip in cord.grips.items():
            path = before.get(guide or len(cord.radii) - 1)
            if path:
                rub_mark(canvas, path[-1], holds=not self._slips[moment.sample, grip])

    def _draw_path(
        self, canvas: Canvas, path: list[XY], tension: float, width: float,
    ) -> None:
        if tension <= SLACK_FRACTION * self._largest:
            canvas.touch_path(path, 2)
            clip.dashed(canvas.surface, SLACK, path, 5 * canvas.unit, 4 * canvas.unit,
                        canvas.width(1.8))
        else:
            canvas.polyline(tension_colour(tension / self._largest), path, width)

    @staticmethod
    def _paths(canvas: Canvas, moment: Moment, cord: _Cord, on: list[int]) -> list[list[XY]]:
        """Of each piece that has a colour of its own, over the guides that the cord lies ``on``.

        One that goes all around a wheel is cut there, as what is filled may not lie on itself.
        """
        points, whole = moment.points[cord.where], cord.pieces.stop - cord.pieces.start == 1
        if whole and not any(cord.radii):
            return [points]
        points = [points[i] for i in on]
        # the picture's y runs down, so right of the path in the world is left of it here
        radii, senses = [cord.radii[i] * canvas.camera.scale for i in on], [
            -cord.senses[i] for i in on]
        around = cord.around[on]
        if whole and not around.any():
            return [cord_path(points, radii, senses, WOUND, closed=cord.closed)]
        return cord_pieces(points, radii, senses, WOUND, closed=cord.closed,
                           around=np.flatnonzero(around).tolist())


def wheels_of(model: Model, pool: PointPool) -> list[_Wheel]:
    """The wheels of guides that no circle of their body shows, on every shaft the largest first.

    A circle that such a wheel would cover is drawn again above it.
    """
    shafts: dict[tuple[int, XY], list[float]] = {}
    for tendon in model.mechanism.tendons:
        for guide in tendon.guides:
            if guide.radius > 0:
                shafts.setdefault((model.names.body[guide.body], guide.at), []).append(guide.radius)
    found = []
    drives = model.drives
    swelling = {(int(drives.target[k]), int(drives.shape[k])) for k in drives.giving("radius")}
    for (body, at), radii in shafts.items():
        spec = model.mechanism.bodies[body]
        circles = [s.radius for k, s in enumerate(spec.shapes)
                   if isinstance(s, Circle) and s.at == at and (body, k) not in swelling]
        missing = {r for r in radii if not any(math.isclose(r, c) for c in circles)}
        steps = {r: BARE for r in missing}
        steps |= {c: ROLES[spec.role] for c in circles if c < max(missing, default=0.0)}
        for radius in sorted(steps, reverse=True):
            centre = pool.add(body, [at, (at[0] + radius, at[1])]).start
            found.append(_Wheel(centre, radius, steps[radius], marked=len(steps) > 1))
    return found
