"""Several runs in one picture: beside or below each other, with signs on springs.

They have one scale of lengths, of tensions and of each kind of arrow, and one legend.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pygame
from numpy.typing import NDArray
from PIL import Image

from sandbox.atomic_files import atomic_file
from sandbox.draw.film import legend
from sandbox.draw.film.bounds import body_box, whole_box
from sandbox.draw.film.camera import MARGIN, Rectangle, width_shown
from sandbox.draw.film.canvas import XY, Canvas, picture_unit, type_size
from sandbox.draw.film.filmed import Metered
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.palette import BACKGROUND, FAINT_INK, HAIRLINE, INK
from sandbox.draw.film.points import moved
from sandbox.draw.film.scales import force_scale
from sandbox.draw.film.sheet import new_surface
from sandbox.draw.film.stills import FINE
from sandbox.draw.film.typesetter import Typesetter, ellipsis
from sandbox.errors import OutputError
from sandbox.numeric import Array, Flags
from sandbox.scene.elements.settings import View

Pixels = NDArray[np.uint8]
SIZES = (0.35, 1.5)
"""Least and largest height of a pane's drawing as a fraction of its width."""
SURROUND = 22
"""Lines of its type that a pane's picture would have besides its drawing, by which its words are
as large as in a picture of one run."""
MOST_ROWS = 6
"""Of the legend."""
RADIUS = 0.66
"""Of a sign, in heights of its letter's type."""
REACHES = (1.15, 1.6, 2.1, 2.8)
"""How far from its spring a sign is tried, in its diameters."""
ANGLES = np.radians([0, 30, -30, 60, -60, 90, -90, 135, -135, 180])
"""Directions in which it is tried, from the one away from the hinge."""


@dataclass(frozen=True)
class Mark:
    """A sign on a spring: a letter in a ring, or on a dark disc where ``strong``."""

    text: str
    strong: bool = False


def draw_ends(
    recordings: Sequence[Metered], labels: Sequence[str], marks: Sequence[Mapping[str, Mark]],
    path: str | Path, *, note: str = "", key: Sequence[tuple[Mark, str]] = (), width: int = 1600,
    columns: int | None = None, words: float = 1.0,
) -> None:
    """Draw the ends of several runs into one picture, as a PNG.

    One camera serves all, so that a length is as long in one as in the other and a place of the
    world is at the same place of each pane.

    Args:
        recordings: one pane each, from left to right, then below.
        labels: a line under each pane.
        marks: for each recording the springs that carry a sign, by name.
        path: the file.
        note: what holds for all of them, below everything.
        key: what the signs mean, below everything too.
        width: of the picture [pixels].
        columns: how many panes stand side by side; all by default.
        words: how large they are, and lines are thick, beside those of a picture of one run that
            is as wide as a pane.

    Raises:
        OutputError: a recording without samples, or a file that cannot be written.
        ValueError: nothing to draw, not one label and one set of marks for each recording, a
            mark on a spring that is not there.
    """
    _check(recordings, labels, marks)
    columns = columns or len(recordings)
    panes = _panes(recordings, width // columns, words)
    for pane, signs in zip(panes, marks, strict=True):
        pane.sign(signs)
    picture = _Spread(panes, width, columns).compose(labels, note, key)
    with atomic_file(Path(path)) as aside:
        Image.frombytes("RGB", picture.get_size(), pygame.image.tobytes(picture, "RGB")).save(
            aside, format="PNG")


def _check(recordings: Sequence[Metered], labels: Sequence[str],
           marks: Sequence[Mapping[str, Mark]]) -> None:
    if not recordings:
        raise ValueError("recordings must hold at least one, got none")
    if not len(recordings) == len(labels) == len(marks):
        raise ValueError(f"{len(recordings)} recordings need as many labels and sets of marks, "
                         f"got {len(labels)} and {len(marks)}")
    for run, signs in zip(recordings, marks, strict=True):
        if not len(run.time):
            raise OutputError("a recording has no samples: there is nothing to draw")
        if unknown := sorted(set(signs) - set(run.model.springs.name)):
            raise ValueError(f"marks name springs that are not there: {', '.join(unknown)}")


def common_box(recordings: Sequence[Metered]) -> Rectangle:
    """What of the world [m] all the runs need together, room for arrows included."""
    corners = []
    for run in recordings:
        bodies = body_box(run)
        aspect = max(bodies.width, 1e-9) / max(bodies.height, 1e-9)
        across = width_shown(bodies, aspect)
        box = whole_box(run, bodies, force_scale(run, across), across)
        corners += [(box.x0, box.y0), (box.x1, box.y1)]
    return Rectangle.around(np.array(corners))


def _panes(recordings: Sequence[Metered], width: int, words: float) -> list[_Pane]:
    """The end of every run drawn with one camera and to one scale."""
    box = common_box(recordings)
    free = 1 - 2 * MARGIN
    shape = box.height / box.width if box.width > 0 else SIZES[1]
    height = round(width * float(np.clip(shape, *SIZES)))
    across = max(box.width, box.height * width / height, 1e-3) / free
    room = SURROUND * _type_size((width, 2 * height), words)
    view = View(size=(width, height), centre=box.centre, width=across)
    unit = words * picture_unit((width, height + room))
    return [_Pane(run, words, FrameRenderer(
        run, view=view, enlarge=FINE, unit=unit, bare=True, moments=[float(run.time[-1])],
        beside=[each for each in recordings if each is not run])) for run in recordings]


def _type_size(size: tuple[int, int], words: float) -> int:
    """Of a frame's words [pixels], or somewhat more."""
    return type_size(words * picture_unit(size))


class _Pane:
    """One run's end."""

    def __init__(self, run: Metered, words: float, renderer: FrameRenderer) -> None:
        self.run, self.camera = run, renderer.camera
        self.unit, self.content = renderer.unit, renderer.content
        self.drawing = _surface(np.ascontiguousarray(renderer.draw(float(run.time[-1]))))
        self.type_size = _type_size(self.drawing.get_size(), words)
        """Of its words, or somewhat more [pixels]."""

    def sign(self, signs: Mapping[str, Mark]) -> None:
        """Put signs beside springs, each where it covers least."""
        type_ = Typesetter(round(1.25 * self.type_size))
        inked = _ink(self.drawing)
        for name, mark in signs.items():
            at, away = _place(self.run, name)
            x, y = self.camera.to_pixels(np.array(at)).tolist()
            size = 2 * RADIUS * type_.size
            spot = _free_spot(inked, (x, y), away, size)
            face = sign_face(mark, type_)
            rect = face.get_rect(center=(round(spot[0]), round(spot[1])))
            self.drawing.blit(face, rect)
            inked[max(0, rect.top):rect.bottom, max(0, rect.left):rect.right] = True


def sign_face(mark: Mark, type_: Typesetter) -> pygame.Surface:
    """The picture of a sign on a see-through ground."""
    fine = 4
    size = 2 * round(RADIUS * type_.size) + 1
    large = pygame.Surface((size * fine, size * fine), pygame.SRCALPHA, 32)
    large.fill((*INK, 0))
    centre, radius = (size * fine / 2, size * fine / 2), size * fine / 2 - 1
    pygame.draw.circle(large, INK, centre, radius)
    if not mark.strong:
        pygame.draw.circle(large, BACKGROUND, centre, radius - 1.5 * fine)
    face = pygame.transform.smoothscale(large, (size, size))
    word = type_.render(mark.text, colour=BACKGROUND if mark.strong else INK)
    # a letter's own box has room for descenders below: centred by what is seen
    seen = word.get_bounding_rect(min_alpha=60)
    face.blit(word, (round(size / 2 - seen.centerx), round(size / 2 - seen.centery)))
    return face


def _place(run: Metered, spring: str) -> tuple[XY, XY]:
    """Middle of a spring at the run's end [m], and the direction away from its hinge (unit)."""
    model = run.model
    springs, joints, number = model.springs, model.joints, model.names.spring[spring]

    def world(body: int, point: Array) -> XY:
        x, y, angle = (float(v) for v in run.arrays["body_pose"][-1, body])
        return moved((float(point[0]), float(point[1])), (x, y, angle))

    if not springs.straight[number]:
        joint = springs.joint[number]
        return world(joints.bodies[joint, 1], joints.anchor[joint, 1]), (0.0, 1.0)
    start, end = (world(body, point) for body, point in
                  zip(springs.bodies[number], springs.anchor[number], strict=True))
    middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    # the hinge between the two bodies that the spring ties together
    across = next((j for j in joints.hinges
                   if set(joints.bodies[j]) == set(springs.bodies[number])), None)
    if across is not None:
        x, y = world(joints.bodies[across, 1], joints.anchor[across, 1])
        away = (middle[0] - x, middle[1] - y)
    else:
        away = (start[1] - end[1], end[0] - start[0])
    length = float(np.hypot(*away))
    return middle, (away[0] / length, away[1] / length) if length > 0 else (0.0, 1.0)


def _free_spot(inked: Flags, at: XY, away: XY, size: float) -> XY:
    """The first of the spots around ``at`` [pixels] where a sign covers least of the drawing."""
    best, least = at, np.inf
    for reach in REACHES:
        for angle in ANGLES:
            c, s = np.cos(angle), np.sin(angle)
            # away is in the world, y up; pixels have y down
            dx, dy = c * away[0] - s * away[1], -(s * away[0] + c * away[1])
            x, y = at[0] + reach * size * dx, at[1] + reach * size * dy
            half = size / 2 + 1
            left, top = round(x - half), round(y - half)
            right, bottom = round(x + half), round(y + half)
            if left < 0 or top < 0 or bottom > inked.shape[0] or right > inked.shape[1]:
                continue
            covered = int(inked[top:bottom, left:right].sum())
            if covered < least:
                best, least = (x, y), covered
        if least == 0:
            break
    return best


class _Spread:
    """Panes, what is written under them, and what holds for all."""

    def __init__(self, panes: Sequence[_Pane], width: int, columns: int) -> None:
        self._panes = panes
        self._width = width
        self._columns = columns
        self._across = width // columns
        self._type = Typesetter(round(1.15 * panes[0].type_size))
        self._pad = round(0.8 * self._type.size)
        self._row = round(1.9 * self._type.size)

    def compose(self, labels: Sequence[str], note: str,
                key: Sequence[tuple[Mark, str]]) -> pygame.Surface:
        """The whole page."""
        high = self._panes[0].drawing.get_height()
        told = self._legend()
        lines = -(-len(self._panes) // self._columns)
        common = self._common(note, key)
        picture = new_surface(self._width, lines * (high + self._row) + self._row * len(common)
                              + told.get_height() + 2 * self._pad)
        for k, (pane, label) in enumerate(zip(self._panes, labels, strict=True)):
            x, y = k % self._columns * self._across, k // self._columns * (high + self._row)
            picture.blit(pane.drawing, (x, y))
            self._write_label(picture, label, x, y + high)
            if x:
                pygame.draw.line(picture, HAIRLINE, (x, y + self._pad),
                                 (x, y + high + self._row // 2))
        y = lines * (high + self._row) + self._pad
        for some, said in common:
            self._write_common(picture, said, some, y)
            y += self._row
        pygame.draw.line(picture, HAIRLINE, (self._pad, y), (self._width - self._pad, y))
        picture.blit(told, (0, y + self._pad // 2))
        return picture

    def _legend(self) -> pygame.Surface:
        """What holds for the marks of all panes, which have one scale."""
        one, type_ = self._panes[0], Typesetter(type_size(self._panes[0].unit))
        items = legend.items_for(legend.together([pane.content for pane in self._panes]),
                                 one.camera.scale, one.unit)
        rows = legend.arrange(items, type_, one.unit, self._width - 2 * self._pad, MOST_ROWS)
        row = round(1.5 * type_.size)
        size = (self._width, row * len(rows))
        large = new_surface(FINE * size[0], FINE * size[1])
        canvas = Canvas(large, one.camera, FINE * one.unit, FINE)
        words = legend.draw_rows(canvas, type_, rows, self._pad, 0, row)
        picture = pygame.transform.smoothscale(large, size)
        for word in words:
            word.paint(picture)
        return picture

    def _common(self, note: str, key: Sequence[tuple[Mark, str]],
                ) -> list[tuple[Sequence[tuple[Mark, str]], str]]:
        """What stands in each row that holds for all: signs and note in one, or in two."""
        if not (note and key):
            return [(key, note)] if note or key else []
        signs = sum(round(2.2 * self._type.size) + 2 * self._pad + self._type.width(meaning)
                    for _, meaning in key)
        if signs + self._type.width(note) + 2 * self._pad <= self._width:
            return [(key, note)]
        return [(key, ""), ((), note)]

    def _write_label(self, picture: pygame.Surface, label: str, left: int, y: int) -> None:
        size = round(1.2 * self._type.size)
        text = ellipsis(self._type, label, self._across - 2 * self._pad, size)
        face = self._type.render(text, size=size, colour=INK)
        x = left + (self._across - face.get_width()) // 2
        picture.blit(face, (x, y + (self._row - face.get_height()) // 2))

    def _write_common(self, picture: pygame.Surface, note: str,
                      key: Sequence[tuple[Mark, str]], y: int) -> None:
        """The signs with their meanings and the note, in one row."""
        x, middle = self._pad, y + self._row // 2
        for mark, meaning in key:
            face = sign_face(mark, self._type)
            picture.blit(face, (x, middle - face.get_height() // 2))
            x += face.get_width() + self._pad // 2
            x += self._write(picture, meaning, x, middle) + 2 * self._pad
        self._write(picture, ellipsis(self._type, note, self._width - x - self._pad,
                                      self._type.size), x, middle)

    def _write(self, picture: pygame.Surface, text: str, x: int, middle: int) -> int:
        face = self._type.render(text, colour=FAINT_INK)
        picture.blit(face, (x, middle - face.get_height() // 2))
        return face.get_width()


def _surface(pixels: Pixels) -> pygame.Surface:
    """A picture [h, w, 3] as a surface of its own."""
    high, wide = pixels.shape[:2]
    return pygame.image.frombytes(np.ascontiguousarray(pixels).tobytes(), (wide, high), "RGB")


def _ink(picture: pygame.Surface) -> Flags:
    """Where a picture is not blank, shape [h, w]."""
    pixels: Pixels = pygame.surfarray.array3d(picture)
    return np.asarray((pixels.min(axis=2) < 245).T)

