"""Which bodies may touch, turned into pymunk's shape filters.

pymunk knows a group number (same group: no contact) and 32 category bits. A
finger's own links become a group; bodies that meet the same others share a
category. That is exact up to 32 kinds of body, however many bodies there are;
pairs beyond that are told apart when contacts are listed.
"""

from __future__ import annotations

import fnmatch
import re
from dataclasses import dataclass

import numpy as np

from sandbox.model.model import Model
from sandbox.numeric import Array, Flags, Integers
from sandbox.scene.elements.bodies import Material
from sandbox.scene.elements.settings import ContactRule
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.values.planes import ALL

CATEGORIES = 32
LARGE = 16
"""Share of all pairs, as 1 in so many, from which a rule is written by a mask of them all."""


@dataclass(frozen=True)
class Filters:
    """Per body, in mechanism order: group, category bits, mask; and what filters can't say.

    ``allowed`` is the matrix of pairs that may touch, ``friction`` and ``restitution`` hold
    the coefficients of all pairs, each of shape [nb, nb].
    """

    group: Integers
    category: Integers
    mask: Integers
    allowed: Flags
    friction: Array
    restitution: Array


class _Words:
    """The bodies that words of rules mean, each worked out once."""

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
        if len(a) * len(b) * LARGE < len(table) ** 2:
            table[np.ix_(a, b)] = table[np.ix_(b, a)] = value
            return
        some, others = (np.isin(np.arange(len(table)), places) for places in (a, b))
        np.copyto(table, value, where=some[:, None] & others)
        if rule.between[0] != rule.between[1]:
            np.copyto(table, value, where=others[:, None] & some)


def allowed_pairs(model: Model) -> Flags:
    """Which bodies may touch which, shape [nb, nb]: rules in order, then planes and joints."""
    words = _Words(model.bodies.name)
    allowed = ~np.eye(len(words.names), dtype=bool)
    for rule in model.mechanism.contacts:
        words.fill(allowed, rule, rule.collide)
    allowed &= _in_one_plane(model.mechanism)
    i, j = _joined(model)
    allowed[i, j] = allowed[j, i] = False
    rests = ~model.bodies.free
    allowed[np.ix_(rests, rests)] = False
    np.fill_diagonal(allowed, False)
    return allowed


def _in_one_plane(mechanism: Mechanism) -> Flags:
    """Which bodies share a plane, shape [nb, nb]."""
    planes = [body.plane for body in mechanism.bodies]
    known = {number: place for place, number in enumerate(
        {number for those in planes if those != ALL for number in those})}
    lies = np.zeros((len(planes), len(known) + 1), dtype=np.float32)
    for row, those in zip(lies, planes, strict=True):
        row[[len(known)] if those == ALL else [known[number] for number in those]] = 1.0
    everywhere = lies[:, -1] > 0
    shared: Flags = (lies[:, :-1] @ lies[:, :-1].T) > 0
    return shared | everywhere[:, None] | everywhere


def _joined(model: Model) -> tuple[Integers, Integers]:
    """The two bodies of every joint that keeps them from touching."""
    joints = model.joints
    return joints.bodies[~joints.collide, 0], joints.bodies[~joints.collide, 1]


def make_filters(model: Model) -> Filters:
    """Filters for every body of a model."""
    mechanism, words = model.mechanism, _Words(model.bodies.name)
    count = len(words.names)
    allowed = allowed_pairs(model)
    settled = np.eye(count, dtype=bool)  # pairs that need no category: told apart otherwise
    rests = ~model.bodies.free
    settled[np.ix_(rests, rests)] = True
    i, j = _joined(model)
    settled[i, j] = settled[j, i] = True
    group = np.zeros(count, dtype=np.int64)
    for number, rule in enumerate(mechanism.contacts, start=1):
        if rule.collide or rule.between[0] != rule.between[1]:
            continue
        members = words(rule.between[0])
        block = np.ix_(members, members)
        if len(members) > 1 and not group[members].any() and not allowed[block].any():
            group[members] = number
            settled[block] = True
    rows = allowed | settled
    kinds, kind = _kinds(rows)
    bits = np.left_shift(np.int64(1), kind) if kinds <= CATEGORIES else np.ones_like(kind)
    mask = np.ones(count, dtype=np.int64)  # beyond that all meet, and are told apart later
    if kinds <= CATEGORIES:
        mask = np.array(
            [np.bitwise_or.reduce(bits[row], initial=0) for row in rows], dtype=np.int64)
    return Filters(group, bits, mask, allowed, *_pair_materials(mechanism, words))


def _kinds(rows: Flags) -> tuple[int, Integers]:
    """How many different rows there are, and which kind each is, shape [nb]."""
    if not len(rows):
        return 0, np.zeros(0, dtype=np.int64)
    kinds, kind = np.unique(rows, axis=0, return_inverse=True)
    return len(kinds), np.reshape(kind, -1).astype(np.int64)


def _pair_materials(mechanism: Mechanism, words: _Words) -> tuple[Array, Array]:
    """Friction and restitution of all pairs: the geometric mean, unless a rule says otherwise."""
    materials = [mechanism.materials.get(body.material or "", Material())
                 for body in mechanism.bodies]
    roots = np.sqrt([[m.friction, m.restitution] for m in materials]).reshape(-1, 2)
    friction, restitution = (roots[:, None, n] * roots[None, :, n] for n in range(2))
    for rule in mechanism.contacts:
        if rule.friction is not None:
            words.fill(friction, rule, rule.friction)
    return friction, restitution
