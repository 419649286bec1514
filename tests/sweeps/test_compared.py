"""What moved between two sweeps: rows by their values, tolerances, what halving the step does."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import sandbox
from sandbox.sweeps.compared import compared, halved, read_kept

SCENE: dict[str, Any] = {
    "run": {"duration": 0.05, "step": 1e-3}, "gravity": [0, 0],
    "parameters": {"push": 1.0, "mass": 0.5, "wide": 0.0},
    "bodies": [{"name": "puck", "mass": "=mass", "inertia": 1e-4}],
    "drives": [{"type": "force", "name": "hand", "body": "puck", "direction": [1, 0],
                "value": "=push * (1 + 200 * t ** 2)"}]}
KEEP = {"way": "final puck.x", "speed": {"final": "puck.vx"}, "twice": "=2 * speed"}


def swept(out: Path, pushes: object = (1.0, 2.0, 3.0), **change: Any) -> Path:
    sandbox.sweep(SCENE, vary={"parameters.push": list(pushes)}, keep=KEEP, set=change, out=out,  # type: ignore[call-overload]
                  audit=False, workers=1)
    return out


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Sweeps of a puck: as it is, a ten-thousandth and a tenth heavier, with other pushes."""
    folder = tmp_path_factory.mktemp("sweeps")
    swept(folder / "one")
    swept(folder / "hardly", **{"parameters.mass": 0.5 * (1 + 1e-7)})
    swept(folder / "heavier", **{"parameters.mass": 0.55})
    swept(folder / "others", (5.0, 3.0000000000000004, 4.0, 2.0))
    return folder


def between(folder: Path, one: str, other: str, **how: Any) -> Any:
    return compared(read_kept(folder / one), read_kept(folder / other), **how)


def test_what_moved_is_told_with_how_much_and_where(folder: Path) -> None:
    found = between(folder, "one", "heavier")
    assert not found.same
    way, speed, twice = found.results
    assert all((each.rows, each.moved) == (3, 3) for each in found.results)
    assert speed.unit == "m/s"
    assert speed.largest == pytest.approx(speed.first * (1 / 1.1 - 1), rel=1e-9)
    assert twice.largest == pytest.approx(2 * speed.largest)
    assert way.where == {"parameters.push": "3.0"}


def test_halving_the_step_gives_a_tolerance(folder: Path) -> None:
    """By what the runs themselves move: known from a sweep with half the step."""
    swept(folder / "half", **{"run.step": 5e-4})
    most = halved(read_kept(folder / "one"), 3)
    moved = {each.name: abs(each.largest) for each in
             between(folder, "one", "half", share=0.0).results}
    assert most == pytest.approx(moved, rel=1e-12)
    assert most["way"] > 0
    assert halved(read_kept(folder / "others"), 4)["way"] == pytest.approx(5 / 3 * most["way"])
    assert between(folder, "one", "half", tolerances=most).same
    assert not between(folder, "one", "heavier", tolerances=most).same
