"""Expressions as plain functions, for repeated evaluation during a run.

``Expression.evaluate`` works on arrays and costs tens of microseconds; here an
expression becomes nested closures on floats and costs one. Where it has no
finite value the function gives nan.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable
from typing import NamedTuple

from sandbox.values.expressions import CONSTANTS, MAX_EXPONENT, call, dotted, parse_expression
from sandbox.values.tables import NONE, Tables

Read = Callable[[], float]

_BINARY: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul,
    ast.Div: operator.truediv, ast.Mod: operator.mod, ast.Pow: lambda a, b: _power(a, b),
}
_COMPARE: dict[type[ast.cmpop], Callable[[float, float], bool]] = {
    ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge,
    ast.Eq: operator.eq, ast.NotEq: operator.ne,
}
_FUNCTIONS: dict[str, Callable[..., float]] = {
    "sin": math.sin, "cos": math.cos, "tan": math.tan, "asin": math.asin, "acos": math.acos,
    "atan": math.atan, "atan2": math.atan2, "sqrt": math.sqrt, "exp": math.exp, "log": math.log,
    "tanh": math.tanh, "abs": abs, "hypot": math.hypot, "sign": lambda x: float((x > 0) - (x < 0)),
    "floor": lambda x: float(math.floor(x)), "ceil": lambda x: float(math.ceil(x)),
    "min": lambda *x: _of_numbers(min, x), "max": lambda *x: _of_numbers(max, x),
    "clip": lambda x, low, high: _of_numbers(min, (_of_numbers(max, (x, low)), high)),
}
"""The functions of expressions, each on floats."""


def _power(base: float, exponent: float) -> float:
    result = base**exponent if abs(exponent) <= MAX_EXPONENT else math.nan
    return result if isinstance(result, float) else math.nan  # a negative base: complex


def _of_numbers(choose: Callable[..., float], values: tuple[float, ...]) -> float:
    """The least or largest of several; nan if one is nan, wherever it stands."""
    return math.nan if any(value != value for value in values) else choose(values)


def closure(text: str, read: Callable[[str], Read], tables: Tables = NONE) -> Read:
    """A function that computes the expression ``text``.

    Args:
        text: an expression; a leading ``=`` is dropped.
        read: gives a function for each name that the expression reads.
        tables: the scene's, by their calls.

    Raises:
        WrongValueError: ``text`` is not an expression.
    """
    expression = parse_expression(text)
    expression.check_tables(tables)
    inner = _closure(expression.tree, _Meanings(read, tables))

    def value() -> float:
        try:
            result = float(inner())
        except (ZeroDivisionError, ValueError, OverflowError):
            return math.nan
        return result if math.isfinite(result) else math.nan

    return value


class _Meanings(NamedTuple):
    """What the names of an expression mean."""

    read: Callable[[str], Read]
    tables: Tables


def _closure(node: ast.expr, known: _Meanings) -> Read:
    name = dotted(node)
    if name is not None:
        if name not in CONSTANTS:
            return known.read(name)
        constant = CONSTANTS[name]
        return lambda: constant
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        literal = float(node.value)
        return lambda: literal
    if isinstance(node, ast.BinOp):
        binary, left, right = _BINARY[type(node.op)], *(
            _closure(side, known) for side in (node.left, node.right))
        return lambda: binary(left(), right())
    if isinstance(node, ast.UnaryOp):
        operand = _closure(node.operand, known)
        if isinstance(node.op, ast.Not):
            return lambda: float(not operand())
        return (lambda: -operand()) if isinstance(node.op, ast.USub) else operand
    if isinstance(node, ast.IfExp):
        test, body, other = (_closure(part, known) for part in (node.test, node.body, node.orelse))
        return lambda: body() if test() else other()
    if isinstance(node, ast.BoolOp):
        parts = [_closure(part, known) for part in node.values]
        every = all if isinstance(node.op, ast.And) else any
        return lambda: float(every(part() for part in parts))
    if isinstance(node, ast.Compare):
        return _comparison(node, known)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        name = node.func.id
        function = _FUNCTIONS[name] if name in _FUNCTIONS else known.tables[call(name)].at
        arguments = [_closure(argument, known) for argument in node.args]
        return lambda: function(*[argument() for argument in arguments])
    raise TypeError(f"{type(node).__name__} has no place in a checked expression")


def _comparison(node: ast.Compare, known: _Meanings) -> Read:
    operands = [_closure(part, known) for part in (node.left, *node.comparators)]
    tests = [_COMPARE[type(op)] for op in node.ops]

    def value() -> float:
        values = [operand() for operand in operands]
        return float(all(
            test(a, b) for test, a, b in zip(tests, values, values[1:], strict=False)))

    return value
