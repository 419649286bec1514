import json

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.elements.arrays import LATE
from sandbox.engine.simulate import simulate
from sandbox.errors import OutputError
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Status
from sandbox.samples.samples import OLDER
from sandbox.scene.read.load import load_scene

from .sample import CONTACTS, N, recording
from .test_reading import damage

ALL = {"run.json", "run.npz", "contacts.csv", "tendons.csv", "joints.csv", "bodies.csv",
       "drives.csv", "springs.csv", "meters.csv"}
METERS = [{"name": "m", "value": "=1 / disc.contact.normal", "unit": "1/N"}]


def sample(**options):
    options = {"contacts": CONTACTS, "meters": METERS, **options}
    return recording(**options)


def files(folder):
    return {path.name for path in folder.iterdir()}


def test_arrays_that_came_late_are_nan_in_recordings_without_them(tmp_path):
    assert {"joint_force", "contact_merged"} <= set(LATE)
    for array in ("joint_force", "contact_merged"):
        sample(contacts=CONTACTS).save(tmp_path / array)
        damage(tmp_path / array / "run.npz", **{f"{array}.npy": None})
        again = Recording.load(tmp_path / array)
        assert np.isnan(again.arrays[array]).all()
        assert len(again.arrays[array]) == (5 if array.startswith("contact_") else len(again))
        assert len(again.part(2, 5).arrays[array]) == 3
    old = Recording.load(tmp_path / "joint_force")
    assert np.isnan(old["finger1.mcp.reaction_x"]).all()
    assert any("no directions of forces" in note for note in old.notes)
    assert not sample().notes[1:]
    figure = next(f for f in audit(old) if f.name == "momentum.force")
    assert (figure.verdict, figure.why) == ("not computed", OLDER)
    old.save(tmp_path / "again")
    assert Recording.load(tmp_path / "again").notes == old.notes


def test_means_without_some_of_their_arrays_are_refused(tmp_path):
    run = simulate(load_scene("single_finger", overrides={"run.duration": 0.01}))
    run.save(tmp_path)
    damage(tmp_path / "run.npz", **{"mean_force.npy": None})
    with pytest.raises(OutputError, match="array 'mean_force' is missing"):
        Recording.load(tmp_path)


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
    sample(n=5, info={"complete": False, "reason": "interrupted"}).save(tmp_path)
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


def test_nothing_to_load(tmp_path):
    with pytest.raises(OutputError, match=r"there is no directory .*nowhere"):
        Recording.load(tmp_path / "nowhere")
    with pytest.raises(OutputError, match=r"there is no recording in .*: run.npz is missing"):
        Recording.load(tmp_path)
    (tmp_path / "run.npz").mkdir()
    with pytest.raises(OutputError, match="cannot read"):
        Recording.load(tmp_path)


def test_any_cut_of_an_archive_is_refused(tmp_path):
    sample().save(tmp_path)
    whole = (tmp_path / "run.npz").read_bytes()
    for length in range(0, len(whole), len(whole) // 10):
        (tmp_path / "run.npz").write_bytes(whole[:length])
        with pytest.raises(OutputError, match="damaged"):
            Recording.load(tmp_path)
