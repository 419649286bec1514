"""What searches over many runs share: their options, how they are asked, run and told."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from sandbox.cli.console import Console, Heartbeat, resume_notice, worker_compilation_notices
from sandbox.cli.failures import Exit
from sandbox.cli.options import OUT, crew_options, limit_option, override_option
from sandbox.cli.runs import default_directory, prepare
from sandbox.cli.scenes import complete_scene
from sandbox.cli.sweep import read_varied
from sandbox.cli.typed import told_as_typed

if TYPE_CHECKING:
    from sandbox.scene.read.limits import Limits
    from sandbox.search.written import WrittenSearch
    from sandbox.sweeps.job import SweepRow

F = TypeVar("F", bound=Callable[..., Any])
Option = Callable[[Any], Any]
RENDERS = Path("searches")
ASKED = "asked.json"
"""What is looked for in a directory of ``searches/``, which another search leaves alone."""
EXTENT = ("runs", "within", "count", "coarse", "probes")
"""Words that say how far a search goes: with others it goes on from what was done."""

_PATHS: list[Option] = [
    click.argument("scene", shell_complete=complete_scene),
    click.option("--vary", multiple=True, metavar="PATH=VALUES", callback=read_varied,
                 help="What is varied: a range, 'parameters.pull=2 N:8 N', with ':log' behind it "
                      "in even ratios; where it fits a distribution, 'normal(3 N, 0.2 N)', or a "
                      "list."),
]
KEEP = click.option("--keep", multiple=True, metavar="QUANTITY",
                     help="What is kept of each run: 'slip=max disc.x', 'ratio==tip / pull'; as "
                          "of 'sandbox sweep'.")
WHERE = click.option("--where", multiple=True, metavar="CONDITION",
                      help="What must hold of what is kept: 'slip < 1 mm'. Several must all hold.")
SEED = click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True,
                     help="Of points that are drawn.")
_PLACE: list[Option] = [
    override_option,
    click.option("--out", type=OUT, metavar="DIR",
                 help="Where the table of all runs and search.json go, and what is done is found "
                      "again; searches/SEARCH/NAME by default, with a number behind it for another "
                      "question."),
    crew_options,
    click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else."),
    click.option("--quiet", "-q", is_flag=True, help="Print errors only."),
    limit_option,
]


def with_options(*options: Option) -> Callable[[F], F]:
    """Give a command the options, in this order."""
    def give(command: F) -> F:
        return _in_order(_PATHS, _in_order(options, placed(command)))
    return give


def placed(command: F) -> F:
    """Give a command what all searches share: what is set, where they run, how they tell."""
    return _in_order(_PLACE, command)


def _in_order(options: Sequence[Option], command: F) -> F:
    for option in reversed(options):
        command = option(command)
    return command


def searched(
    scene: str, kind: str, options: dict[str, Any], *, vary: dict[str, str],
    keep: tuple[str, ...], overrides: dict[str, Any], out: Path | None, workers: int,
    cluster: str, as_json: bool, quiet: bool, option: str = "--vary", limits: Limits,
) -> int:
    """Do a search, and tell what was found; the exit code.

    Args:
        scene: as it was named: a scene, or a study file.
        kind: of the search.
        options: what it is asked besides, by the names of options.
        vary: what each path is given.
        keep: what is kept of each run.
        overrides: what else is changed.
        out: where files go.
        workers: processes; 0 for as many as there are processors.
        cluster: address of a Dask scheduler.
        as_json: one JSON object is printed.
        quiet: errors only.
        option: by which it is told what is varied.
        limits: of the scene.

    Raises:
        ClickException, SandboxError: words that do not fit; what the search has to say.
    """
    from sandbox.sweeps.copies import prepare as prepare_workers

    if not cluster:
        prepare_workers()
    from sandbox.search.asking import Where

    console = Console(as_json=as_json, quiet=quiet)
    began = time.perf_counter()
    asked = _asked(scene, kind, {option: vary, "--keep": keep, "--set": overrides}, limits)
    beside = _beside(scene, asked, options)
    folder = out or _own_folder(asked, kind, beside)
    prepare(folder)
    told = _RunsSoFar(console)
    with resume_notice(folder, console), worker_compilation_notices(console):
        found = asked.run(Where(folder, workers, cluster, told), kind=kind, **beside)
    return _report(kind, found.lines, folder, console, told.count, time.perf_counter() - began)


def _own_folder(asked: WrittenSearch, kind: str, beside: Mapping[str, Any]) -> Path:
    """The directory of this question: the first of its name that has no runs of another one."""
    from sandbox.atomic_files import write_atomic
    from sandbox.search.asking import plain_data
    from sandbox.sweeps.log import FOLDER, files_in

    words = {name: str(word) if isinstance(word, Path) else word
             for name, word in {**beside, **asked.words}.items() if name not in EXTENT}
    study = {**asked.question.plan.written, "vary": asked.question.source.data["vary"]}
    question = json.dumps(plain_data([{**study, "search": kind}, words]), sort_keys=True)
    name = default_directory(asked.question.name).name
    for folder in (RENDERS / kind / (f"{name}-{k}" if k > 1 else name) for k in count(1)):
        file = folder / ASKED
        if not file.is_file() or not any(files_in(folder / FOLDER)):
            prepare(folder)
            write_atomic(file, question + "\n")
            return folder
        if file.read_text(encoding="utf-8", errors="replace").strip() == question:
            return folder
    raise AssertionError("there is always a next number")


def _report(
    kind: str, lines: list[str], folder: Path, console: Console, new: int, seconds: float,
) -> int:
    """Tell what was found, in how many new runs and how many seconds."""
    from sandbox.search.asking import FIGURE, FOUND, RESULT, plain_data
    from sandbox.search.fitting import COMPARED
    from sandbox.sweeps.table import CSV, PARQUET

    files = [name for name in (RESULT, CSV, PARQUET, COMPARED, FIGURE, FOUND)
             if (folder / name).is_file()]
    if console.as_json:
        data = json.loads((folder / RESULT).read_text(encoding="utf-8"))
        console.result_json(plain_data({
            "status": "done", "exit_code": int(Exit.DONE), "search": kind,
            "directory": str(folder), "files": files, "found": data["found"], "new": new,
            "wall_s": seconds}))
        return Exit.DONE
    console.say(*lines, f"{folder}: {', '.join(files)}  ({new} new runs, {seconds:.1f} s)")
    return Exit.DONE


def _asked(
    scene: str, kind: str, given: Mapping[str, Any], limits: Limits,
) -> WrittenSearch:
    """What is searched: what a study file says, or the words of the command.

    ``given`` has those of three options: what is varied, kept and set.
    """
    from sandbox.search.question import asked
    from sandbox.search.written import WrittenSearch, only_of, read_search
    from sandbox.sweeps.plan import study_file

    if study_file(scene, limits):
        for name, words in given.items():
            if words:
                raise click.BadParameter(
                    f"{scene} is a study file, which says this itself; change it there.",
                    param_hint=name)
        found = read_search(scene, limits)
        only_of(found, kind)
        return found
    option, (vary, keep, overrides) = next(iter(given)), given.values()
    if not vary:
        raise click.BadParameter(f"say what is varied, as in {option} 'parameters.pull=2 N:8 N', "
                                 "or give a study file.", param_hint=option)
    with told_as_typed(vary, keep, option):
        return WrittenSearch(asked(scene, vary=vary, keep=list(keep) or None, set=overrides,
                                   limits=limits), "", {})


def _beside(scene: str, found: WrittenSearch, options: dict[str, Any]) -> dict[str, Any]:
    """What options say beside a file; refused if the file says it, too."""
    context = click.get_current_context()
    for name in found.words:
        if context.get_parameter_source(name) is click.core.ParameterSource.COMMANDLINE:
            raise click.BadParameter(f"{scene} says this itself; change it there.",
                                     param_hint=f"--{name}")
    beside = {name: value for name, value in options.items() if name not in found.words}
    if beside.get("data", "") is None:
        raise click.BadParameter("say which file has what was measured.", param_hint="--data")
    return beside


class _RunsSoFar:
    """How many runs were done, told now and then: nobody knows how many there will be."""

    def __init__(self, console: Console) -> None:
        self.count = 0
        self._console, self._when = console, Heartbeat()

    def __call__(self, row: SweepRow) -> None:
        """Take note of a finished run."""
        self.count += 1
        if self._when.due():
            rate = self.count / self._when.seconds
            self._console.warn(f"{self.count} runs, {rate:.3g} a second")
