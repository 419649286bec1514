"""The engine against an independent integration, and against the statics of a grasp."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.mechanics.grasp import disc_centre, disc_grasp
from sandbox.recording.recording import Recording
from sandbox.study import independent as reference
from sandbox.study.reference_fingers import SET_A, SET_G, SET_G_TABLE, DiscRow, FingerSet

from .machines import BODIES, HINGES, finger

STEPS = (1e-3, 5e-4, 2.5e-4)


def angles(run: Recording) -> np.ndarray:
    """The joints' angles [rad], shape [samples, 3]."""
    return np.stack([run[f"{hinge}.angle"] for hinge in HINGES], axis=1)


def closing_error(numbers: FingerSet, pull: float, duration: float, step: float) -> float:
    """Largest difference of any joint at any sample [deg]."""
    run = simulate(finger(numbers, pull=pull, duration=duration, step=step, stops=False))
    truth = reference.integrate(numbers, run.time, pull=pull)
    return float(np.degrees(np.abs(angles(run) - truth.angle).max()))


@pytest.fixture(scope="module")
def errors() -> list[float]:
    return [closing_error(SET_G, 3.0, 0.06, step) for step in STEPS]


def test_free_closing(errors: list[float]) -> None:
    """M q'' = T h - k (lm - lm_0) hm - d q' - Coriolis, Set G from straight under 3 N, 0.06 s.

    0.006 deg at h = 0.5 ms is the project's requirement, and a quarter of it at 0.25 ms follows
    from order 2. The integration it is held against has 1e-7 deg.
    """
    assert errors[1] < 0.006
    assert errors[2] < 0.006 / 4


def assert_second_order(errors: list[float]) -> None:
    """Halving h quarters the error; damped hinges take up to 0.4 of the order at these steps."""
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert ((orders > 1.6) & (orders < 2.3)).all(), orders


def test_free_closing_is_second_order(errors: list[float]) -> None:
    assert_second_order(errors)


def test_stiff_set_a_is_second_order() -> None:
    """The same motion equation for Set A under 3 N, springs of up to 15 kN/m: order 2 as above.

    Explicit springs are stable while omega h < 2; Set A's fastest mode, 270 Hz, has
    omega h = 0.42, 0.21 and 0.11 at these steps.
    """
    steps = (2.5e-4, 1.25e-4, 6.25e-5)
    errors = [closing_error(SET_A, 3.0, 0.03, step) for step in steps]
    assert_second_order(errors)
    # Richardson: with order 2 the last error is a third of the last change, both in degrees
    assert errors[-1] < 1.5 * (errors[1] - errors[2]) / 3


def exact(row: DiscRow) -> DiscRow:
    """The row with its centre unrounded: k_1 = 31 mm at theta_1 = 35 deg."""
    centre = disc_centre(np.radians(35.0), 0.031, row.disc_radius, SET_G.radii[0])
    return DiscRow(row.disc_radius, (float(centre[0]), float(centre[1])), row.tension,
                   row.degrees, row.forces)


@pytest.mark.parametrize("row", SET_G_TABLE)
def test_grasp_of_a_disc(row: DiscRow) -> None:
    """Set G, frictionless, from straight onto a fixed disc: tau = J^T f at rest.

    Three contacts and three joints: geometry alone makes the pose, statics the
    forces. The engine has both to all digits that the table gives, rounded to
    0.001 deg and 0.1 mN.
    """
    run = simulate(finger(SET_G, pull=row.tension, duration=1.5, step=5e-4, disc=exact(row)))
    np.testing.assert_allclose(np.degrees(angles(run)[-1]), row.degrees, rtol=0, atol=5e-4)
    forces = [run[f"{body}.contact.normal"][-1] for body in BODIES]
    np.testing.assert_allclose(forces, row.forces, rtol=0, atol=5e-5)


def test_contact_points_and_normals() -> None:
    """A contact lies on the disc's rim, k_i along its phalanx, and pushes away from the centre.

    Gaps are closed to 1e-10 m; on a rim of 16 mm that turns a normal by no more than 1e-8.
    """
    row = exact(SET_G_TABLE[0])
    run = simulate(finger(SET_G, pull=row.tension, duration=1.5, step=5e-4, disc=row))
    truth = disc_grasp(row.centre, row.disc_radius, SET_G.lengths, SET_G.radii)
    last = run.arrays["contact_sample"] == len(run) - 1
    assert run.arrays["contact_body"][last].tolist() == [1, 2, 3]
    np.testing.assert_allclose(run.arrays["contact_point"][last], truth.contacts, atol=1e-10)
    np.testing.assert_allclose(run.arrays["contact_normal"][last], truth.normals, atol=1e-8)
    force = run.arrays["contact_force"][last]
    np.testing.assert_allclose(np.linalg.norm(force, axis=1), row.forces, rtol=0, atol=5e-5)


def test_pull_below_zero_is_slack() -> None:
    """A tendon cannot push: with -3 N the finger stays straight, to the last digit."""
    run = simulate(finger(SET_G, pull=-3.0, duration=0.02, step=5e-4))
    assert np.abs(angles(run)).max() < 1e-12
    assert (run["finger.tendon.tension"] == 0).all()
