"""Arithmetic of named values: ``"=pull / 4"``. Never Python's ``eval``.

:mod:`ast` parses the text; numbers, names (also with dots), arithmetic, comparison, ``and``,
``or``, ``not``, ``a if c else b``, the functions below and the scene's tables are accepted.
Comparison and logic give 1 or 0; all but 0 is true. A tree is computed on arrays
(:meth:`Expression.evaluate`) or, in every step of a run, on floats (:func:`closure`).
"""

from __future__ import annotations

import ast
import itertools
import keyword
import math
import operator
import re
import sys
import warnings
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial, reduce
from graphlib import CycleError, TopologicalSorter
from typing import Any, NamedTuple, TypeVar

import numpy as np

from sandbox.values.units import parse_quantity
from sandbox.wording import NearMisses, WrongValueError, listed, near, quoted, refuse_if

MAX_LENGTH = 1000
MAX_DEPTH = 60
MAX_EXPONENT = 64.0
Read = Callable[[], float]
_Node = TypeVar("_Node", bound=Hashable)

CONSTANTS: dict[str, float] = {"pi": math.pi, "tau": math.tau, "e": math.e, "deg": math.pi / 180}


def _of_numbers(choose: Callable[..., float], values: tuple[float, ...]) -> float:
    """The minimum or maximum of several; nan if one is nan."""
    return math.nan if any(value != value for value in values) else choose(values)


class Function(NamedTuple):
    """A function of expressions, for arrays and for floats."""

    arrays: Callable[..., Any]
    floats: Callable[..., float]
    arguments: int | None = 1  # their number; None is two or more


FUNCTIONS: dict[str, Function] = {
    "sin": Function(np.sin, math.sin), "cos": Function(np.cos, math.cos),
    "tan": Function(np.tan, math.tan), "asin": Function(np.arcsin, math.asin),
    "acos": Function(np.arccos, math.acos), "atan": Function(np.arctan, math.atan),
    "atan2": Function(np.arctan2, math.atan2, 2), "sqrt": Function(np.sqrt, math.sqrt),
    "exp": Function(np.exp, math.exp), "log": Function(np.log, math.log),
    "abs": Function(np.abs, abs), "hypot": Function(np.hypot, math.hypot, 2),
    "sign": Function(np.sign, lambda x: float((x > 0) - (x < 0))),
    "floor": Function(np.floor, lambda x: float(math.floor(x))),
    "ceil": Function(np.ceil, lambda x: float(math.ceil(x))),
    "tanh": Function(np.tanh, math.tanh),
    "min": Function(lambda *x: reduce(np.minimum, x), lambda *x: _of_numbers(min, x), None),
    "max": Function(lambda *x: reduce(np.maximum, x), lambda *x: _of_numbers(max, x), None),
    "clip": Function(np.clip, lambda x, low, high: _of_numbers(
        min, (_of_numbers(max, (x, low)), high)), 3),
}
KEYWORDS = frozenset({"if", "else", "and", "or", "not"})
RESERVED = frozenset({*CONSTANTS, *FUNCTIONS, *KEYWORDS, *keyword.kwlist, "t"})
"""Names with a meaning in expressions or Python, which no parameter can have."""


def _power(base: Any, exponent: Any) -> Any:
    refuse_if(np.any(np.abs(exponent) > MAX_EXPONENT), f"an exponent is at most {MAX_EXPONENT:g}",
              "limit-exceeded")
    return np.power(base, exponent)


def _float_power(base: float, exponent: float) -> float:
    result = base**exponent if abs(exponent) <= MAX_EXPONENT else math.nan
    return result if isinstance(result, float) else math.nan  # a negative base: complex


_one_or_zero = partial(np.asarray, dtype=float)
# Of arrays and of floats; those of "and", "or" and "if" take functions as operands.
_OPERATORS: dict[type[ast.AST], tuple[Callable[..., Any], Callable[..., Any]]] = {
    ast.Add: (np.add, operator.add), ast.Sub: (np.subtract, operator.sub),
    ast.Mult: (np.multiply, operator.mul), ast.Div: (np.divide, operator.truediv),
    ast.Mod: (np.mod, operator.mod), ast.Pow: (_power, _float_power),
    ast.USub: (np.negative, operator.neg), ast.UAdd: (lambda x: x, lambda x: x),
    ast.Not: (lambda x: _one_or_zero(np.logical_not(x)), lambda x: float(not x)),
    ast.Lt: (np.less, operator.lt), ast.LtE: (np.less_equal, operator.le),
    ast.Gt: (np.greater, operator.gt), ast.GtE: (np.greater_equal, operator.ge),
    ast.Eq: (np.equal, operator.eq), ast.NotEq: (np.not_equal, operator.ne),
    ast.Compare: (lambda found: _one_or_zero(reduce(np.logical_and, found)),
                  lambda found: float(all(found))),
    ast.And: (lambda *parts: _one_or_zero(reduce(np.logical_and, [part() for part in parts])),
              lambda *parts: float(all(part() for part in parts))),
    ast.Or: (lambda *parts: _one_or_zero(reduce(np.logical_or, [part() for part in parts])),
             lambda *parts: float(any(part() for part in parts))),
    ast.IfExp: (lambda test, body, other: np.where(test(), body(), other()),
                lambda test, body, other: body() if test() else other()),
}
_NAME = re.compile(r"(?<![\w.])(?<!\. )([A-Za-z_]\w*)(?![\w.])(?! *\.)( *\()?")  # or a function
_STRANGE = re.compile(r"[^A-Za-z0-9_.+\-*/%()<>=!, \t]")
_UNIT_INSIDE = re.compile(
    rf"(?<![\w.])[0-9.]+(?:[eE][+-]?[0-9]+)? *(?!(?:{'|'.join(sorted(KEYWORDS))})\b)([A-Za-z]\w*)")
_GRAMMAR = (
    "numbers, names, + - * / % **, < <= > >= == !=, and or not, (…), 'a if c else b' and "
    "functions")


@dataclass(frozen=True)
class Expression:
    """A parsed expression: its text (without ``=``), the names it reads, the tables it calls."""

    text: str
    names: frozenset[str]
    tree: ast.expr
    tables: frozenset[str] = frozenset()

    def evaluate(self, values: Mapping[str, Any], *, finite: bool = True) -> Any:
        """The value, float or array, for named values and tables (by :func:`call`)."""
        self.check_tables(values)
        for name in sorted(name for name in self.names if name not in values):
            raise unknown_name(name, values)
        try:
            with np.errstate(all="ignore"):
                computed = _compiled(self.tree, 0, lambda name: lambda: (
                    values[name] if name in values else CONSTANTS[name]), values)
                result = np.asarray(computed(), dtype=float)
        except WrongValueError:
            raise
        except (TypeError, ValueError, OverflowError) as error:
            raise WrongValueError("bad-expression", f"{self} cannot be computed: {error}") from None
        refuse_if(finite and not np.all(np.isfinite(result)), f"{self} has no finite value (a "
                  "division by zero, or out of range)", "bad-expression")
        return float(result) if result.ndim == 0 else result

    def bind(self, values: Mapping[str, float], tables: Mapping[str, str] = {}) -> Expression:
        """The same expression with names replaced by their values, tables by others' names."""
        def bound(found: re.Match[str]) -> str:
            name, call = found.groups(default="")
            if call:
                return tables.get(name, name) + call
            return f"({float(values[name])!r})" if name in values else name

        tree = _tree_of(_NAME.sub(bound, self.text))
        return _expression(ast.unparse(tree), tree)

    def check_tables(self, values: Mapping[str, Any]) -> None:
        """Check that every table that it calls is among ``values``."""
        for name in sorted(self.tables):
            if call(name) not in values:
                raise _unknown_function(name, values)

    def __str__(self) -> str:
        return quoted(f"={self.text}")


def is_expression(value: object) -> bool:
    """Whether a written value is an expression."""
    return isinstance(value, str) and value.lstrip().startswith("=")


def call(table: str) -> str:
    """The key of a table among named values; no other name has this form."""
    return f"{table}()"


@lru_cache(maxsize=1024)
def parse_expression(text: str) -> Expression:
    """Parse ``text`` (a leading ``=`` is dropped)."""
    body = text.strip().removeprefix("=").strip()
    refuse_if(len(body) > MAX_LENGTH, f"an expression has at most {MAX_LENGTH} characters, this "
              f"one has {len(body)}", "limit-exceeded")
    refuse_if(not body, "the expression is empty", "bad-expression", allowed=_GRAMMAR)
    for strange in _STRANGE.findall(body):
        refuse_if(strange, f"{quoted(strange)} has no place in the expression {quoted(body)}",
                  "bad-expression", allowed=_GRAMMAR)
    return _expression(body, _tree_of(body))


@lru_cache(maxsize=32_768)
def names_in(text: str) -> frozenset[str]:
    """The names that an expression reads; its cache is larger than that of whole expressions."""
    return parse_expression(text).names


def closure(text: str, read: Callable[[str], Read], tables: Mapping[str, Any]) -> Read:
    """A function of floats that computes an expression; nan where it has no finite value."""
    def named(name: str) -> Read:
        constant = CONSTANTS.get(name, 0.0)
        return (lambda: constant) if name in CONSTANTS else read(name)

    expression = parse_expression(text)
    expression.check_tables(tables)
    inner = _compiled(expression.tree, 1, named, {name: table.at for name, table in tables.items()})

    def value() -> float:
        try:
            result = float(inner())
        except (ZeroDivisionError, ValueError, OverflowError):
            return math.nan
        return result if math.isfinite(result) else math.nan

    return value


def rings(nexts: Mapping[_Node, Sequence[_Node]]) -> Iterator[list[_Node]]:
    """Cycles of a graph, which has the next ones of each node; none has a node of another."""
    while True:
        try:
            return TopologicalSorter(nexts).prepare()
        except CycleError as error:
            yield (ring := error.args[1][:0:-1])
            nexts = {node: [each for each in following if each not in ring]
                     for node, following in nexts.items() if node not in ring}


def _expression(body: str, tree: ast.expr) -> Expression:
    names: set[str] = set()
    _check(tree, names, 0)
    calls = {name for name in names if name.endswith("()")}
    return Expression(body, frozenset(names - calls - set(CONSTANTS)), tree,
                      frozenset(name[:-2] for name in calls))


def _tree_of(body: str) -> ast.expr:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # "1if x" is doubtful Python; refused or read below
            return ast.parse(body, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        pass
    if unit := _UNIT_INSIDE.search(body):
        try:
            in_si = f"{parse_quantity(unit.group(), None):.10g}"
        except WrongValueError:
            in_si = ""
        raise WrongValueError("bad-expression", f"{quoted(unit.group())} is not a number: inside "
                              "an expression all is SI, without units", allowed=in_si)
    raise WrongValueError("bad-expression",
                          f"{quoted(body)} is not an expression", allowed=_GRAMMAR)


def dotted(node: ast.expr) -> str | None:
    """``finger1.tendon.tension`` of an attribute chain, None of anything else."""
    attributes: list[str] = []
    while isinstance(node, ast.Attribute):
        attributes.append(node.attr)
        node = node.value
    return ".".join([node.id, *reversed(attributes)]) if isinstance(node, ast.Name) else None


def split(node: ast.expr) -> tuple[Sequence[ast.expr], Sequence[ast.AST]] | None:
    """The operands and operators of a node; None of one that no expression may have."""
    parts: Sequence[ast.expr]
    ops: Sequence[ast.AST] = ()
    match node:
        case ast.BinOp():
            parts, ops = (node.left, node.right), (node.op,)
        case ast.UnaryOp():
            parts, ops = (node.operand,), (node.op,)
        case ast.BoolOp():
            parts, ops = node.values, (node.op,)
        case ast.Compare():
            parts, ops = (node.left, *node.comparators), node.ops
        case ast.IfExp():
            parts, ops = (node.test, node.body, node.orelse), (node,)
        case ast.Call(ast.Name(), parts, []):
            pass
        case _:
            return None
    return (parts, ops) if all(type(op) in _OPERATORS for op in ops) else None


def _check(node: ast.expr, names: set[str], depth: int) -> None:
    """Check a node and all below it; ``names`` collects what they read and call."""
    refuse_if(depth > MAX_DEPTH, f"an expression may nest at most {MAX_DEPTH} deep",
              "limit-exceeded")
    if (name := dotted(node)) is not None:
        refuse_if("__" in name, f"{quoted(name)} is not a name that a scene can use",
                  "invalid-name")
        names.add(name)
    elif isinstance(node, ast.Constant):
        if isinstance(node.value, bool) or not isinstance(node.value, (int, float)):
            raise WrongValueError("bad-expression", f"{quoted(node.value)} is not a number")
        refuse_if(not abs(node.value) <= sys.float_info.max,
                  "a number of the expression is too large", "out-of-range")
    elif (found := split(node)) is not None:
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            _check_call(node.func.id, len(node.args), names)
        for part in found[0]:
            _check(part, names, depth + 1)
    else:
        raise WrongValueError("bad-expression", f"{quoted(ast.unparse(node))} has no place in an "
                              "expression", allowed=_GRAMMAR)


def _check_call(name: str, count: int, names: set[str]) -> None:
    """Check a call's number of arguments; an unknown function is a table, of one argument."""
    if name not in FUNCTIONS:
        if count != 1 or name in RESERVED or "__" in name:
            raise _unknown_function(name, {})
        names.add(call(name))
        return
    wanted = FUNCTIONS[name].arguments
    if count < 2 if wanted is None else count != wanted:
        many = {None: "two or more arguments", 1: "one argument"}.get(wanted, f"{wanted} arguments")
        raise WrongValueError("bad-expression", f"the function {name} takes {many}, not {count}")


def _unknown_function(name: str, values: Mapping[str, Any]) -> WrongValueError:
    """The error of a name that is neither a function nor a table among ``values``."""
    known = [*FUNCTIONS, *(each[:-2] for each in values if each.endswith("()"))]
    return WrongValueError("bad-expression", f"unknown function {quoted(name)}",
                           allowed=", ".join(known), hint=near(name, known))


def _compiled(
    node: ast.expr, on: int, read: Callable[[str], Callable[[], Any]],
    tables: Mapping[str, Callable[..., Any]],
) -> Callable[[], Any]:
    """A function that computes a checked node on arrays (``on`` 0) or floats (1)."""
    if (name := dotted(node)) is not None:
        return read(name)
    if isinstance(node, ast.Constant):
        number = float(node.value)  # type: ignore[arg-type]
        return lambda: number
    operands, ops = split(node) or ((), ())
    parts = [_compiled(operand, on, read, tables) for operand in operands]
    if isinstance(node, ast.Call):
        name = node.func.id  # type: ignore[attr-defined]
        known = FUNCTIONS.get(name)
        function: Any = tables[call(name)] if known is None else known[on]
        return lambda: function(*[part() for part in parts])
    if isinstance(node, ast.Compare):
        tests, every = [_OPERATORS[type(op)][on] for op in ops], _OPERATORS[ast.Compare][on]

        def compared() -> Any:
            values = [part() for part in parts]
            return every([test(a, b) for test, a, b in zip(
                tests, values, values[1:], strict=False)])

        return compared
    compute = _OPERATORS[type(ops[0])][on]
    if isinstance(node, ast.BinOp):
        left, right = parts
        return lambda: compute(left(), right())
    if isinstance(node, ast.UnaryOp):
        operand, = parts
        return lambda: compute(operand())
    return lambda: compute(*parts)


class NamedValues(dict[str, Any]):
    """Values that expressions may read, by name; suggestions for the first unknown names."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.near = NearMisses()

    @cached_property
    def listed(self) -> str:
        """The names, cached at their first use."""
        return listed(sorted(self))


def unknown_name(
    name: str, known: Mapping[str, Any], *, but: str = "", also: str = "",
) -> WrongValueError:
    """The refusal of an unknown name; ``but`` is its reader, ``also`` a name with a value later."""
    known = known if isinstance(known, NamedValues) else NamedValues(known)
    others = itertools.chain((each for each in known if each != but), [also] if also else [])
    allowed = ", ".join(filter(None, (known.listed if len(known) > (but in known) else "",
                                      quoted(also) if also else "")))
    return WrongValueError("name-not-found", f"unknown name {quoted(name)} in an expression",
                           allowed=allowed or "numbers, as the scene has no parameters",
                           hint=known.near(name, others))
