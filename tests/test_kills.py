"""A short share of ``python -m tests.kills``; the whole is 200 kills."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

HOME = Path(__file__).parents[1]


@pytest.mark.nightly
@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not copied there")
def test_what_a_kill_leaves_is_whole_or_marked() -> None:
    """Kinds whose kills fall where runs are put into their directory; any seed must do."""
    done = subprocess.run(
        [sys.executable, "-m", "tests.kills", "--seed", "11", "--kills", "12", "--only", "save",
         "--only", "two saves", "--only", "two runs", "--only", "render"],
        cwd=HOME, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "0 faults" in done.stdout
    assert done.stdout.startswith("seed 11\n")
