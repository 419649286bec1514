"""``sandbox verify``: the engine held against the paper's equations, as a report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from sandbox.cli.console import Console, Progress, compilation_notices, table
from sandbox.cli.failures import Exit
from sandbox.cli.options import OUT
from sandbox.cli.runs import prepare
from sandbox.wording import meant

if TYPE_CHECKING:
    from sandbox.verification.benchmarks.benchmark import Benchmark, BenchmarkRuns
    from sandbox.verification.cases.case import Case, CaseResult, Check


@click.command()
@click.option("--out", type=OUT, metavar="DIR",
              help="Where the report goes; docs/verification in a checkout, otherwise "
                   "verification, by default.")
@click.option("--only", multiple=True, metavar="NAME",
              help="Only this case or benchmark; no report unless --out is given. May be given "
                   "several times.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
def verify(out: Path | None, only: tuple[str, ...], as_json: bool, quiet: bool) -> int:
    """Hold the engine against closed forms and independent solutions.

    Writes the cases (index.md, results.json) and the published benchmarks
    (benchmarks.md, benchmarks.json), with plots. Exits 1 if one fails or cannot
    be computed.
    """
    from sandbox.verification.benchmarks.page import measure
    from sandbox.verification.verify import verify as run_cases

    cases, benchmarks = _chosen(only)
    directory = out if out is not None or only else default_directory()
    if directory is not None:
        prepare(directory)
    console = Console(as_json=as_json, quiet=quiet)
    share = len(cases) / (len(cases) + len(benchmarks))
    with (compilation_notices(console),
          Progress("verify", shown=console.shows_progress) as progress):
        results = run_cases(cases, progress=lambda done: progress(share * done))
        runs = measure(benchmarks, progress=lambda done: progress(share + (1 - share) * done))
    files = _write(results, runs, directory)
    holds = all(r.ok for r in results) and all(r.ok for r in runs)
    code = Exit.DONE if holds else Exit.FAILED
    _report(results, runs, directory, files, code, console)
    return code


def default_directory() -> Path:
    """docs/verification in a checkout of sandbox, which has scenes/ beside docs/."""
    here = Path("docs")
    checkout = (here / "verification").is_dir() and Path("scenes").is_dir()
    return here / "verification" if checkout else Path("verification")


def _chosen(names: tuple[str, ...]) -> tuple[list[Case], list[Benchmark]]:
    from sandbox.verification.benchmarks import BENCHMARKS
    from sandbox.verification.cases import CASES

    known = [*(case.name for case in CASES), *(one.name for one in BENCHMARKS)]
    for name in names:
        if name not in known:
            raise click.BadParameter(f"no case is named {name!r}.{meant(name, known)} Cases: "
                                     f"{', '.join(known)}.", param_hint="--only")
    return ([case for case in CASES if not names or case.name in names],
            [one for one in BENCHMARKS if not names or one.name in names])


def _write(results: list[CaseResult], runs: list[BenchmarkRuns], directory: Path | None,
           ) -> list[str]:
    from sandbox.verification.benchmarks.page import write_page
    from sandbox.verification.verify import write_report

    if directory is None:
        return []
    return [*(write_report(results, directory) if results else []),
            *(write_page(runs, directory) if runs else [])]


def _report(results: list[CaseResult], runs: list[BenchmarkRuns], directory: Path | None,
            files: list[str], code: Exit, console: Console) -> None:
    from sandbox.verification.benchmarks import page
    from sandbox.verification.verify import conclusion, result_data

    if console.as_json:
        console.result_json({
            "status": code.name.lower(), "exit_code": int(code),
            "directory": None if directory is None else str(directory),
            "cases": [result_data(result) for result in results],
            "benchmarks": [page.result_data(run) for run in runs]})
        return
    rows = [[r.case.name, r.case.title, str(len(r.checks)),
             r.missing or ("pass" if r.ok else "FAIL")] for r in results]
    rows += [[r.benchmark.name, r.benchmark.title, str(len(r.checks)),
              "pass" if r.ok else "FAIL"] for r in runs]
    console.say(*table(["case", "", "checks", ""], rows, right="<<>"))
    for name, checks in (*((r.case.name, r.checks) for r in results),
                         *((r.benchmark.name, r.checks) for r in runs)):
        for check in checks:
            if not check.ok:
                console.say(_failed(name, check))
    for said in (conclusion(results) if results else "", page.conclusion(runs) if runs else ""):
        if said:
            console.say(*said.splitlines())
    if directory is not None:
        plots = sum(name.endswith(".png") for name in files)
        console.say(f"{directory}: {', '.join(name for name in files if name.endswith('.md'))} "
                    f"and {plots} plots")


def _failed(name: str, check: Check) -> str:
    return (f"FAIL {name}: {check.what}: {check.found:.6g} {check.unit} instead of "
            f"{check.expected:.6g}, off by {check.off:.2g}, allowed {check.allowed:.2g}: "
            f"{check.why}")
