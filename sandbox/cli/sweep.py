"""``sandbox sweep`` and ``sandbox search``: many runs of a scene with values varied."""

from __future__ import annotations

import json
import sys
import time
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from datetime import timedelta
from itertools import count as count_from
from pathlib import Path
from typing import Any

import click
import numpy as np

from sandbox.atomic_files import json_text, write_atomic
from sandbox.cli.console import Console, first_of, monitored, table
from sandbox.cli.options import NAMES, Source, prepare, safe_name, written
from sandbox.errors import SceneError
from sandbox.scene.read.source import SceneSource
from sandbox.search.fitting import COMPARED
from sandbox.search.searches import FINDERS, run_search
from sandbox.search.session import FIGURE as SEARCH_FIGURE
from sandbox.search.session import FOUND, RESULT, Session
from sandbox.sweeps import CSV, FIGURE, PARQUET, SPEC
from sandbox.sweeps.job import DONE, ROWS
from sandbox.sweeps.plan import plan_of, study_file
from sandbox.sweeps.sweep import Advance, run_plan, study_data
from sandbox.sweeps.table import SweepTable, draw_table
from sandbox.sweeps.table import preload as preload_figures
from sandbox.values.paths import parse_path

MAX_REASONS = 5
QUESTION = "question.json"  # names the question of a directory in ``searches/``
EXTENT = ("runs", "within", "count")  # these extend a search in its directory


def _study(scene: Source, vary: Mapping[str, str], example: str) -> SceneSource | None:
    """A study file, None for a scene, which needs ``--vary``."""
    study = study_file(scene.word, scene.limits)
    if study is None and not vary:
        raise click.BadParameter(f"nothing is varied: add --vary '{example}', or give a study "
                                 "file.", param_hint="--vary")
    return study


def _refuse(defined: Collection[str], word: str) -> None:
    """Refuse options of the command line that a study file defines, too."""
    for name, flag in _flags().items():
        if name in defined:
            raise click.BadParameter(f"{word} already defines this; change it there.",
                                     param_hint=flag)


def _flags() -> dict[str, str]:
    """The options that the command line gives, by parameter."""
    context = click.get_current_context()
    return {name: param.opts[0] for param in context.command.params if (name := param.name or "")
            and context.get_parameter_source(name) is click.core.ParameterSource.COMMANDLINE}


@contextmanager
def _problems_at_options() -> Iterator[None]:
    """Report problems of a study made of options at these options."""
    try:
        yield
    except SceneError as error:
        problems = []
        for each in error.problems:
            head, *steps = parse_path(each.path) if each.path.startswith("$") else ("",)
            names = [step for step in steps if isinstance(step, str) and step != "over"]
            words = [f"--{head}", *names[:1]]
            if head == "search":
                words = [_flags().get(str(step), "") for step in steps[1:2]]
            elif error.source:
                raise
            if head in ("search", "vary", "keep", "set", "design", "count", "seed"):
                each = replace(each, path=" ".join(words), line=0, fields="")
            problems.append(each)
        raise SceneError(problems) from None


def sweep(
    scene: Source, out: Path | None, workers: int | str, again: bool, console: Console,
    **options: Any,
) -> int:
    """Run a study, and print a summary of its table."""
    began = time.perf_counter()
    if _study(scene, options["vary"], "parameters.pull=2:8:7"):
        _refuse({*options, "overrides"}, scene.word)
        plan = plan_of(scene.word, scene.limits)
    else:
        audit = not options.pop("no_audit")
        with _problems_at_options():
            plan = plan_of(study_data(scene.word, set=scene.overrides, audit=audit, **options),
                           scene.limits)
    folder = out or Path("sweeps", safe_name(plan.name))
    prepare(folder)
    console.say(f"{plan.name}: {len(plan)} runs of {plan.loaded.mechanism.name}")
    preload_figures()
    with monitored(console, "sweep", folder) as bar:
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
    draw_table(found, folder / FIGURE)
    files = written(folder, (CSV, PARQUET, FIGURE, SPEC))
    missed = [row for row in found.rows if row.holds is False]
    looks = [row for row in found.rows if row.looks]
    counts, rows = Counter(found.status), []
    for name, values in found.kept.items():
        finite = values[np.isfinite(values)]
        numbers = [f"{value:.6g}" for value in np.quantile(finite, [0, 0.5, 1])] \
            if len(finite) else ["-", "-", "-"]
        rows.append([name, found.plan.units.get(name, ""), *numbers])
    lines = table(["kept", "unit", "least", "middle", "largest"], rows, right="<<>>>")
    lines += [""] if lines else []
    for status, runs in counts.items():
        reasons = [row.reason for row in found.rows if row.reason and row.status == status]
        if status != DONE:
            lines.append(f"{runs} of {len(found)} runs {status}: {_most_frequent(reasons)}")
        elif reasons:
            lines.append(f"{len(reasons)} runs have missing results: {_most_frequent(reasons)}")
    if missed:
        lines.append(f"{len(missed)} of {len(found)} runs miss expectations: "
                     f"{_most_frequent(name for row in missed for name in row.failed)}")
    if looks:
        names = sorted({name for row in looks for name in row.looks or ()})
        lines.append(f"{len(looks)} runs have warnings: {', '.join(names)}")
    return console.finish({
        "directory": folder, "files": files, "runs": len(found), "counts": counts,
        "missed": len(missed), "look": len(looks), "wall_s": seconds,
    }, [*lines, f"{folder}: {', '.join(files)}  ({seconds:.1f} s)"])


def _most_frequent(words: Iterable[str]) -> str:
    counted = [f"{word} ({count})" for word, count in Counter(words).most_common()]
    return first_of(counted, MAX_REASONS, between="; ")


def kind_of(word: str) -> str:
    """The search in a study file; empty if it has none."""
    study = study_file(word)
    if (found := study.data.get("search") if study else None) is None:
        return ""
    kind = next((name for name in FINDERS if isinstance(found, dict) and name in found), "")
    return kind or Session(word).kind  # reports what is wrong with it


def search(
    kind: str, scene: Source, *, vary: dict[str, str], keep: tuple[str, ...] = (),
    out: Path | None, workers: int | str, console: Console, **options: Any,
) -> int:
    """Run a search and report the result; the exit code."""
    began, new = time.perf_counter(), 0
    study = _study(scene, vary, "parameters.pull=2 N:8 N")
    own = study.data.get("search") if study else None
    if study:
        there = own.get(kind) if isinstance(own, dict) else None
        _refuse({"vary", "keep", "overrides", *(there if isinstance(there, dict) else ()),
                 *({"seed"} & study.data.keys() if own else ())}, scene.word)
    if own is None and options.get("data", "") is None:
        raise click.BadParameter("name the file with the measured data.", param_hint="--data")
    given = {name: None if value == {} else str(value) if isinstance(value, Path) else value
             for name, value in options.items()}

    def count(_row: object) -> None:
        nonlocal new
        new += 1
        progress.note(f"{new} runs, {new / (time.perf_counter() - began):.3g} a second")

    with nullcontext() if own else _problems_at_options():
        session = Session(study_data(scene.word, vary=vary or None, keep=keep,
                                     set=scene.overrides), scene.limits, kind, given)
        folder = out or _own_directory(session)
        prepare(folder)
        with monitored(console, kept=folder) as progress:
            found = run_search(session, folder, workers, count)
    seconds = time.perf_counter() - began
    files = written(folder, (RESULT, CSV, PARQUET, COMPARED, SEARCH_FIGURE, FOUND))
    result = json.loads((folder / RESULT).read_text(encoding="utf-8"))["found"]
    return console.finish({
        "search": kind, "directory": folder, "files": files, "found": result, "new": new,
        "wall_s": seconds,
    }, [*found.lines, f"{folder}: {', '.join(files)}  ({new} new runs, {seconds:.1f} s)"])


def _own_directory(session: Session) -> Path:
    """A new directory, or that of the same question, which its file has."""
    kind, name = session.kind, safe_name(session.plan.name)
    options = {name: option for name, option in session.options.items() if name not in EXTENT}
    question = json_text([{**session.plan.written, "search": kind}, options], sort_keys=True,
                         ensure_ascii=True)
    for number in count_from(1):
        folder = Path("searches", NAMES.get(kind, kind), f"{name}-{number}" if number > 1 else name)
        file = folder / QUESTION
        if not (file.is_file() and (folder / ROWS).is_file()):
            prepare(folder)
            write_atomic(file, question + "\n")
            break
        if file.read_text(encoding="utf-8", errors="replace").strip() == question:
            break
    return folder
