"""The runs behind a certificate: one mechanism at h, h/2, h/4.

All are sampled every step, so that a peak between two samples of the scene is seen. A run that
diverges ends there and is kept as far as it came: that another step ends well, or does not
either, is part of the answer.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.audit.audit import Figure, audit
from sandbox.engine.simulate import simulate
from sandbox.errors import SimulationDiverged
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Outcome
from sandbox.scene.mechanism import Mechanism
from sandbox.study.refine import refined

Progress = Callable[[float], None]
LABELS = ("h", "h/2", "h/4")
"""Of the three runs."""
LONG = 1.0
"""A run that takes longer than this [s] has its refinements made in processes of their own."""


@dataclass(frozen=True)
class Repeat:
    """One run of a certificate."""

    label: str
    """Of :data:`LABELS`."""
    recording: Recording
    """Sampled every step, up to where it came."""
    figures: tuple[Figure, ...]
    """Of its audit."""


def variants(mechanism: Mechanism) -> list[Mechanism]:
    """The three runs of a certificate: h, h/2, h/4."""
    three = [refined(mechanism), refined(mechanism, parts=2), refined(mechanism, parts=4)]
    return [one.model_copy(update={"run": one.run.model_copy(
        update={"sample_rate": 1 / one.run.step})}) for one in three]


def repeats(mechanism: Mechanism, progress: Progress) -> list[Repeat]:
    """All three, in order; the long ones side by side.

    Raises:
        Interrupted: Ctrl-C.
    """
    wanted = variants(mechanism)
    steps = np.array([m.run.duration / m.run.step for m in wanted])
    ends = np.cumsum(steps) / steps.sum()
    began = time.perf_counter()
    found = [_made(wanted[0], _between(progress, 0.0, ends[0]))]
    if time.perf_counter() - began > LONG:
        found += _side_by_side(wanted[1:], _between(progress, ends[0], 1.0))
    else:
        found += [_made(one, _between(progress, start, end))
                  for one, start, end in zip(wanted[1:], ends, ends[1:], strict=False)]
    progress(1.0)
    return [Repeat(label, recording, tuple(figures))
            for label, (recording, figures) in zip(LABELS, found, strict=True)]


def _made(mechanism: Mechanism, progress: Progress | None = None) -> tuple[Recording, list[Figure]]:
    """A run, as far as it came, and its audit."""
    try:
        run = simulate(mechanism, progress=progress)
    except SimulationDiverged as error:
        if error.recording is None:
            raise
        run = error.recording
    return run, audit(run)


def _between(progress: Progress, start: float, end: float) -> Progress:
    """Progress of one run of several, from fraction ``start`` to fraction ``end``."""
    return lambda fraction: progress(float(start + fraction * (end - start)))


def _side_by_side(
    wanted: list[Mechanism], progress: Progress,
) -> list[tuple[Recording, list[Figure]]]:
    steps = np.array([m.run.duration / m.run.step for m in wanted])
    done = 0.0
    found: dict[int, tuple[Recording, list[Figure]]] = {}
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        order = sorted(range(len(wanted)), key=lambda i: -steps[i])  # the longest first
        jobs = {pool.submit(_far, wanted[i]): i for i in order}
        for job in as_completed(jobs):
            i = jobs[job]
            arrays, info, figures = job.result()
            found[i] = Recording(wanted[i], arrays, info), figures
            done += float(steps[i] / steps.sum())
            progress(done)
    return [found[i] for i in range(len(wanted))]


def _far(mechanism: Mechanism) -> tuple[dict[str, NDArray[Any]], Outcome, list[Figure]]:
    """A run in another process: its arrays come back, what lives in files is copied."""
    run, figures = _made(mechanism)
    return {key: np.array(array) for key, array in run.arrays.items()}, run.info, figures


def looks(found: list[Repeat]) -> list[tuple[Figure, tuple[str, ...]]]:
    """What the audits ask for a look at: each figure where it is worst, and the runs it is in."""
    kept: dict[str, tuple[Figure, tuple[str, ...]]] = {}
    for repeat in found:
        for figure in repeat.figures:
            if figure.verdict != "look":
                continue
            worst, where = kept.get(figure.name, (figure, ()))
            kept[figure.name] = max(worst, figure, key=_excess), (*where, repeat.label)
    return list(kept.values())


def _excess(figure: Figure) -> float:
    """How many times a figure exceeds its threshold; what is no number is the worst."""
    ratio = figure.value / figure.threshold if figure.threshold else math.inf
    return ratio if math.isfinite(ratio) else math.inf
