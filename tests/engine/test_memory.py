"""The table of a run's memory: every view is the array that it stands for."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.memory import make_memory, native_of, snapshot_of, views
from sandbox.engine.snapshot import make_snapshot

from .machines import cord, fixed, mass, mechanism, parts


def busy():
    """Every kind of record, and no two of them equally long."""
    bodies = [fixed("wall"), *(mass(f"b{i}", 0.1, (0.1 * i, 0.0)) for i in range(1, 9))]
    pins = [{"type": "pin", "name": f"j{i}", "a": f"b{i}", "b": f"b{i + 1}", "on_b": (0, 0),
             "damping": 1e-3} for i in range(1, 6)]
    springs = [{"type": "linear", "name": f"s{i}", "a": "wall", "b": f"b{i}", "stiffness": 10}
               for i in range(1, 4)]
    cords = [cord(f"t{i}", ("wall", (0, 1)), (f"b{i}",), (f"b{i + 1}",), (f"b{i + 2}", (0, 0.1)))
             for i in (1, 4)]
    drives = [{"type": "force", "name": f"f{i}", "body": f"b{i}", "direction": (1, 0), "value": 1}
              for i in range(1, 8)]
    return mechanism(bodies=bodies, joints=pins, springs=springs, tendons=cords, drives=drives)


def equal(view: object, array: object) -> bool:
    if not isinstance(array, np.ndarray):
        return view == array
    return (view.dtype == array.dtype and view.shape == array.shape
            and (not array.size or view.ctypes.data == array.ctypes.data))


def test_every_view_is_its_array() -> None:
    world, tables = parts(busy())
    kept = make_snapshot(3, tables.constants, len(world.native.handles))
    table, h, _ = memory = make_memory(world.native, *tables[:3], kept)
    assert len(memory.kept) == len(table)
    constants, state, result = views(table, h)
    for seen, record in ((constants, tables.constants), (state, tables.state),
                         (result, tables.result), (snapshot_of(table), kept),
                         (native_of(table), world.native)):
        assert type(seen)._fields == type(record)._fields
        for name, view, array in zip(record._fields, seen, record, strict=True):
            assert equal(view, array), f"{type(record).__name__}.{name}"


def test_the_records_are_all_of_different_size() -> None:
    """Or a view in another's place might not be noticed."""
    _, tables = parts(busy())
    lengths = [len(getattr(tables.constants, name))
               for name in ("actions", "springs", "dampers", "cords", "guides")]
    assert len({*lengths, len(tables.constants.inverse_mass)}) == 6


def test_what_is_not_in_one_piece_is_refused() -> None:
    world, tables = parts(busy())
    kept = make_snapshot(1, tables.constants, len(world.native.handles))
    torn = tables.state._replace(held=np.zeros((2 * len(tables.state.held), 3))[::2])
    with pytest.raises(ValueError, match="in one piece"):
        make_memory(world.native, tables.constants, torn, tables.result, kept)
