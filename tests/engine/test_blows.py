"""Blows: what friction takes of them, what weight makes of them, and tips that stay."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from tests.support.mechanisms import G, fixed, mechanism

FLOOR = {"type": "box", "size": (4.0, 0.2), "at": (0.0, -0.1)}


def thrown(restitution: float, friction: float, step: float) -> Recording:
    """A disc at 45 degrees onto a floor, no weight, v = 2 m/s each way."""
    return simulate(mechanism(
        duration=0.02, step=step, materials={
            "m": {"friction": friction, "restitution": restitution}},
        bodies=[fixed("floor", material="m", shapes=[FLOOR]),
                {"name": "disc", "mass": 1.0, "at": (0.0, 0.02), "velocity": (2.0, -2.0),
                 "material": "m", "shapes": [{"type": "circle", "radius": 0.01}]}]))


@pytest.mark.parametrize("restitution", [0.5, 1.0])
@pytest.mark.parametrize("friction", [0.1, 1.0])
def test_friction_takes_part_in_a_blow(restitution: float, friction: float) -> None:
    """It slides all through, or rolls with 2/3 of its speed.

    The blow falls up to v h above the floor and friction in the middle of that gap: r + v h/2.
    """
    step = 1e-4
    run = thrown(restitution, friction, step)
    taken = min(friction * (1 + restitution) * 2.0, 2.0 / 3)
    arm = 2.0 * step / 2 / 0.01
    assert run["disc.vy"][-1] == pytest.approx(2.0 * restitution, rel=1e-9)
    assert run["disc.vx"][-1] == pytest.approx(2.0 - taken, abs=arm * taken)
    assert run["disc.omega"][-1] == pytest.approx(-taken * 0.01 / 5e-5, rel=3 * arm)
    rub = np.abs(run["disc/floor.tangential"]) <= friction * run["disc/floor.normal"] * (1 + 1e-9)
    assert rub.all()


@pytest.mark.parametrize("step", [1e-3, 5e-4])
def test_an_elastic_ball_keeps_its_energy(step: float) -> None:
    """It comes back to its height, nine times; the apex lies within h/2 of a sample."""
    run = simulate(mechanism(
        duration=9.0, step=step, gravity=(0.0, -G), run={"sample_rate": 1 / step},
        materials={"m": {"friction": 0.0, "restitution": 1.0}},
        bodies=[fixed("floor", material="m", shapes=[FLOOR]),
                {"name": "ball", "mass": 1.0, "at": (0.0, 1.1), "material": "m",
                 "shapes": [{"type": "circle", "radius": 0.1}]}]))
    y = run["ball.y"] - 0.1
    inner = y[1:-1]
    apexes = inner[(inner >= y[:-2]) & (inner > y[2:])]
    assert len(apexes) == 9
    np.testing.assert_allclose(apexes, 1.0, atol=G * step**2 / 8 + 1e-8)


def test_a_tip_that_sticks_does_not_creep() -> None:
    """Order 2: led along its tangent alone it would be off by ω² h/2 of its arm, 29 μm."""
    def slid(step: float) -> float:
        run = simulate(mechanism(
            duration=0.5, step=step, gravity=(0.0, -G), materials={"m": {"friction": 5.0}},
            bodies=[fixed("floor", material="m", shapes=[FLOOR]),
                    {"name": "rod", "mass": 0.2, "inertia": 0.2 * 0.5**2 / 12,
                     "centre": (0.0, 0.25), "angle": -0.1, "material": "m", "shapes": [
                         {"type": "polygon",
                          "points": [(0.0, 0.0), (1e-3, 0.1), (-1e-3, 0.1)]}]}]))
        return float(np.abs(run["rod.x"][run["rod.angle"] > -0.8]).max())

    coarse, fine = slid(1e-3), slid(5e-4)
    assert fine < 1e-6
    assert coarse / fine == pytest.approx(4.0, rel=0.1)
