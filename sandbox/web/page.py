"""One HTML file that shows runs, needs nothing else and lets nothing else in.

Names, titles and units are data: they stand in ``application/json`` where no markup is read, and
the script writes them as text. A Content-Security-Policy of hashes runs this one script and
nothing besides. The files of :data:`MODULES` follow each other in one scope; there is nothing else
to build. They and the styles hold ASCII letters only: a page that is shown in another encoding
keeps its hashes.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from itertools import chain, repeat
from numbers import Integral
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from sandbox.atomic_files import output_path, write_atomic
from sandbox.audit.figures import Figure
from sandbox.elements.quantities import GRASP, by_telling
from sandbox.errors import OutputError
from sandbox.figure import style
from sandbox.picture.options import check_run
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import Verdict, verdicts, window
from sandbox.samples.samples import Samples
from sandbox.scene.expand import to_json
from sandbox.web.drawing import drawing, listed, meters_of
from sandbox.web.packing import level, packed
from sandbox.wording import printable, quoted

MOST_RUNS = 4
"""Runs that a page shows beside each other."""
MOST_PAIRS = 64
"""Pairs of bodies whose contact forces can be plotted, the most loaded ones."""
START = ('\nawait report(document.querySelector("main"),'
         ' [...document.querySelectorAll("script[data-run]")]);\n')
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width,initial-scale=1">
<title>{title}</title><link rel="icon" href="data:,">
<style>{styles}</style></head>
<body><main><p class="loading">loading&hellip;</p>
<noscript>This page draws with a script, which is off.</noscript></main>
{runs}
<script type="module">{script}</script></body></html>
"""
RUN = ('<script type="application/json" data-run>{head}</script>'
       '<script type="text/plain">{data}</script>')
UPLOT = "1.6.32"
"""The version of uPlot (https://github.com/leeoniya/uPlot, MIT) in ``script/uplot/``."""
HASHES = {
    "uPlot.iife.min.js":
        "19c8d4c6ad88929a79f4ae49d6f7161566dfd0ba3d15cc495e974f787eb78f1f",
    "uPlot.min.css":
        "df630c6a8d6f8eeaff264b50f73ce5b114f646ffd9a0bb74f049b0a00135fa04",
    "uPlot.LICENSE":
        "8f989229699b4fe2f1a0432d0e9edc338a8a911e250e2d1b01ecd770a5f5b1bd",
}
"""SHA-256 of its files, as registry.npmjs.org has them in uplot-1.6.32.tgz."""
MODULES = ("data.js", "stage.js", "plots.js", "shell.js", "report.js")
"""In this order: each uses those before it."""
LIVE = ("live.js",)
"""Those that a live view has besides."""
CONSTANTS = f"const MANY_MM = {style.MANY_MM}, TURN = {style.STROKE};"
"""Constants that the script shares with figures."""


@cache
def text_of(name: str) -> str:
    """A file of ``script/``."""
    return files("sandbox.web").joinpath("script", *name.split("/")).read_text(encoding="utf-8")


@cache
def script(*more: str) -> str:
    """The whole module: uPlot, constants, :data:`MODULES`, then ``more`` files of ``script/``."""
    return "\n".join([text_of("uplot/uPlot.iife.min.js"), CONSTANTS,
                      *(text_of(name) for name in (*MODULES, *more))])


@cache
def styles() -> str:
    """The style sheet."""
    return text_of("uplot/uPlot.min.css") + "\n" + text_of("sandbox.css")


def source_hash(text: str) -> str:
    """A source of a Content-Security-Policy that allows just this script or style sheet."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


class FoundOut(NamedTuple):
    """What was found out of a run besides its samples."""

    verdicts: Sequence[Verdict] = ()
    """On what its scene expects; a page judges it where there are none."""
    figures: Sequence[Figure] = ()
    source: str = ""
    """Where it lies, as it was called."""
    parameters: Mapping[str, float] = MappingProxyType({})
    """Of its scene, in SI."""


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


MAX_PARAMETERS = 3
"""Parameters that are named of a run."""


def told_apart(
    titles: Sequence[str], parameters: Sequence[Mapping[str, float]], sources: Sequence[str],
) -> list[str]:
    """A name of each run: its title; of equal ones the parameters that differ, else its place.

    Args:
        titles: of the scenes.
        parameters: of the scenes as they were run, in SI; empty where they are not known.
        sources: where the runs lie.
    """
    if _differ(titles):
        return list(titles)
    names = dict.fromkeys(name for each in parameters for name in each)
    varied = [name for name in names
              if all(name in each for each in parameters)
              and len({each[name] for each in parameters}) > 1]
    told = [_told(each, varied) for each in parameters]
    if not _differ(told):
        told = list(sources)
    if len(set(titles)) == 1:
        return [text or title for text, title in zip(told, titles, strict=True)]
    return [f"{title}: {text}" if text else title
            for title, text in zip(titles, told, strict=True)]


def _told(parameters: Mapping[str, float], varied: Sequence[str]) -> str:
    return ", ".join(f"{name} = {parameters[name]:.4g}" for name in varied[:MAX_PARAMETERS]) + (
        ", \u2026" if len(varied) > MAX_PARAMETERS else "")


def _differ(names: Sequence[str]) -> bool:
    return all(names) and len(set(names)) == len(names)


def report(
    runs: Sequence[Samples], told: Sequence[FoundOut] = (), plots: Sequence[str] = (),
) -> str:
    """The page of one to :data:`MOST_RUNS` runs.

    Equal runs give equal pages, to the byte.

    Args:
        runs: what to show.
        told: of each run what was found out of it, if anything; it is judged without.
        plots: quantities that are plotted at once; by default those of the scene's expectations.

    Raises:
        OutputError: no runs or too many, or one without samples.
    """
    if not runs:
        raise OutputError("there is no run to show; pass at least one", code="bad-picture")
    if len(runs) > MOST_RUNS:
        raise OutputError(f"a page shows up to {MOST_RUNS} runs, {len(runs)} were given",
                          code="bad-picture")
    for run in runs:
        check_run(run)
    told = [_judged(run, found) for run, found in zip(
        runs, [*told, *(FoundOut() for _ in runs[len(told):])], strict=True)]
    titles = [run.mechanism.title or run.mechanism.name for run in runs]
    names = told_apart(titles, [found.parameters for found in told],
                       [found.source for found in told])
    pieces = [_run(run, [other for other in runs if other is not run], found, name, list(plots))
              for run, found, name in zip(runs, told, names, strict=True)]
    code, looks = script(), styles()
    policy = (f"default-src 'none'; script-src {source_hash(code + START)}; "
              f"style-src {source_hash(looks)}; img-src data: blob:; media-src blob:; "
              "base-uri 'none'; form-action 'none'")
    title = printable(" / ".join(dict.fromkeys(titles)))
    return PAGE.format(policy=policy, title=html.escape(title), styles=looks,
                       runs="\n".join(pieces), script=code + START)


def _judged(run: Samples, told: FoundOut) -> FoundOut:
    """With the verdicts on what the scene expects, where they were not given."""
    return told if told.verdicts else told._replace(verdicts=verdicts(run))


def _run(
    run: Samples, beside: Sequence[Samples], told: FoundOut, name: str, plots: list[str],
) -> str:
    subject, box = listed(run, beside)
    numbers = packed(run, subject.out, quantities(run, plots), subject.width)
    head = {**drawing(run, subject, box), "words": words(run, told, name),
            "sizes": numbers.sizes, "thinned": numbers.thinned,
            "meters": [] if plots else meters_of(run.mechanism.view, run.catalogue),
            "plots": plots or _default_plots(run, told)}
    return RUN.format(head=safe_json(head), data=base64.b64encode(numbers.data).decode())


def quantities(run: Samples, plots: Sequence[str] = ()) -> list[str]:
    """What can be plotted: nearly all, and the forces of the pairs that touch.

    Not how well objects are held, which takes long, unless it is asked for or expected.
    """
    elements = run.catalogue.elements
    wanted = {*plots, *(name for expect in run.mechanism.expect
                        for name in run.match(expect.quantity))}
    names = []
    for head, element in elements.items():
        fixed = element.kind == "body" and run.mechanism.bodies[element.index].motion == "fixed"
        for quantity in by_telling(element.quantities):
            name = f"{head}.{quantity}" if quantity else head
            spare = (element.kind == "body" and quantity in GRASP) or (
                fixed and not quantity.startswith("contact."))
            if name in wanted or not spare:
                names.append(name)
    shown = (name for meter in meters_of(run.mechanism.view, run.catalogue)
             for name in meter["names"])
    return list(dict.fromkeys([*names, *wanted, *shown, *_pairs(run)]))


def _pairs(run: Samples) -> list[str]:
    """``a/b.normal`` of the pairs that press the most."""
    arrays, bodies = run.arrays, run.mechanism.bodies
    keys, which = np.unique(arrays["contact_body"] * len(bodies) + arrays["contact_other"],
                            return_inverse=True)
    pairs = np.stack((keys // len(bodies), keys % len(bodies)), axis=1)
    total = np.bincount(which, np.hypot(*arrays["contact_force"].T), minlength=len(pairs))
    order = np.argsort(-total, kind="stable")[:MOST_PAIRS]
    return [f"{bodies[a].name}/{bodies[b].name}.normal" for a, b in pairs[np.sort(order)]]


def _default_plots(run: Samples, told: FoundOut) -> list[str]:
    """What the scene says something of: expectations, meters, cords, else what is usual."""
    usual = run.catalogue.usual
    expected = [verdict.quantity for verdict in told.verdicts if verdict.quantity in run]
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


HEIGHT = 760
"""Of the frame [pixels]."""
LOWEST, HIGHEST = 200, 4000


@dataclass(frozen=True, repr=False)
class RunPage:
    """One HTML file that plays a run."""

    text: str
    about: str
    """In a line, for who cannot see it."""
    height: int = HEIGHT
    """Of the frame that it is shown in [pixels]."""

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it to a file.

        Raises:
            OutputError: another ending than .html or .htm, or it cannot be written.
        """
        file = output_path(path, "a page")
        if file.suffix.lower() not in (".html", ".htm"):
            raise OutputError(f"{file}: a page is an .html file", code="bad-picture")
        write_atomic(file, self.text)

    def __repr__(self) -> str:
        return f"<RunPage of {self.about}, {len(self.text) / 1000:.0f} kB>"

    def _repr_html_(self) -> str:
        """A frame whose script reaches nothing of the notebook: it may run and save, no more."""
        return ('<iframe sandbox="allow-scripts allow-downloads" '
                f'style="width:100%;height:{self.height}px;border:0" '
                f'title="{html.escape(self.about)}" '
                f'srcdoc="{html.escape(self.text, quote=True)}"></iframe>')


def page(run: Recording, quantities: Sequence[str], height: int) -> RunPage:
    """See :meth:`sandbox.Recording.page`."""
    if not isinstance(height, Integral) or not LOWEST <= height <= HIGHEST:
        raise OutputError(f"height={quoted(height)} is no height of a page; pass {LOWEST} to "
                          f"{HIGHEST} pixels", code="bad-picture")
    plots = list(dict.fromkeys(name for each in quantities for name in run.names(each)))
    told = FoundOut(verdicts=run.verdicts, figures=run.audit)
    return RunPage(report([run], [told], plots), f"{run.mechanism.name or 'a run'} in motion",
                height)
