"""Entry points: functions of the compiled step that are compiled and cached separately.

A kernel is compiled into each of its callers. An entry point is compiled once, by itself, if the
scene uses it, and called through its address in the table of a run (:mod:`sandbox.engine.memory`).
Cached code is found by a hash of its sources (:mod:`sandbox.engine.source_hash`): the cache is
never out of date, and an edit recompiles only the entry points that reach it.
"""

from __future__ import annotations

import contextlib
import inspect
import multiprocessing
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np
from llvmlite import ir
from numba import cfunc, config, njit, types
from numba.core.caching import FunctionCache
from numba.extending import intrinsic

from sandbox.engine.compiling import processors, report_compiled, report_progress
from sandbox.engine.kernel import entry_point_compiler, fast_compilation, kernel
from sandbox.engine.memory import TABLE_WORDS
from sandbox.engine.records import GEAR, RACK, ROLL
from sandbox.engine.source_hash import cacheable, cached
from sandbox.engine.state import Constants, Elements
from sandbox.numeric import Integers

Function = TypeVar("Function", bound=Callable[..., Any])
_TYPES: dict[str, Any] = {
    "int": types.int64, "float": types.float64, "bool": types.boolean, "None": types.void,
    "Array": types.Array(types.float64, 1, "C"), "Matrix": types.Array(types.float64, 2, "C"),
    "Stack": types.Array(types.float64, 3, "C")}
"""Numba's types of the annotations that entry points may have."""
_numba_config: Any = config
_function_cache: Any = FunctionCache
_options: dict[str, Any] = {"error_model": "numpy", "pipeline_class": entry_point_compiler}
_WORD = ir.IntType(64)
_PROCESSES, _SHARE = 4, 5  # maximum number of processes; minimum of entry points of each
_entry_points: dict[str, EntryPoint] = {}
everything = False  # whether all entry points are compiled: results are the same


class EntryPoint:
    """A compiled function that is called by its address, if the scene has its ``feature``."""

    def __init__(self, function: Callable[..., Any], feature: str, default: int) -> None:
        self.py_func, self.name, self.feature = function, function.__name__, feature
        self.default, self.signature = default, _signature(function)
        _entry_points[self.name] = self

    @property
    def place(self) -> int:
        """Index of its address in the table."""
        return TABLE_WORDS + sorted(_entry_points).index(self.name)

    @property
    def source_key(self) -> str:
        """What compiled code of a caller depends on."""
        return f"{self.name} {self.place} {self.signature} {self.default}"

    @cached_property
    def source(self) -> Any:
        """The function under a name that ends with the hash of its sources."""
        return cacheable(self.py_func)

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
        return cached(self.py_func, self.source, lambda function, cache: cfunc(
            self.signature, cache=cache, **_options)(function))


class CalledFromPython:
    """A function that Python calls, compiled and cached in the same way."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.py_func = function

    def __call__(self, *args: Any) -> Any:
        """Call the compiled function."""
        return self.compiled(*args)

    @cached_property
    def compiled(self) -> Any:
        """The compiled function."""
        self._dispatcher.compile(_signature(self.py_func).args)
        return self._dispatcher

    @property
    def cached(self) -> bool:
        """Whether the next process will find the compiled code."""
        return self._dispatcher.stats.cache_path is not None

    @cached_property
    def _dispatcher(self) -> Any:
        return cached(self.py_func, cacheable(self.py_func), lambda function, cache: njit(
            cache=cache, **_options)(function))


def entry_point(feature: str = "", *, default: int = 0) -> Callable[[Function], Function]:
    """Make a function an :class:`EntryPoint`; with ``NUMBA_BOUNDSCHECK=1`` a kernel."""
    def decorated(function: Function) -> Function:
        if _numba_config.BOUNDSCHECK:
            return kernel(function)
        return cast("Function", EntryPoint(function, feature, default).call)

    return decorated


def prepare(constants: Constants, elements: Elements, main: CalledFromPython) -> Integers:
    """Compile or load the entry points of a run and ``main``; addresses for its table."""
    wanted = [one for one in _entry_points.values()
              if everything or not one.feature or FEATURES[one.feature](constants, elements)]
    addresses = np.zeros(len(_entry_points), dtype=np.int64)
    began = time.perf_counter()
    with fast_compilation(), _other_processes(wanted) as (others, own):
        main.compiled  # noqa: B018
        for done, one in enumerate(own, 1):
            one.compiled  # noqa: B018
            report_progress(done / len(wanted))
        while any(other.poll() is None for other in others) and (missing := _missing(wanted)):
            report_progress(1.0 - len(missing) / len(wanted))
            time.sleep(0.2)
        for one in wanted:
            addresses[one.place - TABLE_WORDS] = one.compiled.address
    report_compiled(time.perf_counter() - began)
    return addresses


@contextmanager
def _other_processes(
    wanted: list[EntryPoint],
) -> Iterator[tuple[list[subprocess.Popen[bytes]], list[EntryPoint]]]:
    """Processes that compile parts of what is not in the cache, and the part left to this one."""
    missing = _missing(wanted)
    count = min(_PROCESSES, processors(), len(missing) // _SHARE)
    if (count < 2 or multiprocessing.parent_process() is not None
            or not Path(sys.executable).name.startswith("python")):
        yield [], wanted
        return
    program = ("import sys; from sandbox.engine import simulate, entry_points; "
               "entry_points.compile_named(sys.argv[1:])")
    path = os.pathsep.join(part or str(Path.cwd()) for part in sys.path)
    # PYTHONSAFEPATH: modules in the working directory must not replace those of the path
    environment = {**os.environ, "PYTHONPATH": path, "PYTHONSAFEPATH": "1"}
    quiet: dict[str, Any] = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
    others: list[subprocess.Popen[bytes]] = []
    try:
        with contextlib.suppress(OSError):  # no further process is allowed: this one does its part
            for i in range(1, count):
                others.append(subprocess.Popen(
                    [sys.executable, "-c", program, *(one.name for one in missing[i::count])],
                    env=environment, **quiet))
        yield others, missing[::count]
    finally:
        for other in others:
            other.kill()
            other.wait()


def compile_named(names: list[str]) -> None:
    """Compile entry points into the cache."""
    with fast_compilation():
        for name in names:
            _entry_points[name].compiled  # noqa: B018


def _missing(wanted: list[EntryPoint]) -> list[EntryPoint]:
    """The entry points that are neither loaded nor in the cache; none if there is no cache."""
    wanted = [one for one in wanted if "compiled" not in vars(one)]
    if not wanted:
        return []
    try:
        folder = Path(_function_cache(wanted[0].source).cache_path)
    except (RuntimeError, OSError):  # no place for a cache
        return []
    found = {path.name.split(".")[1].rpartition("-")[0] for path in folder.glob("*.nbc")}
    return [one for one in wanted if one.source.__qualname__ not in found]


def _signature(function: Callable[..., Any]) -> Any:
    notes = {name: _TYPES[note] for name, note in function.__annotations__.items()}
    return notes.pop("return")(*notes.values())


FEATURES: dict[str, Callable[[Constants, Elements], bool]] = {
    "actions": lambda c, e: len(e.actions) > 0,
    "bounces": lambda c, e: bool((c.restitution > 0.0).any()),
    "bounded": lambda c, e: any(map(
        len, (e.limits, e.motors, e.slips, e.dry_friction, c.shapes))),
    "cables": lambda c, e: len(e.cables) > 0,
    "curves": lambda c, e: bool((c.shapes["span"] >= 0).any()),
    "fluids": lambda c, e: bool(len(e.fluids) or len(e.valves) or len(e.pumps)),
    "piles": lambda c, e: bool((c.loose >= 0).any()),
    "laws": lambda c, e: len(c.steps) > 0,
    "loads": lambda c, e: bool(len(e.loads) or len(e.loaded)),
    "motors": lambda c, e: len(e.motors) > 0,
    "joint_friction": lambda c, e: len(e.dry_friction) > 0,
    "paths": lambda c, e: bool((e.joints["span"] >= 0).any()),
    "shapes": lambda c, e: len(c.shapes) > 0,
    "skin": lambda c, e: bool((c.skin > 0.0).any()),
    "slips": lambda c, e: bool(len(e.slips) or (e.cables["spans"] < e.cables["spans_end"]).any()),
    "springs": lambda c, e: len(e.springs) > 0,
    "static": lambda c, e: bool((c.static > 1.0).any() or (e.dry_friction["static"] > 1.0).any()),
    "teeth": lambda c, e: bool(np.isin(e.joints["keeps"], (GEAR, RACK, ROLL)).any()),
    "bonds": lambda c, e: len(e.bonds) > 0,
}
