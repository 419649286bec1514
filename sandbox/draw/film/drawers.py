"""All that draws a run: of each pass over the picture the drawer."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import pygame

from sandbox.draw.film.annotations import AxesDrawer, BarDrawer, GridDrawer
from sandbox.draw.film.bars import PinnedBar
from sandbox.draw.film.belts import BeltDrawer
from sandbox.draw.film.bodies import BodyDrawer
from sandbox.draw.film.body_names import NameDrawer
from sandbox.draw.film.canvas import Canvas, Moment
from sandbox.draw.film.drives import DRIVE_LENGTH, DriveDrawer
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.fluids import FluidDrawer
from sandbox.draw.film.forces import ContactDrawer
from sandbox.draw.film.joints import JointDrawer, draw_ground, ground_spots, joined_points
from sandbox.draw.film.latches import LatchDrawer
from sandbox.draw.film.loads import LOAD_LENGTH, LoadDrawer, draw_liquids
from sandbox.draw.film.marked import marked, traced
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.pressure import PressureDrawer
from sandbox.draw.film.scales import ForceScale
from sandbox.draw.film.springs import SpringDrawer
from sandbox.draw.film.stalks import StalkDrawer
from sandbox.draw.film.tendons import TendonDrawer
from sandbox.draw.film.tensions import Tensions
from sandbox.draw.film.traces import TraceDrawer
from sandbox.draw.film.vectors import VectorDrawer, accelerations, reactions, velocities
from sandbox.scene.layers import LAYERS, PASSES, Show, meant, shown
from sandbox.scene.settings import View

Draw = Callable[[Canvas, Moment], None]
FAR_FOOT = 16.0
"""Points farther than this beside a fixed body's shapes get a ground symbol [points]."""
SAMPLED = ("traces", "velocity", "acceleration", "reactions", "bars", "pressure")
"""Layers whose looks hang on the sample, whatever the poses."""


class VisibleLayers:
    """What a view shows of a run: which layers, and of which bodies."""

    def __init__(self, run: Filmed, view: View) -> None:
        self._shown: Show = shown(view.show, traced=bool(view.traces))
        self._of = {layer: meant(patterns, run.mechanism.bodies)
                    for layer, patterns in self._shown.items() if LAYERS[layer].per_body}

    def __contains__(self, layer: str) -> bool:
        return layer in self._shown

    def of(self, layer: str) -> list[int]:
        """The bodies that a layer is shown of."""
        return self._of.get(layer, [])

    def patterns(self, layer: str) -> tuple[str, ...]:
        """The same as it was asked for."""
        return self._shown.get(layer, ())


class Drawers:
    """Draws what stays once, and what moves for every moment, back to front."""

    def __init__(self, run: Filmed, view: View, canvas: Canvas, *, layers: VisibleLayers,
                 carried: Tensions, bars: list[PinnedBar], scale: ForceScale, width: float,
                 beside: Sequence[Filmed] = ()) -> None:
        """``width`` of what is shown [m]; with a body that is followed nothing stays.

        Runs ``beside`` this one have the same scales.
        """
        self._run, self._layers, self._view = run, layers, view
        self._carried = carried if "tensions" in layers else carried.hidden()
        self.pool, self.still = PointPool(), PointPool()
        self._back(canvas)
        model, pool = run.model, self.pool
        self._stalks = StalkDrawer(model, pool, layers.of("bodies"))
        self._joints = JointDrawer(run, self._carried, pool)
        self._springs = SpringDrawer(run, pool)
        self._latches = LatchDrawer(run, pool)
        self._belts = BeltDrawer(run)
        self.fluids = FluidDrawer(run, pool, beside)
        self._tendons = TendonDrawer(run, self._carried, pool)
        self.contacts = ContactDrawer(run, scale, layers.of("contacts"))
        self.drives = DriveDrawer(run, pool, DRIVE_LENGTH * width, scale, beside)
        self.loads = LoadDrawer(run, pool, LOAD_LENGTH * width, scale, layers.of("loads"), beside)
        self.traces = TraceDrawer(run, traced(run, view, layers.patterns("traces")), pool, canvas,
                                  layers.of("body_names"))
        self.vectors = dict(self._vectors(width))
        self.pressure = PressureDrawer(run, layers.of("pressure"), width)
        self._bars = BarDrawer(bars, carried, pool)
        self._axes = AxesDrawer(layers.of("axes"), pool)
        self._names = NameDrawer(run, layers.of("body_names"))
        pool.close()
        self.still.close()
        table = self._table()
        self._passes = [table[name] for name, layer in PASSES.items() if layer in layers]

    def _back(self, canvas: Canvas) -> None:
        """What stays: liquids, a grid, fixed bodies; grounds, and the bodies that move."""
        model, layers = self._run.model, self._layers
        joined = joined_points(model)
        pool = self.pool if self._view.follow else self.still
        self._fixed = BodyDrawer(model, pool, canvas, moving=False, joined=joined,
                                 shown=layers.of("bodies"))
        self._grounds = ground_spots(model, self.pool,
                                     FAR_FOOT * canvas.unit / canvas.camera.scale)
        self._bodies = BodyDrawer(model, self.pool, canvas, moving=True, joined=joined,
                                  shown=layers.of("bodies"))
        self._grid = GridDrawer(canvas)

    def _vectors(self, width: float) -> Iterator[tuple[str, VectorDrawer]]:
        """Arrows on wish, by their layers."""
        run, layers = self._run, self._layers
        for layer, made in (("velocity", velocities), ("acceleration", accelerations)):
            if layer in layers:
                places = marked(run, self._view, layers.patterns(layer))
                yield layer, VectorDrawer(run, made(run, places), self.pool, width)
        if "reactions" in layers:
            yield "reactions", VectorDrawer(run, reactions(run, layers.of("reactions")),
                                           self.pool, width)

    def _table(self) -> dict[str, Draw]:
        """What draws each of :data:`PASSES` that this view may show."""
        joints = self._joints
        return {
            "rails": lambda canvas, at: joints.draw_grooves(canvas, at, rails=True),
            "stalks": self._stalks.draw,
            "links": joints.draw_links,
            "bodies": self._bodies.draw,
            "grooves": lambda canvas, at: joints.draw_grooves(canvas, at, rails=False),
            "wheels": self._tendons.draw_wheels,
            "belts": self._belts.draw,
            "bars": self._bars.draw,
            "traces": self.traces.draw,
            "fluids": self.fluids.draw,
            "springs": self._springs.draw,
            "stops": joints.draw_stops,
            "grounds": lambda canvas, at: draw_ground(canvas, at, self._grounds),
            "marks": self.drives.draw_marks,
            "latches": self._latches.draw,
            "pins": joints.draw_pins,
            "cords": self._tendons.draw,
            "axes": self._axes.draw,
            "pressure": self.pressure.draw,
            "contacts": self.contacts.draw,
            "told": joints.tell,
            "loads": self.loads.draw,
            **{layer: drawer.draw for layer, drawer in self.vectors.items()},
            "drives": self.drives.draw,
            "body_names": self._names.draw,
        }

    def seen(self, samples: Sequence[int]) -> set[str]:
        """What comes and goes and is there in any of the samples: cords that hang, stops."""
        there = {"slack": self._tendons.slack(samples), "stop": self._joints.stopped(samples)}
        return {name for name, found in there.items() if found}

    def draw_still(self, canvas: Canvas, moment: Moment, stage: pygame.Rect) -> None:
        """What stays where it is on the picture, unless that follows a body."""
        if "loads" in self._layers:
            draw_liquids(canvas, self._run)
        if "coordinates" in self._layers:
            self._grid.draw(canvas, stage)
        if "bodies" in self._layers:
            self._fixed.draw(canvas, moment)

    def draw(self, canvas: Canvas, moment: Moment, stage: pygame.Rect) -> None:
        """Everything that moves, back to front."""
        if self._view.follow:
            self.draw_still(canvas, moment, stage)
        for draw in self._passes:
            draw(canvas, moment)
        if "coordinates" in self._layers:
            self._grid.write(canvas, stage)

    def key(self, canvas: Canvas, moment: Moment) -> bytes:
        """Equal for moments that look the same, besides poses and drives."""
        parts = [self._tendons.key(moment), self._joints.key(moment), self.fluids.key(moment),
                 self._belts.key(moment), self.loads.key(canvas, moment),
                 self.drives.key(moment), self.contacts.key(canvas, moment)]
        if any(layer in self._layers for layer in SAMPLED):
            parts.append(str(moment.sample).encode())
        return b"".join(parts)
