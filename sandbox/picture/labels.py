"""Places of numbers and names, chosen once for a film so that they do not jump or flicker.

A label has one of 16 sides of its point (:data:`SIDES`) for the whole film: the one that covers
the least ink and no other label. It is visible or hidden for at least :data:`HOLD` seconds. Ink is
how dark a small picture is whose pixels are cells.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sandbox.numeric import Array, Flags, Integers
from sandbox.picture.bounds import Camera, Rectangle
from sandbox.picture.geometry import XY
from sandbox.picture.instant import Instant
from sandbox.picture.listing import SIDES, Item, Listing

if TYPE_CHECKING:
    from sandbox.picture.typesetter import Typesetter  # loads pygame

HOLD = 0.35  # minimum time that a label is visible or hidden [s of the film]
CELL = 5.0  # side of the cells whose ink is measured [points]
TURNED, OFF, INK, HIDDEN, OTHER_TIP, CROSSED, OUTSIDE = 0.02, 0.5, 0.3, 0.4, 1.0, 2.0, 4.0
"""Costs per sample: angle to the arrow, standing off, black cell, part of an arrow, tip that is
nearer than its own, label, outside."""
PARTS = np.array([0.1, 0.3, 0.5, 0.7, 0.9])  # places along an arrow that labels leave visible
MAX_NUMBERS, SMALL_NUMBERS = 24, 6  # numbers in a picture, in a small or crowded one
SMALL, CROWDED = 500, 48  # width of a small picture [pixels], texts of a crowded one


@dataclass
class _Seen:
    """A label over the samples that are looked at."""

    item: Item
    key: int
    rows: Array  # point x, y, away x, y [samples, 4] finished pixels; NaN where absent
    words: str = ""

    @property
    def size(self) -> float:
        """The sum of the lengths of its arrow."""
        return float(np.nansum(np.hypot(*self.rows[:, 2:].T)))


def place_labels(out: Listing, camera: Camera, point: float, size: tuple[int, int],
                 stage: Rectangle, type_: Typesetter, letters: int, *, speed: float,
                 samples: Integers | None = None) -> None:
    """Write into items the sides of labels in ``stage``, and when they are shown."""
    time, cell = out.time, CELL * point
    instant = Instant(out, camera.enlarged(1 / cell), 1 / CELL,
                      (int(size[0] / cell) + 1, int(size[1] / cell) + 1), small=True)
    some = np.unique(np.linspace(0, len(time) - 1, 48).astype(int)) if samples is None \
        else samples
    seen, covered = _look(instant, some, type_, cell)
    placed = np.full((0, len(some), 4), np.nan)
    arrows = np.concatenate([np.zeros((len(some), 0, 2)), *(
        one.rows[:, None, :2] - PARTS[:, None] * one.rows[:, None, 2:]
        for one in seen if one.size > 0)], axis=1)
    tips = np.stack([one.rows[:, :2] for one in seen], axis=1) if seen else arrows
    count = sum(np.isfinite(one.rows[:, 0]).mean() for one in seen)
    small = size[0] < SMALL or count > CROWDED
    numbers, maximum = 0, SMALL_NUMBERS if small else MAX_NUMBERS
    for one in sorted(seen, key=lambda one: (one.item.get("rank", 1), -one.size)):
        is_number = "value" in one.item or one.item["k"] != "text"
        if is_number and numbers >= maximum:
            continue
        box = type_.half(one.words, letters)
        middles = np.array([one.rows[:, :2] + offset(side, box, one.item.get("clear", 0.0), point)
                            for side in range(len(SIDES))])
        boxes = np.concatenate((middles - box, middles + box), axis=2)
        present = np.isfinite(one.rows[:, 0])
        free = present & ~_outside(boxes, stage) & ~_meet(boxes[:, None], placed).any(axis=1)
        cost = _costs(one, boxes, placed, arrows, tips, covered, stage, cell)
        cost[free.sum(axis=1) < 0.25 * present.sum()] = np.inf  # a side with too little room
        side = int(np.argmin(cost))
        there = free[side] & np.isfinite(cost[side])
        if samples is None:
            there = steady(there, time[some], HOLD * speed)
        if not there.any():
            continue
        placed = np.concatenate([placed, np.where(there[:, None], boxes[side], np.nan)[None]])
        numbers += is_number
        nearest = np.searchsorted((some[:-1] + some[1:]) / 2, np.arange(len(time)))
        shown = out.varying(there[nearest], steady=True)
        if one.item["k"] == "text":
            one.item["side"], one.item["show"] = side, shown
        else:
            one.item.setdefault("labels", {})[one.key] = [side, shown]


def _look(instant: Instant, some: Integers, type_: Typesetter,
          cell: float) -> tuple[list[_Seen], Array]:
    """Each label in each sample, and sums of the costs of cells."""
    from sandbox.picture.frames import Pixels  # loads pygame

    seen: dict[tuple[int, int], _Seen] = {}
    painter = Pixels(instant.size, 1, type_)
    costs, key = list[Array](), None
    for row, sample in enumerate(some.tolist()):
        instant.go_to(float(instant.out.time[sample]))
        before, key = key, instant.key()
        if key == before:
            costs.append(costs[-1])
            for one in seen.values():
                one.rows[row] = one.rows[row - 1]
            continue
        for label in instant.labels():
            one = seen.setdefault((id(label.item), label.key), _Seen(
                label.item, label.key, np.full((len(some), 4), np.nan)))
            one.words = max(one.words, label.words, key=len)
            one.rows[row] = cell * np.array([*label.point, *label.away])
        costs.append(INK * (1 - painter.grey(instant) / 255))
    covered = np.pad(costs, ((0, 0), (1, 0), (1, 0)))
    return list(seen.values()), covered.cumsum(axis=1).cumsum(axis=2)


def _costs(one: _Seen, boxes: Array, placed: Array, arrows: Array, tips: Array,
           covered: Array, stage: Rectangle, cell: float) -> Array:
    """What each side costs in all samples together."""
    cells = (np.nan_to_num(np.clip(boxes, -1e6, 1e6)) // cell).astype(int)
    x0, y0, x1, y1 = np.moveaxis(cells, 2, 0)
    x0, x1 = (np.clip(v, 0, covered.shape[2] - 1) for v in (x0, x1 + 1))
    y0, y1 = (np.clip(v, 0, covered.shape[1] - 1) for v in (y0, y1 + 1))
    rows = np.arange(covered.shape[0])[None]
    cost = (covered[rows, y1, x1] - covered[rows, y0, x1] - covered[rows, y1, x0]
            + covered[rows, y0, x0])
    cost += HIDDEN * ((arrows > boxes[:, :, None, :2]) & (arrows < boxes[:, :, None, 2:])).all(
        axis=3).sum(axis=2)
    if one.size > 0:
        own = _gap(boxes, one.rows[:, None, :2]) - 1.0
        cost += OTHER_TIP * (_gap(boxes, tips) < own).sum(axis=2)
    cost += CROSSED * _meet(boxes[:, None], placed[None]).sum(axis=1)
    cost += OUTSIDE * _outside(boxes, stage)
    away = one.rows[:, 2:4]
    size = np.hypot(*away.T)
    unit = away / np.where(size > 0, size, 1.0)[:, None]
    cost += np.array([TURNED * (1 - unit @ (dx, -dy)) + OFF * (far > 0) for dx, dy, far in SIDES])
    return np.asarray(np.where(np.isfinite(one.rows[:, 0]), cost, 0.0).sum(axis=1))


def _gap(boxes: Array, points: Array) -> Array:
    """Distances of boxes [sides, samples, 4] to points [samples, k, 2], [sides, samples, k]."""
    low, high = boxes[:, :, None, :2] - points, points - boxes[:, :, None, 2:]
    return np.asarray(np.hypot(*np.moveaxis(np.maximum(np.maximum(low, high), 0.0), -1, 0)))


def _outside(boxes: Array, stage: Rectangle) -> Flags:
    return np.asarray((boxes[..., :2] < stage[:2]).any(axis=-1)
                      | (boxes[..., 2:] > stage[2:]).any(axis=-1))


def _meet(a: Array, b: Array) -> Flags:
    """Whether boxes [..., 4] overlap; absent ones (NaN) do not."""
    return np.asarray((a[..., 0] < b[..., 2]) & (b[..., 0] < a[..., 2])
                      & (a[..., 1] < b[..., 3]) & (b[..., 1] < a[..., 3]))


def steady(there: Flags, time: Array, least: float) -> Flags:
    """The flags without inner gaps, then without inner stays, shorter than ``least`` [s]."""
    found = there.copy()
    for wanted in (False, True):
        edges = np.flatnonzero(np.diff(found.astype(int), prepend=-1, append=-1))
        for a, b in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
            if found[a] == wanted and a > 0 and b < len(found) and time[b] - time[a] < least:
                found[a:b] = not wanted
    return found


def offset(side: int, half: tuple[float, float], clear: float, point: float) -> XY:
    """From a label's point to its middle [pixels], for half its size; ``clear`` is in points."""
    dx, dy, far = SIDES[side]
    reach = (3 + far + clear) * point
    return dx * (half[0] + reach), -dy * (half[1] + reach)

