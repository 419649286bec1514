"""Looks a mechanism over before it runs: what a simulation would do, but its author hardly meant.

Everything is judged at t = 0, from the mechanism alone; nothing is stepped.

- **Assembly**: :mod:`sandbox.engine.inspect_joints`; bodies that lie in each other.
- **Masses**: :mod:`sandbox.engine.inspect_masses`.
- **Springs**: :mod:`sandbox.engine.inspect_springs`; cords: :mod:`sandbox.engine.inspect_ringing`.
- **Control**: :mod:`sandbox.engine.inspect_control`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np
import pymunk

from sandbox.engine.clock import make_clock
from sandbox.engine.contact_rules import allowed_pairs
from sandbox.engine.inspect_control import beyond_stops, control_problems
from sandbox.engine.inspect_joints import joint_problems, shared_problems
from sandbox.engine.inspect_masses import mass_problems
from sandbox.engine.inspect_ringing import ringing_problems
from sandbox.engine.inspect_springs import against_step, without_arm
from sandbox.engine.inspect_words import (
    NEGLIGIBLE,
    STRAIGHT,
    deg,
    error,
    look,
    mm,
)
from sandbox.engine.world import make_shape
from sandbox.errors import Problem
from sandbox.model.catalogue import check_quantities
from sandbox.model.compile import compile_mechanism
from sandbox.model.model import Model
from sandbox.scene.check.ranges import nothing_to_run
from sandbox.scene.geometry import outline, pose_of, to_world
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.values.signals import values
from sandbox.wording import quoted


def inspect(mechanism: Mechanism) -> list[Problem]:
    """All that is to be said of ``mechanism``, errors first, otherwise in its elements' order.

    Paths are those of the mechanism; what belongs to an element has its name.
    """
    model = compile_mechanism(mechanism)
    problems = [
        *nothing_to_run(mechanism), *joint_problems(model), *shared_problems(model),
        *_overlaps(model), *mass_problems(model), *_tendons(model),
        *against_step(model), *ringing_problems(model), *without_arm(model), *_drives(model),
        *_paths(mechanism), *check_quantities(mechanism), *control_problems(mechanism),
        *beyond_stops(model), *_sampling(mechanism), *_retired(mechanism), *_window(mechanism),
    ]
    return sorted(problems, key=lambda problem: problem.severity != "error")


# --- overlapping bodies


def _overlaps(model: Model) -> Iterator[Problem]:
    """Pairs that may touch and are deeper in each other than is negligible."""
    allowed, mechanism = allowed_pairs(model), model.mechanism
    space = pymunk.Space()
    owner: dict[pymunk.Shape, int] = {}
    for i, body in enumerate(mechanism.bodies):
        holder = pymunk.Body(body_type=pymunk.Body.STATIC)
        holder.position, holder.angle = body.at, body.angle
        space.add(holder)
        for shape in body.shapes:
            solid = make_shape(holder, shape, (0.0, 0.0))
            space.add(solid)
            owner[solid] = i
    depths: dict[tuple[int, int], float] = {}
    for solid, i in owner.items():
        if mechanism.bodies[i].motion == "fixed":
            continue
        for hit in space.shape_query(solid):
            j = owner[hit.shape] if hit.shape is not None else i
            if not allowed[i, j]:
                continue
            depth = max((-p.distance for p in hit.contact_point_set.points), default=0.0)
            pair = (min(i, j), max(i, j))
            depths[pair] = max(depth, depths.get(pair, 0.0))
    for (i, j), depth in sorted(depths.items()):
        if depth > NEGLIGIBLE:
            first, second = mechanism.bodies[i].name, mechanism.bodies[j].name
            yield look(f"$.bodies[{i}]", first,
                       f"overlaps {second!r} by {mm(depth)} at t = 0",
                       "move one of them, or add a contact rule with \"collide\": false")


# --- tendons


def _tendons(model: Model) -> Iterator[Problem]:
    bodies = model.mechanism.bodies
    for i, tendon in enumerate(model.mechanism.tendons):
        path = f"$.tendons[{i}]"
        guided = model.tendons.guide_body[model.tendons.guides(i)]
        points = [to_world(pose_of(bodies[body]), guide.at)
                  for body, guide in zip(guided, tendon.guides, strict=True)]
        for k, (p, q) in enumerate(itertools.pairwise(points)):
            first, second = tendon.guides[k], tendon.guides[k + 1]
            gap = math.dist(p, q)
            reach = (first.radius + second.radius if first.side != second.side
                     else abs(first.radius - second.radius))
            if gap < STRAIGHT:
                yield error(path, tendon.name, f"its guides {k} and {k + 1} coincide",
                             "move one of them: the cord between has no direction")
            elif gap < reach:
                yield error(
                    path, tendon.name, f"the wheels of its guides {k} and {k + 1} are "
                    f"{mm(gap)} apart, the cord between them needs {mm(reach)}",
                    "move one of them, or make it smaller")
        if not model.bodies.free[guided].any():
            yield look(path, tendon.name, "passes no body that can move freely",
                           "it pulls on nothing")


# --- drives, quantities, sampling, picture


def _drives(model: Model) -> Iterator[Problem]:
    """Forces, torques and pulls on what cannot move freely; motors and brakes hold all the same."""
    for i, kind in enumerate(model.drives.kind):
        if kind.gives not in ("force", "torque", "tension") or kind.limited:
            continue
        moved = model.moved_by(i)
        if not model.bodies.free[moved].any():
            yield look(
                f"$.drives[{i}]", model.drives.name[i],
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
            first = float(values(signal, np.zeros(1))[0])
            if abs(first - start) > NEGLIGIBLE:
                yield look(
                    f"$.bodies[{i}].path.{axis}", body.name,
                    f"begins at {axis} = {show(start)}, its path at {show(first)}: it jumps there "
                    "in the first step",
                    "let 'at' and 'angle' be where the path begins")


def _sampling(mechanism: Mechanism) -> Iterator[Problem]:
    run = mechanism.run
    clock = make_clock(run.duration, run.step, run.sample_rate)
    actual = 1 / (clock.every * run.step)
    if abs(actual - run.sample_rate) > 1e-6 * run.sample_rate:
        yield look("$.run", "run", f"the step {run.step:g} s does not divide the sampling "
                       f"interval {1 / run.sample_rate:g} s",
                       f"samples come at {actual:.6g} Hz instead of {run.sample_rate:g} Hz")
    if run.duration < run.step:
        yield look("$.run", "run", f"the duration {run.duration:g} s is shorter than a step",
                       "one step is made")


def _retired(mechanism: Mechanism) -> Iterator[Problem]:
    if given := mechanism.run.ignored:
        do, them = ("do", "them") if len(given) > 1 else ("does", "it")
        yield look("$.run", "run", f"{' and '.join(map(quoted, given))} {do} nothing any more: "
                   "each step is solved to rounding, and no overlap is left alone",
                   f"leave {them} out")


def _window(mechanism: Mechanism) -> Iterator[Problem]:
    view = mechanism.view
    if view.start >= mechanism.run.duration:
        yield look("$.view", "view", f"starts at {view.start:g} s, after the end of the run")
    if view.centre is None or view.width is None or not mechanism.bodies:
        return
    half = (view.width / 2, view.width / 2 * view.size[1] / view.size[0])
    for body in mechanism.bodies:
        points = [to_world(pose_of(body), p) for shape in body.shapes for p in outline(shape)]
        low = [min(p[k] for p in points or [body.at]) - view.centre[k] for k in (0, 1)]
        high = [max(p[k] for p in points or [body.at]) - view.centre[k] for k in (0, 1)]
        if all(low[k] <= half[k] and high[k] >= -half[k] for k in (0, 1)):
            return
    yield look("$.view", "view", "no body lies in the window at t = 0",
                   "leave 'centre' or 'width' out to have it fitted")
