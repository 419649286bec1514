"""Number and start of worker processes, without heavy imports, so that they load at once."""

from __future__ import annotations

import multiprocessing
import os
from importlib import import_module
from multiprocessing.context import BaseContext

from sandbox.engine.compiling import processors
from sandbox.errors import SandboxError

MAX_PER_PROCESSOR = 4  # worker processes for each processor; each needs some 200 MB


def check_workers(workers: int | str) -> int | str:
    """Number of worker processes, 0 replaced by one for each processor; or an address."""
    if isinstance(workers, str):
        return workers
    maximum = MAX_PER_PROCESSOR * processors()
    if not 0 <= workers <= maximum:
        raise SandboxError(f"cannot start {workers} worker processes (allowed: 1 to {maximum}, "
                           f"{MAX_PER_PROCESSOR} for each processor)", code="bad-option")
    return workers or processors()


def preload() -> BaseContext:
    """Start to load the engine for worker processes in the background; their context.

    Workers are copies of one process that has loaded the engine, where the system can copy
    processes. A worker first loads the script that it belongs to; if this script starts workers
    without ``if __name__ == "__main__":``, the worker ends here.
    """
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        os._exit(1)
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    server = import_module("multiprocessing.forkserver")
    server.set_forkserver_preload(["sandbox.sweeps.runner"])  # it loads the engine
    server.ensure_running()
    return multiprocessing.get_context("forkserver")
