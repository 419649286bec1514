"""Pull and stiffness together: the line of those that hold one pose.

Three rotations do not decide four inputs: with any pull between T_min and T_max
the stiffnesses k_i = (T h_i + w_i) / (dlm_i hm_i) hold 5/10/15 deg. Shortening,
which the paper's dual control adds, is a function of the rotations and decides
nothing more; so where that control ends depends on its way there. Points of the
line are confirmed by runs with constant pull and stiffness.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.comma import comma_separated
from sandbox.draw.figure.panels import Curve, Panel, save_panels
from sandbox.engine.simulate import simulate
from sandbox.numeric import Array
from sandbox.paper.finger_plant import HINGES, NAMES, SOFTEST, STIFFEST, TARGET, Plant
from sandbox.paper.reach_runs import finger_scene, settle
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.load import load_scene

PICTURE, NUMBERS = "redundancy.png", "redundancy.csv"
CONFIRMED = 6
"""Points of the line that are simulated, both ends among them."""
DUAL = "finger_dual_control"


@dataclass(frozen=True)
class HeldPose:
    """A pull, the stiffnesses that go with it, and the pose that a run came to."""

    pull: float
    """[N]"""
    stiffness: Array
    """[N/m], shape [3]."""
    angles: Array
    """[rad], shape [3]."""


def line(pulls: Array) -> Array:
    """The stiffnesses [N/m] that hold the pose at pulls [N], shapes [m, 3] and [m]."""
    return Plant().stiffness(pulls, np.broadcast_to(TARGET, (len(pulls), 3)))


def dual_end() -> HeldPose:
    """Where the paper's dual control ends."""
    run = simulate(load_scene(shipped_scenes()[DUAL]))
    return HeldPose(float(run["pull.value"][-1]),
                 np.array([run[f"k{i}.value"][-1] for i in (1, 2, 3)]),
                 np.array([run[f"finger.{hinge}.angle"][-1] for hinge in HINGES]))


def run(directory: Path, *, progress: Callable[[float], None] | None = None) -> str:
    """Picture and table into ``directory``.

    Raises:
        OutputError: a file cannot be written.
    """
    least, most = Plant().pull_range(TARGET)
    points = []
    for i, pull in enumerate(np.linspace(least, most, CONFIRMED)):
        stiffness = line(np.array([pull]))[0]
        points.append(HeldPose(float(pull), stiffness,
                            settle(finger_scene(float(pull), stiffness=stiffness))))
        if progress is not None:
            progress((i + 1) / (CONFIRMED + 1))
    end = dual_end()
    write_atomic(directory / NUMBERS, _table([*points, end]))
    save_panels(directory / PICTURE, [_panel(points, end, least, most)])
    off = max(float(np.abs(point.angles - TARGET).max()) for point in points)
    aside_of_line = float(np.abs(end.stiffness / line(np.array([end.pull]))[0] - 1).max())
    return (f"5/10/15 deg is held from {least:.3f} N (knuckle's spring at {SOFTEST:g} k0) to "
            f"{most:.3f} N (end joint's at {STIFFEST:g} k0)\n"
            f"{CONFIRMED} points simulated with constant inputs: {np.degrees(off):.5f} deg off "
            f"at most\nthe paper's dual control ends at {end.pull:.2f} N, "
            f"{100 * aside_of_line:.2f} % off the line")


def _table(points: list[HeldPose]) -> str:
    return comma_separated(
        ["pull_N", "k1_N/m", "k2_N/m", "k3_N/m", "mcp_rad", "pip_rad", "dip_rad"],
        ((point.pull, *point.stiffness, *point.angles) for point in points), digits=6)


def _panel(points: list[HeldPose], end: HeldPose, least: float, most: float) -> Panel:
    k0 = np.asarray(Plant().finger.stiffness)
    pulls = np.linspace(least, most, 101)
    ratios = line(pulls) / k0
    ends = np.array([0.9 * least, 1.1 * most])
    curves = [Curve(f"{name}, closed form", pulls, ratios[:, i]) for i, name in enumerate(NAMES)]
    curves += [Curve(f"{name}, simulated", np.array([p.pull for p in points]),
                     np.array([p.stiffness[i] / k0[i] for p in points]), "points")
               for i, name in enumerate(NAMES)]
    curves.append(Curve("end of the paper's dual control", np.full(3, end.pull),
                        end.stiffness / k0, "joined"))
    # one curve of two strokes
    curves.append(Curve("limits of the stiffness", np.array([*ends, np.nan, *ends]),
                        np.array([STIFFEST, STIFFEST, np.nan, SOFTEST, SOFTEST]), "dashed"))
    return Panel("Pulls and stiffnesses that hold 5/10/15 deg", "pull [N]",
                 "stiffness [shares of Table 2's]", curves)
