"""Which bodies act on each other: by joints, cords, springs, or where they may touch."""

from __future__ import annotations

import numpy as np

from sandbox.model.model import Model
from sandbox.numeric import Flags, Integers


def linked(model: Model, *, springs: bool = False, contacts: Flags | None = None) -> Flags:
    """Which free bodies joints and cords link, springs if asked, and pairs that may touch.

    Those, ``contacts``, are :func:`sandbox.model.pairs.allowed_pairs`; all are [nb, nb].
    """
    tendons, free = model.tendons, model.bodies.free
    found = np.zeros((len(free), len(free)), dtype=bool)
    for pairs in (model.joints.bodies, *([model.springs.bodies] if springs else [])):
        found[pairs[:, 0], pairs[:, 1]] = found[pairs[:, 1], pairs[:, 0]] = True
    for tendon in range(len(tendons.name)):
        guides = tendons.guide_body[tendons.guides(tendon)]
        found[np.ix_(guides, guides)] = True
    if contacts is not None:
        shaped = np.array([bool(body.shapes) for body in model.mechanism.bodies])
        found |= contacts & shaped & shaped[:, None]
    result: Flags = found & free & free[:, None]
    return result


def groups(model: Model, links: Flags) -> list[Integers]:
    """The free bodies gathered by what links them [nb, nb], each group in order."""
    left, found = model.bodies.free.copy(), []
    while left.any():
        group = np.zeros(len(left), dtype=bool)
        group[left.argmax()] = True
        new = group
        while new.any():
            new = links[new].any(axis=0) & ~group
            group = group | new
        found.append(np.flatnonzero(group))
        left &= ~group
    return found
