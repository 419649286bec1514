"""The figure of a finger under control: shortening, rotations, stiffness, pull over time.

Panels A to D are those of the paper's Figures 18 to 21. Nothing is found by name: the
tendon is one whose shortening or whose hinges have a target, or else one that is
pulled, and of two that pull against each other the one that got shorter; the
joints are the hinges between bodies that it passes; the springs are those across
these hinges.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from string import ascii_uppercase
from typing import Any

import numpy as np

from sandbox.draw import paper
from sandbox.draw.paper import Array, Beside, Shown
from sandbox.draw.plots import COLOURS
from sandbox.errors import OutputError
from sandbox.recording.goals import targets, track
from sandbox.recording.recording import Recording
from sandbox.recording.response import BAND, Response, band_of, respond
from sandbox.scene.drives import PullDrive, StiffnessDrive
from sandbox.scene.joints import Pin
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.springs import LinearSpring, Spring
from sandbox.scene.tendons import Tendon

ROW, REST, AXES = 50.0, 16.0, 36.0
"""Height of a row of panels, of title and footnote together, of a panel's axes [mm]."""
PLAIN_HUE, PULL_HUE = COLOURS[5], COLOURS[3]
"""Of the tendon's shortening and of its pull."""
HUES = tuple(hue for hue in COLOURS if hue not in (PLAIN_HUE, PULL_HUE))
"""Of the joints: a joint's rotation and its spring have the same one."""
DECADES = 8.0
"""Stiffnesses that differ by more than this factor are shown on a logarithmic axis."""
THICK = 1.5


@dataclass(frozen=True)
class Roles:
    """Which elements of a mechanism are the finger."""

    tendon: Tendon
    joints: tuple[Pin, ...]
    pull: str
    """The drive that pulls the tendon; empty where none does."""


@dataclass(frozen=True)
class Stiffness:
    """A spring's stiffness over time."""

    label: str
    """The drive that sets it; the joint where none does."""
    joint: int
    """Which of the finger's."""
    unit: str
    time: Array
    """[s], shape [n]."""
    value: Array
    """Shape [n]."""


def draw(run: Recording, given: Mapping[str, float]) -> tuple[Any, dict[str, Response]]:
    """The figure, and the response of each quantity with a target.

    Args:
        run: of a finger: a tendon along hinges.
        given: targets by hand, quantity to value, SI.

    Raises:
        OutputError: the recording has no tendon along hinges, or too few samples.
    """
    goals = targets(run, given)
    roles = roles_of(run, goals)
    if len(run) < 2:
        raise OutputError(f"the recording has {len(run)} samples, a figure needs at least 2")
    used = 3 + len(roles.joints)
    rows = math.ceil(used / 2)
    figure = paper.new_figure(ROW * rows + REST)
    grid = list(figure.subplots(rows, 2, sharex=True, squeeze=False).ravel())
    found: dict[str, Response] = {}
    for axes, letter, (name, head, y, hue) in zip(
            grid, ascii_uppercase, _followed(roles), strict=False):
        if answer := _response(axes, run, name, goals.get(name), y=y, hue=hue):
            found[name] = answer
        paper.dress(axes, head, axes.get_ylabel(), letter=letter)
    _stiffness(grid[used - 2], run, roles, ascii_uppercase[(used - 2) % 26])
    _pull(grid[used - 1], run, roles, ascii_uppercase[(used - 1) % 26])
    paper.over_time(grid, used, 2, run)
    paper.title(figure, run.mechanism.title or run.mechanism.name)
    if found:
        paper.footnote(figure, f"Shaded: ±{100 * BAND:g} % of the target. Dotted: the last time "
                       "outside of it. Numbers at the right: targets and final values.")
    return figure, found


def _followed(roles: Roles) -> list[tuple[str, str, str, str]]:
    """Quantity, title, axis and colour of the first panels."""
    return [
        (f"{roles.tendon.name}.shortening", "Tendon shortening", "shortening", PLAIN_HUE),
        *((f"{joint.name}.angle", f"Rotation of {_short(joint.name)}", "rotation",
           HUES[i % len(HUES)]) for i, joint in enumerate(roles.joints)),
    ]


def roles_of(run: Recording, goals: Mapping[str, Any]) -> Roles:
    """Which tendon, which hinges, which pull; ``goals`` has the quantities with targets as keys.

    Raises:
        OutputError: there is no tendon along hinges.
    """
    mechanism = run.mechanism
    pulls = {d.tendon: d.name for d in mechanism.drives if isinstance(d, PullDrive)}
    fingers = [Roles(tendon, joints, pulls.get(tendon.name, "")) for tendon in mechanism.tendons
               if (joints := _along(mechanism, tendon))]
    if not fingers:
        raise OutputError("the figure 'finger-control' needs a tendon that passes hinges; "
                          "this recording has none")

    def rank(finger: Roles) -> tuple[bool, ...]:
        shortening = f"{finger.tendon.name}.shortening"
        return (shortening not in goals,
                not any(f"{joint.name}.angle" in goals for joint in finger.joints),
                not finger.pull, bool(np.any(run[shortening][-1:] < 0)))

    return min(fingers, key=rank)


def _along(mechanism: Mechanism, tendon: Tendon) -> tuple[Pin, ...]:
    """The hinges between neighbouring bodies of a tendon's path, in the mechanism's order."""
    pairs = {frozenset((a.body, b.body)) for a, b in pairwise(tendon.guides)}
    return tuple(joint for joint in mechanism.joints
                 if isinstance(joint, Pin) and frozenset((joint.a, joint.b)) in pairs)


def stiffnesses(run: Recording, joints: Sequence[Pin]) -> list[Stiffness]:
    """The stiffness of every spring across some hinges over time, in the hinges' order."""
    drives = {d.spring: d.name for d in run.mechanism.drives if isinstance(d, StiffnessDrive)}
    found = []
    for i, joint in enumerate(joints):
        for spring in run.mechanism.springs:
            if not _across(spring, joint):
                continue
            drive = drives.get(spring.name)
            time, value = run.time, np.full(len(run), spring.stiffness)
            if drive:
                time, value, _ = track(run, f"{drive}.value")
            found.append(Stiffness(
                drive or _short(joint.name), i,
                "N/m" if isinstance(spring, LinearSpring) else "N m/rad", time, value))
    return found


def _across(spring: Spring, joint: Pin) -> bool:
    if isinstance(spring, LinearSpring):
        return {spring.a, spring.b} == {joint.a, joint.b}
    return spring.joint == joint.name


def _response(
    axes: Any, run: Recording, name: str, target: Array | None, *, y: str, hue: str,
) -> Response | None:
    """A quantity with its target, its band and when it has settled."""
    time, value, goals = track(run, name, target)
    rows = [value] if goals is None else [value, goals]
    shown = paper.shown_as(run.unit(name), *rows)
    axes.set_ylabel(f"{y} [{shown.unit}]")
    axes.plot(time, shown.factor * value, color=hue, linewidth=THICK, zorder=3)
    paper.roomy(axes, *(shown.factor * row for row in rows))
    last = shown.factor * float(value[-1])
    final = Beside(last, f"{paper.number(last)}{shown.sign}", hue)
    if goals is None:
        paper.put_beside(axes, [final], height=AXES)
        return None
    found = respond(time, value, goals)
    _target(axes, time, goals, shown, band=band_of(value, goals))
    goal = shown.factor * found.target
    beside = Beside(goal, f"target {paper.number(goal)}{'°' if shown.sign == '°' else ''}")
    paper.put_beside(axes, [beside] if found.settles else [beside, final], height=AXES)
    _settling(axes, found)
    return found


def _target(axes: Any, time: Array, target: Array, shown: Shown, *, band: float) -> None:
    # of what stands still two points are enough, and a file of curves stays small
    some = slice(None, None, len(time) - 1 if np.ptp(target) == 0 else 1)
    time, target = time[some], target[some]
    axes.fill_between(time, shown.factor * (target - band), shown.factor * (target + band),
                      color=paper.BAND, linewidth=0, zorder=1)
    axes.plot(time, shown.factor * target, color=paper.INK, linewidth=0.9,
              linestyle=(0, (4, 3)), zorder=2)


def _settling(axes: Any, found: Response) -> None:
    if not found.settles:
        paper.remark(axes, "does not settle", paper.BAD)
        return
    paper.remark(axes, f"settled at {paper.seconds(found.settling)}", paper.GOOD)
    axes.axvline(found.settling, color=paper.GOOD, linewidth=1.1, linestyle=(0, (1.2, 1.6)),
                 zorder=2)


def _stiffness(axes: Any, run: Recording, roles: Roles, letter: str) -> None:
    """All stiffnesses in one panel, each in its joint's colour."""
    rows = stiffnesses(run, roles.joints)
    paper.dress(axes, "Spring stiffness", f"stiffness [{rows[0].unit}]" if rows else "",
                letter=letter)
    if not rows:
        paper.remark(axes, "no springs", paper.QUIET)
        return
    every = np.concatenate([row.value for row in rows])
    if every.min() > 0 and every.max() > DECADES * every.min():
        axes.set_yscale("log")
        axes.set_ylim(every.min() / 1.35, every.max() * 1.35)
    else:
        paper.roomy(axes, every)
    beside = []
    for row in rows:
        hue = HUES[row.joint % len(HUES)]
        axes.plot(row.time, row.value, color=hue, linewidth=THICK)
        last = float(row.value[-1])
        beside.append(Beside(last, f"{row.label}  {paper.number(last)}", hue))
    paper.put_beside(axes, beside, height=AXES)
    if not any(np.ptp(row.value) for row in rows):
        paper.remark(axes, "constant", paper.QUIET)


def _pull(axes: Any, run: Recording, roles: Roles, letter: str) -> None:
    """What pulls the tendon: a drive, or whatever makes its tension."""
    time, value, _ = track(
        run, f"{roles.pull}.value" if roles.pull else f"{roles.tendon.name}.tension")
    paper.dress(axes, "Tendon pull" if roles.pull else "Tendon tension",
                "pull [N]" if roles.pull else "tension [N]", letter=letter)
    axes.plot(time, value, color=PULL_HUE, linewidth=THICK)
    paper.roomy(axes, value, np.zeros(1))
    last = float(value[-1])
    paper.put_beside(axes, [Beside(last, f"{paper.number(last)} N", PULL_HUE)], height=AXES)
    if np.ptp(value) == 0:
        paper.remark(axes, "constant", paper.QUIET)


def _short(name: str) -> str:
    """The last word of a dotted name."""
    return name.rpartition(".")[2]
