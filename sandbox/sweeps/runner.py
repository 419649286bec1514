"""Runs one point of a sweep: values of paths in, a row out."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from sandbox.audit.audit import audit
from sandbox.engine.inspect_control import Checked, control_problems
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.errors import SandboxError, SceneError
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import measured, verdicts, window
from sandbox.scene.document import load_elements
from sandbox.scene.read.load import Loaded, read_scene
from sandbox.scene.settings import Looked
from sandbox.sweeps.job import DONE, ENDED, Point, SweepJob, SweepRow
from sandbox.values.expressions import parse_expression

MAX_REASON = 500  # characters of a reason that a row keeps


class Runner:
    """Runs points of one job, one after the other."""

    def __init__(self, job: SweepJob, scene: Path | Mapping[str, Any]) -> None:
        self._job, self._scene = job, scene
        for path, source in job.bundle.elements.items():
            load_elements(Path(path), source)

    def prepare(self) -> None:
        """Compile the kernels that the scene needs into the cache."""
        with suppress(Exception):  # each run reports the problems of its scene
            Simulation(self._load({})[1])

    def _load(self, values: Point) -> tuple[Loaded, Checked]:
        """The scene, of which only its controllers need a check after reading."""
        loaded = read_scene(self._scene, overrides={**self._job.set, **values},
                            limits=self._job.limits)
        if problems := control_problems(loaded.mechanism):
            raise SceneError(loaded.placed(problems), loaded.name)
        return loaded, Checked(loaded.mechanism)

    def __call__(self, id: str, values: Point) -> SweepRow:
        """Run one point; errors of the run are in its row."""
        try:
            loaded, mechanism = self._load(values)
            recording = simulate(mechanism, recorded_bytes=self._job.limits.recorded_bytes)
        except tuple(ENDED) as error:
            status = next(status for kind, status in ENDED.items() if isinstance(error, kind))
            text = "; ".join(map(str, error.problems)) if isinstance(error, SceneError) \
                else str(error)
            return SweepRow(id, status, reason=" ".join(text.split())[:MAX_REASON])
        parameters = loaded.scene.parameters
        if self._job.recordings:
            recording.save(Path(self._job.recordings, id), parameters=parameters)
        kept, missing = read_results(recording, self._job.keep, parameters)
        judged = verdicts(recording)
        looks = tuple(figure.name for figure in audit(recording) if figure.verdict == "look") \
            if self._job.audited else None
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


@contextmanager
def make_runner(job: SweepJob) -> Iterator[Runner]:
    """A runner with the job's files in a temporary folder."""
    with job.bundle.unpacked() as scene:
        yield Runner(job, scene)
