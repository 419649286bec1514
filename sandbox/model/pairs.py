"""Which bodies may touch which: contact rules in order, then planes and joints."""

from __future__ import annotations

import fnmatch
import math
import re
from fnmatch import fnmatchcase

import numpy as np

from sandbox.model.model import Model
from sandbox.numeric import Array, Flags, Integers
from sandbox.scene.bodies import Material
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.settings import ContactRule
from sandbox.values.appearance import ALL


class Words:
    """The bodies that words of rules mean, each computed once."""

    def __init__(self, names: tuple[str, ...]) -> None:
        self.names, self._found = names, {name: np.array([i]) for i, name in enumerate(names)}

    def __call__(self, word: str) -> Integers:
        """The places of the bodies whose name a word is, or fits."""
        if word not in self._found:
            fits = re.compile(fnmatch.translate(word)).match
            self._found[word] = np.array(
                [i for i, name in enumerate(self.names) if fits(name)], dtype=np.int64)
        return self._found[word]

    def fill(self, table: Array | Flags, rule: ContactRule, value: float | bool) -> None:
        """Set the pairs of a rule in a table of all pairs, [nb, nb]."""
        a, b = (self(word) for word in rule.between)
        table[np.ix_(a, b)] = table[np.ix_(b, a)] = value


def allowed_pairs(model: Model) -> Flags:
    """Which bodies may touch which, shape [nb, nb]: rules in order, then planes and joints."""
    words = Words(model.bodies.name)
    allowed = ~np.eye(len(words.names), dtype=bool)
    for rule in model.mechanism.contacts:
        words.fill(allowed, rule, rule.collide)
    planes = [body.plane for body in model.mechanism.bodies]
    known = list({number for those in planes if those != ALL for number in those})
    everywhere = np.array([those == ALL for those in planes], dtype=bool)
    lies = np.array([[those != ALL and number in those for number in known] for those in planes],
                    dtype=np.float32).reshape(len(planes), len(known))
    allowed &= (lies @ lies.T > 0) | everywhere[:, None] | everywhere
    i, j = joined(model)
    allowed[i, j] = allowed[j, i] = False
    rests = ~model.bodies.free
    allowed[np.ix_(rests, rests)] = False
    np.fill_diagonal(allowed, False)
    return allowed


def joined(model: Model) -> tuple[Integers, Integers]:
    """The two bodies of every joint that keeps them from touching."""
    joints = model.joints
    return joints.bodies[~joints.collide, 0], joints.bodies[~joints.collide, 1]


def friction_of(mechanism: Mechanism, one: int, two: int) -> float:
    """Coefficient of sliding friction of two bodies."""
    return _of_pair(mechanism, one, two, "friction")


def static_friction_of(mechanism: Mechanism, one: int, two: int) -> float:
    """Coefficient of static friction of two bodies."""
    return friction_of(mechanism, one, two) * _of_pair(mechanism, one, two, "static")


def restitution_of(mechanism: Mechanism, one: int, two: int) -> float:
    """Rebound speed over approach speed of two bodies."""
    return _of_pair(mechanism, one, two, "restitution")


def _of_pair(mechanism: Mechanism, one: int, two: int, field: str) -> float:
    """Of the last rule that names two bodies and the field, else the mean of their materials."""
    bodies = mechanism.bodies
    names = bodies[one].name, bodies[two].name
    for rule in reversed(mechanism.contacts):
        value: float | None = getattr(rule, field, None)
        if value is not None and any(all(map(fnmatchcase, pair, rule.between))
                                     for pair in (names, names[::-1])):
            return value
    a, b = (getattr(mechanism.materials.get(bodies[i].material or "", Material()), field)
            for i in (one, two))
    return math.sqrt(a) * math.sqrt(b)


def pair_skins(mechanism: Mechanism) -> Array:
    """Stiffness [N/m] and damping [N s/m] of the soft contacts of all pairs, [2, nb, nb].

    0 of two rigid surfaces; [2, 0, 0] if all are. Two skins are in series, with one force.
    """
    skins = [mechanism.materials.get(body.material or "", Material()).skin
             for body in mechanism.bodies]
    if not any(skins):
        return np.zeros((2, 0, 0))
    yielding = np.array([1 / skin.stiffness if skin else 0.0 for skin in skins])
    loss = np.array([skin.damping / skin.stiffness**2 if skin else 0.0 for skin in skins])
    total = yielding[:, None] + yielding
    stiffness = np.divide(1.0, total, out=np.zeros_like(total), where=total > 0)
    return np.stack([stiffness, stiffness**2 * (loss[:, None] + loss)])
