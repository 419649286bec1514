"""``sandbox report`` and ``run --report`` as a user has them."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from sandbox.recording.store import saved_audit
from sandbox.samples.outcome import INTERRUPTED, Status
from tests.cli.conftest import BALL
from tests.samples.controlled import recording, scene


@pytest.fixture
def runs(sandbox):
    """Two runs in renders/ of an empty directory."""
    recording(reach=(1, 1, 0.5)).save("renders/controlled")
    recording(scene("other"), zeta=0.3, omega=9).save("renders/other")


@pytest.mark.usefixtures("runs")
def test_a_page_of_a_run_lies_beside_it(sandbox):
    said = sandbox("report", "controlled")
    assert said.code == 0
    assert said.out.startswith("renders/controlled/report.html  (")
    page = Path("renders/controlled/report.html").read_text()
    assert page.count("data-run>") == 1
    # what was made of a run goes when a new one takes its place
    recording().save("renders/controlled")
    assert not Path("renders/controlled/report.html").exists()


@pytest.mark.usefixtures("runs")
def test_several_runs_go_into_one_page(sandbox):
    said = sandbox("report", "controlled", "renders/other", "--out", "both.html", "--json")
    told = json.loads(said.out)
    assert told["runs"] == ["renders/controlled", "renders/other"]
    assert told["bytes"] == Path(told["file"]).stat().st_size
    assert Path("both.html").read_text().count("data-run>") == 2


@pytest.mark.usefixtures("runs")
def test_a_quantity_that_is_none_is_told_with_a_near_miss(sandbox):
    said = sandbox("report", "controlled", "--plot", "finger.mcp.angel")
    assert said.code == 2
    assert "Did you mean 'finger.mcp.angle'?" in said.err
    assert sandbox("report", "controlled", "--plot", "finger.*.angle").code == 0
    head = Path("renders/controlled/report.html").read_text()
    plots = json.loads(re.search(r'"plots":(\[.*?\])', head)[1])
    assert {"finger.mcp.angle", "finger.pip.angle", "finger.dip.angle"} <= set(plots)
    assert all(name.endswith(".angle") for name in plots)


@pytest.mark.usefixtures("runs")
def test_what_is_no_run_or_no_page_is_refused(sandbox):
    assert "did you mean 'controlled'" in sandbox("report", "controled").err
    said = sandbox("report", "controlled", "--out", "page.txt")
    assert said.code == 2
    assert "does not end in .html" in said.err
    assert "no directory" in sandbox("report", "controlled", "--out", "no/where/page.html").err


def test_a_run_that_is_not_complete_is_shown_and_told(sandbox):
    run = recording()
    info = replace(run.info, status=Status.INTERRUPTED, reason=INTERRUPTED)
    type(run)(run.mechanism, run.arrays, info).save("renders/stopped")
    said = sandbox("report", "stopped")
    assert said.code == 0
    assert "was interrupted" in said.err
    assert '"complete":false' in Path("renders/stopped/report.html").read_text()


def test_run_writes_the_page_with_verdicts_and_audit(sandbox):
    Path("ball.json").write_text(json.dumps(BALL))
    said = sandbox("run", "ball.json", "--report", "--no-render", "--json")
    told = json.loads(said.out)
    assert "report.html" in told["files"]
    page = Path("renders/ball/report.html").read_text()
    assert '"ok":true' in page
    assert '"verdict":"pass"' in page
    assert sandbox("report", "ball", "--out", "again.html").code == 0
    again = Path("again.html").read_text()
    assert [f["name"] for f in told["audit"]] == [f.name for f in saved_audit(Path("renders/ball"))]
    # the page of the saved run is that of the run, but for what a file's digits lose
    assert len(again) == pytest.approx(len(page), rel=0.01)
