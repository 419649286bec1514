"""Expressions in the compiled step: a stack machine that gives values with their slopes.

Each number on the stack is [value, d/dp, d/dq, ...]: arguments have the slopes given with them, and
each operation applies the chain rule. So laws are linearised exactly. At a kink a function has the
slope of one side; a slope that is not finite (that of a root at 0) counts as 0.
"""

from __future__ import annotations

import math

import numpy as np

from sandbox.engine import memory as at
from sandbox.engine.kernel import kernel
from sandbox.model import programs as ops
from sandbox.numeric import Array


@kernel
def formula(table: int, first: int, last: int, read: Array) -> None:
    """Run a program; value and slopes are then the first row of the ``stack``, [1 + slopes]."""
    steps, stack = at.steps(table), at.stack(table)
    top = -1
    for n in range(first, last):
        op = steps[n]["op"]
        if op in (ops.NUMBER, ops.NAME):
            top += 1
            if op == ops.NUMBER:
                stack[top] = 0.0
                stack[top, 0] = steps[n]["value"]
            for j in range(stack.shape[1] if op == ops.NAME else 0):
                stack[top, j] = read[int(steps[n]["value"]), j]
        elif op == ops.TABLE:
            y, slope = look_up(table, int(steps[n]["value"]), stack[top, 0])
            _chain(stack, top, y, slope)
        elif op == ops.SELECT:
            top -= 2
            chosen = top + 1 if stack[top, 0] != 0.0 else top + 2
            for j in range(stack.shape[1]):
                stack[top, j] = stack[chosen, j]
        elif op == ops.DROP:
            top -= 1
        elif ops.LT <= op < ops.NEXT_LT:
            _compare(stack, top - 1, op)
        elif op in (ops.AND, ops.OR):
            top -= 1
            a, b = stack[top, 0] != 0.0, stack[top + 1, 0] != 0.0
            _whether(stack, top, (a and b) if op == ops.AND else (a or b))
        elif op == ops.NOT:
            _whether(stack, top, stack[top, 0] == 0.0)
        elif ops.NEXT_LT <= op <= ops.NEXT_NE:
            so_far = stack[top - 2, 0]
            top -= 1
            _compare(stack, top, op - ops.NEXT_LT + ops.LT)
            stack[top - 1] = 0.0  # the result in front of what is compared next
            stack[top - 1, 0] = so_far * stack[top, 0]
            for j in range(stack.shape[1]):
                stack[top, j] = stack[top + 1, j]
        elif op == ops.NEG:
            for j in range(stack.shape[1]):
                stack[top, j] = -stack[top, j]
        elif op in (ops.ADD, ops.SUB, ops.MUL, ops.DIV, ops.MOD, ops.POW) or (
                op in (ops.ATAN2, ops.HYPOT, ops.MIN, ops.MAX)):
            top -= 1
            _two(stack, top, op)
        else:
            _one(stack, top, op)


@kernel
def _compare(stack: Array, k: int, op: int) -> None:
    """Compare the numbers at ``k`` and above it: 1 or 0."""
    a, b = stack[k, 0], stack[k + 1, 0]
    true = ((op == ops.LT and a < b) or (op == ops.LE and a <= b) or (op == ops.GT and a > b)
            or (op == ops.GE and a >= b) or (op == ops.EQ and a == b) or (op == ops.NE and a != b))
    _whether(stack, k, true)


@kernel
def _whether(stack: Array, k: int, true: bool) -> None:
    """Put 1 for true, 0 otherwise; neither has a slope."""
    stack[k] = 0.0
    stack[k, 0] = 1.0 if true else 0.0


@kernel
def _chain(stack: Array, k: int, value: float, slope: float) -> None:
    """Put a function's value for its argument, with the slopes that follow from its own."""
    stack[k, 0] = value
    for j in range(1, stack.shape[1]):
        stack[k, j] = slope * stack[k, j] if stack[k, j] != 0.0 and math.isfinite(slope) else 0.0


@kernel
def _two(stack: Array, k: int, op: int) -> None:
    a, b = stack[k, 0], stack[k + 1, 0]
    value, by_a, by_b = a + b, 1.0, 1.0
    if op == ops.SUB:
        value, by_b = a - b, -1.0
    elif op == ops.MUL:
        value, by_a, by_b = a * b, b, a
    elif op == ops.DIV:
        value, by_a, by_b = a / b, 1.0 / b, -a / (b * b)
    elif op == ops.MOD:
        value = a - np.floor(a / b) * b
        by_b = -np.floor(a / b)
    elif op == ops.POW:
        value = a**b if abs(b) <= ops.LARGEST_EXPONENT else math.nan
        by_a, by_b = b * a ** (b - 1.0), value * math.log(a) if a > 0.0 else 0.0
    elif op == ops.ATAN2:
        square = a * a + b * b
        value, by_a, by_b = math.atan2(a, b), b / square, -a / square
    elif op == ops.HYPOT:
        value = math.hypot(a, b)
        by_a, by_b = a / value, b / value
    elif op in (ops.MIN, ops.MAX):
        first = a <= b if op == ops.MIN else a >= b
        value = a + b if a != a or b != b else a if first else b
        by_a, by_b = (1.0, 0.0) if first else (0.0, 1.0)
    stack[k, 0] = value
    for j in range(1, stack.shape[1]):
        slope = 0.0
        if stack[k, j] != 0.0 and math.isfinite(by_a):
            slope += by_a * stack[k, j]
        if stack[k + 1, j] != 0.0 and math.isfinite(by_b):
            slope += by_b * stack[k + 1, j]
        stack[k, j] = slope


@kernel
def _one(stack: Array, k: int, op: int) -> None:
    x = stack[k, 0]
    value, slope = math.nan, 0.0
    if op == ops.SIN:
        value, slope = math.sin(x), math.cos(x)
    elif op == ops.COS:
        value, slope = math.cos(x), -math.sin(x)
    elif op == ops.TAN:
        value = math.tan(x)
        slope = 1.0 + value * value
    elif op in (ops.ASIN, ops.ACOS):
        if abs(x) <= 1.0:
            value, slope = math.asin(x), 1.0 / math.sqrt(1.0 - x * x)
            if op == ops.ACOS:
                value, slope = math.acos(x), -slope
    elif op == ops.ATAN:
        value, slope = math.atan(x), 1.0 / (1.0 + x * x)
    elif op == ops.SQRT:
        if x >= 0.0:
            value = math.sqrt(x)
            slope = 0.5 / value
    elif op == ops.EXP:
        value = math.exp(x)
        slope = value
    elif op == ops.LOG:
        if x > 0.0:
            value, slope = math.log(x), 1.0 / x
    elif op == ops.TANH:
        value = math.tanh(x)
        slope = 1.0 - value * value
    elif op == ops.ABS:
        value, slope = abs(x), 1.0 if x >= 0.0 else -1.0
    elif op == ops.SIGN:
        value = x if x != x else 1.0 if x > 0.0 else -1.0 if x < 0.0 else 0.0
    elif op == ops.FLOOR:
        value = np.floor(x)
    elif op == ops.CEIL:
        value = np.ceil(x)
    _chain(stack, k, value, slope)


@kernel
def look_up(table: int, which: int, x: float) -> tuple[float, float]:
    """A table's value at ``x``, and its slope there."""
    curve, knots = at.curves(table)[which], at.knots(table)
    first, last = curve["first"], curve["last"]
    if not math.isfinite(x):
        return math.nan, 0.0
    if curve["repeats"]:
        period = knots[last]["x"] - knots[first]["x"]
        from_start = x - knots[first]["x"]
        x = from_start - np.floor(from_start / period) * period + knots[first]["x"]
    low, high = first - 1, last + 1  # the piece of `low` begins at or before x, of `high` after
    while high - low > 1:
        middle = (low + high) // 2
        if knots[middle]["x"] <= x:
            low = middle
        else:
            high = middle
    piece = knots[low]
    t = x - piece["x"]
    return (piece["y"] + t * (piece["b"] + t * (piece["c"] + t * piece["d"])),
            piece["b"] + t * (2.0 * piece["c"] + t * 3.0 * piece["d"]))
