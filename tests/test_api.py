"""The public names, and that asking for them costs nothing until they are used."""

from __future__ import annotations

import subprocess
import sys

import pytest

import sandbox

HEAVY = ("numpy", "pydantic", "pymunk", "pygame", "numba", "imageio", "PIL", "scipy", "matplotlib")
NAMES = {
    "load_scene", "simulate", "Recording", "render", "expand", "SceneError", "Simulation",
    "SimulationDiverged", "RecordingFull", "OutputError", "SandboxError", "Interrupted", "Custom",
    "ControllerFailed", "Live", "StopRun", "__version__", "build", "gym", "rest", "rest_along",
    "search", "sweep", "Composite", "register", "to_pymunk",
}


def test_the_public_names_resolve_to_documented_objects() -> None:
    assert set(sandbox.__all__) == set(dir(sandbox)) == NAMES
    for name in NAMES - {"__version__"}:
        value = getattr(sandbox, name)
        assert value.__name__.rpartition(".")[2] == name
        assert value.__doc__
    with pytest.raises(AttributeError, match="no attribute 'simulte'"):
        getattr(sandbox, "simul" + "te")


@pytest.mark.parametrize(("statement", "unwanted"), [
    ("import sandbox, sandbox.errors", HEAVY),
    ("import sandbox.cli.declarations", HEAVY),
    ("import sandbox; sandbox.build.Body(name='a', motion='fixed')", ("numba", "pymunk")),
    ("import sandbox.web.page, sandbox.web.session", ("pygame", "matplotlib")),
])
def test_importing_loads_nothing_heavy(statement: str, unwanted: tuple[str, ...]) -> None:
    script = f"{statement}; import sys; print(*sorted(set({unwanted!r}) & set(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
