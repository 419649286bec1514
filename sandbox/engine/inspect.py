"""Looks a mechanism over before it runs: what a simulation would do, but its author hardly meant.

Everything is judged at t = 0, from the mechanism alone; nothing is stepped.

- **Assembly**: :mod:`sandbox.engine.inspect_joints`, of gears :mod:`sandbox.engine.inspect_wheels`;
  bodies that lie in each other: :mod:`sandbox.engine.inspect_overlaps`.
- **Masses**: :mod:`sandbox.engine.inspect_masses`.
- **Springs**: :mod:`sandbox.engine.inspect_springs`; cords: :mod:`sandbox.engine.inspect_ringing`.
- **Hands**: :mod:`sandbox.engine.inspect_hands`; what they hold:
  :mod:`sandbox.engine.inspect_grasps`; their trees: :mod:`sandbox.engine.inspect_trees`.
- **Control**: :mod:`sandbox.engine.inspect_control`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sandbox.engine.clock import make_clock
from sandbox.engine.estimate import Estimate, estimate
from sandbox.engine.inspect_control import beyond_stops, control_problems
from sandbox.engine.inspect_grasps import grasp_problems
from sandbox.engine.inspect_hands import hand_problems
from sandbox.engine.inspect_idle import idle_problems
from sandbox.engine.inspect_joints import joint_problems, shared_problems
from sandbox.engine.inspect_lines import line_problems
from sandbox.engine.inspect_loads import load_problems
from sandbox.engine.inspect_masses import mass_problems
from sandbox.engine.inspect_overlaps import overlaps
from sandbox.engine.inspect_ringing import ringing_problems
from sandbox.engine.inspect_springs import against_step, without_arm
from sandbox.engine.inspect_tendons import tendon_problems
from sandbox.engine.inspect_wheels import wheel_problems
from sandbox.engine.inspect_words import (
    NEGLIGIBLE,
    deg,
    look,
    mm,
)
from sandbox.errors import Problem
from sandbox.model.compile import compile_mechanism
from sandbox.model.meters import check_quantities, check_shown
from sandbox.model.model import Model
from sandbox.model.pairs import allowed_pairs
from sandbox.scene.bodies import Polygon
from sandbox.scene.check.ranges import nothing_to_run
from sandbox.scene.geometry import outline, pose_of, to_world
from sandbox.scene.mechanism import Mechanism
from sandbox.values.signals import values
from sandbox.wording import quoted


class Inspection(NamedTuple):
    """What a look at a mechanism finds."""

    problems: list[Problem]
    """Errors first, otherwise in the order of the elements."""
    estimate: Estimate
    """Of its run."""


def inspect(mechanism: Mechanism) -> list[Problem]:
    """All that is to be said of ``mechanism``, errors first, otherwise in its elements' order.

    Paths are those of the mechanism; what belongs to an element has its name.
    """
    return look_over(mechanism).problems


def look_over(mechanism: Mechanism) -> Inspection:
    """What :func:`inspect` finds, and what a run would take."""
    model = compile_mechanism(mechanism)
    allowed = allowed_pairs(model)
    solids, cords = overlaps(model, allowed), list(tendon_problems(model))
    astray = {problem.path for problem in cords if problem.blocks}  # nor do these ring
    problems = [
        *nothing_to_run(mechanism), *joint_problems(model), *wheel_problems(model),
        *shared_problems(model),
        *solids.problems, *mass_problems(model, allowed), *cords,
        *hand_problems(model, allowed),
        *line_problems(model), *load_problems(model),
        *against_step(model),
        *(problem for problem in ringing_problems(model) if problem.path not in astray),
        *without_arm(model), *_drives(model),
        *_paths(mechanism), *_cams(mechanism), *check_quantities(mechanism),
        *check_shown(mechanism), *control_problems(mechanism),
        *beyond_stops(model), *idle_problems(model), *grasp_problems(model, allowed),
        *_sampling(mechanism),
        *_retired(mechanism), *_window(mechanism),
    ]
    return Inspection(sorted(problems, key=lambda problem: problem.severity != "error"),
                      estimate(model, allowed, near=solids.near))


# --- drives, quantities, sampling, picture


def _drives(model: Model) -> Iterator[Problem]:
    """Forces, torques and pulls on what cannot move freely; motors and brakes hold all the same."""
    for i, kind in enumerate(model.drives.kind):
        if kind.gives not in ("force", "torque", "tension") or kind.limited:
            continue
        moved = model.moved_by(i)
        if not model.bodies.free[moved].any():
            yield look("no-effect", f"$.drives[{i}]", model.drives.name[i],
                       f"acts on {model.bodies.name[moved[0]]!r}, which cannot move freely",
                       "it changes nothing")


def _paths(mechanism: Mechanism) -> Iterator[Problem]:
    """Scheduled bodies that are elsewhere at t = 0 than their path says."""
    for i, body in enumerate(mechanism.bodies):
        if body.path is None:
            continue
        for axis, start, show in (("x", body.at[0], mm), ("y", body.at[1], mm),
                                  ("angle", body.angle, deg)):
            signal = getattr(body.path, axis)
            if signal is None:
                continue
            first = float(values(signal, np.zeros(1), mechanism.functions)[0])
            if abs(first - start) > NEGLIGIBLE:
                yield look("jump-at-start", f"$.bodies[{i}].path.{axis}", body.name,
                           f"begins at {axis} = {show(start)}, its path at {show(first)}: it jumps "
                           "there in the first step", "let 'at' and 'angle' be where the path "
                           "begins")


def _sampling(mechanism: Mechanism) -> Iterator[Problem]:
    run = mechanism.run
    clock = make_clock(run.duration, run.step, run.sample_rate)
    actual = 1 / (clock.every * run.step)
    if abs(actual - run.sample_rate) > 1e-6 * run.sample_rate:
        yield look("bad-rate", "$.run", "run", f"the step {run.step:g} s does not divide the "
                   f"sampling interval {1 / run.sample_rate:g} s", f"samples come at {actual:.6g} "
                   f"Hz instead of {run.sample_rate:g} Hz")
    if run.duration < run.step:
        yield look("bad-rate", "$.run", "run", f"the duration {run.duration:g} s is shorter than a "
                   "step", "one step is made")


def _cams(mechanism: Mechanism) -> Iterator[Problem]:
    """Cams whose lift leaves the range of its table between two entries."""
    for i, body in enumerate(mechanism.bodies):
        for k, shape in enumerate(body.shapes):
            if isinstance(shape, Polygon) and shape.swing is not None:
                lift, beyond, turn = shape.swing
                yield look(
                    "bad-table", f"$.bodies[{i}].shapes[{k}]", body.name,
                    f"the lift of its cam swings to {mm(lift)} at a turn of {deg(turn)}, "
                    f"{mm(beyond)} beyond its entries",
                    "give more entries there, in a dwell one every 10 deg")


def _retired(mechanism: Mechanism) -> Iterator[Problem]:
    if given := mechanism.run.ignored:
        do, them = ("do", "them") if len(given) > 1 else ("does", "it")
        yield look("no-effect", "$.run", "run", f"{' and '.join(map(quoted, given))} {do} nothing "
                   "now: each step is solved to rounding, and no overlap is left alone",
                   f"leave {them} out")


def _window(mechanism: Mechanism) -> Iterator[Problem]:
    view = mechanism.view
    if view.start >= mechanism.run.duration:
        yield look("bad-view",
                   "$.view", "view", f"starts at {view.start:g} s, after the end of the run")
    if view.centre is None or view.width is None or not mechanism.bodies:
        return
    half = (view.width / 2, view.width / 2 * view.size[1] / view.size[0])
    for body in mechanism.bodies:
        points = [to_world(pose_of(body), p) for shape in body.shapes for p in outline(shape)]
        low = [min(p[k] for p in points or [body.at]) - view.centre[k] for k in (0, 1)]
        high = [max(p[k] for p in points or [body.at]) - view.centre[k] for k in (0, 1)]
        if all(low[k] <= half[k] and high[k] >= -half[k] for k in (0, 1)):
            return
    yield look("bad-view", "$.view", "view", "no body lies in the window at t = 0",
                   "leave 'centre' or 'width' out to have it fitted")
