"""Figure 22: one hand and one pull, with equal springs and with some lowered and raised.

A free finger rests where T h_i(theta_i) = k_i s_i(theta_i) at each joint, with T = F / 4. Each
joint has its own equation, so a spring changes the rotation of its own joint only.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from common import HINGES, ClosedForm, arguments, stills
from scipy.optimize import brentq

import sandbox

SCENES = {"stiffness_uniform": "Equal springs", "stiffness_varied": "Some springs varied"}
FINGERS = ("finger1", "finger2", "finger3", "finger4")


def rest(form: ClosedForm, tension: float) -> np.ndarray:
    """Rotations at which a free finger rests [rad], shape [3]."""
    def torque(angle: float, joint: int) -> float:
        return float(form.torques(np.full(3, angle), np.array(tension))[joint])

    return np.array([brentq(torque, 1e-6, form.limits[joint, 1], args=(joint,), xtol=1e-14)
                     for joint in range(3)])


def main(argv: Sequence[str] | None = None) -> dict[str, float]:
    """Run the study; its numbers by name."""
    options = arguments(__doc__, argv)
    scenes = [sandbox.load_scene(name) for name in SCENES]
    runs = [sandbox.simulate(scene) for scene in scenes]
    parts = [{part.name: part for part in scene.parts} for scene in scenes]
    print("finger  joint  k equal, varied [N/m]  rotation equal, varied [deg]  off [1e-3 deg]")
    errors, change = [], []
    for finger in FINGERS:
        forms = [ClosedForm(each[finger]) for each in parts]
        closed = [np.degrees(rest(form, scene.parameters["pull"] / len(FINGERS)))
                  for form, scene in zip(forms, scenes, strict=True)]
        for joint, hinge in enumerate(HINGES):
            found = [float(np.degrees(run[f"{finger}.{hinge}.angle"][-1])) for run in runs]
            off = [1e3 * (a - b[joint]) for a, b in zip(found, closed, strict=True)]
            errors += off
            change.append(found[1] - found[0])
            print(f"{finger} {hinge:5} {forms[0].stiffness[joint]:10.0f} "
                  f"{forms[1].stiffness[joint]:6.0f} {found[0]:16.3f} {found[1]:8.3f} "
                  f"{off[0]:16.2f} {off[1]:6.2f}")
    largest = max(change, key=abs)
    print(f"largest change {largest:+.1f} deg (page: +40.7); largest difference from the closed "
          f"form {max(map(abs, errors)) / 1e3:.4f} deg (page: 0.0017)")
    stills(options.out / "hand_stiffness.png", runs, list(SCENES.values()), 2, (520, 560))
    return {"largest change": largest, "largest error": max(map(abs, errors)) / 1e3}


if __name__ == "__main__":
    main()
