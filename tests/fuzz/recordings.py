"""A saved run that is changed at random, reproducible from its seed.

It begins as the run of a shipped scene, a few dozen samples long. Changed are its archive (members
missing, of other names, packed, cut, bytes turned over), types, shapes and numbers of its arrays,
the mechanism (as scenes are changed, see :mod:`tests.fuzz.inputs`) and the description of the run.
Headers, bombs and nesting: ``tests/recording/test_reading.py``.
"""

from __future__ import annotations

import contextlib
import io
import json
import random
import tempfile
import tokenize
import zipfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import sandbox
from tests.fuzz.inputs import CHANGES as SCENE_CHANGES
from tests.fuzz.inputs import ENDS, OTHERS, TEXTS, damaged

SCENES = ("adaptive_grasp", "finger_dual_control", "rocker_differential", "single_finger",
          "shape_change", "four_bar", "finger_joint_locks")
SAMPLES = 40
NUMBERS = (*ENDS, float("nan"), float("inf"), -1.0, -1e9, 1e29, 1e31)
WHOLE = (0, 1, -1, 2**31, 2**62, -2**63)
NAMES = ("../run.json", "/etc/passwd.npy", "a\\b.npy", "extra.npy", "TIME.npy", "time.npy ", "",
         "time", "meter_value.npy", "x" * 300 + ".npy", "\u202e.npy", "info.json", "mechanism.json")
UNFIT = (ValueError, KeyError, TypeError, IndexError, AttributeError, OverflowError, SyntaxError,
         RecursionError, EOFError, tokenize.TokenError)
"""Exceptions of a change that no longer fits the files after an earlier one."""


Members = dict[str, bytes]
Change = Callable[[Members, random.Random], None]


def make(seed: int) -> Members:
    """The files of a seed by their names."""
    chance = random.Random(seed)
    members, comment, summary = _saved(chance.choice(SCENES))
    members = dict(members)
    for _ in range(chance.choice([0, 1, 1, 1, 1, 2, 2, 3])):
        with contextlib.suppress(*UNFIT):
            chance.choice(CHANGES)(members, chance)
    stream = io.BytesIO()
    method = chance.choice([zipfile.ZIP_STORED] * 9 + [zipfile.ZIP_DEFLATED])
    with zipfile.ZipFile(stream, "w", method) as archive:
        archive.comment = comment
        for name, content in members.items():
            archive.writestr(zipfile.ZipInfo(name), content, method)  # of no date
    content = stream.getvalue()
    return {"run.npz": damaged(content, chance) if chance.random() < 0.12 else content,
            "run.json": summary}


@cache
def _saved(scene: str) -> tuple[Members, bytes, bytes]:
    """Members, comment and summary of a short run."""
    step = 1e-3
    run = sandbox.simulate(sandbox.load_scene(scene, overrides={
        "run": {"step": step, "duration": SAMPLES * 5 * step, "sample_rate": 200},
        "view.size": [64, 64], "view.fps": 20}))
    with tempfile.TemporaryDirectory(prefix="fuzz-") as folder:
        run.save(folder)
        with zipfile.ZipFile(Path(folder) / "run.npz") as archive:
            members = {name: archive.read(name) for name in archive.namelist()}
            return members, archive.comment, (Path(folder) / "run.json").read_bytes()


def _rename(members: Members, chance: random.Random) -> None:
    """Another name of a member, perhaps one that there is, so that this one is lost."""
    name = chance.choice(sorted(members))
    members[chance.choice([*NAMES, *sorted(members)])] = members.pop(name)


def _bytes(members: Members, chance: random.Random) -> None:
    name = chance.choice(sorted(members))
    members[name] = damaged(members[name], chance)


def _numbers(array: NDArray[Any], chance: random.Random) -> NDArray[Any]:
    """Some or all numbers of an array changed."""
    array = array.copy()
    place = chance.choice([0, -1, chance.randrange(array.size), slice(None)])
    array.reshape(-1)[place] = chance.choice(WHOLE if array.dtype.kind == "i" else NUMBERS)
    return array


def _whole(array: NDArray[Any], chance: random.Random) -> Any:
    """A whole array: larger, in another order, of another shape or type."""
    factor = chance.choice([0, -1, 1e9, 1e-9, 1e20, 1e150])
    return chance.choice([
        lambda: (array * factor).astype(array.dtype), lambda: array[::-1],
        lambda: np.roll(array, 1), lambda: np.sort(array, axis=0),
        lambda: array[:-1], lambda: array[:0], lambda: array[None], lambda: array.T, array.sum,
        lambda: np.concatenate([array, array]), lambda: np.asfortranarray(array),
        lambda: array.astype(chance.choice(["f4", "i8", "i4", "c16", ">f8", "?", "U3"]))])()


def _array(new: Callable[[NDArray[Any], random.Random], Any]) -> Change:
    """The change of one array into a new one."""
    def change(members: Members, chance: random.Random) -> None:
        name = chance.choice(sorted(name for name in members if name.endswith(".npy")))
        array = np.load(io.BytesIO(members[name]), allow_pickle=False)
        with np.errstate(all="ignore"):
            members[name] = _written(new(array, chance))

    return change


def _written(array: Any) -> bytes:
    stream = io.BytesIO()
    np.save(stream, np.asarray(array), allow_pickle=False)
    return stream.getvalue()


def _cut(members: Members, chance: random.Random) -> None:
    """All that has a row per sample, down to fewer of them."""
    count = chance.choice([0, 1, 2, 3, 7])
    kept = np.load(io.BytesIO(members["contact_sample.npy"])) < count
    for name in [name for name in members if name.endswith(".npy")]:
        array = np.load(io.BytesIO(members[name]), allow_pickle=False)
        if name.startswith("contact_"):
            members[name] = _written(array[kept])
        elif array.ndim and len(array) == SAMPLES:
            members[name] = _written(array[:count])


def _text(name: str) -> Change:
    """The change of a JSON member, as scenes are changed or by another value of a key."""
    def change(members: Members, chance: random.Random) -> None:
        data = json.loads(members[name])
        if name == "mechanism.json" or chance.random() < 0.5:
            chance.choice(SCENE_CHANGES)(data, chance)
        else:
            key = chance.choice([*data, "events", "stopped", "controllers", "extra"])
            data[key] = chance.choice([
                *OTHERS, *ENDS, *TEXTS, [{"event": "a", "time_s": 1e300}], {"a": {"b": [[[[1]]]]}},
                {"a": 1}, 10**400, {"event": "x", "verdict": "pass", "time_s": -1}])
        members[name] = json.dumps(data).encode()

    return change


CHANGES: tuple[Change, ...] = (
    _rename, _bytes, _cut, *[_array(_numbers)] * 3, *[_array(_whole)] * 4,
    *[_text("mechanism.json")] * 3, _text("info.json"))
