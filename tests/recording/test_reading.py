"""Damaged or hostile recordings are refused before they are unpacked; large ones are mapped."""

import io
import json
import tracemalloc
import warnings
import zipfile
from functools import partial

import numpy as np
import pytest

from sandbox.errors import OutputError
from sandbox.recording import archive
from sandbox.recording.recording import Recording

from .sample import CONTACTS, N, mapped, recording


@pytest.fixture
def saved(tmp_path):
    run = recording(contacts=sorted(CONTACTS, key=lambda row: row[:3]),
                    meters=[{"name": "m", "value": "=1 / disc.x", "unit": "1/m"}])
    run.save(tmp_path)
    return tmp_path


def rewritten(path, change):
    """The archive written anew, its members by a function of the archive, name and content."""
    with zipfile.ZipFile(path) as old:
        kept, comment = [(name, old.read(name)) for name in old.namelist()], old.comment
    with zipfile.ZipFile(path, "w") as new, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a name that is there twice
        new.comment = comment
        for name, content in kept:
            change(new, name, content)


def damage(path, **members):
    """The archive with some members replaced; None leaves one out."""
    def change(new, name, content):
        if (data := members.get(name, content)) is not None:
            new.writestr(name, data)
    rewritten(path, change)


def npy(array):
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=True)
    return stream.getvalue()


def member(name, content):
    """Another content of a member; None leaves it out."""
    return lambda folder: damage(folder / "run.npz", **{name: content})


def put(key, place, value):
    """Another value in an array."""
    def spoil(folder):
        array = Recording.load(folder).arrays[key].copy()
        array[place] = value
        damage(folder / "run.npz", **{f"{key}.npy": npy(array)})
    return spoil


def text(name, *path, to):
    """Another value in a JSON member."""
    def spoil(folder):
        with zipfile.ZipFile(folder / "run.npz") as archive:
            data = json.loads(archive.read(name))
        holder = data
        for step in path[:-1]:
            holder = holder[step]
        holder[path[-1]] = to
        damage(folder / "run.npz", **{name: json.dumps(data).encode()})
    return spoil


def header(old, new):
    """Another header of an array of 20 numbers."""
    head = "{'descr': '<f8', 'fortran_order': False, 'shape': (20,), }".replace(old, new).encode()
    head = head.ljust(117) + b"\n"
    return member("time.npy", b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head
                  + bytes(8 * 21))


def archived(change):
    """Another way to write a member."""
    return lambda folder: rewritten(folder / "run.npz", change)


def renamed(name):
    return archived(lambda new, old, content: new.writestr(old.replace("time.npy", name), content))


mechanism, info = partial(text, "mechanism.json"), partial(text, "info.json")
NO_ARRAY, INVALID = "is not an array of numbers", "its mechanism is not valid.*"


@pytest.mark.parametrize(("spoil", "message"), [
    (put("time", 7, np.nan), "'time' holds nan"), (put("time", 7, 0.0), "'time' does not rise"),
    (put("time", -1, 1e9), r"'time' goes on after the run's end of .* s: 1e\+09 s"),
    (put("body_pose", (3, 1, 2), np.nan), "'body_pose' holds nan"),
    (put("body_acceleration", (0, 0, 0), 1e300), r"'body_acceleration' holds 1e\+300"),
    (put("contact_force", (2, 1), np.nan), "'contact_force' holds nan"),
    (put("contact_sample", 4, N), r"'contact_sample' points outside 0\.\.19"),
    (put("contact_sample", 4, 1), "'contact_sample' is not in order"),
    (put("body_mass", 1, np.nan), "'body_mass' holds nan"),
    (put("body_inertia", 1, -1.0), "'body_inertia' holds -"),
    (put("body_mass", 1, np.inf), r"'body_mass' has no weight for 'finger1\.proximal'"),
    (mechanism("joints", 0, "a", to="nobody"),
     INVALID + r"\$\.joints\[0\]\.a: there is no body named 'nobody'"),
    (mechanism("bodies", 3, "mass", to=1e300), INVALID + r"\[3\]\.mass: 1e\+300 is too large"),
    (mechanism("groups", 0, "bodies", 0, to="\x1b[31m"),
     INVALID + r"groups\[0\]\.bodies\[0\]: "),
    (mechanism("bodies", 1, "name", to="palm"),
     INVALID + "the name 'palm' is already that of another body"),
    (mechanism("bodies", to=[]), INVALID + "there is no body named 'palm'.*, and 13 more"),
    (mechanism("title", to=[[[]]]), INVALID + r"\$\.title: "),
    (mechanism("bodies", to=[0] * 300_000), INVALID + "the scene has 300 000 bodies"),
    (mechanism("title", to=[0] * 1_100_000), INVALID + "the scene has 1 100 ... values and more"),
    (info("format", to=10**30), "has format 1000000000000000000000000000000; this version"),
    (info("reason", to="\ud800"), "half a character"),
    (info("step", to=1e300), "its step is"),
    (info("seed", to=True), "'seed': Input should be a valid integer"),
    (info("controllers", to={"a": {"b": json.loads("[" * 40 + "]" * 40)}}),
     "nest"),
    (info("events", to=[{"event": "a", "time_s": float("nan")}]),
     "NaN is not a number"),
    (member("mechanism.json", b'{"a": 1, "a": 2}'), 'the key "a" is repeated'),
    (member("mechanism.json", b'{"bodies": ' + b"[" * 100_000 + b"]" * 100_000 + b"}"), "nest"),
    (member("mechanism.json", b"\xff\xfe"), "damaged"),
    (member("mechanism.json", b" " * (archive.MAX_TEXT + 1)),
     "has 20000001 bytes; allowed: at most 20000000"),
    (member("time.npy", None), "'time' is missing"),
    (member("info.json", None), "it has no 'info.json'"),
    (info("stopped", to={"event": "a", "verdict": "no", "time_s": 0}),
     "'stopped.verdict': Input should be 'pass' or 'fail'"),
    (member("time.npy", b"nonsense"), "damaged"),
    (member("time.npy", npy(np.zeros(N))[:-8]), "damaged"),
    (member("time.npy", npy(np.zeros(N, dtype=np.float32))), "holds float32, expected float64"),
    (archived(lambda new, name, content: [
        new.writestr(name, content) for _ in range(1 + (name == "time.npy"))]),
     "'time.npy' is in it twice"),
    (archived(lambda new, name, content: new.writestr(name, content, zipfile.ZIP_BZIP2)),
     "packed in a way that is not read"),
    (renamed("../time.npy"), r"no part of a recording is called '\.\./time\.npy'"),
    (renamed("\x1b[31m.npy"), r"no part of a recording is called '\\x1b\[31m.npy'"),
    (header("(20,)", "(10000000000,)"), "does not take the 296 bytes that it has"),
    (header("(20,)", "(-20,)"), "does not take"), (header("<f8", "|O"), "holds object"),
    (header("'<f8'", "__import__('os').abort()"), NO_ARRAY),
    (header("<f8", ">f8"), "holds >f8, expected float64"), (header("<f8", "<q9"), "damaged"),
])
def test_a_damaged_recording_is_refused_in_a_line(saved, monkeypatch, spoil, message):
    """Its numbers are checked in small pieces."""
    spoil(saved)
    monkeypatch.setattr("sandbox.elements.arrays.PIECE", 8)
    with pytest.raises(OutputError, match=message) as caught:
        Recording.load(saved)
    assert str(caught.value).isprintable()


def test_a_bomb_is_not_unpacked(saved):
    """3 GB of zeros take 3 MB of a file: what they claim is compared before that."""
    size = 8 * 30_000_000
    zeros = bytes(1 << 20)

    def bomb(new, name, content):
        if name != "body_pose.npy":
            new.writestr(name, content)
            return
        entry = zipfile.ZipInfo(name)
        entry.compress_type = zipfile.ZIP_DEFLATED
        with new.open(entry, "w") as member:
            np.lib.format.write_array_header_1_0(
                member, {"descr": "<f8", "fortran_order": False, "shape": (N, 6, 3)})
            for _ in range(size // len(zeros)):
                member.write(zeros)

    rewritten(saved / "run.npz", bomb)
    tracemalloc.start()
    with pytest.raises(OutputError, match=r"its compressed parts would take 239\d+ bytes; allowed"):
        Recording.load(saved)
    assert tracemalloc.get_traced_memory()[1] < 8e6
    tracemalloc.stop()


def test_a_large_recording_is_mapped_and_reads_the_same(saved, monkeypatch):
    small = Recording.load(saved)
    monkeypatch.setattr("sandbox.recording.archive.IN_MEMORY", 1000)
    large = Recording.load(saved)
    for key, array in large.arrays.items():
        assert np.array_equal(array, small.arrays[key], equal_nan=True), key
        assert mapped(array) == (array.size > 0), key
        assert not mapped(small.arrays[key])
        assert array.flags.aligned
        assert not array.flags.writeable
    for name in small.names():
        assert np.array_equal(large[name], small[name], equal_nan=True), name
    large.save(saved / "again")
    assert (saved / "again/run.npz").read_bytes() == (saved / "run.npz").read_bytes()


@pytest.mark.parametrize("in_memory", [1000, 10**9])
def test_a_flipped_byte_is_found(saved, monkeypatch, in_memory):
    monkeypatch.setattr("sandbox.recording.archive.IN_MEMORY", in_memory)
    whole = bytearray((saved / "run.npz").read_bytes())
    place = whole.index(b"\x93NUMPY", whole.index(b"contact_normal.npy")) + 130
    whole[place] ^= 1
    (saved / "run.npz").write_bytes(whole)
    with pytest.raises(OutputError, match="Bad CRC-32"):
        Recording.load(saved)
