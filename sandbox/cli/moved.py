"""``sandbox compare`` of two sweeps: which of what they kept moved, by how much, and where."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sandbox.cli.console import Console, table
from sandbox.cli.exits import Exit

if TYPE_CHECKING:
    from sandbox.sweeps.compared import Moved, Movement

SWEEPS = Path("sweeps")
MOST_TOLD = 8


def sweep_directory(word: str) -> Path | None:
    """The directory of a sweep: itself, or that of this name in ``sweeps/``; None if it is none."""
    from sandbox.sweeps.compared import is_sweep

    return next((path for path in (Path(word), SWEEPS / word) if is_sweep(path)), None)


def compare_sweeps(
    one: Path, other: Path, console: Console, *, tolerance: float | None, step_check: int | None,
) -> int:
    """Say what moved from the first sweep to the second.

    Raises:
        UsageError: two tolerances at once.
        SandboxError: they have nothing in common, or the first cannot be run again.
    """
    from sandbox.cli.compiling import compilation_notices
    from sandbox.errors import SandboxError
    from sandbox.sweeps.compared import SHARE, compared, halved, read_kept

    if tolerance is not None and step_check is not None:
        raise click.UsageError("--tolerance and --step-check both say what counts as moved: "
                               "give one of them")
    first, second = read_kept(one), read_kept(other)
    allowed = None
    if step_check is not None:
        compared(first, second)  # what is wrong with them is told before anything runs
        with compilation_notices(console):
            try:
                allowed = halved(first, step_check)
            except SandboxError as error:
                try:  # after a change the first one's scene is gone, and the second one's is there
                    allowed = halved(second, step_check)
                except SandboxError:
                    raise error from None
    share = SHARE if tolerance is None else tolerance
    found = compared(first, second, share=share, tolerances=allowed)
    if console.as_json:
        console.result_json({"status": "done", "exit_code": int(Exit.DONE), "same": found.same,
                             "sweeps": [str(one), str(other)],
                             **({} if allowed else {"tolerance": share}), **_data(found)})
        return Exit.DONE
    console.say(*_told(found, one, other, share))
    return Exit.DONE


def _told(found: Movement, one: Path, other: Path, share: float) -> list[str]:
    moved = sorted((each for each in found.results if each.moved), key=lambda each: -each.moved)
    lines = [f"{found.matched} rows in both, {len(found.results)} kept results"]
    for count, path in zip(found.alone, (one, other), strict=True):
        lines += [f"{count} rows in {path} only"] * bool(count)
    for where, before, after in found.ended[:MOST_TOLD]:
        lines.append(f"{_at(where)}: {before or 'not done'} in {one}, {after or 'not done'} in "
                     f"{other}")
    if more := len(found.ended) - MOST_TOLD:
        lines += [f"{more} more rows ended otherwise"] * (more > 0)
    if moved:
        rows = [[each.name, each.unit, f"{each.moved} of {each.rows}", f"{each.largest:+.4g}",
                 f"{each.first:.6g}", _tolerance(each, share), _at(each.where)] for each in moved]
        lines += table(["moved", "unit", "rows", "by at most", "from", "tolerance", "where"], rows,
                       right="<<>>>><")
    still = len(found.results) - len(moved)
    lines += [f"{still} of {len(found.results)} kept results did not move"] * bool(still)
    return lines


def _tolerance(each: Moved, share: float) -> str:
    return f"{share:.3g} of it" if each.tolerance is None else f"{each.tolerance:.3g}"


def _at(where: Mapping[str, str]) -> str:
    return ", ".join(f"{path} = {_short(value)}" for path, value in where.items())


def _short(text: str) -> str:
    try:
        return f"{float(text):.6g}"
    except ValueError:
        return text


def _data(found: Movement) -> dict[str, object]:
    return {
        "matched": found.matched, "only_first": found.alone[0], "only_second": found.alone[1],
        "ended": [{"where": dict(where), "first": a, "second": b} for where, a, b in found.ended],
        "results": [{name: value for name, value in
                     {**asdict(each), "where": dict(each.where),
                      "first": each.first if math.isfinite(each.first) else None}.items()
                     if name != "tolerance" or value is not None}
                    for each in found.results]}
