"""One picture of a run at any time, from its recording alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.draw.film import clip, legend
from sandbox.draw.film.bars import bars_of
from sandbox.draw.film.bounds import body_box, drift, whole_box
from sandbox.draw.film.camera import (
    Camera,
    Rectangle,
    Stage,
    needed_height,
    place_camera,
    width_shown,
)
from sandbox.draw.film.canvas import Canvas, Moment, picture_unit, type_size
from sandbox.draw.film.cells import Cells
from sandbox.draw.film.drawers import Drawers, VisibleLayers
from sandbox.draw.film.filmed import Metered, frame_times
from sandbox.draw.film.finger_names import Covered, Name, place_names
from sandbox.draw.film.headline import HEAD, Headline
from sandbox.draw.film.labels import place_labels
from sandbox.draw.film.linework import Linework
from sandbox.draw.film.marked import finger_names
from sandbox.draw.film.meters import MeterPanel
from sandbox.draw.film.palette import BACKGROUND, FAINT_INK, HAIRLINE, Colour
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.scales import ForceScale, force_scale, shared
from sandbox.draw.film.sheet import Hair, Sheet, Text, WrittenFace, new_surface
from sandbox.draw.film.tensions import tensions_of
from sandbox.draw.film.typesetter import Typesetter
from sandbox.numeric import Array
from sandbox.scene.settings import View

Pixels = NDArray[np.uint8]
REACH = 6.0
"""Points around pooled points that a pin or an outline may touch."""
LEGEND = (0.3, 0.5)
"""Of a picture's height, at most; the second on paper, where letters have a least size."""
STANDS = 0.2
"""A film stands where nothing moves by more than a pixel from so long before to after [s of it]."""
NAME_SAMPLES = 24
"""Samples looked at for where a finger's name is in nobody's way."""
COLOUR = np.uint32(0xFFFFFF)
"""The fourth byte of a word is anything."""
SIGNS = np.array([-1.0, -1.0, 1.0, 1.0])
SHAPES = (0.2, 1.5)
"""Least and largest height of the motion in its width, where the picture is as high as it needs."""
MOST_PIXELS = 60_000_000
"""Of the enlarged picture; very large pictures are enlarged less."""


class FrameRenderer:
    """Draws frames of a run, enlarged and scaled down so that edges are smooth.

    Args:
        run: the recording.
        size: width and height [pixels]; the scene's view by default.
        view: what to show instead of the scene's view.
        enlarge: how many times larger a frame is drawn before it is scaled down; a power
            of 2, for others pygame's scaling greys white.
        note: a few words beside the time stamp.
        unit: pixels per point, of which lines and type have so many; by ``size`` if left out.
        bare: without title, time and legend.
        scales: of title, time and legend the scales alone.
        least: no type is smaller [pixels, as a typesetter counts it].
        moments: the only times [s] that are drawn, each for itself, to which a picture of bodies
            that the view names is fitted; by default all of the run, as a film.
        beside: runs that are compared with this one, with which it shares its scales.
    """

    def __init__(self, run: Metered, *, size: tuple[int, int] | None = None,
                 view: View | None = None, enlarge: int = 2, note: str = "",
                 unit: float | None = None, bare: bool = False,
                 scales: bool = False, least: int = 0,
                 moments: Sequence[float] | None = None,
                 beside: Sequence[Metered] = ()) -> None:
        self.run, self._beside = run, beside
        self.view = view or run.mechanism.view
        self.size = size or self.view.size
        self.unit = unit or picture_unit(self.size)
        while enlarge > 1 and self.size[0] * self.size[1] * enlarge**2 > MOST_PIXELS:
            enlarge //= 2
        self.enlarged = enlarge
        self._note, self._moments = note, moments
        self._bare, self._scales = bare or scales, scales
        self._type = Typesetter(type_size(self.unit), least)
        self._lay_out()
        self._build()

    def _lay_out(self) -> None:
        """Header, legend, meters and between them the stage; then the camera."""
        run, (width, height) = self.run, self.size
        self.layers = VisibleLayers(run, self.view)
        self._bars = bars_of(run, self.layers.of("bars"))
        self._carried = tensions_of(run, self._bars).beside(
            tensions_of(each, bars_of(each, VisibleLayers(each, self.view).of("bars")))
            for each in self._beside)
        bodies = body_box(run, self.view, self._moments)
        across = width_shown(bodies, width / height, self.view.width)
        self._scale = shared(force_scale(each, across, self.view) for each in (run, *self._beside))
        shown = self._scale if "contacts" in self.layers else ForceScale(0.0, 0.0)
        box = whole_box(run, bodies, shown, across, self.view, self._moments)
        self._box = box
        self._across = width_shown(box, width / height, self.view.width)
        self._row = round(1.5 * self._type.size)
        self._pad = round(0.8 * self._type.size)
        self._title = self._headline()
        self._head = self._title.high if self._title else 0
        keyed = self._scales or not self._bare
        share = LEGEND[1] if self._type.least else LEGEND[0]
        most = max(0, int(share * height / self._row)) if keyed else 0
        probe = Canvas(new_surface(1, 1), Camera(1.0, (0.0, 0.0), (0.0, 0.0)), self.unit, 1)
        self.content = legend.content(run, self.layers, self._drawers(probe), self._carried,
                                      self._scale, self._drawn_samples())
        self._panel = MeterPanel(run, self.view, self._type, self.unit, self.size)
        rows = 1 if keyed else 0
        for _ in range(3):
            foot = rows * self._row + (self._pad if rows else 0)
            self._place_camera(box, foot)
            self._legend = legend.arrange(
                legend.items_for(self.content, self.camera.scale, self.unit,
                                 scales=self._scales), self._type,
                self.unit, width - 2 * self._pad, most)
            if len(self._legend) <= rows:
                break
            rows = len(self._legend)

    def _drawn_samples(self) -> list[int]:
        """Those nearest to the moments that are drawn, or to the frames of a film."""
        view, time = self.view, self.run.time
        if self._moments is None and time[-1] / view.speed * view.fps > len(time):
            return list(range(len(time)))
        times = np.asarray(self._moments if self._moments is not None else frame_times(
            self.run, fps=view.fps, speed=view.speed, start=view.start))
        i = np.clip(np.searchsorted(time, times) - 1, 0, max(len(time) - 2, 0))
        j = np.minimum(i + 1, len(time) - 1)
        nearest: list[int] = np.unique(np.where(times - time[i] > time[j] - times, j, i)).tolist()
        return nearest

    @property
    def needs(self) -> float:
        """How high the picture has to be for what it shows to fill its width [pixels].

        Of a window of ``centre`` and ``width`` it shows as much as the view's size does.
        """
        wide, view = self.size[0], self.view
        share = self._box.height / max(self._box.width, 1e-9)
        if view.centre and view.width:
            share = view.size[1] / view.size[0]
        around = self._head + self._panel.below + (
            len(self._legend) * self._row + self._pad if self._legend else 0)
        return around + wide * float(np.clip(share, *SHAPES))

    def _place_camera(self, box: Rectangle, foot: float) -> None:
        """Where the motion is larger, with the meters below it or beside it.

        A window that the view asks for is kept whole beside meters as above them: what it shows
        without any.
        """
        (width, height), panel = self.size, self._panel
        panel.shrink()
        high = height - self._head - foot

        def camera_on(stage: Stage) -> Camera:
            asked = self.view.width
            if asked is not None:
                asked *= max(1.0, max(8, high) * stage.width / (width * stage.height))
            return place_camera(box, stage, centre=self.view.centre, width=asked)

        below = Stage(0, self._head, width, max(8, high - panel.below))
        self.camera, self._aside = camera_on(below), False
        if panel and panel.tall <= high:
            beside = camera_on(Stage(0, self._head, max(8, width - panel.beside), high))
            if beside.scale > self.camera.scale:
                self.camera, self._aside = beside, True
        if panel and not self._aside and self.view.width is None:
            panel.grow(below.height - needed_height(box, self.camera))
            self.camera = camera_on(Stage(0, self._head, width, max(8, high - panel.below)))

    def _drawers(self, canvas: Canvas) -> Drawers:
        return Drawers(self.run, self.view, canvas, layers=self.layers, carried=self._carried,
                       bars=self._bars, scale=self._scale, width=self._across,
                       beside=self._beside)

    def _build(self) -> None:
        """Surfaces, drawers, and everything that stays, drawn once."""
        width, height = self.size
        run, k = self.run, self.enlarged
        self._large, self._small = new_surface(width * k, height * k), new_surface(width, height)
        self._still_camera = self.camera.magnified(k)
        self._canvas = Canvas(self._large, self._still_camera, self.unit * k, k)
        self._drawn_by = drawers = self._drawers(self._canvas)
        self._pool, self._drift = drawers.pool, drift(run, self.view)
        sizes = np.abs(run.arrays["drive_value"]).max(axis=0, initial=0.0)
        self._drive_sizes = np.where(sizes > 0, sizes, 1.0)
        gap = self._pad // 2 if self._legend or not self._bare else 0
        self._foot = max(height - len(self._legend) * self._row - gap, self._head + 2)
        bottom, panel = self._foot - gap, self._panel
        beside, below = (panel.beside, 0) if self._aside else (0, panel.below)
        self._stage = pygame.Rect(0, self._head, width - beside, bottom - below - self._head)
        panel.settle(pygame.Rect(self._stage.right, self._head, beside, bottom - self._head)
                     if self._aside else pygame.Rect(0, self._stage.bottom, width, below),
                     aside=self._aside)
        self._cells = Cells(self._stage)
        self._draw_still()
        for zone in ((0, 0, width, self._head), (0, self._stage.bottom, width, height),
                     panel.rect):
            self._large.fill(BACKGROUND, [v * k for v in zone])
        self._panel_words = panel.draw_still(self._canvas)
        words = self._draw_surround()
        pygame.transform.smoothscale(self._large, self.size, self._small)
        for word in words:
            word.paint(self._small)
        self._large_still, self._small_still = self._large.copy(), self._small.copy()
        self._redrawn: list[pygame.Rect] = []
        self._written: list[pygame.Rect] = []
        self._stamped = pygame.Rect(0, 0, 0, 0)
        self._drawn: bytes | None = None
        self._names: list[Name] = []
        if "names" in self.layers:
            self._place_names()

    def _draw_still(self) -> None:
        """What stays, unless the picture goes with a body."""
        if not self.view.follow:
            still = self._moment(self._drawn_by.still, float(self.run.time[0]))
            self._drawn_by.draw_still(self._canvas, still, self._stage)

    def _draw_surround(self) -> list[Text]:
        """Title and legend; their texts are told."""
        canvas, k, width = self._canvas, self.enlarged, self.size[0]
        if self._legend and not self._bare:
            y = (self._foot - self._pad // 2) * k
            clip.line(canvas.surface, HAIRLINE, (self._pad * k, y),
                      ((width - self._pad) * k, y), canvas.width(1))
        words = legend.draw_rows(canvas, self._type, self._legend, self._pad, self._foot, self._row)
        return [*words, *(self._title.texts(self._type, self._pad) if self._title else ())]

    def _headline(self) -> Headline | None:
        """The title beside the time."""
        if self._bare:
            return None
        stamp = self._stamp(float(self.run.time[-1]))
        room = self.size[0] - 3 * self._pad - self._type.width(stamp)
        mechanism = self.run.mechanism
        return Headline.of(mechanism.title or mechanism.name, self._type, room,
                           self._type.scaled(1.25), self.size[1])

    def _place_names(self) -> None:
        """Where the names of fingers go: on nothing that a sample of the run draws."""
        poses, k = self.run.arrays["body_pose"], self.enlarged
        names = finger_names(self.run.model)
        if not names:
            return
        bodies = [body for _, body in names]
        samples: dict[bytes, Array] = {}  # a mechanism at rest is drawn once
        covered = Covered(self._stage, self.unit)
        for s in np.unique(np.linspace(0, len(poses) - 1, NAME_SAMPLES).astype(int)).tolist():
            moment = self._moment(self._pool, float(self.run.time[s]))
            if (key := self._key(moment)) in samples:
                continue
            samples[key] = self._seen_at(moment.pose[bodies, :2])
            self._large.blit(self._large_still, (0, 0))
            self._draw_moving(moment)
            words = pygame.surfarray.pixels2d(self._large)[k // 2::k, k // 2::k].T & COLOUR
            covered.add(words != words[0, 0])
            self._canvas.clear()
        self._large.blit(self._large_still, (0, 0))
        self._names = place_names(
            names, np.array(list(samples.values())), covered,
            lambda text: self._name_face(text).get_size(), self.unit)

    def _seen_at(self, points: Array) -> Array:
        """Where points of the world [m] are on the finished picture, which may go along."""
        return self._canvas.camera.to_pixels(points) / self.enlarged

    def _name_face(self, text: str) -> WrittenFace:
        return self._type.render(text, colour=FAINT_INK, halo=True)

    def _stamp(self, t: float) -> str:
        note = f"{self._note}   " if self._note else ""
        return f"{note}t = {t:.3f} s"

    def _moment(self, pool: PointPool, t: float) -> Moment:
        """Poses and drives between samples, everything else from the nearest sample."""
        time, arrays = self.run.time, self.run.arrays
        i = int(np.clip(np.searchsorted(time, t) - 1, 0, max(len(time) - 2, 0)))
        j = min(i + 1, len(time) - 1)
        w = float(np.clip((t - time[i]) / (time[j] - time[i]), 0, 1)) if j > i else 0.0
        pose = (1 - w) * arrays["body_pose"][i] + w * arrays["body_pose"][j]
        drives = (1 - w) * arrays["drive_value"][i] + w * arrays["drive_value"][j]
        world = pool.world(pose)
        self._go_along((1 - w) * self._drift[i] + w * self._drift[j])
        pixels = self._canvas.camera.to_pixels(world)
        return Moment(j if w > 0.5 else i, t, pose, drives, world, pixels, pixels.tolist())

    def _go_along(self, way: Array) -> None:
        """Move the camera ``way`` [m] from where it was at t = 0."""
        still, canvas = self._still_camera, self._canvas
        x, y = (float(v) for v in way)
        canvas.camera = Camera(still.scale, (still.centre[0] + x, still.centre[1] + y), still.pixel)
        canvas.drift = (-still.scale * x, still.scale * y)

    def draw(self, t: float) -> Pixels:
        """The picture at ``t`` [s]: (height, width, 3), red, green, blue.

        Times outside of the recording show its first or last sample.
        """
        return self.draw_packed(t).view(np.uint8).reshape(*self.size[::-1], 4)[..., :3]

    @property
    def tension_colours(self) -> tuple[Colour, ...]:
        """Colours of tensions that may occur, which a palette of few colours is to keep."""
        return self._carried.colours

    def draw_packed(self, t: float) -> NDArray[np.uint32]:
        """The picture at ``t`` [s] as (height, width) words of red + 256 green + 65536 blue."""
        stands = self._stands(t)
        moment = self._moment(self._pool, t)
        key = self._key(moment) + bytes([stands])
        if key != self._drawn:
            self._restore()
            self._draw_moving(moment)
            self._redrawn = self._cells.mark(self._boxes(moment))
            self._scale_down()
            lines = Linework.of(self._small) if stands else None
            self._written = [label.paint(self._small) for label in self._labels(moment, lines)]
            self._drawn = key
        self._draw_meters(t)
        self._write_stamp(t)
        words: NDArray[np.uint32] = pygame.surfarray.pixels2d(self._small).T & COLOUR
        return words

    def _restore(self) -> None:
        """Put back what the last frame covered."""
        k = self.enlarged
        areas = [(rect.x * k, rect.y * k, rect.w * k, rect.h * k) for rect in self._redrawn]
        self._large.blits([(self._large_still, area, area) for area in areas], doreturn=False)
        self._small.blits([(self._small_still, rect, rect)
                           for rect in self._redrawn + self._written], doreturn=False)
        self._canvas.clear()

    def _draw_moving(self, moment: Moment) -> None:
        """Everything that moves, back to front."""
        surface = self._canvas.surface
        surface.set_clip([v * self.enlarged for v in self._stage])
        self._drawn_by.draw(self._canvas, moment, self._stage)
        surface.set_clip(None)

    def _boxes(self, moment: Moment) -> Array:
        """What the frame covers: left, top, right, bottom [k, 4] in finished pixels."""
        if self.view.follow:
            stage = self._stage
            return np.array([(stage.left, stage.top, stage.right, stage.bottom)], dtype=float)
        boxes = self._pool.boxes(moment.pixels) + REACH * self._canvas.unit * SIGNS
        if self._canvas.touched:
            boxes = np.concatenate((boxes, np.array(self._canvas.touched)))
        return boxes / self.enlarged

    def _scale_down(self) -> None:
        k = self.enlarged
        for rect in self._redrawn:
            source = self._large.subsurface([v * k for v in rect])
            pygame.transform.smoothscale(source, rect.size, self._small.subsurface(rect))

    def _key(self, moment: Moment) -> bytes:
        """Equal for moments that look the same: a mechanism at rest is drawn once."""
        places = moment.pixels[np.isfinite(moment.pixels).all(axis=1)]
        drives = np.round(moment.drives / self._drive_sizes, 6)
        return b"".join((clip.whole(places).tobytes(), drives.tobytes(),
                         self._drawn_by.key(self._canvas, moment)))

    def _stamp_text(self, t: float) -> Text:
        """The time, in the header."""
        face = self._type.render(self._stamp(min(t, float(self.run.time[-1]))), colour=FAINT_INK)
        line = round(HEAD * self._type.size)
        return Text(face, (self.size[0] - self._pad - face.get_width(),
                           (line - face.get_height()) // 2 + 1))

    def _write_stamp(self, t: float) -> None:
        if not self._bare:
            self._small.blit(self._small_still, self._stamped, self._stamped)
            self._stamped = self._stamp_text(t).paint(self._small)

    def _draw_meters(self, t: float) -> None:
        """Cursors and values, which go with time whatever else moves."""
        area = self._panel.rect
        if not area.width or not area.height:
            return
        large = pygame.Rect([v * self.enlarged for v in area])
        self._large.blit(self._large_still, large, large)
        words = self._panel.draw(self._canvas, t)
        pygame.transform.smoothscale(self._large.subsurface(large), area.size,
                                     self._small.subsurface(area))
        for word in (*self._panel_words, *words):
            word.paint(self._small)

    def _stands(self, t: float) -> bool:
        """Whether texts may look for clear ground at ``t`` [s]: in a film, where nothing moves."""
        if self._moments is not None:
            return True
        apart = STANDS * self.view.speed
        before, after = (self._moment(self._pool, t + way).pixels for way in (-apart, apart))
        with np.errstate(invalid="ignore"):  # what lies nowhere does not move
            return not (np.abs(after - before) > self.enlarged).any()

    def _labels(self, moment: Moment, lines: Linework | None) -> Iterator[Text | Hair]:
        """Names and values on the finished picture, each where there is room."""
        names = list(self._finger_names(moment))
        yield from names
        taken = [pygame.Rect(area) for area in self._canvas.busy]
        taken += [name.rect for name in names if isinstance(name, Text)]
        yield from place_labels(self._canvas.labels, self._type, self.unit, self._stage, taken,
                                [pygame.Rect(area) for area in self._canvas.avoided], lines)

    def _finger_names(self, moment: Moment) -> Iterator[Text | Hair]:
        """Fingers' names beside their hinges, each after its leader."""
        for name in self._names:
            x, y = self._seen_at(moment.pose[name.body, :2]).tolist()
            yield Hair(FAINT_INK, *name.leader((x, y), self.unit))
            yield Text(self._name_face(name.text), name.rect((x, y)).topleft)

    def sheet(self, t: float) -> Sheet:
        """The picture at ``t`` [s] as shapes and texts; painted, it is :meth:`draw`."""
        sheet, canvas = Sheet(self.size, self.enlarged), self._canvas
        canvas.surface = sheet
        canvas.clear()
        sheet.set_clip([v * self.enlarged for v in self._stage])
        self._draw_still()
        sheet.set_clip(None)
        sheet.words += [*self._draw_surround(), *self._panel.draw_still(canvas)]
        stands = self._stands(t)
        moment = self._moment(self._pool, t)
        self._draw_moving(moment)
        meters = self._panel.draw(canvas, t)
        lines = Linework(replace(sheet, words=[]).painted()) if stands else None
        sheet.words += [*self._labels(moment, lines), *meters]
        sheet.words += [] if self._bare else [self._stamp_text(t)]
        canvas.clear()
        canvas.surface = self._large
        return sheet
