"""One HTML file that shows runs, without a network.

Names, titles and units are data: they stand in ``application/json`` where no markup is read, and
the script writes them as text. A Content-Security-Policy of hashes allows this one script only. The
files of :data:`MODULES` share one scope. They and the styles are ASCII: a page that is shown in
another encoding keeps its hashes.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from importlib.resources import files
from itertools import chain, repeat
from typing import Any, NamedTuple

import numpy as np

from sandbox.audit.evidence import Figure
from sandbox.elements.quantities import GRASP, by_telling
from sandbox.errors import OutputError
from sandbox.figure import style
from sandbox.picture.options import check_run
from sandbox.samples.expectations import Verdict, verdicts, window
from sandbox.samples.samples import Samples
from sandbox.scene.expand import to_json
from sandbox.web.drawing import drawing, listed, meters_of
from sandbox.web.packing import level, packed
from sandbox.wording import printable

MAX_RUNS = 4
MAX_PAIRS = 64  # pairs of bodies whose contact forces can be plotted, the most loaded ones
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">{meta}
<meta name="viewport" content="width=device-width,initial-scale=1">
<title>{title}</title><link rel="icon" href="data:,">
<style>{styles}</style></head>
<body><main><p class="loading">loading&hellip;</p>
<noscript>This page draws with a script, which is off.</noscript></main>
{data}
<script type="module">{script}</script></body></html>
"""
START = ('\nawait report(document.querySelector("main"),'
         ' [...document.querySelectorAll("script[data-run]")]);\n')
MODULES = ("data.js", "stage.js", "items.js", "plots.js", "shell.js", "report.js")
"""In this order: each uses those before it."""
CONSTANTS = (f"const MANY_MM = {style.MANY_MM}, TURN = {style.STROKE}, "
             f"PRESSURES = {json.dumps(style.PRESSURES)};")
"""Constants that the script shares with figures."""


@cache
def text_of(name: str) -> str:
    """A file of ``script/``."""
    return files("sandbox.web").joinpath("script", *name.split("/")).read_text(encoding="utf-8")


@cache
def script(start: str, *more: str) -> str:
    """The whole module: uPlot, :data:`MODULES`, ``more`` files of ``script/``, then ``start``."""
    return "\n".join([text_of("uplot/uPlot.iife.min.js"), CONSTANTS,
                      *(text_of(name) for name in (*MODULES, *more))]) + start


@cache
def styles() -> str:
    """The style sheet."""
    return text_of("uplot/uPlot.min.css") + "\n" + text_of("sandbox.css")


def html_page(title: str, code: str, *, meta: str = "", data: str = "") -> str:
    """A page that runs one script."""
    return PAGE.format(title=html.escape(printable(title)), styles=styles(), script=code,
                       meta=meta, data=data)


def policy(code: str) -> str:
    """A Content-Security-Policy that allows just this script and the style sheet."""
    script_hash, style_hash = (
        f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
        for text in (code, styles()))
    return (f"default-src 'none'; script-src {script_hash}; style-src {style_hash}; "
            "img-src data: blob:; media-src blob:; base-uri 'none'; form-action 'none'")


class FoundOut(NamedTuple):
    """Data about a run besides its samples."""

    verdicts: Sequence[Verdict] = ()  # computed where there are none
    figures: Sequence[Figure] = ()
    source: str = ""  # its directory


def words(run: Samples, known: FoundOut, apart: str = "") -> dict[str, Any]:
    """Texts and tables of a run; ``apart`` is a name that distinguishes it from others."""
    def finite(one: Verdict | Figure) -> dict[str, Any]:
        return {key: None if isinstance(value, float) and not math.isfinite(value) else value
                for key, value in vars(one).items()}

    info = run.info
    return {
        "about": run.mechanism.about, "complete": run.complete, "status": info.status.value,
        "reason": info.reason, "notes": list(run.notes), "apart": apart,
        "samples": len(run), "step": info.step, "rate": info.sample_rate,
        "versions": dict(info.versions),
        "events": [{"name": one.event, "t": one.time} for one in info.marked],
        "expect": [{**finite(v), "allowed": v.allowed, "over": over} for v, over in zip(
            known.verdicts, chain(_windows(run), repeat(None)), strict=False)],
        "audit": [finite(figure) for figure in known.figures],
        "scene": to_json(run.mechanism),
    }


def _windows(run: Samples) -> Iterator[list[float] | None]:
    """Begin and end of the window of each verdict on a run's expectations [s], in their order.

    A last value is taken at the end of its window, one at an instant there.
    """
    for expect in run.mechanism.expect:
        times = run.time[window(run, expect)[0]]
        if expect.at is not None and len(times):
            times = np.array([expect.at])
        times = times[-1:] if expect.statistic == "final" else times
        for _ in run.match(expect.quantity) or [""]:
            yield [float(times[0]), float(times[-1])] if len(times) else None


def report(
    runs: Sequence[Samples], known: Sequence[FoundOut] = (), plots: Sequence[str] = (),
) -> str:
    """The page of one to :data:`MAX_RUNS` runs; equal runs give equal pages, to the byte.

    ``known`` has data about each run; ``plots`` are quantities that are plotted at once, by default
    those of the scene's expectations.

    Raises:
        OutputError: no runs or too many, or one without samples.
    """
    if not 1 <= len(runs) <= MAX_RUNS:
        raise OutputError(f"a page shows up to {MAX_RUNS} runs, {len(runs)} were given" if runs
                          else "there is no run to show; pass at least one", code="bad-picture")
    for run in runs:
        check_run(run)
    known = [found if found.verdicts else found._replace(verdicts=verdicts(run))
            for run, found in zip(runs, chain(known, repeat(FoundOut())), strict=False)]
    titles = [run.mechanism.title or run.mechanism.name for run in runs]
    sources = [found.source for found in known]
    names = next((each for each in (titles, sources) if len(set(each)) == len(runs)), titles)
    pieces = []
    for run, found, name in zip(runs, known, names, strict=True):
        subject, box = listed(run, [other for other in runs if other is not run])
        numbers = packed(run, subject.out, quantities(run, plots), subject.width)
        head = safe_json({
            **drawing(run, subject, box), "words": words(run, found, name),
            "thinned": numbers.thinned,
            "meters": [] if plots else meters_of(run.mechanism.view, run.catalogue),
            "plots": list(plots) or _default_plots(run, found)})
        lines = "\n".join(base64.b64encode(part).decode() for part in numbers.parts)
        pieces.append(f'<script type="application/json" data-run>{head}</script>'
                      f'<script type="text/plain">{lines}</script>')
    code = script(START)
    return html_page(" / ".join(dict.fromkeys(titles)), code, data="\n".join(pieces), meta=(
        f'\n<meta http-equiv="Content-Security-Policy" content="{policy(code)}">'))


def quantities(run: Samples, plots: Sequence[str] = ()) -> list[str]:
    """Quantities that can be plotted: nearly all, and the forces of pairs in contact.

    Grasp measures, which take long, are included only if they are in ``plots`` or expected.
    """
    bodies, arrays = run.mechanism.bodies, run.arrays
    wanted = dict.fromkeys([*plots, *(name for expect in run.mechanism.expect
                                      for name in run.match(expect.quantity))])
    names = []
    for head, element in run.catalogue.elements.items():
        fixed = element.kind == "body" and bodies[element.index].motion == "fixed"
        for quantity in by_telling(element.quantities):
            name = f"{head}.{quantity}" if quantity else head
            spare = (element.kind == "body" and quantity in GRASP) or (
                fixed and not quantity.startswith("contact."))
            if name in wanted or not spare:
                names.append(name)
    shown = [name for meter in meters_of(run.mechanism.view, run.catalogue)
             for name in meter["names"]]
    keys, which = np.unique(arrays["contact_body"] * len(bodies) + arrays["contact_other"],
                            return_inverse=True)
    total = np.bincount(which, np.hypot(*arrays["contact_force"].T), minlength=len(keys))
    loaded = np.sort(np.argsort(-total, kind="stable")[:MAX_PAIRS])
    pairs = [f"{bodies[a].name}/{bodies[b].name}.normal"
             for a, b in (divmod(key, len(bodies)) for key in keys[loaded].tolist())]
    return list(dict.fromkeys([*names, *wanted, *shown, *pairs]))


def _default_plots(run: Samples, known: FoundOut) -> list[str]:
    """The first of these that change: expectations, meters, tendons, else the usual quantities."""
    usual = run.catalogue.usual
    expected = [verdict.quantity for verdict in known.verdicts if verdict.quantity in run]
    for names in ((*expected, *usual["meter"], *usual["tendon"]),
                  (*usual["joint"], *usual["drive"]), (*usual["spring"], *usual["body"])):
        if found := [name for name in dict.fromkeys(names)
                     if level(np.nan_to_num(run[name]), 0.0) is None]:
            return found
    return []


def safe_json(data: Mapping[str, Any]) -> str:
    """JSON in ASCII that may stand in a script element: nothing in it ends or opens a tag."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
