"""Equation (31) for n phalanges, against complex numbers."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.mechanics import chain
from sandbox.study.reference_fingers import SET_G

from .coordinates import frames


@pytest.mark.parametrize("n", [1, 3, 6])
def test_positions_by_complex_numbers(n: int) -> None:
    """Hinges, points of phalanges and tip, shape [time, n]; roundings of 0.2 m stay under 1e-15."""
    lengths = tuple(np.linspace(0.05, 0.02, n).tolist())
    theta = np.random.default_rng(n).uniform(-0.2, 1.4, (11, n))
    origin, direction = frames(lengths, theta)
    found = chain.transforms(theta, lengths)
    assert found.shape == (11, n, 3, 3)
    np.testing.assert_allclose(chain.hinges(found) @ [1, 1j], origin[:, 1:], rtol=0, atol=1e-15)
    local = np.array([0.013, -0.007])
    np.testing.assert_allclose(
        chain.to_world(found, local) @ [1, 1j],
        origin[:, 1:] + direction[:, 1:] * (local @ [1, 1j]), rtol=0, atol=1e-15)
    np.testing.assert_allclose(
        chain.tip(found, lengths[-1]) @ [1, 1j],
        origin[:, -1] + direction[:, -1] * lengths[-1], rtol=0, atol=1e-15)


def test_base_places_the_finger() -> None:
    """A palm turned by a quarter: what lay along +x lies along +y."""
    found = chain.transforms(np.zeros(3), SET_G.lengths, chain.pose(0.1, 0.2, np.pi / 2))
    np.testing.assert_allclose(
        chain.hinges(found), [[0.1, 0.2], [0.1, 0.245], [0.1, 0.271]], rtol=0, atol=1e-15)


def test_links_come_back_from_frames_in_the_world() -> None:
    """(31) undone over time, shape [7, 4], on a palm anywhere; and poses as the world counts."""
    theta = np.random.default_rng(8).uniform(-1, 2, (7, 4))
    lengths, palm = (0.04, 0.03, 0.02, 0.02), chain.pose([0.1] * 7, 0.2, np.linspace(0, 3, 7))
    found = chain.transforms(theta, lengths, palm)
    np.testing.assert_allclose(
        chain.links_between(found, palm), chain.link_transforms(theta, lengths), rtol=0, atol=1e-15)
    np.testing.assert_allclose(
        chain.inverse(found) @ found, np.broadcast_to(np.eye(3), (7, 4, 3, 3)), rtol=0, atol=1e-15)
    turned = np.linspace(0, 3, 7)[:, None] - np.cumsum(theta, axis=1)
    at = chain.hinges(found)
    np.testing.assert_allclose(
        chain.pose(at[..., 0], at[..., 1], turned), found, rtol=0, atol=1e-14)


def test_impossible_chains_are_refused() -> None:
    with pytest.raises(ValueError, match=r"x and y and angle must be of equal length"):
        chain.pose([0.0, 1.0], [0.0, 1.0, 2.0])
    with pytest.raises(ValueError, match=r"frames must have shape \[..., n, 3, 3\]"):
        chain.links_between(np.eye(3))
    with pytest.raises(ValueError, match=r"length_before must be 0 or more, got -0.1 m"):
        chain.link_transform(0.1, -0.1)
    with pytest.raises(ValueError, match=r"lengths must be greater than 0, got -0.02 m"):
        chain.transforms(np.zeros(2), [0.03, -0.02])
    with pytest.raises(ValueError, match=r"theta must have 3 values in rad"):
        chain.transforms(np.zeros(2), SET_G.lengths)
