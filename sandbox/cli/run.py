"""``sandbox run``: simulate a scene, keep the numbers, draw it, judge its expectations."""

from __future__ import annotations

import time
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.compiling import compilation_notices
from sandbox.cli.console import Console
from sandbox.cli.exits import Exit
from sandbox.cli.failures import pages_line, report
from sandbox.cli.inspection import inspection_data, inspection_lines, look_over, refuse_blocking
from sandbox.cli.options import (
    OUT,
    chosen_limits,
    limit_options,
    meter_option,
    override_option,
    refuse_unknown,
    show_option,
)
from sandbox.cli.output import default_directory, written
from sandbox.cli.progress import Progress
from sandbox.cli.scenes import complete_scene, load, scene_path
from sandbox.cli.verdict import AUDIT_PAGE, audit_lines, expectation_table, verdict_data
from sandbox.errors import Interrupted, Problem, RecordingFull, SimulationDiverged

if TYPE_CHECKING:
    from sandbox.audit.audit import Figure
    from sandbox.recording.new_run import NewRun
    from sandbox.recording.recording import Recording
    from sandbox.samples.expectations import Verdict
    from sandbox.scene.read.limits import Limits
    from sandbox.scene.read.load import Loaded


@dataclass
class _Job:
    """One run on its way: what it is, where it goes, how long its phases took."""

    loaded: Loaded
    directory: Path
    console: Console
    limits: Limits
    animation: str = ""
    """``gif``, ``mp4`` or empty."""
    frames: bool = False
    show: str | None = None
    """Layers, as they are asked for."""
    meters: tuple[str, ...] = ()
    audits: bool = True
    reports: bool = False
    """Whether a page for a browser is written, too."""
    whole_audit: bool = False
    """Whether all of its figures are shown."""
    problems: list[Problem] = field(default_factory=list)
    audited: list[Figure] = field(default_factory=list)
    wall_s: dict[str, float] = field(default_factory=dict)


@click.command()
@click.argument("scene", shell_complete=complete_scene)
@click.option("--out", type=OUT, metavar="DIR",
              help="Where the files go; renders/<scene name> by default.")
@override_option
@click.option("--no-render", is_flag=True, help="Numbers only, no pictures.")
@click.option("--frames", is_flag=True, help="Also write every picture as PNG into frames/.")
@click.option("--format", "animation", type=click.Choice(["gif", "mp4"]), default="gif",
              show_default=True, help="Of the animation.")
@meter_option
@click.option("--report", "reports", is_flag=True,
              help="Also write report.html, a page that plays the run.")
@show_option
@click.option("--audit/--no-audit", default=None,
              help="Show every figure of the audit, which is one line by default if all pass; do "
                   "not check the recording against mechanics.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
@limit_options
def run(
    scene: str, out: Path | None, overrides: dict[str, Any], no_render: bool, frames: bool,
    animation: str, reports: bool, show: str | None, meters: tuple[str, ...], audit: bool | None,
    as_json: bool, quiet: bool, **limits: Any,
) -> int:
    """Simulate SCENE, save its forces, draw it, judge it.

    SCENE is a JSON file, or the name of a scene that 'sandbox list' shows.
    Writes run.json, run.npz, the CSV logs and animation.gif into DIR, and
    prints which of the scene's expectations hold, and a line on the audit of the
    recording against the laws of mechanics, or all of it where it asks for a
    look. Exits 1 if an expectation does not hold.
    """
    from sandbox.recording.new_run import writing

    loaded = load(scene_path(scene), overrides=overrides, limits=limits)
    job = _Job(
        loaded=loaded, directory=out or default_directory(loaded.mechanism.name),
        console=Console(as_json=as_json, quiet=quiet),
        animation="" if no_render else animation, frames=frames and not no_render,
        show=show, meters=meters, audits=audit is not False, whole_audit=audit is True,
        reports=reports, limits=chosen_limits(limits),
    )
    refuse_unknown(meters, loaded.mechanism)
    _look_over(job)
    with writing(job.directory) as new:
        try:
            recording = _simulate(job)
        except (Interrupted, RecordingFull, SimulationDiverged) as error:
            return _keep(job, new, error)
        judged = _write(job, new, recording)
    return _report(job, recording, judged)


def _look_over(job: _Job) -> None:
    """Show what the inspection finds, and refuse what cannot be simulated or takes too much.

    Raises:
        SceneError: problems that block.
    """
    job.problems = look_over(job.loaded, job.limits).problems
    refuse_blocking(job.problems, job.loaded)
    job.console.warn(*inspection_lines(job.problems, job.loaded), *pages_line(job.problems))


def _simulate(job: _Job) -> Recording:
    from sandbox.engine.inspect_control import Checked
    from sandbox.engine.simulate import simulate

    with (compilation_notices(job.console),
          Progress("simulate", shown=job.console.shows_progress) as progress):
        recording = simulate(Checked(job.loaded.mechanism), progress=progress,
                             recorded_bytes=job.limits.recorded_bytes)
    job.wall_s |= recording.info.wall
    return recording


def _keep(
    job: _Job, new: NewRun, error: Interrupted | RecordingFull | SimulationDiverged,
) -> int:
    """Save what was recorded before a run ended early, marked incomplete; its exit code."""
    from sandbox.recording.store import save_data, save_summary
    from sandbox.samples.expectations import verdicts

    more: dict[str, Any] = {"directory": str(job.directory), "complete": False, "files": []}
    if error.recording is not None:
        save_data(error.recording, new.aside)
        judged: list[Verdict] = []
        try:
            judged = verdicts(error.recording)
            if job.audits:
                _audit(job, error.recording)
        except KeyboardInterrupt:  # once more: without them, then
            pass
        finally:  # whatever becomes of these, what was recorded is kept
            save_summary(error.recording, new.aside, parameters=job.loaded.scene.parameters,
                         derived=job.loaded.derived, verdicts=judged, figures=job.audited)
            stopped = not isinstance(error, SimulationDiverged)
            more |= {"samples": len(error.recording),
                     **_kept(job, new, error.recording, stopped=stopped)}
    return report(error, job.console, **more)


def _write(job: _Job, new: NewRun, recording: Recording) -> list[Verdict]:
    """Save and draw, one beside the other, and put all in place. Returns the verdicts."""
    from sandbox.recording.store import save_data, save_summary
    from sandbox.samples.expectations import verdicts

    with ThreadPoolExecutor(max_workers=1) as beside:
        saved = beside.submit(_timed, job, "save", save_data, recording, new.aside)
        try:
            if job.animation or job.frames:
                _timed(job, "draw", _draw, job, new.aside, recording)
            saved.result()
            judged = verdicts(recording)
            if job.audits:
                _timed(job, "audit", _audit, job, recording)
            if job.reports:
                _timed(job, "report", _page, job, new.aside, recording, judged)
            save_summary(recording, new.aside, parameters=job.loaded.scene.parameters,
                         derived=job.loaded.derived, verdicts=judged, wall_s=job.wall_s,
                         figures=job.audited)
        except BaseException as error:
            saved.result()
            _keep_numbers(job, new, recording, interrupted=isinstance(error, KeyboardInterrupt))
            raise
    new.publish()
    return judged


def _keep_numbers(job: _Job, new: NewRun, recording: Recording, *, interrupted: bool) -> None:
    """Stopped while it was drawn or audited: its numbers are kept, marked incomplete."""
    from sandbox.recording.store import save_summary, unfinished
    from sandbox.samples.outcome import INTERRUPTED, Status

    info = replace(recording.info, status=Status.INTERRUPTED, reason=INTERRUPTED) \
        if interrupted else unfinished(recording.info)
    kept = type(recording)(recording.mechanism, recording.arrays, info)
    save_summary(kept, new.aside, parameters=job.loaded.scene.parameters,
                 derived=job.loaded.derived, verdicts=(), figures=())
    _kept(job, new, kept, stopped=True)


def _kept(job: _Job, new: NewRun, recording: Recording, *, stopped: bool) -> dict[str, Any]:
    """Put a run that is not complete where it belongs, and tell where; for the JSON object."""
    place = new.publish(stopped=stopped)
    stays = f"; the run that was in {job.directory} stays" if place != job.directory else ""
    job.console.warn(f"kept {len(recording)} samples in {place}, marked incomplete{stays}")
    return {"directory": str(place), "files": written(place)}


def _audit(job: _Job, recording: Recording) -> None:
    from sandbox.audit.audit import audit

    job.audited = audit(recording)


def _timed(job: _Job, phase: str, work: Any, *arguments: Any) -> None:
    began = time.perf_counter()
    work(*arguments)
    job.wall_s[phase] = time.perf_counter() - began


def _draw(job: _Job, folder: Path, recording: Recording) -> None:
    from sandbox.draw.film.video import render

    shown = job.console.shows_progress
    if job.animation:
        with Progress("draw", shown=shown) as progress:
            render(recording, folder / f"animation.{job.animation}", show=job.show,
                   meters=job.meters or None, progress=progress, most_frames=job.limits.frames)
    if job.frames:
        with Progress("frames", shown=shown) as progress:
            render(recording, folder / "frames", show=job.show,
                   meters=job.meters or None, progress=progress, most_frames=job.limits.frames)


def _page(job: _Job, folder: Path, recording: Recording, judged: list[Verdict]) -> None:
    from sandbox.cli.report import write_page
    from sandbox.recording.new_run import PAGE

    write_page([recording], folder / PAGE, sources=[str(job.directory)], figures=[job.audited],
               judged=[judged])


def _report(job: _Job, recording: Recording, judged: list[Verdict]) -> int:
    """Print what came of a run; its exit code."""
    from sandbox.audit.audit import figure_data
    from sandbox.samples.outcome import outcome_data

    code = Exit.DONE if all(verdict.ok for verdict in judged) else Exit.FAILED
    console, files = job.console, written(job.directory)
    if console.as_json:
        outcome = outcome_data(recording.info)
        console.result_json({
            "status": code.name.lower(), "exit_code": int(code),
            "scene": job.loaded.mechanism.name, "title": job.loaded.mechanism.title,
            "directory": str(job.directory), "files": files, "complete": recording.complete,
            "samples": len(recording), "wall_s": job.wall_s,
            "expectations": [verdict_data(verdict) for verdict in judged],
            "audit": [figure_data(figure) for figure in job.audited], "audit_page": AUDIT_PAGE,
            "findings": inspection_data(job.problems, job.loaded),
            "notes": recording.notes, "events": outcome["events"],
            "broke": outcome["broke"],
            "controllers": outcome["controllers"], "stopped": outcome["stopped"],
        })
        return code
    for happened in recording.info.events:
        console.say(f"event {happened.event} at t = {happened.time:.6g} s")
    for name, found in recording.info.controllers.items():
        console.say(f"controller {name}: {_found_line(found)}")
    for note in recording.notes:
        console.warn(f"note: {note}")
    if judged:
        table = expectation_table(judged)
        console.say(*table, *([""] if len(table) > 1 else []))
    if job.audited:
        told = audit_lines(job.audited, whole=job.whole_audit)
        console.say(*told, *([""] if len(told) > 1 else []))
    phases = ", ".join(f"{phase} {seconds:.1f} s" for phase, seconds in job.wall_s.items())
    console.say(f"{job.directory}: {', '.join(files)}  ({phases})")
    return code


def _found_line(found: Mapping[str, Any]) -> str:
    """What a law found out, on one line."""
    return ", ".join(f"{key} = {value:.6g}" if isinstance(value, float) else f"{key} = {value}"
                     for key, value in found.items())
