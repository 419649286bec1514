"""The figure of a finger under control: shortening, rotations, stiffness, pull over time.

Panels A to D are those of the paper's Figures 18 to 21. Nothing is found by name: the
tendon is one whose shortening or whose hinges have a target, or else one that is
pulled, and of two that pull against each other the one that got shorter; the
joints are the hinges between bodies that it passes; the springs are those across
these hinges. Events stand as grey lines, and one that loads the finger does not count
against what had settled before it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from string import ascii_uppercase
from typing import Any

import numpy as np

from sandbox.draw.figure import style
from sandbox.draw.figure.events import EventMark, draw_marks, draw_names, marks_of
from sandbox.draw.figure.style import Shown, SideLabel
from sandbox.errors import OutputError
from sandbox.model.model import NONE, Model
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.response import BAND, Response, band_of, respond, settling_time
from sandbox.samples.targets import SUFFIX, Track, targets, track

ROW, REST, AXES, WIDTH = 52.0, 16.0, 35.0, 33.0
"""Height of a row of panels, of title and footnote together, height and width of a panel's axes
[mm]."""
PLAIN_HUE, PULL_HUE = style.SLATE, style.VIOLET
"""Of the tendon's shortening and of its pull."""
HUES = tuple(hue for hue in style.COLOURS if hue not in (PLAIN_HUE, PULL_HUE))
"""Of the joints: a joint's rotation and its spring have the same one."""
DECADES = 8.0
"""Stiffnesses that differ by more than this factor are shown on a logarithmic axis."""


@dataclass(frozen=True)
class Roles:
    """Which elements of a mechanism are the finger, by name."""

    tendon: str
    joints: tuple[str, ...]
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

    What had settled before the first event that set more than targets has the
    settling of the samples before that event.

    Args:
        run: of a finger: a tendon along hinges.
        given: targets by hand, quantity to value, SI.

    Raises:
        OutputError: the recording has no tendon along hinges, or too few samples.
    """
    goals = targets(run, given)
    roles = roles_of(run, goals)
    if len(run) < 2:
        raise OutputError(f"the recording has {len(run)} samples, a figure needs at least 2",
                          code="bad-time")
    used = 3 + len(roles.joints)
    rows, marks = math.ceil(used / 2), marks_of(run, width=WIDTH)
    figure = style.new_figure(ROW * rows + REST)
    grid = list(figure.subplots(rows, 2, sharex=True, squeeze=False).ravel())
    found: dict[str, Response] = {}
    for axes, letter, (name, head, y, hue) in zip(
            grid, ascii_uppercase, _followed(roles), strict=False):
        style.dress(axes, head, y, letter=letter)
        answer = _response(axes, run, name, goals.get(name), hue=hue,
                           marks=marks if axes is grid[0] else ())
        if answer:
            found[name] = answer
    _stiffness(grid[used - 2], run, roles, ascii_uppercase[(used - 2) % 26])
    _pull(grid[used - 1], run, roles, ascii_uppercase[(used - 1) % 26])
    style.over_time(grid, used, 2, run)
    draw_marks(grid[:used], marks)
    style.title(figure, _title(run.model, roles))
    _footnote(figure, targets=bool(found), events=bool(marks), loads=disturbed(run) < math.inf)
    return figure, found


def _footnote(figure: Any, *, targets: bool, events: bool, loads: bool) -> None:
    lines = []
    if targets:
        lines.append(f"Shaded: ±{100 * BAND:g} % of the target. Dotted: the last time outside "
                     "of it. Numbers at the right: targets and final values.")
    second = ["Grey lines: events, named in A."] if events else []
    if targets and loads:
        second.append("Where one disturbs what had settled: settled before it, back after it.")
    if second:
        lines.append(" ".join(second))
    if lines:
        style.footnote(figure, "\n".join(lines))


def disturbed(run: Recording) -> float:
    """When the first event of a run set something other than a target [s]; inf if none did."""
    sets = {event.name: event.set for event in run.mechanism.events}
    return min((event.time for event in run.info.events
                if any(not key.endswith(SUFFIX) for key in sets.get(event.event, ()))),
               default=math.inf)


def _title(model: Model, roles: Roles) -> str:
    """The scene's title, and which tendon this is where several pass hinges."""
    title = model.mechanism.title or model.mechanism.name
    fingers = sum(bool(_along(model, tendon)) for tendon in range(len(model.tendons.name)))
    return f"{title} ({roles.tendon})" if fingers > 1 else title


def _followed(roles: Roles) -> list[tuple[str, str, str, str]]:
    """Quantity, title, axis and colour of the first panels."""
    return [
        (f"{roles.tendon}.shortening", "Tendon shortening", "shortening", PLAIN_HUE),
        *((f"{joint}.angle", f"Rotation of {_short(joint)}", "rotation",
           HUES[i % len(HUES)]) for i, joint in enumerate(roles.joints)),
    ]


def roles_of(run: Recording, goals: Mapping[str, Any]) -> Roles:
    """Which tendon, which hinges, which pull; ``goals`` has the quantities with targets as keys.

    Raises:
        OutputError: there is no tendon along hinges.
    """
    model = run.model
    fingers = [Roles(name, joints, "" if drive == NONE else model.drives.name[drive])
               for i, (name, drive) in enumerate(
                   zip(model.tendons.name, model.tendons.drive, strict=True))
               if (joints := _along(model, i))]
    if not fingers:
        raise OutputError("the figure 'finger-control' needs a tendon that passes hinges; "
                          "this recording has none", code="bad-picture")

    def rank(finger: Roles) -> tuple[bool, ...]:
        shortening = f"{finger.tendon}.shortening"
        return (shortening not in goals,
                not any(f"{joint}.angle" in goals for joint in finger.joints),
                not finger.pull, bool(np.any(run[shortening][-1:] < 0)))

    return min(fingers, key=rank)


def _along(model: Model, tendon: int) -> tuple[str, ...]:
    """The hinges between neighbouring bodies of a tendon's path, in the mechanism's order."""
    joints, path = model.joints, model.tendons.guide_body[model.tendons.guides(tendon)]
    pairs = {frozenset(pair) for pair in pairwise(path.tolist())}
    return tuple(joints.name[i] for i in joints.hinges if frozenset(joints.bodies[i]) in pairs)


def stiffnesses(run: Recording, joints: Sequence[str]) -> list[Stiffness]:
    """The stiffness of every spring across some hinges over time, in the hinges' order."""
    springs, found = run.model.springs, []
    for i, joint in enumerate(joints):
        for k in _across(run.model, run.model.names.joint[joint]):
            label = _short(joint)
            time, value = run.time, np.full(len(run), springs.stiffness[k])
            if springs.drive[k] != NONE:
                label = run.model.drives.name[springs.drive[k]]
                time, value, _ = track(run, f"{label}.value")
            found.append(Stiffness(label, i, springs.kind[k].unit, time, value))
    return found


def _across(model: Model, joint: int) -> list[int]:
    """The springs about a hinge, or between its two bodies."""
    springs, ends = model.springs, set(model.joints.bodies[joint])
    return [k for k, about in enumerate(springs.joint)
            if about in (joint, NONE) and set(springs.bodies[k]) == ends]


def _response(
    axes: Any, run: Recording, name: str, target: Array | None, *, hue: str,
    marks: Sequence[EventMark],
) -> Response | None:
    """A quantity with its target, its band and when it has settled; the names of ``marks``."""
    time, value, goals = path = track(run, name, target)
    rows = [value] if goals is None else [value, goals]
    shown = style.shown_as(run.unit(name), *rows)
    axes.set_ylabel(f"{axes.get_ylabel()} [{shown.unit}]", fontsize=style.SMALL)
    axes.plot(time, shown.factor * value, color=hue, linewidth=style.LINE, zorder=3)
    style.roomy(axes, *(shown.factor * row for row in rows))
    draw_names(axes, marks, height=AXES)
    last = shown.factor * float(value[-1])
    final = SideLabel(last, f"{style.number(last)}{shown.sign}", hue)
    if goals is None:
        style.label_side(axes, [final], height=AXES)
        return None
    found, back = _answer(path, disturbed(run))
    _target(axes, time, goals, shown, band=band_of(value, goals))
    goal = shown.factor * found.target
    aim = SideLabel(goal, f"target {style.number(goal)}{'°' if shown.sign == '°' else ''}")
    style.label_side(axes, [aim] if found.settles and math.isfinite(back) else [aim, final],
                     height=AXES)
    _settling(axes, found, back)
    return found


def _answer(path: Track, since: float) -> tuple[Response, float]:
    """The response, and how long after a disturbance it was outside of the band [s].

    The settling is that before ``since`` if it had settled by then and the target
    stays the same from then on; else that of the whole run, with 0.
    """
    time, value, goals = path
    assert goals is not None
    whole, early = respond(time, value, goals), int(np.count_nonzero(time <= since))
    if not 2 <= early < len(time) or not np.allclose(goals[early - 1:], goals[-1]):
        return whole, 0.0
    first = settling_time(time[:early], value[:early], goals[:early])
    if not math.isfinite(first):
        return whole, 0.0
    return replace(whole, settling=first), max(0.0, whole.settling - since)


def _target(axes: Any, time: Array, target: Array, shown: Shown, *, band: float) -> None:
    # of what stands still two points are enough, and a file of curves stays small
    some = slice(None, None, len(time) - 1 if np.ptp(target) == 0 else 1)
    time, target = time[some], target[some]
    axes.fill_between(time, shown.factor * (target - band), shown.factor * (target + band),
                      color=style.BAND, linewidth=0, zorder=1)
    axes.plot(time, shown.factor * target, color=style.INK, zorder=2, **style.TARGET)


def _settling(axes: Any, found: Response, back: float) -> None:
    if not found.settles:
        style.remark(axes, "does not settle", style.BAD)
        return
    after = "" if not back else f";\nback after {style.seconds(back)}" if math.isfinite(
        back) else ";\nnot back"
    style.remark(axes, f"settled at {style.seconds(found.settling)}{after}",
                 style.GOOD if math.isfinite(back) else style.BAD)
    axes.axvline(found.settling, color=style.GOOD, linewidth=1.1, linestyle=(0, (1.2, 1.6)),
                 zorder=2)


def _stiffness(axes: Any, run: Recording, roles: Roles, letter: str) -> None:
    """All stiffnesses in one panel, each in its joint's colour."""
    rows = stiffnesses(run, roles.joints)
    style.dress(axes, "Spring stiffness", f"stiffness [{rows[0].unit}]" if rows else "",
                letter=letter)
    if not rows:
        style.remark(axes, "no springs", style.QUIET)
        return
    every = np.concatenate([row.value for row in rows])
    if every.min() > 0 and every.max() > DECADES * every.min():
        axes.set_yscale("log")
        axes.set_ylim(every.min() / 1.35, every.max() * 1.35)
    else:
        style.roomy(axes, every)
    labels = []
    for row in rows:
        hue = HUES[row.joint % len(HUES)]
        axes.plot(row.time, row.value, color=hue, linewidth=style.LINE)
        last = float(row.value[-1])
        labels.append(SideLabel(last, f"{row.label}  {style.number(last)}", hue))
    style.label_side(axes, labels, height=AXES)
    if not any(np.ptp(row.value) for row in rows):
        style.remark(axes, "constant", style.QUIET)


def _pull(axes: Any, run: Recording, roles: Roles, letter: str) -> None:
    """What pulls the tendon: a drive, or whatever makes its tension."""
    time, value, _ = track(
        run, f"{roles.pull}.value" if roles.pull else f"{roles.tendon}.tension")
    style.dress(axes, "Tendon pull" if roles.pull else "Tendon tension",
                "pull [N]" if roles.pull else "tension [N]", letter=letter)
    axes.plot(time, value, color=PULL_HUE, linewidth=style.LINE)
    style.roomy(axes, value, np.zeros(1))
    last = float(value[-1])
    style.label_side(axes, [SideLabel(last, f"{style.number(last)} N", PULL_HUE)], height=AXES)
    if np.ptp(value) == 0:
        style.remark(axes, "constant", style.QUIET)


def _short(name: str) -> str:
    """The last word of a dotted name."""
    return name.rpartition(".")[2]
