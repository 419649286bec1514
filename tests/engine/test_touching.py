"""Contacts as the step sees them: gaps, normals and places without pymunk's margins, in order."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.audit.audit import audit
from sandbox.engine.world import MOST_MARGIN

from .machines import Bench, G, disc, fixed, mechanism

R = 0.01
CIRCLE = {"type": "circle", "radius": R}
CAPSULE = {"type": "capsule", "start": (-0.03, 0.0), "end": (0.03, 0.0), "radius": R}
BOX = {"type": "box", "size": (0.06, 2 * R)}
DIAMOND = {"type": "polygon", "points": [(0.0, -R), (0.02, 0.01), (0.0, 0.03), (-0.02, 0.01)]}
GAPS = (2e-4, 0.0, -3e-4)
"""Less than the margins of 1 mm together; touching; overlapping."""


def touching(
    upper: dict[str, Any], lower: dict[str, Any], gap: float, *, turn: float, swapped: bool,
    lift: float = 2 * R, aside: float = 0.0,
) -> tuple[Bench, np.ndarray]:
    """One shape above another, both free, all turned and shifted; touches, and where they are."""
    c, s = np.cos(turn), np.sin(turn)
    place = np.array([[c, -s], [s, c]]) @ [aside, lift + gap] + [0.3, -0.2]
    bodies = [{"name": "low", "mass": 0.1, "inertia": 1e-5, "at": (0.3, -0.2), "angle": turn,
               "shapes": [lower]},
              {"name": "high", "mass": 0.1, "inertia": 1e-5, "at": place.tolist(), "angle": turn,
               "shapes": [upper]}]
    bench = Bench(mechanism(bodies=bodies[::-1] if swapped else bodies)).step()
    touches = bench.state.touches[:bench.state.touching[0]]
    return bench, touches


def flat(bench: Bench, touches: np.ndarray, turn: float) -> np.ndarray:
    """Places of the touches from the lower body, turned back, [n, 2]: with a's arm and with b's."""
    c, s = np.cos(turn), np.sin(turn)
    seen = []
    for body, x, y in (("a", "ax", "ay"), ("b", "bx", "by")):
        at = bench.state.body[touches[body], :2] + np.stack([touches[x], touches[y]], axis=1)
        seen.append((at - [0.3, -0.2]) @ np.array([[c, -s], [s, c]]))
    np.testing.assert_allclose(*seen, atol=1e-15)
    return seen[0][np.argsort(seen[0][:, 0])]


PAIRS: dict[str, tuple[dict[str, Any], dict[str, Any], list[float]]] = {
    "circle on circle": (CIRCLE, CIRCLE, [0.0]),
    "circle on capsule": (CIRCLE, CAPSULE, [0.0]),
    "capsule on circle": (CAPSULE, CIRCLE, [0.0]),
    "circle on box": (CIRCLE, BOX, [0.0]),
    "box on circle": (BOX, CIRCLE, [0.0]),
    "corner on box": (DIAMOND, BOX, [0.0]),
    "corner on capsule": (DIAMOND, CAPSULE, [0.0]),
    "corner on circle": (DIAMOND, CIRCLE, [0.0]),
    "box on box": (BOX, BOX, [-0.03, 0.03]),
    "capsule on capsule": (CAPSULE, CAPSULE, [-0.03, 0.03]),
    "capsule on box": (CAPSULE, BOX, [-0.03, 0.03]),
    "box on capsule": (BOX, CAPSULE, [-0.03, 0.03]),
}
"""The upper shape's lowest point is 10 mm down, the lower's highest 10 mm up; where they touch."""


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize("pair", PAIRS)
def test_gap_normal_and_place(pair: str, gap: float, swapped: bool) -> None:
    """Gap to 1e-15 m (coordinates of 0.3 m round by 6e-17), normal from the body that comes first,
    place half way between the surfaces; pymunk's own rounding of closest points is 1e-9 of a shape.
    """
    upper, lower, where = PAIRS[pair]
    turn = 0.4
    bench, touches = touching(upper, lower, gap, turn=turn, swapped=swapped)
    assert len(touches) == len(where)
    assert touches["a"].tolist() == [0] * len(where)
    assert touches["b"].tolist() == [1] * len(where)
    np.testing.assert_allclose(touches["gap"], gap, rtol=0, atol=1e-12)
    up = np.array([-np.sin(turn), np.cos(turn)]) * (-1 if swapped else 1)
    normals = np.stack([touches["nx"], touches["ny"]], axis=1)
    np.testing.assert_allclose(normals, np.tile(up, (len(where), 1)), rtol=0, atol=1e-9)
    places = flat(bench, touches, turn)
    np.testing.assert_allclose(places[:, 1], R + gap / 2, rtol=0, atol=1e-9)
    np.testing.assert_allclose(places[:, 0], where, rtol=0, atol=MOST_MARGIN + 1e-9)
    if len(where) == 1:
        np.testing.assert_allclose(places[:, 0], where, rtol=0, atol=1e-9)


# -- memory ----------------------------------------------------------------------------


def test_what_is_wedged_is_left_alone() -> None:
    """A disc half a millimetre too large for its gap on either side: there is no way out, so that
    asking for one would be answered with forces without end. It slides down as if it fitted.
    """
    wall = {"type": "box", "size": (0.02, 0.4)}
    run = sandbox.simulate(mechanism(
        duration=0.1, gravity=(0.0, -G),
        bodies=[fixed("left", at=(-0.02, 0.0), shapes=[wall]),
                fixed("right", at=(0.02, 0.0), shapes=[wall]),
                disc("disc", R + 5e-4, (0.0, 0.0)),
                fixed("floor", at=(0.5, -0.01), shapes=[{"type": "box", "size": (0.2, 0.02)}]),
                disc("sunk", R, (0.5, R - 2e-3))]))
    assert np.abs(run["disc.x"]).max() < 1e-9
    assert run["disc.y"][-1] == pytest.approx(-G * run.time[-1]**2 / 2, rel=1e-3)
    # elsewhere an overlap of 2 mm comes out, at 0.1 m/s, and then the disc rests
    assert run["sunk.y"][-1] == pytest.approx(R, abs=1e-6)
    assert np.abs(np.diff(run["sunk.y"]) / np.diff(run.time)).max() == pytest.approx(0.1, rel=1e-3)


def test_links_that_overlap_on_a_knee_keep_moving_as_their_pins_have_it() -> None:
    """Two links on one pin of a third collide, and overlap for good: no blow, no divergence."""
    bar = {"type": "capsule", "end": (0.1, 0.0), "radius": 0.005}
    run = sandbox.simulate(mechanism(
        duration=0.3, gravity=(0.0, -G),
        bodies=[fixed("base"), {"name": "one", "mass": 0.3, "shapes": [bar]}, *(
            {"name": name, "mass": 0.3, "at": (0.1, 0.0), "angle": angle, "shapes": [bar]}
            for name, angle in (("two", -1.0), ("three", 1.0)))],
        joints=[{"type": "pin", "name": f"pin{i}", "a": a, "b": b, "on_b": (0.0, 0.0)}
                for i, (a, b) in enumerate((("base", "one"), ("one", "two"), ("one", "three")))]))
    verdicts = {figure.name: figure.verdict for figure in audit(run)}
    for name in ("energy.created", "energy.lost", "momentum.force", "momentum.moment",
                 "joint.drift", "contact.bounds"):
        assert verdicts[name] == "pass", name
    assert verdicts["contact.place"] == "look"  # 10 mm deep at the pin, and said
