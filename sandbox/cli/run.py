"""``sandbox run`` and ``sandbox view``: simulate a scene, or play with it in the browser."""

from __future__ import annotations

import contextlib
import dataclasses
import html
import os
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.console import (
    Console,
    Exit,
    Progress,
    compilation_notices,
    pages_line,
    report,
    see,
    shown,
    table,
)
from sandbox.cli.options import (
    OUT,
    OUTPUT,
    RENDERS,
    SCENE,
    Source,
    refuse_blocking,
    safe_name,
    takes,
)
from sandbox.cli.runs import files_of, write_page
from sandbox.cli.scenes import inspection_data, inspection_lines
from sandbox.errors import Problem, RunEnded, SimulationDiverged

if TYPE_CHECKING:
    from sandbox.audit.audit import Figure
    from sandbox.recording.new_run import NewRun
    from sandbox.recording.recording import Recording
    from sandbox.samples.expectations import Verdict
    from sandbox.scene.read.load import Loaded
    from sandbox.web.server import Server

MAX_ROWS = 12  # expectations that are all listed; of more, those that passed are only counted
AUDIT_PAGE = "docs/audit.md"  # explanation of the consistency checks


@click.command()
@click.option("--out", type=OUT, metavar="DIR", help="Directory; renders/NAME by default.")
@click.option("--solver", type=click.Choice(["direct", "pymunk"]), help="By default the scene's.")
@click.option("--no-render", is_flag=True, help="Numbers only, no pictures.")
@click.option("--format", "animation", type=click.Choice(["gif", "mp4"]), default="gif",
              show_default=True, help="Of the animation.")
@click.option("--report", "writes_page", is_flag=True, help="Also write report.html.")
@click.option("--audit", "lists_checks", is_flag=True, help="List all consistency checks.")
@takes(*SCENE, *OUTPUT)
def run(
    scene: Source, out: Path | None, solver: str | None, no_render: bool, animation: str,
    writes_page: bool, lists_checks: bool, console: Console,
) -> int:
    """Simulate SCENE, write results, check expectations.

    SCENE is a JSON file, or the name of a scene that 'sandbox list' shows.
    Writes run.json, run.npz, the CSV logs and animation.gif into DIR. Prints the
    expectations of the scene that passed and failed, and the warnings of the
    consistency checks. Exits 1 if an expectation failed.
    """
    from sandbox.engine.inspect_control import Checked
    from sandbox.engine.simulate import simulate
    from sandbox.recording.new_run import writing

    loaded = scene.load({} if solver is None else {"run.solver": solver})
    problems = scene.inspect(loaded).problems
    refuse_blocking(problems, loaded)
    console.warn(*inspection_lines(problems, loaded), *pages_line(problems))
    with writing(out or RENDERS / safe_name(loaded.mechanism.name)) as new:
        job = _Job(scene, loaded, new, console)
        try:
            with compilation_notices(console), Progress("Simulating", console) as progress:
                recording = simulate(Checked(loaded.mechanism), progress=progress,
                                     recorded_bytes=scene.limits.recorded_bytes)
        except RunEnded as error:
            return job.keep(error)
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

    def keep(self, error: RunEnded) -> int:
        """Save what was recorded before a run ended early, marked incomplete; its exit code."""
        from sandbox.recording.store import save_data

        recording = error.recording
        more: dict[str, Any] = {"directory": str(self.new.directory), "complete": False,
                                "files": []}
        if recording is not None:
            save_data(recording, self.new.aside)
            try:
                with contextlib.suppress(KeyboardInterrupt):  # a second Ctrl-C: leave it out
                    self._judge(recording)
            finally:
                self._save_summary(recording)
                more |= self._publish(recording, not isinstance(error, SimulationDiverged))
        return report(error, self.console, **more)

    def write(self, recording: Recording, animation: str, writes_page: bool) -> None:
        """Save and draw in parallel, then put all files in place."""
        from sandbox.recording.new_run import PAGE
        from sandbox.recording.store import save_data, unfinished
        from sandbox.samples.outcome import INTERRUPTED

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
                kept = type(recording)(recording.mechanism, recording.arrays, info)
                self.judged = self.checks = ()
                self._save_summary(kept)
                self._publish(kept, stopped=True)
                raise
        self.new.publish()

    @contextlib.contextmanager
    def _timed(self, phase: str) -> Iterator[None]:
        began = time.perf_counter()
        yield
        self.wall_s[phase] = time.perf_counter() - began

    def _judge(self, recording: Recording) -> None:
        from sandbox.audit.audit import audit
        from sandbox.samples.expectations import verdicts

        self.judged = verdicts(recording)
        self.checks = audit(recording)

    def _save_summary(self, recording: Recording) -> None:
        from sandbox.recording.store import save_summary

        save_summary(recording, self.new.aside, parameters=self.loaded.scene.parameters,
                     derived=self.loaded.derived, verdicts=self.judged, wall_s=self.wall_s,
                     figures=self.checks)

    def _publish(self, recording: Recording, stopped: bool) -> dict[str, Any]:
        """Put an incomplete run in place and print where; its part of the JSON object."""
        place = self.new.publish(stopped=stopped)
        stays = f"; the run that was in {self.new.directory} stays" \
            if place != self.new.directory else ""
        self.console.warn(f"kept {len(recording)} samples in {place}, marked incomplete{stays}")
        return {"directory": str(place), "samples": len(recording), "files": files_of(place)}


def _finish(job: _Job, recording: Recording, problems: list[Problem], lists_checks: bool) -> int:
    """Print the results of a run; its exit code."""
    from sandbox.audit.figures import figure_data
    from sandbox.samples.outcome import outcome_data

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
        "audit": [figure_data(figure) for figure in job.checks], "audit_page": AUDIT_PAGE,
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
        *(table(["expectation of", "", "value", "range", "unit", ""], rows, right="<<>")
          if rows else ()),
        *(f"FAIL {v.quantity}: {v.reason}" for v in failed if v.reason),
        f"{len(judged) - len(failed)} of {len(judged)} expectations passed"
        f"{'' if listed is judged else '; run.json lists all'}",
        *(see("expectation-failed") if failed else ())]


def _check_lines(checks: Sequence[Figure], solver: str, *, whole: bool) -> list[str]:
    """The count of consistency checks that passed, and the warnings; all as a table if wanted."""
    from sandbox.audit.audit import CHECKS, advice_on

    computed = [f for f in checks if f.verdict != "not computed"]
    warnings = [f for f in computed if f.verdict != "pass"]
    lines = []
    if whole:
        lines += table(["check", "value", "at most", "unit", "", ""], [
            [f.name, shown(f.value, ".2g"), shown(f.threshold, ".2g"), f.unit,
             "pass" if f.verdict == "pass" else "WARNING",
             CHECKS[f.name].asks if f.name in CHECKS else ""]
            for f in computed], right="<>><<<")
        if without := [f.name for f in checks if f.verdict == "not computed"]:
            lines.append(f"not computed (run.json has the reasons): {', '.join(without)}")
    many = "s" if len(warnings) > 1 else ""
    lines.append(f"{len(computed) - len(warnings)} checks passed"
                 + (f", {len(warnings)} warning{many}:" if warnings else "")
                 + ("" if whole or warnings else "; --audit lists them"))
    for each in warnings:
        advice = advice_on(each.name, solver)
        value = f"{shown(each.value, '.2g')} {each.unit}".rstrip()
        lines += [f"  {each.name} = {value}, at most {shown(each.threshold, '.2g')}: {each.why}",
                  f"    meaning: {advice.means}",
                  f"    what to do: {advice.do}"]
    return [*lines, *([f"{AUDIT_PAGE} explains them"] if whole or warnings else [])]


# -- in the browser ------------------------------------------------------------------


@click.command()
@click.option("--port", type=click.IntRange(0, 65535), default=0, metavar="N",
              help="Port of the page; by default a free one.")
@click.option("--no-browser", is_flag=True, help="Only print the address.")
@takes(*SCENE)
def view(scene: Source, port: int, no_browser: bool) -> int:
    """Open SCENE in the browser: run, pause, pull bodies, move sliders.

    Serves a page on this machine only, until Ctrl-C. The scene is reloaded when
    its file is saved. A session can be saved as a scene that reproduces it
    exactly. Needs the extra 'view'.
    """
    import getpass
    import platform

    from sandbox.web.server import Server, needed
    from sandbox.web.session import Found, Session

    needed()
    console = Console()

    def read(changed: Mapping[str, Any]) -> Found:
        loaded = dataclasses.replace(scene, overrides=changed).load()
        problems = scene.inspect(loaded).problems
        refuse_blocking(problems, loaded)
        return Found(loaded, [*inspection_lines(problems, loaded), *pages_line(problems)])

    def session() -> Session:
        return Session(read, dict(scene.overrides), lambda name: RENDERS / safe_name(name))

    with compilation_notices(console):
        first = session()
    console.warn(*first.warnings)

    def ready(server: Server) -> None:
        console.say(server.address, "from another machine: ssh -N -L "
                    f"{server.port}:127.0.0.1:{server.port} {getpass.getuser()}@{platform.node()}",
                    "Ctrl-C ends it")
        sys.stdout.flush()
        if not no_browser and _has_browser():
            import webbrowser

            webbrowser.open(opened.enter_context(redirect_to(server.address)).as_uri())

    with contextlib.ExitStack() as opened:
        title = first.scene.title or first.scene.name
        Server(session, first, title=title, port=port).serve(ready)
    return Exit.INTERRUPTED


@contextlib.contextmanager
def redirect_to(address: str) -> Iterator[Path]:
    """A temporary file, readable by its owner only, that redirects a browser to an address.

    An address in the browser's own arguments could be read by all who may list processes.
    """
    link = html.escape(address, quote=True)
    with tempfile.TemporaryDirectory(prefix="sandbox-") as folder:
        file = Path(folder, "view.html")
        file.touch(0o600)
        file.write_text(
            '<!doctype html><meta charset="utf-8"><meta name="referrer" content="no-referrer">'
            f'<meta http-equiv="refresh" content="0; url={link}"><title>sandbox view</title>'
            f'<a href="{link}">to the view</a>\n')
        yield file


def _has_browser() -> bool:
    """Whether a browser window can be opened."""
    if os.environ.get("SSH_CONNECTION"):
        return False
    return sys.platform in ("win32", "darwin") or bool(
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
