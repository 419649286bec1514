"""Ratios, the equilibrium curve and isotropy: against the general statics and published figures."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.mechanics import statics, transmission
from sandbox.mechanics.four_bar import FourBar, crank_torques
from sandbox.mechanics.transmission import two_phalanx_forces


@given(st.floats(0.0, 1.5), st.floats(0.005, 0.045), st.floats(0.003, 0.03),
       st.floats(-0.01, 0.05), st.floats(-0.01, 0.05))
def test_two_phalanges_are_the_general_case(
    theta_2: float, k_1: float, k_2: float, tau_1: float, tau_2: float,
) -> None:
    """f_1, f_2 against J^-T tau of the n-phalanx closed form."""
    found = transmission.two_phalanx_forces(theta_2, k_1, k_2, 0.045, tau_1, tau_2)
    J = statics.contact_jacobian([0.3, theta_2], (0.045, 0.03), [k_1, k_2])
    np.testing.assert_allclose(
        [found.proximal, found.distal], statics.contact_forces(J, [tau_1, tau_2]),
        rtol=1e-9, atol=1e-9)


@given(st.floats(0.0, 3.0), st.floats(0.02, 0.98))
def test_equilibrium_curve_is_where_f_1_vanishes(theta_2: float, ratio: float) -> None:
    """At k_2 = e the proximal force is 0, beyond it positive, before it negative."""
    edge = float(transmission.equilibrium_distance(theta_2, 0.045, ratio))
    if edge < 1e-5:
        return  # cos(theta_2) <= 0: the curve has left the phalanx
    e = np.array([edge * 0.999, edge, edge * 1.001])
    f_1 = transmission.two_phalanx_forces(theta_2, 0.02, e, 0.045, 0.03, 0.03 * ratio).proximal
    assert f_1[0] < 0 < f_1[2]
    assert abs(f_1[1]) < 1e-12 * 0.03 / 0.02 / (1 - ratio)


@given(st.lists(st.floats(0.0, 1.3), min_size=4, max_size=4))
def test_isotropic_arms_press_equally(theta: list[float]) -> None:
    """T h over J^-T for those arms: the same force on four phalanges, and isotropy 1."""
    lengths, k = (0.05, 0.04, 0.03, 0.02), (0.02, 0.02, 0.015, 0.012)
    h = transmission.isotropic_arms(theta, lengths, k)
    forces = statics.contact_forces(statics.contact_jacobian(theta, lengths, k), 3.0 * h)
    np.testing.assert_allclose(forces, 3.0, rtol=1e-8)
    assert transmission.force_isotropy(forces) == pytest.approx(1.0, rel=1e-8)


# --- four-bar linkages


DEG = np.radians(1)
LAVAL = FourBar(frame=0.050, first=0.040, coupler=0.0477643698, second=0.012)
"""A crank of 40 mm that stands at 75 deg to the proximal phalanx while the finger is straight."""
HORN, TORQUE, K_1, K_2 = 90 * DEG, 0.5, 0.025, 0.050 / 3


def e(angle: float) -> complex:
    return complex(np.exp(1j * angle))


def test_the_angles_are_those_of_syngrasps_coupled_finger():
    """q_1 - z_a at z_p of 90 to 150 deg, angles inside of the frame; its ratios have 8 digits."""
    bar = FourBar(0.038, 0.020, 0.035, 0.015)
    inside = np.array([90, 105, 120, 135, 150]) * DEG
    assert np.allclose(bar.first_angle(np.pi - inside) / DEG, [
        80.4444823, 69.1004108, 57.5968318, 46.2940821, 35.7079490], rtol=0, atol=5e-8)
    assert np.allclose(-bar.ratio(np.pi - inside), [
        -0.74350878, -0.76527001, -0.76468737, -0.73686400, -0.66503558], rtol=0, atol=1e-8)


@pytest.mark.parametrize("crossed", [False, True])
def test_the_coupler_keeps_its_length_and_the_ratio_is_the_slope(crossed: bool):
    """By differences of 1e-5 rad, whose error is some 1e-10."""
    bar = FourBar(0.050, 0.040, 0.048, 0.012, crossed)
    second = np.linspace(-2.5, 2.5, 41)
    ends = bar.frame + bar.second * np.exp(1j * second) - bar.first * np.exp(
        1j * bar.first_angle(second))
    assert np.allclose(np.abs(ends), bar.coupler, rtol=0, atol=1e-15)
    slope = (bar.first_angle(second + 1e-5) - bar.first_angle(second - 1e-5)) / 2e-5
    assert np.allclose(bar.ratio(second), slope, rtol=0, atol=1e-8)


def crank(theta_1: float, theta_2: float) -> float:
    """Closing angle of the crank [rad] at which the coupler closes, by bisection of the points.

    The finger closes clockwise from +x; the formulas under test are not used.
    """
    hinge = 0.050 * e(-theta_1)
    horn = hinge + 0.012 * e(-theta_1 - theta_2 + HORN)
    low, high = -np.angle(horn) - np.pi, -np.angle(horn)
    assert abs(horn - 0.040 * e(-low)) > LAVAL.coupler > abs(horn - 0.040 * e(-high))
    for _ in range(60):
        middle = (low + high) / 2
        longer = abs(horn - 0.040 * e(-middle)) > LAVAL.coupler
        low, high = (middle, high) if longer else (low, middle)
    return float(low)


def contacts(theta_1: float, theta_2: float) -> np.ndarray:
    """How far each contact has gone along its phalanx's push: material points, shape [2, 2]."""
    first = K_1 * e(-theta_1)
    second = 0.050 * e(-theta_1) + K_2 * e(-theta_1 - theta_2)
    return np.array([[first.real, first.imag], [second.real, second.imag]])


@pytest.mark.parametrize("degrees", [0, 30, 75, 90])
def test_forces_are_those_of_virtual_work(degrees: float):
    """Central differences of 1e-5 rad: 1e-9 of 20 N and bisection's rounding, 1e-16 / 1e-5."""
    theta, step = np.array([0.6, degrees * DEG]), 1e-5
    work, J = np.zeros(2), np.zeros((2, 2))
    normals = np.array([[-np.sin(a), -np.cos(a)] for a in np.cumsum(theta)])
    for j in range(2):
        ahead, behind = theta.copy(), theta.copy()
        ahead[j] += step
        behind[j] -= step
        work[j] = TORQUE * (crank(*ahead) - crank(*behind)) / (2 * step)
        moved = (contacts(*ahead) - contacts(*behind)) / (2 * step)
        J[:, j] = (moved * normals).sum(axis=1)
    wanted = np.linalg.solve(J.T, work)
    tau = crank_torques(TORQUE, LAVAL, HORN)(theta)
    found = two_phalanx_forces(theta[1], K_1, K_2, LAVAL.frame, *tau)
    assert np.allclose([found.proximal, found.distal], wanted, rtol=0, atol=1e-6)
    h = LAVAL.cut(HORN - theta[1])
    assert found.distal == pytest.approx(TORQUE * h / (K_2 * (h + 0.050)), rel=1e-12)
    assert found.proximal == pytest.approx(
        TORQUE * 0.050 * (K_2 - h * np.cos(theta[1])) / (K_1 * K_2 * (h + 0.050)), rel=1e-9)
