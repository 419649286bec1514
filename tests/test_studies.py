"""The studies of docs/studies, each with few runs, against numbers of their pages."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent.parent / "docs" / "studies"
NUMBERS: Mapping[str, Mapping[str, tuple[float, float]]] = {
    # by study: number, value and tolerance; the closed forms are nearer than the pages print
    "finger_control": {
        "lowest pull": (6.829, 5e-4), "highest pull": (22.86, 5e-3),
        "finger_stiffness_15N settled": (1.897, 0.01), "finger_dual_control settled": (2.392, 0.01),
        "finger_force_control stiffness": (0, 1e-3), "finger_stiffness_10N stiffness": (0, 5e-3),
        "finger_model_control settled": (0.070, 2e-3), "finger_lqr_control settled": (0.067, 2e-3),
        "least pull, low": (6.83, 0.1), "least pull, high": (6.83, 0.1)},
    "proposals": {
        "springs, 10 N": (1.6, 0.05), "antagonist, 10 N": (8.6, 0.05), "locks, 15 N": (0, 0.01),
        "locks of 0.08 N m, highest": (16.17, 5e-3), "springs for 2/10/15 deg": (0, 3e-3),
        "antagonist on wheels made for the target": (0, 3e-3), "locks at the target": (0, 0.07)},
    "hand_stiffness": {"largest change": (40.7, 0.05), "largest error": (0, 0.002)},
    "soft_vs_adaptive": {
        "off": (0, 1e-8), "cone, differential": (0.15, 5e-3),
        "cone, springs of 300 N/m": (0.04, 5e-3), "cone, springs of 600 N/m": (0.08, 5e-3)},
    "gripping_force": {"statics, 99 %": (0, 1e-8), "discs, 25 N": (0.75, 0.1)},
    "differential": {
        "rigid tensions": (1.53, 0.1), "rigid lost": (0.64, 0.1), "rockers off": (0, 0.01),
        "springs of 300 N/m off": (0, 1e-6), "rigid off": (0, 1e-4)},
    "survival": {
        "differs": (0, 1e-9), "adaptive grasp, 38 mm": (0.9, 0.1),
        "two against two, 5 N": (0.65, 0.1)},
    "guides": {
        "best at three pulls, 3.75 N": (0.05, 0.02), "best at one pull, 7.5 N": (0.57, 0.02),
        "half a millimetre": (0.20, 5e-3)},
    "sheaths": {
        "share": (0, 2e-3), "force": (0, 1e-3), "pushed back": (0, 1e-3), "loop 0.1": (0, 2e-3)},
    "soft_skin": {"tension": (0, 1e-4), "spread, 5 N/mm": (0.09, 0.05)},
    "sand_heap": {"carried": (0, 1e-9), "creep": (0, 1e-9), "slope 0": (14.7, 2),
                  "slope 0.5": (22, 2)},
    "identification": {
        "k1 theory": (0.043, 1e-3), "c3 theory": (0.117, 2e-3), "k1 half": (0.043, 0.01),
        "c3 half": (0.117, 0.03)},
}


def test_every_study_has_a_page_and_numbers() -> None:
    assert {path.stem for path in FOLDER.glob("*.py")} == set(NUMBERS) | {"common"}
    assert {path.stem for path in FOLDER.glob("*.md")} == set(NUMBERS) | {"index"}


@pytest.mark.nightly
@pytest.mark.parametrize("name", NUMBERS)
def test_a_study_gives_the_numbers_of_its_page(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sys, "path", [str(FOLDER), *sys.path])
    found = import_module(name).main(["--quick", "--out", str(tmp_path)])
    for number, (value, tolerance) in NUMBERS[name].items():
        assert found[number] == pytest.approx(value, abs=tolerance), number
    assert list(tmp_path.glob("*.png"))
