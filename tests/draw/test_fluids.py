"""Lines of fluid in pictures: chambers in the colour of their pressure, pumps with their flow."""

from __future__ import annotations

import numpy as np
import pytest

import sandbox
from sandbox.draw.film.fluids import largest_pressure, pressure_text
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.palette import DRIVE, TENSION, lighter
from sandbox.draw.film.symbols import signs_in


@pytest.fixture(scope="module")
def lift() -> sandbox.Recording:
    scene = sandbox.load_scene("hydraulic_lift", overrides={"run.duration": 4.6})
    return sandbox.simulate(sandbox.expand(scene))


@pytest.mark.parametrize(("pascals", "text"), [
    (0.0, "0 Pa"), (500.0, "500 Pa"), (5e4, "50 kPa"), (2e5, "2 bar"), (1.5e6, "1.5 MPa")])
def test_pressures_are_told_in_their_own_units(pascals: float, text: str) -> None:
    assert pressure_text(pascals) == text


def count(picture: np.ndarray, colour: tuple[int, int, int]) -> int:
    return int((np.abs(picture.astype(int) - colour).max(axis=-1) <= 2).sum())


def fluid(picture: np.ndarray) -> int:
    """How much of a picture shows fluid under pressure."""
    return sum(count(picture, lighter(colour, 0.15)) for colour in set(TENSION[3:]))


def test_a_cylinder_fills_as_it_grows(lift: sandbox.Recording) -> None:
    frames = FrameRenderer(lift)
    low, high = (fluid(frames.draw(t)[:550]) for t in (0.1, 3.5))
    assert high > 1.3 * low > 0


@pytest.mark.parametrize("size", [(800, 600), (400, 300)])
def test_a_valve_is_filled_while_something_flows(
    lift: sandbox.Recording, size: tuple[int, int],
) -> None:
    """The pump's circle and name are there all the time; the check valve's wings come to it."""
    frames = FrameRenderer(lift, size=size)
    pumping, held = (count(frames.draw(t), DRIVE) for t in (2.0, 3.5))
    assert pumping > held > 0


def test_the_legend_says_what_is_open_and_what_is_shut(lift: sandbox.Recording) -> None:
    """Where there are valves; a scene without any has nothing of them to explain."""
    shown = [item.after for row in FrameRenderer(lift)._legend for item in row]
    assert shown.index("shut") == shown.index("valve open") + 1
    assert not {"open", "shut"} & signs_in(sandbox.simulate(sandbox.load_scene(
        "held_disc", overrides={"run.duration": 0.01})))


def test_equal_pictures_are_drawn_once(lift: sandbox.Recording) -> None:
    frames = FrameRenderer(lift)
    one = frames.draw(1.0).copy()
    assert (one == FrameRenderer(lift).draw(1.0)).all()
    assert (one != frames.draw(2.0)).any()


def test_the_scale_ends_above_the_run(lift: sandbox.Recording) -> None:
    top = largest_pressure(lift)
    assert top >= np.quantile(lift.arrays["line_pressure"].max(axis=1), 0.99)
    assert top < 2 * lift.arrays["line_pressure"].max()


def test_lines_without_chambers_and_muscles_are_drawn() -> None:
    """Nothing to stand beside: no pump, no fault. A muscle is filled on its rod's side."""
    scene = {"run": {"duration": 0.1, "step": 1e-3}, "bodies": [
        {"name": "g", "motion": "fixed"},
        {"name": "b", "mass": 1, "at": [0.2, 0], "shapes": [{"type": "circle", "radius": 0.02}]}],
        "lines": [{"name": "alone", "volume": 1e-3},
                  {"name": "air", "volume": 1e-3, "gas": 1, "pressure": 1e5, "chambers": [
                      {"type": "cylinder", "a": "g", "b": "b", "area": 1e-4, "pulls": True}]}],
        "valves": [{"name": "tap", "a": "alone", "resistance": 1e9}],
        "drives": [{"type": "flow", "name": "pump", "line": "alone", "value": 1e-6}]}
    run = sandbox.simulate(sandbox.expand(sandbox.load_scene(scene)))
    assert fluid(FrameRenderer(run).draw(0.05)) > 0
