"""What all tests share."""

from __future__ import annotations

import os
import signal
import tempfile
from pathlib import Path

import pytest
from hypothesis import settings

import sandbox

if not os.access(Path(sandbox.__file__).parent, os.W_OK):
    # compiled code is cached beside the package; where that is read-only, in one place for all
    # workers, so that each does not compile for itself
    os.environ.setdefault("NUMBA_CACHE_DIR", str(Path(tempfile.gettempdir()) / "sandbox-numba"))

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # a shell starts background jobs so, and processes would pass it on: Ctrl-C could not be tested
    signal.signal(signal.SIGINT, signal.default_int_handler)

# fewer examples by day and no time limit; --hypothesis-profile=default overrides it
settings.register_profile("day", max_examples=25, deadline=None)
settings.load_profile("day")


def pytest_report_header() -> str:
    return f"sandbox {sandbox.__version__} in {Path(sandbox.__file__).parent}"


def pytest_sessionstart(session: pytest.Session) -> None:
    """Compile the engine once, before worker processes look for it in the cache."""
    if getattr(session.config.option, "numprocesses", None):
        from tests.support.entry_points import all_entry_points

        with all_entry_points():
            sandbox.Simulation({"bodies": [{"name": "puck", "mass": 1, "inertia": 1}]})
