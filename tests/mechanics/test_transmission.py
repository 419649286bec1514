"""Ratios, the equilibrium curve and isotropy: against the general statics and published figures."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.mechanics import statics, transmission
from sandbox.study.reference_fingers import SET_G, SET_G_TABLE, DiscRow

MID = np.array(SET_G.lengths) / 2


@pytest.mark.parametrize("row", SET_G_TABLE)
def test_force_transfer_of_the_table(row: DiscRow) -> None:
    """The sum of the table's own forces over its tension, and the smallest over the largest."""
    f = np.array(row.forces)
    assert transmission.force_transfer_ratio(f, row.tension) == pytest.approx(
        sum(row.forces) / row.tension)
    assert transmission.force_isotropy(f) == pytest.approx(min(row.forces) / max(row.forces))


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


SHARES = {0.1: 0.8938967, 0.2: 0.7612676, 0.3: 0.5907444, 0.4: 0.3633802, 0.5: 0.2213919,
          0.6: 0.1439515, 0.7: 0.0915801}
"""Stable share of the grasp-state plane for l_2 = 2 l_1 / 3, integrated apart from this program."""


def test_stable_share_of_the_plane() -> None:
    """To the 7 digits of the table, and by counting poses in which f_1 > 0.

    On a grid of n by n cells the curve passes through at most 2 n of them: 2 / n is the error.
    """
    ratios = np.array(list(SHARES))
    found = transmission.stable_share(0.06, 0.04, ratios)
    np.testing.assert_allclose(found, list(SHARES.values()), rtol=0, atol=5.1e-8)
    n = 400
    middle = (np.arange(n) + 0.5) / n
    for X, share in zip(ratios, found, strict=True):
        forces = transmission.two_phalanx_forces(
            middle[:, None] * np.pi / 2, 0.03, 0.04 * middle, 0.06, 1.0, X)
        assert (forces.proximal > 0).mean() == pytest.approx(share, abs=2 / n)
    with pytest.raises(ValueError, match="ratio must be below 1, got 1"):
        transmission.stable_share(0.06, 0.04, 1.0)


@given(st.lists(st.floats(0.0, 1.3), min_size=4, max_size=4))
def test_isotropic_arms_press_equally(theta: list[float]) -> None:
    """T h over J^-T for those arms: the same force on four phalanges, and isotropy 1."""
    lengths, k = (0.05, 0.04, 0.03, 0.02), (0.02, 0.02, 0.015, 0.012)
    h = transmission.isotropic_arms(theta, lengths, k)
    forces = statics.contact_forces(statics.contact_jacobian(theta, lengths, k), 3.0 * h)
    np.testing.assert_allclose(forces, 3.0, rtol=1e-8)
    assert transmission.force_isotropy(forces) == pytest.approx(1.0, rel=1e-8)


def test_equal_forces_at_mid_phalanx_want_nine_to_four_to_one() -> None:
    """45/26/21 mm pressed in the middle: 9 : 4.2 : 1 is right at theta_2, theta_3 = 52, 38 deg, in
    the range of Set G's grasps. Straight it would be 15.4 : 4.7 : 1, by adding up levers:
    22.5 + (45 + 13) + (71 + 10.5) = 162, 13 + 36.5 = 49.5 and 10.5 mm.
    """
    straight = transmission.isotropic_arms(np.zeros(3), SET_G.lengths, MID)
    np.testing.assert_allclose(straight, [0.162, 0.0495, 0.0105], rtol=1e-14)
    held = transmission.isotropic_arms(np.radians([35.0, 52.0, 38.0]), SET_G.lengths, MID)
    np.testing.assert_allclose(held / held[2], [9.0, 4.2, 1.0], rtol=0, atol=0.05)
    J = statics.contact_jacobian(np.radians([35.0, 52.0, 38.0]), SET_G.lengths, MID)
    ruled = statics.contact_forces(J, np.array([9.0, 4.2, 1.0]) * 1e-3)
    assert transmission.force_isotropy(ruled) > 0.95


@pytest.mark.parametrize(("call", "message"), [
    (lambda: transmission.transmission_ratios([-0.01, 0.005]), "arms of joint 1 .* got -0.01 m"),
    (lambda: transmission.force_transfer_ratio([1.0], 0.0), "tension .* got 0 N"),
    (lambda: transmission.equilibrium_distance(0.3, 0.04, 1.25), "ratio must be below 1, got 1.25"),
    (lambda: transmission.two_phalanx_forces(0.3, 0.02, 0.0, 0.04, 1, 1), "k_2 .* got 0 m"),
    (lambda: transmission.force_isotropy([0.0, 0.0]), "largest of forces .* got 0 N"),
])
def test_impossible_transmissions_are_refused(call: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
