"""What is refused of a stranger's recording, before anything of it is unpacked; what is mapped."""

import json
import mmap
import tracemalloc
import warnings
import zipfile

import numpy as np
import pytest

from sandbox.elements.arrays import LARGEST
from sandbox.errors import OutputError
from sandbox.recording import reading
from sandbox.recording.recording import Recording

from .sample import CONTACTS, H, N, recording
from .test_store import damage, npy


@pytest.fixture
def saved(tmp_path):
    run = recording(contacts=sorted(CONTACTS, key=lambda row: row[:3]),
                    meters=[{"name": "m", "value": "=1 / disc.x", "unit": "1/m"}])
    run.save(tmp_path)
    return tmp_path


def load_changed(folder, **changes):
    """The recording with some arrays changed in place by functions."""
    run = Recording.load(folder)
    members = {}
    for key, change in changes.items():
        array = run.arrays[key].copy()
        change(array)
        members[f"{key}.npy"] = npy(array)
    damage(folder / "run.npz", **members)
    return Recording.load(folder)


def put(place, value):
    def change(array):
        array[place] = value
    return change


@pytest.mark.parametrize(("key", "change", "message"), [
    ("time", put(7, np.nan), "'time' does not rise: nan s in sample 7"),
    ("time", put(7, 6.5 * H), "'time' does not rise: 0.065 s in sample 7"),
    ("time", put(slice(None), 0.1), "'time' does not rise: 0.1 s in sample 1"),
    ("body_pose", put((3, 1, 2), np.nan), "'body_pose' holds nan in sample 3"),
    ("body_acceleration", put((0, 0, 0), 1e300), r"'body_acceleration' holds 1e\+300 in sample 0"),
    ("joint_angle", put((2, 0), np.inf), "'joint_angle' holds inf in sample 2"),
    ("contact_force", put((2, 1), np.nan), "'contact_force' holds nan in row 2"),
    ("contact_body", put(1, -1), r"'contact_body' points outside 0\.\.5 in row 1: -1"),
    ("contact_sample", put(4, N), r"'contact_sample' points outside 0\.\.19 in row 4: 20"),
    ("contact_sample", put(4, 1), "'contact_sample' is not in order in row 4"),
    ("body_mass", put(1, np.nan), "'body_mass' holds nan in element 1"),
    ("body_inertia", put(1, -1.0), "'body_inertia' is not greater than 0"),
    ("body_centre", put((1, 0), np.inf), "'body_centre' holds inf in element 1"),
    ("meter_value", put((1, 0), 2 * LARGEST), r"'meter_value' holds 2e\+30 in sample 1"),
])
def test_numbers_that_no_run_records(saved, monkeypatch, key, change, message):
    """The numbers are checked in small pieces."""
    monkeypatch.setattr(reading, "AT_ONCE", 64)
    with pytest.raises(OutputError, match=f"run.npz is damaged: array {message}"):
        load_changed(saved, **{key: change})


def test_what_is_infinite_excuses_nothing_else(saved):
    def change(array):
        array[0], array[1] = np.inf, 0.0

    with pytest.raises(OutputError, match="'body_mass' is not greater than 0"):
        load_changed(saved, body_mass=change)


def mutate(folder, name, change):
    with zipfile.ZipFile(folder / "run.npz") as archive:
        data = json.loads(archive.read(name))
    change(data)
    damage(folder / "run.npz", **{name: json.dumps(data).encode()})


def set_in(*path, to):
    def change(data):
        for step in path[:-1]:
            data = data[step]
        data[path[-1]] = to
    return change


@pytest.mark.parametrize(("change", "message"), [
    (set_in("joints", 0, "a", to="nobody"),
     r"\$\.joints\[0\]\.a: there is no body named 'nobody'"),
    (set_in("bodies", 3, "mass", to=1e300), r"bodies\.3\.mass: 1e\+300 is too large"),
    (set_in("bodies", 3, "shapes", 0, "radius", to=0), r"must be greater than 0"),
    (set_in("groups", 0, "bodies", 0, to="\x1b[31m"), r"groups\.0\.bodies\.0: String should match"),
    (set_in("bodies", 1, "name", to="palm"), "the name 'palm' is already that of another body"),
    (set_in("bodies", to=[]), "there is no body named 'palm'.*, and 13 more"),
    (set_in("title", to=[[[]]]), "title: Input should be a valid string"),
    (set_in("bodies", to=[0] * 300_000), "the scene has 300 000 bodies"),
    (set_in("title", to=[0] * 1_100_000), "the scene has 1 100 ... values and more"),
])
def test_a_mechanism_is_held_to_what_a_scene_is_held_to(saved, change, message):
    mutate(saved, "mechanism.json", change)
    with pytest.raises(OutputError, match=f"its mechanism is not valid.*{message}") as caught:
        Recording.load(saved)
    assert "\n" not in str(caught.value)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize(("text", "message"), [
    (b'{"a": 1, "a": 2}', 'the key "a" stands here a second time'),
    (b'{"bodies": ' + b"[" * 100_000 + b"]" * 100_000 + b"}", "nest"),
    (b'{"bodies": NaN}', "NaN"),
    (b"\xff\xfe", "damaged"),
    (b" " * (reading.MOST_TEXT + 1), "has 20000001 bytes; allowed: at most 20000000"),
])
def test_texts_that_are_none(saved, text, message):
    damage(saved / "run.npz", **{"mechanism.json": text})
    with pytest.raises(OutputError, match=message):
        Recording.load(saved)


@pytest.mark.parametrize(("change", "message"), [
    (set_in("format", to=0), "does not describe a run"),
    (set_in("format", to=10**30), "has format 1000000000000000000000000000000; this version"),
    (set_in("reason", to="\ud800"), "half a character"),
    (set_in("step", to=1e300), "for 'step'"),
    (set_in("sample_rate", to=-5), "its sample_rate is"),
    (set_in("seed", to=True), "it says True for 'seed'"),
    (set_in("controllers", to={"a": 1}), "it says 1 of the controller 'a'"),
    (set_in("controllers", to={"a": {"b": json.loads("[" * 40 + "]" * 40)}}),
     "does not describe a run"),
    (set_in("events", to=[{"event": "a", "time_s": float("nan")}]), "for 'time_s'"),
])
def test_what_is_said_of_no_run(saved, change, message):
    mutate(saved, "info.json", change)
    with pytest.raises(OutputError, match=message):
        Recording.load(saved)


def rewritten(folder, change):
    """The archive written anew, its members by a function of the old name, entry and content."""
    with zipfile.ZipFile(folder / "run.npz") as old:
        kept = [(name, old.read(name)) for name in old.namelist()]
        comment = old.comment
    with zipfile.ZipFile(folder / "run.npz", "w") as new, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a name that is there twice
        new.comment = comment
        for name, content in kept:
            change(new, name, content)


@pytest.mark.parametrize(("change", "message"), [
    (lambda new, name, content: [new.writestr(name, content)
                                 for _ in range(1 + (name == "time.npy"))],
     "'time.npy' is in it twice"),
    (lambda new, name, content: new.writestr(name.replace("time.npy", "../time.npy"), content),
     r"no part of a recording is called '\.\./time\.npy'"),
    (lambda new, name, content: new.writestr(name.replace("time.npy", "/etc/time.npy"), content),
     "no part of a recording is called"),
    (lambda new, name, content: new.writestr(name.replace("time.npy", "\x1b[31m.npy"), content),
     r"no part of a recording is called '\\x1b\[31m.npy'"),
    (lambda new, name, content: new.writestr(name, content, zipfile.ZIP_BZIP2),
     "packed in a way that is not read"),
])
def test_members_that_are_not_a_recordings(saved, change, message):
    rewritten(saved, change)
    with pytest.raises(OutputError, match=message) as caught:
        Recording.load(saved)
    assert str(caught.value).isprintable()


def test_many_small_bombs_are_one(saved, monkeypatch):
    """It is all parts together that may not be too large, not each of them."""
    rewritten(saved, lambda new, name, content: new.writestr(name, content, zipfile.ZIP_DEFLATED))
    with zipfile.ZipFile(saved / "run.npz") as archive:
        total = sum(one.file_size for one in archive.infolist())
    monkeypatch.setattr(reading, "MOST_UNPACKED", total)
    assert Recording.load(saved).complete
    monkeypatch.setattr(reading, "MOST_UNPACKED", total - 1)
    with pytest.raises(OutputError, match=f"compressed parts would take {total} bytes"):
        Recording.load(saved)


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

    rewritten(saved, bomb)
    tracemalloc.start()
    with pytest.raises(OutputError, match=r"its compressed parts would take 239\d+ bytes; allowed"):
        Recording.load(saved)
    assert tracemalloc.get_traced_memory()[1] < 8e6
    tracemalloc.stop()


HEAD = "{'descr': '<f8', 'fortran_order': False, 'shape': (20,), }"


@pytest.mark.parametrize(("head", "message"), [
    (HEAD.replace("(20,)", "(10000000000,)"), "does not take the 296 bytes that it has"),
    (HEAD.replace("(20,)", "(" + "9" * 5000 + ",)"), "is not an array of numbers"),
    (HEAD.replace("(20,)", "(-20,)"), "is not an array of numbers"),
    (HEAD.replace("'<f8'", "__import__('os').abort()"), "is not an array of numbers"),
    (HEAD.replace("<f8", "|O"), "is not an array of numbers"),
    (HEAD.replace("<f8", ">f8"), "holds >f8, expected float64"),
    (HEAD.replace("<f8", "<q9"), "damaged"),
    ("(" * 100, "is not an array of numbers"),
])
def test_headers_are_read_as_they_are_written_and_never_run(saved, head, message):
    text = head.ljust(128 - 11).encode() + b"\n" if len(head) < 117 else head.encode() + b"\n"
    damage(saved / "run.npz", **{
        "time.npy": b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + bytes(8 * 21)})
    with pytest.raises(OutputError, match=message):
        Recording.load(saved)


def mapped(array):
    while array is not None and not isinstance(array, mmap.mmap):
        array = array.base
    return array is not None


def test_a_large_recording_is_mapped_and_reads_the_same(saved, monkeypatch):
    small = Recording.load(saved)
    monkeypatch.setattr(reading, "IN_MEMORY", 1000)
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


def test_loading_takes_no_memory_that_grows_with_the_recording(tmp_path, monkeypatch):
    monkeypatch.setattr(reading, "IN_MEMORY", 1 << 20)
    run = recording(n=20_000)
    run.save(tmp_path)
    del run
    assert (tmp_path / "run.npz").stat().st_size > 8e6
    tracemalloc.start()
    again = Recording.load(tmp_path)
    window = again.part(5000, 5010)
    assert window["disc.x"].shape == (10,)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 6e6


def test_a_directory_that_claims_more_than_there_is(saved):
    path = saved / "run.npz"
    content = bytearray(path.read_bytes())
    end = content.rindex(b"PK\x05\x06")
    content[end + 12:end + 16] = (1 << 30).to_bytes(4, "little")
    path.write_bytes(content)
    with pytest.raises(OutputError, match="is not a recording, or damaged"):
        Recording.load(saved)


def test_a_flipped_byte_of_a_large_recording_is_found_too(saved, monkeypatch):
    monkeypatch.setattr(reading, "IN_MEMORY", 1000)
    whole = bytearray((saved / "run.npz").read_bytes())
    place = whole.index(b"\x93NUMPY", whole.index(b"contact_normal.npy")) + 130
    whole[place] ^= 1
    (saved / "run.npz").write_bytes(whole)
    with pytest.raises(OutputError, match="Bad CRC-32"):
        Recording.load(saved)


def test_what_moves_freely_has_a_weight(saved):
    with pytest.raises(OutputError, match=r"'body_mass' has no weight for 'finger1\.proximal'"):
        load_changed(saved, body_mass=put(1, np.inf))
