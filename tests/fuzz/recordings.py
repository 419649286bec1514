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
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import sandbox
from tests.fuzz.inputs import CHANGES as SCENE_CHANGES
from tests.fuzz.inputs import ENDS, OTHERS, RAW, TEXTS

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


@dataclass
class Files:
    """What lies in a run's directory, the archive in its members."""

    members: dict[str, bytes]
    comment: bytes
    summary: bytes
    packed: bool = False

    def array(self, name: str) -> NDArray[Any]:
        """An array that can be written to."""
        return np.load(io.BytesIO(self.members[name]), allow_pickle=False).copy()

    def keep(self, name: str, array: NDArray[Any]) -> None:
        """Put an array back."""
        stream = io.BytesIO()
        np.save(stream, array, allow_pickle=False)
        self.members[name] = stream.getvalue()

    @property
    def arrays(self) -> list[str]:
        """Members that are arrays still."""
        return sorted(name for name, content in self.members.items()
                      if name.endswith(".npy") and content[:6] == b"\x93NUMPY")


Change = Callable[[Files, random.Random], None]


def make(seed: int) -> dict[str, bytes]:
    """The files of a seed by their names."""
    chance = random.Random(seed)
    members, comment, summary = _saved(chance.choice(SCENES))
    files = Files(dict(members), comment, summary)
    for _ in range(chance.choice([0, 1, 1, 1, 1, 2, 2, 3])):
        with contextlib.suppress(*UNFIT):
            chance.choice(CHANGES)(files, chance)
    archive = _archive(files)
    if chance.random() < 0.12:
        archive = _damaged(archive, chance)
    found = {"run.npz": archive, "run.json": files.summary}
    return {name: content for name, content in found.items() if content}


@cache
def _saved(scene: str) -> tuple[dict[str, bytes], bytes, bytes]:
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


def _archive(files: Files) -> bytes:
    stream = io.BytesIO()
    method = zipfile.ZIP_DEFLATED if files.packed else zipfile.ZIP_STORED
    with zipfile.ZipFile(stream, "w", method) as archive:
        archive.comment = files.comment
        for name, content in files.members.items():
            archive.writestr(zipfile.ZipInfo(name), content, method)  # of no date
    return stream.getvalue()


def _damaged(content: bytes, chance: random.Random) -> bytes:
    """Cut, or bytes turned over; most of what is not numbers lies at its end."""
    for _ in range(chance.randrange(1, 4)):
        place = chance.randrange(len(content) + 1)
        if chance.random() < 0.6:
            place = max(0, len(content) - chance.randrange(1, 4000))
        content = chance.choice([
            content[:place], content[:place] + chance.choice(RAW) + content[place:],
            content[:place] + bytes([chance.randrange(256)]) + content[place + 1:],
            content[:place] + b"\xff" * 4 + content[place + 4:]])
    return content


def _drop(files: Files, chance: random.Random) -> None:
    del files.members[chance.choice(sorted(files.members))]


def _rename(files: Files, chance: random.Random) -> None:
    name = chance.choice(sorted(files.members))
    files.members[chance.choice([*NAMES, *sorted(files.members)])] = files.members.pop(name)


def _pack(files: Files, chance: random.Random) -> None:
    files.packed = True


def _bytes(files: Files, chance: random.Random) -> None:
    name = chance.choice(sorted(files.members))
    files.members[name] = _damaged(files.members[name], chance)


def _array(new: Callable[[NDArray[Any], random.Random], Any]) -> Change:
    """The change of one array into a new one."""
    def change(files: Files, chance: random.Random) -> None:
        name = chance.choice(files.arrays)
        with np.errstate(all="ignore"):
            files.keep(name, np.asarray(new(files.array(name), chance)))

    return change


def _hostile(array: NDArray[Any], chance: random.Random) -> Any:
    return chance.choice(WHOLE if array.dtype.kind == "i" else NUMBERS)


def _numbers(array: NDArray[Any], chance: random.Random) -> NDArray[Any]:
    """Some numbers of an array changed, anywhere or at its ends."""
    flat, value = array.reshape(-1), _hostile(array, chance)
    for _ in range(chance.choice([1, 1, 3])):
        flat[chance.choice([0, -1, chance.randrange(len(flat))])] = value
    return array


def _all_numbers(array: NDArray[Any], chance: random.Random) -> NDArray[Any]:
    """A whole array: of one number, larger, smaller, reversed, in another order."""
    factor = chance.choice([0, -1, 1e9, 1e-9, 1e20, 1e150])
    return chance.choice([
        lambda: np.full_like(array, _hostile(array, chance)),
        lambda: (array * factor).astype(array.dtype), lambda: array[::-1].copy(),
        lambda: np.roll(array, 1), lambda: np.sort(array, axis=0)])()


def _shape(array: NDArray[Any], chance: random.Random) -> NDArray[Any]:
    return chance.choice([
        lambda: array[:-1], lambda: array[None], lambda: array.T, lambda: array.reshape(-1),
        lambda: np.concatenate([array, array]), lambda: array.sum(),
        lambda: np.asfortranarray(array), lambda: array[:0]])()


def _type(array: NDArray[Any], chance: random.Random) -> NDArray[Any]:
    return array.astype(chance.choice(["f4", "i8", "i4", "c16", ">f8", "?", "U3"]))


def _cut(files: Files, chance: random.Random) -> None:
    """All that has a row per sample, down to fewer of them."""
    count = chance.choice([0, 1, 2, 3, 7])
    kept = files.array("contact_sample.npy") < count
    for name in files.arrays:
        array = files.array(name)
        if name.startswith("contact_"):
            files.keep(name, array[kept])
        elif array.ndim and len(array) == SAMPLES:
            files.keep(name, array[:count])


def _mechanism(files: Files, chance: random.Random) -> None:
    data = json.loads(files.members["mechanism.json"])
    for _ in range(chance.choice([1, 1, 2])):
        chance.choice(SCENE_CHANGES)(data, chance)
    files.members["mechanism.json"] = json.dumps(data).encode()


def _info(files: Files, chance: random.Random) -> None:
    data = json.loads(files.members["info.json"])
    if chance.random() < 0.5:
        chance.choice(SCENE_CHANGES)(data, chance)
    else:
        data[chance.choice([*data, "events", "stopped", "controllers", "extra"])] = chance.choice([
            *OTHERS, *ENDS, *TEXTS, [{"event": "a", "time_s": 1e300}], {"a": {"b": [[[[1]]]]}},
            {"a": 1}, 10**400, {"event": "x", "verdict": "pass", "time_s": -1}])
    files.members["info.json"] = json.dumps(data).encode()


CHANGES: tuple[Change, ...] = (
    _drop, _rename, _pack, _bytes, *[_array(_numbers)] * 3, *[_array(_all_numbers)] * 2, _cut,
    _array(_shape), _array(_type), *[_mechanism] * 3, _info)
