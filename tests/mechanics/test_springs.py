"""Equations (20)-(30) and the spring arms, against ends placed by coordinates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sandbox.mechanics import springs
from sandbox.study.reference_fingers import SET_A, SET_G, FingerSet

from .coordinates import straight_lines

SETS = pytest.mark.parametrize("finger", [SET_A, SET_G], ids=["A", "G"])


def _springs(finger: FingerSet) -> springs.SpringSet:
    return springs.spring_set(finger.before, finger.after)


@SETS
def test_lengths_over_time_are_distances(finger: FingerSet) -> None:
    """(20)-(29), shape [time, 3], against the distance of the ends in the world."""
    theta = np.linspace([0, 0, 0], finger.limits, 40)
    by_hand = straight_lines(finger, theta, finger.before, finger.after, own_frame=False)
    np.testing.assert_allclose(_springs(finger).lengths(theta), by_hand, rtol=0, atol=1e-15)


@pytest.mark.parametrize("before", [(-0.007, 0.008), (0.003, 0.008), (-0.007, -0.004)])
def test_any_quadrant(before: tuple[float, float]) -> None:
    """(22) with the sign of x: right wherever M'' lies, where the printed atan2(y/x) is not."""
    finger = replace(SET_A, before=(before,), after=((0.007, 0.008),), lengths=(0.045,))
    theta = np.linspace(0, 1.2, 9)[:, None]
    by_hand = straight_lines(finger, theta, finger.before, finger.after, own_frame=False)
    np.testing.assert_allclose(_springs(finger).lengths(theta), by_hand, rtol=0, atol=1e-15)


@SETS
def test_arms_are_the_derivative(finger: FingerSet) -> None:
    """hm = d(lm)/d(theta), on both sides of the over-centre angle. A central difference of
    step e errs by e^2/6 |lm'''| + 1e-17/e; |lm'''| < 1 m and e = 1e-5 give < 2e-11 m.
    """
    theta, e = np.linspace([0, 0, 0], [2.2, 2.2, 2.2], 30), 1e-5
    found = _springs(finger)
    slope = (found.lengths(theta + e) - found.lengths(theta - e)) / (2 * e)
    np.testing.assert_allclose(found.arms(theta), slope, rtol=0, atol=2e-11)
    assert (found.arms(theta)[0] > 0).all()
    assert (found.arms(theta)[-1] < 0).all()


def test_over_centre_angles() -> None:
    """Rho_0 + omega_0: 90 deg for ends at (-8, 8), (8, 8); 2 atan2(b, 7) for Set A. There the
    hinge lies on the spring: lm = dm + rm and no arm.
    """
    np.testing.assert_allclose(
        np.degrees(_springs(SET_G).over_centre), [90, 90, 90], rtol=0, atol=1e-12)
    heights = np.array([8, 8, 10])
    np.testing.assert_allclose(
        _springs(SET_A).over_centre, 2 * np.arctan(heights / 7), rtol=0, atol=1e-14)
    found = _springs(SET_A)
    np.testing.assert_allclose(found.lengths(found.over_centre), found.dm + found.rm, rtol=1e-14)
    np.testing.assert_allclose(found.arms(found.over_centre), 0, atol=1e-17)


def test_each_attachment_angle_belongs_to_its_own_end() -> None:
    """(26) at M'', (27) at M', on sides of unlike length: angles between arms as vectors.

    Ends at (-12, 5) and (3, 4) mm about the hinge, the second turned by -theta: the angle at each
    end is that between the ways to the hinge and to the other end.
    """
    before, after = np.array([-0.012, 0.005]), np.array([0.003, 0.004])
    found = springs.spring_set(before, after)
    for theta in (0.0, 0.4, 1.2):
        c, s = np.cos(theta), np.sin(theta)
        end = np.array([c * after[0] + s * after[1], c * after[1] - s * after[0]])
        angles = []
        for here, there in ((before, end), (end, before)):
            inward, along = -here, there - here
            angles.append(np.arccos(inward @ along
                                    / np.linalg.norm(inward) / np.linalg.norm(along)))
        rho, omega = found.attachment_angles([theta])
        assert (rho[0], omega[0]) == (pytest.approx(angles[0]), pytest.approx(angles[1]))


def test_end_forces_pull_together() -> None:
    """Along the spring, equal and opposite, shape [time, 2]; a pushed one drives its ends apart."""
    near, far = springs.end_forces([[0.0, 0.0], [0.0, 0.0]], [0.03, 0.04], [5.0, -10.0])
    np.testing.assert_allclose(near, [[3, 4], [-6, -8]], rtol=1e-15)
    np.testing.assert_array_equal(far, -near)


@pytest.mark.parametrize(("call", "message"), [
    (lambda: springs.attachment_radius((0.0, 0.0)), "after distance to its hinge .* got 0 m"),
    (lambda: springs.spring_set(SET_G.before, SET_G.after[:2]), "after must have 3 points"),
    (lambda: springs.spring_length(0.01, -0.02, 1.0), "rm must be greater than 0, got -0.02 m"),
    (lambda: springs.spring_length([0.01] * 2, [0.02] * 3, 1.0),
     "dm and rm and delta must be of equal length"),
])
def test_impossible_springs_are_refused(call: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
