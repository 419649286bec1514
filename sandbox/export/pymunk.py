"""A mechanism as a Python script that needs pymunk alone."""

from __future__ import annotations

import ast
import inspect
import math
from collections.abc import Sequence
from typing import Any

import sandbox
from sandbox.engine import pymunk_scene
from sandbox.engine.pymunk_draft import Call, Formula, PymunkDraft, scene_arguments, time_step
from sandbox.export.selection import Export, leave_out
from sandbox.scene.mechanism import Mechanism

# definitions of sandbox.engine.pymunk_scene that every script contains
ALWAYS = ("Scene", "__init__", "step", "contacts")
# functions in formulas of a scene besides Python's own
FORMULAS = """from math import *
sign = lambda x: (x > 0) - (x < 0)
clip = lambda x, low, high: min(max(x, low), high)
"""
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


def write_script(mechanism: Mechanism, without: Sequence[str] = ()) -> Export:
    """Write a Python script."""
    kept, left_out = leave_out(mechanism, without)
    draft = PymunkDraft(kept)
    calls = [f"scene.{_text(call)}" for call in draft.calls]
    first = f"scene = Scene({', '.join(map(_text, scene_arguments(kept)))})"
    title = "".join(c if c.isprintable() else " "
                    for c in kept.title or kept.name or "A mechanism")
    return Export("\n".join([
        f"# {title}; written by sandbox {sandbox.__version__}",
        _definitions(ast.parse("\n".join([first, *calls]))),
        "\nimport sys", *[FORMULAS] * any("lambda t:" in call for call in calls), first, *calls,
        f"STEPS = {max(1, math.ceil(kept.run.duration / time_step(kept) - 1e-9))}\n{MAIN}",
    ]), left_out=left_out)


def _text(value: Any) -> str:
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


DEFINITIONS = (ast.FunctionDef, ast.ClassDef)


def _definitions(calls: ast.AST) -> str:
    """The definitions of :mod:`sandbox.engine.pymunk_scene` that the calls use."""
    tree = ast.parse(inspect.getsource(pymunk_scene))
    known = {node.name: node for node in ast.walk(tree) if isinstance(node, DEFINITIONS)}
    used, waiting = set[str](), {*ALWAYS, *_names(calls)} & known.keys()
    while waiting:
        used |= waiting
        waiting = {each for name in waiting for each in _names(known[name])} & known.keys() - used
    for node in (tree, *known.values()):
        if not isinstance(node, ast.FunctionDef):
            node.body = [each for each in node.body
                         if not isinstance(each, DEFINITIONS) or each.name in used]
    return ast.unparse(tree)


def _names(node: ast.AST) -> set[str]:
    """Functions that a node calls, and attributes; of a class none: methods are chosen singly."""
    if isinstance(node, ast.ClassDef):
        return {"__init__", "measure", "act"}
    return {each.attr if isinstance(each, ast.Attribute) else each.id for each in ast.walk(node)
            if isinstance(each, ast.Attribute | ast.Name)}
