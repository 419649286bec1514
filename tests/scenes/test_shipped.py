"""Every shipped scene, every invariant: a new scene is tested the moment it exists."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from sandbox.engine.inspect import inspect
from sandbox.engine.simulate import simulate
from sandbox.kinds.quantities import GRASP
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import verdicts
from sandbox.scene.expand import expand, to_json
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.load import load_scene

SCENES = shipped_scenes()
LACKING = {name for name, row in GRASP.items() if row.nothing}
"""What has no value where nothing holds the object."""
STABLE = ("adaptive_grasp", "shape_change", "single_finger", "pulley_differential",
          "rocker_differential")


@cache
def run_of(name: str) -> Recording:
    return simulate(load_scene(SCENES[name]))


def files(run: Recording, directory: Path) -> dict[str, bytes]:
    run.save(directory)
    return {name: (directory / name).read_bytes() for name in ("run.npz", "contacts.csv")}


@pytest.mark.parametrize("name", SCENES)
class TestEveryScene:
    def test_says_what_it_is_and_why_it_expects(self, name: str):
        scene = load_scene(SCENES[name])
        assert scene.title
        assert scene.about
        assert scene.expect, "a scene carries its own force-range regression test"
        assert all(expectation.because for expectation in scene.expect)

    def test_inspection_finds_nothing(self, name: str):
        assert not inspect(expand(load_scene(SCENES[name])))

    def test_its_mechanism_is_a_scene_of_its_own(self, name: str):
        mechanism = expand(load_scene(SCENES[name]))
        again = expand(load_scene(json.loads(to_json(mechanism))))
        assert again.model_copy(update={"name": mechanism.name}) == mechanism

    def test_every_number_is_finite(self, name: str):
        run = run_of(name)
        assert run.complete
        for quantity in run.names():
            if "/" not in quantity and quantity.rpartition(".")[2] not in LACKING:
                assert np.isfinite(run[quantity]).all(), quantity

    def test_names_are_unique(self, name: str):
        m = run_of(name).mechanism
        kinds = (m.bodies, m.joints, m.springs, m.tendons, m.drives, m.meters)
        names = [element.name for kind in kinds for element in kind]
        assert len(set(names)) == len(names)

    def test_expectations_hold(self, name: str):
        failed = [verdict for verdict in verdicts(run_of(name)) if not verdict.ok]
        assert not failed

    def test_twice_gives_the_same_bytes(self, name: str, tmp_path: Path):
        first = files(run_of(name), tmp_path / "first")
        assert files(simulate(load_scene(SCENES[name])), tmp_path / "second") == first

    def test_saved_and_loaded_is_the_same(self, name: str, tmp_path: Path):
        run = run_of(name)
        run.save(tmp_path)
        again = Recording.load(tmp_path)
        assert again.mechanism == run.mechanism
        for key, array in run.arrays.items():
            assert np.array_equal(again.arrays[key], array, equal_nan=True), key


@pytest.mark.parametrize("step", ["0.25 ms", "0.4 ms", "1 ms"])
@pytest.mark.parametrize("name", STABLE)
def test_the_verdict_does_not_hang_on_the_step(name: str, step: str):
    """What is determined by statics cannot depend on how finely it is reached."""
    run = simulate(load_scene(SCENES[name], overrides={"run.step": step}))
    assert not [verdict for verdict in verdicts(run) if not verdict.ok]
