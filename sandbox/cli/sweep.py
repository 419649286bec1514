"""``sandbox sweep``: a scene run many times with values of its paths varied, as a table."""

from __future__ import annotations

import sys
import time
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.console import (
    Console,
    Heartbeat,
    Progress,
    format_duration,
    resume_notice,
    table,
    worker_compilation_notices,
)
from sandbox.cli.failures import Exit
from sandbox.cli.options import OUT, crew_options, limit_option, override_option
from sandbox.cli.runs import default_directory, prepare
from sandbox.cli.scenes import complete_scene
from sandbox.cli.typed import told_as_typed

if TYPE_CHECKING:
    from sandbox.scene.read.limits import Limits
    from sandbox.sweeps.plan import Plan
    from sandbox.sweeps.sweep import Advance
    from sandbox.sweeps.table import SweepTable

DESIGNS = ("grid", "paired", "latin_hypercube", "sobol", "halton", "random")
RENDERS = Path("sweeps")
MOST_REASONS = 5


def read_varied(
    ctx: click.Context, param: click.Parameter, words: tuple[str, ...],
) -> dict[str, str]:
    """``path=values`` words as a table."""
    found: dict[str, str] = {}
    for word in words:
        path, equals, text = word.partition("=")
        if not equals or not path.strip():
            raise click.BadParameter(f"{word!r} is not of the form path=values", ctx, param)
        if path.strip() in found:
            raise click.BadParameter(f"{path.strip()!r} is varied twice", ctx, param)
        found[path.strip()] = text
    return found


@click.command()
@click.argument("scene", shell_complete=complete_scene)
@click.option("--vary", multiple=True, metavar="PATH=VALUES", callback=read_varied,
              help="What is varied: from:to:count, as in 'parameters.pull=2 N:8 N:7', with ':log' "
                   "behind it in even ratios; a list, '1,2,5'; a distribution, 'normal(3 N, 0.2 "
                   "N)'; from:to, of designs with a count. Several make a grid.")
@click.option("--keep", multiple=True, metavar="QUANTITY",
              help="What is kept of each run: 'max disc.x over last 0.2 s', 'tip=final tip.x', "
                   "'ratio==tip / pull'; a quantity alone means its last value. By default what "
                   "the scene's expectations look at.")
@click.option("--design", type=click.Choice(DESIGNS), help="How the points lie; a grid by "
              "default, random where there is a distribution, else latin_hypercube.")
@click.option("--count", type=click.IntRange(min=1), metavar="N",
              help="How many points, of designs other than grid and paired.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True,
              help="Of random points.")
@override_option
@click.option("--out", type=OUT, metavar="DIR",
              help="Where the table goes, and what is done is found again; sweeps/NAME by "
                   "default.")
@crew_options
@click.option("--recordings", is_flag=True, help="Keep the whole recording of each run, too.")
@click.option("--no-audit", is_flag=True, help="Do not audit runs, which takes as long as running "
              "them.")
@click.option("--again", is_flag=True, help="Do all runs again, those that are done, too.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
@limit_option
def sweep(
    scene: str, vary: dict[str, str], keep: tuple[str, ...], design: str | None,
    count: int | None, seed: int, overrides: dict[str, Any], out: Path | None,
    workers: int, cluster: str, recordings: bool, no_audit: bool, again: bool,
    as_json: bool, quiet: bool, limits: Limits,
) -> int:
    """Run SCENE many times, with values of its paths varied.

    SCENE is a scene, or a study file that says what is varied and kept. Writes
    table.csv (table.parquet, too, where pyarrow is installed), a row a run, with
    values, what is kept, verdict and audit, and sweep.png. Runs that are done
    are not done again: the same command goes on where it was stopped.
    """
    from sandbox.sweeps.copies import prepare as prepare_workers

    console = Console(as_json=as_json, quiet=quiet)
    began = time.perf_counter()
    if not cluster:
        prepare_workers()
    from sandbox.sweeps.drawing import load
    from sandbox.sweeps.sweep import run_plan

    plan = _plan(scene, vary, limits, keep=keep, design=design, count=count,
                 seed=seed, set=overrides, recordings=recordings, audit=not no_audit)
    folder = out or RENDERS / default_directory(plan.name).name
    prepare(folder)
    console.say(f"{plan.name}: {len(plan)} runs of {plan.loaded.mechanism.name}")
    load()
    with (resume_notice(folder, console), worker_compilation_notices(console),
          Progress("sweep", shown=console.shows_progress) as bar):
        found = run_plan(plan, folder, workers=workers, cluster=cluster, again=again,
                         progress=_SweepSoFar(bar, console))
    return _report(found, folder, console, time.perf_counter() - began)


def _plan(scene: str, vary: dict[str, str], limits: Limits, **words: Any) -> Plan:
    """The plan of a study file, or of a scene and the words of the command."""
    from sandbox.sweeps.plan import plan_of, read_plan, study_file
    from sandbox.sweeps.sweep import study_data

    if study_file(scene, limits):
        given = [f"--{name.replace('_', '-')}" for name, value in
                 {"vary": vary, **words, "no_audit": not words["audit"]}.items()
                 if value and name not in ("audit",)]
        if given:
            raise click.BadParameter(
                f"{scene} is a study file, which says this itself; change it there.",
                param_hint=given[0])
        return read_plan(scene, limits)
    if not vary:
        raise click.BadParameter("say what is varied, as in --vary 'parameters.pull=2:8:7', or "
                                 "give a study file.", param_hint="--vary")
    with told_as_typed(vary, words["keep"]):
        return plan_of(study_data(scene, vary=vary, **words), limits)


class _SweepSoFar:
    """Progress: a bar on a terminal, a line now and then elsewhere."""

    def __init__(self, bar: Progress, console: Console) -> None:
        self._bar, self._console, self._when = bar, console, Heartbeat()

    def __call__(self, at: Advance) -> None:
        """Take note of a finished run."""
        self._bar(at.fraction)
        if sys.stderr.isatty() or not self._when.due():
            return
        rate = at.done / at.seconds
        left = format_duration((at.total - at.before - at.done) / rate)
        self._console.warn(f"{at.before + at.done} of {at.total} runs, {rate:.3g} a second, "
                           f"{left} left" + (f", {at.doubtful} to look at" if at.doubtful else ""))


def _report(found: SweepTable, folder: Path, console: Console, seconds: float) -> int:
    from sandbox.sweeps.drawing import FIGURE, draw
    from sandbox.sweeps.table import CSV, PARQUET, SPEC

    draw(found, folder / FIGURE)
    files = [name for name in (CSV, PARQUET, FIGURE, SPEC) if (folder / name).is_file()]
    counts = {status: found.status.count(status) for status in dict.fromkeys(found.status)}
    if console.as_json:
        console.result_json({
            "status": "done", "exit_code": int(Exit.DONE), "directory": str(folder),
            "files": files, "runs": len(found), "counts": counts,
            "missed": len(_missed(found)), "look": int(found.doubtful.sum()), "wall_s": seconds})
        return Exit.DONE
    rows = _summary(found)
    if rows:
        console.say(*table(["kept", "unit", "least", "middle", "largest"], rows, right="<<>>>"), "")
    for status, runs in counts.items():
        if status != "done":
            console.say(f"{runs} of {len(found)} runs {status}: {_reasons(found, status)}")
    if lacking := sum(found.status[run] == "done" for run in found.reason):
        console.say(f"{lacking} runs lack something that is kept: {_reasons(found, 'done')}")
    if missed := _missed(found):
        failed = Counter(name for run in missed for name in found.failed.get(run, ()))
        console.say(f"{len(missed)} of {len(found)} runs miss what the scene expects: "
                    + _most(failed))
    if looks := int(found.doubtful.sum()):
        names = sorted({name for each in found.looks.values() for name in each})
        console.say(f"{looks} runs have warnings: {', '.join(names)}")
    console.say(f"{folder}: {', '.join(files)}  ({seconds:.1f} s)")
    return Exit.DONE


def _summary(found: SweepTable) -> list[list[str]]:
    import numpy as np

    rows = []
    for name, values in found.kept.items():
        finite = values[np.isfinite(values)]
        numbers = [f"{value:.6g}" for value in np.quantile(finite, [0, 0.5, 1])] \
            if len(finite) else ["-", "-", "-"]
        rows.append([name, found.plan.units.get(name, ""), *numbers])
    return rows


def _missed(found: SweepTable) -> list[int]:
    """Runs of which an expectation failed."""
    return [run for run, holds in enumerate(found.holds.tolist()) if holds == 0]


def _reasons(found: SweepTable, status: str) -> str:
    """Why runs ended so, the most frequent first."""
    return _most(Counter(reason for run, reason in found.reason.items()
                         if found.status[run] == status))


def _most(counted: Counter[str]) -> str:
    """The most frequent, and how often each was."""
    return "; ".join(f"{word} ({count})" for word, count in counted.most_common(MOST_REASONS))
