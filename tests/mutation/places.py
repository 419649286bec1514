"""Where a source file can be made wrong, and how: edits of its text at nodes of its syntax tree.

A place is a node; each has one or more mutations. What no test can be asked to notice is left
out: docstrings, messages and everything else in strings, annotations, decorators, ``raise`` and
``assert``, how an object prints itself.
"""

from __future__ import annotations

import ast
import random
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

OPERATORS: dict[type[ast.operator], tuple[str, str]] = {
    ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"),
    ast.Pow: ("**", "*"), ast.FloorDiv: ("//", "/"), ast.Mod: ("%", "*"),
    ast.BitAnd: ("&", "|"), ast.BitOr: ("|", "&"),
}
COMPARISONS: dict[type[ast.cmpop], tuple[str, tuple[str, ...]]] = {
    ast.Lt: ("<", ("<=", ">=")), ast.LtE: ("<=", ("<", ">")),
    ast.Gt: (">", (">=", "<=")), ast.GtE: (">=", (">", "<")),
    ast.Eq: ("==", ("!=",)), ast.NotEq: ("!=", ("==",)),
    ast.In: ("in", ("not in",)), ast.NotIn: ("not in", ("in",)),
    ast.Is: ("is", ("is not",)), ast.IsNot: ("is not", ("is",)),
}
NAMES = {
    "min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum",
    "nanmin": "nanmax", "nanmax": "nanmin", "argmin": "argmax", "argmax": "argmin",
    "sin": "cos", "cos": "sin", "any": "all", "all": "any", "floor": "ceil", "ceil": "floor",
    "zeros": "ones", "zeros_like": "ones_like", "flatnonzero": "isnan",
}
"""Functions and methods that are called by the wrong name."""
DROPPED = ("abs", "sqrt", "nan_to_num", "unwrap", "cumsum", "sorted", "reversed")
"""Functions of one argument that are left out."""
SETTINGS = ("strict", "cutoff", "dtype", "copy", "default_factory", "cache", "stacklevel")
"""Keyword arguments that say how and not what."""
NOT_ENTERED = (ast.Raise, ast.Assert, ast.JoinedStr, ast.Import, ast.ImportFrom)
PRINTED = ("__repr__", "__str__")


@dataclass(frozen=True)
class Mutation:
    """One edit: the text between two offsets [characters] of a file is replaced."""

    file: str
    """From the package's folder, such as ``audit/rest.py``."""
    line: int
    start: int
    end: int
    text: str

    def of(self, source: str) -> str:
        """The file with the edit made."""
        return source[:self.start] + self.text + source[self.end:]

    def shown(self, source: str) -> tuple[str, str]:
        """The lines it touches before and after, with plain spaces: its name, wherever it moves."""
        first = source.rfind("\n", 0, self.start) + 1
        last = (source + "\n").find("\n", self.end)
        after = source[first:self.start] + self.text + source[self.end:last]
        return " ".join(source[first:last].split()), " ".join(after.split())


class _Finder:
    """Goes through a file's tree and gathers the mutations of every node."""

    def __init__(self, file: str, source: str) -> None:
        self.file, self.source = file, source
        self.starts = [0]
        for line in source.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))
        self.lines = source.splitlines(keepends=True)

    def places(self) -> list[list[Mutation]]:
        """Of every node that has any: its mutations."""
        each = [[Mutation(self.file, node.lineno, start, end, text)
                 for start, end, text in self._edits(node)]
                for node in self._nodes(ast.parse(self.source))]
        return [mutations for mutations in each if mutations]

    def _nodes(self, node: ast.AST) -> Iterator[ast.expr | ast.stmt | ast.comprehension]:
        """All nodes below ``node`` that count, in the order of the text."""
        if isinstance(node, NOT_ENTERED) or (
                isinstance(node, ast.FunctionDef) and node.name in PRINTED):
            return
        if isinstance(node, ast.expr | ast.stmt):
            yield node
        for name, value in ast.iter_fields(node):
            if name in ("annotation", "returns", "decorator_list"):
                continue
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.keyword) and child.arg in SETTINGS:
                    continue
                if isinstance(child, ast.AST) and not _is_text(child):
                    yield from self._nodes(child)

    # -- edits ----------------------------------------------------------------------------

    def _at(self, line: int, column: int) -> int:
        """Offset in characters of a place that the tree gives in bytes."""
        return self.starts[line - 1] + len(self.lines[line - 1].encode()[:column].decode())

    def _span(self, node: ast.expr | ast.stmt) -> tuple[int, int]:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return (self._at(node.lineno, node.col_offset),
                self._at(node.end_lineno, node.end_col_offset))

    def _edits(self, node: ast.AST) -> Iterator[tuple[int, int, str]]:
        match node:
            case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
                if not _joins(left) and not _joins(right):
                    yield from self._between(left, right, *OPERATORS[type(op)])
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                sign, others = COMPARISONS[type(op)]
                for other in others:
                    yield from self._between(left, right, sign, other)
            case ast.BoolOp(op=op, values=[first, second, *_]):
                words = ("and", "or") if isinstance(op, ast.And) else ("or", "and")
                yield from self._between(first, second, *words)
            case ast.UnaryOp(op=ast.USub() | ast.Not() | ast.Invert(), operand=operand):
                yield self._span(node)[0], self._span(operand)[0], ""
            case ast.Constant(value=bool() as value):
                yield *self._span(node), str(not value)
            case ast.Constant(value=int() | float() as value):
                yield *self._span(node), _other_number(value)
            case ast.Call():
                yield from self._called(node)
            case ast.If(test=test) | ast.While(test=test) | ast.IfExp(test=test):
                start, end = self._span(test)
                yield start, end, f"(not ({self.source[start:end]}))"
            case ast.Slice(upper=ast.expr() as upper) if not isinstance(upper, ast.Constant):
                yield self._span(upper)[1], self._span(upper)[1], " - 1"
            case ast.AugAssign(target=target, op=op, value=value) if type(op) in OPERATORS:
                sign, other = OPERATORS[type(op)]
                yield from self._between(target, value, f"{sign}=", f"{other}=")
            case ast.Expr(value=ast.Call()):
                yield *self._span(node), "None"
            case ast.Continue() | ast.Break():
                yield *self._span(node), "pass"
            case _:
                return

    def _called(self, node: ast.Call) -> Iterator[tuple[int, int, str]]:
        name = node.func.attr if isinstance(node.func, ast.Attribute) else (
            node.func.id if isinstance(node.func, ast.Name) else "")
        end = self._span(node.func)[1]
        if name in NAMES:
            yield end - len(name), end, NAMES[name]
        if name in DROPPED and len(node.args) == 1 and not isinstance(node.args[0], ast.Starred):
            start, stop = self._span(node.args[0])
            yield *self._span(node), f"({self.source[start:stop]})"
        if name == "range" and node.args:
            last = self._span(node.args[-1] if len(node.args) < 3 else node.args[1])[1]
            yield last, last, " - 1"

    def _between(
        self, left: ast.expr, right: ast.expr, sign: str, other: str,
    ) -> Iterator[tuple[int, int, str]]:
        """The operator between two nodes; none where a comment stands there, too."""
        start, end = self._span(left)[1], self._span(right)[0]
        gap = self.source[start:end]
        found = re.search(r"\s+".join(map(re.escape, sign.split())), gap)
        if found and "#" not in gap:
            yield start + found.start(), start + found.end(), other


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _joins(node: ast.expr) -> bool:
    """Whether an operand is no number: a text, a list, a type among types."""
    return (_is_text(node) or isinstance(node, ast.JoinedStr | ast.List | ast.Tuple | ast.Dict)
            or (isinstance(node, ast.Name) and node.id[:1].isupper() and not node.id.isupper())
            or (isinstance(node, ast.Constant) and node.value is None)
            or (isinstance(node, ast.BinOp) and (_joins(node.left) or _joins(node.right))))


def _other_number(value: int | float) -> str:
    if isinstance(value, int):
        return str(value + 1)
    return "1.0" if value == 0 else repr(value * 1.1)


def places(package: Path, rooms: list[str]) -> list[list[Mutation]]:
    """All places in the files of ``rooms``, which are folders or files of the package."""
    found = []
    for room in rooms:
        root = package / room
        for path in [root] if root.is_file() else sorted(root.rglob("*.py")):
            found += _Finder(path.relative_to(package).as_posix(), path.read_text()).places()
    return found


def sample(package: Path, rooms: list[str], seed: int, count: int) -> list[Mutation]:
    """``count`` places drawn from all (0: all of them), one mutation each, in the files' order.

    The same seed and sources give the same mutants. What would be no Python is left out.
    """
    draw = random.Random(seed)
    found = places(package, rooms)
    chosen = [draw.choice(each) for each in draw.sample(found, len(found))]
    kept: list[Mutation] = []
    for mutation in chosen:
        if len(kept) == count > 0:
            break
        try:
            compile(mutation.of((package / mutation.file).read_text()), mutation.file, "exec")
        except SyntaxError:
            continue
        kept.append(mutation)
    return sorted(kept, key=lambda one: (one.file, one.start, one.text))
