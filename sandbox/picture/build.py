"""The display list of a run: all elements in their order, and the legend."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from sandbox.picture.bounds import drift
from sandbox.picture.elements.bodies import add_bodies, add_stalks, add_wheels
from sandbox.picture.elements.drives import add_belts, add_drives
from sandbox.picture.elements.forces import add_contacts, add_loads, add_pressure, add_vectors
from sandbox.picture.elements.joints import (
    add_bars,
    add_grounds,
    add_joints,
    add_latches,
    add_links,
    add_springs,
    add_stops,
    stopping,
)
from sandbox.picture.elements.notes import (
    add_axes,
    add_liquids,
    add_names,
    add_traces,
    round_interval,
)
from sandbox.picture.elements.tendons import add_cables, add_fluids, largest_pressure
from sandbox.picture.listing import Listing
from sandbox.picture.palette import DRIVE, PUSH, SLACK, SPRING, TENSION, css, glyph, mixed
from sandbox.picture.run_data import RunData
from sandbox.picture.scales import (
    SLACK_FRACTION,
    ForceScale,
    Tensions,
    bars_of,
    force_scale,
    prefixed,
    pressure_unit,
    shared,
    tensions_of,
)
from sandbox.picture.subject import Subject, VisibleLayers
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
    "stop": Row("joints", 16, "stop"),
}
"""By name, most important first. What a picture shows by itself has no row."""
SHOWN_ON = "on the object"
SEEN = 2.5  # arrows that are shorter everywhere have no scale [points]
STEPS = 8  # colours of springs on either side of their own stiffness
RAMPS = {"load": [[css(c) for c in PUSH], [css(c) for c in TENSION]],
         "stiffness": [[css(mixed(SPRING, other, k / (STEPS - 1))) for k in range(STEPS)]
                       for other in (SLACK, DRIVE)]}
"""The ramps of loads (push and pull) and of driven stiffness."""
ELEMENTS: tuple[Callable[[Subject], None], ...] = (
    add_liquids, add_bodies, add_stalks, add_wheels, add_joints, add_links, add_grounds,
    add_stops, add_latches, add_springs, add_bars, add_belts, add_fluids, add_cables, add_traces,
    add_axes, add_pressure, add_contacts, add_loads, add_vectors, add_drives, add_names,
)
"""What adds items to a list; a new kind of element is a function here."""


def add_legend(s: Subject, carried: Tensions) -> None:
    """Add the rows that the run's pictures need."""
    out, signs = s.out, s.signs | _seen(s)

    def add(kind: str, layer: str, **row: Any) -> None:
        out.legend.append({"k": kind, "l": layer, **row})

    add("scale", "bodies", metres=1.0, unit="m", words="", s=out.style("", "ink", 1.6))
    for token, unit, words, size, layer, scale in _arrow_scales(s):
        if scale.metres > 0:
            factor, written, _ = prefixed(scale.reference, unit)
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
    if "pressure" in signs:
        largest = max(map(largest_pressure, (s.run, *s.beside)))
        pascals, unit = pressure_unit(largest)
        add("ramp", "tendons", ramp="load", low=0, before="pressure 0",
            after=f"{largest / pascals:.4g} {unit}")
    for name, row in ROWS.items():
        if name in signs and row.layer in s.layers:
            add("glyph", row.layer, g=glyph(out, name), width=row.width, words=row.words,
                centred=row.centred)
    if token := s.trace_ink:
        out.glyphs[name := f"trace {token}"] = [
            [out.style("", token, 1.8), {"l": [0, 0, 30, 0]}],
            [out.style(token), {"c": [15, 0, 15, 0, 3.0]}]]
        every = round_interval(float(s.run.time[-1] - s.run.time[0]))
        add("glyph", "traces", g=name, width=30, words=f"every {every:g} s")


def _arrow_scales(s: Subject) -> list[tuple[str, str, str, list[float], str, ForceScale]]:
    """Token, unit, words, size, layer and scale of each kind of arrow."""
    found: list[tuple[str, str, str, list[float], str, ForceScale]] = []
    if "contacts" in s.layers and (
            s.out.fixed_columns  # of a run that goes on it is not known
            or _largest(s, "contacts") * s.force.metres >= SEEN * s.point):
        on = f" {s.contacts_on}" if s.contacts_on.startswith(SHOWN_ON) and (
            "else" not in s.contacts_on) else ""
        found.append(("force", "N", f"contact force{on}", [2.4, 10], "contacts", s.force))
    scaled = "scaled" in s.signs and s.force.metres > 0
    if scaled:
        found.append(("drive", "N", "driving force", [3.4, 11], "drives", s.force))
    if not (scaled and s.loads == s.force):
        found.append(("drive", "N", "load", [3.4, 11], "loads", s.loads))
    return [*found, *((token, unit, words, [2.4, 10],
                       token if token != "reaction" else "reactions", scale)
                      for token, unit, words, scale in s.vectors)]


def _largest(s: Subject, table: str) -> float:
    """The largest arrow of a table in what is painted."""
    rows, some = s.out.tables.get(table, np.zeros((0, 6))), _painted(s)
    rows = rows if isinstance(some, slice) else rows[np.isin(rows[:, 0], some)]
    return float(np.hypot(rows[:, 4], rows[:, 5]).max(initial=0.0))


def _painted(s: Subject) -> Any:
    """The samples nearest to the moments that are painted, or all."""
    return slice(None) if s.moments is None else np.unique(
        [int(np.argmin(np.abs(s.run.time - t))) for t in s.moments])


def _seen(s: Subject) -> set[str]:
    """Rows for what comes and goes: slack tendons, stops, latches, arrows that are cut."""
    some, pieces = _painted(s), s.carried.pieces
    held = s.run.arrays["held"][some] != 0 if s.run.model.bonds.name else np.zeros(0, dtype=bool)
    found = {
        "slack": bool((pieces[some] <= SLACK_FRACTION * s.carried.largest).any()),
        "stop": bool(stopping(s)[some].any()),
        "holds": bool(held.any()), "gone": not held.all(),
        "cut": any(_largest(s, item["t"]) > item["most"] for item in s.out.items
                   if item["k"] == "arrows")}
    return {sign for sign, shown in found.items() if shown}


def subject_of(run: RunData, view: View, *, width: float, point: float,
               beside: Sequence[RunData] = (), moments: Sequence[float] | None = None,
               fixed_columns: bool = False) -> Subject:
    """The display list of a run.

    Args:
        run: the recording.
        view: layers and scales.
        width: width of the picture [m], the measure of arrows.
        point: metres per point.
        beside: runs that share its scales.
        moments: times that are painted [s], if they are few.
        fixed_columns: see :class:`Listing`.
    """
    runs = (run, *beside)
    layers = [VisibleLayers(each, view) for each in runs]
    own, *others = (tensions_of(each, bars_of(each, shown.of("bars")))
                    for each, shown in zip(runs, layers, strict=True))
    carried = own.beside(others)
    out = Listing.of(run.time, run.arrays["body_pose"], fixed_columns=fixed_columns)
    out.ramps = RAMPS
    if view.follow:
        out.drift = drift(run, view)
    s = Subject(run, view, layers[0], out, carried if "tensions" in layers[0] else carried.hidden(),
                shared(force_scale(each, width, view) for each in runs), width, point, beside,
                moments)
    for add in ELEMENTS:
        add(s)
    add_legend(s, carried)
    s.close()
    return s
