"""Measures of how an object is held that no hand can ever hold."""

from __future__ import annotations

from collections.abc import Iterator
from fnmatch import fnmatchcase

import numpy as np

from sandbox.elements.quantities import GRASP
from sandbox.engine.inspect_words import look
from sandbox.errors import Problem
from sandbox.model.catalogue import grasp_of
from sandbox.model.meters import names_read
from sandbox.model.model import Model
from sandbox.numeric import Flags
from sandbox.samples.grasps import OF_HANDS, of_hand
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import is_pattern, listed


def grasp_problems(model: Model, allowed: Flags) -> Iterator[Problem]:
    """Expectations and meters of them; ``allowed`` says which bodies may touch, [nb, nb]."""
    mechanism = model.mechanism
    hand = np.array([bool(of_hand(body) and body.shapes) for body in mechanism.bodies], dtype=bool)
    alone = {body.name for i, body in enumerate(mechanism.bodies)
             if grasp_of(body) and not (allowed[i] & hand).any()}
    for path, name in _asked(mechanism) if alone else ():
        body, _, quantity = name.rpartition(".")
        for each in sorted(alone) if is_pattern(body) else [body] if body in alone else []:
            if fnmatchcase(each, body) and any(fnmatchcase(one, quantity) for one in GRASP):
                yield look("no-effect", path, each, f"measures the grasp of {each}, but no part of "
                           "a hand can touch it", "a body that moves, or one with a role such as "
                           f"{listed(OF_HANDS[:2])}, and contact rules that let it")
                break


def _asked(mechanism: Mechanism) -> Iterator[tuple[str, str]]:
    """What expectations and meters read, names and patterns, with their paths."""
    for i, expect in enumerate(mechanism.expect):
        yield f"$.expect[{i}].{expect.key}", expect.quantity
    for i, meter in enumerate(mechanism.meters):
        for name in sorted(names_read(meter)):
            yield f"$.meters[{i}].value", name
