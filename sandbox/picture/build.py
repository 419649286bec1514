"""The display list of a run: all elements in their order."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from sandbox.picture.bounds import drift
from sandbox.picture.elements.bodies import add_bodies, add_stalks, add_wheels
from sandbox.picture.elements.cords import add_cords
from sandbox.picture.elements.drives import add_belts, add_drives
from sandbox.picture.elements.fluids import add_fluids, largest_pressure, pressure_text
from sandbox.picture.elements.forces import add_contacts, add_loads, add_pressure, add_vectors
from sandbox.picture.elements.joints import (
    add_grounds,
    add_joints,
    add_latches,
    add_stops,
    stopping,
)
from sandbox.picture.elements.links import add_bars, add_links, add_springs
from sandbox.picture.elements.notes import (
    add_axes,
    add_liquids,
    add_names,
    add_traces,
    round_interval,
)
from sandbox.picture.glyphs import glyph
from sandbox.picture.listing import Listing
from sandbox.picture.palette import DRIVE, PUSH, SLACK, SPRING, TENSION, css, mixed
from sandbox.picture.run_data import RunData
from sandbox.picture.scales import ForceScale, force_scale, prefixed, shared
from sandbox.picture.subject import Subject, VisibleLayers
from sandbox.picture.tensions import SLACK_FRACTION, Tensions, bars_of, tensions_of
from sandbox.scene.settings import View


class Row(NamedTuple):
    """A row that explains a glyph."""

    layer: str
    width: float
    """Of the glyph [points]."""
    words: str


ROWS: Mapping[str, Row] = {
    "cut": Row("contacts", 34, "cut short"),
    "patch": Row("pressure", 22, "force per length"),
    "slack": Row("tendons", 26, "slack"),
    "stiffer": Row("drives", 36, "stiffened"),
    "braked": Row("drives", 12, "brake holds"),
    "unbraked": Row("drives", 12, "free"),
    "motor": Row("drives", 20, "motor"),
    "belt": Row("drives", 16, "surface runs"),
    "servo": Row("drives", 26, "servo"),
    "rubs": Row("joints", 14, "friction holds"),
    "slides": Row("joints", 14, "slips"),
    "driven": Row("drives", 30, "drive, not to scale"),
    "torque": Row("drives", 22, "torque"),
    "holds": Row("joints", 18, "may release"),
    "gone": Row("joints", 18, "released"),
    "open": Row("tendons", 15, "valve open"),
    "shut": Row("tendons", 15, "shut"),
    "stop": Row("joints", 16, "stop"),
}
"""By name, most important first. What a picture shows by itself has no row."""
SHOWN_ON = "on the object"
SEEN = 2.5
"""Arrows that are shorter everywhere have no scale [points]."""
CENTRED = {"braked", "unbraked", "motor", "servo", "rubs", "slides", "torque", "holds", "gone",
           "open", "shut", "belt"}
"""Glyphs whose middle is their origin; others begin there."""


def add_legend(s: Subject, carried: Tensions) -> None:
    """Add the rows that the run's pictures need."""
    out, rows = s.out, s.out.legend
    rows.append({"k": "scale", "metres": 1.0, "unit": "m", "words": "", "l": "bodies",
                 "s": out.style("", "ink", 1.6)})
    _arrow_scales(s)
    if carried.largest > 0:
        words, pushes = f"{carried.largest:g} N", False
        for layer in ("tensions", "bars"):
            pushes |= layer in carried.pushing
            if layer in s.layers:
                rows.append({"k": "ramp", "ramp": "load", "low": -1 if pushes else 0, "l": layer,
                             "before": "push" if pushes else "tension 0",
                             "after": f"pull {words}" if pushes else words,
                             "instead": "tensions" if layer == "bars" else ""})
    if "pressure" in s.signs:
        largest = max(map(largest_pressure, (s.run, *s.beside)))
        rows.append({"k": "ramp", "ramp": "load", "low": 0, "l": "tendons",
                     "before": "pressure 0", "after": pressure_text(largest)})
    s.signs |= _seen(s)
    for name, row in ROWS.items():
        if name in s.signs and row.layer in s.layers:
            rows.append({"k": "glyph", "g": glyph(out, name), "l": row.layer,
                         "width": row.width, "words": row.words, "centred": name in CENTRED})
    if "trace" in s.signs:
        token = s.trace_inks[0]
        name = f"trace {token}"
        out.glyphs[name] = [[out.style("", token, 1.8), {"l": [0, 0, 30, 0]}],
                            [out.style(token), {"c": [15, 0, 15, 0, 3.0]}]]
        every = round_interval(float(s.run.time[-1] - s.run.time[0]))
        rows.append({"k": "glyph", "g": name, "l": "traces", "width": 30,
                     "words": f"every {every:g} s"})


def _arrow_scales(s: Subject) -> None:
    """A row for each kind of arrow that has a scale."""
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
    found += [(token, unit, words, [2.4, 10], layer, scale)
              for token, unit, words, scale in s.vectors
              for layer in [token if token != "reaction" else "reactions"]]
    for token, unit, words, size, layer, scale in found:
        if scale.metres > 0:
            factor, written, _ = prefixed(scale.reference, unit)
            s.out.legend.append({"k": "scale", "metres": scale.metres / factor, "unit": written,
                                 "words": words, "l": layer, "size": size,
                                 "s": s.out.style(token)})


def _largest(s: Subject, table: str) -> float:
    """The largest arrow of a table in what is painted."""
    rows, some = s.out.tables.get(table, np.zeros((0, 6))), samples_of(s)
    if not isinstance(some, slice):
        rows = rows[np.isin(rows[:, 0], some)]
    return float(np.hypot(rows[:, 4], rows[:, 5]).max(initial=0.0))


def samples_of(s: Subject) -> Any:
    """The samples nearest to the moments that are painted, or all."""
    if s.moments is None:
        return slice(None)
    return np.unique([int(np.argmin(np.abs(s.run.time - t))) for t in s.moments])


def _seen(s: Subject) -> set[str]:
    """Rows for what comes and goes: slack cords, stops, latches, arrows that are cut."""
    model, some = s.run.model, samples_of(s)
    found = set()
    pieces = s.carried.pieces[some]
    if pieces.size and (pieces <= SLACK_FRACTION * s.carried.largest).any():
        found.add("slack")
    if stopping(s)[some].any():
        found.add("stop")
    if model.ties.name:
        held = s.run.arrays["held"][some] != 0
        found |= ({"holds"} if held.any() else set()) | ({"gone"} if not held.all() else set())
    if any(_largest(s, item["t"]) > item["most"] for item in s.out.items
           if item["k"] == "arrows"):
        found.add("cut")
    return found


ELEMENTS: tuple[Callable[[Subject], None], ...] = (
    add_liquids, add_bodies, add_stalks, add_wheels, add_joints, add_links, add_grounds,
    add_stops, add_latches, add_springs, add_bars, add_belts, add_fluids, add_cords, add_traces,
    add_axes, add_pressure, add_contacts, add_loads, add_vectors, add_drives, add_names,
)
"""What adds items to a list; a new kind of element is a function here."""
STEPS = 8
"""Colours of springs on either side of their own stiffness."""


RAMPS = {"load": [[css(c) for c in PUSH], [css(c) for c in TENSION]],
         "stiffness": [[css(mixed(SPRING, other, k / (STEPS - 1))) for k in range(STEPS)]
                       for other in (SLACK, DRIVE)]}
"""The ramps of loads (push and pull) and of driven stiffness."""


def tensions(run: RunData, layers: VisibleLayers, beside: Sequence[RunData],
             view: View) -> Tensions:
    """What cords, links and bars carry, on the scale that some runs share."""
    own = tensions_of(run, bars_of(run, layers.of("bars")))
    return own.beside(tensions_of(each, bars_of(each, VisibleLayers(each, view).of("bars")))
                      for each in beside)


def subject_of(run: RunData, view: View, *, width: float, point: float,
               beside: Sequence[RunData] = (), moments: Sequence[float] | None = None,
               fixed_columns: bool = False, force: ForceScale | None = None) -> Subject:
    """The list of a run with all that its layers show.

    Args:
        run: the recording.
        view: what to show.
        width: of what the picture shows [m], by which arrows are measured.
        point: metres per point.
        beside: runs that share its scales.
        moments: the times that are painted [s], if they are few.
        fixed_columns: see :class:`Listing`.
        force: the scale of contact forces, by default that of the runs.
    """
    layers = VisibleLayers(run, view)
    carried = tensions(run, layers, beside, view)
    out = Listing.of(run.time, run.arrays["body_pose"], fixed_columns=fixed_columns)
    out.ramps = RAMPS
    if view.follow:
        out.drift = drift(run, view)
    s = Subject(run, view, layers, out, carried if "tensions" in layers else carried.hidden(),
                force or shared(force_scale(each, width, view) for each in (run, *beside)),
                width, point, beside, moments)
    for add in ELEMENTS:
        add(s)
    add_legend(s, carried)
    s.close()
    return s
