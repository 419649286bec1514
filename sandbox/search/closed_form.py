"""A closed form of what was varied, held against what runs answered: it is to hold where > 0."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.numeric import Array
from sandbox.scene.read.load import read_scene
from sandbox.scene.values.expressions import (
    CONSTANTS,
    Expression,
    parse_expression,
    unknown_name,
)
from sandbox.search.criteria import RefusedError
from sandbox.search.question import Question
from sandbox.wording import WrongValueError, quoted

_LAST = re.compile(r"(?:^|\.)([A-Za-z_]\w*)$")


@dataclass(frozen=True)
class ClosedForm:
    """An expression of varied paths, by their last words, and of the scene's parameters."""

    text: str
    expression: Expression
    names: Mapping[str, str]
    """The path of each name that is varied."""
    parameters: Mapping[str, float]

    def at(self, numbers: Mapping[str, Any]) -> Array:
        """Its value at numbers [SI] of the paths, of any shapes; nan where it has none."""
        given = {name: numbers[path] for name, path in self.names.items() if path in numbers}
        found = self.expression.evaluate({**self.parameters, **given}, finite=False)
        return np.asarray(np.broadcast_arrays(found, *given.values())[0], dtype=float)


def closed_form(text: str, question: Question) -> ClosedForm:
    """A closed form from its words.

    Args:
        text: ``"mu - tan(angle)"``, of ``parameters.mu`` and ``bodies[block].angle``.
        question: what is varied.

    Raises:
        RefusedError: no expression, a name that is neither varied nor a parameter, or a parameter
            that changes with what is varied.
    """
    names: dict[str, str] = {}
    for path in question.space.paths:
        if match := _LAST.search(path):
            names.setdefault(match[1], path)
    parameters = question.plan.loaded.scene.parameters
    known = {**parameters, **dict.fromkeys(names, 1.0)}
    try:
        expression = parse_expression(text)
        for name in sorted(expression.names - known.keys()):
            raise unknown_name(name, known)
        expression.check_tables(known)
    except WrongValueError as error:
        raise RefusedError(f"the closed form: {error}") from None
    low, high = (_parameters(question, share) for share in (0.0, 1.0))
    for name in sorted(expression.names - names.keys() - CONSTANTS.keys()):
        if low[name] != high[name]:
            raise RefusedError(f"the closed form: {quoted(name)} follows from what is varied; "
                               "write it out in its place")
    return ClosedForm(text, expression, names, parameters)


def _parameters(question: Question, share: float) -> Mapping[str, float]:
    """The scene's parameters where all paths are at a share of their ways."""
    job = question.plan.job
    point, = question.space.points([[share] * len(question.space.paths)])
    with job.bundle.unpacked() as scene:
        return read_scene(scene, overrides={**job.set, **point}, limits=job.limits).scene.parameters
