"""Which elements that can be released are engaged in which samples."""

from __future__ import annotations

import numpy as np

from sandbox.numeric import Array, Flags, Integers


def held_of(bonds: Integers, held: Array | Integers) -> Flags:
    """Which elements are engaged in which samples, [elements, n].

    Args:
        bonds: their numbers in :class:`sandbox.model.model.Bonds`, or -1.
        held: as recorded, [n, nr]; an element that was not recorded is engaged.
    """
    return np.array([held_one(bond, held) for bond in bonds.tolist()], dtype=bool).reshape(
        len(bonds), len(held))


def held_one(bond: int, held: Array | Integers) -> Flags:
    """In which samples one element is engaged, [n]; arguments as of :func:`held_of`."""
    return np.asarray(held[:, bond] != 0.0 if bond >= 0 else np.ones(len(held), dtype=bool))
