"""Worker processes on this machine: started once, each with one run at a time.

A worker that dies is replaced, and its run begun again; a run that two workers died of is given
back as one that did. The standard library's pools cannot tell which run took a worker with it,
and are broken by it as a whole.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any

from sandbox.errors import SandboxError
from sandbox.sweeps.job import DIED, SweepJob, SweepRow, ready
from sandbox.sweeps.points import Override

LIVES = 2
"""Workers that one run may cost."""
PATIENCE = 2.0
"""Seconds that a worker has to end when it is told to."""
WARM: dict[str, Any] = {
    "name": "warm", "run": {"duration": 1e-3}, "gravity": [0, 0],
    "bodies": [{"name": "puck", "mass": 1, "inertia": 1}]}
"""A scene that loads the inner loop, or compiles it."""
Task = tuple[str, Mapping[str, Override]]
"""The id of a run, and what its paths are set to."""


@dataclass(eq=False)
class _Worker:
    process: BaseProcess
    line: Connection
    task: Task | None = None
    ready: bool = False
    """Whether it has said that it listens."""


class Pool:
    """Processes that run points of a job, as a context: it ends them.

    Args:
        job: what is run.
        workers: how many; as many as this process may use processors by default.
    """

    def __init__(self, job: SweepJob, workers: int = 0) -> None:
        self._job = job
        self._count = workers or processors()
        self._workers: list[_Worker] = []
        self._context = multiprocessing.get_context("spawn")

    def results(self, tasks: Iterable[Task]) -> Iterator[SweepRow]:
        """The rows of all tasks as they are done, in any order.

        Raises:
            SandboxError: workers end before they have begun.
        """
        source = iter(tasks)
        again: deque[Task] = deque()
        lost: dict[str, int] = {}
        while True:
            self._hand_out(source, again)
            if not any(worker.task for worker in self._workers):
                return
            told = wait([worker.line for worker in self._workers])
            for worker in [each for each in self._workers if each.line in told]:
                yield from self._heard(worker, again, lost)

    def _hand_out(self, source: Iterator[Task], again: deque[Task]) -> None:
        """Give each free worker a run, those that were left alone first."""
        for worker in [each for each in self._workers if not each.task]:
            task = again.popleft() if again else next(source, None)
            if task is None:
                return
            worker.task = task
            with suppress(OSError):  # dead: its line says so when it is listened to
                worker.line.send(task)

    def _heard(
        self, worker: _Worker, again: deque[Task], lost: dict[str, int],
    ) -> Iterator[SweepRow]:
        try:
            said = worker.line.recv()
        except (EOFError, OSError):
            yield from self._buried(worker, again, lost)
            return
        if isinstance(said, SweepRow):
            worker.task = None
            yield said
        else:
            worker.ready = True

    def _buried(
        self, worker: _Worker, again: deque[Task], lost: dict[str, int],
    ) -> Iterator[SweepRow]:
        self._workers.remove(worker)
        worker.process.join()
        worker.line.close()
        how = _how(worker.process.exitcode)
        if not worker.ready and (worker.process.exitcode or 0) >= 0:  # nobody killed it
            raise SandboxError(f"a worker process ended before it could begin ({how})")
        self._begin()
        if worker.task is None:
            return
        id = worker.task[0]
        lost[id] = lost.get(id, 0) + 1
        if lost[id] < LIVES:
            again.append(worker.task)
        else:
            yield SweepRow(id, DIED, reason=f"{LIVES} worker processes ended in this run, the last "
                                       f"one {how}")

    def _begin(self) -> None:
        here, there = self._context.Pipe()
        process = self._context.Process(target=_serve, args=(there, self._job), daemon=True)
        process.start()
        there.close()
        self._workers.append(_Worker(process, here))

    def __enter__(self) -> Pool:
        from sandbox.engine.simulate import simulate

        for _ in range(self._count):
            self._begin()
        try:
            simulate(WARM)  # while they load: what has to be compiled is compiled once
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers:
            worker.line.close()
        for worker in self._workers:
            worker.process.terminate() if worker.task else None
            worker.process.join(PATIENCE)
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()
        self._workers.clear()


def _serve(line: Connection, job: SweepJob) -> None:
    """What a worker does: runs what it is sent, until nobody listens any more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for who started it
    with suppress(EOFError, OSError), ready(job) as run:
        line.send("ready")
        while True:
            id, values = line.recv()
            line.send(run(id, values))


def processors() -> int:
    """How many this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on every system
        return os.cpu_count() or 1


def _how(code: int | None) -> str:
    if code is not None and code < 0:
        try:
            return f"by signal {signal.Signals(-code).name}"
        except ValueError:
            return f"by signal {-code}"
    return f"with exit code {code}"
