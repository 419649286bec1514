"""Texts and tables of a page: expectations, audit, events, the scene."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, repeat
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from sandbox.audit.figures import Figure
from sandbox.samples.expectations import Verdict, window
from sandbox.samples.samples import Samples
from sandbox.scene.expand import to_json


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
