"""Pictures of loads: arrows from where they act, and liquids below their level."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.options import view_of
from sandbox.draw.film.palette import DRIVE, LIQUID


def picture(*loads: dict[str, Any], **more: Any) -> tuple[FrameRenderer, np.ndarray]:
    """A box of 0.4 m by 0.2 m at the origin under loads, in its first sample."""
    run = sandbox.simulate(sandbox.load_scene({
        "run": {"duration": 0.01}, "gravity": [0, -9.81], "loads": list(loads),
        "view": {"centre": [0, 0], "width": 2, "size": [400, 400]},
        "bodies": [{"name": "b", "density": 500, "thickness": 0.1, "velocity": [3, 0],
                    "shapes": [{"type": "box", "size": [0.4, 0.2]}], **more}]}))
    frames = FrameRenderer(run)
    return frames, frames.draw(0.0).copy()


def where(image: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    """Rows and columns of a colour, [n, 2]."""
    return np.argwhere(np.abs(image[20:370].astype(int) - colour).max(axis=-1) <= 2)


@pytest.mark.parametrize("direction", [1, -1])
def test_an_arrow_points_along_its_force(direction: int) -> None:
    law = {"type": "law", "name": "f", "force": [20 * direction, 0], "at": [0.1, 0]}
    frames, image = picture(law, velocity=[0, 0])
    place = frames.camera.to_pixels(np.array([[0.1, 0.0]]))[0]
    columns = where(image, DRIVE)[:, 1]
    assert (direction * (np.median(columns) - place[0])) > 2


def test_what_rounding_leaves_of_a_load_is_no_arrow() -> None:
    """A force of 1e-9 N moves the box of 4 kg by 2.5e-10 m/s^2: the largest, and still nothing."""
    _, image = picture({"type": "law", "name": "f", "force": [1e-9, 0]}, velocity=[0, 0])
    assert not len(where(image, DRIVE))


def test_a_liquid_is_below_its_level() -> None:
    frames, image = picture({"type": "buoyancy", "name": "w", "level": 0.1})
    level = frames.camera.to_pixels(np.array([[0.0, 0.1]]))[0, 1]
    rows = where(image, LIQUID)[:, 0] + 20
    assert rows.min() >= level - 1
    assert len(rows) > 20_000


def test_lift_is_drawn_where_the_water_carries() -> None:
    """A box that is askew is carried beside its centre: on the side that is deeper."""
    frames, image = picture({"type": "buoyancy", "name": "w"}, angle=-0.4, velocity=[0, 0])
    middle = frames.camera.to_pixels(np.zeros((1, 2)))[0, 0]
    stem = where(image, DRIVE)
    assert np.median(stem[:, 1]) > middle + 2


def test_no_load_no_arrow() -> None:
    _, image = picture()
    assert not len(where(image, DRIVE))
    assert not len(where(image, LIQUID))


def test_liquids_go_with_the_layer_of_loads() -> None:
    frames, image = picture({"type": "buoyancy", "name": "w", "level": 0.1})
    without = FrameRenderer(frames.run, view=view_of(frames.view, {"show": ["-loads"]}))
    assert len(where(image, LIQUID)) > 20_000
    assert not len(where(without.draw(0.0), LIQUID))
