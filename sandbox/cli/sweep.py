"""``sandbox sweep`` and ``sandbox search``: many runs of a scene with values varied."""

from __future__ import annotations

import json
import shlex
import sys
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from datetime import timedelta
from functools import partial, reduce
from itertools import count as count_from
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.console import Console, Progress, many_runs, table
from sandbox.cli.entry import Commands
from sandbox.cli.options import (
    OUT,
    OUTPUT,
    SCENE,
    Command,
    Source,
    prepare,
    read_pairs,
    read_quantity,
    safe_name,
    takes,
    written,
)
from sandbox.errors import SandboxError, SceneError

if TYPE_CHECKING:
    from sandbox.search.session import Session
    from sandbox.sweeps.sweep import Advance
    from sandbox.sweeps.table import SweepTable

DESIGNS = ("grid", "paired", "latin_hypercube", "sobol", "halton", "random")
MAX_REASONS = 5
QUESTION = "question.json"
"""The question of a directory in ``searches/``, which other questions do not use."""
EXTENT = ("runs", "within", "count")
"""Options that extend a search, which then continues in the same directory."""
NAMES = {"best": "optimize"}  # commands whose names differ from those in study files


def _read_workers(ctx: click.Context, param: click.Parameter, word: str | None) -> int | str:
    """A number of processes, 0 for one for each processor, or the address of a scheduler."""
    from sandbox.sweeps.processes import check_workers

    if word is None:
        return 0
    if "://" in word:
        return word
    if not word.isdecimal() or int(word) < 1:
        raise click.BadParameter(f"{word!r} is neither a number of processes nor the address of a "
                                 "Dask scheduler, as in tcp://10.0.0.1:8786", ctx, param)
    try:
        return check_workers(int(word))
    except SandboxError as error:
        raise click.BadParameter(str(error), ctx, param) from None


def _takes_study(
    values: str, directory: str, *own: Callable[[Any], Any],
) -> Callable[[Command], Command]:
    """Give a command SCENE, ``--vary``, its own options, and those of all sweeps and searches."""
    options = [
        click.option("--vary", multiple=True, metavar="PATH=VALUES", callback=read_pairs,
                     help=values),
        *own,
        click.option("--out", type=OUT, metavar="DIR", help=directory),
        click.option("--workers", metavar="N|ADDRESS", callback=_read_workers,
                     help="Processes, by default one per processor; or a Dask scheduler."),
        takes(*SCENE, *OUTPUT)]
    return lambda command: reduce(lambda made, option: option(made), reversed(options), command)


_KEEP = click.option("--keep", multiple=True, metavar="RESULT",
                     help="A result of each run: 'max disc.x over last 0.2 s', 'tip=final tip.x', "
                          "'ratio==tip / pull', a quantity for its last value. By default those "
                          "of the expectations.")
_WHERE = click.option("--where", multiple=True, metavar="CONDITION",
                      help="A condition on results: 'slip < 1 mm'. Several must all hold.")
_SEED = click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True,
                     help="Of random points.")


def _is_study(scene: Source, defined: Collection[str]) -> bool:
    """Whether a study file is given; options that it ``defined`` are refused."""
    from sandbox.sweeps.plan import study_file

    if not study_file(scene.word, scene.limits):
        return False
    context = click.get_current_context()
    for param in context.command.params:
        if param.name in defined and context.get_parameter_source(param.name or "") is \
                click.core.ParameterSource.COMMANDLINE:
            raise click.BadParameter(f"{scene.word} already defines this; change it there.",
                                     param_hint=param.opts[0])
    return True


@contextmanager
def _problems_at_options(
    vary: Mapping[str, str], keep: Sequence[str], example: str,
) -> Iterator[None]:
    """Report problems of a study made of options at these options."""
    from sandbox.values.paths import parse_path

    if not vary:
        raise click.BadParameter(f"nothing is varied: add --vary '{example}', or give a study "
                                 "file.", param_hint="--vary")
    try:
        yield
    except SceneError as error:
        if error.source:
            raise
        problems = []
        for each in error.problems:
            head, *steps = parse_path(each.path) if each.path.startswith("$") else ("",)
            if head in ("vary", "keep", "set", "design", "count", "seed"):
                names = {f"{path}={values}": (path,) for path, values in vary.items()} \
                    if head == "vary" else {text: (text, text.partition("=")[0].strip())
                                            for text in keep if head == "keep"}
                word = next((text for text, known in names.items() if {*known} & {*steps}), "")
                each = replace(each, path=f"--{head} {shlex.quote(word) if word else ''}".rstrip(),
                               fields="")
            problems.append(each)
        raise SceneError(problems) from None


# -- sweeps --------------------------------------------------------------------------


@click.command()
@_takes_study(
    "Values of a path: from:to:count, as in 'parameters.pull=2 N:8 N:7', with ':log' even ratios; "
    "a list, '1,2,5'; a distribution, 'normal(3 N, 0.2 N)'; from:to, of designs with a count. "
    "Several make a grid.",
    "Directory of the table, and of finished runs; sweeps/NAME by default.",
    _KEEP,
    click.option("--design", type=click.Choice(DESIGNS), help="Arrangement of the points; a grid "
                 "by default, random where there is a distribution, else latin_hypercube."),
    click.option("--count", type=click.IntRange(min=1), metavar="N",
                 help="Number of points, of designs other than grid and paired."),
    _SEED)
@click.option("--recordings", is_flag=True, help="Keep the whole recording of each run, too.")
@click.option("--no-audit", is_flag=True, help="Do not audit runs; this halves the time.")
@click.option("--again", is_flag=True, help="Repeat finished runs.")
def sweep(
    scene: Source, out: Path | None, workers: int | str, again: bool, console: Console,
    **options: Any,
) -> int:
    """Run SCENE many times with values varied.

    SCENE is a scene, or a study file that defines what is varied and kept. Writes
    table.csv (and table.parquet where pyarrow is installed) with a row for each
    run, and sweep.png; of a grid of two paths a map. Finished runs are not
    repeated: the same command resumes an interrupted sweep.
    """
    from sandbox.sweeps.processes import preload

    began = time.perf_counter()
    if isinstance(workers, int):
        preload()
    from sandbox.sweeps.plan import plan_of, read_plan
    from sandbox.sweeps.sweep import run_plan, study_data
    from sandbox.sweeps.table import preload as preload_figures

    if _is_study(scene, {*options, "overrides"}):
        plan = read_plan(scene.word, scene.limits)
    else:
        audit = not options.pop("no_audit")
        with _problems_at_options(options["vary"], options["keep"], "parameters.pull=2:8:7"):
            plan = plan_of(study_data(scene.word, set=scene.overrides, audit=audit, **options),
                           scene.limits)
    folder = out or Path("sweeps", safe_name(plan.name))
    prepare(folder)
    console.say(f"{plan.name}: {len(plan)} runs of {plan.loaded.mechanism.name}")
    preload_figures()
    with many_runs(folder, console), Progress("sweep", console) as bar:
        def advance(at: Advance) -> None:
            bar(at.done / max(at.total - at.before, 1))
            if not sys.stderr.isatty() and at.done:
                rate = at.done / at.seconds
                left = timedelta(seconds=round((at.total - at.before - at.done) / rate))
                looks = f", {at.doubtful} to look at" if at.doubtful else ""
                bar.note(f"{at.before + at.done} of {at.total} runs, {rate:.3g} a second, "
                         f"{left} left{looks}")

        found = run_plan(plan, folder, workers=workers, again=again, progress=advance)
    return _report_sweep(found, folder, console, time.perf_counter() - began)


def _report_sweep(found: SweepTable, folder: Path, console: Console, seconds: float) -> int:
    import numpy as np

    from sandbox.sweeps.table import CSV, FIGURE, PARQUET, SPEC, draw_table

    draw_table(found, folder / FIGURE)
    files = written(folder, (CSV, PARQUET, FIGURE, SPEC))
    counts = Counter(found.status)
    missed = [run for run, holds in enumerate(found.holds.tolist()) if holds == 0]
    looks = int(found.doubtful.sum())
    rows, lines = [], list[str]()
    for name, values in found.kept.items():
        finite = values[np.isfinite(values)]
        numbers = [f"{value:.6g}" for value in np.quantile(finite, [0, 0.5, 1])] \
            if len(finite) else ["-", "-", "-"]
        rows.append([name, found.plan.units.get(name, ""), *numbers])
    if rows:
        lines += [*table(["kept", "unit", "least", "middle", "largest"], rows, right="<<>>>"), ""]
    reasons: dict[str, Counter[str]] = {}
    for status, reason in zip(found.status, found.reason, strict=True):
        reasons.setdefault(status, Counter()).update([reason] if reason else ())
    lines += [f"{runs} of {len(found)} runs {status}: {_most_frequent(reasons[status])}"
              for status, runs in counts.items() if status != "done"]
    if words := reasons.get("done"):
        lines.append(f"{words.total()} runs have missing results: {_most_frequent(words)}")
    if missed:
        failed = Counter(name for run in missed for name in found.failed[run])
        lines.append(f"{len(missed)} of {len(found)} runs miss expectations: "
                     f"{_most_frequent(failed)}")
    if looks:
        names = sorted({name for each in found.looks for name in each})
        lines.append(f"{looks} runs have warnings: {', '.join(names)}")
    return console.finish({
        "directory": folder, "files": files, "runs": len(found), "counts": counts,
        "missed": len(missed), "look": looks, "wall_s": seconds,
    }, [*lines, f"{folder}: {', '.join(files)}  ({seconds:.1f} s)"])


def _most_frequent(words: Counter[str]) -> str:
    return "; ".join(f"{word} ({count})" for word, count in words.most_common(MAX_REASONS))


# -- searches ------------------------------------------------------------------------


class _Searches(Commands):
    """Runs the search of a study file, too."""

    noun, nouns = "search", "Searches"

    def resolve_command(
        self, ctx: click.Context, args: list[str],
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args[0] not in self.commands and args[0].endswith(".json"):
            kind = _kind_of(args[0], ctx)
            return kind, self.commands[kind], args
        return super().resolve_command(ctx, args)


def _kind_of(word: str, ctx: click.Context) -> str:
    """The command of the search in a study file."""
    from sandbox.scene.read.source import read_source
    from sandbox.search.searches import FINDERS
    from sandbox.search.session import read_session
    from sandbox.sweeps.plan import study_file

    file = study_file(word)
    found = read_source(file).data.get("search") if file else None
    if found is None:
        raise click.UsageError(
            f"{word} is not a search: write 'sandbox search optimize {word}', or add a key "
            f"\"search\" to the study file ({', '.join(search.list_commands(ctx))}).", ctx)
    kind = next((name for name in FINDERS if isinstance(found, dict) and name in found), "")
    kind = kind or read_session(word).kind  # reports what is wrong with it
    return NAMES.get(kind, kind)


@click.group(cls=_Searches, invoke_without_command=True)
@click.pass_context
def search(ctx: click.Context) -> None:
    """Find thresholds, fits, optima or sensitivities.

    SCENE is a scene, or a study file that defines what is varied and kept; if it has
    a key "search", 'sandbox search STUDY.json' runs that. Finished runs are not
    repeated: the same command resumes an interrupted search. The result is
    checked by runs at half the time step.
    """
    if ctx.invoked_subcommand is None:
        raise click.UsageError(f"Say which search: {', '.join(search.list_commands(ctx))}.", ctx)


def _read_noise(
    ctx: click.Context, param: click.Parameter, words: tuple[str, ...],
) -> dict[str, float | None]:
    read = read_quantity(None)
    return {name: read(ctx, param, text) for name, text in read_pairs(ctx, param, words).items()}


SEARCHES: dict[str, tuple[str, list[Callable[[Any], Any]]]] = {
    "threshold": (
        "The value at which a condition begins or ceases to hold.\n\n"
        "The condition is --where, or the expectations of the scene.", [
            _KEEP, _WHERE,
            click.option("--within", metavar="WIDTH", callback=read_quantity(None),
                         help="Width of the bracket; a thousandth of the range by default.")]),
    "fit": (
        "The values with which the scene reproduces a measurement.\n\n"
        "With 95 % intervals, and the directions that the data do not determine.", [
            click.option("--data", type=click.Path(path_type=Path), metavar="FILE.csv",
                         help="Columns 'time' [s], and quantities in SI or as in 'x [mm]'."),
            click.option("--match", multiple=True, metavar="COLUMN=QUANTITY", callback=read_pairs,
                         help="Quantity of a column, as in 'x=puck.x'; its name by default."),
            click.option("--noise", multiple=True, metavar="COLUMN=SIZE", callback=_read_noise,
                         help="Standard deviation, as in 'x=0.5 mm'; estimated by default.")]),
    "best": (
        "The values that minimise or maximise results.", [
            _KEEP,
            click.option("--minimize", "least", multiple=True, metavar="NAME",
                         help="A result to minimise. Several goals have several solutions."),
            click.option("--maximize", "most", multiple=True, metavar="NAME",
                         help="A result to maximise."),
            _WHERE,
            click.option("--sampler", metavar="NAME",
                         help="cmaes (the default for one goal over ranges), tpe (with conditions "
                              "or lists), gp, nsga2 (for several goals), random."),
            click.option("--runs", type=click.IntRange(min=1), default=200, show_default=True,
                         help="Number of runs; more continue the search."),
            _SEED]),
    "sensitivity": (
        "The influence of each path on each result.", [
            _KEEP,
            click.option("--method", metavar="NAME", default="sobol", show_default=True,
                         help="sobol (shares of the variance) or morris (screening)."),
            click.option("--count", type=click.IntRange(min=1), default=64, show_default=True,
                         help="Base points, a power of 2, each with a run per path and two more; "
                              "or Morris' trajectories."),
            _SEED])}
"""Help and options of each search; both have the names of a study file."""


def _search(
    kind: str, scene: Source, *, vary: dict[str, str], keep: tuple[str, ...] = (),
    out: Path | None, workers: int | str, console: Console, **options: Any,
) -> int:
    """Run a search and report the result; the exit code."""
    from sandbox.sweeps.processes import preload

    began, new, progress = time.perf_counter(), 0, Progress("", console)
    if isinstance(workers, int):
        preload()
    from sandbox.search.fitting import COMPARED
    from sandbox.search.searches import run_search
    from sandbox.search.session import FIGURE, FOUND, RESULT, make_session, read_session
    from sandbox.sweeps.table import CSV, PARQUET

    if _is_study(scene, ("vary", "keep", "overrides")):
        session = read_session(scene.word, scene.limits)
        _is_study(scene, session.options if session.in_file == kind else ())
    else:
        with _problems_at_options(vary, keep, "parameters.pull=2 N:8 N"):
            session = make_session(scene.word, vary=vary, keep=list(keep) or None,
                                   set=scene.overrides, limits=scene.limits)
    if not session.in_file and options.get("data", "") is None:
        raise click.BadParameter("name the file with the measured data.", param_hint="--data")
    session.choose(kind, **{name: None if value == {} else value
                            for name, value in options.items()})
    folder = out or _own_directory(session)
    prepare(folder)

    def count(_row: object) -> None:
        nonlocal new
        new += 1
        progress.note(f"{new} runs, {new / progress.seconds:.3g} a second")

    with many_runs(folder, console):
        found = run_search(session, folder, workers, count)
    seconds = time.perf_counter() - began
    files = written(folder, (RESULT, CSV, PARQUET, COMPARED, FIGURE, FOUND))
    result = json.loads((folder / RESULT).read_text(encoding="utf-8"))["found"]
    return console.finish({
        "search": kind, "directory": folder, "files": files, "found": result, "new": new,
        "wall_s": seconds,
    }, [*found.lines, f"{folder}: {', '.join(files)}  ({new} new runs, {seconds:.1f} s)"])


def _own_directory(session: Session) -> Path:
    """The first directory of the question's name that has no runs of another question."""
    from sandbox.atomic_files import json_text, write_atomic
    from sandbox.sweeps.job import FOLDER, row_files

    kind, name = session.kind, safe_name(session.plan.name)
    options = {name: option for name, option in session.options.items() if name not in EXTENT}
    question = json_text([{**session.plan.written, "search": kind}, options], sort_keys=True,
                         ensure_ascii=True)
    for number in count_from(1):
        folder = Path("searches", NAMES.get(kind, kind), f"{name}-{number}" if number > 1 else name)
        file = folder / QUESTION
        if not file.is_file() or not any(row_files(folder / FOLDER)):
            prepare(folder)
            write_atomic(file, question + "\n")
            return folder
        if file.read_text(encoding="utf-8", errors="replace").strip() == question:
            return folder
    raise AssertionError("numbers do not end")


for _kind, (_about, _options) in SEARCHES.items():
    search.command(NAMES.get(_kind, _kind), help=_about)(_takes_study(
        "Values of a path: a range, 'parameters.pull=2 N:8 N', with ':log' for even ratios; a list "
        "or a distribution, 'normal(3 N, 0.2 N)', where the search takes them.",
        "Directory of the results and finished runs; by default searches/KIND/NAME, with a number "
        "for another question.", *_options)(partial(_search, _kind)))
