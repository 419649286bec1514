"""What a page or view knows of a run before its first frame: parts, scales, colours, words."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import chain, repeat
from typing import Any, NamedTuple

import numpy as np

from sandbox.audit.figures import Figure
from sandbox.draw.film import palette
from sandbox.draw.film.bars import bars_of
from sandbox.draw.film.bounds import body_box, whole_box
from sandbox.draw.film.camera import width_shown
from sandbox.draw.film.drives import STIFFENED_CORD, legend_entries
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.finger_names import finger_names
from sandbox.draw.film.fluids import largest_pressure, pressure_text, valve_entries
from sandbox.draw.film.links import has_ropes
from sandbox.draw.film.scales import ForceScale, force_scale
from sandbox.draw.film.tensions import SLACK_FRACTION, Tensions, tensions_of
from sandbox.kinds.arrays import largest_size
from sandbox.kinds.layers import LAYERS, shown
from sandbox.model.ties import held_of
from sandbox.samples.acted import contacts_on, said_of
from sandbox.samples.expectations import Verdict, window
from sandbox.samples.samples import Samples
from sandbox.scene.expand import to_json
from sandbox.show.channels import moving
from sandbox.show.parts import fills_of, parts_of
from sandbox.show.points import Part, css, short

FORMAT = 1
DRAWN = ("bodies", "springs", "tendons", "joints", "contacts", "tensions", "drives", "loads",
         "names", "traces", "velocity", "acceleration", "reactions", "bars", "axes", "coordinates",
         "body_names")
"""The layers that the script draws."""
COLOURS = ("BACKGROUND", "INK", "FAINT_INK", "HAIRLINE", "FORCE", "STOP", "DRIVE", "SPRING",
           "PIN_FILL", "PIN_RING", "SLACK", "ROPE", "TRACE", "VELOCITY", "ACCELERATION", "REACTION",
           "AXES", "LIQUID", "LIQUID_EDGE")
"""Of the palette."""
DRIVE_SYMBOLS = {"made stiffer": "stiffer", "brake holds": "braked", "free": "unbraked",
                 "motor": "motor", "surface runs": "belt", "servo": "servo",
                 "friction holds": "rubs", "slips": "slides", STIFFENED_CORD.words: "wider"}
"""From the words of the films' legend to the script's symbols."""


class FoundOut(NamedTuple):
    """What was found out of a run besides its samples."""

    verdicts: Sequence[Verdict] = ()
    figures: Sequence[Figure] = ()
    source: str = ""
    """Where it lies, as it was called."""


def drawing(run: Filmed) -> dict[str, Any]:
    """All that a ``Stage`` needs to draw frames of a run."""
    mechanism, model = run.mechanism, run.model
    bodies = body_box(run)
    width, height = mechanism.view.size
    across = width_shown(bodies, width / height, mechanism.view.width)
    scale = force_scale(run, across)
    carried = tensions_of(run)
    box = whole_box(run, bodies, scale, across)
    extent = width_shown(box, width / height, mechanism.view.width)
    parts = parts_of(run, scale, extent)
    fills = fills_of(parts)
    pose = run.arrays["body_pose"][0]
    visible = shown(mechanism.view.show, traced=bool(mechanism.view.traces))
    return {
        "format": FORMAT, "name": mechanism.name, "title": mechanism.title or mechanism.name,
        "bodies": [{"name": b.name, "role": b.role, "fixed": bool(f),
                    "centre": [short(v) for v in c]}
                   for b, f, c in zip(mechanism.bodies, model.bodies.fixed,
                                      run.arrays["body_centre"], strict=True)],
        "moving": moving(model).tolist(), "rest": [short(v) for v in pose.ravel()],
        "drives": [{"name": name, "unit": kind.unit, "most": short(most)} for name, kind, most in
                   zip(model.drives.name, model.drives.kind,
                       np.abs(run.arrays["drive_value"]).max(axis=0, initial=0.0), strict=True)],
        "parts": parts, "fills": fills,
        "box": [box.x0, box.y0, box.x1, box.y1],
        "view": {"centre": mechanism.view.centre, "width": mechanism.view.width,
                 "aspect": width / height, "follow": mechanism.view.follow},
        "scale": {"metres": short(scale.metres), "reference": short(scale.reference),
                  "longest": short(scale.longest),
                  "tension": short(carried.largest), "bars": short(_largest_bar(run)),
                  "pressure": short(largest_pressure(run)), "across": short(extent)},
        "colours": {name: css(getattr(palette, name)) for name in COLOURS},
        "ramps": {"pull": [css(c) for c in palette.TENSION],
                  "push": [css(c) for c in palette.PUSH]},
        "fingers": [{"name": name, "body": body} for name, body in finger_names(model)],
        "layers": [{"name": name, "words": LAYERS[name].words, "about": LAYERS[name].about,
                    "on": name in visible} for name in DRAWN],
        "legend": _legend(run, scale, carried, parts),
    }


def _legend(run: Filmed, scale: ForceScale, carried: Tensions,
            parts: Sequence[Part]) -> list[dict[str, Any]]:
    """Symbols by their names with the words before and after, most important first.

    ``l`` is the layer with which one goes, ``of`` the part whose scale it shows.
    """
    found: list[tuple[str, str, str, str]] = [("length", "", "", "")]
    model = run.model
    if scale.metres > 0:
        found.append(("force", "", "contact force " + _on_whom(run), "contacts"))
    kinds = [{"s": "vector", "before": "", "after": part["words"], "l": part["l"], "of": k}
             for k, part in enumerate(parts) if part["k"] == "vectors"]
    late: list[tuple[str, str, str, str]] = []
    if np.hypot(*run.arrays["contact_force"].T).max(initial=0.0) > scale.longest > 0:
        late.append(("cut", "", "larger, cut short", "contacts"))
    if (largest := _largest_bar(run)) > 0:
        late.append(("both", f"bars push {largest:g} N", f"{largest:g} N pull", "bars"))
    if carried.largest > 0:
        end = f"{carried.largest:g} N"
        late.append(("both", f"pushes {end}", f"{end} pulls", "tensions") if carried.pushes
                    else ("pull", "tension 0", end, "tensions"))
    if (pressure := largest_pressure(run)) > 0:
        late.append(("pull", "pressure 0", pressure_text(pressure), "tendons"))
    if has_ropes(model):
        late.append(("rope", "", "rope", "joints"))
    hold = held_of(model.ties.tendon, run.arrays["held"]).T[:, model.tendons.stretch_tendon]
    if (hold & (carried.pieces <= SLACK_FRACTION * carried.largest)).any():
        late.append(("slack", "", "slack", "tendons"))
    if len(model.springs.name):
        late.append(("spring", "", "spring", "springs"))
    late += [(DRIVE_SYMBOLS[entry.words], "", entry.words, "drives")
             for entry in legend_entries(model)]
    if model.loads.name:
        late.append(("load", "", "load", "loads"))
    if model.ties.name:
        late += [("holds", "", "may let go", "joints"), ("gone", "", "let go", "joints")]
    late += [(symbol, "", entry.words, "tendons") for symbol, entry in
             zip(("open", "shut"), valve_entries(model), strict=False)]
    if largest_size(run.arrays["joint_stop"]) > 0:
        late.append(("stop", "", "joint stop", "joints"))
    late += [("trace", "", f"trace, marked every {part['every']:g} s", "traces")
             for part in parts if part["k"] == "trace" and not part["w"]]
    if any(b.motion == "fixed" and b.shapes for b in run.mechanism.bodies):
        late.append(("fixed", "", "fixed", "bodies"))

    def items(rows: list[tuple[str, str, str, str]]) -> list[dict[str, Any]]:
        return [{"s": s, "before": before, "after": after, "l": layer}
                for s, before, after, layer in rows]

    return [*items(found), *kinds, *items(late)]


def _largest_bar(run: Filmed) -> float:
    """Top of the scale of what bodies between two pins carry [N]; 0 if they carry nothing."""
    return tensions_of(run, bars_of(run, range(len(run.mechanism.bodies)))).largest


def _on_whom(run: Filmed) -> str:
    on, _ = contacts_on(run.model, run.arrays)
    other = run.arrays["contact_body"] + run.arrays["contact_other"] - on
    return said_of(run.model, on, other)


def words(run: Samples, told: FoundOut) -> dict[str, Any]:
    """What the page says of a run in tables and texts; no number in it is infinite or none."""
    info = run.info
    return {
        "about": run.mechanism.about, "complete": run.complete, "status": info.status.value,
        "reason": info.reason, "notes": list(run.notes), "source": told.source,
        "samples": len(run), "step": info.step, "rate": info.sample_rate,
        "versions": dict(info.versions),
        "events": [{"name": one.event, "t": one.time} for one in info.events],
        "expect": [_verdict(verdict, over) for verdict, over in zip(
            told.verdicts, chain(windows(run), repeat(None)), strict=False)],
        "audit": [{"name": f.name, "value": number(f.value), "most": number(f.threshold),
                   "unit": f.unit, "verdict": f.verdict, "why": f.why} for f in told.figures],
        "scene": to_json(run.mechanism),
    }


def _verdict(verdict: Verdict, over: list[float] | None) -> dict[str, Any]:
    return {"quantity": verdict.quantity, "statistic": verdict.statistic, "unit": verdict.unit,
            "low": number(verdict.low), "high": number(verdict.high),
            "value": number(verdict.value), "ok": verdict.ok, "because": verdict.because,
            "reason": verdict.reason, "over": over}


def windows(run: Samples) -> Iterator[list[float] | None]:
    """From when to when each verdict on a run's expectations is taken [s], in their order."""
    for expect in run.mechanism.expect:
        times = run.time[window(run, expect)[0]]
        for _ in run.match(expect.quantity) or [""]:
            yield [float(times[0]), float(times[-1])] if len(times) else None


def number(value: float) -> float | None:
    """A number for JSON; none where it is infinite or has no value."""
    return value if math.isfinite(value) else None


