"""The same study on a Dask cluster: a scheduler and workers in processes of their own."""

import importlib.util
import re
import subprocess
import sys
import time

import pytest

from sandbox.errors import SandboxError
from sandbox.sweeps.plan import plan_of
from sandbox.sweeps.sweep import run_plan, study_data
from tests.sweeps.scenes import PUCK

pytestmark = [pytest.mark.nightly, pytest.mark.skipif(
    importlib.util.find_spec("distributed") is None, reason="needs distributed")]
# what Dask leaves open when workers are killed is its own affair
quiet = pytest.mark.filterwarnings("ignore")


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cluster")
    log = (folder / "scheduler.log").open("w+")
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler"]
    scheduler = subprocess.Popen([*dask, "--port", "0", "--no-dashboard", "--host", "127.0.0.1"],
                                 stdout=log, stderr=subprocess.STDOUT, cwd=folder)
    address = _matched(folder / "scheduler.log", r"Scheduler at:\s+(tcp://\S+)")
    workers = [subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_worker", address, "--nthreads", "1",
         "--no-nanny", "--no-dashboard", "--local-directory", str(folder)],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=folder) for _ in range(2)]
    monkeypatch = pytest.MonkeyPatch()
    monkeypatch.setattr("sandbox.sweeps.workers.CONNECT_TIMEOUT", 100.0)  # a busy machine
    yield address, workers
    monkeypatch.undo()
    for process in (*workers, scheduler):
        process.kill()
        process.wait()
    log.close()


def _matched(path, pattern):
    deadline = time.monotonic() + 100
    while time.monotonic() < deadline:
        if found := re.search(pattern, path.read_text()):
            return found[1]
        time.sleep(0.05)
    raise AssertionError(path.read_text())


def study(count):
    return plan_of(study_data(PUCK, vary={"parameters.push": f"1:{count}:{count}"},
                              keep=["v=puck.vx"]))


@quiet
def test_a_cluster_gives_the_same_bytes(cluster, tmp_path):
    address, _ = cluster
    run_plan(study(20), tmp_path / "there", workers=address)
    run_plan(study(20), tmp_path / "here", workers=1)
    for name in ("table.csv", "table.parquet"):
        assert (tmp_path / "there" / name).read_bytes() == (tmp_path / "here" / name).read_bytes()


@quiet
def test_a_worker_of_the_cluster_that_dies_loses_nothing(cluster, tmp_path):
    address, workers = cluster

    def kill(at):
        if at.done == 3:
            workers[0].kill()

    table = run_plan(study(60), tmp_path, workers=address, progress=kill)
    assert table["status"] == ["done"] * 60


@quiet
@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "tcp://127.0.0.1:no"])
def test_a_cluster_that_does_not_answer(address, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sandbox.sweeps.workers.CONNECT_TIMEOUT", 1.0)
    with pytest.raises(SandboxError, match=f"cluster '{address}' cannot be reached"):
        run_plan(study(2), None, workers=address)
