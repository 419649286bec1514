"""Points in, rows out: what was run is taken from the log, the rest is run and added to it.

Sweeps and searches share it, so whatever asks for the same points again, a search that was stopped
as well as a sweep, goes on by itself.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from types import TracebackType
from typing import Protocol, Self

from sandbox.sweeps.crew import crew_of
from sandbox.sweeps.job import SweepJob, SweepRow, Task, run_id
from sandbox.sweeps.log import Log
from sandbox.sweeps.points import Override
from sandbox.sweeps.pool import Pool


class Workers(Protocol):
    """Whatever runs points."""

    def results(self, tasks: Iterable[Task]) -> Iterator[SweepRow]:
        """The rows of all tasks as they are done, in any order."""


class Evaluator:
    """Runs points of one job, as a context that ends the workers; they begin when first needed.

    Args:
        job: what is run.
        log: of what was run, open.
        workers: processes at hand; as many as there are processors by default.
        cluster: address of a Dask scheduler, which is used in their place.
        most: no more processes than this; as many as there are runs, of a known number.
        heard: is told each row that was run.

    Raises:
        SandboxError: a number of workers that is not begun.
    """

    def __init__(
        self, job: SweepJob, log: Log, *, workers: int = 0, cluster: str = "", most: int = 0,
        heard: Callable[[SweepRow], None] | None = None,
    ) -> None:
        self.job, self._log, self._heard = job, log, heard
        self._workers, self._cluster = crew_of(workers), cluster
        self._most = most or self._workers
        self._digest = job.digest
        self._crew: Workers | None = None
        self._held = contextlib.ExitStack()
        self._known: dict[str, SweepRow] | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._held.__exit__(kind, error, trace)
        self._crew = None

    def run(self, tasks: Iterable[Task]) -> Iterator[SweepRow]:
        """Run tasks, known or not, and log each; their rows as they are done, in any order.

        Raises:
            OutputError: the log cannot be written.
            SandboxError: no workers, or a cluster that cannot be used.
        """
        if self._crew is None:
            self._crew = self._held.enter_context(self._begun())
        for row in self._crew.results(tasks):
            self._log.add(row)
            if self._heard:
                self._heard(row)
            yield row

    def rows(self, points: Sequence[Mapping[str, Override]]) -> list[SweepRow]:
        """The rows of points, in their order; only what the log does not have is run.

        Raises:
            OutputError: the log cannot be read or written.
            SandboxError: no workers, or a cluster that cannot be used.
        """
        if self._known is None:
            self._known = {row.id: row for row in self._log.rows()}
        ids = [run_id(self._digest, point) for point in points]
        missing = {id: point for id, point in zip(ids, points, strict=True)
                   if id not in self._known}
        if missing:
            self._known.update((row.id, row) for row in self.run(missing.items()))
        return [self._known[id] for id in ids]

    def _begun(self) -> AbstractContextManager[Workers]:
        if self._cluster:
            from sandbox.sweeps.cluster import Cluster

            return Cluster(self.job, self._cluster)
        return Pool(self.job, min(self._workers, self._most))
