"""More contacts than there is room for: room is made, and the run goes on from the very step."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.engine import simulation as module
from sandbox.engine import world
from sandbox.engine.simulate import simulate
from sandbox.engine.world import Room
from sandbox.errors import SandboxError
from sandbox.scene.mechanism import Mechanism

from .machines import G, disc, fixed, mechanism

R = 0.01


def heap(rows: int, columns: int, *, duration: float = 0.1, **more: Any) -> Mechanism:
    """Discs in rows on a floor between two walls, each row half a disc beside the last."""
    bodies = [fixed("tray", shapes=[
        {"type": "box", "size": (4, 0.1), "at": (0, -0.05)},
        {"type": "box", "size": (0.1, 2), "at": (-0.05 - R, 1)},
        {"type": "box", "size": (0.1, 2), "at": (0.05 + 2 * R * columns, 1)}])]
    for j in range(rows):
        for i in range(columns):
            at = (2 * R * i + R * (j % 2), R + 1.01 * math.sqrt(3) * R * j)
            bodies.append(disc(f"d{j}_{i}", R, at))
    return mechanism(duration=duration, gravity=(0.0, -G), bodies=bodies, **more)


def cramped(monkeypatch: pytest.MonkeyPatch, contacts: int = 2, rows: int = 8) -> list[Room]:
    """Runs start with no more room than this; every room that is made then."""
    made: list[Room] = []

    def room(**given: int) -> Room:
        made.append(Room(**given) if made else Room(contacts, rows))
        return made[-1]

    monkeypatch.setattr(world, "Room", room)
    return made


def test_it_goes_on_to_the_last_bit_as_with_room_from_the_start(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    machine = heap(3, 4, run={"sample_rate": 400.0})
    whole = simulate(machine)
    made = cramped(monkeypatch)
    again = simulate(machine)
    assert len(made) > 1
    for name, array in whole.arrays.items():
        np.testing.assert_array_equal(again.arrays[name], array, err_msg=name)


def test_too_many_are_told_with_their_number(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_CONTACTS", 5)
    cramped(monkeypatch)
    with pytest.raises(SandboxError, match=r"\d+ contacts at once at t = .*more than the 5"):
        simulate(heap(2, 8))
