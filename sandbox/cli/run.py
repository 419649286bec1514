"""``sandbox run``: simulate a scene."""

from __future__ import annotations

import contextlib
import dataclasses
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from sandbox.audit.audit import CHECKS, advice_on, audit
from sandbox.audit.evidence import Figure
from sandbox.cli.check import inspection_data, ready
from sandbox.cli.console import Console, Exit, Progress, monitored, report, see, shown, table
from sandbox.cli.options import RENDERS, Source, safe_name
from sandbox.cli.runs import files_of, write_page
from sandbox.engine.inspect_control import Checked
from sandbox.engine.simulate import simulate
from sandbox.errors import Problem, RunEnded, SimulationDiverged
from sandbox.recording.new_run import PAGE, NewRun, writing
from sandbox.recording.recording import Recording
from sandbox.recording.store import save_data, save_summary, unfinished
from sandbox.samples.expectations import Verdict, verdicts
from sandbox.samples.outcome import INTERRUPTED, outcome_data
from sandbox.scene.read.load import Loaded
from sandbox.wording import counted

MAX_ROWS = 12  # expectations that are all listed; of more, those that passed are only counted
AUDIT_PAGE = "docs/audit.md"  # explanation of the consistency checks


def run(
    scene: Source, out: Path | None, solver: str | None, no_render: bool, animation: str,
    writes_page: bool, lists_checks: bool, console: Console,
) -> int:
    """Simulate a scene, write the results, and print the verdicts on its expectations."""
    loaded, problems, warnings = ready(scene, {} if solver is None else {"run.solver": solver})
    console.warn(*warnings)
    with writing(out or RENDERS / safe_name(loaded.mechanism.name)) as new:
        job = _Job(scene, loaded, new, console)
        try:
            with monitored(console, "Simulating") as progress:
                recording = simulate(Checked(loaded.mechanism), progress=progress,
                                     recorded_bytes=scene.limits.recorded_bytes)
        except RunEnded as error:
            return job.ended(error)
        job.wall_s |= recording.info.wall
        job.write(recording, "" if no_render else animation, writes_page)
    return _finish(job, recording, problems, lists_checks)


@dataclasses.dataclass
class _Job:
    """A run whose files are written."""

    scene: Source
    loaded: Loaded
    new: NewRun
    console: Console
    judged: Sequence[Verdict] = ()
    checks: Sequence[Figure] = ()
    wall_s: dict[str, float] = dataclasses.field(default_factory=dict)  # duration of each phase

    def ended(self, error: RunEnded) -> int:
        """Save what was recorded before a run ended early; its exit code."""
        more: dict[str, Any] = {"directory": self.new.directory, "complete": False, "files": []}
        if (recording := error.recording) is not None:
            save_data(recording, self.new.aside)
            try:
                with contextlib.suppress(KeyboardInterrupt):  # a second Ctrl-C: leave it out
                    self._judge(recording)
            finally:
                more |= self._keep(recording, not isinstance(error, SimulationDiverged))
        return report(error, self.console, **more)

    def write(self, recording: Recording, animation: str, writes_page: bool) -> None:
        """Save and draw in parallel, then put all files in place."""
        def save() -> None:
            with self._timed("save"):
                save_data(recording, self.new.aside)

        with ThreadPoolExecutor(max_workers=1) as beside:
            saved = beside.submit(save)
            try:
                if animation:
                    from sandbox.picture.film import render
                    with self._timed("draw"), Progress("Drawing", self.console) as progress:
                        render(recording, self.new.aside / f"animation.{animation}",
                               progress=progress, most_frames=self.scene.limits.frames)
                saved.result()
                with self._timed("audit"):
                    self._judge(recording)
                if writes_page:
                    from sandbox.web.page import FoundOut
                    with self._timed("report"):
                        write_page([recording], self.new.aside / PAGE, [FoundOut(
                            self.judged, self.checks, str(self.new.directory))])
                self._save_summary(recording)
            except BaseException as error:  # keep the numbers, marked incomplete
                saved.result()
                info = dataclasses.replace(
                    recording.info, complete=False, reason=INTERRUPTED) \
                    if isinstance(error, KeyboardInterrupt) else unfinished(recording.info)
                self.judged = self.checks = ()
                self._keep(type(recording)(recording.mechanism, recording.arrays, info), True)
                raise
        self.new.publish()

    @contextlib.contextmanager
    def _timed(self, phase: str) -> Iterator[None]:
        began = time.perf_counter()
        yield
        self.wall_s[phase] = time.perf_counter() - began

    def _judge(self, recording: Recording) -> None:
        self.judged = verdicts(recording)
        self.checks = audit(recording)

    def _save_summary(self, recording: Recording) -> None:
        save_summary(recording, self.new.aside, parameters=self.loaded.scene.parameters,
                     derived=self.loaded.derived, verdicts=self.judged, wall_s=self.wall_s,
                     figures=self.checks)

    def _keep(self, recording: Recording, stopped: bool) -> dict[str, Any]:
        """Put an incomplete run in place and print where; its part of the JSON object."""
        self._save_summary(recording)
        place = self.new.publish(stopped=stopped)
        stays = f"; the run that was in {self.new.directory} stays" \
            if place != self.new.directory else ""
        self.console.warn(f"kept {len(recording)} samples in {place}, marked incomplete{stays}")
        return {"directory": place, "samples": len(recording), "files": files_of(place)}


def _finish(job: _Job, recording: Recording, problems: list[Problem], lists_checks: bool) -> int:
    mechanism, info, directory = job.loaded.mechanism, recording.info, job.new.directory
    files, outcome = files_of(directory), outcome_data(info)
    lines = [f"event {each.event} at t = {each.time:.6g} s" for each in info.events]
    for name, found in info.controllers.items():
        values = ", ".join(f"{key} = {value:.6g}" if isinstance(value, float)
                           else f"{key} = {value}" for key, value in found.items())
        lines.append(f"controller {name}: {values}")
    lines += [*(_expectation_lines(job.judged) if job.judged else ()),
              *_check_lines(job.checks, recording.mechanism.run.solver, whole=lists_checks)]
    phases = ", ".join(f"{phase} {seconds:.1f} s" for phase, seconds in job.wall_s.items())
    lines.append(f"Results in {directory}: {', '.join(files)}  ({phases})")
    if not job.console.as_json:
        job.console.warn(*(f"{job.loaded.name}: note: {note}" for note in recording.notes))
    return job.console.finish({
        "scene": mechanism.name, "title": mechanism.title, "directory": directory, "files": files,
        "complete": recording.complete, "samples": len(recording), "wall_s": job.wall_s,
        "expectations": [dataclasses.asdict(verdict) for verdict in job.judged],
        "audit": [vars(figure) for figure in job.checks], "audit_page": AUDIT_PAGE,
        "findings": inspection_data(problems, job.loaded), "notes": recording.notes,
        **{key: outcome[key] for key in ("events", "broke", "controllers", "stopped")},
    }, lines, Exit.DONE if all(verdict.ok for verdict in job.judged) else Exit.FAILED)


def _expectation_lines(judged: Sequence[Verdict]) -> list[str]:
    """A table of expectations (of many, those that failed), the reasons of failures, the count."""
    failed = [v for v in judged if not v.ok]
    listed = judged if len(judged) <= MAX_ROWS else failed
    rows = [[v.quantity, v.statistic, shown(v.value, ".6g"), v.allowed,
             "" if v.unit == "1" else v.unit, "pass" if v.ok else "FAIL"] for v in listed]
    return [
        *table(["expectation of", "", "value", "range", "unit", ""], rows, right="<<>"),
        *(f"FAIL {v.quantity}: {v.reason}" for v in failed if v.reason),
        f"{len(judged) - len(failed)} of {len(judged)} expectations passed"
        f"{'' if listed is judged else '; run.json lists all'}",
        *(see("expectation-failed") if failed else ())]


def _check_lines(checks: Sequence[Figure], solver: str, *, whole: bool) -> list[str]:
    """The count of consistency checks that passed, and the warnings; all as a table if wanted."""
    computed = [f for f in checks if f.verdict != "not computed"]
    warnings = [f for f in computed if f.verdict != "pass"]
    lines = table(["check", "value", "at most", "unit", "", ""], [
        [f.name, shown(f.value, ".2g"), shown(f.threshold, ".2g"), f.unit,
         "pass" if f.verdict == "pass" else "WARNING",
         CHECKS[f.name].asks if f.name in CHECKS else ""]
        for f in computed if whole], right="<>><<<")
    without = [f.name for f in checks if f.verdict == "not computed"]
    if whole and without:
        lines.append(f"not computed (run.json has the reasons): {', '.join(without)}")
    lines.append(f"{len(computed) - len(warnings)} checks passed"
                 + (f", {counted(len(warnings), 'warning')}:" if warnings else "")
                 + ("" if whole or warnings else "; --audit lists them"))
    for each in warnings:
        advice = advice_on(each.name, solver)
        value = f"{shown(each.value, '.2g')} {each.unit}".rstrip()
        lines += [f"  {each.name} = {value}, at most {shown(each.threshold, '.2g')}: {each.why}",
                  f"    meaning: {advice.means}",
                  f"    what to do: {advice.do}"]
    return [*lines, *([f"{AUDIT_PAGE} explains them"] if whole or warnings else [])]
