"""Bodies are drawn plane by plane, whatever their role, and those that stay among them."""

import numpy as np
import pytest

from sandbox.picture.palette import ROLES
from sandbox.scene.mechanism import Mechanism
from tests.draw.painted import frames_of

from .conftest import recording


def seen(*bodies):
    """The fill that is seen where bodies lie above one another; each is role, plane, motion."""
    run = recording(Mechanism.model_validate({
        "bodies": [{"name": f"b{i}", "role": role, "plane": plane, "motion": motion,
                    **({} if motion == "fixed" else {"mass": 1}),
                    "shapes": [{"type": "box", "size": [0.04, 0.04]}]}
                   for i, (role, plane, motion) in enumerate(bodies)],
        "view": {"centre": [0, 0], "width": 0.12}}),
        np.zeros(1), np.zeros((1, len(bodies), 3)))
    drawn = frames_of(run, size=(480, 480))
    x, y = drawn.picture.camera.to_pixels(np.array([[0.003, 0.005]]))[0]
    pixels = drawn.draw(0.0)[int(y) - 8:int(y) + 8, int(x) - 8:int(x) + 8].reshape(-1, 3)
    return [role for role, style in ROLES.items() if (pixels == style.fill).all(axis=1).any()]


@pytest.mark.parametrize("motion", ["dynamic", "fixed"])
def test_the_higher_plane_is_in_front(motion):
    assert seen(("object", 1, motion), ("phalanx", 0, "dynamic")) == ["object"]
    assert seen(("phalanx", 0, "dynamic"), ("object", 1, motion)) == ["object"]


def test_in_one_plane_the_role_decides_as_ever():
    assert seen(("phalanx", 0, "dynamic"), ("object", 0, "dynamic")) == ["phalanx"]
    assert seen(("phalanx", 0, "dynamic"), ("palm", 0, "fixed")) == ["phalanx"]
