"""Checks of a mechanism before it runs, and an estimate of the time and memory of a run.

The checks use the mechanism at t = 0; nothing is stepped. The terms of the estimate were fitted to
runs of 38 mechanisms: shipped scenes take 0.4 to 1.5 times the estimate on a core of a server, 200
boxes that fall on one another 10 times as long. Pictures and the audit are left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sandbox.elements.arrays import CONTACT as CONTACT_ROW
from sandbox.elements.arrays import MEAN, MEAN_CONTACT, PER_SAMPLE, row_bytes
from sandbox.elements.controllers.controller import every
from sandbox.engine import inspect_elements as of
from sandbox.engine.inputs import make_clock
from sandbox.engine.inspect_control import beyond_stops, control_problems, idle_problems
from sandbox.engine.inspect_elements import NEGLIGIBLE, deg, look, mm
from sandbox.engine.inspect_hands import hand_problems
from sandbox.engine.inspect_springs import against_step, ringing_problems, without_arm
from sandbox.engine.islands import MANY
from sandbox.engine.pile_rows import MIN_LINKED
from sandbox.errors import Problem
from sandbox.model.compile import compile_mechanism
from sandbox.model.meters import check_quantities, check_shown
from sandbox.model.model import Model
from sandbox.model.pairs import allowed_pairs
from sandbox.numeric import Flags
from sandbox.scene.bodies import Polygon
from sandbox.scene.check.ranges import nothing_to_run
from sandbox.scene.geometry import outline, pose_of, to_world
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.limits import Limits, over
from sandbox.values.signals import values


class Inspection(NamedTuple):
    """Problems of a mechanism and the estimate of its run."""

    problems: list[Problem]  # errors first, otherwise in the order of the elements
    estimate: Estimate


def inspect(mechanism: Mechanism) -> list[Problem]:
    """The problems of :func:`look_over`."""
    return look_over(mechanism).problems


def look_over(mechanism: Mechanism) -> Inspection:
    """Errors and warnings of a mechanism, and the cost of a run."""
    model = compile_mechanism(mechanism)
    allowed = allowed_pairs(model)
    (solids, near), cables = of.overlaps(model, allowed), list(of.tendon_problems(model))
    astray = {problem.path for problem in cables if problem.blocks}  # no check of their vibration
    problems = [
        *nothing_to_run(mechanism), *of.joint_problems(model), *of.wheel_problems(model),
        *of.shared_problems(model), *solids, *of.mass_problems(model, allowed), *cables,
        *hand_problems(model, allowed), *of.line_problems(model), *of.load_problems(model),
        *against_step(model),
        *(problem for problem in ringing_problems(model) if problem.path not in astray),
        *without_arm(model), *_of_scene(mechanism),
        *check_quantities(mechanism), *check_shown(mechanism), *control_problems(mechanism),
        *beyond_stops(model), *idle_problems(model), *of.grasp_problems(model, allowed),
        *_of_run(mechanism)]
    return Inspection(sorted(problems, key=lambda problem: problem.severity != "error"),
                      estimate(model, allowed, near=near))


def _of_scene(mechanism: Mechanism) -> Iterator[Problem]:
    for i, body in enumerate(mechanism.bodies):
        for axis, start, show in (("x", body.at[0], mm), ("y", body.at[1], mm),
                                  ("angle", body.angle, deg)) if body.path else ():
            signal = getattr(body.path, axis)
            if signal is None:
                continue
            first = float(values(signal, np.zeros(1), mechanism.functions)[0])
            if abs(first - start) > NEGLIGIBLE:
                yield look("jump-at-start", f"$.bodies[{i}].path.{axis}", body.name,
                           f"begins at {axis} = {show(start)}, its path at {show(first)}: it jumps "
                           "there in the first step", "set 'at' and 'angle' to the path's start")
        for k, shape in enumerate(body.shapes):
            if isinstance(shape, Polygon) and shape.swing is not None:
                lift, beyond, turn = shape.swing
                yield look("bad-table", f"$.bodies[{i}].shapes[{k}]", body.name,
                           f"the lift of its cam swings to {mm(lift)} at a turn of {deg(turn)}, "
                           f"{mm(beyond)} beyond its entries",
                           "give more entries there, in a dwell one every 10 deg")


def _of_run(mechanism: Mechanism) -> Iterator[Problem]:
    run, view = mechanism.run, mechanism.view
    actual = 1 / (make_clock(run.duration, run.step, run.sample_rate).every * run.step)
    if abs(actual - run.sample_rate) > 1e-6 * run.sample_rate:
        yield look("bad-rate", "$.run", "run", f"the step {run.step:g} s does not divide the "
                   f"sampling interval {1 / run.sample_rate:g} s",
                   f"the sample rate is {actual:.6g} Hz instead of {run.sample_rate:g} Hz")
    if run.duration < run.step:
        yield look("bad-rate", "$.run", "run", f"the duration {run.duration:g} s is shorter than a "
                   "step", "one step is made")
    if view.start >= run.duration:
        yield look("bad-view",
                   "$.view", "view", f"starts at {view.start:g} s, after the end of the run")
    if view.centre is None or view.width is None or not mechanism.bodies:
        return
    half = np.array([view.width / 2, view.width / 2 * view.size[1] / view.size[0]])
    for body in mechanism.bodies:
        points = [to_world(pose_of(body), p) for shape in body.shapes for p in outline(shape)]
        off = np.array(points or [body.at]) - view.centre
        if ((off.min(axis=0) <= half) & (off.max(axis=0) >= -half)).all():
            return
    yield look("bad-view", "$.view", "view", "no body lies in the window at t = 0",
               "leave 'centre' or 'width' out to have it fitted")


STEP = 3e-6  # an empty step [s]
BODY, ROW, GUIDE, SPRING, DRIVE = 0.12e-6, 0.25e-6, 0.12e-6, 0.6e-6, 0.35e-6  # per element [s]
CONTACT, CONTACTS = 0.25e-6, 2e-9  # per contact, and per pair of contacts [s]
PILED, POWER = 0.25e-6, 1.5  # time for the bodies of a pile, times their number to this power [s]
ACT = 12e-6  # one evaluation of a controller or a condition [s]
NUMBER = 0.25e-6  # eight bytes that are recorded and written into two files [s]
ROWS = {"point": 2, "groove": 1, "distance": 1, "range": 1, "gear": 1, "rack": 1, "roll": 2}
"""Of joints."""


@dataclass(frozen=True)
class Estimate:
    """The cost of a run."""

    steps: int
    samples: int
    contacts: int  # in every sample: of free bodies with shapes, or pairs near at t = 0
    seconds: float
    recorded_bytes: int  # contacts included

    def __str__(self) -> str:
        return (f"would take about {_time(self.seconds)} and {_size(self.recorded_bytes)} "
                f"({_count(self.steps)}, {_count(self.samples, 'sample')})")

    @property
    def data(self) -> dict[str, float]:
        """The same as JSON data."""
        return {"steps": self.steps, "samples": self.samples, "contacts": self.contacts,
                "seconds": float(f"{self.seconds:.2g}"),
                "recorded_bytes": self.recorded_bytes}

    def beyond(self, limits: Limits) -> Iterator[Problem]:
        """Time and memory above the limits."""
        yield from over(limits, "seconds", self.seconds, "$.run", "the run would take about "
                        f"{_time(self.seconds)}, {{count}} s")
        yield from over(
            limits, "recorded_bytes", self.recorded_bytes, "$.run.sample_rate", "the recording "
            f"would take about {{count}} bytes with {self.contacts} contacts in each sample")


def estimate(model: Model, allowed: Flags, *, near: int) -> Estimate:
    """Estimate the cost of a run; ``near`` pairs of the ``allowed`` are together at t = 0."""
    mechanism, run = model.mechanism, model.mechanism.run
    clock = make_clock(run.duration, run.step, run.sample_rate)
    shaped = np.array([bool(body.shapes) for body in mechanism.bodies], dtype=bool)
    may = allowed & shaped & shaped[:, None]
    touching = int(np.count_nonzero(may.any(axis=1) & model.bodies.free))
    contacts = min(max(touching, near), int(np.count_nonzero(may)) // 2)
    sample, contact = list(PER_SAMPLE), list(CONTACT_ROW)
    if clock.every > 1:
        sample, contact = [*sample, *MEAN], [*contact, *MEAN_CONTACT]
    size = clock.samples * (row_bytes(mechanism, sample) + contacts * row_bytes(mechanism, contact))
    rates = [law.rate for law in mechanism.controllers]
    rates += [event.rate for event in mechanism.events if event.when is not None]
    step = (STEP + BODY * len(shaped) + ROW * sum(ROWS[kind.keeps] for kind in model.joints.kind)
            + GUIDE * (len(model.tendons.guide_body) + len(model.lines.gain))
            + SPRING * sum(map(len, (model.springs.name, model.lines.name, model.valves.name,
                                     model.loads.name)))
            + DRIVE * len(model.drives.name) + CONTACT * contacts)
    held = np.zeros(len(model.bodies.name), dtype=bool)
    for bodies in (model.joints.bodies, model.tendons.guide_body, model.springs.bodies):
        held[bodies.ravel()] = True
    piled = int(np.count_nonzero(model.bodies.free & ~held))
    linked = int(np.count_nonzero(model.bodies.free)) - piled
    kept_out = (len(model.loads.name) or len(model.lines.name) or len(model.bonds.name)
                or bool((~np.isnan(model.drives.most)).any()))
    if piled + linked >= MIN_LINKED and not kept_out:
        piled += linked
    # contacts are coupled; the sparse solver takes those of piles
    step += (float(PILED * piled**POWER) if 2 * min(contacts, piled) > MANY
             else CONTACTS * contacts**2)
    seconds = (clock.steps * step + ACT * sum(clock.steps / every(rate, clock.step)
                                              for rate in rates) + NUMBER * size / 8)
    return Estimate(clock.steps, clock.samples, contacts, seconds, size)


def _time(seconds: float) -> str:
    size, name = next((size, name) for below, size, name in (
        (100, 1, "s"), (6000, 60, "min"), (360_000, 3600, "h"), (math.inf, 86400, "days"))
        if seconds < below)
    return f"{max(seconds / size, 0.01):.2g} {name}"


def _size(size: float) -> str:
    factor, unit = ((1e3, "kB") if size < 999.5e3 else (1e6, "MB") if size < 999.5e6
                    else (1e9, "GB"))
    return f"{max(size / factor, 1):.3g} {unit}"


def _count(number: int, what: str = "step") -> str:
    return f"{number:,} {what}{'' if number == 1 else 's'}".replace(",", " ")
