"""Workers that run the points of a job: processes on this machine, or a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from functools import cached_property
from importlib import import_module
from itertools import islice
from multiprocessing.connection import wait as wait_for_sentinel
from pathlib import Path
from typing import Any

from sandbox import __version__
from sandbox.engine.compiling import on_compiling, report_worker_compilation
from sandbox.errors import SandboxError
from sandbox.sweeps.job import DIED, Log, Point, SweepJob, SweepRow, Task, run_id
from sandbox.sweeps.processes import check_workers, preload
from sandbox.wording import quoted

ATTEMPTS = 2
"""Worker processes that one run may end."""
CONNECT_TIMEOUT = 10.0
"""Seconds in which a Dask scheduler must answer, and have a worker."""
CLUSTER_TASKS = 1000
"""Runs that are at a cluster at a time."""


class Evaluator:
    """Runs points of one job and logs their rows; workers start with the first run.

    Args:
        job: the work.
        log: of finished runs, open.
        stack: ends the workers.
        workers: number of processes, 0 for one for each processor; or the address of a Dask
            scheduler, ``tcp://10.0.0.1:8786``, or its scheduler file.
        on_row: called with each row that was run.
    """

    def __init__(
        self, job: SweepJob, log: Log, stack: ExitStack, *, workers: int | str = 0,
        on_row: Callable[[SweepRow], None] = lambda row: None,
    ) -> None:
        self._job, self._log, self._stack, self._on_row = job, log, stack, on_row
        self._digest, self._count = job.digest, check_workers(workers)
        self._known: dict[str, SweepRow] = {}

    @cached_property
    def _workers(self) -> Processes | Cluster:
        if isinstance(self._count, str):
            return Cluster(self._job, self._count, self._stack)
        return Processes(self._job, self._count, self._stack)

    def run(self, tasks: Iterable[Task]) -> Iterator[SweepRow]:
        """Run tasks and log each; their rows as they are finished, in any order."""
        for row in self._workers.results(tasks):
            self._log.add(row)
            self._on_row(row)
            yield row

    def rows(self, points: Sequence[Point]) -> list[SweepRow]:
        """The rows of points, in their order; only those that the log lacks are run."""
        self._known = self._known or {row.id: row for row in self._log.rows()}
        ids = [run_id(self._digest, point) for point in points]
        missing = {id: point for id, point in zip(ids, points, strict=True)
                   if id not in self._known}
        if missing:
            self._known.update((row.id, row) for row in self.run(missing.items()))
        return [self._known[id] for id in ids]


class _Workers:
    """Runs points by an executor."""

    ahead: int
    """Runs that are submitted at a time."""

    def _submit(self, task: Task) -> Future[SweepRow]:
        raise NotImplementedError

    def _row_of(self, task: Task, future: Future[SweepRow]) -> SweepRow:
        return future.result()

    def _repeat(self, tasks: Iterable[Task]) -> Iterator[SweepRow]:
        """The rows of runs that were under way when a process died."""
        raise NotImplementedError

    def results(self, tasks: Iterable[Task]) -> Iterator[SweepRow]:
        """The rows of all tasks as they are finished, in any order."""
        source = iter(tasks)
        pending: dict[Future[SweepRow], Task] = {}
        while True:
            for task in islice(source, self.ahead - len(pending)):
                pending[self._submit(task)] = task
            if not pending:
                return
            done = wait(pending, return_when=FIRST_COMPLETED).done
            if any(_broken(future) for future in done):
                done = wait(pending).done  # a pool breaks as a whole
            suspects = []
            for future in done:
                task = pending.pop(future)
                if _broken(future):
                    suspects.append(task)
                else:
                    yield self._row_of(task, future)
            if suspects:
                yield from self._repeat(suspects)


def _broken(future: Future[SweepRow]) -> bool:
    return not future.cancelled() and isinstance(future.exception(), BrokenProcessPool)


# -- processes -----------------------------------------------------------------------


class Processes(_Workers):
    """Processes on this machine.

    The first one compiles the kernels that the scene needs before the others start. If a process
    dies, the pool is started anew and the runs that were under way are repeated alone, so that one
    that ends its process again is recognised.
    """

    def __init__(self, job: SweepJob, count: int, stack: ExitStack) -> None:
        self._job, self._count, self.ahead = job, count, 2 * count
        self._pool: ProcessPoolExecutor | None = None
        self._scene = stack.enter_context(job.bundle.unpacked())
        stack.callback(self._stop)
        self._context: Any = preload()
        self._notices = self._context.SimpleQueue()
        self._start(count)

    def _submit(self, task: Task) -> Future[SweepRow]:
        assert self._pool is not None
        try:
            return self._pool.submit(_run, *task)
        except BrokenProcessPool as error:
            failed: Future[SweepRow] = Future()
            failed.set_exception(error)
            return failed

    def _repeat(self, tasks: Iterable[Task]) -> Iterator[SweepRow]:
        self._start(1)
        for task in tasks:
            try:
                yield self._submit(task).result()
            except BrokenProcessPool:
                yield SweepRow(task[0], DIED, reason=f"{ATTEMPTS} worker processes ended in this "
                                                     "run")
                self._start(1)
        self._start(self._count)

    def _start(self, count: int) -> None:
        """Start a pool whose first process has compiled what the scene needs."""
        for _ in range(ATTEMPTS):
            self._stop()
            self._pool = ProcessPoolExecutor(count, self._context, _start_worker, (
                self._job, self._scene, self._notices))
            ready = self._pool.submit(_prepare)
            while not wait([ready], timeout=0.1).done or not self._notices.empty():
                while not self._notices.empty():
                    report_worker_compilation(self._notices.get())
            if not ready.exception():
                return
        raise SandboxError("a worker process ended before it could begin; a script that starts "
                           "workers does so under if __name__ == \"__main__\":",
                           code="worker-failed")

    def _stop(self) -> None:
        if self._pool is not None:
            for process in list((self._pool._processes or {}).values()):
                process.terminate()
            self._pool.shutdown(cancel_futures=True)
        self._pool = None


_worker: dict[str, Any] = {}
"""State of a worker process: its runner, and the queue for notices of compilation."""


def _start_worker(job: SweepJob, scene: Path | dict[str, Any], notices: Any) -> None:
    from sandbox.sweeps.runner import Runner  # loads the engine

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent
    threading.Thread(target=_exit_with_parent, daemon=True).start()
    _worker.update(run=Runner(job, scene), notices=notices)


def _exit_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait_for_sentinel([parent.sentinel])
        os._exit(1)


def _prepare() -> None:
    with on_compiling(lambda: _worker["notices"].put(None), _worker["notices"].put):
        _worker["run"].prepare()


def _run(id: str, values: Point) -> SweepRow:
    row: SweepRow = _worker["run"](id, values)
    return row


# -- cluster -------------------------------------------------------------------------


class Cluster(_Workers):
    """A Dask cluster, which repeats the runs of workers that die."""

    ahead = CLUSTER_TASKS

    def __init__(self, job: SweepJob, address: str, stack: ExitStack) -> None:
        self._address = address
        try:
            distributed: Any = import_module("distributed")
        except ImportError:
            raise SandboxError("a cluster needs Dask: pip install "
                               "'sandbox-mechanics[cluster]'", code="missing-package") from None
        key = "scheduler_file" if address.endswith(".json") else "address"
        try:
            if key == "scheduler_file" and not Path(address).is_file():
                raise FileNotFoundError("there is no such file")  # Dask would wait for it
            client = stack.enter_context(distributed.Client(
                **{key: address}, timeout=CONNECT_TIMEOUT, set_as_default=False))
            client.wait_for_workers(1, timeout=CONNECT_TIMEOUT)
        except (OSError, ValueError, TimeoutError) as error:
            raise self._unusable(
                f"cannot be reached: {error or type(error).__name__}; give the address of a Dask "
                "scheduler with workers, as in tcp://10.0.0.1:8786") from None
        for worker, version in sorted(client.run(_version).items()):
            if version != __version__:
                raise self._unusable(f"has a worker {worker} with sandbox {version}, here it is "
                                     f"{__version__}; install the same there")
        self._executor: Executor = client.get_executor(pure=False, retries=ATTEMPTS)
        self._placed = client.scatter(job, broadcast=True, hash=False)

    def _unusable(self, why: str) -> SandboxError:
        return SandboxError(f"the cluster {quoted(self._address)} {why}",
                            code="cluster-unreachable")

    def _submit(self, task: Task) -> Future[SweepRow]:
        return self._executor.submit(_run_remote, *task, job=self._placed)

    def _row_of(self, task: Task, future: Future[SweepRow]) -> SweepRow:
        try:
            return future.result()
        except CancelledError:
            raise self._unusable("lost runs; finished runs are saved, and the same command "
                                 "resumes") from None
        except Exception as error:  # whatever ended its workers
            return SweepRow(task[0], DIED, reason="workers of the cluster ended in this run: "
                                                  f"{error or type(error).__name__}")


def _run_remote(id: str, values: Point, job: SweepJob) -> SweepRow:
    from sandbox.sweeps.runner import make_runner  # loads the engine

    with make_runner(job) as run:
        return run(id, values)


def _version() -> str:
    return __version__
