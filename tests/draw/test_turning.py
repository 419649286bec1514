"""Marks of brakes and motors, and springs whose stiffness is set."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.palette import DRIVE, SPRING
from sandbox.draw.film.springs import LINE, THICK, driven_line
from sandbox.scene.mechanism import Mechanism

from .conftest import recording

VIEW = {"centre": [0, 0], "width": 0.2, "size": [800, 600]}


def pictures(drive: dict[str, Any], values: list[float], *, positive: str = "counterclockwise",
             springs: tuple[Any, ...] = ()) -> list[np.ndarray]:
    """A hinge in the middle of the picture, one picture for each value of a drive, no legend."""
    mechanism = Mechanism.model_validate({
        "name": "hinge", "bodies": [
            {"name": "wall", "motion": "fixed"},
            {"name": "arm", "mass": 0.1, "inertia": 1e-4}],
        "joints": [{"type": "pin", "name": "p", "a": "wall", "b": "arm", "on_a": [0, 0],
                    "positive": positive}],
        "springs": list(springs), "drives": [{"name": "d", **drive}], "view": VIEW})
    time = np.arange(len(values), dtype=float)
    run = recording(mechanism, time, np.zeros((len(values), 2, 3)),
                    drive_value=np.array(values)[:, None])
    renderer = FrameRenderer(run)
    return [renderer.draw(t)[renderer._stage.top:renderer._stage.bottom].astype(int)
            for t in time]


def inked(picture: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    """Row and column of every pixel in about that colour, [k, 2]."""
    return np.argwhere(np.abs(picture - colour).max(axis=2) < 30)


def test_a_brake_is_full_while_it_holds() -> None:
    free, holds = pictures({"type": "brake", "joint": "p", "value": 0}, [0.0, 0.3])
    few, many = len(inked(free, DRIVE)), len(inked(holds, DRIVE))
    assert few > 10  # an outline
    assert many > 2 * few


@pytest.mark.parametrize(("positive", "value"), [("counterclockwise", 1.0), ("clockwise", -1.0),
                                                 ("clockwise", 1.0), ("counterclockwise", -1.0)])
def test_a_motors_arrow_turns_as_the_hinge_does(positive: str, value: float) -> None:
    """Both arrows open to the right; the head, most of the ink, is below where it turns left."""
    still, moving = pictures({"type": "motor", "joint": "p", "value": 1, "torque": 1},
                             [0.0, value], positive=positive)
    ring = inked(still, DRIVE)  # the same on all sides: it keeps its hinge at rest
    middle = (ring[:, 0].min() + ring[:, 0].max()) / 2
    assert abs(np.mean(ring[:, 0]) - middle) < 1
    ink = inked(moving, DRIVE)
    middle = (ink[:, 0].min() + ink[:, 0].max()) / 2
    below = np.count_nonzero(ink[:, 0] > middle) > len(ink) / 2
    assert below == ((value > 0) == (positive == "counterclockwise"))


def test_a_spring_made_stiffer_is_thicker_and_coloured() -> None:
    assert driven_line(1.0) == (SPRING, LINE)
    assert driven_line(100.0) == driven_line(THICK[1])
    assert driven_line(THICK[1])[0] == DRIVE
    widths = [driven_line(share)[1] for share in (0.0, 0.5, 0.7, 1.0, 2.0, 6.0)]
    assert widths == sorted(widths)
    spring = {"type": "rotary", "name": "s", "joint": "p", "stiffness": 0.1}
    own, stiff = pictures({"type": "stiffness", "spring": "s"}, [0.1, 0.6], springs=(spring,))
    assert not len(inked(own, DRIVE))
    assert len(inked(stiff, DRIVE)) > 30


def test_a_spring_of_no_stiffness_can_be_driven() -> None:
    spring = {"type": "rotary", "name": "s", "joint": "p", "stiffness": 0.0}
    zero, some = pictures({"type": "stiffness", "spring": "s"}, [0.0, 0.6], springs=(spring,))
    np.testing.assert_array_equal(zero, some)
