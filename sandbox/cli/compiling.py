"""One line on stderr when the engine's inner loop is compiled, as in the first run ever."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from sandbox.cli.console import Console

COMPILING = ("compiling the inner loop: once for each installation, and it takes a while "
             "(40 to 80 s of one processor)")

NOT_KEPT = ("compiling the inner loop (40 to 80 s of one processor), as each run has to: neither "
            "the installation nor a cache of the user's can be written to; NUMBA_CACHE_DIR can "
            "name a directory that can")


@contextmanager
def told_if_compiling(console: Console) -> Iterator[None]:
    """Say so at once if anything is compiled in this context, terminal or not, unless quiet."""
    from sandbox.engine.compiling import on_compiling

    def tell() -> None:
        from sandbox.engine.advance import advance
        from sandbox.engine.kernel import can_keep

        console.warn(COMPILING if can_keep(advance) else NOT_KEPT)

    with on_compiling(tell):
        yield
