"""The display list of a run: all elements in their order, and the legend."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from sandbox.figure.style import pressure_unit
from sandbox.picture import scales
from sandbox.picture.bounds import drift
from sandbox.picture.elements import bodies, drives, forces, joints, notes, tendons
from sandbox.picture.listing import Listing, RunData
from sandbox.picture.palette import PUSH, TENSION, TOKENS, css, glyph, mixed
from sandbox.picture.subject import Subject, visible_layers
from sandbox.scene.settings import View


class Row(NamedTuple):
    """A row that explains a glyph."""

    layer: str
    width: float  # of the glyph [points]
    words: str
    centred: bool = False  # whether the glyph's middle is its origin; others begin there


ROWS: Mapping[str, Row] = {
    "cut": Row("contacts", 34, "cut short"),
    "patch": Row("pressure", 22, "force per length"),
    "slack": Row("tendons", 26, "slack"),
    "stiffer": Row("drives", 36, "stiffened"),
    "braked": Row("drives", 12, "brake holds", centred=True),
    "unbraked": Row("drives", 12, "free", centred=True),
    "motor": Row("drives", 20, "motor", centred=True),
    "belt": Row("drives", 16, "surface runs", centred=True),
    "servo": Row("drives", 26, "servo", centred=True),
    "rubs": Row("joints", 14, "friction holds", centred=True),
    "slides": Row("joints", 14, "slips", centred=True),
    "driven": Row("drives", 30, "drive, not to scale"),
    "torque": Row("drives", 22, "torque", centred=True),
    "holds": Row("joints", 18, "may release", centred=True),
    "gone": Row("joints", 18, "released", centred=True),
    "open": Row("tendons", 15, "valve open", centred=True),
    "shut": Row("tendons", 15, "shut", centred=True),
    "pump": Row("tendons", 15, "pump", centred=True),
    "stop": Row("joints", 16, "stop"),
}
"""By name, most important first. What a picture shows by itself has no row."""
STEPS = 8  # colours of springs on either side of their own stiffness
RAMPS = {"load": [[css(c) for c in PUSH], [css(c) for c in TENSION]],
         "stiffness": [[css(mixed(TOKENS["spring"][0], TOKENS[end][0], k / (STEPS - 1)))
                        for k in range(STEPS)] for end in ("slack", "drive")]}
"""The ramps of loads (push and pull) and of driven stiffness."""
ELEMENTS: tuple[Callable[[Subject], None], ...] = (
    notes.add_liquids, bodies.add_bodies, bodies.add_anchor_lines, bodies.add_wheels,
    joints.add_joints, joints.add_links, joints.add_grounds, joints.add_stops, joints.add_latches,
    joints.add_springs, joints.add_bars, drives.add_belts, tendons.add_fluids, tendons.add_cables,
    notes.add_traces, notes.add_axes, forces.add_pressure, forces.add_contacts, forces.add_loads,
    forces.add_vectors, drives.add_drives, notes.add_names,
)
"""The functions that add items to a list; a new kind of element is one more."""


def add_legend(s: Subject, carried: scales.Tensions) -> None:
    """Add the rows that the run's pictures need."""
    out, signs = s.out, _seen(s)

    def add(kind: str, layer: str, **row: Any) -> None:
        out.legend.append({"k": kind, "l": layer, **row})

    add("scale", "bodies", metres=1.0, unit="m", words="", s=out.style("", "ink", 1.6))
    arrows = {layer: row for layer, row in s.arrows.items() if layer in s.layers}
    for layer in ("contacts", "drives", "loads", "velocity", "acceleration", "reactions"):
        if layer in arrows and not (
                layer == "loads" and "drives" in arrows and arrows[layer][-1] == s.force):
            token, unit, words, size, scale = arrows[layer]
            factor, written, _ = scales.prefixed(scale.reference, unit)
            add("scale", layer, metres=scale.metres / factor, unit=written, words=words,
                size=size, s=out.style(token))
    if carried.largest > 0:
        words, pushes = f"{carried.largest:g} N", False
        for layer in ("tensions", "bars"):
            pushes |= layer in carried.pushing
            if layer in s.layers:
                add("ramp", layer, ramp="load", low=-1 if pushes else 0,
                    before="push" if pushes else "tension 0",
                    after=f"pull {words}" if pushes else words,
                    instead="tensions" if layer == "bars" else "")
    if "pressure" in s.signs and "tendons" in s.layers:
        largest = max(map(tendons.largest_pressure, (s.run, *s.beside)))
        pascals, unit = pressure_unit(largest)
        add("ramp", "tendons", ramp="load", low=0, before="pressure 0",
            after=f"{largest / pascals:.4g} {unit}")
    for name, sign in ROWS.items():
        if name in signs and sign.layer in s.layers:
            add("glyph", sign.layer, g=glyph(out, name), width=sign.width, words=sign.words,
                centred=sign.centred)
    if token := s.trace_ink:
        out.glyphs[name := f"trace {token}"] = [
            [out.style("", token, 1.8), {"l": [0, 0, 30, 0]}],
            [out.style(token), {"c": [15, 0, 15, 0, 3.0]}]]
        add("glyph", "traces", g=name, width=30, words=f"every {notes.mark_interval(s.run):g} s")


def _seen(s: Subject) -> set[str]:
    """Names of rows; slack, bonds, stops and cut arrows come and go in the painted samples."""
    some = s.painted()
    held = s.run.arrays["held"][some] != 0
    slack = s.carried.pieces[some] <= scales.SLACK_FRACTION * s.carried.largest
    found = {
        "slack": slack.any(), "stop": joints.stopping(s)[some].any(),
        "holds": held.any(), "gone": not held.all(),
        "cut": any(s.largest_arrow(item["t"]) > item["most"] for item in s.out.items
                   if item["k"] == "arrows" and item["l"] in ("contacts", "drives", "loads"))}
    return {sign for sign in ROWS if found.get(sign, sign in s.signs)}


def subject_of(run: RunData, view: View, *, width: float, point: float,
               beside: Sequence[RunData] = (), moments: Sequence[float] | None = None,
               fixed_columns: bool = False) -> Subject:
    """The display list of a run; ``width`` [m] and metres per ``point`` as in :class:`Subject`."""
    runs = (run, *beside)
    layers = [visible_layers(each, view) for each in runs]
    own, *others = (scales.tensions_of(each, scales.bars_of(each, shown.get("bars", ())))
                    for each, shown in zip(runs, layers, strict=True))
    carried = own.beside(others)
    out = Listing.of(run.time, run.arrays["body_pose"], fixed_columns=fixed_columns)
    out.ramps = RAMPS
    if view.follow:
        out.drift = drift(run, view)
    force = scales.shared(scales.force_scale(each, width, view) for each in runs)
    s = Subject(run, view, layers[0], out, carried if "tensions" in layers[0] else carried.hidden(),
                force, width, point, beside, moments)
    for add in ELEMENTS:
        add(s)
    add_legend(s, carried)
    s.close()
    return s
