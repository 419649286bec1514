"""The strip below the drawing: scale bar, force and tension scales, symbols of this scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from sandbox.draw.film import clip
from sandbox.draw.film.bodies import hatch
from sandbox.draw.film.camera import round_length
from sandbox.draw.film.canvas import Canvas, Typesetter
from sandbox.draw.film.drawers import Drawers, VisibleLayers
from sandbox.draw.film.drives import Entry, legend_entries
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.fluids import largest_pressure, pressure_text, valve_entries
from sandbox.draw.film.forces import slim_arrow
from sandbox.draw.film.geometry import dashes
from sandbox.draw.film.joints import hinge_mark, stop_wedge
from sandbox.draw.film.latches import latch_entries
from sandbox.draw.film.links import has_ropes, rope_symbol
from sandbox.draw.film.loads import load_entries
from sandbox.draw.film.palette import (
    FAINT_INK,
    FORCE,
    INK,
    PUSH,
    ROLES,
    SLACK,
    TENSION,
    TRACE,
    Colour,
)
from sandbox.draw.film.pressure import strip
from sandbox.draw.film.scales import ForceScale
from sandbox.draw.film.sheet import Text
from sandbox.draw.film.springs import spring_symbol
from sandbox.draw.film.tensions import Tensions
from sandbox.draw.film.traces import MARK, WIDTH
from sandbox.draw.film.vectors import Vectors
from sandbox.kinds.arrays import largest_size

XY = tuple[float, float]
Draw = Callable[[Canvas, float, float, float], None]
"""Draws a symbol: canvas, left, middle height, width, all in pixels of the enlarged picture."""
GAP = 17
BAR = 80


@dataclass(frozen=True)
class Item:
    """One entry: a word before, a symbol, words after. Widths in finished pixels."""

    before: str
    symbol: float
    after: str
    draw: Draw

    def width(self, type_: Typesetter, unit: float) -> float:
        """The whole entry's."""
        words = sum(type_.width(w) + 5 * unit for w in (self.before, self.after) if w)
        return self.symbol + words


@dataclass(frozen=True)
class Content:
    """What occurs in this picture, hence what needs an explanation."""

    force: ForceScale
    on: str
    """Whom contact forces are shown on."""
    vectors: Sequence[tuple[Vectors, ForceScale]]
    """Arrows that are shown on wish, each kind with its scale."""
    cut: bool
    """Whether an arrow of contact forces or of those on wish is ever cut short."""
    spread: bool
    """Whether forces along outlines are shown."""
    tension: float
    """Top of the tension scale [N]; 0 where no cord and no link that is shown carries anything."""
    pushes: bool
    """Whether that scale has a side for links that push."""
    slack: bool
    pressure: float
    """Top of the pressure scale [Pa]; 0 without lines of fluid."""
    springs: bool
    drives: Sequence[Entry]
    stops: bool
    marks: float
    """Time between the marks of traces [s]; 0 without any."""
    fixed: bool
    ropes: bool


def content(run: Filmed, layers: VisibleLayers, drawers: Drawers, carried: Tensions,
            scale: ForceScale) -> Content:
    """What a picture of these layers shows of a run."""
    mechanism, model = run.mechanism, run.model
    tells = "tensions" in layers or "bars" in layers
    entries = [*(legend_entries(model) if "drives" in layers else ()),
               *(load_entries(run) if "loads" in layers else ()),
               *(latch_entries(model) if "joints" in layers else ()),
               *(valve_entries(model) if "tendons" in layers else ())]
    fixed = set(layers.of("bodies"))
    return Content(
        force=scale if "contacts" in layers else ForceScale(0.0, 0.0),
        on=drawers.contacts.words,
        vectors=[(each.vectors, each.scale) for each in drawers.vectors if each.scale.metres > 0],
        cut=("contacts" in layers and drawers.contacts.cuts) or any(
            each.cuts for each in drawers.vectors),
        spread=drawers.pressure.scale.metres > 0,
        tension=carried.largest if tells else 0.0, pushes=carried.pushes,
        slack="tendons" in layers and drawers.slack,
        pressure=largest_pressure(run) if "tendons" in layers else 0.0,
        springs="springs" in layers and bool(mechanism.springs), drives=entries,
        stops="joints" in layers and largest_size(run.arrays["joint_stop"]) > 0,
        marks=drawers.traces.interval if "traces" in layers and drawers.traces.any else 0.0,
        ropes="joints" in layers and has_ropes(model),
        fixed=any(b.motion == "fixed" and b.shapes and i in fixed
                  for i, b in enumerate(mechanism.bodies)))


def length_text(metres: float) -> str:
    """``0.02`` as ``20 mm``."""
    for factor, unit in ((1.0, "m"), (1e3, "mm"), (1e6, "µm")):
        if metres * factor >= 0.9995:
            return f"{metres * factor:.6g} {unit}"
    return f"{metres:.3g} m"


def items_for(content: Content, scale: float, unit: float) -> list[Item]:
    """The entries for a camera of ``scale`` [pixels per metre], most important first."""
    bar = round_length(BAR * unit / scale)
    items = [Item("", bar * scale, length_text(bar), _scale_bar)]
    arrows = [(content.force, "N", f"contact force {content.on}", FORCE)]
    arrows += [(own, each.unit, each.words, each.colour) for each, own in content.vectors]
    for own, of, words, colour in arrows:
        if own.metres > 0:
            size = round_length(52 * unit / (own.metres * scale))
            items.append(Item("", size * own.metres * scale, f"{size:g} {of} {words}",
                              partial(_arrow, colour)))
    if content.cut:
        items.append(Item("", 34 * unit, "larger, cut short", _cut))
    if content.spread:
        items.append(Item("", 22 * unit, "force per length", strip))
    if content.tension > 0:
        end = f"{content.tension:g} N"
        items.append(Item(f"pushes {end}", 96 * unit, f"{end} pulls", _push_and_pull)
                     if content.pushes else Item("tension 0", 64 * unit, end, _tension))
    if content.pressure > 0:
        items.append(Item("pressure 0", 64 * unit, pressure_text(content.pressure), _tension))
    if content.ropes:
        items.append(Item("", 30 * unit, "rope", rope_symbol))
    if content.slack:
        items.append(Item("", 26 * unit, "slack", _slack))
    if content.springs:
        items.append(Item("", 36 * unit, "spring", spring_symbol))
    items += [Item("", entry.width * unit, entry.words, entry.symbol) for entry in content.drives]
    if content.stops:
        items.append(Item("", 16 * unit, "joint stop", _stop))
    if content.marks > 0:
        items.append(Item("", 30 * unit, f"trace, marked every {content.marks:g} s", _trace))
    if content.fixed:
        items.append(Item("", 22 * unit, "fixed", _fixed))
    return items


def arrange(items: list[Item], type_: Typesetter, unit: float, width: float,
            most_rows: int) -> list[list[Item]]:
    """Items in rows no wider than ``width``; what finds no row is left out, last ones first."""
    rows: list[list[Item]] = []
    used = width + 1.0
    for item in items:
        needs = item.width(type_, unit)
        if used + needs > width:
            if len(rows) == most_rows or needs > width:
                continue
            rows.append([])
            used = 0.0
        rows[-1].append(item)
        used += needs + GAP * unit
    return rows


def draw_rows(canvas: Canvas, type_: Typesetter, rows: list[list[Item]], left: float,
              top: float, row_height: float) -> list[Text]:
    """Draw all symbols; returns the words with their places [finished pixels]."""
    big, unit = canvas.enlarged, canvas.unit / canvas.enlarged
    words: list[Text] = []

    def write(text: str, x: float, y: float) -> float:
        face = type_.render(text, colour=FAINT_INK)
        words.append(Text(face, (round(x), round(y - face.get_height() / 2))))
        return face.get_width() + 5 * unit

    for k, row in enumerate(rows):
        x, y = left, top + (k + 0.5) * row_height
        for item in row:
            if item.before:
                x += write(item.before, x, y)
            item.draw(canvas, x * big, y * big, item.symbol * big)
            x += item.symbol + 5 * unit
            x += write(item.after, x, y) - 5 * unit + GAP * unit
    return words


def _scale_bar(canvas: Canvas, x: float, y: float, width: float) -> None:
    line, tick = canvas.width(1.6), 4 * canvas.unit
    clip.line(canvas.surface, INK, (x, y), (x + width, y), line)
    for end in (x, x + width):
        clip.line(canvas.surface, INK, (end, y - tick), (end, y + tick), line)


def _arrow(colour: Colour, canvas: Canvas, x: float, y: float, width: float) -> None:
    slim_arrow(canvas, colour, (x, y), (x + width, y))


def _cut(canvas: Canvas, x: float, y: float, width: float) -> None:
    slim_arrow(canvas, FORCE, (x, y), (x + width, y), cut=True)


def _tension(canvas: Canvas, x: float, y: float, width: float) -> None:
    _ramp(canvas, x, y, width, TENSION)


def _push_and_pull(canvas: Canvas, x: float, y: float, width: float) -> None:
    _ramp(canvas, x, y, width, PUSH[::-1] + TENSION)


def _ramp(canvas: Canvas, x: float, y: float, width: float, colours: Sequence[Colour]) -> None:
    half, count = 4.5 * canvas.unit, len(colours)
    for k, colour in enumerate(colours):
        left, right = round(width * k / count), round(width * (k + 1) / count)
        clip.rect(canvas.surface, colour,
                  (round(x) + left, round(y - half), right - left, round(2 * half)))


def _slack(canvas: Canvas, x: float, y: float, width: float) -> None:
    for piece in dashes([(x, y), (x + width, y)], 5 * canvas.unit, 4 * canvas.unit):
        clip.line(canvas.surface, SLACK, *piece, canvas.width(1.8))


def _stop(canvas: Canvas, x: float, y: float, width: float) -> None:
    hinge = (x + 4 * canvas.unit, y)
    stop_wedge(canvas, hinge, 0.0)
    hinge_mark(canvas, hinge, hinge)


def _trace(canvas: Canvas, x: float, y: float, width: float) -> None:
    clip.line(canvas.surface, TRACE, (x, y), (x + width, y), canvas.width(WIDTH))
    for way in (0.25, 0.75):
        canvas.disc(TRACE, (x + way * width, y), MARK)


def _fixed(canvas: Canvas, x: float, y: float, width: float) -> None:
    half = 6 * canvas.unit
    style = ROLES["palm"]
    corners = [(x, y - half), (x + width, y - half), (x + width, y + half), (x, y + half)]
    clip.polygon(canvas.surface, style.fill, corners)
    hatch(canvas, corners, style)
    clip.lines(canvas.surface, style.edge, corners, canvas.width(1.2), closed=True)
