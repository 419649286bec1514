"""One mechanism simulated at h, h/2 and h/4, and its quantities at common instants.

All runs are sampled at every step, to include peaks between the scene's samples. A run that
diverges is kept up to that point.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numpy as np

from sandbox.audit.audit import Figure, audit
from sandbox.elements.controllers.controller import every
from sandbox.engine.simulate import simulate
from sandbox.errors import SimulationDiverged
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Outcome
from sandbox.scene.mechanism import Mechanism

Progress = Callable[[float], None]
Run = tuple[Recording, list[Figure]]
"""A run and its audit."""
LABELS = ("h", "h/2", "h/4")
LONG = 1.0
"""If the run at h takes longer [s], the other two run in processes of their own."""


def refined(mechanism: Mechanism, parts: int) -> Mechanism:
    """The mechanism with a step ``parts`` times finer, sampled at every step.

    Controllers and events keep the rates that they have at the mechanism's own step.
    """
    run = mechanism.run
    step = run.step / parts
    rates: dict[str, Any] = {
        kind: tuple(each.model_copy(update={"rate": 1 / (every(each.rate, run.step) * run.step)})
                    for each in getattr(mechanism, kind)) for kind in ("controllers", "events")}
    return mechanism.model_copy(update={
        "run": run.model_copy(update={"step": step, "sample_rate": 1 / step}), **rates})


def simulate_all(mechanism: Mechanism, progress: Progress) -> list[Run]:
    """Simulate at h, h/2 and h/4, each up to where it diverges, and audit the runs."""
    first, *others = (refined(mechanism, parts) for parts in (1, 2, 4))
    began = time.perf_counter()
    found = [_run(first, lambda share: progress(share / 7))]
    if time.perf_counter() - began > LONG:
        with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
            found += [(Recording(scene, arrays, outcome), figures) for scene, (
                arrays, outcome, figures) in zip(others, pool.map(_remote, others), strict=True)]
    else:
        found += [_run(others[0], lambda share: progress((1 + 2 * share) / 7)),
                  _run(others[1], lambda share: progress((3 + 4 * share) / 7))]
    progress(1.0)
    return found


def _run(mechanism: Mechanism, progress: Progress | None = None) -> Run:
    try:
        run = simulate(mechanism, progress=progress)
    except SimulationDiverged as error:
        if error.recording is None:
            raise
        run = error.recording
    return run, audit(run)


def _remote(mechanism: Mechanism) -> tuple[dict[str, Any], Outcome, list[Figure]]:
    """A run in another process; arrays in files are copied."""
    run, figures = _run(mechanism)
    return {key: np.array(array) for key, array in run.arrays.items()}, run.info, figures


def at_instants(time: Array, values: Array, wanted: Array) -> Array:
    """``values`` [n] at evenly spaced ``time`` [n], interpolated at the instants ``wanted`` [m].

    Poses of a run with step h belong to t = (k - 1/2) h, so runs at h and h/2 have no instant in
    common. The cubic through the four nearest samples has an error of fourth order. Where they
    jump, as in an impact (the third difference is then as large as the second), the cubic is
    clipped to their range.
    """
    if len(time) < 4:
        raise ValueError(f"time must hold at least 4 samples, got {len(time)}")
    spacing = (time[-1] - time[0]) / (len(time) - 1)
    place = (wanted - time[0]) / spacing
    first = np.clip(np.floor(place).astype(int) - 1, 0, len(time) - 4)
    u = place - first
    near = values[first[:, None] + np.arange(4)]
    weights = np.stack([
        -(u - 1) * (u - 2) * (u - 3) / 6, u * (u - 2) * (u - 3) / 2,
        -u * (u - 1) * (u - 3) / 2, u * (u - 1) * (u - 2) / 6], axis=1)
    read = (weights * near).sum(axis=1)
    bend = np.abs(np.diff(near, n=2, axis=1)).max(axis=1)
    jumps = np.abs(np.diff(near, n=3, axis=1))[:, 0] > 0.5 * bend
    clipped = np.clip(read, near.min(axis=1), near.max(axis=1))
    return np.asarray(np.where(jumps & (u >= 0) & (u <= 3), clipped, read))
