"""Entry points: functions of the compiled step that are compiled and cached separately.

A kernel is compiled into each of its callers. An entry point is compiled once, by itself, and
called through its address, which stands in the table of a run behind the arrays
(:mod:`sandbox.engine.memory`). Callers know its signature only. This has three advantages:

- Nothing is compiled twice, and what a scene does not use is not compiled at all.
- After an edit, only the entry points that reach the edited code are compiled again.
- Cached code is found by a hash of its sources (:mod:`sandbox.engine.source_hash`), so the cache
  is never out of date, and all versions of a source can be cached at the same time.
"""

from __future__ import annotations

import contextlib
import ctypes
import inspect
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from types import FunctionType
from typing import Any, TypeVar, cast

import numpy as np
from llvmlite import ir
from numba import cfunc, njit, types
from numba.core import typing as numba_typing
from numba.extending import intrinsic

from sandbox.engine.compiling import report_compiled, report_progress
from sandbox.engine.features import FEATURES
from sandbox.engine.memory import TABLE_WORDS
from sandbox.engine.numba_linking import fast_compilation
from sandbox.engine.source_hash import source_hash
from sandbox.engine.state import Constants
from sandbox.numeric import Integers

Function = TypeVar("Function", bound=Callable[..., Any])
_TYPES: dict[str, Any] = {
    "int": types.int64, "float": types.float64, "bool": types.boolean, "None": types.void,
    "Array": types.Array(types.float64, 1, "C"), "Matrix": types.Array(types.float64, 2, "C"),
    "Stack": types.Array(types.float64, 3, "C")}
"""Numba's types of the annotations that entry points may have."""
_CTYPES: dict[Any, Any] = {types.int64: ctypes.c_int64, types.float64: ctypes.c_double,
           types.boolean: ctypes.c_bool, types.void: None}
_numba_typing: Any = numba_typing
_WORD = ir.IntType(64)
_OBSOLETE = 7 * 86400
"""Cached code of other versions of an entry point is deleted after this time [s]."""
_entry_points: dict[str, EntryPoint] = {}
_everything = False
_errors: list[BaseException] = []
"""Exceptions raised while a late entry point was compiled: none can leave compiled code."""


class EntryPoint:
    """A function that is compiled separately and called by its address.

    Args:
        function: the first argument is the address of a run's table; all arguments are annotated
            with one of ``int``, ``float``, ``bool``, ``Array``, ``Matrix`` and ``Stack``.
        feature: only compiled for scenes that have this feature; empty for all.
        default: result in scenes without the feature.
        late: compiled when it is first called, in the middle of a step.
    """

    def __init__(
        self, function: Callable[..., Any], feature: str, default: int, late: bool,
    ) -> None:
        self.py_func, self.name, self.feature = function, function.__name__, feature
        self.default, self.late = default, late
        self.signature = _signature(function)
        if self.name in _entry_points:
            raise ValueError(f"there are two entry points named {self.name}")
        _entry_points[self.name] = self

    @property
    def place(self) -> int:
        """Where in the table its address stands."""
        return TABLE_WORDS + sorted(_entry_points).index(self.name)

    @property
    def source_key(self) -> str:
        """What compiled code of a caller depends on."""
        return f"{self.name} {self.place} {self.signature} {self.default}"

    @cached_property
    def call(self) -> Any:
        """An intrinsic that calls the function at the address in the table, if there is one."""
        def typing(context: Any, *args: Any) -> Any:
            return self.signature, self._generate

        own = inspect.signature(self.py_func)
        context = inspect.Parameter("context", inspect.Parameter.POSITIONAL_OR_KEYWORD)
        typing.__signature__ = own.replace(  # type: ignore[attr-defined]
            parameters=[context, *own.parameters.values()])
        call: Any = intrinsic(typing)
        call.entry_point = self
        return call

    def _generate(self, context: Any, builder: Any, signature: Any, args: Any) -> Any:
        table = builder.inttoptr(args[0], _WORD.as_pointer())
        address = builder.load(builder.gep(table, [_WORD(self.place)]))
        result = context.get_value_type(signature.return_type)
        kind = ir.FunctionType(result, [context.get_value_type(one) for one in signature.args])
        absent = builder.basic_block
        with builder.if_then(builder.icmp_unsigned("!=", address, _WORD(0))):
            value = builder.call(builder.inttoptr(address, kind.as_pointer()), args)
            present = builder.basic_block
        if signature.return_type == types.void:
            return context.get_dummy_value()
        either = builder.phi(result)
        either.add_incoming(ir.Constant(result, self.default), absent)
        either.add_incoming(value, present)
        return either

    @cached_property
    def compiled(self) -> Any:
        """Numba's C callback, compiled now or loaded from the cache."""
        copy = cacheable(self.py_func)
        try:
            made = cfunc(self.signature, error_model="numpy", cache=True)(copy)
        except RuntimeError:  # neither the installation nor the user's cache can be written to
            return cfunc(self.signature, error_model="numpy")(copy)
        if not made.cache_hits:
            _remove_obsolete(made, copy.__qualname__)
        return made

    def address(self) -> int:
        """The address of the compiled function, or of a function that compiles it first."""
        if self.late and "compiled" not in self.__dict__:
            return int(ctypes.cast(self._first_call, ctypes.c_void_p).value or 0)
        return int(self.compiled.address)

    @cached_property
    def _first_call(self) -> Any:
        """Compile the function, put its address into the table of the caller, and call it."""
        kind = ctypes.CFUNCTYPE(_CTYPES[self.signature.return_type],
                                *(_CTYPES[one] for one in self.signature.args))

        def first_call(table: int, *args: Any) -> Any:
            try:
                began = time.perf_counter()
                with fast_compilation():
                    address = self.compiled.address
                report_compiled(time.perf_counter() - began)
                ctypes.c_int64.from_address(table + 8 * self.place).value = address
                return kind(address)(table, *args)
            except BaseException as error:  # Ctrl-C among them
                _errors.append(error)
                return self.default

        return kind(first_call)


class CalledFromPython:
    """A function that Python calls, compiled and cached in the same way.

    Args:
        function: with arguments annotated like those of an entry point.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self.py_func = function
        self.signature = _signature(function)

    def __call__(self, *args: Any) -> Any:
        """Call the compiled function."""
        result = self.compiled(*args)
        if _errors:
            error = _errors[0]
            _errors.clear()
            raise error
        return result

    @cached_property
    def compiled(self) -> Any:
        """The compiled function."""
        self._dispatcher.compile(self.signature.args)
        return self._dispatcher

    @property
    def cached(self) -> bool:
        """Whether the next process will find the compiled code."""
        return self._dispatcher.stats.cache_path is not None

    @cached_property
    def _dispatcher(self) -> Any:
        made = njit(error_model="numpy")(cacheable(self.py_func))
        with contextlib.suppress(RuntimeError):  # Numba knows only now whether it can cache
            made.enable_caching()
        return made


def entry_point(
    feature: str = "", *, default: int = 0, late: bool = False,
) -> Callable[[Function], Function]:
    """Compile and cache a function by itself; the arguments are those of :class:`EntryPoint`."""
    def decorated(function: Function) -> Function:
        return cast("Function", EntryPoint(function, feature, default, late).call)

    return decorated


@contextmanager
def all_entry_points() -> Iterator[None]:
    """Compile all entry points for runs that begin in this context, whatever their scenes have.

    Results are the same; tests compare them.
    """
    global _everything
    _everything = True
    try:
        yield
    finally:
        _everything = False


def prepare(constants: Constants, main: CalledFromPython) -> Integers:
    """Compile or load the entry points for a run; their addresses, for the end of its table.

    Args:
        constants: of the run.
        main: the function that Python calls.
    """
    wanted = [one for one in _entry_points.values()
              if _everything or not one.feature or FEATURES[one.feature](constants)]
    addresses = np.zeros(len(_entry_points), dtype=np.int64)
    first = TABLE_WORDS
    began = time.perf_counter()
    with fast_compilation():
        for done, one in enumerate(wanted, 1):
            addresses[one.place - first] = one.address()
            report_progress(done / len(wanted))
        main.compiled  # noqa: B018
    report_compiled(time.perf_counter() - began)
    return addresses


def _signature(function: Callable[..., Any]) -> Any:
    notes = {name: _TYPES[note] for name, note in function.__annotations__.items()}
    return _numba_typing.signature(notes.pop("return"), *notes.values())


def cacheable(function: Callable[..., Any]) -> Any:
    """A copy of a function whose name and file make Numba's cache a reliable one.

    The name ends with a hash of all sources. The file is this one: Numba discards cached code
    when the file of the function has changed, which says nothing of the function.
    """
    copy = FunctionType(
        function.__code__.replace(co_filename=__file__, co_firstlineno=1), function.__globals__,
        function.__name__, function.__defaults__, function.__closure__)
    copy.__qualname__ = f"{function.__name__}_{source_hash(function)}"
    copy.__module__, copy.__annotations__ = function.__module__, function.__annotations__
    return copy


def _remove_obsolete(made: Any, name: str) -> None:
    """Delete old cached code of other versions of the function just compiled."""
    folder = getattr(getattr(made, "_cache", None), "cache_path", None)  # private in Numba
    if folder is None:
        return
    stem, _, _ = name.rpartition("_")
    for path in Path(folder).glob(f"entry_points.{stem}_{'[0-9a-f]' * 16}-*.nb[ic]"):
        with contextlib.suppress(OSError):
            if name not in path.name and time.time() - path.stat().st_mtime > _OBSOLETE:
                path.unlink()
