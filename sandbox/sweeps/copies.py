"""Where worker processes are copied from: one process that has loaded what they need.

It can begin to load before anybody knows what is to be run, and a second pool finds it loaded.
Windows cannot copy processes; there each worker loads for itself.
"""

from __future__ import annotations

import multiprocessing
import os
from importlib import import_module
from multiprocessing.context import BaseContext

LOADED = "sandbox.sweeps.runner"
"""What is loaded before workers are copied."""
COPIED, EACH = "forkserver", "spawn"
UNGUARDED = 64
"""Exit code of a worker whose script asks for workers while it is only loaded."""


def prepare() -> None:
    """Begin to load what workers are copied from, while there is something else to do.

    A worker first loads the script that it belongs to: what this does when it is loaded it would do
    again in each worker, so such a worker ends.
    """
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        os._exit(UNGUARDED)  # whoever it was copied from takes SystemExit for a failure
    if COPIED in multiprocessing.get_all_start_methods():
        server = import_module("multiprocessing.forkserver")
        server.set_forkserver_preload([LOADED])
        server.ensure_running()


def context() -> BaseContext:
    """How worker processes are begun."""
    prepare()
    return multiprocessing.get_context(
        COPIED if COPIED in multiprocessing.get_all_start_methods() else EACH)
