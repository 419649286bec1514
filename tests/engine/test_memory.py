"""The table of a run's memory: every view is the array that it stands for."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

from sandbox.engine import memory as at
from sandbox.engine.memory import make_memory

from .machines import Bench, cord, disc, fixed, mass, mechanism

PARTS = ("native", "constants", "state", "result", "snapshot")
NUMBERS = ("step", "each_body", "space", "get", "read", "put", "write", "place")


def busy():
    """Every kind of record, and few of them equally long."""
    bodies = [fixed("wall"), *(mass(f"b{i}", 0.1, (0.1 * i, 0.0)) for i in range(1, 9)),
              disc("d", 0.01, (1.0, 0.0)), disc("e", 0.01, (2.0, 0.0)),
              {"name": "s", "motion": "scheduled", "path": {"x": 0.0}}]
    pins = [{"type": "pin", "name": f"j{i}", "a": f"b{i}", "b": f"b{i + 1}", "on_b": (0, 0),
             "damping": 1e-3, "limits": (-1, 1)} for i in range(1, 6)]
    ropes = [{"type": "rope", "name": f"r{i}", "a": "wall", "b": f"b{i}", "longest": 2.0}
             for i in range(1, 4)]
    springs = [{"type": "linear", "name": f"s{i}", "a": "wall", "b": f"b{i}", "stiffness": 10}
               for i in range(1, 4)]
    cords = [cord(f"t{i}", ("wall", (0, 1)), (f"b{i}",), (f"b{i + 1}",), (f"b{i + 2}", (0, 0.1)))
             for i in (1, 4)]
    drives = [{"type": "force", "name": f"f{i}", "body": f"b{i}", "direction": (1, 0), "value": 1}
              for i in range(1, 8)]
    drives += [{"type": "motor", "name": "m", "joint": "j1", "value": 1.0, "torque": 1.0}]
    return mechanism(bodies=bodies, joints=pins + ropes, springs=springs, tendons=cords,
                     drives=drives)


def arrays(bench):
    """All arrays of a run under the names of their views."""
    parts = dict(zip(PARTS, (bench.world.native, *bench.tables[:3], bench.kept), strict=True))
    endings = {"constants": "{}", "state": "{}_states", "result": "{}_results",
               "snapshot": "kept_{}", "native": "{}"}
    found = {}
    for part, record in parts.items():
        for name, value in record._asdict().items():
            if not isinstance(value, np.ndarray):
                continue
            stem = name.removesuffix("s") if part in ("state", "result") else name
            names = [endings[part].format(stem), name]
            found[next(one for one in names if hasattr(at, one))] = value
    return found


@pytest.mark.nightly
def test_every_view_is_its_array() -> None:
    """Address, lengths and the size of an item, as compiled code sees them."""
    bench = Bench(busy())
    named = arrays(bench)
    views = [name for name, value in vars(at).items()
             if type(value).__name__ == "_Intrinsic" and name not in NUMBERS]
    assert set(views) == set(named)
    lines = ["def look(table, out):"]
    for k, name in enumerate(named):
        lines += [f"    a = at.{name}(table)", f"    out[{k}, 0] = a.ctypes.data",
                  f"    out[{k}, 1] = a.itemsize",
                  *(f"    out[{k}, {2 + axis}] = a.shape[{axis}]"
                    for axis in range(named[name].ndim))]
    scope = {"at": at}
    exec("\n".join(lines), scope)
    out = np.zeros((len(named), 5), dtype=np.int64)
    njit(scope["look"])(bench.memory.address, out)
    for (name, array), row in zip(named.items(), out.tolist(), strict=True):
        lengths = [*array.shape, *[0] * (3 - array.ndim)]
        assert row == [array.ctypes.data, array.itemsize, *lengths], name


def test_plain_numbers_are_those_of_the_calls() -> None:
    bench = Bench(busy())
    out = np.zeros(len(NUMBERS), dtype=np.int64)
    lines = ["def look(table, out):",
             *(f"    out[{k}] = at.{name}(table)" for k, name in enumerate(NUMBERS))]
    scope = {"at": at}
    exec("\n".join(lines), scope)
    njit(scope["look"])(bench.memory.address, out)
    assert out.tolist() == [getattr(bench.world.native, name) for name in NUMBERS]
    assert len(set(out.tolist())) == len(NUMBERS)


def test_what_is_not_in_one_piece_is_refused() -> None:
    bench = Bench(busy())
    torn = bench.state._replace(body=np.zeros((2 * len(bench.state.body), 6))[::2])
    with pytest.raises(ValueError, match="in one piece"):
        make_memory(bench.world.native, bench.constants, torn, bench.result, bench.kept,
                    np.zeros(0, dtype=np.int64))
