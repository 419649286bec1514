"""``sandbox search``: thresholds, fits, optimisation and sensitivity over many runs of a scene."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from itertools import count as count_from
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from sandbox.cli.console import Console, Heartbeat, resume_notice, worker_compilation_notices
from sandbox.cli.failures import Exit
from sandbox.cli.options import OUT, limit_option, scene_options
from sandbox.cli.runs import default_directory, prepare
from sandbox.cli.scenes import complete_scene
from sandbox.cli.sweep import problems_at_options, read_varied, workers_option
from sandbox.wording import meant

if TYPE_CHECKING:
    from sandbox.scene.read.limits import Limits
    from sandbox.search.searches import Search
    from sandbox.sweeps.job import SweepRow

F = TypeVar("F", bound=Callable[..., Any])
SEARCHES = Path("searches")
QUESTION = "asked.json"
"""The question of a directory in ``searches/``, which other questions do not use."""
EXTENT = ("runs", "within", "count")
"""Options that extend a search, which then continues in the same directory."""
COMMANDS = {"best": "optimize"}
"""Commands whose names differ from those in study files."""
REMOVED = {
    "best": "Use 'sandbox search optimize SCENE' with --minimize or --maximize.",
    "robustness": "Use 'sandbox sweep SCENE' with two --vary: on a grid it draws a map of where "
                  "the expectations of the scene hold.",
}
"""Searches of earlier versions, and what replaces each."""


class _Searches(click.Group):
    """Runs the search of a study file, and suggests similar names."""

    def resolve_command(
        self, ctx: click.Context, args: list[str],
    ) -> tuple[str | None, click.Command | None, list[str]]:
        word, known = args[0], self.list_commands(ctx)
        if word in known or word.startswith("-") or ctx.resilient_parsing:
            return super().resolve_command(ctx, args)
        if word in REMOVED:
            raise click.UsageError(f"There is no search {word!r}. {REMOVED[word]}", ctx)
        if kind := _kind_of(word, known, ctx):
            return kind, self.commands[kind], args
        raise click.UsageError(f"There is no search {word!r}.{meant(word, known)} "
                               f"Searches: {', '.join(known)}.", ctx)


def _kind_of(word: str, known: list[str], ctx: click.Context) -> str:
    """The command of the search in a study file; empty for a word that names no file."""
    from sandbox.scene.read.source import read_source
    from sandbox.search.searches import FINDERS, read_search
    from sandbox.sweeps.plan import study_file

    file = study_file(word)
    if not word.endswith(".json") and file is None:
        return ""
    written = read_source(file or Path(word)).data.get("search") if file else None
    if file is None or written is None:
        raise click.UsageError(
            f"{word} is not a search: write 'sandbox search optimize {word}', or add a key "
            f"\"search\" to the study file ({', '.join(known)}).", ctx)
    kind = next((name for name in FINDERS if isinstance(written, dict) and name in written), "")
    kind = kind or read_search(word).kind  # reports what is wrong with it
    return COMMANDS.get(kind, kind)


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


def _options(*own: Callable[[Any], Any]) -> Callable[[F], F]:
    """Give a command the options of all searches, with its own among them."""
    shared = [
        click.argument("scene", shell_complete=complete_scene),
        click.option("--vary", multiple=True, metavar="PATH=VALUES", callback=read_varied,
                     help="Values of a path: a range, 'parameters.pull=2 N:8 N', with ':log' for "
                          "even ratios; for a fit also a list or a distribution, 'normal(3 N, 0.2 "
                          "N)'."),
        *own, scene_options,
        click.option("--out", type=OUT, metavar="DIR",
                     help="Directory of the results and finished runs; by default "
                          "searches/KIND/NAME, with a number for another question."),
        workers_option,
        click.option("--json", "as_json", is_flag=True,
                     help="Print one JSON object and nothing else."),
        click.option("--quiet", "-q", is_flag=True, help="Print errors only."),
        limit_option,
    ]

    def give(command: F) -> F:
        for option in reversed(shared):
            command = option(command)
        return command
    return give


KEEP = click.option("--keep", multiple=True, metavar="RESULT",
                    help="A result of each run: 'slip=max disc.x', 'ratio==tip / pull'; as of "
                         "'sandbox sweep'.")
WHERE = click.option("--where", multiple=True, metavar="CONDITION",
                     help="A condition on results: 'slip < 1 mm'. Several must all hold.")
SEED = click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True,
                    help="Of random points.")


@search.command()
@_options(KEEP, WHERE, click.option(
    "--within", metavar="WIDTH", help="Width of the bracket, as in '0.01 N'; a thousandth of the "
    "range by default."))
def threshold(scene: str, where: tuple[str, ...], within: str | None, **shared: Any) -> int:
    """The value at which a condition begins or ceases to hold.

    The condition is --where, or the expectations of the scene.
    """
    return _run(scene, "threshold", {"where": where, "within": _quantity(within, "--within")},
                **shared)


@search.command()
@_options(
    click.option("--data", type=click.Path(path_type=Path), metavar="FILE.csv",
                 help="The measurement: a column 'time' [s], and columns of quantities, SI or as "
                      "in 'x [mm]'."),
    click.option("--match", multiple=True, metavar="COLUMN=QUANTITY",
                 help="The quantity of a column, as in 'x=puck.x'; by default columns that have a "
                      "quantity's name."),
    click.option("--noise", multiple=True, metavar="COLUMN=SIZE",
                 help="Standard deviation of a column, as in 'x=0.5 mm'; estimated by default."))
def fit(
    scene: str, data: Path | None, match: tuple[str, ...], noise: tuple[str, ...], **shared: Any,
) -> int:
    """The values with which the scene reproduces a measurement.

    With 95 % intervals, and the directions that the data do not determine.
    """
    sizes = {name: _quantity(text, "--noise") for name, text in _pairs(noise, "--noise").items()}
    return _run(scene, "fit", {"data": data, "match": _pairs(match, "--match") or None,
                               "noise": sizes or None}, keep=(), **shared)


@search.command()
@_options(
    KEEP,
    click.option("--minimize", "least", multiple=True, metavar="NAME",
                 help="A result to minimise. Several goals have several solutions."),
    click.option("--maximize", "most", multiple=True, metavar="NAME",
                 help="A result to maximise."), WHERE,
    click.option("--sampler", metavar="NAME", help="cmaes (the default for one goal over ranges), "
                 "tpe (with conditions or lists), gp, nsga2 (for several goals), random."),
    click.option("--runs", type=click.IntRange(min=1), default=200, show_default=True,
                 help="Number of runs; a larger one continues the search."), SEED)
def optimize(
    scene: str, least: tuple[str, ...], most: tuple[str, ...], where: tuple[str, ...],
    sampler: str | None, runs: int, seed: int, **shared: Any,
) -> int:
    """The values that minimise or maximise results."""
    return _run(scene, "best", {"least": least, "most": most, "where": where, "sampler": sampler,
                                "runs": runs, "seed": seed}, **shared)


@search.command()
@_options(
    KEEP,
    click.option("--method", metavar="NAME", default="sobol", show_default=True,
                 help="sobol (shares of the variance) or morris (screening of many paths)."),
    click.option("--count", type=click.IntRange(min=1), default=64, show_default=True,
                 help="Base points, a power of 2, each with as many runs as there are paths and "
                      "two more; or Morris' trajectories."), SEED)
def sensitivity(scene: str, method: str, count: int, seed: int, **shared: Any) -> int:
    """The influence of each path on each result."""
    return _run(scene, "sensitivity", {"method": method, "count": count, "seed": seed}, **shared)


def _quantity(text: str | None, option: str) -> float | None:
    """A quantity of an option, SI."""
    from sandbox.values.units import parse_quantity
    from sandbox.wording import WrongValueError

    try:
        return None if text is None else parse_quantity(text, None)
    except WrongValueError as error:
        raise click.BadParameter(str(error), param_hint=option) from None


def _pairs(words: tuple[str, ...], option: str) -> dict[str, str]:
    """``name=value`` words as a table."""
    found = {}
    for word in words:
        name, equals, value = (part.strip() for part in word.partition("="))
        if not (name and equals and value):
            raise click.BadParameter(f"{word!r} is not of the form name=value", param_hint=option)
        found[name] = value
    return found


def _run(
    scene: str, kind: str, options: dict[str, Any], *, vary: dict[str, str],
    keep: tuple[str, ...], overrides: dict[str, Any], out: Path | None, workers: int | str,
    as_json: bool, quiet: bool, limits: Limits,
) -> int:
    """Run a search and report the result; the exit code."""
    from sandbox.sweeps.processes import preload

    if isinstance(workers, int):
        preload()
    from sandbox.search.session import Where

    console = Console(as_json=as_json, quiet=quiet)
    began = time.perf_counter()
    given = {"--vary": vary, "--keep": keep, "--set": overrides}
    chosen = _search(scene, kind, given, limits)
    beside = _beside(scene, chosen, options)
    folder = out or _own_directory(chosen, kind, beside)
    prepare(folder)
    progress = _SearchProgress(console)
    with resume_notice(folder, console), worker_compilation_notices(console):
        found = chosen.run(Where(folder, workers, progress), kind=kind, **beside)
    return _report(kind, found.lines, folder, console, progress.count,
                   time.perf_counter() - began)


def _search(scene: str, kind: str, given: Mapping[str, Any], limits: Limits) -> Search:
    """The search of a study file, or of the options ``--vary``, ``--keep`` and ``--set``."""
    from sandbox.search.session import make_question
    from sandbox.search.searches import Search, read_search
    from sandbox.sweeps.plan import study_file

    if study_file(scene, limits):
        for option, words in given.items():
            if words:
                raise click.BadParameter(
                    f"{scene} is a study file and already defines this; change it there.",
                    param_hint=option)
        found = read_search(scene, limits)
        found.require(kind)
        return found
    vary, keep, overrides = given.values()
    if not vary:
        raise click.BadParameter("nothing is varied: add --vary 'parameters.pull=2 N:8 N', or give "
                                 "a study file.", param_hint="--vary")
    with problems_at_options(vary, keep):
        return Search(make_question(scene, vary=vary, keep=list(keep) or None, set=overrides,
                                    limits=limits))


def _beside(scene: str, found: Search, options: dict[str, Any]) -> dict[str, Any]:
    """The options that a study file does not give; others are refused."""
    context, own = click.get_current_context(), found.options or {}
    for param in context.command.params:
        if param.name in own and context.get_parameter_source(param.name or "") is \
                click.core.ParameterSource.COMMANDLINE:
            raise click.BadParameter(f"{scene} already defines this; change it there.",
                                     param_hint=param.opts[0])
    beside = {name: value for name, value in options.items() if name not in own}
    if beside.get("data", "") is None:
        raise click.BadParameter("name the file with the measured data.", param_hint="--data")
    return beside


def _own_directory(chosen: Search, kind: str, beside: Mapping[str, Any]) -> Path:
    """The first directory of the question's name that has no runs of another question."""
    from sandbox.atomic_files import write_atomic
    from sandbox.search.session import plain_data
    from sandbox.sweeps.job import FOLDER, row_files

    options = {name: str(option) if isinstance(option, Path) else option
               for name, option in {**beside, **(chosen.options or {})}.items()
               if name not in EXTENT}
    question = json.dumps(plain_data([{**chosen.question.study, "search": kind}, options]),
                          sort_keys=True)
    name = default_directory(chosen.question.name).name
    for number in count_from(1):
        folder = SEARCHES / COMMANDS.get(kind, kind) / (f"{name}-{number}" if number > 1 else name)
        file = folder / QUESTION
        if not file.is_file() or not any(row_files(folder / FOLDER)):
            prepare(folder)
            write_atomic(file, question + "\n")
            return folder
        if file.read_text(encoding="utf-8", errors="replace").strip() == question:
            return folder
    raise AssertionError("numbers do not end")


def _report(
    kind: str, lines: list[str], folder: Path, console: Console, new: int, seconds: float,
) -> int:
    from sandbox.search.fitting import COMPARED
    from sandbox.search.session import FIGURE, FOUND, RESULT
    from sandbox.sweeps.table import CSV, PARQUET

    files = [name for name in (RESULT, CSV, PARQUET, COMPARED, FIGURE, FOUND)
             if (folder / name).is_file()]
    if console.as_json:
        data = json.loads((folder / RESULT).read_text(encoding="utf-8"))
        console.result_json({
            "status": "done", "exit_code": int(Exit.DONE), "search": kind,
            "directory": str(folder), "files": files, "found": data["found"], "new": new,
            "wall_s": seconds})
        return Exit.DONE
    console.say(*lines, f"{folder}: {', '.join(files)}  ({new} new runs, {seconds:.1f} s)")
    return Exit.DONE


class _SearchProgress:
    """Counts runs, and prints a line now and then."""

    def __init__(self, console: Console) -> None:
        self.count = 0
        self._console, self._when = console, Heartbeat()

    def __call__(self, row: SweepRow) -> None:
        self.count += 1
        if self._when.due():
            self._console.warn(f"{self.count} runs, {self.count / self._when.seconds:.3g} a second")
