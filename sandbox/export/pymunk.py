"""A mechanism as a Python script that needs pymunk alone."""

from __future__ import annotations

import ast
import inspect
import math
from collections.abc import Sequence
from typing import Any

import sandbox
from sandbox.engine import pymunk_scene
from sandbox.engine.pymunk_draft import (
    Call,
    Formula,
    PymunkDraft,
    scene_arguments,
    time_step,
)
from sandbox.export.selection import leave_out
from sandbox.scene.mechanism import Mechanism

ALWAYS = ("Scene", "__init__", "step", "contacts")
"""Definitions of :mod:`sandbox.engine.pymunk_scene` that every script contains."""
FORMULAS = """from math import *
sign = lambda x: (x > 0) - (x < 0)
clip = lambda x, low, high: min(max(x, low), high)
"""  # What formulas of a scene call besides Python's own functions
MAIN = '''

def draw(scene):
    """Show the scene by pymunk's debug drawing, in a window of pygame."""
    import pygame
    from pymunk.pygame_util import DrawOptions
    boxes = [shape.bb for shapes in scene.shapes.values() for shape in shapes]
    left, top = min(box.left for box in boxes), max(box.top for box in boxes)
    size = max(max(box.right for box in boxes) - left, top - min(box.bottom for box in boxes))
    screen, zoom = pygame.display.set_mode((800, 800)), 800 / size
    options = DrawOptions(screen)
    options.transform = pymunk.Transform(zoom, 0, 0, -zoom, -zoom * left, zoom * top)
    screen.fill("white")
    scene.space.debug_draw(options)
    pygame.event.pump()
    pygame.display.flip()


if __name__ == "__main__":
    while scene.steps < STEPS:
        scene.step()
        if "--draw" in sys.argv and scene.steps % max(round(0.04 / scene.h), 1) == 0:
            draw(scene)
    for name, body in scene.bodies.items():
        print(name, *body.position, body.angle)
    for name, tendon in scene.tendons.items():
        print(name, tendon.tension)
    for (one, other), force in scene.contacts().items():
        print(f"{one}/{other}", *force)
'''


def write_script(
    mechanism: Mechanism, without: Sequence[str] = (),
) -> tuple[str, tuple[str, ...], tuple[str, ...]]:
    """The text of a script, notes on differences, and names of elements left out.

    Raises:
        SceneError: elements without a counterpart, or names in ``without`` that fit no element.
    """
    kept, left_out = leave_out(mechanism, without)
    draft = PymunkDraft(kept)
    calls = [f"scene.{_text(call)}" for call in draft.calls]
    first = f"scene = Scene({', '.join(map(_text, scene_arguments(kept)))})"
    title = _plain(kept.title or kept.name or "A mechanism")
    head = f'"""{title}; written by sandbox {sandbox.__version__}. SI units."""'
    steps = f"STEPS = {max(1, math.ceil(kept.run.duration / time_step(kept) - 1e-9))}"
    maths = FORMULAS if any("lambda t:" in call for call in calls) else ""
    return "\n".join([
        f"{head}\n{maths}{_definitions(ast.parse(first + chr(10) + chr(10).join(calls)))}\n",
        first, *calls, f"{steps}\n{MAIN}"]), (), left_out


def _text(value: Any) -> str:
    """An argument or a call as Python."""
    match value:
        case Call():
            named = [f"{key}={_text(each)}" for key, each in value.settings.items()]
            return f"{value.name}({', '.join([*map(_text, value.arguments), *named])})"
        case Formula():
            return f"lambda t: {value.text.removeprefix('=')}"
        case tuple() | list():
            return f"({', '.join(map(_text, value))}{',' * (len(value) == 1)})"
        case float():
            number = repr(value).removesuffix(".0")
            return f"float({number!r})" if "inf" in number else number
    return ascii(value)


def _plain(text: str) -> str:
    """A text that ends no string."""
    return "".join(c if c.isprintable() and c not in '"\\' else " " for c in text)


def _definitions(calls: ast.AST) -> str:
    """What the calls use of :mod:`sandbox.engine.pymunk_scene`, without types."""
    tree = ast.parse(inspect.getsource(pymunk_scene))
    known = {node.name: node for node in ast.walk(tree) if isinstance(node, DEFINITIONS)}
    used, waiting = set[str](), {*ALWAYS, *_names(calls)} & known.keys()
    while waiting:
        used |= waiting
        waiting = {each for name in waiting for each in _names(known[name])} & known.keys() - used
    trimmed = ast.unparse(ast.fix_missing_locations(_Trimmed(used).visit(tree)))
    libraries = [f"import {name}" for name in ("cmath", "itertools", "math", "sys")]
    libraries += ["from bisect import bisect_right"] * ("bisect_right" in trimmed)
    return "\n".join([*libraries, "import pymunk", "from pymunk import Body, Vec2d", "", trimmed])


DEFINITIONS = (ast.FunctionDef, ast.ClassDef)


def _names(node: ast.AST) -> set[str]:
    """Functions that a node calls, and attributes; of a class none: methods are chosen singly."""
    if isinstance(node, ast.ClassDef):
        return {"__init__", "measure", "act"}
    return {each.attr if isinstance(each, ast.Attribute) else each.id for each in ast.walk(node)
            if isinstance(each, ast.Attribute | ast.Name)}


class _Trimmed(ast.NodeTransformer):
    """Leaves functions and methods that are used, without types and with short docstrings."""

    def __init__(self, used: set[str]) -> None:
        self.used = used

    def visit_Module(self, node: ast.Module) -> ast.AST:
        """Leave functions and classes."""
        node.body = [each for each in node.body if isinstance(each, DEFINITIONS)]
        return self.generic_visit(node)

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.AST | None:
        """Leave the methods that are used."""
        node.body = [each for each in node.body if not isinstance(each, ast.FunctionDef)
                     or each.name in self.used]
        return self._short(node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST | None:
        """Leave a function that is used, or is in another one."""
        if node.col_offset == 0 and node.name not in self.used:
            return None
        node.returns = None
        return self._short(node)

    def _short(self, node: ast.FunctionDef | ast.ClassDef) -> ast.AST:
        if text := ast.get_docstring(node):
            node.body[0] = ast.Expr(ast.Constant(text.split("\n\n")[0]))
        return self.generic_visit(node)

    def visit_arg(self, node: ast.arg) -> ast.AST:
        """Drop its type."""
        node.annotation = None
        return node

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AST:
        """Drop the type of a variable."""
        return ast.Assign([node.target], node.value or ast.Constant(None), lineno=node.lineno)
