"""How functions of the compiled step are compiled.

They are not kept on disk one by one: each is linked into the two that Python calls
(:mod:`sandbox.engine.advance`), and these are kept, under the fingerprint of all sources. Numba
would take a kept function out again though what it uses from another file had changed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

from numba import njit

if TYPE_CHECKING:
    from numba.core.dispatcher import Dispatcher

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Dispatcher[Function]:
    """Compile a function where it is first used; a division by 0 gives inf or nan."""
    return njit(error_model="numpy")(function)
