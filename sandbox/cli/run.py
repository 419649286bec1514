"""``sandbox run``: simulate a scene, write results and pictures, check expectations."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.check import inspect_scene, inspection_data, inspection_lines, refuse_blocking
from sandbox.cli.console import Console, Progress, compilation_notices, table
from sandbox.cli.failures import Exit, pages_line, report, see
from sandbox.cli.options import OUT, json_option, limit_option, quiet_option, scene_options
from sandbox.cli.runs import default_directory, write_page, written
from sandbox.cli.scenes import load, scene_argument, scene_path
from sandbox.errors import Interrupted, Problem, RecordingFull, SimulationDiverged

if TYPE_CHECKING:
    from sandbox.audit.audit import Figure
    from sandbox.recording.new_run import NewRun
    from sandbox.recording.recording import Recording
    from sandbox.samples.expectations import Verdict
    from sandbox.scene.read.limits import Limits
    from sandbox.scene.read.load import Loaded

MAX_ROWS = 12
"""Expectations that are all listed; of more, those that passed are only counted."""
AUDIT_PAGE = "docs/audit.md"
"""Explanation of the consistency checks."""


@dataclass
class _Job:
    """A run in progress."""

    loaded: Loaded
    directory: Path
    console: Console
    limits: Limits
    animation: str = ""
    """``gif``, ``mp4`` or empty."""
    writes_page: bool = False
    lists_checks: bool = False
    problems: list[Problem] = field(default_factory=list)
    checks: list[Figure] = field(default_factory=list)
    wall_s: dict[str, float] = field(default_factory=dict)
    """Duration of each phase [s]."""


@click.command()
@scene_argument
@click.option("--out", type=OUT, metavar="DIR",
              help="Directory for the files; renders/<scene name> by default.")
@scene_options
@click.option("--solver", type=click.Choice(["direct", "pymunk"]),
              help="Solver; that of the scene's run by default.")
@click.option("--no-render", is_flag=True, help="Numbers only, no pictures.")
@click.option("--format", "animation", type=click.Choice(["gif", "mp4"]), default="gif",
              show_default=True, help="Of the animation.")
@click.option("--report", "writes_page", is_flag=True,
              help="Also write report.html, a page that plays the run.")
@click.option("--audit", "lists_checks", is_flag=True, help="List all consistency checks.")
@json_option
@quiet_option
@limit_option
def run(
    scene: str, out: Path | None, overrides: dict[str, Any], solver: str | None, no_render: bool,
    animation: str, writes_page: bool, lists_checks: bool, as_json: bool, quiet: bool,
    limits: Limits,
) -> int:
    """Simulate SCENE, write results, check expectations.

    SCENE is a JSON file, or the name of a scene that 'sandbox list' shows.
    Writes run.json, run.npz, the CSV logs and animation.gif into DIR. Prints the
    expectations of the scene that passed and failed, and the warnings of the
    consistency checks. Exits 1 if an expectation failed.
    """
    from sandbox.recording.new_run import writing

    if solver is not None:
        overrides = {**overrides, "run.solver": solver}
    loaded = load(scene_path(scene), overrides=overrides, limits=limits)
    job = _Job(
        loaded=loaded, directory=out or default_directory(loaded.mechanism.name),
        console=Console(as_json=as_json, quiet=quiet), limits=limits,
        animation="" if no_render else animation, writes_page=writes_page,
        lists_checks=lists_checks,
    )
    job.problems = inspect_scene(loaded, limits).problems
    refuse_blocking(job.problems, loaded)
    job.console.warn(*inspection_lines(job.problems, loaded), *pages_line(job.problems))
    with writing(job.directory) as new:
        try:
            recording = _simulate(job)
        except (Interrupted, RecordingFull, SimulationDiverged) as error:
            return _keep(job, new, error)
        judged = _write(job, new, recording)
    return _report(job, recording, judged)


def _simulate(job: _Job) -> Recording:
    from sandbox.engine.inspect_control import Checked
    from sandbox.engine.simulate import simulate

    with (compilation_notices(job.console),
          Progress("Simulating", shown=job.console.shows_progress) as progress):
        recording = simulate(Checked(job.loaded.mechanism), progress=progress,
                             recorded_bytes=job.limits.recorded_bytes)
    job.wall_s |= recording.info.wall
    return recording


def _keep(
    job: _Job, new: NewRun, error: Interrupted | RecordingFull | SimulationDiverged,
) -> int:
    """Save what was recorded before a run ended early, marked incomplete; its exit code."""
    from sandbox.recording.store import save_data
    from sandbox.samples.expectations import verdicts

    more: dict[str, Any] = {"directory": str(job.directory), "complete": False, "files": []}
    if error.recording is not None:
        save_data(error.recording, new.aside)
        judged: list[Verdict] = []
        try:
            judged = verdicts(error.recording)
            _audit(job, error.recording)
        except KeyboardInterrupt:  # a second Ctrl-C: leave them out
            pass
        finally:
            _save_summary(job, new, error.recording, judged)
            stopped = not isinstance(error, SimulationDiverged)
            more |= {"samples": len(error.recording),
                     **_publish_incomplete(job, new, error.recording, stopped=stopped)}
    return report(error, job.console, **more)


def _write(job: _Job, new: NewRun, recording: Recording) -> list[Verdict]:
    """Save and draw in parallel, then put all files in place. Returns the verdicts."""
    from sandbox.recording.store import save_data
    from sandbox.samples.expectations import verdicts

    with ThreadPoolExecutor(max_workers=1) as beside:
        saved = beside.submit(_timed, job, "save", save_data, recording, new.aside)
        try:
            if job.animation:
                _timed(job, "draw", _draw, job, new.aside, recording)
            saved.result()
            judged = verdicts(recording)
            _timed(job, "audit", _audit, job, recording)
            if job.writes_page:
                _timed(job, "report", _page, job, new.aside, recording, judged)
            _save_summary(job, new, recording, judged)
        except BaseException as error:
            saved.result()
            _keep_numbers(job, new, recording, interrupted=isinstance(error, KeyboardInterrupt))
            raise
    new.publish()
    return judged


def _save_summary(
    job: _Job, new: NewRun, recording: Recording, judged: Sequence[Verdict],
) -> None:
    from sandbox.recording.store import save_summary

    save_summary(recording, new.aside, parameters=job.loaded.scene.parameters,
                 derived=job.loaded.derived, verdicts=judged, wall_s=job.wall_s,
                 figures=job.checks)


def _keep_numbers(job: _Job, new: NewRun, recording: Recording, *, interrupted: bool) -> None:
    """Save the numbers of a run that was stopped while drawing, marked incomplete."""
    from sandbox.recording.store import unfinished
    from sandbox.samples.outcome import INTERRUPTED

    info = dataclasses.replace(recording.info, complete=False, reason=INTERRUPTED) \
        if interrupted else unfinished(recording.info)
    kept = type(recording)(recording.mechanism, recording.arrays, info)
    job.checks = []
    _save_summary(job, new, kept, ())
    _publish_incomplete(job, new, kept, stopped=True)


def _publish_incomplete(
    job: _Job, new: NewRun, recording: Recording, *, stopped: bool,
) -> dict[str, Any]:
    """Put an incomplete run in place and print where; its part of the JSON object."""
    place = new.publish(stopped=stopped)
    stays = f"; the run that was in {job.directory} stays" if place != job.directory else ""
    job.console.warn(f"kept {len(recording)} samples in {place}, marked incomplete{stays}")
    return {"directory": str(place), "files": written(place)}


def _audit(job: _Job, recording: Recording) -> None:
    from sandbox.audit.audit import audit

    job.checks = audit(recording)


def _timed(job: _Job, phase: str, work: Any, *arguments: Any) -> None:
    began = time.perf_counter()
    work(*arguments)
    job.wall_s[phase] = time.perf_counter() - began


def _draw(job: _Job, folder: Path, recording: Recording) -> None:
    from sandbox.picture.film import render

    with Progress("Drawing", shown=job.console.shows_progress) as progress:
        render(recording, folder / f"animation.{job.animation}", progress=progress,
               most_frames=job.limits.frames)


def _page(job: _Job, folder: Path, recording: Recording, judged: list[Verdict]) -> None:
    from sandbox.recording.new_run import PAGE

    write_page([recording], folder / PAGE, sources=[str(job.directory)], figures=[job.checks],
               judged=[judged])


def _report(job: _Job, recording: Recording, judged: list[Verdict]) -> int:
    """Print the results of a run; its exit code."""
    code = Exit.DONE if all(verdict.ok for verdict in judged) else Exit.FAILED
    console, files = job.console, written(job.directory)
    if console.as_json:
        console.result_json(_data(job, recording, judged, code, files))
        return code
    for each in recording.info.events:
        console.say(f"event {each.event} at t = {each.time:.6g} s")
    for name, found in recording.info.controllers.items():
        values = ", ".join(f"{key} = {value:.6g}" if isinstance(value, float)
                           else f"{key} = {value}" for key, value in found.items())
        console.say(f"controller {name}: {values}")
    for note in recording.notes:
        console.warn(f"{job.loaded.name}: note: {note}")
    if judged:
        console.say(*expectation_lines(judged))
    console.say(*check_lines(job.checks, whole=job.lists_checks))
    phases = ", ".join(f"{phase} {seconds:.1f} s" for phase, seconds in job.wall_s.items())
    console.say(f"Results in {job.directory}: {', '.join(files)}  ({phases})")
    return code


def _data(
    job: _Job, recording: Recording, judged: list[Verdict], code: Exit, files: list[str],
) -> dict[str, Any]:
    from sandbox.audit.audit import figure_data
    from sandbox.samples.outcome import outcome_data

    outcome = outcome_data(recording.info)
    return {
        "status": code.name.lower(), "exit_code": int(code),
        "scene": job.loaded.mechanism.name, "title": job.loaded.mechanism.title,
        "directory": str(job.directory), "files": files, "complete": recording.complete,
        "samples": len(recording), "wall_s": job.wall_s,
        "expectations": [verdict_data(verdict) for verdict in judged],
        "audit": [figure_data(figure) for figure in job.checks], "audit_page": AUDIT_PAGE,
        "findings": inspection_data(job.problems, job.loaded),
        "notes": recording.notes,
        **{key: outcome[key] for key in ("events", "broke", "controllers", "stopped")},
    }


def verdict_data(verdict: Verdict) -> dict[str, Any]:
    """A verdict as JSON data; infinite and missing values are null."""
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in dataclasses.asdict(verdict).items()
    }


def expectation_lines(judged: list[Verdict]) -> list[str]:
    """A table of expectations, the reasons of failures, and the count.

    Of more than :data:`MAX_ROWS` only those that failed are listed.
    """
    failed = [v for v in judged if not v.ok]
    shown = judged if len(judged) <= MAX_ROWS else failed
    rows = [
        [v.quantity, v.statistic, "-" if math.isnan(v.value) else f"{v.value:.6g}", v.allowed,
         "" if v.unit == "1" else v.unit, "pass" if v.ok else "FAIL"]
        for v in shown
    ]
    lines = table(["expectation of", "", "value", "range", "unit", ""], rows,
                  right="<<>") if rows else []
    lines += [f"FAIL {v.quantity}: {v.reason}" for v in failed if v.reason]
    where = "" if shown is judged else "; run.json lists all"
    count = f"{len(judged) - len(failed)} of {len(judged)} expectations passed"
    lines.append(f"{count}{where}")
    lines += see(["expectation-failed"]) if failed else []
    return lines


def check_lines(checks: list[Figure], *, whole: bool) -> list[str]:
    """The count of consistency checks that passed, and the warnings; all as a table if wanted."""
    from sandbox.audit.audit import ASKS, advice_on

    computed = [f for f in checks if f.verdict != "not computed"]
    warnings = [f for f in computed if f.verdict != "pass"]
    lines = []
    if whole:
        lines += table(["check", "value", "at most", "unit", "", ""], [
            [f.name, _short(f.value), _short(f.threshold), f.unit,
             "pass" if f.verdict == "pass" else "WARNING", ASKS.get(f.name, "")]
            for f in computed], right="<>><<<")
        if without := [f.name for f in checks if f.verdict == "not computed"]:
            lines.append(f"not computed (run.json has the reasons): {', '.join(without)}")
    many = "s" if len(warnings) > 1 else ""
    lines.append(f"{len(computed) - len(warnings)} checks passed"
                 + (f", {len(warnings)} warning{many}:" if warnings else "")
                 + ("" if whole or warnings else "; --audit lists them"))
    for each in warnings:
        advice = advice_on(each.name)
        value = f"{_short(each.value)} {each.unit}".rstrip()
        lines += [f"  {each.name} = {value}, at most {_short(each.threshold)}: {each.why}",
                  f"    meaning: {advice.means}",
                  f"    what to do: {advice.do}"]
    if whole or warnings:
        lines.append(f"{AUDIT_PAGE} explains them")
    return lines


def _short(value: float) -> str:
    return f"{value:.2g}" if math.isfinite(value) else "-"
