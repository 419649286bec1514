"""Cache keys: a hash of all sources of a compiled function.

Numba looks for changes only in the file of the function itself. The hash covers the functions,
constants and record types that it uses, too.
"""

from __future__ import annotations

import hashlib
import platform
import types
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import numba
import numpy as np
from llvmlite import binding
from numba.core.errors import NumbaError

from sandbox.engine.kernel import Kernel

Source = Callable[..., Any]
_MACHINERY = ("kernel.py", "source_hash.py", "entry_points.py", "memory.py", "native.py")
_OPTIONS = "CPU_NAME", "CPU_FEATURES", "OPT", "BOUNDSCHECK"


def source_hash(function: Source) -> str:
    """Sixteen digits that change with the code, constants and types that a function reaches."""
    reached: dict[str, Source] = {}
    texts: list[str] = []
    waiting = [function]
    while waiting:
        one = waiting.pop()
        name = f"{one.__module__}.{one.__qualname__}"
        if name in reached:
            if reached[name] is not one:
                raise TypeError(f"{function.__qualname__} uses two functions named {name}")
            continue
        reached[name] = one
        text, calls = _describe(one)
        texts.append(text)
        waiting += calls
    first, *others = texts
    return hashlib.sha256(repr((_base(), first, sorted(others))).encode()).hexdigest()[:16]


def cacheable(function: Callable[..., Any]) -> Any:
    """A copy whose name ends with the hash of its sources, in a file that does not change."""
    copy = types.FunctionType(
        function.__code__.replace(co_filename=__file__, co_firstlineno=1), function.__globals__,
        function.__name__, function.__defaults__, function.__closure__)
    copy.__qualname__ = f"{function.__name__}_{source_hash(function)}"
    copy.__module__, copy.__annotations__ = function.__module__, function.__annotations__
    return copy


def cached(function: Source, source: Any, compiled: Callable[[Source, bool], Any]) -> Any:
    """Compile with a cache, found by the name of ``source``, if one can be written to."""
    try:
        return compiled(source, True)
    except NumbaError:
        compiled(function, False)  # raises the error with the place in the source
        raise
    except (RuntimeError, OSError):  # no place for a cache; no room left
        return compiled(source, False)


@cache
def _base() -> tuple[object, ...]:
    files = b"".join(Path(__file__).with_name(name).read_bytes() for name in _MACHINERY)
    return (platform.python_version(), numba.__version__, llvmlite.__version__, np.__version__,
            binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten(),
            *(getattr(numba.config, name) for name in _OPTIONS), hashlib.sha256(files).hexdigest())


@cache
def _describe(function: Source) -> tuple[str, list[Source]]:
    calls: list[Source] = []
    scope, values = function.__globals__, dict[str, Any]()
    closed = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    values.update((name, cell.cell_contents) for name, cell in closed)
    parts: list[object] = [function.__module__, function.__qualname__, function.__defaults__,
                           function.__kwdefaults__]
    codes = [function.__code__]
    for code in codes:  # nested ones are added
        nested = [each for each in code.co_consts if isinstance(each, types.CodeType)]
        codes += nested
        parts += [code.co_code, code.co_names, code.co_varnames, code.co_argcount,
                  code.co_kwonlyargcount, code.co_flags,
                  *(None if each in nested or each == function.__doc__ else each
                    for each in code.co_consts)]
        for name in code.co_names:
            value = scope.get(name)
            if not isinstance(value, types.ModuleType):
                values |= {name: value} if name in scope else {}
            elif value.__name__ not in ("math", "numpy"):  # their versions are in the base
                values.update((f"{name}.{each}", attribute) for each in code.co_names
                              if not isinstance(attribute := getattr(value, each, value),
                                                types.ModuleType))
    found = [f"{name}={_value(value, calls)}" for name, value in sorted(values.items())]
    return "\n".join([*map(repr, parts), *found]), calls


def _value(value: Any, calls: list[Source]) -> str:
    if entry_point := getattr(value, "entry_point", None):
        return str(entry_point.source_key)
    if view := getattr(value, "view_of_table", None):
        return str(view)
    if isinstance(value, Kernel | types.FunctionType):
        if not value.__module__.startswith("numba."):
            calls.append(getattr(value, "py_func", value))
        return f"{value.__module__}.{value.__qualname__}"
    if isinstance(value, int | float | str | np.generic | tuple | type(None)):
        return f"{type(value).__name__} {value!r}"
    if isinstance(value, np.dtype):
        return repr(value)
    if type(value).__name__ == "_Intrinsic":  # of native.py, which is part of the base
        return f"{value._defn.__module__}.{value._name}"
    raise TypeError(f"compiled functions cannot use {value!r} of type {type(value).__name__}; "
                    "use numbers, strings, tuples, dtypes and kernels")
