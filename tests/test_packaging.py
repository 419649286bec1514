"""The wheel holds what a user needs, works away from the checkout, and weighs little."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import pytest

import sandbox

ROOT = Path(__file__).parent.parent
PROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dist")
    subprocess.run([sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)],
                   cwd=ROOT, check=True, capture_output=True)
    built, = folder.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def unpacked(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    return folder


def from_wheel(unpacked: Path, *words: str) -> str:
    """What a command of the unpacked wheel prints; it runs away from the checkout."""
    environment = {**os.environ, "PYTHONPATH": str(unpacked)}
    done = subprocess.run([sys.executable, *words], cwd=unpacked.parent, env=environment,
                          check=True, capture_output=True, text=True)
    return done.stdout


def test_the_wheel_holds_package_scenes_schema_and_licence(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    sources = {str(path.relative_to(ROOT)) for path in (ROOT / "sandbox").rglob("*.py*")
               if path.suffix in (".py", ".pyi")}
    scenes = {f"sandbox/_scenes/{path.relative_to(ROOT / 'scenes').as_posix()}"
              for path in (ROOT / "scenes").rglob("*.json")}
    assert len(scenes) > 6  # six scenes and the schema that they name
    assert {"sandbox/py.typed", "sandbox/_scenes/scene.schema.json"} | sources | scenes <= names
    assert any(name.endswith("licenses/LICENSE") for name in names)
    outside = {name for name in names if not name.startswith("sandbox/")}
    assert {name.partition("/")[0].rpartition(".")[2] for name in outside} == {"dist-info"}
    with zipfile.ZipFile(wheel) as archive:  # sources, no pictures and no recordings
        assert max(member.compress_size for member in archive.infolist()) < 100_000
    assert {name.rpartition(".")[2] for name in names if name.startswith("sandbox/")} == {
        "py", "pyi", "typed", "json", "svg", "dxf", "js", "css", "LICENSE"}
    web = {path.relative_to(ROOT).as_posix() for path in (ROOT / "sandbox/show/web").rglob("*.*")}
    assert {"sandbox/show/web/report.js", "sandbox/show/web/uplot/uPlot.LICENSE"} <= web <= names
    assert wheel.stat().st_size < 2_000_000  # sources, scenes and what pages need: 1.6 MB


def test_the_wheel_finds_its_scenes(unpacked: Path) -> None:
    listed = json.loads(from_wheel(unpacked, "-m", "sandbox", "list", "--json"))["scenes"]
    assert {scene["name"] for scene in listed} >= {
        "adaptive_grasp", "shape_change", "single_finger", "rocker_differential",
        "pulley_differential", "rope_differential", "slider_crank"}
    assert all(Path(scene["path"]).is_relative_to(unpacked) for scene in listed)
    assert all(scene["title"] for scene in listed)


def test_the_wheel_checks_a_scene_by_name(unpacked: Path) -> None:
    printed = from_wheel(unpacked, "-m", "sandbox", "check", "single_finger")
    assert "single_finger: ok" in printed.splitlines()


def test_the_version_is_told_once(unpacked: Path) -> None:
    assert from_wheel(unpacked, "-m", "sandbox", "--version") == f"sandbox {sandbox.__version__}\n"
    assert (unpacked / f"sandbox_mechanics-{sandbox.__version__}.dist-info").is_dir()
    assert f"\nversion: {sandbox.__version__}\n" in (ROOT / "CITATION.cff").read_text()
    assert f"\n## [{sandbox.__version__}]" in (ROOT / "CHANGELOG.md").read_text()


def test_the_checkers_of_developers_are_not_asked_of_users() -> None:
    asked = " ".join(PROJECT["project"]["dependencies"])
    assert not any(tool in asked for tool in ("pytest", "hypothesis", "ruff", "mypy", "scipy"))


def test_the_first_level_holds_only_what_belongs_there() -> None:
    known = {"pyproject.toml", "sandbox", "scenes", "renders", "tests", "README.md",
             "CHANGELOG.md", "LICENSE", "CITATION.cff", "docs", "benchmarks"}
    there = {path.name for path in ROOT.iterdir() if not path.name.startswith(".")}
    assert there - known - {"build", "dist"} == set()
