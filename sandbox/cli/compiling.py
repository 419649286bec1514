"""One line on stderr when the engine's inner loop is compiled, as in the first run ever."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from sandbox.cli.console import Console

COMPILING = ("compiling the inner loop: once for each installation, and it takes a while "
             "(some ten to thirty seconds)")


@contextmanager
def told_if_compiling(console: Console) -> Iterator[None]:
    """Say so at once if anything is compiled in this context, terminal or not, unless quiet."""
    from sandbox.engine.compiling import on_compiling

    with on_compiling(lambda: console.warn(COMPILING)):
        yield
