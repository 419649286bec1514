"""Arithmetic of named values: ``"=pull / 4"``. Never Python's ``eval``.

A text of plain characters is parsed by :mod:`ast`, and only numbers, names
(dotted ones too), arithmetic, comparison, ``and``, ``or``, ``not``, ``a if c else b``,
the functions below and the scene's tables are accepted. What is compared, and what
``and``, ``or`` and ``not`` make of it, is 1 or 0, to be counted and weighted with; all
but 0 is true. Expressions work on floats and on
arrays alike. Among the named values a table stands under its :func:`call`.
"""

from __future__ import annotations

import ast
import itertools
import keyword
import math
import re
import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache, reduce
from typing import Any

import numpy as np

from sandbox.values.units import parse_quantity
from sandbox.wording import NearMisses, WrongValueError, listed, near, quoted

MAX_LENGTH = 1000
MAX_DEPTH = 60
MAX_EXPONENT = 64.0

CONSTANTS: dict[str, float] = {"pi": math.pi, "tau": math.tau, "e": math.e, "deg": math.pi / 180}
FUNCTIONS: dict[str, tuple[Callable[..., Any], int | None]] = {
    "sin": (np.sin, 1), "cos": (np.cos, 1), "tan": (np.tan, 1), "asin": (np.arcsin, 1),
    "acos": (np.arccos, 1), "atan": (np.arctan, 1), "atan2": (np.arctan2, 2),
    "sqrt": (np.sqrt, 1), "exp": (np.exp, 1), "log": (np.log, 1), "abs": (np.abs, 1),
    "hypot": (np.hypot, 2), "sign": (np.sign, 1), "floor": (np.floor, 1), "ceil": (np.ceil, 1),
    "tanh": (np.tanh, 1),
    "min": (np.minimum, None), "max": (np.maximum, None), "clip": (np.clip, 3),
}
"""Name -> (function, number of arguments; None is two or more)."""
KEYWORDS = frozenset({"if", "else", "and", "or", "not"})
RESERVED = frozenset({*CONSTANTS, *FUNCTIONS, *KEYWORDS, *keyword.kwlist, "t"})
"""Names that mean something already and cannot be a parameter's, words of :mod:`ast` among them."""

_BINARY: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: np.add, ast.Sub: np.subtract, ast.Mult: np.multiply, ast.Div: np.divide,
    ast.Mod: np.mod, ast.Pow: np.power,
}
_COMPARE: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Lt: np.less, ast.LtE: np.less_equal, ast.Gt: np.greater, ast.GtE: np.greater_equal,
    ast.Eq: np.equal, ast.NotEq: np.not_equal,
}
_LOGIC: dict[type[ast.boolop], Callable[[Any, Any], Any]] = {
    ast.And: np.logical_and, ast.Or: np.logical_or,
}
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
        """The value, float or array, for the given names.

        With ``finite`` False a result may hold NaN and infinity, where the
        named values do (a quantity that is not defined at every sample).

        Raises:
            WrongValueError: a name without a value, or a result that is not finite.
        """
        try:
            with np.errstate(all="ignore"):
                result = np.asarray(_evaluate(self.tree, values), dtype=float)
        except WrongValueError:
            raise
        except (TypeError, ValueError, OverflowError) as error:
            raise WrongValueError("bad-expression", f"{self} cannot be computed: {error}") from None
        if finite and not np.all(np.isfinite(result)):
            raise WrongValueError("bad-expression", f"{self} has no finite value (a division by "
                                  "zero, or out of range)")
        return float(result) if result.ndim == 0 else result

    def bind(
        self, values: Mapping[str, float], tables: Mapping[str, str] | None = None,
    ) -> Expression:
        """The same expression with names replaced by their values, tables by others' names."""
        bound = _Binder(values, tables or {}).visit(_tree_of(self.text))
        return _expression(ast.unparse(bound), bound)

    def check_tables(self, values: Mapping[str, Any]) -> None:
        """See that every table that it calls is among ``values``.

        Raises:
            WrongValueError: the first one that is not.
        """
        for name in sorted(self.tables):
            if call(name) not in values:
                raise _unknown_function(name, values)

    def __str__(self) -> str:
        return quoted(f"={self.text}")


class _Binder(ast.NodeTransformer):
    """Puts numbers for names; a dotted name is one name and not touched by its head's."""

    def __init__(self, values: Mapping[str, float], tables: Mapping[str, str]) -> None:
        self.values, self.tables = values, tables

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id not in self.values:
            return node
        value = float(self.values[node.id])
        constant = ast.Constant(abs(value))
        return constant if value >= 0 else ast.UnaryOp(ast.USub(), constant)

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        return node

    def visit_Call(self, node: ast.Call) -> ast.expr:
        node.args = [self.visit(arg) for arg in node.args]
        if isinstance(node.func, ast.Name) and node.func.id in self.tables:
            node.func = ast.Name(self.tables[node.func.id])
        return node


def call(table: str) -> str:
    """What a table stands under among named values; no name can be that."""
    return f"{table}()"


@lru_cache(maxsize=1024)
def parse_expression(text: str) -> Expression:
    """Parse ``text`` (a leading ``=`` is dropped).

    Raises:
        WrongValueError: not arithmetic, too long, too deep, or an unknown function.
    """
    body = text.strip().removeprefix("=").strip()
    if len(body) > MAX_LENGTH:
        raise WrongValueError("limit-exceeded", f"an expression has at most {MAX_LENGTH} "
                              f"characters, this one has {len(body)}")
    if not body:
        raise WrongValueError("bad-expression", "the expression is empty", allowed=_GRAMMAR)
    if strange := _STRANGE.search(body):
        raise WrongValueError("bad-expression", f"{quoted(strange.group())} has no place in the "
                              f"expression {quoted(body)}", allowed=_GRAMMAR)
    return _expression(body, _tree_of(body))


@lru_cache(maxsize=32_768)
def names_in(text: str) -> frozenset[str]:
    """The names that an expression reads; kept for many more than whole expressions are.

    Raises:
        WrongValueError: as :func:`parse_expression`.
    """
    return parse_expression(text).names


def _expression(body: str, tree: ast.expr) -> Expression:
    names: set[str] = set()
    _check(tree, names, 0)
    read = frozenset(name for name in names if not name.endswith("()"))
    return Expression(body, read - set(CONSTANTS), tree,
                      frozenset(name[:-2] for name in names - read))


def _tree_of(body: str) -> ast.expr:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # "1if x" is doubtful Python; refused or read below
            return ast.parse(body, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        pass
    if unit := _UNIT_INSIDE.search(body):
        raise WrongValueError("bad-expression", f"{quoted(unit.group())} is not a number: inside "
                              "an expression all is SI, without units",
                              allowed=_in_si(unit.group()))
    raise WrongValueError("bad-expression",
                          f"{quoted(body)} is not an expression", allowed=_GRAMMAR)


def _in_si(text: str) -> str:
    """The number that a quantity is without its unit; nothing of a unit that there is not."""
    try:
        return f"{parse_quantity(text, None):.10g}"
    except WrongValueError:
        return ""


def dotted(node: ast.expr) -> str | None:
    """``finger1.tendon.tension`` of an attribute chain, None of anything else."""
    attributes: list[str] = []
    while isinstance(node, ast.Attribute):
        attributes.append(node.attr)
        node = node.value
    if not isinstance(node, ast.Name):
        return None
    return ".".join([node.id, *reversed(attributes)])


def _check(node: ast.expr, names: set[str], depth: int) -> None:
    if depth > MAX_DEPTH:
        raise WrongValueError("limit-exceeded", f"an expression may nest at most {MAX_DEPTH} deep")
    children: Iterable[ast.expr]
    name = dotted(node)
    if name is not None:
        if "__" in name:
            raise WrongValueError("invalid-name",
                                  f"{quoted(name)} is not a name that a scene can use")
        names.add(name)
        children = ()
    elif isinstance(node, ast.Constant):
        _check_constant(node.value)
        children = ()
    elif isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        children = (node.left, node.right)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd, ast.Not)):
        children = (node.operand,)
    elif isinstance(node, ast.IfExp):
        children = (node.test, node.body, node.orelse)
    elif isinstance(node, ast.BoolOp):
        children = node.values
    elif isinstance(node, ast.Compare) and all(type(op) in _COMPARE for op in node.ops):
        children = (node.left, *node.comparators)
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        if _check_call(node.func.id, len(node.args)):
            names.add(call(node.func.id))
        children = node.args
    else:
        raise WrongValueError("bad-expression",
                              f"{_words(node)} has no place in an expression", allowed=_GRAMMAR)
    for child in children:
        _check(child, names, depth + 1)


def _check_constant(value: object) -> None:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise WrongValueError("bad-expression", f"{quoted(value)} is not a number")
    try:
        finite = math.isfinite(float(value))
    except OverflowError:
        finite = False
    if not finite:
        raise WrongValueError("out-of-range", "a number of the expression is too large")


def _words(node: ast.expr) -> str:
    """What a refused piece of Python is, for a person."""
    if isinstance(node, ast.Compare):
        return "'is' or 'in'"
    if isinstance(node, ast.BinOp):
        return "'//'" if isinstance(node.op, ast.FloorDiv) else "this operator"
    if isinstance(node, ast.Call):
        return "a call of anything but a plain function"
    return f"{type(node).__name__.lower()} of Python"


def _check_call(name: str, count: int) -> bool:
    """Hold a call to the function's number of arguments; whether it is one of a table."""
    if name not in FUNCTIONS:
        if count != 1 or name in RESERVED or "__" in name:  # no table either
            raise _unknown_function(name, {})
        return True
    wanted = FUNCTIONS[name][1]
    if (wanted is None and count < 2) or (wanted is not None and count != wanted):
        many = {None: "two or more arguments", 1: "one argument"}.get(wanted, f"{wanted} arguments")
        raise WrongValueError("bad-expression", f"the function {name} takes {many}, not {count}")
    return False


def _unknown_function(name: str, values: Mapping[str, Any]) -> WrongValueError:
    """The refusal of what is neither a function nor a table among ``values``."""
    known = [*FUNCTIONS, *(each[:-2] for each in values if each.endswith("()"))]
    return WrongValueError("bad-expression", f"unknown function {quoted(name)}",
                           allowed=", ".join(known), hint=near(name, known))


def _evaluate(node: ast.expr, values: Mapping[str, Any]) -> Any:
    name = dotted(node)
    if name is not None:
        if name in values:
            return values[name]
        if name in CONSTANTS:
            return CONSTANTS[name]
        raise unknown_name(name, values)
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        return float(node.value)
    if isinstance(node, ast.BinOp):
        left, right = _evaluate(node.left, values), _evaluate(node.right, values)
        if isinstance(node.op, ast.Pow) and np.any(np.abs(right) > MAX_EXPONENT):
            raise WrongValueError("limit-exceeded", f"an exponent is at most {MAX_EXPONENT:g}")
        return _BINARY[type(node.op)](left, right)
    if isinstance(node, ast.UnaryOp):
        operand = _evaluate(node.operand, values)
        if isinstance(node.op, ast.Not):
            return _one_or_zero(np.logical_not(operand))
        return np.negative(operand) if isinstance(node.op, ast.USub) else operand
    if isinstance(node, ast.BoolOp):
        parts = [_evaluate(part, values) for part in node.values]
        return _one_or_zero(reduce(_LOGIC[type(node.op)], parts))
    if isinstance(node, ast.IfExp):
        return np.where(*(_evaluate(part, values) for part in (node.test, node.body, node.orelse)))
    if isinstance(node, ast.Compare):
        operands = [_evaluate(part, values) for part in (node.left, *node.comparators)]
        pairs = zip(node.ops, operands, operands[1:], strict=False)
        return _one_or_zero(
            reduce(np.logical_and, [_COMPARE[type(op)](a, b) for op, a, b in pairs]))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        arguments = [_evaluate(arg, values) for arg in node.args]
        if node.func.id not in FUNCTIONS:
            if call(node.func.id) not in values:
                raise _unknown_function(node.func.id, values)
            return values[call(node.func.id)](*arguments)
        return _call(node.func.id, arguments)
    raise WrongValueError("bad-expression", f"{_words(node)} has no place in an expression")


def _one_or_zero(true: Any) -> Any:
    return np.asarray(true, dtype=float)


def _call(name: str, arguments: list[Any]) -> Any:
    function, arity = FUNCTIONS[name]
    if arity is not None:
        return function(*arguments)
    result = arguments[0]
    for argument in arguments[1:]:
        result = function(result, argument)
    return result


class NamedValues(dict[str, Any]):
    """What expressions may read, by name; near misses for the first names that it lacks."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.near = NearMisses()

    @cached_property
    def listed(self) -> str:
        """The values of names, cached at their first use."""
        return listed(sorted(self))


def unknown_name(
    name: str, known: Mapping[str, Any], *, but: str = "", also: str = "",
) -> WrongValueError:
    """The refusal of a name that an expression reads but nobody gave a value.

    ``but`` is the name of what reads it, which is not meant; ``also`` one that has a value later.
    """
    known = known if isinstance(known, NamedValues) else NamedValues(known)
    others = itertools.chain((each for each in known if each != but), [also] if also else [])
    allowed = ", ".join(filter(None, (known.listed if len(known) > (but in known) else "",
                                      quoted(also) if also else "")))
    return WrongValueError("name-not-found", f"unknown name {quoted(name)} in an expression",
                           allowed=allowed or "the scene has no parameters",
                           hint=known.near(name, others))
