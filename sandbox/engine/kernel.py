"""Kernels: functions that are compiled with Numba as part of their callers.

Everything that a kernel calls is compiled into one of the entry points
(:mod:`sandbox.engine.entry_points`); a kernel has no machine code of its own.
Called from Python, a kernel runs as plain Python.

The first run is about three times as fast because kernels are only linked into their callers,
references are not counted, unneeded compiler passes are left out, the types of operators are
remembered, and garbage collection is off meanwhile. Steps are about a sixth faster because negative
indices do not count from the end of an array; no kernel may use one. This takes private parts of
Numba. If a small function does not compile with them, only documented interfaces are used.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import cache, cached_property, update_wrapper
from importlib import import_module
from typing import Any, TypeVar, cast

from numba import cfunc, njit, types
from numba.extending import models, register_model, typeof_impl

from sandbox.engine.compiling import report_began

Function = TypeVar("Function", bound=Callable[..., Any])
_UNUSED_PASSES = {
    "WithLifting", "InlineClosureLikes", "RewriteSemanticConstants", "DeadBranchPrune",
    "RewriteDynamicRaises", "MakeFunctionToJitFunction", "InlineInlinables", "FindLiterallyCalls",
    "LiteralUnroll", "ReconstructSSA", "LiteralPropagationSubPipelinePass", "PreLowerStripPhis",
    "InlineOverloads", "NopythonRewrites", "NoPythonSupportedFeatureValidation", "IRLegalization",
    "DumpParforDiagnostics"}  # passes of Numba's compiler that are left out


class Kernel:
    """A function that Numba compiles into its callers; x / 0 gives inf or nan."""

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


_contexts: list[ExitStack] = []  # open ones of fast_compilation


@contextmanager
def fast_compilation() -> Iterator[None]:
    """Compile faster within this context. It costs nothing if nothing is compiled."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        with ExitStack() as context:
            _contexts.append(context)
            context.callback(_contexts.remove, context)
            yield
    finally:
        if collecting:
            gc.enable()


def kernel_options() -> dict[str, Any]:
    """Options of ``njit`` for kernels; empty if Numba's private interfaces have changed."""
    compilers = _compilers()
    return _options(compilers[0]) if compilers else {}


def entry_point_compiler(*args: Any) -> Any:
    """Numba's compiler with some passes less; the usual one if private interfaces have changed."""
    compilers = _compilers()
    return (compilers[1] if compilers else import_module("numba.core.compiler").Compiler)(*args)


def _compilers() -> tuple[Any, Any] | None:
    compilers = _tested_compilers()
    if compilers and _contexts:
        _contexts[-1].enter_context(_numba_patched())
    return compilers


@cache
def _tested_compilers() -> tuple[Any, Any] | None:
    try:
        compilers = _make_compilers()
        with _numba_patched():
            if _probe(*compilers) == 42.0:
                return compilers
    except Exception:  # whatever a changed interface raises
        pass
    return None


def _options(compiler: Any) -> dict[str, Any]:
    return {"pipeline_class": compiler, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def _probe(of_kernels: Any, of_entry_points: Any) -> float:
    def inner(x: float, n: int) -> float:
        return x * n + n

    inner = njit(error_model="numpy", **_options(of_kernels))(inner)

    def outer(x: float) -> float:
        return inner(x, 3) + inner(2.0 * x, 3)

    return float(cfunc("float64(float64)", error_model="numpy",
                       pipeline_class=of_entry_points)(outer).ctypes(4.0))


def _make_compilers() -> tuple[Any, Any]:
    function_maker = import_module("numba._dynfunc")
    codegen = import_module("numba.core.codegen")
    compiler = import_module("numba.core.compiler")
    lowering: Any = import_module("numba.core.typed_passes").NativeLowering
    register_pass = import_module("numba.core.compiler_machinery").register_pass

    class LinkedLibrary(codegen.JITCodeLibrary):  # type: ignore[misc, name-defined]
        """LLVM code without optimisation and machine code of its own."""

        def _optimize_final_module(self) -> None:
            pass

        def _finalize_final_module(self) -> None:
            self._finalize_dynamic_globals()
            self._finalized = True

    @register_pass(mutates_CFG=True, analysis_only=False)
    class LinkedLowering(lowering):  # type: ignore[misc]
        """Lower a function into such a library."""

        _name = "linked_lowering"

        def run_pass(self, state: Any) -> bool:
            name = state.func_id.func_qualname
            state.library = library = LinkedLibrary(state.targetctx.codegen(), name)
            state.flags.no_compile = True
            super().run_pass(state)
            lowered = state["cr"]
            described = lowered.fndesc
            library._ensure_finalized()
            entry = function_maker.make_function(
                described.lookup_module(), name.split(".")[-1], "linked", 0, lowered.env,
                (library,))
            state.targetctx.insert_user_function(entry, described, [library])
            state.reload_init.extend(library._reload_init)
            state["cr"] = compiler._LowerResult(
                described, lowered.call_helper, cfunc=entry, env=lowered.env)
            return True

    class ShortCompiler(compiler.CompilerBase):  # type: ignore[misc, name-defined]
        """Numba's usual compiler without the counting of references and without some passes."""

        lowering_pass = lowering

        def __init__(self, *args: Any) -> None:
            args[5].nrt = False  # flags
            super().__init__(*args)

        def define_pipelines(self) -> list[Any]:
            passes = import_module("numba.core.compiler_machinery").PassManager("short")
            for step, text in compiler.DefaultPassBuilder.define_nopython_pipeline(
                    self.state).passes:
                if step.__name__ not in _UNUSED_PASSES:
                    passes.add_pass(self.lowering_pass if step is lowering else step, text)
            passes.finalize()
            return [passes]

    class LinkedCompiler(ShortCompiler):
        """The same for functions that are only linked into their callers."""

        lowering_pass = LinkedLowering

    return LinkedCompiler, ShortCompiler


@contextmanager
def _numba_patched() -> Iterator[None]:
    """Let Numba remember the types of operators, and take negative indices as they are."""
    function_type: Any = import_module("numba.core.types.functions").BaseFunction
    arrays: Any = import_module("numba.np.arrayobj")
    resolve, index = function_type.get_call_type, arrays.fix_integer_index
    if getattr(resolve, "remembers", False):  # on already
        yield
        return
    known: dict[Any, Any] = {}

    def remembered(self: Any, context: Any, args: Any, kws: Any) -> Any:
        key = self, id(context), tuple(args), tuple(kws.items())
        if key not in known:
            known[key] = resolve(self, context, args, kws)
        return known[key]

    remembered.remembers = True  # type: ignore[attr-defined]
    function_type.get_call_type = remembered
    arrays.fix_integer_index = (
        lambda context, builder, kind, index, *size: context.cast(builder, index, kind, types.intp))
    try:
        yield
    finally:
        function_type.get_call_type, arrays.fix_integer_index = resolve, index
