"""``sandbox sweep``: runs a scene many times with values of its paths varied, as a table."""

from __future__ import annotations

import shlex
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
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
from sandbox.cli.options import OUT, limit_option, scene_options
from sandbox.cli.runs import default_directory, prepare
from sandbox.cli.scenes import complete_scene

if TYPE_CHECKING:
    from sandbox.errors import Problem
    from sandbox.scene.read.limits import Limits
    from sandbox.sweeps.plan import Plan
    from sandbox.sweeps.sweep import Advance
    from sandbox.sweeps.table import SweepTable

DESIGNS = ("grid", "paired", "latin_hypercube", "sobol", "halton", "random")
SWEEPS = Path("sweeps")
MAX_REASONS = 5


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


def read_workers(ctx: click.Context, param: click.Parameter, word: str | None) -> int | str:
    """A number of processes, 0 for one for each processor, or the address of a scheduler."""
    from sandbox.errors import SandboxError
    from sandbox.sweeps.processes import check_workers

    if word is None:
        return 0
    if "://" in word or word.endswith(".json"):
        return word
    try:
        number = int(word)
        if number < 1:
            raise ValueError
        check_workers(number)
    except ValueError:
        raise click.BadParameter(f"{word!r} is neither a number of processes nor the address of a "
                                 "Dask scheduler, as in tcp://10.0.0.1:8786", ctx, param) from None
    except SandboxError as error:
        raise click.BadParameter(str(error), ctx, param) from None
    return number


workers_option = click.option(
    "--workers", metavar="N|ADDRESS", callback=read_workers,
    help="Processes, one for each processor by default; or the address of a Dask scheduler, as in "
         "tcp://10.0.0.1:8786.")


@contextmanager
def problems_at_options(vary: Mapping[str, str], keep: Sequence[str]) -> Iterator[None]:
    """Report problems of a study made of options at these options.

    Raises:
        SceneError: of a file unchanged; of options with ``--vary pull=2:8:x`` as its path.
    """
    from sandbox.errors import SceneError

    try:
        yield
    except SceneError as error:
        if error.source:
            raise
        raise SceneError([_at_option(each, vary, keep) for each in error.problems]) from None


def _at_option(problem: Problem, vary: Mapping[str, str], keep: Sequence[str]) -> Problem:
    from sandbox.values.paths import parse_path

    head, *steps = (*parse_path(problem.path), "", "") if problem.path.startswith("$") else ("",)
    if head not in ("vary", "keep", "set", "design", "count", "seed"):
        return problem
    word = ""
    if head == "vary":
        word = next((f"{step}={vary[str(step)]}" for step in steps if step in vary), "")
    elif head == "keep":
        word = next((text for text in keep if steps[0] in (text, text.partition("=")[0].strip())),
                    "")
    return replace(problem, path=f"--{head} {shlex.quote(word)}" if word else f"--{head}",
                   fields="")


@click.command()
@click.argument("scene", shell_complete=complete_scene)
@click.option("--vary", multiple=True, metavar="PATH=VALUES", callback=read_varied,
              help="Values of a path: from:to:count, as in 'parameters.pull=2 N:8 N:7', ':log' "
                   "behind it for even ratios; a list, '1,2,5'; a distribution, 'normal(3 N, 0.2 "
                   "N)'; from:to, of designs with a count. Several make a grid.")
@click.option("--keep", multiple=True, metavar="RESULT",
              help="A result of each run: 'max disc.x over last 0.2 s', 'tip=final tip.x', "
                   "'ratio==tip / pull'; a quantity alone means its last value. By default those "
                   "of the scene's expectations.")
@click.option("--design", type=click.Choice(DESIGNS), help="Arrangement of the points; a grid by "
              "default, random where there is a distribution, else latin_hypercube.")
@click.option("--count", type=click.IntRange(min=1), metavar="N",
              help="Number of points, of designs other than grid and paired.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True,
              help="Of random points.")
@scene_options
@click.option("--out", type=OUT, metavar="DIR",
              help="Directory of the table, and of finished runs; sweeps/NAME by default.")
@workers_option
@click.option("--recordings", is_flag=True, help="Keep the whole recording of each run, too.")
@click.option("--no-audit", is_flag=True, help="Do not audit runs, which takes as long as running "
              "them.")
@click.option("--again", is_flag=True, help="Repeat finished runs.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
@limit_option
def sweep(
    scene: str, vary: dict[str, str], keep: tuple[str, ...], design: str | None,
    count: int | None, seed: int, overrides: dict[str, Any], out: Path | None,
    workers: int | str, recordings: bool, no_audit: bool, again: bool, as_json: bool, quiet: bool,
    limits: Limits,
) -> int:
    """Run SCENE many times with values varied.

    SCENE is a scene, or a study file that defines what is varied and kept. Writes
    table.csv (and table.parquet where pyarrow is installed) with a row for each
    run, and sweep.png; of a grid of two paths a map. Finished runs are not
    repeated: the same command resumes an interrupted sweep.
    """
    from sandbox.sweeps.processes import preload

    console = Console(as_json=as_json, quiet=quiet)
    began = time.perf_counter()
    if isinstance(workers, int):
        preload()
    from sandbox.sweeps.sweep import run_plan
    from sandbox.sweeps.table import preload as preload_figures

    plan = _plan(scene, vary, limits, keep=keep, design=design, count=count,
                 seed=seed, set=overrides, recordings=recordings, audit=not no_audit)
    folder = out or SWEEPS / default_directory(plan.name).name
    prepare(folder)
    console.say(f"{plan.name}: {len(plan)} runs of {plan.loaded.mechanism.name}")
    preload_figures()
    with (resume_notice(folder, console), worker_compilation_notices(console),
          Progress("sweep", shown=console.shows_progress) as bar):
        found = run_plan(plan, folder, workers=workers, again=again,
                         progress=_SweepProgress(bar, console))
    return _report(found, folder, console, time.perf_counter() - began)


def _plan(scene: str, vary: dict[str, str], limits: Limits, **options: Any) -> Plan:
    """The plan of a study file, or of a scene and the options of the command."""
    from sandbox.sweeps.plan import plan_of, read_plan, study_file
    from sandbox.sweeps.sweep import study_data

    if study_file(scene, limits):
        given = [f"--{name.replace('_', '-')}" for name, value in
                 {"vary": vary, **options, "no_audit": not options["audit"]}.items()
                 if value and name != "audit"]
        if given:
            raise click.BadParameter(
                f"{scene} is a study file and already defines this; change it there.",
                param_hint=given[0])
        return read_plan(scene, limits)
    if not vary:
        raise click.BadParameter("nothing is varied: add --vary 'parameters.pull=2:8:7', or give a "
                                 "study file.", param_hint="--vary")
    with problems_at_options(vary, options["keep"]):
        return plan_of(study_data(scene, vary=vary, **options), limits)


class _SweepProgress:
    """A bar on a terminal, a line now and then elsewhere."""

    def __init__(self, bar: Progress, console: Console) -> None:
        self._bar, self._console, self._when = bar, console, Heartbeat()

    def __call__(self, at: Advance) -> None:
        self._bar(at.fraction)
        if sys.stderr.isatty() or not self._when.due():
            return
        rate = at.done / at.seconds
        left = format_duration((at.total - at.before - at.done) / rate)
        self._console.warn(f"{at.before + at.done} of {at.total} runs, {rate:.3g} a second, "
                           f"{left} left" + (f", {at.doubtful} to look at" if at.doubtful else ""))


def _report(found: SweepTable, folder: Path, console: Console, seconds: float) -> int:
    from sandbox.sweeps.table import CSV, FIGURE, PARQUET, SPEC, draw_table

    draw_table(found, folder / FIGURE)
    files = [name for name in (CSV, PARQUET, FIGURE, SPEC) if (folder / name).is_file()]
    counts = Counter(found.status)
    missed = [run for run, holds in enumerate(found.holds.tolist()) if holds == 0]
    looks = int(found.doubtful.sum())
    if console.as_json:
        console.result_json({
            "status": "done", "exit_code": int(Exit.DONE), "directory": str(folder),
            "files": files, "runs": len(found), "counts": counts,
            "missed": len(missed), "look": looks, "wall_s": seconds})
        return Exit.DONE
    if found.kept:
        console.say(*table(["kept", "unit", "least", "middle", "largest"], _summary(found),
                           right="<<>>>"), "")
    reasons = {status: _most_frequent(reason for run, reason in found.reason.items()
                                      if found.status[run] == status) for status in counts}
    for status, runs in counts.items():
        if status != "done":
            console.say(f"{runs} of {len(found)} runs {status}: {reasons[status]}")
    if lacking := sum(found.status[run] == "done" for run in found.reason):
        console.say(f"{lacking} runs have missing results: {reasons['done']}")
    if missed:
        failed = _most_frequent(name for run in missed for name in found.failed.get(run, ()))
        console.say(f"{len(missed)} of {len(found)} runs miss expectations: {failed}")
    if looks:
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


def _most_frequent(words: Iterator[str]) -> str:
    return "; ".join(f"{word} ({count})"
                     for word, count in Counter(words).most_common(MAX_REASONS))
