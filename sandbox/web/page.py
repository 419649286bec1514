"""One HTML file that shows runs, needs nothing else and lets nothing else in.

Names, titles and units are data: they stand in ``application/json`` where no markup is read, and
the script writes them as text. A Content-Security-Policy of hashes runs this one script and
nothing besides.
"""

from __future__ import annotations

import base64
import html
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from numbers import Integral
from typing import Any

import numpy as np

from sandbox.atomic_files import output_path, write_atomic
from sandbox.elements.quantities import GRASP, by_telling
from sandbox.errors import OutputError
from sandbox.picture.options import check_run
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import verdicts
from sandbox.samples.samples import Samples
from sandbox.web.drawing import drawing, listed
from sandbox.web.files import script, source_hash, styles
from sandbox.web.meters import meters_of
from sandbox.web.packing import level, packed
from sandbox.web.words import FoundOut, told_apart, words
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
