"""The same runs on a Dask cluster, wherever its scheduler is.

Runs go out in batches of about a second's work, since a scheduler handles some thousand tasks a
second at best; as many batches are out at a time as keep all workers busy, so that a million runs
take no more memory than a thousand. Workers that die have their batches repeated elsewhere by
Dask; of a batch that so many died of as its scheduler allows (three, if it is not told otherwise:
``distributed.scheduler.allowed-failures``), each run is tried alone.
"""

from __future__ import annotations

import itertools
import json
import socket
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import TracebackType
from typing import Any, Self
from urllib.parse import urlsplit

from sandbox import __version__
from sandbox.errors import SandboxError
from sandbox.sweeps.job import DIED, SweepJob, SweepRow, Task
from sandbox.wording import quoted

PATIENCE = 20.0
"""Seconds that a scheduler has to answer, and then its first worker to be there."""
LISTENING = 4.0
"""Seconds in which somebody has to be found at its address at all."""
PLAIN, PORT = ("tcp", "tls"), 8786
"""Kinds of addresses that are a host and a port; the port that Dask takes if none is said."""
BATCH = 1.0
"""Seconds of work in a batch, about."""
MOST_IN_BATCH = 500
AHEAD = 3
"""Batches for each worker that are out at a time."""
TRIES = 3
"""How often a batch is sent that the cluster loses."""
Batch = tuple[Task, ...]


@dataclass(frozen=True)
class _Sent:
    """A batch that is out."""

    batch: Batch
    placing: int
    """With which placing of the job."""
    tries: int


class Cluster:
    """A Dask cluster as workers, as a context.

    Args:
        job: what is run.
        address: of the scheduler: ``tcp://10.0.0.1:8786``, or the path of its scheduler file.

    Raises:
        SandboxError: ``distributed`` is not installed, the scheduler does not answer, it has no
            workers, or these have another version.
    """

    def __init__(self, job: SweepJob, address: str) -> None:
        self._job, self._address = job, address
        self._client: Any = None
        self._placed: Any = None
        """The job, in the memory of the workers."""
        self._placings = 0

    def __enter__(self) -> Self:
        try:
            _answers(self._address)
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise self._unreached(error) from None
        try:
            distributed: Any = import_module("distributed")
        except ImportError:
            raise SandboxError("a cluster needs Dask: pip install "
                               "'sandbox-mechanics[cluster]'", code="missing-package") from None
        where = {"scheduler_file": self._address} if self._address.endswith(".json") else \
            {"address": self._address}
        try:
            self._client = distributed.Client(**where, timeout=PATIENCE, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            raise self._unreached(error) from None
        self._same_version()
        self._place()
        return self

    def _unreached(self, error: Exception) -> SandboxError:
        return SandboxError(f"the cluster {quoted(self._address)} cannot be reached: "
                            f"{error or type(error).__name__}; give the address of a Dask "
                            "scheduler, as in tcp://10.0.0.1:8786", code="cluster-unreachable")

    def _place(self) -> None:
        """Put the job into the memory of the workers.

        Under a key of its own: under that of its contents it would go when another program, one
        that was killed, say, lets go of the same.
        """
        self._placed = self._client.scatter(self._job, broadcast=True, hash=False)
        self._placings += 1

    def _same_version(self) -> None:
        """See that there are workers, and that each runs what is run here.

        Raises:
            SandboxError: none, or another version.
        """
        try:
            self._client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError:
            raise SandboxError(f"the cluster {quoted(self._address)} has no workers",
                               code="cluster-unreachable") from None
        found: dict[str, str] = self._client.run(_version)
        for worker, version in sorted(found.items()):
            if version != __version__:
                raise SandboxError(f"worker {worker} of the cluster has sandbox {version or 'not'},"
                                   f" here it is {__version__}; install the same there",
                                   code="cluster-unreachable")

    def results(self, tasks: Iterable[Task]) -> Iterator[SweepRow]:
        """The rows of all tasks as they are done, in any order."""
        source, size = iter(tasks), 1
        out: Any = import_module("distributed").as_completed(loop=self._client.loop)
        sent: dict[str, _Sent] = {}
        while True:
            for batch in self._next(source, size, len(sent)):
                self._send(batch, sent, out)
            if not sent:
                return
            future = next(out)
            done = sent.pop(future.key)
            if future.status == "finished":
                rows, seconds = future.result()
                size = _size(len(rows), seconds)
                yield from rows
            elif future.status != "error":
                self._send_again(done, sent, out)
            elif len(done.batch) > 1:  # one of them is to blame
                for task in done.batch:
                    self._send((task,), sent, out)
            else:
                yield SweepRow(done.batch[0][0], DIED, reason=_why(future))

    def _send(self, batch: Batch, sent: dict[str, _Sent], out: Any, tries: int = 1) -> None:
        future = self._client.submit(_run, self._placed, batch, pure=False)
        sent[future.key] = _Sent(batch, self._placings, tries)
        out.add(future)

    def _send_again(self, lost: _Sent, sent: dict[str, _Sent], out: Any) -> None:
        """A batch that the cluster lost, through no fault of its runs: with the job, for example.

        Raises:
            SandboxError: it was lost too often.
        """
        if lost.tries >= TRIES:
            raise SandboxError(f"the cluster {quoted(self._address)} lost the same runs {TRIES} "
                               "times; what is done is kept, and the same command goes on",
                               code="cluster-unreachable")
        if lost.placing == self._placings:
            self._place()
        self._send(lost.batch, sent, out, lost.tries + 1)

    def _next(self, source: Iterator[Task], size: int, out: int) -> Iterator[Batch]:
        """As many batches as are to be out."""
        threads = sum(self._client.nthreads().values())
        for _ in range(AHEAD * threads - out):
            batch = tuple(itertools.islice(source, size))
            if not batch:
                return
            yield batch

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._client is not None:
            self._client.close()


def _answers(address: str) -> None:
    """See that somebody listens at an address: Dask itself would try for much longer.

    Raises:
        OSError: nobody does, or there is no such scheduler file.
        ValueError, KeyError, TypeError: what stands there is no address.
    """
    if address.endswith(".json"):
        address = json.loads(Path(address).read_text(encoding="utf-8"))["address"]
    where = urlsplit(address if "://" in address else f"tcp://{address}")
    if where.scheme in PLAIN:
        socket.create_connection((where.hostname or "", where.port or PORT), LISTENING).close()


def _run(job: SweepJob, tasks: Batch) -> tuple[list[SweepRow], float]:
    """What a worker does with a batch: rows, and how long they took [s]."""
    from sandbox.sweeps.runner import ready  # the engine, which whoever asks does not need

    began = time.perf_counter()
    with ready(job) as run:
        return [run(id, values) for id, values in tasks], time.perf_counter() - began


def _version() -> str:
    try:
        import sandbox
    except ImportError:
        return ""
    return sandbox.__version__


def _size(runs: int, seconds: float) -> int:
    """Runs of a batch that takes about :data:`BATCH`."""
    return int(min(max(BATCH * runs / max(seconds, 1e-9), 1), MOST_IN_BATCH))


def _why(future: Any) -> str:
    error = future.exception()
    return f"workers of the cluster ended in this run: {error or type(error).__name__}"
