"""The three proposals of the paper's conclusion, side by side at one pull.

Springs of controlled stiffness, an antagonist tendon, joint locks: which poses
each reaches with the finger of section 5 (Set A), which of them hold the
paper's 5/10/15 deg, and at which pulls. The maps come from the closed forms of
:mod:`sandbox.paper.reach`; simulations confirm corners, points inside and
points just outside.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.draw.figure import style
from sandbox.draw.figure.maps import Bar, MapRow, Plane, Region, save_bars, save_maps
from sandbox.numeric import Array
from sandbox.paper.finger_plant import HINGES, TARGET
from sandbox.paper.reach import PoseBox, PoseCurve, Reach, common, reach_of
from sandbox.paper.reach_runs import LOOSE, finger_scene, settle
from sandbox.study.reference_fingers import SET_A

PULLS = (5.0, 10.0, 15.0)
"""[N]"""
FACTOR = 3.0
"""Largest stiffness over the smallest, of magnetorheological elastomers at their best."""
HOLDING, WEAKER = 0.08, 0.05
"""Of a lock [N m]: two faces of a small disc brake at 6 mm, friction 0.3, pressed with 22 N
(14 N): 2 * 0.3 * 22 N * 6 mm."""
ARMS: Array = np.full(3, 5e-3)
"""Of the antagonist [m]: wheels on the hinges as far above them as the guides are below."""
MADE_PULL, MADE_TENSION = 14.0, 10.0
"""[N]: an antagonist whose wheels are made to hold the target with these tensions."""
STIFFNESS, ANTAGONIST, LOCKS = "stiffness k0 to 3 k0", "antagonist", "joint locks"
COLOURS = {STIFFNESS: style.BLUE, ANTAGONIST: style.ORANGE, LOCKS: style.GREEN}
SHOWN = ((7.0, "θ1, knuckle (mcp) [deg]"), (66.0, "θ2, middle joint (pip) [deg]"),
         (80.0, "θ3, end joint (dip) [deg]"))
"""Of each joint: highest angle shown [deg], label."""


@dataclass(frozen=True)
class AtPull:
    """What is reached at one pull."""

    pull: float
    stiffness: PoseBox
    locks: PoseBox
    weaker: PoseBox
    """With locks of the weaker holding torque."""
    antagonist: PoseCurve

    def sets(self) -> dict[str, PoseBox | PoseCurve]:
        """By name."""
        return {STIFFNESS: self.stiffness, ANTAGONIST: self.antagonist, LOCKS: self.locks}


def at_pull(reach: Reach, pull: float, points: int = 601) -> AtPull:
    """All sets at a pull [N]; ``points`` antagonist tensions from 0 to where all is straight."""
    straight = float((pull * reach.arm[:, 0] / ARMS).max())
    return AtPull(pull, reach.stiffness_box(pull, FACTOR), reach.lock_box(pull, HOLDING),
                  reach.lock_box(pull, WEAKER),
                  reach.antagonist_curve(pull, ARMS, np.linspace(0, straight, points)))


def miss(reached: PoseBox | PoseCurve, pose: Array = TARGET) -> float:
    """From ``pose`` to the nearest reachable one, over all joints together [rad]."""
    return float(np.linalg.norm(reached.nearest(pose) - pose))


def run(directory: Path, *, progress: Callable[[float], None] | None = None) -> str:
    """Maps, pull ranges and their confirmation by simulation, into ``directory``.

    Raises:
        OutputError: a file cannot be written.
    """
    reach = reach_of(SET_A)
    sets = [at_pull(reach, pull) for pull in PULLS]
    for ending in ("png", "svg", "pdf"):
        save_maps(directory / f"proposals_maps.{ending}", [_row(each) for each in sets])
        _save_pulls(directory / f"proposals_pulls.{ending}", reach)
    checks = confirmations(reach, progress)
    summary = {
        "target_rad": TARGET.tolist(), "fold_rad": reach.fold.tolist(),
        "at_pull": [_numbers(each) for each in sets], "pulls_N": _pulls(reach),
        "simulated": checks,
    }
    write_atomic(directory / "proposals.json", json.dumps(summary, indent=1) + "\n")
    return "\n".join([*(_line(each) for each in sets), _pull_line(reach), _check_line(checks)])


# --- numbers


def _numbers(each: AtPull) -> dict[str, Any]:
    found: dict[str, Any] = {"pull_N": each.pull}
    for name, reached in each.sets().items():
        entry: dict[str, Any] = {"nearest_rad": reached.nearest(TARGET).tolist(),
                                 "miss_rad": miss(reached)}
        if isinstance(reached, PoseBox):
            entry |= {"joints_rad": reached.joints, "volume_rad3": reached.volume}
        found[name] = entry
    return found


def _pulls(reach: Reach) -> dict[str, Any]:
    ranges = {STIFFNESS: reach.stiffness_pulls(TARGET, FACTOR),
              "antagonist with wheels made for the pose": reach.antagonist_pulls(TARGET),
              f"{LOCKS}, {HOLDING} N m": reach.lock_pulls(TARGET, HOLDING),
              f"{LOCKS}, {WEAKER} N m": reach.lock_pulls(TARGET, WEAKER)}
    return {name: {"joints": rows.tolist(), "all": common(rows)} for name, rows in ranges.items()}


def _line(each: AtPull) -> str:
    parts = [f"{name}: {_verdict(reached)}" for name, reached in each.sets().items()]
    return f"{each.pull:g} N: " + "; ".join(parts)


def _verdict(reached: PoseBox | PoseCurve) -> str:
    off = float(np.degrees(miss(reached)))
    return "reaches the target" if off < 0.05 else f"misses it by {off:.1f}°"


def _pull_line(reach: Reach) -> str:
    shared = {name: entry["all"] for name, entry in _pulls(reach).items()}
    return "pulls that hold the target: " + "; ".join(
        f"{name}: " + (f"{both[0]:.2f} to {both[1]:.2f} N" if both else "none")
        for name, both in shared.items())


def _check_line(checks: list[dict[str, Any]]) -> str:
    worst = max(float(check["off_rad"]) for check in checks)
    return (f"{len(checks)} poses simulated, the farthest {np.degrees(worst):.3f}° "
            "from the closed form")


# --- pictures


def _row(each: AtPull) -> MapRow:
    verdicts = [(f"{name}: {_verdict(reached)}", COLOURS[name])
                for name, reached in each.sets().items()]
    return MapRow(f"pull {each.pull:g} N", verdicts,
               [_plane(each, 0, 1), _plane(each, 1, 2)])


def _plane(each: AtPull, i: int, j: int) -> Plane:
    (width, x), (height, y) = SHOWN[i], SHOWN[j]
    locks, weaker = f"{LOCKS}, {HOLDING:g} N m", f"{LOCKS}, {WEAKER:g} N m"
    regions = (
        Region(locks, COLOURS[LOCKS], _rectangles(each.locks, i, j)),
        Region(weaker, COLOURS[LOCKS], _rectangles(each.weaker, i, j), outline=True),
        Region(STIFFNESS, COLOURS[STIFFNESS], _rectangles(each.stiffness, i, j)),
        _trace(ANTAGONIST, each.antagonist, i, j),
    )
    target, stops = np.degrees(TARGET), np.degrees(SET_A.limits)
    return Plane(x, y, width, height, regions, (float(target[i]), float(target[j])),
                 stops=(float(stops[i]), float(stops[j])))


def _rectangles(box: PoseBox, i: int, j: int) -> list[tuple[float, float, float, float]]:
    return [(*np.degrees(across), *np.degrees(up)) for across in box.joints[i]
            for up in box.joints[j]]


def _trace(name: str, curve: PoseCurve, i: int, j: int) -> Region:
    """The curve in a plane, broken where a joint springs to its stop."""
    poses = np.degrees(curve.poses)
    jumps = np.flatnonzero(np.abs(np.diff(poses, axis=0)).max(axis=1) > 2.0)
    broken = np.insert(poses, jumps + 1, np.nan, axis=0)
    return Region(name, COLOURS[name], x=broken[:, i], y=broken[:, j])


def _save_pulls(path: Path, reach: Reach) -> None:
    bars, notes = [], []
    for name, colour, rows in (
        (f"stiffness, k0 to {FACTOR:g} k0", COLOURS[STIFFNESS],
         reach.stiffness_pulls(TARGET, FACTOR)),
        ("antagonist with wheels made for this pose", COLOURS[ANTAGONIST],
         reach.antagonist_pulls(TARGET)),
        (f"locks of {HOLDING:g} N m", COLOURS[LOCKS], reach.lock_pulls(TARGET, HOLDING)),
        (f"locks of {WEAKER:g} N m", style.PALE_GREEN, reach.lock_pulls(TARGET, WEAKER)),
    ):
        both = common(rows)
        note = (f"all three joints from {both[0]:.1f} to {both[1]:.1f} N" if both
                else "no pull holds all three joints")
        notes.append((COLOURS[LOCKS] if colour == style.PALE_GREEN else colour, note))
        bars += [Bar(name, f"{hinge}, {angle:.0f}°", colour, *map(float, row))
                 for hinge, angle, row in zip(HINGES, np.degrees(TARGET), rows, strict=True)]
    save_bars(path, bars, title="Pulls at which each joint can be held at the paper's angle",
              x="pull of the tendon [N]", right=45.0, marks=PULLS, notes=notes)


# --- simulations


def confirmations(
    reach: Reach, progress: Callable[[float], None] | None = None,
) -> list[dict[str, Any]]:
    """Poses of the maps simulated: expected and found angles [rad] of each."""
    cases = [*_stiffness_cases(reach), *_antagonist_cases(reach), *_lock_cases(reach)]
    found = []
    for at, (name, where, expected, scene) in enumerate(cases):
        pose = settle(scene)
        found.append({"set": name, "where": where, "expected_rad": expected.tolist(),
                      "simulated_rad": pose.tolist(),
                      "off_rad": float(np.abs(pose - expected).max())})
        if progress is not None:
            progress((at + 1) / len(cases))
    return found


Case = tuple[str, str, Array, dict[str, Any]]


def _stiffness_cases(reach: Reach, pull: float = 10.0) -> list[Case]:
    k0 = reach.stiffness
    inside = reach.needed_stiffness(pull, np.radians([2.0, 10.0, 15.0]))
    past = reach.needed_stiffness(pull, reach.fold + np.radians([0.0, 0.0, 1.0]))
    cases = {
        "corner: all 3 k0": FACTOR * k0,
        "corner: all k0": k0,
        "corner: k0, 3 k0, k0": k0 * [1, FACTOR, 1],
        "inside: 2/10/15 deg": inside,
        "outside: k of 1 deg beyond the end joint's fold": np.array([*inside[:2], past[2]]),
        "outside: 4/10/15 deg takes less than k0": np.clip(
            reach.needed_stiffness(pull, np.radians([4.0, 10.0, 15.0])), k0, FACTOR * k0),
    }
    return [(STIFFNESS, f"{pull:g} N, {where}", reach.free(pull, k),
             finger_scene(pull, stiffness=k)) for where, k in cases.items()]


def _antagonist_cases(reach: Reach, pull: float = 10.0) -> list[Case]:
    cases: list[Case] = [
        (ANTAGONIST, f"{pull:g} N, antagonist {tension:g} N",
         reach.with_antagonist(pull, tension, ARMS),
         finger_scene(pull, antagonist=(tension, ARMS))) for tension in (4.0, 8.0, 9.5, 11.0)]
    made = reach.antagonist_arms(MADE_PULL, MADE_TENSION, TARGET)
    cases.append((ANTAGONIST, f"{MADE_PULL:g} N, antagonist {MADE_TENSION:g} N on wheels made for "
                  "it: the target", TARGET,
                  finger_scene(MADE_PULL, antagonist=(MADE_TENSION, made))))
    return cases


def _lock_cases(reach: Reach, pull: float = 15.0) -> list[Case]:
    beyond = float(np.degrees(reach.free(pull)[0])) + 0.2
    cases = {
        "inside: the target": (HOLDING, (5.0, 10.0, 15.0)),
        "corner: locked straight": (HOLDING, (LOOSE, LOOSE, LOOSE)),
        "inside: 2/30/30 deg": (HOLDING, (2.0, 30.0, 30.0)),
        "outside: knuckle never gets there": (HOLDING, (beyond, 10.0, 15.0)),
        "outside: end joint at 38 deg slips": (HOLDING, (5.0, 10.0, 38.0)),
        "outside: weaker locks at 1/5/15 deg slip": (WEAKER, (1.0, 5.0, 15.0)),
    }
    return [(LOCKS, f"{pull:g} N, {where}",
             reach.locked(pull, holding, np.radians(np.maximum(asked, 0.0))),
             finger_scene(pull, locks=(holding, np.radians(asked))))
            for where, (holding, asked) in cases.items()]
