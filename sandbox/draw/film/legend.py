"""The strip below the drawing: scale bar, force and tension scales, symbols of this scene."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from sandbox.draw.film import clip
from sandbox.draw.film.belts import belt_symbol
from sandbox.draw.film.bodies import hatch
from sandbox.draw.film.camera import round_length
from sandbox.draw.film.canvas import Canvas
from sandbox.draw.film.drawers import Drawers, VisibleLayers
from sandbox.draw.film.drives import drive_arrow
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.fluids import pressure_text, valve_mark
from sandbox.draw.film.forces import SHORTEST, slim_arrow
from sandbox.draw.film.geometry import dashes
from sandbox.draw.film.joints import hinge_mark, rub_mark, stop_wedge
from sandbox.draw.film.latches import latch_mark
from sandbox.draw.film.links import rope_symbol
from sandbox.draw.film.loads import load_arrow
from sandbox.draw.film.palette import (
    FAINT_INK,
    FORCE,
    INK,
    PIN_RING,
    PUSH,
    ROLES,
    SLACK,
    TENSION,
    TRACES,
    Colour,
    Style,
)
from sandbox.draw.film.pressure import strip
from sandbox.draw.film.scales import ForceScale, shared
from sandbox.draw.film.sheet import Text
from sandbox.draw.film.springs import spring_symbol, stiffened_symbol
from sandbox.draw.film.symbols import SYMBOLS, fixed_style, signs_in
from sandbox.draw.film.tendons import stiffened_cord_symbol
from sandbox.draw.film.tensions import Tensions
from sandbox.draw.film.traces import MARK, WIDTH
from sandbox.draw.film.turning import brake_mark, motor_mark, servo_mark, turn_arrow
from sandbox.draw.film.typesetter import Typesetter
from sandbox.draw.film.vectors import Vectors

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
    contact: float
    """The largest contact force of any picture [N]."""
    on: str
    """Whom contact forces are shown on; empty without any."""
    loads: ForceScale
    vectors: Sequence[tuple[Vectors, ForceScale]]
    """Arrows that are shown on wish, each kind with its scale."""
    cut: bool
    """Whether any picture has an arrow of contact forces or of those on wish cut short."""
    spread: bool
    """Whether forces along outlines are shown."""
    tension: float
    """Top of the tension scale [N]; 0 where no cord and no link that is shown carries anything."""
    pushes: bool
    """Whether that scale has a side for links that push."""
    pressure: float
    """Top of the pressure scale [Pa]; 0 without lines of fluid."""
    signs: Collection[str]
    """Symbols without numbers, of :data:`sandbox.draw.film.symbols.SYMBOLS`."""
    fixed: Style
    """Of the fixed bodies that are shown, or of most of them."""
    marks: float
    """Time between the marks of traces [s]; 0 without any."""
    traces: Sequence[Colour]
    """Colours of traces."""


def content(run: Filmed, layers: VisibleLayers, drawers: Drawers, carried: Tensions,
            scale: ForceScale, samples: Sequence[int]) -> Content:
    """What pictures of these layers show of a run in some samples."""
    tells = "tensions" in layers or "bars" in layers
    signs = signs_in(run) | drawers.drives.signs
    if fixed := fixed_style(run, layers.of("bodies")):
        signs.add("fixed")
    signs = (signs - {"stop"}) | drawers.seen(samples)
    largest = drawers.contacts.largest(samples) if "contacts" in layers else 0.0
    return Content(
        force=scale if "contacts" in layers else ForceScale(0.0, 0.0),
        contact=largest,
        on=drawers.contacts.words, loads=drawers.loads.scale,
        vectors=[(each.vectors, each.scale) for each in drawers.vectors.values()
                 if each.scale.metres > 0],
        cut=(largest > scale.longest and scale.metres > 0) or any(
            each.cuts(samples) for each in drawers.vectors.values())
        or ("drives" in layers and drawers.drives.cuts(samples)),
        spread=drawers.pressure.scale.metres > 0,
        tension=carried.largest if tells else 0.0, pushes=carried.pushes,
        pressure=drawers.fluids.largest if "tendons" in layers else 0.0,
        signs={name for name in signs if SYMBOLS[name].layer in layers},
        fixed=fixed or ROLES["ground"],
        marks=drawers.traces.interval if "traces" in layers and drawers.traces.any else 0.0,
        traces=drawers.traces.colours or TRACES[:1])


def together(contents: Sequence[Content]) -> Content:
    """What one legend says of several pictures that have the same scales."""
    return replace(
        contents[0], contact=max(each.contact for each in contents),
        on=" or ".join(dict.fromkeys(each.on for each in contents if each.on)),
        loads=shared(each.loads for each in contents),
        cut=any(each.cut for each in contents), spread=any(each.spread for each in contents),
        signs={name for each in contents for name in each.signs},
        fixed=next((each.fixed for each in contents if "fixed" in each.signs), contents[0].fixed),
        marks=max(each.marks for each in contents))


def length_text(metres: float) -> str:
    """``0.02`` as ``20 mm``."""
    for factor, unit in ((1.0, "m"), (1e3, "mm"), (1e6, "µm")):
        if metres * factor >= 0.9995:
            return f"{metres * factor:.6g} {unit}"
    return f"{metres:.3g} m"


def items_for(content: Content, scale: float, unit: float, *, scales: bool = False) -> list[Item]:
    """The entries for a camera of ``scale`` [pixels per metre], most important first.

    All of them, or the ``scales`` alone: what has a number, and what is cut short of one.
    """
    bar = round_length(BAR * unit / scale)
    items = [Item("", bar * scale, length_text(bar), _scale_bar)]
    arrows: list[tuple[ForceScale, str, Draw]] = []
    if content.contact * content.force.metres * scale >= SHORTEST * unit:
        arrows.append((content.force, f"N contact force {content.on}", partial(_arrow, FORCE)))
    scaled = "scaled" in content.signs and content.force.metres > 0
    if scaled:
        arrows.append((content.force, f"N {SYMBOLS['scaled'].words}", _load))
    arrows.append((content.loads, "N load", _load))
    arrows += [(own, f"{each.unit} {each.words}", partial(_arrow, each.colour))
               for each, own in content.vectors]
    for own, words, draw in arrows:
        if own.metres > 0:
            size = round_length(52 * unit / (own.metres * scale))
            items.append(Item("", size * own.metres * scale, f"{size:g} {words}", draw))
    numbers = {"both" if content.pushes else "pull": f"{content.tension:g} N"} if (
        content.tension > 0) else {}
    if content.pressure > 0:
        numbers["pressure"] = pressure_text(content.pressure)
    if content.marks > 0:
        numbers["trace"] = f"{content.marks:g} s"
    signs = () if scales else (*content.signs, *(["patch"] if content.spread else []))
    there = {*signs, *numbers, *(["cut"] if content.cut else [])}
    made = {"fixed": partial(_fixed, content.fixed), "trace": partial(_trace, content.traces)}
    for name, row in SYMBOLS.items():
        if name in there and not (scaled and name == "scaled"):
            before, after = (text.format(numbers.get(name)) for text in (row.before, row.words))
            items.append(Item(before, row.width * unit, after, made.get(name, DRAWN[name])))
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


def _vane(canvas: Canvas, at: XY) -> None:
    canvas.ring(TENSION[len(TENSION) // 2], PIN_RING, at, 7.0, 1.2)


def _slack(canvas: Canvas, x: float, y: float, width: float) -> None:
    for piece in dashes([(x, y), (x + width, y)], 5 * canvas.unit, 4 * canvas.unit):
        clip.line(canvas.surface, SLACK, *piece, canvas.width(1.8))


def _stop(canvas: Canvas, x: float, y: float, width: float) -> None:
    hinge = (x + 4 * canvas.unit, y)
    stop_wedge(canvas, hinge, 0.0)
    hinge_mark(canvas, hinge, hinge)


def _trace(colours: Sequence[Colour], canvas: Canvas, x: float, y: float, width: float) -> None:
    """In the first two colours, where there are several."""
    ways = zip((0.0, 0.5), (colours[0], colours[1 % len(colours)]), strict=True)
    for begin, colour in ways:
        clip.line(canvas.surface, colour, (x + begin * width, y),
                  (x + (begin + 0.5) * width, y), canvas.width(WIDTH))
        canvas.disc(colour, (x + (begin + 0.25) * width, y), MARK)


def _hinge(mark: Callable[[Canvas, XY], None]) -> Draw:
    """A symbol that is a mark about a hinge."""
    def draw(canvas: Canvas, x: float, y: float, width: float) -> None:
        middle = (x + width / 2, y)
        mark(canvas, middle)
        hinge_mark(canvas, middle, middle)
    return draw


def _middle(mark: Callable[[Canvas, XY], None]) -> Draw:
    """A symbol that is a mark alone."""
    return lambda canvas, x, y, width: mark(canvas, (x + width / 2, y))


def _load(canvas: Canvas, x: float, y: float, width: float) -> None:
    load_arrow(canvas, (x, y), (x + width, y))


def _driven(canvas: Canvas, x: float, y: float, width: float) -> None:
    drive_arrow(canvas, (x, y), (x + width, y), scaled=False)


def _turned(canvas: Canvas, at: XY) -> None:
    turn_arrow(canvas, (at[0], at[1] + 2 * canvas.unit), 1, 8.0)


def _fixed(style: Style, canvas: Canvas, x: float, y: float, width: float) -> None:
    half = 6 * canvas.unit
    corners = [(x, y - half), (x + width, y - half), (x + width, y + half), (x, y + half)]
    clip.polygon(canvas.surface, style.fill, corners)
    hatch(canvas, corners, style)
    clip.lines(canvas.surface, style.edge, corners, canvas.width(1.2), closed=True)


DRAWN: Mapping[str, Draw] = {
    "cut": _cut, "patch": strip, "both": _push_and_pull, "pull": _tension, "pressure": _tension,
    "vane": _middle(_vane), "rope": rope_symbol, "slack": _slack, "spring": spring_symbol,
    "stiffer": stiffened_symbol,
    "braked": _hinge(partial(brake_mark, holds=True)),
    "unbraked": _hinge(partial(brake_mark, holds=False)),
    "motor": _hinge(lambda canvas, at: motor_mark(canvas, at, 1)),
    "belt": belt_symbol, "servo": _hinge(servo_mark), "wider": stiffened_cord_symbol,
    "rubs": _hinge(partial(rub_mark, holds=True)),
    "slides": _hinge(partial(rub_mark, holds=False)),
    "scaled": _load, "driven": _driven, "torque": _middle(_turned),
    "holds": _middle(partial(latch_mark, holds=True)),
    "gone": _middle(partial(latch_mark, holds=False)),
    "open": _middle(partial(valve_mark, along=(1.0, 0.0), flows=True)),
    "shut": _middle(partial(valve_mark, along=(1.0, 0.0), flows=False)),
    "stop": _stop, "trace": partial(_trace, TRACES[:1]), "fixed": partial(_fixed, ROLES["ground"]),
}
"""What draws the symbols, by their names."""
