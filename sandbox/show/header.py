"""What a page or view knows of a run before its first frame: parts, scales, colours, words."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, repeat
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from sandbox.audit.figures import Figure
from sandbox.model.ties import held_of
from sandbox.numeric import Array
from sandbox.picture import palette
from sandbox.picture.bars import bars_of
from sandbox.picture.bounds import body_box, whole_box
from sandbox.picture.build import subject_of
from sandbox.picture.camera import Rectangle, width_shown
from sandbox.picture.elements.fluids import largest_pressure, pressure_text
from sandbox.picture.marked import finger_names
from sandbox.picture.run_data import RunData
from sandbox.picture.scales import LONGEST, ForceScale, force_scale
from sandbox.picture.tensions import SLACK_FRACTION, Tensions, tensions_of
from sandbox.samples.contacts import contacts_on, said_of
from sandbox.samples.expectations import Verdict, window
from sandbox.samples.samples import Samples
from sandbox.scene.expand import to_json
from sandbox.scene.layers import LAYERS, shown
from sandbox.scene.settings import View
from sandbox.show.channels import moving, vectors_of
from sandbox.show.drawing import SYMBOLS, arrow_sign, fixed_style, signs_in
from sandbox.show.parts import fills_of, parts_of
from sandbox.show.points import Part, css, short

COLOURS = ("BACKGROUND", "INK", "FAINT_INK", "HAIRLINE", "FORCE", "STOP", "DRIVE", "SPRING",
           "PIN_FILL", "PIN_RING", "SLACK", "ROPE", "TRACE", "VELOCITY", "ACCELERATION", "REACTION",
           "AXES", "LIQUID", "LIQUID_EDGE")
"""Of the palette."""


class FoundOut(NamedTuple):
    """What was found out of a run besides its samples."""

    verdicts: Sequence[Verdict] = ()
    """On what its scene expects; a page judges it where there are none."""
    figures: Sequence[Figure] = ()
    source: str = ""
    """Where it lies, as it was called."""
    parameters: Mapping[str, float] = MappingProxyType({})
    """Of its scene, in SI."""


def _whole(run: RunData, bodies: Rectangle, scale: ForceScale, across: float,
           view: View) -> Rectangle:
    """What a page shows of a run [m]: its bodies and arrows."""
    out = subject_of(run, view, width=across, point=across / 800, force=scale).out
    return whole_box(out, run, bodies, view)


def drawing(run: RunData) -> dict[str, Any]:
    """All that a ``Stage`` needs to draw frames of a run."""
    mechanism, model = run.mechanism, run.model
    bodies = body_box(run)
    width, height = mechanism.view.size
    across = width_shown(bodies, width / height, mechanism.view.width)
    scale = force_scale(run, across)
    carried = tensions_of(run)
    box = _whole(run, bodies, scale, across, mechanism.view)
    extent = width_shown(box, width / height, mechanism.view.width)
    parts = parts_of(run, scale, extent)
    legend = _legend(run, scale, carried, parts)
    fills = fills_of([*parts, *legend])
    pose = run.arrays["body_pose"][0]
    visible = shown(mechanism.view.show, traced=bool(mechanism.view.traces))
    return {
        "name": mechanism.name, "title": mechanism.title or mechanism.name,
        "bodies": [{"name": b.name, "fixed": bool(f), "centre": [short(v) for v in c]}
                   for b, f, c in zip(mechanism.bodies, model.bodies.fixed,
                                      run.arrays["body_centre"], strict=True)],
        "moving": moving(model).tolist(), "rest": [short(v) for v in pose.ravel()],
        "drives": [{"name": name, "unit": kind.unit, "most": short(most)} for name, kind, most in
                   zip(model.drives.name, model.drives.kind,
                       np.abs(run.arrays["drive_value"]).max(axis=0, initial=0.0), strict=True)],
        "parts": parts, "fills": fills,
        "box": _corners(box), "unfollowed": _corners(_unfollowed(run, scale, box)),
        "view": {"centre": mechanism.view.centre, "width": mechanism.view.width,
                 "aspect": width / height, "follow": mechanism.view.follow,
                 "speed": mechanism.view.speed},
        "scale": {"metres": short(scale.metres), "reference": short(scale.reference),
                  "longest": short(scale.longest),
                  "tension": short(carried.largest), "bars": short(_largest_bar(run)),
                  "pressure": short(largest_pressure(run)), "across": short(extent)},
        "colours": {name: css(getattr(palette, name)) for name in COLOURS},
        "ramps": {"pull": [css(c) for c in palette.TENSION],
                  "push": [css(c) for c in palette.PUSH]},
        "fingers": [{"name": name, "body": body} for name, body in finger_names(model)],
        "layers": [{"name": name, "words": layer.words, "about": layer.about,
                    "on": name in visible} for name, layer in LAYERS.items()],
        "legend": legend,
    }


def _corners(box: Rectangle) -> list[float]:
    return [box.x0, box.y0, box.x1, box.y1]


def _unfollowed(run: RunData, scale: ForceScale, box: Rectangle) -> Rectangle:
    """What is shown once nobody is followed any more [m]."""
    view = run.mechanism.view
    if view.follow is None:
        return box
    still = view.model_copy(update={"follow": None})
    bodies = body_box(run, still)
    across = width_shown(bodies, view.size[0] / view.size[1], view.width)
    return _whole(run, bodies, scale, across, still)


def _legend(run: RunData, scale: ForceScale, carried: Tensions,
            parts: Sequence[Part]) -> list[dict[str, Any]]:
    """Symbols by their names with their widths and the words about them, most important first.

    ``l`` are the layers with any of which one goes, none if it is always there, ``of`` is the part
    whose scale it shows, ``f`` its fill and edge.
    """
    found: list[dict[str, Any]] = [{"s": "length", "before": "", "after": "", "l": []}]
    if scale.metres > 0:
        found.append({"s": "force", "before": "", "after": "contact force " + _on_whom(run),
                      "l": ["contacts"]})
    signs = {arrow_sign(part["bend"], part["scaled"]) for part in parts
             if part["k"] == "drive" and part["most"] > 0}
    if "scaled" in signs:  # which arrows are only where there is such a scale
        found.append({"s": "scaled", "before": "", "after": SYMBOLS["scaled"].words,
                      "l": [SYMBOLS["scaled"].layer]})
    found += [{"s": "load", "before": "", "after": "load", "l": ["loads"], "of": k}
              for k, part in enumerate(parts) if part["k"] == "loads" and part["metres"] > 0]
    found += [{"s": "vector", "before": "", "after": part["words"], "l": [part["l"]], "of": k}
              for k, part in enumerate(parts) if part["k"] == "vectors"]
    numbers, there = _legend_numbers(run, carried, parts), signs_in(run)
    there |= signs - {"scaled"}
    if cut := _cut(run, scale, parts):
        there.add("cut")
    if any(part["k"] == "pressure" for part in parts):
        there.add("patch")
    model = run.model
    hold = held_of(model.ties.tendon, run.arrays["held"]).T[:, model.tendons.stretch_tendon]
    if (hold & (carried.pieces <= SLACK_FRACTION * carried.largest)).any():
        there.add("slack")
    if fixed := fixed_style(run, range(len(run.mechanism.bodies))):
        there.add("fixed")
    return found + [
        {"s": name, "before": row.before.format(numbers.get(name)),
         "after": row.words.format(numbers.get(name)), "w": row.width,
         "l": cut if name == "cut" else [row.layer],
         **({"f": fixed} if name == "fixed" else {})}
        for name, row in SYMBOLS.items() if name in numbers or name in there]


def _legend_numbers(run: RunData, carried: Tensions, parts: Sequence[Part]) -> dict[str, str]:
    """Of symbols that stand for a scale, where it ends; of traces how often they are marked."""
    tops = {"bars": _largest_bar(run), "both" if carried.pushes else "pull": carried.largest}
    found = {name: f"{top:g} N" for name, top in tops.items() if top > 0}
    if (pressure := largest_pressure(run)) > 0:
        found["pressure"] = pressure_text(pressure)
    traces = [part for part in parts if part["k"] == "trace"]
    return found | ({"trace": f"{traces[0]['every']:g} s"} if traces else {})


def _cut(run: RunData, scale: ForceScale, parts: Sequence[Part]) -> list[str]:
    """The layers in which an arrow is ever cut short."""
    arrays, vectors, found = run.arrays, vectors_of(run), dict[str, None]()
    for part in parts:
        if part["k"] == "contacts":
            sizes, longest = _contacts_of(run, part), scale.longest
        elif part["k"] == "vectors":
            values = np.nan_to_num(vectors[part["v"]][1].values)[:, part.get("of", slice(None))]
            sizes, longest = np.hypot(*values.T), part["longest"]
        elif part["k"] == "loads":
            values = arrays["load_force"][:, part.get("of", slice(None))]
            sizes, longest = np.hypot(*values.T), part["longest"]
        elif part["k"] == "drive" and not part["bend"]:
            sizes = np.abs(arrays["drive_value"][:, part["d"]])
            longest = scale.longest if part["scaled"] else LONGEST * part["usual"]
        else:
            continue
        if sizes.max(initial=0.0) > longest * (1 + 1e-6) > 0:  # `longest` is rounded
            found[part["l"]] = None
    return list(found)


def _contacts_of(run: RunData, part: Part) -> Array:
    """Sizes of the contact forces that a part shows, [m] N."""
    sizes: Array = np.hypot(*run.arrays["contact_force"].T)
    if "of" in part:
        body, other = (np.isin(run.arrays[f"contact_{name}"], part["of"])
                       for name in ("body", "other"))
        sizes = sizes[body | other]
    return sizes


def _largest_bar(run: RunData) -> float:
    """Top of the scale of what bodies between two pins carry [N]; 0 if they carry nothing."""
    return tensions_of(run, bars_of(run, range(len(run.mechanism.bodies)))).largest


def _on_whom(run: RunData) -> str:
    on, _ = contacts_on(run.model, run.arrays)
    other = run.arrays["contact_body"] + run.arrays["contact_other"] - on
    return said_of(run.model, on, other)


def words(run: Samples, told: FoundOut, apart: str = "") -> dict[str, Any]:
    """What the page says of a run in tables and texts; no number in it is infinite or none.

    ``apart`` is what tells it from others beside it.
    """
    info = run.info
    return {
        "about": run.mechanism.about, "complete": run.complete, "status": info.status.value,
        "reason": info.reason, "notes": list(run.notes), "apart": apart,
        "samples": len(run), "step": info.step, "rate": info.sample_rate,
        "versions": dict(info.versions),
        "events": [{"name": one.event, "t": one.time} for one in info.marked],
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
    """From when to when each verdict on a run's expectations is taken [s], in their order.

    A last value is taken at the end of its window, one at an instant there.
    """
    for expect in run.mechanism.expect:
        times = run.time[window(run, expect)[0]]
        if expect.at is not None and len(times):
            times = np.array([expect.at])
        times = times[-1:] if expect.statistic == "final" else times
        for _ in run.match(expect.quantity) or [""]:
            yield [float(times[0]), float(times[-1])] if len(times) else None


def number(value: float) -> float | None:
    """A number for JSON; none where it is infinite or has no value."""
    return value if math.isfinite(value) else None


