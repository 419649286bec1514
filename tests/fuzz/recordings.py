"""A saved run from a seed, changed where a stranger would change it.

It begins as the run of a shipped scene, a few dozen samples long. Changed are its archive (members
missing, twice, of other names, packed, cut, bytes turned over), the headers, types and shapes of
its arrays, single numbers and whole arrays of them, the mechanism (as scenes are changed, see
:mod:`tests.fuzz.inputs`) and what is said of the run, and the summary beside the archive.
"""

from __future__ import annotations

import contextlib
import io
import json
import random
import struct
import tempfile
import tokenize
import warnings
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
DTYPES = ("<f4", ">f8", "<i8", "<c16", "<U3", "|O", "|S0", "<f8", "|V8", "<M8[s]")
UNFIT = (ValueError, KeyError, TypeError, IndexError, AttributeError, OverflowError, SyntaxError,
         RecursionError, EOFError, tokenize.TokenError, struct.error)
"""What a change raises if one before it left nothing that could be changed so."""
BOMB = 150_000_000
"""Bytes that a packed member unpacks to."""


@dataclass
class Files:
    """What lies in a run's directory, the archive in its members."""

    members: dict[str, bytes]
    comment: bytes
    summary: bytes
    packed: bool = False
    twice: str = ""
    bomb: str = ""

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
    with zipfile.ZipFile(stream, "w", method) as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of names that are there twice
        archive.comment = files.comment
        for name, content in files.members.items():
            if name == files.bomb:
                _add_bomb(archive, name)
                continue
            for _ in range(1 + (name == files.twice)):
                archive.writestr(zipfile.ZipInfo(name), content, method)  # of no date
    return stream.getvalue()


def _add_bomb(archive: zipfile.ZipFile, name: str) -> None:
    """A member, packed small, that would be very large."""
    place = zipfile.ZipInfo(name)
    place.compress_type = zipfile.ZIP_DEFLATED
    zeros = bytes(1 << 20)
    with archive.open(place, "w") as member:
        np.lib.format.write_array_header_1_0(member, {
            "descr": "<f8", "fortran_order": False, "shape": (BOMB // 8,)})
        for _ in range(BOMB >> 20):
            member.write(zeros)


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


# -- members ----------------------------------------------------------------------------------


def _drop(files: Files, chance: random.Random) -> None:
    del files.members[chance.choice(sorted(files.members))]


def _rename(files: Files, chance: random.Random) -> None:
    name = chance.choice(sorted(files.members))
    files.members[chance.choice([*NAMES, *sorted(files.members)])] = files.members.pop(name)


def _repeat(files: Files, chance: random.Random) -> None:
    files.twice = chance.choice(sorted(files.members))


def _pack(files: Files, chance: random.Random) -> None:
    files.packed = True
    if chance.random() < 0.05:
        files.bomb = chance.choice(sorted(files.members))


def _bytes(files: Files, chance: random.Random) -> None:
    name = chance.choice(sorted(files.members))
    files.members[name] = _damaged(files.members[name], chance)


# -- arrays -----------------------------------------------------------------------------------


def _number(files: Files, chance: random.Random) -> None:
    """Some numbers of an array, anywhere or at its ends."""
    name = chance.choice(files.arrays)
    array = files.array(name)
    flat = array.reshape(-1)
    value = chance.choice(WHOLE if array.dtype.kind == "i" else NUMBERS)
    for _ in range(chance.choice([1, 1, 3])):
        flat[chance.choice([0, -1, chance.randrange(len(flat))])] = value
    files.keep(name, array)


def _all_numbers(files: Files, chance: random.Random) -> None:
    """A whole array: of one number, larger, smaller, the other way round, in another order."""
    name = chance.choice(files.arrays)
    array = files.array(name)
    factor = chance.choice([0, -1, 1e9, 1e-9, 1e20, 1e150])
    files.keep(name, np.asarray(chance.choice([
        lambda: np.full_like(array, chance.choice(WHOLE if array.dtype.kind == "i" else NUMBERS)),
        lambda: (array * factor).astype(array.dtype), lambda: array[::-1].copy(),
        lambda: np.roll(array, 1), lambda: np.sort(array, axis=0)])()))


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


def _longer(files: Files, chance: random.Random) -> None:
    """Time and the duration that is said, both as many times as long."""
    factor = chance.choice([1e3, 1e6, 1e9, 1e-6])
    files.keep("time.npy", files.array("time.npy") * factor)
    data = json.loads(files.members["mechanism.json"])
    data["run"]["duration"] *= factor
    files.members["mechanism.json"] = json.dumps(data).encode()


def _shape(files: Files, chance: random.Random) -> None:
    name = chance.choice(files.arrays)
    array = files.array(name)
    files.keep(name, np.asarray(chance.choice([
        lambda: array[:-1], lambda: array[None], lambda: array.T, lambda: array.reshape(-1),
        lambda: np.concatenate([array, array]), lambda: array.sum(),
        lambda: np.asfortranarray(array), lambda: array[:0]])()))


def _header(files: Files, chance: random.Random) -> None:
    """What an array says of itself, its numbers left as they are."""
    name = chance.choice(files.arrays)
    content = files.members[name]
    length = struct.unpack("<H", content[8:10])[0]
    head, rest = content[10:10 + length].decode("latin-1"), content[10 + length:]
    array = files.array(name)
    shape = chance.choice([(-1,), (10**18,), (10**18, 10**18), (2**63,), (), (0,), (10**6,) * 3,
                           (*array.shape, 10**9), (len(array), 2**40)])
    text = repr({"descr": chance.choice(DTYPES), "fortran_order": chance.choice([True, False]),
                 "shape": array.shape}) if chance.random() < 0.5 else repr(
        {"descr": "<f8", "fortran_order": False, "shape": shape})
    text = chance.choice([text, text, text, head[:-20], head.replace("<f8", "__import__('os')"),
                          "(" * 500, "[" + "9" * 5000])
    begin = chance.choice([b"\x93NUMPY\x01\x00", b"\x93NUMPY\x01\x00", b"\x93NUMPY\x02\x00",
                           b"\x93NUMPY\x09\x09"])
    files.members[name] = (begin + struct.pack("<H", chance.choice([len(text) + 1, 65535, 0])
                                               if chance.random() < 0.1 else len(text) + 1)
                           + text.encode() + b"\n" + rest)


def _type(files: Files, chance: random.Random) -> None:
    name = chance.choice(files.arrays)
    with np.errstate(all="ignore"):
        files.keep(name, files.array(name).astype(chance.choice(["f4", "i8", "i4", "c16", ">f8",
                                                                "?", "U3"])))


# -- texts ------------------------------------------------------------------------------------


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


def _format(files: Files, chance: random.Random) -> None:
    data = json.loads(files.members["info.json"])
    data["format"] = chance.choice([0, -1, 2, 10**30, 1.0, "1", True, None, [1], float("nan")])
    files.members["info.json"] = json.dumps(data).encode()


def _deep(files: Files, chance: random.Random) -> None:
    name = chance.choice(["info.json", "mechanism.json"])
    depth = chance.choice([50, 900, 100_000])
    files.members[name] = b'{"format": 1, "notes": ' + b"[" * depth + b"]" * depth + b"}"


def _summary(files: Files, chance: random.Random) -> None:
    """Of another run, none, or garbage."""
    files.summary = chance.choice([_saved(chance.choice(SCENES))[2], b"", b"{", b"\xff" * 3000,
                                   b'{"run_id": "' + b"0" * 32 + b'"}'])


CHANGES: tuple[Callable[[Files, random.Random], None], ...] = (
    _drop, _rename, _repeat, _pack, _bytes, _number, _number, _number, _all_numbers, _all_numbers,
    _cut, _longer, _shape, _header, _type, _mechanism, _mechanism, _mechanism, _info, _format,
    _deep, _summary)
