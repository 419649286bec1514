"""Mechanisms with very many closed loops."""

from __future__ import annotations

from itertools import combinations

import pytest

from sandbox.engine.simulate import simulate
from sandbox.errors import SandboxError

from .machines import mass, mechanism


def test_a_mechanism_too_large_to_factor_is_refused() -> None:
    """Sixty bodies, every two of them pinned together."""
    joints = [{"type": "pin", "name": f"p{i}_{j}", "a": f"b{i}", "b": f"b{j}", "on_a": (0, 0)}
              for i, j in combinations(range(60), 2)]
    with pytest.raises(SandboxError, match="form too many loops"):
        simulate(mechanism(bodies=[mass(f"b{i}", 1.0, (0, 0)) for i in range(60)], joints=joints))
