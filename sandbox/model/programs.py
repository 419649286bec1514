"""Expressions as programs of a stack machine, which the compiled step runs (engine/formulas.py).

A program computes the same as the expression in the same order. Laws of springs and loads are
expressions of a stretch or of a body's motion.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from sandbox.elements.loads import MOTION, LoadSpec
from sandbox.elements.springs import Spring
from sandbox.numeric import Array, Integers, Records
from sandbox.values import expressions as ex
from sandbox.values.tables import Function, Tables
from sandbox.wording import WrongValueError

# operations; NAME and TABLE have the index of a name or table; NEXT_LT and so on are the second
# comparisons of a chain (a < b < c), in the order of the first
(NUMBER, NAME, TABLE, ADD, SUB, MUL, DIV, MOD, POW, NEG, SELECT, DROP, AND, OR, NOT, LT, LE, GT,
 GE, EQ, NE, NEXT_LT, NEXT_LE, NEXT_GT, NEXT_GE, NEXT_EQ, NEXT_NE, SIN, COS, TAN, ASIN, ACOS, ATAN,
 ATAN2, SQRT, EXP, LOG, TANH, ABS, HYPOT, SIGN, FLOOR, CEIL, MIN, MAX) = range(45)

_CODES: dict[type[ast.AST], int] = {
    ast.Add: ADD, ast.Sub: SUB, ast.Mult: MUL, ast.Div: DIV, ast.Mod: MOD, ast.Pow: POW,
    ast.USub: NEG, ast.Not: NOT, ast.And: AND, ast.Or: OR, ast.IfExp: SELECT, ast.Lt: LT,
    ast.LtE: LE, ast.Gt: GT, ast.GtE: GE, ast.Eq: EQ, ast.NotEq: NE}
_FUNCTIONS: dict[str, int] = {
    "sin": SIN, "cos": COS, "tan": TAN, "asin": ASIN, "acos": ACOS, "atan": ATAN, "atan2": ATAN2,
    "sqrt": SQRT, "exp": EXP, "log": LOG, "tanh": TANH, "abs": ABS, "hypot": HYPOT, "sign": SIGN,
    "floor": FLOOR, "ceil": CEIL, "min": MIN, "max": MAX}

LARGEST_EXPONENT = ex.MAX_EXPONENT  # of expressions, for compiled code
STEP = np.dtype([("op", np.int64), ("value", float)])
CURVE = np.dtype([
    ("first", np.int64), ("last", np.int64),    # its knots
    ("repeats", np.int64),  # whether it starts again after the last
])
KNOT = np.dtype([
    ("x", float),           # where its piece begins; a curve's first piece ends there
    ("y", float), ("b", float), ("c", float), ("d", float),     # of the piece
])  # A curve of n knots has n + 1 pieces, the one before its first knot in a row before that

Step = tuple[int, float]


class Program(NamedTuple):
    """What an expression does, step by step."""

    steps: tuple[Step, ...]
    depth: int  # maximum size of the stack


def compile_expression(
    expression: ex.Expression, names: Sequence[str], tables: Sequence[str],
) -> Program:
    """The program of an expression; WrongValueError if it has other ``names`` or ``tables``."""
    expression.check_tables({f"{name}()": None for name in tables})
    for name in sorted(expression.names):
        if name not in names:
            raise ex.unknown_name(name, dict.fromkeys(names))
    where = {name: i for i, name in enumerate(names)}, {name: i for i, name in enumerate(tables)}
    steps = tuple(_steps(expression.tree, *where))
    waiting = depth = 0
    for op, _ in steps:
        waiting += _GROWS.get(op, 0)
        depth = max(depth, waiting)
    return Program(steps, depth)


_GROWS = {NUMBER: 1, NAME: 1, SELECT: -2, DROP: -1} | dict.fromkeys(
    (ADD, SUB, MUL, DIV, MOD, POW, AND, OR, NEXT_LT, NEXT_LE, NEXT_GT, NEXT_GE, NEXT_EQ, NEXT_NE,
     ATAN2, HYPOT, MIN, MAX), -1)
"""By how much an operation makes the stack higher; the others leave it."""


def _steps(node: ast.expr, names: Mapping[str, int], tables: Mapping[str, int]) -> Iterator[Step]:
    if (name := ex.dotted(node)) is not None:
        yield (NAME, names[name]) if name in names else (NUMBER, ex.CONSTANTS[name])
        return
    if isinstance(node, ast.Constant):
        yield NUMBER, float(node.value)  # type: ignore[arg-type]
        return
    operands, operators = ex.split(node) or ((), ())
    codes = [_CODES.get(type(operator), 0) for operator in operators]
    last = 0.0
    if isinstance(node, ast.Call):
        called = node.func.id  # type: ignore[attr-defined]
        codes, last = [_FUNCTIONS.get(called, TABLE)], tables.get(called, 0.0)
        if called == "clip":
            codes = [MAX, MIN]
    elif isinstance(node, ast.Compare):
        codes = [code + (NEXT_LT - LT if i else 0) for i, code in enumerate(codes)]
    between = codes * (len(operands) - 1) if len(codes) == 1 else codes
    for i, operand in enumerate(operands):
        yield from _steps(operand, names, tables)
        if i and not isinstance(node, ast.IfExp):
            yield between[i - 1], 0.0
    if isinstance(node, ast.Compare):
        yield DROP, 0.0
    elif (len(operands) == 1 and codes[0]) or isinstance(node, ast.IfExp):
        yield codes[0], last


def curve_tables(functions: Sequence[Function]) -> tuple[Records, Records]:
    """CURVE of each table and the KNOTs of all, the piece before a curve's first in front."""
    curves = np.zeros(len(functions), CURVE)
    knots = np.zeros(sum(len(each.knots) + 1 for each in functions), KNOT)
    at = 0
    for curve, function in zip(curves, functions, strict=True):
        curve["first"], curve["last"] = at + 1, at + len(function.knots)
        curve["repeats"] = function.repeats
        own = knots[at:at + len(function.knots) + 1]
        own["x"] = np.concatenate([function.knots[:1], function.knots])
        own["y"], own["b"], own["c"], own["d"] = function.pieces.T
        at += len(own)
    return curves, knots


def step_table(programs: Sequence[Program]) -> tuple[Records, Integers]:
    """STEPs of all programs, and where those of each begin and the last one's end, [n + 1]."""
    table = np.zeros(sum(len(each.steps) for each in programs), STEP)
    for row, (op, value) in zip(table, (step for each in programs for step in each.steps),
                                strict=True):
        row["op"], row["value"] = op, value
    return table, np.cumsum([0, *(len(each.steps) for each in programs)], dtype=np.int64)


def stack_for(programs: Sequence[Program], slopes: int) -> Array:
    """Room for the numbers of any of these, each with so many slopes."""
    return np.zeros((max((each.depth for each in programs), default=0) + 1, 1 + slopes))


def _values(expression: ex.Expression, shape: tuple[int, ...], known: Mapping[str, Any]) -> Array:
    try:
        return np.broadcast_to(expression.evaluate(known, finite=False), shape)
    except WrongValueError:  # an exponent that is too large at one of them
        return np.full(shape, np.nan)


STRETCH, RATE = 0, 1  # inputs of a law's program, and its stiffness


@dataclass(frozen=True)
class SpringLaw:
    """The law of one spring."""

    own: ex.Expression | None  # of stretch and rate; None for k s
    names: tuple[str, ...]  # of stretch, rate and stiffness
    damping: float  # [N s/m, N m s/rad]
    side: int  # +1 if it acts only while stretched, -1 only while compressed; 0 always
    whole: ex.Expression  # with damping, and 0 on the other side
    program: Program  # of the whole
    tables: Tables

    @property
    def of_rate(self) -> bool:
        """Whether it depends on the rate."""
        return self.names[RATE] in self.whole.names

    def force(self, stretch: Array, rate: Array, stiffness: Array | float = 0.0) -> Array:
        """The force [N, N m] at stretches and rates [n]; nan where it has no value."""
        return _values(self.whole, np.shape(stretch), {
            **dict(zip(self.names, (stretch, rate, stiffness), strict=True)), **self.tables})

    def slopes(self, stretch: Array, stiffness: float = 0.0) -> Array:
        """dF/ds at rest between neighbours of rising stretches, [n - 1]."""
        with np.errstate(all="ignore"):
            found: Array = np.diff(self.force(stretch, np.zeros(len(stretch)), stiffness))
            return found / np.diff(stretch)


def law_of(spring: Spring, order: Sequence[str], tables: Tables) -> SpringLaw | None:
    """The law of a spring, None of a linear one; programs number tables in their ``order``."""
    own, damping = spring.law and ex.parse_expression(spring.law), float(spring.damping)
    names = stretch, rate, _ = *spring.OWN, "stiffness"
    if not own and spring.only is None:
        return None
    text = f"({own.text})" if own else f"stiffness * {stretch}"
    text += f" + {damping!r} * {rate}" if damping else ""
    side = 0 if spring.only is None else 1 if spring.only in ("pull", "above") else -1
    if side:
        bound, beyond = ("max", ">") if side > 0 else ("min", "<")
        text = f"{bound}({text}, 0) if {stretch} {beyond} 0 else 0"
    tree = ast.parse(text, mode="eval").body
    read = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    whole = ex.Expression(text, frozenset(read & {*names}), tree,
                          own.tables if own else frozenset())
    return SpringLaw(own or None, names, damping, side, whole,
                     compile_expression(whole, names, order), tables)


MOVED = frozenset(MOTION) - {"t", "mass", "inertia"}  # these change in a step, besides the time


@dataclass(frozen=True)
class LoadLaw:
    """The law of one load: components of its force, and its torque; None for 0."""

    parts: tuple[ex.Expression | None, ...]  # [3]
    programs: tuple[Program | None, ...]  # [3]
    tables: Tables

    @property
    def names(self) -> frozenset[str]:
        """What it reads."""
        return frozenset[str]().union(*(part.names for part in self.parts if part is not None))

    def at(self, motion: Mapping[str, Array]) -> Array:
        """Its three numbers [3, n] for a motion [n] under each of its names; nan for no value."""
        shape = np.shape(motion["x"])
        return np.array([np.zeros(shape) if part is None else _values(
            part, shape, {**motion, **self.tables}) for part in self.parts])


def law_of_load(load: LoadSpec, order: Sequence[str], tables: Tables) -> LoadLaw | None:
    """The law of a load, None of one without; programs number tables in their ``order``."""
    if (texts := load.laws()) is None:
        return None
    parts = tuple(None if text is None else ex.parse_expression(text) for text in texts)
    return LoadLaw(parts, tuple(None if part is None else compile_expression(part, MOTION, order)
                                for part in parts), tables)
