"""Drives that set the stiffness of a tendon, against closed forms of a weight that hangs on it.

By a step x'' = - w^2 x becomes x_(n+1) - 2 x_n + x_(n-1) = - (h w)^2 x_n, whose solutions swing at
w', sin(h w' / 2) = h w / 2. At rest until t = 0 they are A cos(w' t) / cos(h w' / 2), the poses
being at t = h / 2, 3 h / 2, ...; so rounding is all that is left (1e-12 of some thousand steps).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from sandbox.engine.simulate import simulate
from sandbox.scene.mechanism import Mechanism

from .machines import G, H, cord, fixed, mass, mechanism

M, OWN, MORE, AT = 0.1, 40.0, 70.0, 0.05
"""Weight, stiffnesses before and after the instant ``AT``: less than twice, so it stays taut."""


def hanging(
    value: Any = None, *, driven: bool = True, own: float = OWN, duration: float = 0.4, **more: Any,
) -> Mechanism:
    """A weight in balance on a cord of 0.5 m; some value for the stiffness of the cord."""
    drive = {"type": "stiffness", "name": "k", "tendon": "c"}
    return mechanism(
        duration=duration, gravity=(0.0, -G), run={"sample_rate": 1 / H},
        bodies=[fixed("wall"), mass("m", M, (0.0, -0.5))],
        tendons=[cord("c", ("wall",), ("m",), stiffness=own, pretension=M * G, **more)],
        drives=[drive | ({} if value is None else {"value": value})] if driven else [])


@pytest.mark.parametrize("most", [MORE, 1e7])
def test_one_that_is_let_go_falls(most: float) -> None:
    """With 0, below which nothing counts: soft by the pose, or as a row at the step's end.

    Taken up again at the depth that it has fallen to it pulls with what it is then stretched by.
    """
    values = [(0.0, OWN), (0.1, -5.0), (0.2, OWN), (0.35, most)]
    run = simulate(hanging({"table": values, "between": "step"}))
    falls = (run.time > 0.1) & (run.time < 0.2)
    assert (run["k.value"][falls] == 0).all()
    assert (run["c.tension"][falls] == 0).all()
    assert np.diff(run["m.vy"][falls]) == pytest.approx(-G * H, abs=1e-12)
    assert run["c.tension"][np.flatnonzero(run.time > 0.2)[0]] > M * G


def test_a_stiff_one_rests_where_its_stiffness_says() -> None:
    """The row at the step's end damps its vibration: x = m g / k after it.

    Lengths of 0.5 m are known to 1e-16 m, of 0.2 um that is 5e-10.
    """
    own = 2e4
    run = simulate(hanging({"table": [(0.0, own), (0.1, 1e6), (0.3, 4e6)], "between": "step"},
                           own=own, damping=50.0))
    for at, k in ((0.29, 1e6), (0.39, 4e6)):
        n = int(np.flatnonzero(run.time > at)[0])
        x = run["c.length"][n] - 0.5 + M * G / own
        assert x == pytest.approx(M * G / k, rel=1e-8)
        assert run["c.tension"][n] == pytest.approx(M * G, rel=1e-9)


@pytest.mark.parametrize("names", [{}, {"spring": "s", "tendon": "c"}])
def test_it_sets_one_thing(names: dict[str, str]) -> None:
    with pytest.raises(ValidationError, match="needs either 'spring' or 'tendon'"):
        mechanism(drives=[{"type": "stiffness", "name": "k", **names}])
