"""Tendons in poses: spans between guides, wheels that a tendon lifts off."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sandbox.elements.element import GRAZE
from sandbox.model.model import Model, Tendons
from sandbox.numeric import Flags
from sandbox.scene.geometry import Vec


class CableSpan(NamedTuple):
    """A piece of a tendon from one guide that holds it to the next, or to an end."""

    tendon: int
    guides: tuple[int, ...]  # numbers in order; the first and the last one hold it, or are ends
    into: int  # which of Tendons.grips feeds it; -1 at an end
    out_of: int  # which of them takes from it; -1 at an end


def spans_of(tendons: Tendons, tendon: int) -> list[CableSpan]:
    """The spans of a tendon in its order, of a loop from its first guide that holds it; or none."""
    grips = tendons.gripped(tendon).tolist()
    if not grips:
        return []
    path = tendons.guides(tendon)
    held = tendons.grips[grips].tolist()
    between = [CableSpan(tendon, tuple(range(a, b + 1)), grips[k], grips[k + 1])
               for k, (a, b) in enumerate(itertools.pairwise(held))]
    if tendons.closed[tendon]:
        on = (*range(held[-1], path.stop - 1), *range(path.start, held[0] + 1))
        return [*between, CableSpan(tendon, on, grips[-1], grips[0])]
    return [CableSpan(tendon, tuple(range(path.start, held[0] + 1)), -1, grips[0]), *between,
            CableSpan(tendon, tuple(range(held[-1], path.stop)), grips[-1], -1)]


def lifted_at_start(model: Model) -> Flags:
    """Of every guide whether its tendon is off it at t = 0, [ng].

    By default it is off a wheel that is clear of the straight path, a loop is on its wheels.
    """
    tendons = model.tendons
    off = np.zeros(len(tendons.guide_body), dtype=bool)
    for tendon in range(len(tendons.name)):
        path, guides = tendons.guides(tendon), model.mechanism.tendons[tendon].guides
        default = "on" if tendons.closed[tendon] else "off"
        loose = [g for g in tendons.wheels[tendons.loose(tendon)].tolist()
                 if (guides[g - path.start].begins or default) == "off"]
        at = {g: model.at_start(tendons.guide_body[g], tendons.guide_at[g])
              for g in range(path.start, path.stop)} if loose else {}
        found = True
        while found:
            found = False
            for wheel in loose:
                before = max(g for g in range(path.start, wheel) if not off[g])
                after = min(g for g in range(wheel + 1, path.stop) if not off[g])
                three = [before, wheel, after]
                if not off[wheel] and passes_by(
                        [at[g] for g in three], tendons.guide_radius[three].tolist()
                        ) > GRAZE * abs(tendons.guide_radius[wheel]):
                    off[wheel] = found = True
    return off


def passes_by(centres: list[Vec], radii: Sequence[float]) -> float:
    """Gap of a tendon of two wheels and one between them [m], < 0 where it bends; signed radii."""
    (ax, ay), (cx, cy), (bx, by) = centres
    dx, dy, offset = bx - ax, by - ay, radii[0] - radii[2]
    square = dx * dx + dy * dy
    if square <= offset * offset:
        return -math.inf
    straight = math.sqrt(square - offset * offset)
    ux, uy = (straight * dx + offset * dy) / square, (straight * dy - offset * dx) / square
    across = ux * (cy - ay) - uy * (cx - ax) - radii[0]
    return float(-math.copysign(1.0, radii[1]) * across - abs(radii[1]))
