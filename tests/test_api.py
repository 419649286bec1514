"""The public names, and that asking for them costs nothing until they are used."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import sandbox
from sandbox import errors

HEAVY = ("numpy", "pydantic", "pymunk", "pygame", "numba", "imageio", "PIL", "scipy")
CONTRACT = {
    "load_scene", "simulate", "Recording", "render", "expand", "SceneError", "Simulation",
    "SimulationDiverged", "RecordingFull", "OutputError", "SandboxError", "Interrupted", "Custom",
    "ControllerFailed", "Live", "StopRun", "__version__", "build", "gym", "rest", "rest_along",
    "search", "sweep",
}
NO_HOME = {"__version__", "build", "gym", "search"}
"""Of the front itself, and modules."""


def test_the_public_names_are_those_promised():
    assert set(sandbox.__all__) == CONTRACT
    assert set(dir(sandbox)) == CONTRACT


@pytest.mark.parametrize("name", sorted(CONTRACT - NO_HOME))
def test_every_public_name_resolves_to_what_its_home_defines(name):
    value = getattr(sandbox, name)
    assert value.__name__ == name
    assert value.__module__.startswith(sandbox._HOMES[name])
    assert value.__doc__


def test_the_lazy_names_are_those_that_type_checkers_see():
    text = Path(sandbox.__file__).read_text(encoding="utf-8")
    block = text.split("if TYPE_CHECKING:")[1].split("__version__")[0]
    assert all(name in block for name in sandbox._HOMES)
    assert set(sandbox._HOMES) == CONTRACT - NO_HOME


def test_the_builders_are_loaded_when_they_are_asked_for():
    script = ("import sandbox, sys; print('pydantic' in sys.modules); sandbox.build.body('a'); "
              "print('numba' in sys.modules)")
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'simulte'"):
        getattr(sandbox, "simul" + "te")


@pytest.mark.parametrize("module", ["sandbox", "sandbox.cli.entry", "sandbox.errors"])
def test_importing_loads_nothing_heavy(module):
    script = f"import {module}, sys; print(*sorted(set({HEAVY!r}) & set(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


@pytest.mark.parametrize("module", ["sandbox.show.page", "sandbox.show.server"])
def test_pages_and_views_are_made_without_what_draws_films_and_figures(module):
    script = f"import {module}, sys; print(*{{'pygame', 'matplotlib'}} & set(sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_every_error_is_a_sandbox_error():
    found = [value for value in vars(errors).values()
             if isinstance(value, type) and issubclass(value, Exception)]
    assert len(found) >= 5
    assert all(issubclass(value, errors.SandboxError) for value in found)
