"""Scenes of n things of one kind, right and wrong ones: ``SCENES[kind](n)`` is a file's text."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

Text = Callable[[int], str]
FRAME = {"name": "frame", "motion": "fixed"}


def _body(name: str, x: float, y: float = 0.0, **more: Any) -> dict[str, Any]:
    return {"name": name, "at": [x, y], "mass": 0.1,
            "shapes": [{"type": "circle", "radius": 0.01}], **more}


def _row(n: int, apart: float = 0.05) -> list[dict[str, Any]]:
    """Discs side by side."""
    return [_body(f"disc{i}", apart * i) for i in range(n)]


def _chain(n: int) -> dict[str, Any]:
    bodies = [FRAME, *({"name": f"link{i}", "at": [0.05 * i, 0], "mass": 0.1, "shapes": [
        {"type": "capsule", "end": [0.05, 0], "radius": 0.005}]} for i in range(n))]
    joints = [{"type": "pin", "name": f"pin{i}", "a": f"link{i - 1}" if i else "frame",
               "b": f"link{i}", "on_b": [0, 0]} for i in range(n)]
    return {"bodies": bodies, "joints": joints}


def _two() -> list[dict[str, Any]]:
    return [FRAME, _body("disc", 0.1)]


def _finger(name: str, **more: Any) -> dict[str, Any]:
    return {"type": "finger", "name": name, "lengths": [0.04, 0.03], "radii": [0.008, 0.008],
            "masses": [0.01, 0.01], "guides": [[-0.02, -0.01], [0.01, -0.01], [0.01, -0.01]],
            **more}


def _fingers(n: int) -> list[dict[str, Any]]:
    return [_finger(f"finger{i}", at=[0.0, 0.1 * i]) for i in range(n)]


def _drives(n: int) -> list[dict[str, Any]]:
    return [{"type": "force", "name": f"push{i}", "body": "disc", "direction": [1, 0], "value": 1}
            for i in range(n)]


_TYPES: dict[str, Callable[[int], Any]] = {
    # right
    "bodies": lambda n: {"bodies": _row(n)},
    "chain": _chain,
    "discs in one place": lambda n: {"bodies": _row(n, 0.0)},
    "cords of a row": lambda n: {"bodies": _row(n), "tendons": [
        {"name": f"c{i}", "guides": [{"body": f"disc{i}"}, {"body": f"disc{i + 1}"}]}
        for i in range(n - 1)]},
    "drives": lambda n: {"bodies": _two(), "drives": _drives(n)},
    "controllers": lambda n: {"bodies": _two(), "drives": _drives(n), "controllers": [
        {"type": "pid", "name": f"law{i}", "reads": "disc.x", "target": 0, "kp": 1,
         "writes": f"push{i}"} for i in range(n)]},
    "feedback that reads all before": lambda n: {
        "bodies": _two(), "drives": _drives(n), "controllers": [
            {"type": "feedback", "name": f"law{i}", "writes": f"push{i}", "value": "+".join(
                ["=disc.x", *(f"push{k}.value" for k in range(max(0, i - 40), i))])}
            for i in range(n)]},
    "events": lambda n: {"bodies": _two(), "drives": _drives(1), "events": [
        {"name": f"e{i}", "when": f"=disc.x > {i}", "set": {"push0": 1}} for i in range(n)]},
    "meters of meters": lambda n: {"bodies": _two(), "meters": [
        {"name": f"m{i}", "value": f"=m{i - 1} + 1" if i else "=disc.x"} for i in range(n)]},
    "expectations by pattern": lambda n: {"bodies": _row(n), "expect": [
        {"mean": "disc*.x", "above": i} for i in range(n)]},
    "expectations of pairs": lambda n: {"bodies": _row(n), "expect": [
        {"mean": "disc1*/disc*.normal", "above": i} for i in range(n)]},
    "contact rules of all": lambda n: {"bodies": _row(n), "contacts": [
        {"between": ["*", f"disc{i}"], "collide": False} for i in range(n)]},
    "large groups": lambda n: {"bodies": _row(n), "groups": [
        {"name": "g", "bodies": [f"disc{i}" for i in range(n)]}]},
    "parameters in rings": lambda n: {"bodies": _two(), "parameters": {
        f"p{i}": f"=p{(i + 1) % n}" for i in range(n)}},
    "long expressions": lambda n: {
        "parameters": {"load": 1}, "bodies": _two(),
        "expect": [{"mean": "disc.x", "above": "=" + "+".join(["load"] * 150) + f"+{i}"}
                   for i in range(n // 20)]},
    "templates in chains": lambda n: {
        "templates": {"t0": _finger("x"), **{f"t{i}": {"like": f"t{i - 1}"}
                                             for i in range(1, n)}},
        "parts": [{"name": f"f{i}", "like": f"t{n - 1}"} for i in range(n // 2)]},
    "fingers": lambda n: {"parts": _fingers(n // 4)},
    "fingers on one palm": lambda n: {"bodies": [{"name": "palm", "mass": 1, "shapes": [
        {"type": "circle", "radius": 0.001}]}], "parts": [
        {**each, "on": "palm"} for each in _fingers(n // 4)]},
    "a tree": lambda n: {"parts": [*_fingers(n // 4), {
        "type": "pulley_tree", "name": "tree", "pitch": 0.01, "at": [1, 0],
        "pulls": [f"finger{i}" for i in range(n // 4)]}]},
    # wrong
    "unknown keys": lambda n: {"bodies": _two(), **{f"key{i}": 1 for i in range(n)}},
    "wrong values": lambda n: {"bodies": [{**each, "mass": "heavy"} for each in _row(n)]},
    "parts that cannot be built": lambda n: {"parts": [
        {**each, "on": f"nobody{i}"} for i, each in enumerate(_fingers(n // 4))]},
    "wrong references": lambda n: {"bodies": _row(n), "joints": [
        {"type": "pin", "name": f"j{i}", "a": f"dsc{i}", "b": f"disk{i}", "on_a": [0, 0]}
        for i in range(n)]},
    "wrong expectations": lambda n: {"bodies": _row(n), "expect": [
        {"mean": f"dsc{i}.x", "above": 1} for i in range(n)]},
    "wrong parameters": lambda n: {"bodies": _two(), "parameters": {
        f"p{i}": f"=q{i}" for i in range(n)}},
    "one name for all": lambda n: {"bodies": [_body("b", 0.05 * i) for i in range(n)]},
}


def _written(data: Callable[[int], Any]) -> Text:
    return lambda n: json.dumps(data(n))


SCENES: dict[str, Text] = {kind: _written(data) for kind, data in _TYPES.items()} | {
    "one key again and again": lambda n: "{" + ", ".join(['"title": 1'] * n) + "}",
    "NaN": lambda n: '{"bodies": [' + ", ".join(["NaN"] * n) + "]}",
    "brackets": lambda n: '{"title": ' + "[" * n,
    "backslashes": lambda n: '{"title": "' + "\\\\" * 20 * n,
    "a number of many digits": lambda n: '{"bodies": [' + "1" * 40 * n + "]}",
    "long keys": lambda n: '{"' + "k" * 10 * n + '": {"a": NaN, "b": NaN, "c": [NaN, NaN]}}',
}
