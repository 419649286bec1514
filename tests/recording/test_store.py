import io
import json
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.elements.arrays import LATE
from sandbox.engine.simulate import simulate
from sandbox.errors import OutputError
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Happened, Status, Stop
from sandbox.samples.samples import OLDER
from sandbox.scene.read.load import load_scene

from .sample import CONTACTS, N, recording

ALL = {"run.json", "run.npz", "contacts.csv", "tendons.csv", "joints.csv", "bodies.csv",
       "drives.csv", "springs.csv", "meters.csv"}
METERS = [{"name": "m", "value": "=1 / disc.contact.normal", "unit": "1/N"}]


def sample(**options):
    options = {"contacts": CONTACTS, "meters": METERS, **options}
    return recording(**options)


def files(folder):
    return {path.name for path in folder.iterdir()}


def without(folder, array):
    """The recording in a folder as it would be had it been made before ``array`` was."""
    path = folder / "run.npz"
    with zipfile.ZipFile(path) as old:
        kept = {name: old.read(name) for name in old.namelist() if name != f"{array}.npy"}
        comment = old.comment
    with zipfile.ZipFile(path, "w") as new:
        new.comment = comment
        for name, content in kept.items():
            new.writestr(name, content)
    return folder


def test_arrays_that_came_late_are_nan_in_recordings_without_them(tmp_path):
    assert {"joint_force", "contact_merged"} <= set(LATE)
    for array in ("joint_force", "contact_merged"):
        sample(contacts=CONTACTS).save(tmp_path / array)
        again = Recording.load(without(tmp_path / array, array))
        assert np.isnan(again.arrays[array]).all()
        assert len(again.arrays[array]) == (5 if array.startswith("contact_") else len(again))
        assert len(again.part(2, 5).arrays[array]) == 3
    old = Recording.load(tmp_path / "joint_force")
    assert np.isnan(old["finger1.mcp.reaction_x"]).all()
    assert any("before joints' forces were kept" in note for note in old.notes)
    assert not sample().notes[1:]
    figure = next(f for f in audit(old) if f.name == "momentum.force")
    assert (figure.verdict, figure.why) == ("not computed", OLDER)
    old.save(tmp_path / "again")
    assert Recording.load(tmp_path / "again").notes == old.notes


def test_means_without_some_of_their_arrays_are_refused(tmp_path):
    run = simulate(load_scene("single_finger", overrides={"run.duration": 0.01}))
    run.save(tmp_path)
    with pytest.raises(OutputError, match="array 'mean_force' is missing"):
        Recording.load(without(tmp_path, "mean_force"))


def test_what_is_saved_is_what_is_loaded(tmp_path):
    run = sample(view={"width": 0.2}, drives=[
        {"type": "force", "name": "f", "body": "disc", "direction": [1, 0], "value": "=sin(t)"},
        {"type": "force", "name": "g", "body": "disc", "direction": [1, 0],
         "value": {"to": 2, "over": 1}}])
    run.save(tmp_path / "new" / "folder", parameters={"pull": 15.0})
    assert files(tmp_path / "new" / "folder") == ALL
    again = Recording.load(tmp_path / "new" / "folder")
    assert again.mechanism == run.mechanism
    assert again.complete
    assert len(again) == N
    assert again.notes == run.notes
    assert len(run.notes) == 1
    for key, array in run.arrays.items():
        assert np.array_equal(again.arrays[key], array), key
        assert again.arrays[key].dtype == array.dtype
    for name in run.names():
        assert np.array_equal(again[name], run[name], equal_nan=True), name


def test_numpy_reads_the_archive_without_pickle(tmp_path):
    run = sample()
    run.save(tmp_path)
    with np.load(tmp_path / "run.npz", allow_pickle=False) as content:
        assert np.array_equal(content["body_pose"], run.arrays["body_pose"])
        assert np.array_equal(content["meter_value"][:, 0], run["m"], equal_nan=True)
        assert json.loads(content["mechanism.json"])["name"] == "sample"
    with zipfile.ZipFile(tmp_path / "run.npz") as content:
        names = content.namelist()
        assert names[:-2] == sorted(names[:-2])
        assert len(names) > 20
        assert content.testzip() is None
        assert {info.date_time for info in content.infolist()} == {(1980, 1, 1, 0, 0, 0)}


def test_the_summary_says_what_was_run(tmp_path):
    run = sample(expect=[{"max": "m", "below": 1, "because": "no reason"},
                         {"final": "disc.x", "above": 0}])
    run.save(tmp_path, parameters={"pull": 15.0})
    said = json.loads((tmp_path / "run.json").read_text(encoding="utf-8"))
    assert said["complete"] is True
    assert said["title"] == "A sample"
    assert said["parameters"] == {"pull": 15.0}
    assert (said["seed"], said["step_s"], said["samples"]) == (0, 0.01, N)
    assert said["versions"] == {"sandbox": "0"}
    assert said["platform"]
    first, second = said["expectations"]
    assert first["ok"] is False
    assert first["value"] is None
    assert first["low"] is None
    assert first["because"] == "no reason"
    assert "no value" in first["reason"]
    assert second["ok"] is True
    assert second["quantity"] == "disc.x"
    assert said["scene"]["bodies"][1]["name"] == "finger1.proximal"


def test_an_incomplete_run_never_looks_complete(tmp_path):
    sample().save(tmp_path)
    sample(n=5, info={"status": Status.INTERRUPTED, "reason": "interrupted"}).save(tmp_path)
    assert files(tmp_path) == ALL - {"run.json"} | {"run.incomplete.json"}
    said = json.loads((tmp_path / "run.incomplete.json").read_text())
    assert said["complete"] is False
    assert said["reason"] == "interrupted"
    again = Recording.load(tmp_path)
    assert not again.complete
    assert len(again) == 5
    assert (again.info.status, again.info.reason) == (Status.INTERRUPTED, "interrupted")
    sample().save(tmp_path)
    assert files(tmp_path) == ALL


CONTROLLED = {
    "status": Status.STOPPED, "stopped": Stop("far", "fail", 0.15, "it must stay near"),
    "events": (Happened("tap", 0.02), Happened("far", 0.15)),
    "controllers": {"tuner": {"tuned": True, "kp": 0.5}}, "steps": 20, "notes": ("a note",)}


def test_what_events_and_laws_did_is_kept(tmp_path):
    run = recording(info=CONTROLLED)
    run.save(tmp_path)
    assert Recording.load(tmp_path).info == replace(run.info, wall={})
    said = json.loads((tmp_path / "run.json").read_text())
    assert said["events"] == [{"event": "tap", "time_s": 0.02}, {"event": "far", "time_s": 0.15}]
    assert said["stopped"] == {
        "event": "far", "verdict": "fail", "time_s": 0.15, "because": "it must stay near"}
    assert said["controllers"] == {"tuner": {"tuned": True, "kp": 0.5}}
    with zipfile.ZipFile(tmp_path / "run.npz") as content:
        told = json.loads(content.read("info.json"))
    assert {key: told[key] for key in ("events", "stopped", "controllers")} == {
        key: said[key] for key in ("events", "stopped", "controllers")}


def test_saving_again_removes_files_that_no_longer_belong(tmp_path):
    sample().save(tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    sample(meters=[], springs=[]).save(tmp_path)
    assert files(tmp_path) == ALL - {"springs.csv", "meters.csv"} | {"notes.txt"}


def test_a_directory_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=r"cannot write .*file"):
        sample().save(tmp_path / "file")
    with pytest.raises(OutputError, match=r"cannot write .*under: Not a directory"):
        sample().save(tmp_path / "file" / "under")
    (tmp_path / "out" / "run.npz").mkdir(parents=True)
    with pytest.raises(OutputError, match="cannot write"):
        sample().save(tmp_path / "out")


@pytest.mark.skipif(sys.platform == "win32", reason="no file size limit there")
def test_a_disk_that_fills_leaves_one_plain_message_and_the_old_run(tmp_path):
    script = (
        "import pathlib, resource, sys\n"
        "sys.path.insert(0, sys.argv[2])\n"
        "from recording.test_store import sample\n"
        "from sandbox.errors import OutputError\n"
        "run, folder = sample(), pathlib.Path(sys.argv[1])\n"
        "run.save(folder)\n"
        "largest = (folder / 'run.npz').stat().st_size\n"
        "for limit in (0, 100, largest // 2, largest - 1, largest):\n"
        "    hard = resource.getrlimit(resource.RLIMIT_FSIZE)[1]\n"
        "    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, hard))\n"
        "    try:\n        run.save(folder)\n"
        "    except OutputError as error:\n        print(error)\n"
        "    print(len(list(folder.iterdir())), 'files')\n")
    folder = tmp_path / "run"
    done = subprocess.run(
        [sys.executable, "-c", script, str(folder), str(Path(__file__).parents[1])],
        capture_output=True, text=True, check=True)
    failed = f"cannot write {folder / 'run.npz'}: File too large\n{len(ALL)} files\n"
    assert done.stdout == 4 * failed + f"{len(ALL)} files\n"
    assert done.stderr == ""


def damage(path, **members):
    """The archive with some members replaced; None leaves one out."""
    with zipfile.ZipFile(path) as old:
        content, comment = {name: old.read(name) for name in old.namelist()}, old.comment
    with zipfile.ZipFile(path, "w") as new:
        new.comment = comment
        for name, data in {**content, **members}.items():
            if data is not None:
                new.writestr(name, data)


def npy(array):
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=True)
    return stream.getvalue()


def test_nothing_to_load(tmp_path):
    with pytest.raises(OutputError, match=r"there is no directory .*nowhere"):
        Recording.load(tmp_path / "nowhere")
    with pytest.raises(OutputError, match=r"there is no recording in .*: run.npz is missing"):
        Recording.load(tmp_path)
    (tmp_path / "run.npz").mkdir()
    with pytest.raises(OutputError, match="cannot read"):
        Recording.load(tmp_path)


@pytest.mark.parametrize("content", [b"", b"garbage", b"PK\x03\x04" + bytes(100)])
def test_garbage_is_not_a_recording(tmp_path, content):
    (tmp_path / "run.npz").write_bytes(content)
    with pytest.raises(OutputError, match="is not a recording, or damaged"):
        Recording.load(tmp_path)


@pytest.mark.parametrize(("members", "message"), [
    ({"time.npy": None}, "'time' is missing"),
    ({"info.json": None}, "it has no 'info.json'"),
    ({"info.json": b"[1]"}, "does not describe a run"),
    ({"info.json": b'{"format": 1, "step": "x"}'}, "it says 'x' for 'step'"),
    ({"info.json": b'{"format": 1, "events": [{"event": "a"}]}'}, "it says None for 'time_s'"),
    ({"info.json": b'{"format": 1, "stopped": {"verdict": "no"}}'}, "has the verdict 'no'"),
    ({"info.json": b'{"format": 2, "complete": true}'}, "format 2; this version reads up to 1"),
    ({"mechanism.json": b'{"bodies": 3}'}, "mechanism is not valid"),
    ({"time.npy": b"nonsense"}, "damaged"),
    ({"time.npy": npy(np.zeros(N))[:-8]}, "damaged"),
    ({"time.npy": npy(np.zeros(N, dtype=np.float32))}, "holds float32, expected float64"),
    ({"body_mass.npy": npy(np.float64(3.0))}, "has shape"),
])
def test_a_damaged_archive_is_refused_in_a_line(tmp_path, members, message):
    sample().save(tmp_path)
    damage(tmp_path / "run.npz", **members)
    with pytest.raises(OutputError, match=message) as caught:
        Recording.load(tmp_path)
    assert "\n" not in str(caught.value)


class Trap:
    """Touches a file when it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return Path.touch, (self.path,)


def test_nothing_is_ever_unpickled(tmp_path):
    sample().save(tmp_path)
    trap = npy(np.array([Trap(tmp_path / "sprung")] * N, dtype=object))
    damage(tmp_path / "run.npz", **{"time.npy": trap})
    with pytest.raises(OutputError, match="damaged"):
        Recording.load(tmp_path)
    assert not (tmp_path / "sprung").exists()


def test_any_cut_of_an_archive_is_refused(tmp_path):
    sample().save(tmp_path)
    whole = (tmp_path / "run.npz").read_bytes()
    for length in range(0, len(whole), len(whole) // 10):
        (tmp_path / "run.npz").write_bytes(whole[:length])
        with pytest.raises(OutputError):
            Recording.load(tmp_path)


def test_a_flipped_byte_is_found_by_its_checksum(tmp_path):
    sample().save(tmp_path)
    whole = bytearray((tmp_path / "run.npz").read_bytes())
    place = whole.index(b"\x93NUMPY") + 200  # in the numbers of the first array
    whole[place] ^= 1
    (tmp_path / "run.npz").write_bytes(whole)
    with pytest.raises(OutputError, match="CRC"):
        Recording.load(tmp_path)
