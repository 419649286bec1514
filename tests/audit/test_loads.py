"""The figure of loads: what is planted in a recording, or in its scene, is noticed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from sandbox.study.plain_mechanisms import mass, mechanism

SHAPE = {"shapes": [{"type": "box", "size": (0.4, 0.2)}]}
LOADS: list[dict[str, Any]] = [
    {"type": "drag", "name": "air", "linear": 0.5, "turning": 0.01},
    {"type": "law", "name": "keel", "bodies": ["one"], "frame": "body", "at": (0.1, 0.05),
     "force": ["=-0.1 * vx", "=-3 * vy * speed"], "torque": "=0.1 * sin(9 * t)"},
    {"type": "law", "name": "heavy", "bodies": ["two"], "acceleration": ["=-0.3 * ax", "=-x"]},
    {"type": "buoyancy", "name": "water"}]


@pytest.fixture(scope="module")
def run() -> Recording:
    return simulate(mechanism(
        duration=0.2, step=1e-3, gravity=(0.0, -9.81), run={"sample_rate": 1000}, loads=LOADS,
        bodies=[{**mass(name, 40.0, (x, 0.0)), **SHAPE, "thickness": 1.0, "inertia": 0.5,
                 "velocity": (1.0, 0.2), "angle": 0.2, "angular_velocity": 1.0}
                for name, x in (("one", 0.0), ("two", 3.0))]))


def verdict(run: Recording) -> str:
    return next(figure.verdict for figure in audit(run) if figure.name == "load.law")


def spoilt(run: Recording, key: str, change: Callable[[np.ndarray], None]) -> Recording:
    arrays = {name: np.array(array) for name, array in run.arrays.items()}
    change(arrays[key])
    return Recording(run.mechanism, arrays, run.info)


def grown(place: Any, share: float) -> Callable[[np.ndarray], None]:
    def change(array: np.ndarray) -> None:
        array[place] *= 1 + share
    return change


def test_a_good_run_passes(run: Recording) -> None:
    assert [figure.name for figure in audit(run) if figure.verdict == "look"] == []
    assert verdict(run) == "pass"


@pytest.mark.parametrize("load", range(len(LOADS) + 2))
def test_a_force_that_is_another_is_noticed(run: Recording, load: int) -> None:
    """Of each load on each body, in one sample, by a ten thousandth."""
    assert verdict(spoilt(run, "load_force", grown((100, load), 1e-4))) == "look"


@pytest.mark.parametrize("load", [0, 2, 4])
def test_a_torque_that_is_another_is_noticed(run: Recording, load: int) -> None:
    assert verdict(spoilt(run, "load_torque", grown((100, load), 1e-4))) == "look"


@pytest.mark.parametrize(("i", "field", "value"), [
    (0, "linear", 0.5005), (0, "turning", 0.01001), (0, "flow", (1e-3, 0.0)),
    (1, "at", (0.1001, 0.05)), (1, "frame", "world"), (1, "torque", "=0.1 * sin(9.01 * t)"),
    (2, "acceleration", ("=-0.301 * ax", "=-x")), (3, "density", 1000.5), (3, "level", 1e-4)])
def test_another_law_is_noticed(run: Recording, i: int, field: str, value: Any) -> None:
    """The scene says something else than what was run."""
    loads = list(run.mechanism.loads)
    loads[i] = loads[i].model_copy(update={field: value})
    other: Mechanism = run.mechanism.model_copy(update={"loads": tuple(loads)})
    assert verdict(Recording(other, dict(run.arrays), run.info)) == "look"


def test_work_that_was_not_done_is_noticed(run: Recording) -> None:
    def change(array: np.ndarray) -> None:
        array[:, 0] *= 1.001
    found = {f.name: f.verdict for f in audit(spoilt(run, "load_work", change))}
    assert "look" in (found["energy.created"], found["energy.lost"])
