"""The benchmarks work; how fast things are is theirs to say, not a test's."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
SCRIPT = """
import sys
import sandbox.cli  # the one under test, before a checkout's can be found
sys.path.insert(0, sys.argv[1])
from benchmarks.__main__ import main
sys.exit(main(sys.argv[2:]))
"""


@pytest.mark.parametrize("name", ["step_loop", "control", "drawing", "scaling", "audit", "page",
                                  "rest", "accuracy", "work_precision", "view", "gym"])
def test_a_benchmark_measures(name: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(ROOT), "--quick", "--json", "--only", name,
         "--draw", str(tmp_path)],
        cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode in (0, 1)
    assert done.stdout, done.stderr
    assert {path.stem for path in tmp_path.glob("*.png")} == ({
        "work_precision_pose", "work_precision_forces"} if name == "work_precision" else set())
    figures = json.loads(done.stdout)["figures"]
    assert any(figure["most"] is not None or figure["least"] is not None for figure in figures)
    differences = ("std", "all that acts")  # which noise can make negative
    assert all(figure["value"] > 0 or any(word in figure["name"] for word in differences)
               for figure in figures)
    if name in ("rest", "accuracy"):  # these do not depend on the machine
        assert [figure for figure in figures if not figure["ok"]] == []
