"""The wheel holds what a user needs and works away from the checkout."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import sandbox

ROOT = Path(__file__).parent.parent
pytestmark = pytest.mark.nightly


def test_the_wheel_holds_all_that_it_needs_and_runs(tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)],
                   cwd=ROOT, check=True, capture_output=True)
    wheel, = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        archive.extractall(tmp_path / "site")
    wanted = {path.relative_to(ROOT).as_posix() for path in (ROOT / "sandbox").rglob("*.*")
              if path.suffix in (".py", ".typed", ".js", ".css", ".LICENSE")}
    scenes = {f"sandbox/_scenes/{path.relative_to(ROOT / 'scenes').as_posix()}"
              for path in (ROOT / "scenes").rglob("*.json")}
    assert wanted | scenes <= names
    assert any(name.endswith("licenses/LICENSE") for name in names)
    assert {name.rpartition(".")[2] for name in names if name.startswith("sandbox/")} == {
        "py", "typed", "json", "toml", "svg", "dxf", "js", "css", "LICENSE"}
    assert wheel.stat().st_size < 2_000_000

    def printed(*words: str) -> str:
        return subprocess.run(
            [sys.executable, "-m", "sandbox", *words], cwd=tmp_path, check=True, text=True,
            env={**os.environ, "PYTHONPATH": str(tmp_path / "site")}, capture_output=True).stdout

    listed = json.loads(printed("list", "--json"))["scenes"]
    assert {"adaptive_grasp", "single_finger"} <= {scene["name"] for scene in listed}
    assert all(Path(scene["path"]).is_relative_to(tmp_path / "site") for scene in listed)
    assert "single_finger: ok" in printed("check", "single_finger").splitlines()
    assert printed("--version") == f"sandbox {sandbox.__version__}\n"
