"""Fairer comparisons: the paper's laws with other gains, or with what the better ones are given.

Each variant changes a controller of :mod:`sandbox.paper.finger_trials` in one respect,
so that one sees how much each does: the gains, the pull, a reference that rises.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from sandbox.paper.finger_plant import HINGES
from sandbox.paper.finger_trials import GENTLE, NOMINAL, Mismatch, TrialController, retune

STIFFNESS, WEAKER, DUAL = "finger_stiffness_15N", "finger_stiffness_10N", "finger_dual_control"
"""Scenes of the paper's controllers."""


def _gains_only(scene: dict[str, Any], pull: float) -> None:
    """The retuned proportional and integral gains: no derivative, and a target that jumps."""
    retune(scene)
    scene["parameters"]["pull"] = pull
    for loop, hinge in zip(scene["controllers"], HINGES, strict=True):
        loop.update(kd=0.0, target=f"={hinge}")


def _without(scene: dict[str, Any], gain: str) -> None:
    """The dual control without one part of the pull's loop."""
    scene["controllers"][0][gain] = 0.0


def _retuned_dual(scene: dict[str, Any]) -> None:
    """The dual control: the loops on the stiffness retuned, that on the pull as it is."""
    retune({"parameters": {}, "controllers": scene["controllers"][1:]})


def _slower(scene: dict[str, Any]) -> None:
    """Retuned, with a reference that rises as slowly as the pull does."""
    retune(scene)
    for loop in scene["controllers"]:
        loop["target"]["ramp"]["over"] = GENTLE


def _of(name: str, scene: str, duration: float,
        change: Callable[[dict[str, Any]], None] | None = None,
        *, slow: bool = False) -> tuple[TrialController, Mismatch]:
    return TrialController(name, scene, duration, change), Mismatch(slow=True) if slow else NOMINAL


VARIANTS = (
    _of("gains only, 15 N", STIFFNESS, 1.0, partial(_gains_only, pull=15.0)),
    _of("gains only, 14 N", STIFFNESS, 1.0, partial(_gains_only, pull=14.0)),
    _of("dual, Tp = 0", DUAL, 5.0, partial(_without, gain="kp")),
    _of("dual, Ti = 0", DUAL, 5.0, partial(_without, gain="ki")),
    _of("dual, loops retuned", DUAL, 5.0, _retuned_dual),
    _of("15 N, slow springs, pull rises", STIFFNESS, 4.0, slow=True),
    _of("10 N, slow springs, pull rises", WEAKER, 4.0, slow=True),
    _of("PID retuned, slow springs, slower reference", STIFFNESS, 1.0, _slower, slow=True),
)
"""Who is tried, and in which case. With slow springs the pull of all of them rises."""
