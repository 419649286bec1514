"""Runs one point of a sweep: values of paths in, a row out."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sandbox.audit.audit import audit
from sandbox.engine.inspect_control import Checked, control_problems
from sandbox.engine.simulate import simulate
from sandbox.errors import SandboxError, SceneError
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import measured, verdicts, window
from sandbox.scene.read.load import Loaded, read_scene
from sandbox.scene.settings import Looked
from sandbox.sweeps.job import DONE, ENDED, Point, SweepJob, SweepRow
from sandbox.values.expressions import parse_expression

MAX_REASON = 500  # characters of a reason that a row keeps
Scene = Path | Mapping[str, Any]


def load_scene(job: SweepJob, scene: Scene, values: Point) -> tuple[Loaded, Checked]:
    """The scene at one point, of which only its controllers need a check after reading."""
    loaded = read_scene(scene, overrides={**job.set, **values}, limits=job.limits)
    if problems := control_problems(loaded.mechanism):
        raise SceneError(loaded.placed(problems), loaded.name)
    return loaded, Checked(loaded.mechanism)


def run_point(job: SweepJob, scene: Scene, id: str, values: Point) -> SweepRow:
    """Run one point; errors of the run are in its row."""
    try:
        loaded, mechanism = load_scene(job, scene, values)
        recording = simulate(mechanism, recorded_bytes=job.limits.recorded_bytes)
    except tuple(ENDED) as error:
        status = next(status for kind, status in ENDED.items() if isinstance(error, kind))
        text = "; ".join(map(str, error.problems)) if isinstance(error, SceneError) else str(error)
        return SweepRow(id, status, reason=" ".join(text.split())[:MAX_REASON])
    parameters = loaded.scene.parameters
    if job.recordings:
        recording.save(Path(job.recordings, id), parameters=parameters)
    kept, missing = read_results(recording, job.keep, parameters)
    judged = verdicts(recording)
    looks = tuple(figure.name for figure in audit(recording) if figure.verdict == "look") \
        if job.audited else None
    return SweepRow(
        id, DONE, reason="; ".join(missing)[:MAX_REASON], kept=kept,
        holds=all(verdict.ok for verdict in judged) if judged else None,
        failed=tuple(dict.fromkeys(v.quantity for v in judged if not v.ok)), looks=looks)


def read_results(
    run: Recording, keep: Mapping[str, Looked | str], parameters: Mapping[str, float],
) -> tuple[dict[str, float | None], list[str]]:
    """Results of a run by name, and why some have no value."""
    found: dict[str, float | None] = {}
    missing: list[str] = []
    for name, result in keep.items():
        value = math.nan
        try:
            if isinstance(result, str):
                expression = parse_expression(result)
                names = expression.names
                why = next((f"{each} has no value" for each in names
                            if found.get(each, 0.0) is None), "")
                values = {**parameters, **found}
                if not why:
                    value = float(expression.evaluate({each: values[each] for each in names}))
            else:
                chosen, why = window(run, result)
                if not why:
                    value, why = measured(run, result.quantity, result, chosen)
        except (SandboxError, ArithmeticError, ValueError) as error:
            why = str(error)
        found[name] = value if math.isfinite(value) else None
        if found[name] is None:
            missing.append(f"{name}: {why or 'no finite value'}")
    return found, missing
