"""Compilation of all entry points, whatever the scene needs."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from sandbox.engine import entry_points


@contextmanager
def all_entry_points() -> Iterator[None]:
    """Compile all entry points for runs that begin in this context; results are the same."""
    entry_points.everything = True
    try:
        yield
    finally:
        entry_points.everything = False
