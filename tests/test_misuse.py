"""Wrong arguments of the Python interface: each is a SandboxError that says what to pass."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.engine.inspect_control import Checked
from sandbox.scene.document import Scene
from sandbox.scene.mechanism import Mechanism

DISC = {"name": "a", "mass": 1, "shapes": [{"type": "circle", "radius": 0.01}]}
DATA = {"run": {"duration": 0.01}, "bodies": [DISC]}


@pytest.fixture(scope="module")
def run() -> sandbox.Recording:
    return sandbox.simulate(sandbox.load_scene(DATA))


def error_of(work: Any, *args: Any, **keys: Any) -> str:
    with pytest.raises(sandbox.SandboxError) as found:
        work(*args, **keys)
    return str(found.value)


NO_SCENE = "is no scene. Allowed: a scene from sandbox.load_scene"
NO_LIST = "pass a list of sandbox.Custom"


@pytest.mark.parametrize(("work", "given", "keys", "message"), [
    *((work, given, {}, NO_SCENE) for given in (None, b"single_finger")
      for work in (sandbox.simulate, sandbox.Simulation, sandbox.expand)),
    *((sandbox.load_scene, given, {}, "Allowed: a path, the name of a shipped scene, or a mapping")
      for given in (None, b"x")),
    (sandbox.load_scene, DATA, {"overrides": 3}, 'such as {"run.step": "1 ms"}'),
    (sandbox.load_scene, DATA, {"overrides": {3: 4}}, "cannot set 3"),
    (sandbox.load_scene, DATA, {"limits": {"steps": 3}}, "are no limits. Allowed: sandbox.scene"),
    *((work, DATA, {"controllers": given}, NO_LIST) for given in (3, "a", lambda t, x: 0.0)
      for work in (sandbox.simulate, sandbox.Simulation)),
    *((sandbox.render, given, {"path": "x.gif"}, "pass what sandbox.simulate")
      for given in (None, "renders/hand", 3, DATA)),
])
def test_wrong_types_of_arguments(
    work: Any, given: Any, keys: dict[str, Any], message: str,
) -> None:
    assert message in error_of(work, given, **keys)


@pytest.mark.parametrize("work", [sandbox.simulate, sandbox.Simulation])
def test_scenes_are_accepted_as_paths_names_and_data(work: Any, tmp_path: Path) -> None:
    path = tmp_path / "disc.json"
    path.write_text(json.dumps({**DATA, "title": "A disc"}), encoding="utf-8")
    for given in (path, str(path), DATA, sandbox.load_scene(DATA),
                  sandbox.expand(sandbox.load_scene(DATA))):
        assert [body.name for body in work(given).mechanism.bodies] == ["a"]
    assert work(path).mechanism.name == "disc"
    assert work("single_finger").mechanism.name == "single_finger"
    assert "Did you mean" in error_of(work, "single_fnger")


def test_errors_have_a_place_in_the_file(tmp_path: Path) -> None:
    path = tmp_path / "disc.json"
    path.write_text(json.dumps({**DATA, "events": [
        {"name": "e", "when": "=a.xx > 1", "stop": "pass"}]}, indent=1), encoding="utf-8")
    message = error_of(sandbox.simulate, path)
    assert message.startswith(f"{path}:")
    assert "$.events[0].when: unknown quantity 'a.xx'. Did you mean 'a.x'?" in message


@pytest.mark.parametrize("path", ["", "  ", None, "a\0b"])
def test_no_path_is_not_the_working_directory(
    run: sandbox.Recording, path: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    kept = ("run.json", "frame_00001.png", "mine.txt")
    for name in kept:
        (tmp_path / name).write_text("mine")
    for work in (run.save, lambda path: sandbox.render(run, path), sandbox.Recording.load):
        assert "pass a path such as" in error_of(work, path)
    assert sorted(each.name for each in tmp_path.iterdir()) == sorted(kept)


@pytest.mark.parametrize(("keys", "wanted"), [
    ({"fps": 24}, "20, 25 or 50"), ({"fps": "x"}, "20, 25 or 50"),
    ({"size": (0, 0)}, "64 to 8192"), ({"size": 5}, "64 to 8192"),
    ({"size": (100.5, 100)}, "64 to 8192"), ({"size": (1e9, 64)}, "64 to 8192"),
    ({"width": math.nan}, "finite"), ({"width": 0}, "greater than 0"),
    ({"width": "wide"}, "not a number with a unit"), ({"width": 1e300}, "too large"),
    *(({"speed": speed}, "speed") for speed in (0, math.inf, "fast")),
    ({"centre": 3}, "a list"), ({"centre": (math.inf, 0)}, "finite"),
    ({"centre": (1, 2, 3)}, "at most 2"),
])
def test_pictures_that_cannot_be(
    run: sandbox.Recording, keys: dict[str, Any], wanted: str, tmp_path: Path,
) -> None:
    message = error_of(sandbox.render, run, tmp_path / "x.gif", **keys)
    assert wanted in message
    assert f"{next(iter(keys))}=" in message
    assert not list(tmp_path.iterdir())


def test_numbers_of_numpy_are_numbers(run: sandbox.Recording, tmp_path: Path) -> None:
    sandbox.render(run, tmp_path / "x.png", size=np.array([64, 64]), fps=np.int64(20),
                   width=np.float64(0.1), centre=np.zeros(2))
    assert (tmp_path / "x.png").exists()


# --- a mechanism built by hand is checked like one that was read


def changed(**keys: Any) -> Mechanism:
    mechanism = Mechanism.model_validate(DATA)
    return mechanism.model_copy(update={"bodies": (mechanism.bodies[0].model_copy(update=keys),)})


@pytest.mark.parametrize(("keys", "place"), [
    ({"mass": math.inf}, "$.bodies[0].mass: must be finite"),
    ({"mass": -1.0}, "$.bodies[0].mass: must be greater than 0"),
    ({"mass": None}, "$.bodies[0]: a dynamic body needs either"),
    ({"mass": None, "density": 1e-9}, "$.bodies[0]: its mass is"),
    ({"material": "rubber"}, "$.bodies[0].material: there is no material named 'rubber'"),
])
def test_a_body_by_hand(keys: dict[str, Any], place: str) -> None:
    assert error_of(sandbox.simulate, changed(**keys)).startswith(place)


def test_mechanisms_by_hand() -> None:
    whole = Mechanism.model_validate(DATA)
    twice = whole.model_copy(update={"bodies": whole.bodies * 2})
    assert "the name 'a' is already that of another body" in error_of(sandbox.simulate, twice)
    for nothing in (Mechanism(), Scene(), Mechanism.model_construct()):
        assert "nothing to simulate" in error_of(sandbox.simulate, nothing)
        assert "nothing to simulate" in error_of(sandbox.simulate, Checked(nothing))
    assert "$.bodies: expected a list" in error_of(
        sandbox.simulate, Mechanism.model_construct(bodies=3))
    joint = {"type": "pin", "name": "j", "a": "a", "b": "nobody", "on_a": [0, 0]}
    assert "there is no body named 'nobody'" in error_of(
        sandbox.simulate, Mechanism.model_validate({**DATA, "joints": [joint]}))
    assert len(sandbox.simulate(whole)) == 10
