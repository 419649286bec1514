"""The audit as ``sandbox run`` shows it."""

from __future__ import annotations

import json
import math

from sandbox.audit.figures import judged, missing
from sandbox.cli.verdict import audit_table

FIGURES = [
    judged("poses", 1.5e-13, "m", 1e-12, why="all is well", source="(31)"),
    judged("joint.drift", 2e-3, "m", 1e-6, why="the pin came apart", source=""),
    judged("energy.lost", math.nan, "", 1e-3, why="no number", source=""),
    missing("differential", why="there is no tree", source="(4)-(7)"),
]


def test_the_table_is_short_and_says_where_to_read_on():
    lines = audit_table(FIGURES)
    assert lines[1].split() == ["poses", "1.5e-13", "1e-12", "m", "pass"]
    assert lines[2].split()[-1] == "look"
    assert "look joint.drift: the pin came apart" in lines
    assert "not computed: differential (run.json says why)" in lines
    assert lines[-1] == "1 of 3 figures pass; docs/audit.md explains them"


def test_a_value_that_is_none_is_no_pass():
    assert FIGURES[2].verdict == "look"
    assert judged("x", 0.0, "", math.nan, why="", source="").verdict == "look"


def test_run_shows_and_keeps_the_audit(sandbox, scene, tmp_path):
    said = sandbox("run", scene(), "--no-render", "--out", tmp_path / "shown")
    assert said.code == 0
    assert "docs/audit.md" in said.out
    assert "momentum.force" in said.out
    kept = json.loads((tmp_path / "shown" / "run.json").read_text())
    assert {"momentum.force", "energy.created"} <= {f["name"] for f in kept["audit"]}
    assert kept["wall_s"]["audit"] > 0


def test_no_audit_leaves_it_out(sandbox, scene, tmp_path):
    said = sandbox("run", scene(), "--no-render", "--no-audit", "--out", tmp_path / "without")
    assert "docs/audit.md" not in said.out
    kept = json.loads((tmp_path / "without" / "run.json").read_text())
    assert kept["audit"] == []


def test_json_has_the_figures(sandbox, scene):
    result = json.loads(sandbox("run", scene(), "--no-render", "--json").out)
    assert result["audit_page"] == "docs/audit.md"
    assert {f["verdict"] for f in result["audit"]} <= {"pass", "look", "not computed"}
    assert all(f["why"] for f in result["audit"])
