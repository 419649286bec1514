"""Workers that run the points of a job: processes on this machine, or a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, suppress
from itertools import islice
from multiprocessing.connection import wait as wait_for_sentinel
from pathlib import Path
from typing import Any

from sandbox import __version__
from sandbox.engine.compiling import on_compiling, report_began, report_compiled
from sandbox.errors import SandboxError, optional
from sandbox.sweeps.job import Point, SweepJob, SweepRow, Task
from sandbox.sweeps.processes import preload
from sandbox.wording import quoted

ATTEMPTS = 2  # worker processes that one run may end
CONNECT_TIMEOUT = 10.0  # seconds in which a Dask scheduler must answer, and have a worker
CLUSTER_TASKS = 1000  # runs that are at a cluster at a time


def make_workers(job: SweepJob, workers: int | str, stack: ExitStack) -> Processes:
    """Start worker processes, or connect to a Dask scheduler; ``stack`` ends them."""
    if isinstance(workers, str):
        return Cluster(job, workers, stack)
    return Processes(job, workers, stack)


class Processes:
    """Processes on this machine.

    The first one compiles the kernels that the scene needs before the others start. If a process
    dies, the pool is started anew and the runs that were under way are repeated alone, so that one
    that ends its process again is recognised.
    """

    ahead: int  # runs that are submitted at a time

    def __init__(self, job: SweepJob, count: int, stack: ExitStack) -> None:
        self._job, self._count, self.ahead = job, count, 2 * count
        self._pool: ProcessPoolExecutor | None = None
        self._scene = stack.enter_context(job.bundle.unpacked())
        stack.callback(self._stop)
        self._context: Any = preload()
        self._notices = self._context.SimpleQueue()
        self._start(count)

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
            if any(map(_broken, done)):
                done = wait(pending).done  # a pool breaks as a whole
            suspects = [pending.pop(future) for future in done if _broken(future)]
            for future in done & pending.keys():
                yield self._row_of(pending.pop(future), future)
            if suspects:
                self._start(1)
                for task in suspects:
                    again = self._submit(task)
                    wait([again])
                    if _broken(again):
                        yield SweepRow(task[0], "died", reason=f"{ATTEMPTS} worker processes ended "
                                                             "in this run")
                        self._start(1)
                    else:
                        yield again.result()
                self._start(self._count)

    def _submit(self, task: Task) -> Future[SweepRow]:
        assert self._pool is not None
        future: Future[SweepRow] = Future()
        try:
            future = self._pool.submit(_run, *task)
        except BrokenProcessPool as error:
            future.set_exception(error)
        return future

    def _row_of(self, _task: Task, future: Future[SweepRow]) -> SweepRow:
        return future.result()

    def _start(self, count: int) -> None:
        """Start a pool whose first process has compiled what the scene needs."""
        for _ in range(ATTEMPTS):
            self._stop()
            self._pool = ProcessPoolExecutor(count, self._context, _start_worker, (
                self._job, self._scene, self._notices))
            ready = self._pool.submit(_prepare)
            while not wait([ready], timeout=0.1).done or not self._notices.empty():
                while not self._notices.empty():
                    if (seconds := self._notices.get()) is None:
                        report_began(in_workers=True)
                    else:
                        report_compiled(seconds, in_workers=True)
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


def _broken(future: Future[SweepRow]) -> bool:
    return not future.cancelled() and isinstance(future.exception(), BrokenProcessPool)


_worker: dict[str, Any] = {}  # its job, scene, and queue for notices of compilation


def _start_worker(job: SweepJob, scene: Path | dict[str, Any], notices: Any) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent
    threading.Thread(target=_exit_with_parent, daemon=True).start()
    job.bundle.register()
    _worker.update(job=job, scene=scene, notices=notices)


def _exit_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait_for_sentinel([parent.sentinel])
        os._exit(1)


def _prepare() -> None:
    from sandbox.engine.simulation import Simulation
    from sandbox.sweeps.runner import load_scene  # loads the engine
    with on_compiling(lambda: _worker["notices"].put(None), _worker["notices"].put), \
            suppress(Exception):  # each run reports the problems of its scene
        Simulation(load_scene(_worker["job"], _worker["scene"], {})[1])


def _run(id: str, values: Point) -> SweepRow:
    from sandbox.sweeps.runner import run_point
    return run_point(_worker["job"], _worker["scene"], id, values)


class Cluster(Processes):
    """A Dask cluster, which repeats the runs of workers that die itself."""

    ahead = CLUSTER_TASKS

    def __init__(self, job: SweepJob, address: str, stack: ExitStack) -> None:
        self._address = address
        distributed = optional("distributed", "'sandbox-mechanics[cluster]'")
        try:
            client = stack.enter_context(distributed.Client(
                address, timeout=CONNECT_TIMEOUT, set_as_default=False))
            client.wait_for_workers(1, timeout=CONNECT_TIMEOUT)
        except (OSError, ValueError, TimeoutError) as error:
            raise self._unusable(
                f"cannot be reached: {error or type(error).__name__}; give the address of a Dask "
                "scheduler with workers, as in tcp://10.0.0.1:8786") from None
        for worker, version in sorted(client.run(_version).items()):
            if version != __version__:
                raise self._unusable(f"has a worker {worker} with sandbox {version}, here it is "
                                     f"{__version__}; install the same there")
        self._executor: Any = client.get_executor(pure=False, retries=ATTEMPTS)
        self._placed = client.scatter(job, broadcast=True, hash=False)

    def _unusable(self, why: str) -> SandboxError:
        return SandboxError(f"the cluster {quoted(self._address)} {why}",
                            code="cluster-unreachable")

    def _submit(self, task: Task) -> Future[SweepRow]:
        future: Future[SweepRow] = self._executor.submit(_run_remote, *task, job=self._placed)
        return future

    def _row_of(self, task: Task, future: Future[SweepRow]) -> SweepRow:
        try:
            return future.result()
        except CancelledError:
            raise self._unusable("lost runs; finished runs are saved, and the same command "
                                 "resumes") from None
        except Exception as error:  # whatever ended its workers
            return SweepRow(task[0], "died", reason="workers of the cluster ended in this run: "
                                                  f"{error or type(error).__name__}")


def _version() -> str:
    return __version__


def _run_remote(id: str, values: Point, job: SweepJob) -> SweepRow:
    from sandbox.sweeps.runner import run_point  # loads the engine
    job.bundle.register()
    with job.bundle.unpacked() as scene:
        return run_point(job, scene, id, values)
