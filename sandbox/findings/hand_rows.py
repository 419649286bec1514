"""What sweeps of a four-finger hand kept, finger by finger, and the finger of closed forms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.mechanics.embrace import ClosingFinger
from sandbox.model.compile import compile_mechanism
from sandbox.numeric import Array, Flags
from sandbox.paper.hand_stiffness import free_fingers
from sandbox.scene.parts.finger import Finger
from sandbox.scene.read.load import read_scene
from sandbox.sweeps.table import SweepTable

FINGERS = 4
PHALANGES, HINGES = ("proximal", "middle", "distal"), ("mcp", "pip", "dip")
RAMP = 0.5
"""In which the pull grows in the scenes [s]."""
PRESSES = 0.01
"""What presses with less is no contact [N]: a hundredth of the least force that matters here."""
STILL = 0.01
"""A finger whose joints together turn faster than this is not at rest [rad/s]."""

AT_REST = 1e-6
"""Torque left over above which the closed form found no rest [N m]; the least torque that
presses with 0.01 N at 1 mm is ten times that."""


@dataclass(frozen=True)
class HandRows:
    """Fingers of all runs of a table, m = 4 runs, those of a run next to each other; SI."""

    runs: Array
    """The run of each, shape [m]."""
    radius: Array
    place: Array
    """Of the disc's centre along the straight finger from its first hinge [m], shape [m]."""
    gap: Array
    """Between the straight finger and the disc [m], shape [m]."""
    theta: Array
    """Rotations at the end [rad], shape [m, 3]."""
    forces: Array
    """Of the phalanges, from the palm out [N], shape [m, 3]; nan of a run without results."""
    tension: Array
    """[N], shape [m]."""
    drawn: Array
    """How far what its tendon is tied to has gone [m], shape [m]; nan on rockers."""
    sound: Flags
    """At rest, of a run that came to its end, shape [m]."""

    @property
    def pressing(self) -> Flags:
        """Which phalanges press, shape [m, 3]."""
        return np.asarray(self.forces > PRESSES)

    def centres(self, thickness: float) -> Array:
        """Of the discs, the first hinge at the origin [m], shape [m, 2].

        Args:
            thickness: radius of the proximal phalanx, below which the gap begins [m].
        """
        return np.stack([self.place, -thickness - self.gap - self.radius], axis=1)

    def only(self, these: Flags) -> HandRows:
        """Some of the fingers, by flags of shape [m]."""
        return HandRows(*(getattr(self, name)[these] for name in self.__dataclass_fields__))


def hand_rows(table: SweepTable) -> HandRows:
    """The fingers of a table of one of the studies of hands."""
    def each(names: Sequence[str]) -> Array:
        columns = [[table[name.format(i + 1)] for i in range(FINGERS)] for name in names]
        return np.array(columns, dtype=float).transpose(2, 1, 0).reshape(-1, len(names))

    moves, done = each(["moves{}"])[:, 0], np.repeat(table.done, FINGERS)
    radius, place, gap = each([f"parameters.{name}{{}}" for name in ("r", "x", "gap")]).T
    return HandRows(
        np.repeat(np.arange(len(table)), FINGERS), radius, place, gap,
        each([f"{hinge}{{}}" for hinge in HINGES]), each([f"{name}{{}}" for name in PHALANGES]),
        each(["tension{}"])[:, 0],
        each(["gone{}"])[:, 0] if "gone1" in table.kept else np.full(len(done), np.nan),
        np.asarray(done & (moves < STILL)))


def closing_finger(scene: str) -> ClosingFinger:
    """The first finger of a shipped scene, for closed forms."""
    loaded = read_scene(scene)
    part = next(part for part in loaded.scene.parts if isinstance(part, Finger))
    free = free_fingers(compile_mechanism(loaded.mechanism))[part.name]
    return ClosingFinger(free.tendon, free.springs, free.stiffness, free.limits,
                   np.array(part.lengths), np.array(part.radii), np.array(part.damping))


def doubts(tables: Mapping[str, SweepTable]) -> str:
    """A line on runs that did not end, moved at their end, or whose audit asks for a look."""
    runs = sum(map(len, tables.values()))
    lost = sum(len(table) - int(table.done.sum()) for table in tables.values())
    moved = sum(int((~hand_rows(table).sound).sum()) for table in tables.values())
    looks = sorted({look for table in tables.values() for all in table.looks.values()
                    for look in all})
    asked = sum(len(table.looks) for table in tables.values())
    return (f"{runs} runs, {lost} did not end; {moved} of {FINGERS * runs} fingers were not at "
            f"rest and are left out; {asked} audits ask for a look"
            + (f" ({', '.join(looks)})." if looks else "."))
