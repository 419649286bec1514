"""Two sweeps held against each other: which of what was kept moved, by how much, and where.

Rows belong together where all paths that both have varied have the same values. What counts as
moved is what differs by more than a tolerance: a share of the larger number, or, by
:func:`halved`, what a run moves by when its step is halved.
"""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from sandbox.errors import OutputError, SandboxError
from sandbox.sweeps.job import DONE, STEP, run_id
from sandbox.sweeps.plan import plan_of
from sandbox.sweeps.runner import ready
from sandbox.sweeps.table import CSV, SPEC
from sandbox.wording import quoted

DIGITS = 12
"""Of the values of paths, by which rows are matched."""
SHARE = 1e-6
"""Of the larger number: what differs by less has not moved, if nothing else is said."""
Key = tuple[str, ...]


@dataclass(frozen=True)
class Kept:
    """A sweep as its directory has it."""

    directory: Path
    study: Mapping[str, Any]
    paths: tuple[str, ...]
    units: Mapping[str, str]
    """Of paths and of what is kept."""
    names: tuple[str, ...]
    """Of what is kept."""
    rows: Sequence[Mapping[str, str]]
    scene: Path | None = None
    """The file of its scene, where it was; None of a scene that stands in the study."""


@dataclass(frozen=True)
class Moved:
    """One kept result in two sweeps."""

    name: str
    unit: str
    rows: int
    """In which both have a value."""
    moved: int
    """In which these differ by more than the tolerance."""
    largest: float
    """The largest difference, second less first, by size; 0 where there is none."""
    first: float
    """The number of the first sweep there."""
    where: Mapping[str, str]
    """The values of the paths there."""
    tolerance: float | None
    """An absolute one, or None for a share of the number."""


@dataclass(frozen=True)
class Movement:
    """What came of it."""

    results: Sequence[Moved]
    matched: int
    alone: tuple[int, int]
    """Rows that only the first has, and only the second."""
    ended: Sequence[tuple[Mapping[str, str], str, str]] = field(default_factory=tuple)
    """Rows that ended otherwise: values, how in the first, how in the second."""

    @property
    def same(self) -> bool:
        """Whether nothing moved, no row is alone and none ended otherwise."""
        return not (any(each.moved for each in self.results) or any(self.alone) or self.ended)


def is_sweep(directory: Path) -> bool:
    """Whether a directory holds a sweep."""
    return (directory / SPEC).is_file() and (directory / CSV).is_file()


def read_kept(directory: Path) -> Kept:
    """A sweep's directory.

    Raises:
        OutputError: it holds none that can be read.
    """
    try:
        said = json.loads((directory / SPEC).read_text(encoding="utf-8"))
        with (directory / CSV).open(encoding="utf-8", newline="") as file:
            reader = csv.DictReader(file)
            columns, rows = list(reader.fieldnames or ()), list(reader)
        units = {str(name): str(unit) for name, unit in said["units"].items()}
        paths = tuple(path for group in _groups(said["study"]) for path in group)
        names = tuple(name for name in units if name not in paths and name in columns)
        if lacking := [name for name in (*paths, "id", "status") if name not in columns]:
            raise ValueError(f"{CSV} has no column {quoted(lacking[0])}")
        for row in rows:
            for name in names:
                float(row[name] or 0.0)
        scene = said.get("scene_file", "")
        return Kept(directory, said["study"], paths, units, names, rows,
                    directory / str(scene) if scene else None)
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise OutputError(f"there is no sweep that can be read in {directory}: {error}",
                          code="no-run") from None


def _groups(study: Mapping[str, Any]) -> Iterable[Mapping[str, Any]]:
    vary = study["vary"]
    return [vary] if isinstance(vary, Mapping) else [group["over"] for group in vary]


def compared(
    one: Kept, other: Kept, *, share: float = SHARE, tolerances: Mapping[str, float] | None = None,
) -> Movement:
    """What moved from one sweep to the other.

    Args:
        one: the first.
        other: the second.
        share: of the larger of two numbers, by which they may differ.
        tolerances: by how much what is kept may differ, by name, SI; in place of the share.

    Raises:
        SandboxError: they have varied nothing alike, or kept nothing alike.
    """
    paths = [path for path in one.paths if path in other.paths]
    names = [name for name in one.names if name in other.names]
    if not paths or not names:
        what = "no path is varied" if not paths else "nothing is kept"
        raise SandboxError(f"{what} in both {one.directory} and {other.directory}: there is "
                           "nothing to compare", code="sweeps-differ")
    mine, theirs = _by_values(one, paths), _by_values(other, paths)
    both = [key for key in mine if key in theirs]
    ended = tuple((_where(mine[key], paths), mine[key]["status"], theirs[key]["status"])
                  for key in both if mine[key]["status"] != theirs[key]["status"])
    pairs = [(mine[key], theirs[key]) for key in both]
    results = [_moved(name, one.units.get(name, ""), pairs, paths, share,
                      (tolerances or {}).get(name)) for name in names]
    return Movement(results, len(both), (len(mine) - len(both), len(theirs) - len(both)), ended)


def _by_values(kept: Kept, paths: Sequence[str]) -> dict[Key, Mapping[str, str]]:
    """Rows by the values of paths.

    Raises:
        SandboxError: several rows have the same ones.
    """
    found: dict[Key, Mapping[str, str]] = {}
    for row in kept.rows:
        key = tuple(_plain(row[path]) for path in paths)
        if key in found and any(row[name] != found[key][name] for name in kept.names):
            raise SandboxError(f"{kept.directory} has several rows with the same values of "
                               f"{', '.join(paths)}, the paths that both sweeps vary",
                               code="sweeps-differ")
        found[key] = row
    return found


def _plain(text: str) -> str:
    """A number without the rounding of its last digits; a text as it is."""
    try:
        return f"{float(text):.{DIGITS}g}"
    except ValueError:
        return text


def _where(row: Mapping[str, str], paths: Sequence[str]) -> dict[str, str]:
    return {path: row[path] for path in paths}


def _moved(
    name: str, unit: str, pairs: Sequence[tuple[Mapping[str, str], Mapping[str, str]]],
    paths: Sequence[str], share: float, tolerance: float | None,
) -> Moved:
    rows = moved = 0
    largest, first, where = 0.0, math.nan, dict[str, str]()
    for one, other in pairs:
        if not one[name] or not other[name]:
            continue
        a, b = float(one[name]), float(other[name])
        rows += 1
        most = share * max(abs(a), abs(b)) if tolerance is None else tolerance
        moved += not abs(b - a) <= most
        if abs(b - a) > abs(largest):
            largest, first, where = b - a, a, _where(one, paths)
    return Moved(name, unit, rows, moved, largest, first, where, tolerance)


def halved(kept: Kept, count: int) -> dict[str, float]:
    """By how much what is kept moves at most when the step is halved, by name, SI.

    So many runs of the sweep, spread over it, are made again with half their step.

    Raises:
        SandboxError: the sweep varies the step itself, or none of these runs came to its end; its
            scene, or sandbox, is another by now.
        SceneError: its scene is not found any more.
    """
    if STEP in kept.paths:
        raise SandboxError(f"{kept.directory} varies {STEP} itself: its own rows say what halving "
                           "it does", code="sweeps-differ")
    scene = {"scene": str(kept.scene)} if kept.scene and kept.scene.is_file() else {}
    plan = plan_of({**kept.study, **scene})
    done = [number for number, row in enumerate(kept.rows) if row["status"] == DONE]
    chosen = done if len(done) <= count else [
        done[round(k * (len(done) - 1) / max(count - 1, 1))] for k in range(count)]
    digest = plan.job.digest
    if any(run_id(digest, plan.points[number]) != kept.rows[number]["id"] for number in chosen):
        raise SandboxError(f"the scene of {kept.directory}, or sandbox itself, is not what it was "
                           "then: its runs cannot be made again with half the step",
                           code="sweeps-differ")
    job = replace(plan.job, set={**plan.job.set, STEP: plan.loaded.mechanism.run.step / 2},
                  audited=False)
    most: dict[str, float] = {}
    with ready(job) as run:
        for number in chosen:
            again = run("", plan.points[number])
            for name, value in again.kept.items():
                text = kept.rows[number].get(name, "")
                if value is not None and text:
                    most[name] = max(most.get(name, 0.0), abs(value - float(text)))
    if not most:
        raise SandboxError(f"no run of {kept.directory} came to its end with half its step",
                           code="sweeps-differ")
    return most
