"""The grasp-state map against the potential energy along slides; stiffness of a grasp."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.mechanics.grasp_state import GraspState, TwoPhalanges, ejection_path, tendon_torques
from sandbox.mechanics.grasp_stiffness import grasp_map, grasp_stiffness, tip_jacobian
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.tendon import route
from tests.verification.test_grasps import two_fingers

L = (0.045, 0.030)
STOPS = {"lower": (-1.5, 0.0), "upper": (1.5, 1.6)}
GUIDES = [(-0.022, -0.014), (0.024, -0.005), (0.008, -0.003)]
CABLE = route(GUIDES, L)
SPRINGS = spring_set([(-0.008, 0.008)] * 2, [(0.008, 0.008)] * 2)
TENSION, STIFFNESS = 5.0, (300.0, 200.0)


def driven(apart: float = 0.0, **changes: object) -> TwoPhalanges:
    """A finger with a tendon and springs."""
    torques = tendon_torques(TENSION, CABLE, springs=SPRINGS, stiffness=STIFFNESS)
    return TwoPhalanges(L, torques, apart=apart, **(STOPS | changes))


def _object(theta: np.ndarray, k_2: np.ndarray, apart: float) -> np.ndarray:
    """The object's centre as a complex number, from the pose."""
    first, second = np.exp(-1j * theta[..., 0]), np.exp(-1j * theta.sum(axis=-1))
    return L[0] * first + (k_2 - 1j * apart) * second


@pytest.mark.parametrize("apart", [0.0, 0.023])
def test_every_slide_keeps_the_object_and_gives_energy(apart: float) -> None:
    """Along every slide the object stays where it is, by complex numbers, and the potential energy
    V = elastic - T shortening falls; at the equilibrium its slope is 0.
    """
    finger = driven(apart)
    seen = set()
    for theta_1, theta_2, k_2 in [(0.3, 0.2, 0.004), (0.9, 0.5, 0.008), (0.4, 0.1, 0.012),
                                  (1.2, 0.3, 0.002), (0.2, 0.05, 0.026), (0.5, 0.6, 0.006)]:
        path = ejection_path(finger, theta_1=theta_1, theta_2=theta_2, k_2=k_2, samples=401)
        if path.state == GraspState.STABLE:
            continue
        seen.add(path.state)
        centre = _object(path.theta, path.k_2, apart)
        np.testing.assert_allclose(
            centre, _object(path.theta[0], np.array(k_2), apart), rtol=0, atol=1e-15)
        energy = (0.5 * SPRINGS.elongations(path.theta)**2 @ np.array(STIFFNESS)
                  - TENSION * CABLE.shortening(path.theta))
        steps = np.diff(energy)
        assert (steps <= 1e-15).all()
        if path.state == GraspState.EQUILIBRIUM:  # a minimum: the last step is of second order
            assert abs(steps[-1]) < 0.01 * np.abs(steps).max()
        elif path.state == GraspState.EJECTS:
            assert path.k_2[-1] == pytest.approx(L[1], rel=1e-12)
    assert seen >= {GraspState.EQUILIBRIUM, GraspState.EJECTS} if not apart else seen


def test_two_mirrored_fingers():
    """SynGrasp's quasi-static analysis without synergies, of this hand by an own program."""
    _, hinges, tips = two_fingers()
    jacobian = tip_jacobian(tips, hinges, [[True, True, False, False], [False, False, True, True]])
    found = grasp_stiffness(grasp_map(tips, tips.mean(axis=0)), jacobian, np.full(4, 0.05),
                            contact_stiffness=2000.0)
    np.testing.assert_allclose(found, [
        [35.818082, 0, -1.596764], [0, 353.099848, 0], [-1.596764, 0, 0.210173]], atol=6e-7)
