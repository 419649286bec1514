"""The finger of Set A as a scene, with springs, an antagonist or locks, run until it rests."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sandbox.engine.simulate import simulate
from sandbox.numeric import Array
from sandbox.paper.finger_plant import HINGES
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene
from sandbox.study.reference_fingers import SET_A

LINKS = ("palm", "proximal", "middle", "distal")
RAMP, REST = 1.0, 2.0
"""Pulls rise over the first and are held for the second [s]. What is left of a motion dies out
with damping / stiffness of the joint: 10 ms as a rule, 0.3 s for the end joint that an
antagonist holds next to where it would run away."""
LOOSE = -1.0
"""An angle at which a lock is closed from the start."""
EYES = 0.6
"""Height of the antagonist's eyes over that of the lower wheel beside them: below 1, so that
the cord lies on its wheels at all angles."""


def finger_scene(
    pull: float, *, stiffness: ArrayLike | None = None,
    antagonist: tuple[float, ArrayLike] | None = None,
    locks: tuple[float, ArrayLike] | None = None,
) -> dict[str, Any]:
    """A scene whose pulls rise slowly on the straight finger, and stay.

    Args:
        pull: T [N].
        stiffness: k_i [N/m], shape [3]; by default that of Set A.
        antagonist: T_a [N] and its arms r_i [m], shape [3].
        locks: holding torque [N m] and the angles at which they close [rad], shape [3].
    """
    k = SET_A.stiffness if stiffness is None else np.asarray(stiffness, dtype=float).tolist()
    scene: dict[str, Any] = {
        "run": {"duration": RAMP + REST, "step": 2e-4, "sample_rate": 500},
        "parts": [{
            "type": "finger", "name": "finger", "lengths": SET_A.lengths, "radii": SET_A.radii,
            "masses": SET_A.masses, "guides": SET_A.guides, "damping": SET_A.damping,
            "limits": SET_A.limits,
            "springs": {"stiffness": k, "from": SET_A.before, "to": SET_A.after},
        }],
        "drives": [{"type": "pull", "name": "pull", "tendon": "finger",
                    "value": {"ramp": {"to": pull, "over": RAMP}}}],
    }
    if antagonist is not None:
        tension, arms = antagonist
        scene["tendons"] = [antagonist_tendon(arms)]
        scene["drives"].append({"type": "pull", "name": "antagonist_pull",
                                "tendon": "finger.antagonist",
                                "value": {"ramp": {"to": tension, "over": RAMP}}})
    if locks is not None:
        holding, angles = locks
        _add_locks(scene, holding, np.asarray(angles, dtype=float))
    return scene


def antagonist_tendon(arms: ArrayLike) -> dict[str, Any]:
    """The cord over the back: an eye on each phalanx, a wheel of radius r_i on each hinge.

    The eyes stand where the flexor's guides do along the phalanges, and low enough
    that the cord lies on each wheel at all angles: its arm is then the radius.
    """
    radii = np.asarray(arms, dtype=float)
    lower = [radii[0], *np.minimum(radii[:-1], radii[1:]), radii[-1]]
    guides: list[dict[str, Any]] = []
    for i, ((x, _), height) in enumerate(zip(SET_A.guides, lower, strict=True)):
        if i:
            guides.append({"body": f"finger.{LINKS[i]}", "radius": radii[i - 1], "side": "left"})
        guides.append({"body": f"finger.{LINKS[i]}", "at": [x, EYES * height]})
    # from the tip to the palm, where it is pulled: the wheels then lie to its left
    return {"name": "finger.antagonist", "guides": guides[::-1]}


def settle(scene: dict[str, Any]) -> Array:
    """Runs a scene and gives the angles at its end [rad], shape [3]."""
    recording = simulate(expand(load_scene(scene)))
    return np.array([recording[f"finger.{hinge}.angle"][-1] for hinge in HINGES])


def _add_locks(scene: dict[str, Any], holding: float, angles: Array) -> None:
    scene["events"] = []
    for hinge, angle in zip(HINGES, angles, strict=True):
        closed = angle < 0
        scene["drives"].append({"type": "brake", "name": f"{hinge}_lock",
                                "joint": f"finger.{hinge}", "value": holding if closed else 0})
        if not closed:
            scene["events"].append({
                "name": f"lock_{hinge}", "when": f"=finger.{hinge}.angle >= {float(angle)!r}",
                "rate": 5000, "set": {f"{hinge}_lock": holding}})
