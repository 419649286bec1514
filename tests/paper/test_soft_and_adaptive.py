"""Figure 2d: springs from one bar against a differential, and the closed forms of both."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sandbox.paper import soft_and_adaptive as study

FINGERS = tuple(f"finger{k}" for k in range(1, 6))


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    folder, shares = tmp_path_factory.mktemp("study"), list[float]()
    text = study.run(folder, progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    return folder, text


@pytest.fixture(scope="module")
def rows(written: tuple[Path, str]) -> list[dict[str, str]]:
    with (written[0] / study.NUMBERS).open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def column(rows: list[dict[str, str]], name: str, thing: str, stiffness: float) -> np.ndarray:
    """A column of one hand on one object, finger by finger."""
    found = [row for row in rows
             if row["object"] == thing and float(row["stiffness_N_per_m"]) == stiffness]
    assert tuple(row["finger"] for row in found) == FINGERS
    return np.array([float(row[name]) for row in found])


@pytest.mark.parametrize("thing", study.OBJECTS)
@pytest.mark.parametrize("stiffness", [np.inf, *study.STIFFNESS])
class TestEveryHandOnEveryObject:
    def test_it_is_as_the_closed_forms_say(
            self, rows: list[dict[str, str]], thing: str, stiffness: float) -> None:
        """At rest, to what the solve leaves: 1e-9 of forces of some N; travels to as much by
        springs of 300 N/m or, of the differential, cords."""
        for name, bound in (("travel", 1e-10), ("tension", 1e-8), ("force", 1e-8)):
            unit = study.UNITS[name]
            np.testing.assert_allclose(
                column(rows, f"{name}_{unit}", thing, stiffness),
                column(rows, f"{name}_closed_{unit}", thing, stiffness), rtol=0, atol=bound)


def test_what_is_written(written: tuple[Path, str]) -> None:
    folder, text = written
    with Image.open(folder / study.HANDS) as picture:
        assert picture.size[0] == 720
    for ending in ("png", "svg", "pdf"):
        assert (folder / f"{study.TENSIONS}.{ending}").stat().st_size > 5000
    table = (folder / study.TABLE).read_text(encoding="utf-8").splitlines()
    assert len(table) == 2 + len(study.OBJECTS) * 6
    assert len({line.count("|") for line in table}) == 1
    assert "bottle: the tensions spread by 0 %, 10 %, 20 %, the contact forces by 17 %," in text
