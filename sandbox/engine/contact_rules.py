"""Which bodies may touch, turned into pymunk's shape filters.

pymunk knows a group number (same group: no contact) and 32 category bits. A
finger's own links become a group; bodies that meet the same others share a
category. That is exact up to 32 kinds of body, however many bodies there are;
pairs beyond that are told apart when contacts are listed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sandbox.model.model import Model
from sandbox.model.pairs import Words, allowed_pairs, joined
from sandbox.numeric import Array, Flags, Integers, Stack
from sandbox.scene.bodies import Material
from sandbox.scene.mechanism import Mechanism

CATEGORIES = 32


@dataclass(frozen=True)
class Filters:
    """Per body, in mechanism order: group, category bits, mask; and what filters can't say.

    ``allowed`` is the matrix of pairs that may touch, ``friction``, ``static`` and
    ``restitution`` hold the coefficients of all pairs, each of shape [nb, nb].
    """

    group: Integers
    category: Integers
    mask: Integers
    allowed: Flags
    friction: Array
    static: Array
    restitution: Array


def make_filters(model: Model) -> Filters:
    """Filters for every body of a model."""
    mechanism, words = model.mechanism, Words(model.bodies.name)
    count = len(words.names)
    allowed = allowed_pairs(model)
    settled = np.eye(count, dtype=bool)  # pairs that need no category: told apart otherwise
    rests = ~model.bodies.free
    settled[np.ix_(rests, rests)] = True
    i, j = joined(model)
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


def _pair_materials(mechanism: Mechanism, words: Words) -> Stack:
    """Friction, static and restitution of all pairs: geometric means, or what rules say, [3]."""
    materials = [mechanism.materials.get(body.material or "", Material())
                 for body in mechanism.bodies]
    roots = np.sqrt([[m.friction, m.static, m.restitution] for m in materials]).reshape(-1, 3).T
    found = np.ascontiguousarray(roots[:, :, None] * roots[:, None, :])
    for rule in mechanism.contacts:
        for table, value in zip(found, (rule.friction, rule.static), strict=False):
            if value is not None:
                words.fill(table, rule, value)
    return found
