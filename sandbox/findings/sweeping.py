"""The sweeps of a study, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from sandbox.scene.library import shipped_studies
from sandbox.sweeps.plan import read_plan
from sandbox.sweeps.sweep import Progress, run_plan
from sandbox.sweeps.table import SweepTable


def run_sweeps(
    names: Mapping[str, str], directory: Path, progress: Callable[[float], None] | None,
    **crew: Any,
) -> dict[str, SweepTable]:
    """Run shipped study files, or what is missing of them; their tables by the same names.

    Args:
        names: of the study file, by that of its directory.
        directory: where their directories are.
        progress: is told the share of all runs that are done.
        crew: ``workers`` and ``cluster``.

    Raises:
        OutputError: a directory cannot be written.
        SandboxError: no workers, or a cluster that cannot be used.
    """
    plans = {name: read_plan(shipped_studies()[study]) for name, study in names.items()}
    total, before, tables = sum(map(len, plans.values())), 0, {}
    for name, plan in plans.items():
        tables[name] = run_plan(plan, directory / name, **crew,
                                progress=progress and _share(progress, before, total))
        before += len(plan)
    return tables


def _share(progress: Callable[[float], None], before: int, total: int) -> Progress:
    return lambda at: progress((before + at.before + at.done) / total)
