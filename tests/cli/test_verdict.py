"""The audit as ``sandbox run`` shows it."""

from __future__ import annotations

import json
import math
import re

from sandbox.audit.figures import judged, missing
from sandbox.cli.verdict import MOST_ROWS, audit_lines, audit_table, expectation_table
from sandbox.samples.expectations import Verdict

FIGURES = [
    judged("poses", 1.5e-13, "m", 1e-12, why="all is well", source="(31)"),
    judged("joint.drift", 2e-3, "m", 1e-6, why="the pin came apart", source=""),
    judged("energy.lost", math.nan, "", 1e-3, why="no number", source=""),
    missing("differential", why="there is no tree", source="(4)-(7)"),
]


def test_the_table_is_short_and_says_where_to_read_on():
    lines = audit_table(FIGURES)
    assert lines[1].split()[:5] == ["poses", "1.5e-13", "1e-12", "m", "pass"]
    assert lines[1].endswith("  are the links where their hinge angles put them?")
    assert lines[2].split()[4] == "look"
    assert "look joint.drift (0.002 m, at most 1e-06): the pin came apart" in lines
    assert "not computed, since the scene has none of it or the run kept too little (run.json " \
        "says which): differential" in lines
    assert lines[-1] == "audit: 1 of 3 figures pass, 2 to look at; docs/audit.md explains them"


def test_one_line_before_it_what_to_look_at_and_all_rows_on_wish():
    fine = [FIGURES[0], FIGURES[3]]
    assert audit_lines(fine, whole=False) == ["audit: 1 of 1 figures pass; --audit shows them"]
    assert audit_lines(fine, whole=True) == audit_table(fine)
    looks = audit_lines(FIGURES, whole=False)
    assert [line.partition(":")[0] for line in looks] == [
        "look joint.drift (0.002 m, at most 1e-06)", "  it means", "  what to do",
        "look energy.lost (-, at most 0.001)", "  it means",
        "  what to do", "audit"]
    assert looks[-1] == "audit: 1 of 3 figures pass, 2 to look at; --audit shows them, " \
        "docs/audit.md explains them"
    assert looks[:-1] == [line for line in audit_table(FIGURES) if line in looks]


def test_many_expectations_that_hold_are_counted_and_failures_have_rows():
    hold = [verdict(f"q{i}", ok=True) for i in range(MOST_ROWS)]
    assert len(expectation_table(hold)) == MOST_ROWS + 2
    assert expectation_table([*hold, verdict("more", ok=True)]) == [
        "13 of 13 expectations hold; run.json has them all"]
    lines = expectation_table([*hold, verdict("bad", ok=False)])
    assert [line.split()[0] for line in lines[:-1]] == ["expectation", "bad", "FAIL", "12"]
    assert lines[-1] == "see docs/messages.md#expectation-failed"


def verdict(name, *, ok):
    return Verdict(quantity=name, statistic="mean", unit="N", value=1.0, low=0.0, high=2.0, ok=ok,
                   reason="" if ok else "no")


def test_run_shows_and_keeps_the_audit(sandbox, scene, tmp_path):
    said = sandbox("run", scene(), "--no-render", "--out", tmp_path / "shown")
    assert said.code == 0
    assert re.search(r"^audit: (\d+) of \1 figures pass; --audit shows them$", said.out, re.M)
    assert "momentum.force" not in said.out
    said = sandbox("run", scene(), "--no-render", "--audit", "--out", tmp_path / "shown")
    assert "docs/audit.md" in said.out
    assert "is F = m a for every body?" in said.out
    kept = json.loads((tmp_path / "shown" / "run.json").read_text())
    assert {"momentum.force", "energy.created"} <= {f["name"] for f in kept["audit"]}
    assert kept["wall_s"]["audit"] > 0
