"""A grasp of four fingers at rest."""

from __future__ import annotations

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene
from tests.hard.measures import late
from tests.hard.trial import AtMost, Measure, Trial
from tests.support.reference import SET_G
from tests.verification.case import point


def square(step: float) -> Mechanism:
    """A square, free in the plane, in the grasp of four fingers from four sides.

    The fingers lie in planes of their own and pass each other; each is pulled by itself.
    """
    centre = 0.011 - 0.042j
    names = [f"finger{i}" for i in range(1, 5)]
    fingers = [{
        "type": "finger", "name": name, "angle": np.pi / 2 * i, "material": "skin",
        "at": point(-centre * 1j**i), "lengths": SET_G.lengths, "radii": SET_G.radii,
        "masses": SET_G.masses, "guides": SET_G.guides, "damping": SET_G.damping,
        "limits": SET_G.limits,
        "springs": {"stiffness": 300, "from": SET_G.before[0], "to": SET_G.after[0]},
    } for i, name in enumerate(names)]
    return expand(load_scene({
        "run": {"duration": 4.0, "step": step, "sample_rate": 500.0}, "parts": fingers,
        "materials": {"skin": {"friction": 0.5}},
        "bodies": [{"name": "square", "mass": 0.05, "material": "skin", "at": [0.004, -0.003],
                    "angle": 0.4, "shapes": [{"type": "box", "size": [0.036, 0.036]}]}],
        "drives": [{"type": "pull", "name": f"{name}.pull", "tendon": name,
                    "value": {"ramp": {"to": 3.75, "over": 0.5}}} for name in names],
        "contacts": [{"between": ["finger*", "finger*"], "collide": False}]}))


def _pairs(run: Recording) -> np.ndarray:
    """Sizes of all contact forces [N] in the last second, a column for each pair, 0 if apart."""
    arrays = run.arrays
    count = len(run.mechanism.bodies)
    pair = arrays["contact_body"] * count + arrays["contact_other"]
    columns, place = np.unique(pair, return_inverse=True)
    sizes = np.zeros((len(run), len(columns)))
    sizes[arrays["contact_sample"], place] = np.linalg.norm(arrays["contact_force"], axis=1)
    return np.asarray(sizes[late(run, 1.0)])


def trials() -> list[Trial]:
    def tension(run: Recording) -> float:
        found = np.asarray(run.arrays["tendon_tension"])[late(run, 1.0)]
        return float(np.ptp(found, axis=0).max())

    def creep(run: Recording) -> float:
        """Distance that any body's frame moves in the last second [m]."""
        at = run.arrays["body_pose"][late(run, 1.0)][..., :2]
        return float(np.linalg.norm(at[-1] - at[0], axis=-1).max())

    return [Trial(
        "square", "a free square held by four fingers, in the fourth second", square,
        (Measure("noise of contacts", "N", lambda run: float(np.ptp(_pairs(run), axis=0).max())),
         Measure("noise of tensions", "N", tension), Measure("creep", "m", creep)),
        tuple(target for step in (2e-3, 5e-4) for target in (
            AtMost("noise of contacts", step, 1e-8, "every single force is constant at rest"),
            AtMost("noise of tensions", step, 1e-8, "as above"),
            AtMost("creep", step, 1e-8, "friction holds; damping closes less"))))]
