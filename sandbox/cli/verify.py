"""``sandbox verify``: the engine held against the paper's equations, as a report."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sandbox.cli.compiling import told_if_compiling
from sandbox.cli.console import Console, table
from sandbox.cli.exits import Exit
from sandbox.cli.output import prepare
from sandbox.cli.progress import Progress

if TYPE_CHECKING:
    from sandbox.verification.cases import Case
    from sandbox.verification.cases.case import CaseResult


@click.command()
@click.option("--out", type=click.Path(path_type=Path), metavar="DIR",
              help="Where the report goes; docs/verification in a checkout, otherwise "
                   "verification, by default.")
@click.option("--only", multiple=True, metavar="CASE",
              help="Only this case; no report unless --out is given. May be given several times.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
def verify(out: Path | None, only: tuple[str, ...], as_json: bool, quiet: bool) -> int:
    """Hold the engine against closed forms and independent solutions.

    Writes a table (index.md), the numbers (results.json) and plots. Exits 1 if
    a case fails or cannot be computed.
    """
    from sandbox.verification.verify import verify as run_cases
    from sandbox.verification.verify import write_report

    cases = _chosen(only)
    directory = out if out is not None or only else default_directory()
    if directory is not None:
        prepare(directory)
    console = Console(as_json=as_json, quiet=quiet)
    with (told_if_compiling(console),
          Progress("verify", shown=console.shows_progress) as progress):
        results = run_cases(cases, progress=progress)
    if directory is not None:
        write_report(results, directory)
    code = Exit.DONE if all(result.ok for result in results) else Exit.FAILED
    _report(results, directory, code, console)
    return code


def default_directory() -> Path:
    """docs/verification in a checkout of sandbox, which has scenes/ beside docs/."""
    here = Path("docs")
    checkout = (here / "verification").is_dir() and Path("scenes").is_dir()
    return here / "verification" if checkout else Path("verification")


def _chosen(names: tuple[str, ...]) -> list[Case]:
    from sandbox.verification.cases import CASES

    known = {case.name: case for case in CASES}
    for name in names:
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1)
            hint = f" Did you mean {near[0]!r}?" if near else ""
            raise click.BadParameter(f"no case is named {name!r}.{hint} Cases: "
                                     f"{', '.join(known)}.", param_hint="--only")
    return [known[name] for name in names] or list(CASES)


def _report(
    results: list[CaseResult], directory: Path | None, code: Exit, console: Console,
) -> None:
    from sandbox.verification.verify import INDEX, conclusion, result_data

    if console.as_json:
        console.result_json({
            "status": code.name.lower(), "exit_code": int(code),
            "directory": None if directory is None else str(directory),
            "cases": [result_data(result) for result in results]})
        return
    rows = [[r.case.name, r.case.title, str(len(r.checks)),
             r.missing or ("pass" if r.ok else "FAIL")] for r in results]
    console.say(table(["case", "", "checks", ""], rows, right="<<>"))
    for r in results:
        for check in r.checks:
            if not check.ok:
                console.say(f"FAIL {r.case.name}: {check.what}: {check.found:.6g} {check.unit} "
                            f"instead of {check.expected:.6g}, off by {check.off:.2g}, allowed "
                            f"{check.allowed:.2g}: {check.why}")
    console.say(conclusion(results))
    if directory is not None:
        console.say(f"{directory}: {INDEX} and {sum(bool(r.panels) for r in results)} plots")
