"""Pictures of outlines cut into pieces: no seam inside, holes open, joints of a chain unseen."""

from __future__ import annotations

import math

import numpy as np
import pytest
from PIL import Image

import sandbox

STAR = [[r * math.cos(k * math.pi / 7), r * math.sin(k * math.pi / 7)]
        for k, r in enumerate([1.0, 0.5] * 7)]
RING = [[0.2 * math.cos(k), 0.2 * math.sin(k)] for k in np.linspace(0, 6.0, 12).tolist()]


def picture(tmp_path, shape, motion) -> np.ndarray:
    body = {"name": "b", "motion": motion, "shapes": [shape]}
    if motion == "dynamic":
        body["density"] = 1000
    run = sandbox.simulate(sandbox.load_scene({
        "run": {"duration": "1 ms", "step": "1 ms", "sample_rate": 1000}, "bodies": [body],
        "view": {"centre": [0, 0], "width": 3, "size": [600, 450]}}))
    sandbox.render(run, tmp_path / "one.png")
    return np.asarray(Image.open(tmp_path / "one.png").convert("RGB")).astype(int)


def at(image: np.ndarray, x: float, y: float) -> np.ndarray:
    """The colours of 5 x 5 pixels about a place [m]; the view is 3 m wide and centred."""
    scale = image.shape[1] / 3
    column, row = round(300 + scale * x), round(225 - scale * y)
    return image[row - 2:row + 3, column - 2:column + 3].reshape(-1, 3)


@pytest.mark.parametrize("holes", [[], [RING]])
def test_inside_of_a_body_no_seam_shows(tmp_path, holes):
    image = picture(tmp_path, {"type": "polygon", "points": STAR, "holes": holes}, "dynamic")
    # rings between hole and sides, which every seam from corner to corner crosses
    fills = np.concatenate([at(image, r * math.cos(t), r * math.sin(t))
                            for t in np.linspace(0, math.tau, 90) for r in (0.28, 0.36)])
    assert (fills == fills[0]).all()
    middle = at(image, 0, 0)
    assert (middle == (255 if holes else fills[0])).all()
