"""Input of a display list: the run, its visible layers and its scales."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sandbox.model.model import NONE
from sandbox.numeric import Array, Flags
from sandbox.picture.listing import Item, Listing, Number, Point, RunData, nearest, short
from sandbox.picture.palette import TOKENS, Colour, css, glyph
from sandbox.picture.scales import ForceScale, Tensions, prefixed
from sandbox.scene.layers import PASSES, meant, shown
from sandbox.scene.settings import View
from sandbox.values.appearance import depth

BEHIND, ABOVE = -math.inf, math.inf  # planes behind all bodies and in front of them
INKS = {token: [css(day), css(night)] for token, (day, night) in TOKENS.items()}
ORDER = {name: k for k, name in enumerate(PASSES)}


def visible_layers(run: RunData, view: View) -> dict[str, list[int]]:
    """The layers that a view shows of a run, with their bodies."""
    return {layer: meant(patterns, run.mechanism.bodies)
            for layer, patterns in shown(view.show, traced=bool(view.traces)).items()}


@dataclass
class Subject:
    """A run with the list that its elements are added to."""

    run: RunData
    view: View
    layers: dict[str, list[int]]  # those that are shown, with their bodies
    out: Listing
    carried: Tensions  # tensions, and the scale of their colours
    force: ForceScale  # of contact forces
    width: float  # of the picture [m]
    point: float  # metres per point
    beside: Sequence[RunData] = ()  # other runs with the same scales
    moments: Sequence[float] | None = None  # the times that are painted [s], if they are few
    arrows: dict[str, tuple[str, str, str, Sequence[float], ForceScale]] = field(
        default_factory=dict)
    """Arrows in the legend by layer: token, unit, words, size and scale."""
    trace_ink: str = ""  # token of the first trace
    signs: set[str] = field(default_factory=set)  # glyphs that a legend may explain, see ROWS
    keys: list[tuple[float, float, float]] = field(default_factory=list)  # order of the items

    def __post_init__(self) -> None:
        bodies, fixed = self.run.mechanism.bodies, self.run.model.bodies.fixed.tolist()
        self.depths = [depth(body.plane) for body in bodies]
        self.lowest = min((deep for deep, stays in zip(self.depths, fixed, strict=True)
                           if not stays), default=0)
        """The plane of the lowest body that moves."""
        self.out.inks |= INKS

    def ink(self, day: Colour, night: Colour) -> str:
        """The token of a colour."""
        token = css(day)
        self.out.inks[token] = [token, css(night)]
        return token

    def plane(self, *bodies: int) -> float:
        """Where an element on these bodies lies: in the uppermost of their planes."""
        return max((self.depths[body] for body in bodies), default=self.lowest)

    def add(self, step: str, kind: str, name: str = "", *, plane: float = ABOVE, rank: float = 0,
            layer: str = "", shown: Number | None = None, **fields: Any) -> None:
        """Add an item of a pass (see :data:`sandbox.scene.layers.PASSES`) if its layer is shown.

        It is visible where ``shown`` is not 0. ``written`` are a typical value and the unit of its
        numbers. Items are sorted by plane, pass and ``rank``; of
        texts and arrows, which lie above all, ``rank`` is the order in which labels are placed.
        """
        if "s" in fields:
            style = self.out.style
            fields["s"] = [style(*each) for each in fields["s"]] if isinstance(
                fields["s"], list) else style(*fields["s"])
        for each in [fields["g"]] if isinstance(fields.get("g"), str) else fields.get("g", ()):
            self.signs.add(glyph(self.out, each))
        if "written" in fields:
            fields |= zip(("factor", "unit", "decimals"), prefixed(*fields.pop("written")),
                          strict=True)
        layer = layer or PASSES[step]
        if layer not in self.layers:
            return
        if math.isfinite(plane):
            plane = max(plane, self.lowest)
        if kind in ("text", "arrows"):
            fields["rank"], plane = rank, ABOVE
        self.keys.append((plane, ORDER[step], rank))
        item: Item = {"k": kind, "l": layer, "n": name or None, **fields, "if": shown}
        self.out.items.append({key: value for key, value in item.items() if value is not None})

    def number(self, step: str, name: str, at: Point, values: Array, largest: float, unit: str, *,
               steady: bool = False, token: str = "drive", words: str = "", **fields: Any) -> None:
        """Add a number beside a point, with decimals for the ``largest`` value."""
        self.add(step, "text", name, at=at, words=words, written=(largest, unit),
                 value=self.out.column(values, steady=steady), s=("", token), **fields)

    def patterns(self, layer: str) -> Sequence[str]:
        """Names and patterns of the bodies that a layer is shown of."""
        return shown(self.view.show, traced=bool(self.view.traces)).get(layer, ())

    def painted(self) -> Any:
        """The painted samples."""
        return slice(None) if self.moments is None else nearest(self.run.time, self.moments)

    def largest_arrow(self, table: str) -> float:
        """The largest arrow of a table in the painted samples."""
        rows = self.out.tables.get(table, np.zeros((0, 6)))
        if self.moments is not None:
            rows = rows[np.isin(rows[:, 0], self.painted())]
        return float(np.hypot(rows[:, 4], rows[:, 5]).max(initial=0.0))

    def close(self) -> None:
        """Sort the list back to front."""
        order = sorted(range(len(self.keys)), key=self.keys.__getitem__)
        self.out.items = [self.out.items[k] for k in order]
        self.keys = []

    def held(self, *bonds: int) -> list[int] | None:
        """A column that is 1 while all of these hold; None if nothing of them can be released."""
        found = [bond for bond in bonds if bond != NONE]
        return self.out.column((self.run.arrays["held"][:, found] != 0).all(axis=1),
                               steady=True) if found else None

    def on(self, body: int, at: Iterable[float]) -> Point:
        """A point of a body, or of another frame."""
        return [int(body), *map(short, at)]

    def during(self, there: Flags) -> Number | None:
        """When an item is shown that is there in some samples; None if it is in all."""
        return None if there.all() else self.steady(there)

    def steady(self, values: Array | Flags) -> Number:
        """Values that painters do not interpolate, as a column, or as the number that they are."""
        return self.out.varying(values, steady=True)
