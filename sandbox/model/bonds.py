"""Elements that can be released: joints, springs and tendons, by number; when they hold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sandbox.elements.element import HELD_ABOVE, NAMED, RELEASABLE
from sandbox.numeric import Array, Flags, Integers
from sandbox.scene.mechanism import Mechanism
from sandbox.values.signals import values


@dataclass(frozen=True)
class Bonds:
    """nr joints, springs and tendons that can be released, in this order."""

    name: tuple[str, ...]
    joint: Integers
    """Of every joint its number among these, or -1, [nj]."""
    spring: Integers
    """Of every spring, [ns]."""
    tendon: Integers
    """Of every tendon, [nt]."""
    breaks_at: Array
    """Breaking load of each [N, of a rotary spring N m], [nr]; infinite without."""
    held: Flags
    """Which hold at t = 0, [nr]."""
    as_is: Flags
    """Which are engaged with the length that they have then, [nr]."""
    drive: Integers
    """The drive that holds each, or -1, [nr]."""
    over: Array
    """Time constant of closing a joint's gap [s], [nr]; 0 of others."""

    def of(self, kind: str) -> Integers:
        """Of every ``joint``, ``spring`` or ``tendon`` its number among these, or -1."""
        return {"joint": self.joint, "spring": self.spring, "tendon": self.tendon}[kind]

    def element(self, number: int) -> tuple[str, int]:
        """The list of :data:`RELEASABLE` of an element with this number, and its place there."""
        kind = next(kind for kind in RELEASABLE if number in self.of(NAMED[kind].one))
        return kind, self.of(NAMED[kind].one).tolist().index(number)

    def begins(self, number: int) -> bool:
        """Whether the element with this number, or -1, holds at t = 0."""
        return bool(number < 0 or self.held[number])


def compile_bonds(mechanism: Mechanism) -> Bonds:
    """The releasable elements of a mechanism."""
    place = {name: number for number, name in enumerate(mechanism.releasable)}
    specs = [each for each in mechanism.holding if each.name in place]

    drives = {drive.target[1]: (i, drive) for i, drive in enumerate(mechanism.drives)
              if drive.kind.gives == "hold"}

    def driven(name: str) -> bool:
        """Whether it holds at t = 0 by its drive, or has no drive."""
        if name not in drives:
            return True
        return bool(values(drives[name][1].value, np.zeros(1), mechanism.functions)[0] > HELD_ABOVE)

    def of(among: str) -> Integers:
        return np.array([place.get(each.name, -1) for each in getattr(mechanism, among)],
                        dtype=np.int64)

    return Bonds(
        tuple(place), of("joints"), of("springs"), of("tendons"),
        np.array([np.inf if each.breaks_at is None else each.breaks_at for each in specs],
                 dtype=float),
        np.array([not each.released and driven(each.name) for each in specs], dtype=bool),
        np.array([getattr(each, "taken_up", "") == "as_is" for each in specs], dtype=bool),
        np.array([drives[each.name][0] if each.name in drives else -1 for each in specs],
                 dtype=np.int64),
        np.array([getattr(each, "takes_up_in", 0.0) for each in specs], dtype=float))


def held_of(bonds: Integers, held: Array | Integers) -> Flags:
    """Which elements hold in which samples, [elements, n].

    Args:
        bonds: their numbers in :class:`Bonds`, or -1.
        held: as recorded, [n, nr]; an element that was not recorded holds.
    """
    return np.array([held_one(bond, held) for bond in bonds.tolist()], dtype=bool).reshape(
        len(bonds), len(held))


def held_one(bond: int, held: Array | Integers) -> Flags:
    """In which samples one element holds, [n]; arguments as of :func:`held_of`."""
    return np.asarray(held[:, bond] != 0.0 if bond >= 0 else np.ones(len(held), dtype=bool))
