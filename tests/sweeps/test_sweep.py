"""Sweeps in worker processes, interrupted and resumed."""

import json
import multiprocessing
import os
import subprocess
import sys
from contextlib import ExitStack

import numpy as np
import pytest

import sandbox
from sandbox.errors import OutputError
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.load import read_scene
from sandbox.sweeps.job import Log, SweepRow, make_bundle
from sandbox.sweeps.plan import plan_of
from sandbox.sweeps.sweep import run_plan, study_data
from sandbox.sweeps.workers import Processes
from tests.sweeps.scenes import PUCK, InProcess

LAST = 0.1 - 0.5e-3
"""When the last sample is [s]: in the middle of the last step."""


@pytest.fixture
def in_process(monkeypatch):
    monkeypatch.setattr("sandbox.sweeps.workers.Processes", InProcess)


def study(vary="1:6:6", **more):
    return study_data(PUCK, vary={"parameters.push": vary}, keep=["v=puck.vx", "twice==2 * v"],
                      audit=False, **more)


def run(data, folder=None, **more):
    return run_plan(plan_of(data), folder, **{"workers": 2, **more})


def test_each_row_is_what_its_values_give(tmp_path):
    table = run(study(), tmp_path)
    assert table["v"] == pytest.approx(np.arange(1, 7) * LAST, rel=1e-12)
    assert table["twice"].tolist() == (2 * table["v"]).tolist()
    assert table["parameters.push"].tolist() == [1, 2, 3, 4, 5, 6]
    assert table["holds"] == [force * LAST >= 0.25 for force in range(1, 7)]
    assert table["failed"][0] == "puck.vx"
    assert table.plan.units == {"parameters.push": "N", "v": "m/s", "twice": ""}


@pytest.mark.usefixtures("in_process")
def test_finished_runs_are_not_repeated(tmp_path):
    run(study("1:3:3"), tmp_path)
    advances = []
    table = run(study("1:6:6"), tmp_path, progress=advances.append)
    assert [(at.before, at.done) for at in advances] == [(3, 1), (3, 2), (3, 3)]
    assert table.count == 6
    again = []
    assert run(study("1:6:6"), tmp_path, progress=again.append).count == 6
    assert again == []
    run(study("1:6:6"), tmp_path, again=True, progress=again.append)
    assert len(again) == 6


@pytest.mark.usefixtures("in_process")
def test_rows_of_another_scene_or_of_other_quantities_are_not_taken(tmp_path):
    run(study("1:3:3"), tmp_path)
    heavier = {**study("1:3:3"), "set": {"parameters.m": 2}}
    assert run(heavier, tmp_path)["v"] == pytest.approx(np.arange(1, 4) * LAST / 2, rel=1e-12)
    other = {**study("1:3:3"), "keep": {"v": "max puck.x"}}
    assert (run(other, tmp_path)["v"] < 0.02).all()


@pytest.mark.usefixtures("in_process")
def test_runs_that_do_not_end_well_are_rows_with_their_reason():
    scene = {**PUCK, "run": {**PUCK["run"], "duration": "0.2 s"}}
    data = study_data(scene, vary={"parameters.push": "2, 1e12"}, keep=["v=puck.vx"], audit=False)
    table = run(data)
    assert table["status"] == ["done", "diverged"]
    assert "puck" in table["reason"][1]
    assert np.isnan(table["v"][1])
    assert table["holds"] == [True, None]


@pytest.mark.usefixtures("in_process")
def test_ctrl_c_keeps_finished_runs(tmp_path):
    def stop(at):
        if at.done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(study(), tmp_path, progress=stop)
    assert json.loads((tmp_path / "sweep.json").read_text())["ended"] == "interrupted"
    assert len(list(Log(tmp_path).rows())) == 2
    assert (tmp_path / "table.csv").read_text().count(",done,") == 2
    assert run(study(), tmp_path).count == 6


# -- nothing lost --------------------------------------------------------------------


def test_a_worker_that_is_killed_loses_nothing(tmp_path):
    def kill(at):
        if at.done == 1:
            multiprocessing.active_children()[0].kill()

    table = run(study("1:12:12"), tmp_path, progress=kill)
    assert table["status"] == ["done"] * 12
    assert table["v"] == pytest.approx(np.arange(1, 13) * LAST, rel=1e-12)


class _Deadly(Processes):
    """One run ends its process."""

    bad = ""

    def _submit(self, task):
        return self._pool.submit(os._exit, 7) if task[0] == self.bad else super()._submit(task)


def test_a_run_that_ends_two_processes_is_given_up_and_the_others_finish():
    plan = plan_of(study("1:6:6"))
    _Deadly.bad = plan.ids[2]
    with ExitStack() as stack:
        rows = {row.id: row for row in _Deadly(plan.job, 2, stack).results(
            zip(plan.ids, plan.points, strict=True))}
    assert [rows[id].status for id in plan.ids] == ["done", "done", "died", *["done"] * 3]
    assert "2 worker processes" in rows[plan.ids[2]].reason


@pytest.mark.nightly
def test_a_script_without_a_guard_gets_a_message(tmp_path):
    script = tmp_path / "script.py"
    script.write_text("import sandbox\nsandbox.sweep('single_finger', vary={'parameters.pull': "
                      "[1, 2]}, workers=1)\n")
    words = subprocess.run([sys.executable, str(script)], capture_output=True, text=True,
                          timeout=100)
    assert words.stderr.splitlines()[-1].endswith('under if __name__ == "__main__":')


# -- the log -------------------------------------------------------------------------


def test_a_line_that_was_cut_off_is_taken_away(tmp_path):
    row = SweepRow("0" * 16, "done", kept={"v": 1.0})
    with Log(tmp_path) as log:
        log.add(row)
    path = tmp_path / "rows" / "00000.jsonl"
    path.write_bytes(path.read_bytes() + b'{"id": "12')
    assert list(Log(tmp_path).rows()) == [row]
    other = SweepRow("1" * 16, "died", reason="it did")
    with Log(tmp_path) as log:
        log.add(other)
    assert list(Log(tmp_path).rows()) == [row, other]


def test_two_processes_do_not_write_one_sweep(tmp_path):
    with Log(tmp_path), pytest.raises(OutputError, match="another process"), Log(tmp_path):
        pass


@pytest.mark.parametrize("line", [b"nothing\n", b"{}\n", b'{"id": "0", "status": "well"}\n'])
def test_a_corrupt_row_is_an_error(tmp_path, line):
    folder = tmp_path / "rows"
    folder.mkdir()
    (folder / "00000.jsonl").write_bytes(line)
    with pytest.raises(OutputError, match=r"00000\.jsonl:1"):
        list(Log(tmp_path).rows())


# -- files ---------------------------------------------------------------------------


@pytest.mark.usefixtures("in_process")
def test_the_table_is_read_back_by_pandas(tmp_path):
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    table = run(study(), tmp_path)
    for back in (pandas.read_parquet(tmp_path / "table.parquet"),
                 pandas.read_csv(tmp_path / "table.csv")):
        assert list(back.columns) == list(table.columns())
        assert back["v"].tolist() == table["v"].tolist()
        assert back["holds"].tolist() == table["holds"]
    frame = table.to_pandas()
    assert frame["v"].tolist() == table["v"].tolist()
    assert frame.attrs["units"]["v"] == "m/s"


@pytest.mark.usefixtures("in_process")
def test_recordings_that_are_requested_later_are_made(tmp_path):
    run(study("1, 2"), tmp_path)
    again = []
    table = run(study("1, 2, 3", recordings=True), tmp_path)
    run(study("1, 2, 3", recordings=True), tmp_path, progress=again.append)
    assert again == []
    for run_, id in enumerate(table.ids):
        kept = sandbox.Recording.load(tmp_path / "runs" / id)
        assert kept["puck.vx"][-1] == table["v"][run_]


def test_a_bundle_has_the_scenes_that_a_varied_include_names(tmp_path):
    def scene(name, **more):
        (tmp_path / f"{name}.json").write_text(json.dumps({"name": name, **more}))

    body = [{"name": "body", "motion": "fixed", "shapes": [{"type": "circle", "radius": "5 mm"}]}]
    scene("hand", parts=[{"include": "disc", "name": "object"}])
    scene("disc", bodies=body)
    scene("square", parts=[{"include": "corner", "name": "one"}])
    scene("corner", bodies=body)
    scene("other", bodies=body)
    bundle, _ = make_bundle(tmp_path / "hand.json", {}, Limits(), also=[["disc", "square"]])
    assert set(bundle.files) == {"hand.json", "disc.json", "square.json", "corner.json"}
    with bundle.unpacked() as main:
        found = read_scene(main, overrides={"parts[object].include": "square"})
    assert [each.name for each in found.mechanism.bodies] == ["object.one.body"]
