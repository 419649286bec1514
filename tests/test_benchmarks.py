"""The benchmarks work; how fast things are is theirs to say, not a test's."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent


@pytest.mark.nightly
def test_the_benchmarks_measure(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks", "--quick", "--json", "--draw", str(tmp_path)],
        cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode in (0, 1), done.stderr
    assert list(tmp_path.glob("*.png"))
    figures = json.loads(done.stdout)["figures"]
    assert any(figure["most"] is not None or figure["least"] is not None for figure in figures)
