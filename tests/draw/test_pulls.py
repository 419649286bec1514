"""The arrow of a pull goes on along its cord, also where that comes from a wheel."""

import numpy as np
import pytest

from sandbox.draw.film.drives import DriveDrawer
from sandbox.draw.film.forces import ForceScale
from sandbox.draw.film.points import PointPool
from sandbox.scene.mechanism import Mechanism

from .conftest import recording

R = 0.03


def direction(side, end):
    """Of the arrow of a cord that comes from a wheel about the origin, to be pulled at ``end``."""
    run = recording(Mechanism.model_validate({
        "bodies": [{"name": "frame", "motion": "fixed"}],
        "tendons": [{"name": "cord", "guides": [
            {"body": "frame", "at": [0.2, 0]}, {"body": "frame", "radius": R, "side": side},
            {"body": "frame", "at": end}]}],
        "drives": [{"type": "pull", "name": "pull", "tendon": "cord", "value": 1}]}),
        np.zeros(1), np.zeros((1, 1, 3)))
    pool = PointPool()
    drawer = DriveDrawer(run, pool, 0.02, ForceScale(0.0, 0.0))
    pool.close()
    ((_, tail, tip),) = drawer.ends(pool.world(np.zeros((1, 3))), np.ones(1))
    assert tail == pytest.approx(end)
    arrow = np.array(tip) - tail
    return arrow / np.hypot(*arrow)


@pytest.mark.parametrize(("side", "end"), [
    ("left", (-0.1, R)), ("right", (-0.1, -R)), ("left", (-R, -0.1)), ("right", (-R, 0.1))])
def test_it_leaves_the_rim_and_not_the_centre(side, end):
    """Ends straight beyond the wheel's top, bottom and left side, on its tangents there."""
    along = np.where(np.abs(end) > R, np.sign(end), 0.0)
    assert direction(side, end) == pytest.approx(along, abs=1e-12)
