"""Elements of your own: those of docs/howto/own_joint.md, from files and in Python."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

import sandbox
from sandbox.audit.audit import audit
from sandbox.cli.commands import invoke
from sandbox.scene.document import load_elements, registered

PAGE = (Path(__file__).parents[2] / "docs" / "howto" / "own_joint.md").read_text(encoding="utf-8")
BLOCKS: dict[str, str] = dict(re.findall(r"^```python (\w+)\.py\n(.*?)^```$", PAGE, re.M | re.S))
STRUT = {"type": "strut", "name": "leg", "a": "ground", "b": "weight", "stiffness": 1000,
         "damping": 20, "rest_length": 0.2, "longest": 0.4}
BODIES = [{"name": "ground", "motion": "fixed"},
          {"name": "weight", "at": [0, 0.25], "mass": 2, "inertia": 1e-3}]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The files of the page and a scene in the current directory."""
    monkeypatch.chdir(tmp_path)
    for name, text in BLOCKS.items():
        Path(f"{name}.py").write_text(text, encoding="utf-8")
    scene = {"run": {"duration": 0.01}, "bodies": BODIES, "parts": [STRUT]}
    Path("scene.json").write_text(json.dumps(scene), encoding="utf-8")


@pytest.fixture
def loaded(folder: None) -> Iterator[None]:
    """The elements of the page, registered."""
    restore = [load_elements(Path(f"{name}.py")) for name in BLOCKS]
    yield
    restore[0]()
    assert registered() == ()


def run(step: float = 1e-3, **changes: Any) -> sandbox.Recording:
    scene = {"run": {"duration": 0.3, "step": step}, "bodies": BODIES, "parts": [STRUT]}
    return sandbox.simulate(sandbox.load_scene({**scene, **changes}))


@pytest.mark.usefixtures("loaded")
def test_a_strut_follows_the_damped_oscillation() -> None:
    """x = A exp(-d t) (cos w t + d/w sin w t), d = c/2m = 5/s, w^2 = k/m - d^2 = 475/s^2."""
    errors = []
    for step in (2e-3, 1e-3):
        done = run(step)
        t, (d, w) = done.time, (5.0, np.sqrt(475.0))
        exact = 0.2 + 0.05 * np.exp(-d * t) * (np.cos(w * t) + d / w * np.sin(w * t))
        errors.append(np.abs(done["leg.spring.length"] - exact).max())
    assert errors[0] < 1e-4
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)  # second order


@pytest.mark.usefixtures("loaded")
@pytest.mark.parametrize(("gravity", "length", "force"), [(-19.62, 0.19, -39.24), (40, 0.25, 80)])
def test_its_stops_carry_the_rest_of_the_weight(
    gravity: float, length: float, force: float) -> None:
    stopped = {**STRUT, "shortest": 0.19, "longest": 0.25}
    done = run(gravity=[0, gravity], parts=[stopped], run={"duration": 1})
    assert done["leg.spring.length"][-1] == pytest.approx(length, abs=1e-9)
    assert done["leg.force"][-1] == pytest.approx(force, rel=1e-9)
    assert done["leg.spring.force"][-1] == pytest.approx(1000 * (length - 0.2), rel=1e-6)
    assert [figure.name for figure in audit(done) if figure.verdict == "look"] == []


@pytest.mark.usefixtures("loaded")
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_law_of_ones_own_holds(friction: float) -> None:
    """Torque 0.2 N m against 0.5 N m/rad (q + 8 q^3): q = 0.25 rad; friction above it holds."""
    bushing = {"type": "bushing", "name": "mount", "a": "ground", "b": "weight",
               "on_a": [0, 0.25], "stiffness": 0.5, "damping": 0.05, "friction": friction}
    drive = {"type": "torque", "name": "load", "joint": "mount.hinge", "value": 0.1875}
    done = run(parts=[bushing], drives=[drive], run={"duration": 3})
    assert done["mount.hinge.angle"][-1] == pytest.approx(0.0 if friction else 0.25, abs=1e-6)
    assert [figure.name for figure in audit(done) if figure.verdict == "look"] == []


@pytest.mark.usefixtures("folder")
def test_worker_processes_get_the_file(capsys: Any) -> None:
    assert invoke(["sweep", "scene.json", "--elements", "my_strut.py", "--vary",
                   "parts[leg].stiffness=100 N/m:200 N/m", "--count", "2", "--keep",
                   "force=leg.force", "--workers", "1"]) == 0, capsys.readouterr()


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(("old", "new", "message"), [
    ("return {", "return {{", "wrong.py:26: SyntaxError: '{' was never closed"),
    ("import sandbox\n", "import sandbox\n1 / 0\n", "wrong.py:4: ZeroDivisionError: division by"),
    ("@sandbox.register\n", "", "wrong.py: it registers no element"),
    ("stiffness=self.stiffness", "stiffness=self.k", "elements(): AttributeError: 'Strut' object"),
    ('"springs":', '"sprins":', "unknown key 'sprins'. Did you mean 'springs'?"),
    ('"springs":', '"at": [1, 0], "springs":', "'at' is no list of elements"),
    ("name=spring", 'name="spring"', "the name 'spring' must begin with 'leg.'"),
])
def test_a_wrong_file_gets_one_clear_message(old: str, new: str, message: str, capsys: Any) -> None:
    text = BLOCKS["my_strut"]
    assert old in text
    Path("wrong.py").write_text(text.replace(old, new), encoding="utf-8")
    assert invoke(["check", "scene.json", "--elements", "wrong.py"]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert "Traceback" not in said
    assert registered() == ()


@pytest.mark.usefixtures("loaded")
def test_other_classes_and_taken_types_cannot_be_registered() -> None:
    with pytest.raises(sandbox.SandboxError, match=r"a subclass of sandbox\.Composite"):
        sandbox.register(dict)  # type: ignore[type-var]

    class Strut(sandbox.Composite):
        type: Literal["strut"]

    with pytest.raises(sandbox.SandboxError, match="'strut' is already that of Strut"):
        sandbox.register(Strut)
