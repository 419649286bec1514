"""Kernels: functions that are compiled with Numba as part of their callers.

Everything that a kernel calls is compiled into one of the entry points
(:mod:`sandbox.engine.entry_points`); a kernel has no machine code of its own.
Called from Python, a kernel runs as plain Python.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, update_wrapper
from typing import Any, TypeVar, cast

from numba import njit, types
from numba.extending import models, register_model, typeof_impl

from sandbox.engine.compiling import report_began

Function = TypeVar("Function", bound=Callable[..., Any])


class Kernel:
    """A function that Numba compiles into its callers.

    Compiled, a division by zero gives inf or nan.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self.py_func = function
        self.__qualname__ = function.__qualname__
        update_wrapper(self, function)

    def __call__(self, *args: Any) -> Any:
        """Run the Python function."""
        return self.py_func(*args)

    @cached_property
    def dispatcher(self) -> Any:
        """Numba's dispatcher of the function, made when a caller is compiled."""
        from sandbox.engine.numba_linking import kernel_options

        report_began()
        return njit(error_model="numpy", **kernel_options())(self.py_func)


def kernel(function: Function) -> Function:
    """Compile a function into the kernels and entry points that call it."""
    return cast("Function", Kernel(function))


_unliteral: Any = types.unliteral


class KernelType(types.Dispatcher):
    """The Numba type of a kernel. Literal arguments do not give a specialisation of their own."""

    def get_call_type(self, context: Any, args: Any, kws: Any) -> Any:
        """The signature of a call; a literal 0 counts as any integer."""
        return super().get_call_type(
            context, tuple(_unliteral(one) for one in args),
            {name: _unliteral(value) for name, value in kws.items()})


register_model(KernelType)(models.OpaqueModel)


@typeof_impl.register(Kernel)
def _type_of_kernel(value: Kernel, context: object) -> KernelType:
    return KernelType(value.dispatcher)
