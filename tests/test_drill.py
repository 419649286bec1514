"""A toy joint and a toy drive are added in a copy of the sources.

Their scenes run and expect what statics and Newton's law say.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import sandbox

PACKAGE = Path(sandbox.__file__).parent
ROOT = Path(__file__).parents[1]

STRUT = '''
class Strut(_JointSpec):
    """Keeps two points from coming nearer than a distance: pushes and never pulls."""

    type: Literal["strut"]
    shortest: Length
    on_a: Point | None = (0.0, 0.0)
    on_b: Point | None = (0.0, 0.0)


Joint = Annotated[Pin | Slot | Weld | Rod | Rope | Strut |'''
CLUTCH = '''
class ClutchDrive(Model):
    """Carries a torque from one body of a hinge to the other, up to a limit, and slips above."""

    type: Literal["clutch"]
    name: Name
    joint: Name
    value: TorqueSignal
    """The most that it carries [N m]."""


Drive = Annotated[
'''.replace("(Model)", "(Spec)")
STRUT_SCENE = {
    "format": 1, "title": "A strut", "about": "A toy: 2 kg in a groove stand on a strut.",
    "gravity": [0, -9.81], "run": {"duration": 0.2},
    "bodies": [{"name": "ground", "motion": "fixed"},
               {"name": "load", "at": [0, 0.1], "mass": 2, "inertia": 1e-3}],
    "joints": [{"type": "slot", "name": "guide", "a": "ground", "b": "load", "start": [0, 0],
                "end": [0, 1], "turns": False},
               {"type": "strut", "name": "strut", "a": "ground", "b": "load", "shortest": 0.1}],
    "expect": [{"mean": "strut.reaction", "over": "last 0.1 s", "is": "=2 * 9.81",
                "within": "0.01 %", "because": "it carries the weight"}],
}
CLUTCH_SCENE = {
    "format": 1, "title": "A clutch", "about": "A toy: a wheel at 10 rad/s is brought to rest.",
    "run": {"duration": 0.2},
    "bodies": [{"name": "ground", "motion": "fixed"},
               {"name": "wheel", "mass": 1, "inertia": 1e-3, "angular_velocity": 10}],
    "joints": [{"type": "pin", "name": "axle", "a": "ground", "b": "wheel", "on_b": [0, 0]}],
    "drives": [{"type": "clutch", "name": "clutch", "joint": "axle", "value": 0.1}],
    "expect": [{"final": "wheel.omega", "is": 0, "within": 1e-6,
                "because": "it stops after I omega / tau = 0.1 s"},
               {"final": "axle.angle", "is": "=10 * 0.1 / 2", "within": "1 %",
                "because": "and half of omega times that"}],
}

Edit = tuple[str, str, str]
"""File, what stands there, what shall."""
SPECS: list[Edit] = [
    ("sandbox/scene/elements/joints.py", "\nJoint = Annotated[Pin | Slot | Weld | Rod | Rope |",
     STRUT),
    ("sandbox/scene/elements/drives.py", "\nDrive = Annotated[\n", CLUTCH),
    ("sandbox/scene/elements/drives.py", "| MotorDrive | BrakeDrive\n",
     "| MotorDrive | BrakeDrive\n    | ClutchDrive\n"),
]
JOINT: list[Edit] = [
    ("sandbox/kinds/elements.py", '    "rope": JointKind(',
     '    "strut": JointKind("range", _REACTION, mujoco="a strut"),\n    "rope": JointKind('),
    ("sandbox/model/compile.py", "    Slot,\n    Weld,\n", "    Slot,\n    Strut,\n    Weld,\n"),
    ("sandbox/model/compile.py", "        case Rope():\n",
     "        case Strut():\n            return _JointFacts(reach=(joint.shortest, math.inf))\n"
     "        case Rope():\n"),
    ("sandbox/picture/elements/joints.py", '    "rod": JointLook(',
     '    "strut": JointLook("ends", "rod"),\n    "rod": JointLook('),
]
DRIVE: list[Edit] = [
    ("sandbox/kinds/elements.py", '    "motor": DriveKind(',
     '    "clutch": DriveKind(_ON_HINGE, "torque", "N m", "torque", ("value", "work", "torque"),\n'
     '                        floor=0.0, sole="clutch", limited=True,\n'
     '                        mujoco="a clutch"),\n    "motor": DriveKind('),
    ("sandbox/model/compile.py", "    BrakeDrive,\n", "    BrakeDrive,\n    ClutchDrive,\n"),
    ("sandbox/model/compile.py", "case TorqueDrive() | BrakeDrive():",
     "case TorqueDrive() | BrakeDrive() | ClutchDrive():"),
    ("sandbox/picture/elements/drives.py", '    "radius": DriveLook(),',
     '    "radius": DriveLook(),\n    "clutch": DriveLook(mark="brake"),'),
]
CHECKS = ("tests/test_architecture.py", "tests/export/test_every_kind.py",
          "tests/scene/test_schema.py")


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program, its tests, docs and scenes, with the two specs written."""
    root = tmp_path_factory.mktemp("drill")
    litter = shutil.ignore_patterns("*.pyc", "_scenes")
    shutil.copytree(PACKAGE, root / "sandbox", ignore=litter)
    for folder in ("tests", "docs", "scenes", "benchmarks"):
        shutil.copytree(ROOT / folder, root / folder, ignore=litter)
    for name in ("pyproject.toml", "README.md", "CHANGELOG.md"):
        shutil.copy(ROOT / name, root / name)
    for edit in SPECS:
        write(root, edit)
    return root


def write(root: Path, edit: Edit) -> None:
    file, old, new = edit
    text = (root / file).read_text(encoding="utf-8")
    assert text.count(old) == 1, f"{file} has {old!r} {text.count(old)} times"
    (root / file).write_text(text.replace(old, new), encoding="utf-8")


def run(root: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments], cwd=root, capture_output=True, text=True, timeout=900,
        check=False, env={**os.environ, "PYTHONPATH": str(root)})


@pytest.mark.nightly
def test_a_new_joint_and_a_new_drive_hold_with_few_files_written(copy: Path) -> None:
    for edit in (*JOINT, *DRIVE):
        write(copy, edit)
    for name, scene in (("strut", STRUT_SCENE), ("clutch", CLUTCH_SCENE)):
        (copy / "scenes" / f"{name}.json").write_text(json.dumps(scene), encoding="utf-8")
    made = run(copy, "docs/make_reference.py")
    assert made.returncode == 0, made.stderr
    accepted = run(copy, "-m", "tests.golden", "accept", "strut", "clutch")
    assert accepted.returncode == 0, accepted.stderr
    done = run(copy, "-m", "pytest", "-q", "-p", "no:cacheprovider", *CHECKS,
               "tests/golden/test_golden.py::test_scene[strut]",
               "tests/golden/test_golden.py::test_scene[clutch]")
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr
    for name in ("strut", "clutch"):
        shown = run(copy, "-m", "sandbox", "run", name, "--out", name)
        assert shown.returncode == 0, shown.stdout + shown.stderr
        assert "checks passed" in shown.stdout
        assert (copy / name / "animation.gif").exists()
