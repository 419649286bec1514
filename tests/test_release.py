"""The script that makes a release: what it refuses, what it writes; and what the sdist holds."""

from __future__ import annotations

import importlib.machinery
import importlib.util
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path
from types import ModuleType

import pytest

import sandbox

ROOT = Path(__file__).parent.parent
TOLD = ("sandbox/__init__.py", "CITATION.cff", "CHANGELOG.md")
"""The files that say the version."""


@pytest.fixture(scope="module")
def script() -> ModuleType:
    loader = importlib.machinery.SourceFileLoader("release", str(ROOT / ".ci" / "release"))
    spec = importlib.util.spec_from_loader("release", loader)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    loader.exec_module(module)
    sys.dont_write_bytecode = before
    return module


@pytest.fixture
def copied(tmp_path: Path) -> Path:
    """What tells the version, as it is before a release that has something to tell."""
    for name in (*TOLD, ".ci/release"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    log = tmp_path / "CHANGELOG.md"
    text = log.read_text(encoding="utf-8")
    head, _, rest = text.partition("## [Unreleased]\n")
    older = rest[rest.index("\n## ["):]
    log.write_text(f"{head}## [Unreleased]\n\n### Added\n\n- A thing.\n{older}", encoding="utf-8")
    return tmp_path


def test_a_release_says_its_version_and_day_in_each_of_the_three_files(
        script: ModuleType, copied: Path) -> None:
    after = script.edits(copied, "99.0.0", "2031-02-03")
    source, cited, log = (after[copied / name] for name in TOLD)
    assert '\n__version__ = "99.0.0"\n' in source
    assert source.count(sandbox.__version__) == 0
    assert "\nversion: 99.0.0\ndate-released: 2031-02-03\n" in cited
    assert "## [Unreleased]\n\n## [99.0.0] - 2031-02-03\n\n### Added\n\n- A thing.\n" in log
    assert f"\n## [{sandbox.__version__}]" in log


@pytest.mark.parametrize(("version", "why"), [
    ("1.2", "no version such as"), ("v9.0.0", "no version such as"),
    (sandbox.__version__, "not higher than"), ("0.0.9", "not higher than")])
def test_a_version_that_is_none_or_lower_is_refused(script: ModuleType, copied: Path,
                                                    version: str, why: str) -> None:
    with pytest.raises(script.NotReady, match=why):
        script.edits(copied, version, "2031-02-03")


def test_versions_are_compared_as_numbers(script: ModuleType) -> None:
    assert script.numbers("0.10.0") > script.numbers("0.9.9")


def test_a_release_without_changes_is_refused(script: ModuleType, copied: Path) -> None:
    log = copied / "CHANGELOG.md"
    log.write_text(log.read_text(encoding="utf-8").replace("- A thing.\n", ""), encoding="utf-8")
    with pytest.raises(script.NotReady, match="nothing under 'Unreleased'"):
        script.edits(copied, "99.0.0", "2031-02-03")


@pytest.mark.skipif(shutil.which("git") is None, reason="a release needs git")
def test_only_what_is_committed_is_released(copied: Path) -> None:
    def git(*words: str) -> None:
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@example.org", *words],
                       cwd=copied, check=True, capture_output=True)

    def release() -> subprocess.CompletedProcess[str]:
        return subprocess.run([sys.executable, ".ci/release", "99.0.0", "--only-write"],
                              cwd=copied, capture_output=True, text=True, check=False)

    git("init", "--quiet")
    done = release()
    assert (done.returncode, done.stderr.splitlines()[0]) == (
        1, "no release: there is uncommitted work:")
    assert "99.0.0" not in (copied / "CITATION.cff").read_text(encoding="utf-8")
    git("add", ".")
    git("commit", "--quiet", "--message", "all")
    assert release().returncode == 0
    assert all("99.0.0" in (copied / name).read_text(encoding="utf-8") for name in TOLD)


def test_the_sdist_holds_all_that_the_checkout_has(tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-m", "hatchling", "build", "-t", "sdist", "-d", str(tmp_path)],
                   cwd=ROOT, check=True, capture_output=True)
    packed, = tmp_path.glob("*.tar.gz")
    with tarfile.open(packed) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    wanted = {path.relative_to(ROOT).as_posix()
              for folder in ("sandbox", "scenes", "tests", "docs", "benchmarks", "renders/gallery")
              for path in (ROOT / folder).rglob("*")
              if path.suffix in (".py", ".pyi", ".json", ".md", ".toml", ".png", ".gif", ".js")}
    assert {"README.md", "CHANGELOG.md", "CITATION.cff", "LICENSE", ".ci/run"} | wanted <= names
