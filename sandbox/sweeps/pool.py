"""Worker processes on this machine: started once, each with one run at a time.

Workers are copies of one process that has loaded the engine, where the system can copy processes.
The first of them compiles what the scene needs before the others begin, so that it is
compiled once. A worker that dies is replaced, and its run begun again; a run that two workers died
of is given back as one that did. The standard library's pools cannot tell which run took a worker
with it, and are broken by it as a whole.
"""

from __future__ import annotations

import signal
import time
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess

from sandbox.engine.compiling import on_compiling, report_worker_compilation
from sandbox.errors import SandboxError
from sandbox.sweeps.copies import UNGUARDED, context
from sandbox.sweeps.job import DIED, SweepJob, SweepRow, Task

LIVES = 2
"""Workers that one run may cost."""
PATIENCE = 2.0
"""Seconds that a worker has to end when it is told to."""
BRIEF = 0.2
"""Seconds of a run that is so short that a worker is given the next one ahead, not to wait for it;
with longer ones a worker could sit idle at the end while another has one left."""
READY, COMPILING = "ready", "compiling"


@dataclass(eq=False)
class _Worker:
    process: BaseProcess
    line: Connection
    tasks: deque[Task] = field(default_factory=deque)
    """Its run, and the next one."""
    since: float = 0.0
    """When it was given the first of them, or ended the one before."""
    ready: bool = False
    """Whether it has said that it listens."""


class Pool:
    """Processes that run points of a job, as a context: it ends them.

    Args:
        job: what is run.
        workers: how many.
    """

    def __init__(self, job: SweepJob, workers: int) -> None:
        self._job = job
        self._count = workers
        self._workers: list[_Worker] = []
        self._context = context()
        self._brief = False
        self._stillborn = 0
        """Workers in a row that ended before they were ready."""
        self._again: deque[Task] = deque()
        self._lost: dict[str, int] = {}
        """Workers that a run has cost so far, by its id."""

    def results(self, tasks: Iterable[Task]) -> Iterator[SweepRow]:
        """The rows of all tasks as they are done, in any order.

        Raises:
            SandboxError: workers end before they have begun.
        """
        source = iter(tasks)
        while True:
            self._hand_out(source)
            if not any(worker.tasks for worker in self._workers):
                return
            told = wait([worker.line for worker in self._workers])
            for worker in [each for each in self._workers if each.line in told]:
                yield from self._heard(worker)

    def _hand_out(self, source: Iterator[Task]) -> None:
        """Give each free worker a run, those that were left alone first; brief ones ahead."""
        for most in range(1, 3 if self._brief else 2):
            for worker in self._workers:
                if len(worker.tasks) >= most:
                    continue
                task = self._again.popleft() if self._again else next(source, None)
                if task is None:
                    return
                if not worker.tasks:
                    worker.since = time.monotonic()
                worker.tasks.append(task)
                with suppress(OSError):  # dead: its line says so when it is listened to
                    worker.line.send(task)

    def _heard(self, worker: _Worker) -> Iterator[SweepRow]:
        try:
            said = worker.line.recv()
        except (EOFError, OSError):
            yield from self._buried(worker)
            return
        if isinstance(said, SweepRow):
            worker.tasks.popleft()
            now = time.monotonic()
            self._brief, worker.since = now - worker.since < BRIEF, now
            yield said
        elif said == READY:
            worker.ready, self._stillborn = True, 0
            worker.since = time.monotonic()
            while len(self._workers) < self._count:
                self._begin()
        else:
            report_worker_compilation(None if said == COMPILING else said)

    def _buried(self, worker: _Worker) -> Iterator[SweepRow]:
        self._workers.remove(worker)
        worker.process.join()
        worker.line.close()
        how = _how(worker.process.exitcode)
        if worker.process.exitcode == UNGUARDED:
            raise SandboxError("a worker process loads the script that asks for it, which asks for "
                               "workers again: put what the script does under "
                               "if __name__ == \"__main__\":", code="worker-failed") from None
        if not worker.ready and (worker.process.exitcode or 0) >= 0:  # nobody killed it
            self._stillborn += 1
            if self._stillborn >= LIVES:
                raise SandboxError(
                    f"a worker process ended before it could begin ({how})",
                    code="worker-failed") from None
            self._again.extend(worker.tasks)
        elif worker.tasks:
            yield from self._lost_with(worker, how)
        self._begin()

    def _lost_with(self, worker: _Worker, how: str) -> Iterator[SweepRow]:
        """What becomes of the runs of a worker that died in the first of them."""
        task, *others = worker.tasks
        self._again.extend(others)
        lost = self._lost[task[0]] = self._lost.get(task[0], 0) + 1
        if lost < LIVES:
            self._again.append(task)
        else:
            yield SweepRow(task[0], DIED, reason=f"{LIVES} worker processes ended in this run, the "
                                          f"last one {how}")

    def _begin(self) -> None:
        here, there = self._context.Pipe()
        process = self._context.Process(  # type: ignore[attr-defined]  # of all but the base
            target=_serve, args=(there, self._job), daemon=True)
        process.start()
        there.close()
        self._workers.append(_Worker(process, here))

    def __enter__(self) -> Pool:
        self._begin()
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers:
            worker.line.close()
        for worker in self._workers:
            worker.process.terminate() if worker.tasks or not worker.ready else None
            worker.process.join(PATIENCE)
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()
        self._workers.clear()


def _serve(line: Connection, job: SweepJob) -> None:
    """What a worker does: runs what it is sent, until nobody listens any more."""
    from sandbox.sweeps.runner import ready  # the engine, which whoever asks does not need

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for who started it
    with suppress(EOFError, OSError), ready(job) as run:
        with on_compiling(lambda: line.send(COMPILING), line.send):
            run.prepare()
        line.send(READY)
        while True:
            id, values = line.recv()
            line.send(run(id, values))


def _how(code: int | None) -> str:
    if code is not None and code < 0:
        try:
            return f"by signal {signal.Signals(-code).name}"
        except ValueError:
            return f"by signal {-code}"
    return f"with exit code {code}"
