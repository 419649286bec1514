"""What is drawn anew for each episode, by the lists and distributions that sweeps know."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from sandbox.errors import Problem, SceneError
from sandbox.scene.read.limits import Limits
from sandbox.sweeps.job import Override
from sandbox.sweeps.plan import plan_of
from sandbox.sweeps.points import make_points
from sandbox.sweeps.spec import SweepSpec
from sandbox.sweeps.sweep import study_data

TRIED = 64
"""Draws that are made before anything runs; the least and largest of each path have to be right."""


@dataclass(frozen=True)
class Draws:
    """Values of paths, by chance."""

    spec: SweepSpec

    def drawn(self, seed: int) -> dict[str, Override]:
        """Values by path; of the same seed the same."""
        return make_points(self.spec.model_copy(update={"seed": seed}))[0]


def read_draws(
    scene: str | os.PathLike[str] | Mapping[str, Any], randomise: object, set: Mapping[str, Any],
    limits: Limits,
) -> Draws:
    """Look over what shall be drawn, and try the scene with it.

    Raises:
        SceneError: paths that the scene does not have, values that it cannot have, no distribution.
    """
    if not isinstance(randomise, Mapping):
        raise SceneError([Problem("bad-argument",
                                  f"{randomise!r} does not say what is drawn", "randomise",
                                  allowed='values by path: {"parameters.m": "normal(1 kg, 0.1 kg)"}'
                                  )])
    try:
        plan = plan_of(study_data(
            scene, vary=[{"over": dict(randomise), "design": "random", "count": TRIED}],
            set=set, keep={"t": "=0"}), limits)
    except SceneError as error:
        raise SceneError([replace(each, path=_here(each.path)) for each in error.problems],
                         error.source) from None
    group = plan.spec.vary[0].model_copy(update={"count": 1})
    return Draws(plan.spec.model_copy(update={"vary": (group,)}))


def _here(path: str) -> str:
    """Where in ``randomise`` stands what a sweep has at a path."""
    for begin in ("$.vary[0].over", "$.vary[0]", "$.vary"):
        if path.startswith(begin):
            return f"randomise{path.removeprefix(begin)}"
    return "randomise" if path == "$" else path
