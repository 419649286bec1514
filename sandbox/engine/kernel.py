"""How functions of the compiled step are compiled.

They are not kept on disk one by one: each is linked into the two that Python calls
(:mod:`sandbox.engine.advance`), and these are kept, under the fingerprint of all sources. Numba
would take a kept function out again though what it uses from another file had changed.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np
from numba import njit
from numba.extending import register_jitable

if TYPE_CHECKING:
    from numba.core.dispatcher import Dispatcher

ZERO = cast("int", np.int64(0))
"""Where counts begin that are handed on: a literal 0 is a type of its own, for which what takes it
would be compiled once more."""

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Dispatcher[Function]:
    """Compile a function where it is first used; a division by 0 gives inf or nan."""
    return njit(error_model="numpy")(function)


def either(function: Function) -> Function:
    """A function that kernels compile in, and that stays one of Python where Python calls it."""
    return register_jitable(error_model="numpy")(function)


def kept_on_disk(function: Function) -> Dispatcher[Function]:
    """A function that Python calls, compiled and kept on disk wherever that can be.

    Numba keeps it beside the sources, else in the user's cache; an installation that cannot be
    written to, of a user without a home, has neither. It is then compiled for each process, and
    :func:`can_keep` says so.
    """
    compiled = njit(error_model="numpy")(function)
    # numba knows only whether it can when it does
    with contextlib.suppress(RuntimeError):
        compiled.enable_caching()
    return compiled


def can_keep(compiled: Dispatcher[Function]) -> bool:
    """Whether what is compiled of a function is found again by the next process."""
    return compiled.stats.cache_path is not None


def inlined(function: Function) -> Dispatcher[Function]:
    """A kernel that is called in one place, and there written out.

    A kernel is linked with all that it calls, and machine code made of the whole: a level less
    is that much less to compile.
    """
    return njit(error_model="numpy", inline="always")(function)
