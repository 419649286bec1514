"""Every shipped scene and every whole scene of the docs, simulated once each."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

from sandbox.elements.quantities import GRASP
from sandbox.engine.inspect import inspect
from sandbox.recording.recording import Recording
from sandbox.recording.store import save_data, save_summary
from sandbox.scene.expand import expand, to_json
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene

from .digest import differences, digest, names_by_kind, read_values, tolerance_of
from .scenes import ROOT, SCENES, SHIPPED, recording_of

KEPT = read_values()
MAY_LACK = {name for name, row in GRASP.items() if row.nothing}
"""Quantities without a value where nothing holds the object."""
TWICE = ("single_finger", "four_bar", "escapement", "atwood", "gear_pair", "hydraulic_press",
         "pulley_differential", "finger_lqr_control", "capstan", "newtons_cradle", "release",
         "slider_crank")


@pytest.mark.parametrize("name", SCENES)
def test_scene(name: str, tmp_path: Path) -> None:
    mechanism = SCENES[name].mechanism()
    assert not inspect(mechanism)
    run = recording_of(mechanism)
    assert run.complete != SCENES[name].diverges
    assert not [verdict for verdict in run.verdicts if not verdict.ok]
    new = digest(run)
    if name in SHIPPED:
        _check_shipped(mechanism, run, tmp_path)
        assert [kind for kind, each in new["kinds"].items()
                if any(each.moments[-2:]) and kind not in MAY_LACK] == [], "not finite"
    assert name in KEPT, f"a new scene: python -m tests.golden accept '{name}'"
    moved = differences(KEPT[name], new, names_by_kind(run), tolerance=tolerance_of(KEPT, name))
    assert not moved, "\n".join([*moved, "intended? python -m tests.golden accept"])


def _check_shipped(mechanism: Mechanism, run: Recording, folder: Path) -> None:
    """A shipped scene explains itself, and survives being written and read."""
    assert mechanism.title
    assert mechanism.about
    assert mechanism.expect
    assert all(expectation.because for expectation in mechanism.expect)
    again = expand(load_scene(json.loads(to_json(mechanism))))
    assert again.model_copy(update={"name": mechanism.name}) == mechanism
    part = run.part(len(run) // 2, len(run) // 2 + 50)
    save_data(part, folder)
    save_summary(part, folder, verdicts=run.verdicts, figures=run.audit)
    loaded = Recording.load(folder)
    assert loaded.mechanism == run.mechanism
    for key, array in part.arrays.items():
        assert np.array_equal(loaded.arrays[key], array, equal_nan=True), key


def test_another_process_gives_the_same_bytes() -> None:
    """In another order, another environment, with all entry points compiled, and without the
    optional packages, which no shipped scene needs."""
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"][
        "optional-dependencies"]
    optional = {re.split(r"[>\[]", need)[0] for extra in extras.keys() - {"docs", "test", "dev"}
                for need in extras[extra] if not need.startswith("sandbox")}
    script = f"""if True:
        import json, sys
        sys.modules.update(dict.fromkeys({optional}))
        from tests.support.entry_points import all_entry_points
        from tests.golden.digest import digest
        from tests.golden.scenes import SHIPPED, recording_of
        scenes = {{name: each.mechanism() for name, each in SHIPPED.items()}}
        with all_entry_points():
            print(json.dumps({{name: digest(recording_of(scenes[name]))
                              for name in sys.argv[1:]}}))
        """
    other = {"PYTHONHASHSEED": "1001", "LANG": "tr_TR.UTF-8", "TZ": "Asia/Kathmandu",
             "HOME": "/nowhere", "PYTHONUTF8": "0"}
    done = subprocess.run([sys.executable, "-c", script, *reversed(TWICE)], check=True,
                          capture_output=True, text=True, cwd=ROOT, env={**os.environ, **other})
    assert json.loads(done.stdout) == {
        name: json.loads(json.dumps(digest(recording_of(SCENES[name].mechanism()))))
        for name in TWICE}


@pytest.mark.parametrize(("key", "element", "share", "message"), [
    ("spring_force", 1, 0.5, "finger.pip_spring.force: mean "),
    ("tendon_tension", 0, -2.0, "finger.tendon.tension: mean "),
    ("joint_reaction", 0, 1e-12, "finger.mcp.reaction: other bytes")])
def test_one_number_that_moves_is_named(key: str, element: int, share: float, message: str) -> None:
    run = recording_of(SCENES["single_finger"].mechanism())
    array = np.array(run.arrays[key])
    array[len(array) // 2, element] *= 1 + share
    other = Recording(run.mechanism, {**run.arrays, key: array}, run.info)
    plain, new, names = digest(run), digest(other), names_by_kind(run)
    assert message in "\n".join(differences(plain, new, names))
    if abs(share) < 1e-9:
        assert not differences(plain, new, names, tolerance=1e-6)
