"""How functions of the compiled step are compiled.

They are not kept on disk one by one: each is linked into the two that Python calls
(:mod:`sandbox.engine.advance`), and these are kept, under the fingerprint of all sources. Numba
would take a kept function out again though what it uses from another file had changed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numba.core.dispatcher import Dispatcher

ZERO = cast("int", np.int64(0))
"""Where counts begin that are handed on: a literal 0 is a type of its own, for which what takes it
would be compiled once more."""

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Dispatcher[Function]:
    """Compile a function where it is first used; a division by 0 gives inf or nan."""
    return njit(error_model="numpy")(function)


def inlined(function: Function) -> Dispatcher[Function]:
    """A kernel that is called in one place, and there written out.

    A kernel is linked with all that it calls, and machine code made of the whole: a level less
    is that much less to compile.
    """
    return njit(error_model="numpy", inline="always")(function)
