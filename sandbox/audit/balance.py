"""Figures of force: joints' reactions, momentum of every body, energy of the whole."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import ROUNDING, Figure, Worst, judged, missing
from sandbox.model.model import NONE
from sandbox.model.supports import MOST, shared_joints
from sandbox.numeric import Array
from sandbox.samples.samples import OLDER

EXACT = 1e-9
"""Fraction of the largest force: sums of some ten forces to sixteen digits, and some to spare."""
STILL = 1e-11, 1e-10
"""Where nothing moves faster [m/s, rad/s] the engine lets all stand: so much may go in a step."""
ENERGY = 1e-3
"""Fraction of the energy at h = 0.5 ms; the leapfrog's error goes with h^2."""
REFERENCE_STEP = 5e-4
DIGITS = 1e-15
"""Share of a velocity that is lost to rounding where a step changes it."""
POSES = 5
"""In so many poses joints have to share a load to be told: in a dead centre some do for once."""


def balance_figures(evidence: Evidence) -> Iterator[Figure]:
    """Reactions, momentum, energy."""
    yield _reaction_sizes(evidence)
    yield _shared(evidence)
    yield from _momentum(evidence)
    yield from energy_figures(evidence)


def _reaction_sizes(evidence: Evidence) -> Figure:
    """The recorded sizes of reactions against the recorded vectors."""
    a, worst = evidence.run.arrays, Worst()
    if not evidence.vectors:
        return missing("reaction.size", why=OLDER, source="|R|")
    vector = np.hypot(a["joint_force"][:, :, 0], a["joint_force"][:, :, 1])
    for j, name in enumerate(evidence.model.joints.name):
        scale = max(float(np.abs(a["joint_reaction"][:, j]).max(initial=0.0)), 1e-12)
        worst.add(name, np.abs(vector[:, j] - a["joint_reaction"][:, j]) / scale, ROUNDING)
    return worst.figure(
        "reaction.size", "", source="|R|", none="there is no joint",
        why="size of each reaction against its components, shares of the largest of its joint, "
            "{count} joints, worst: {where}")


def _shared(evidence: Evidence) -> Figure:
    """Joints whose reactions the laws of mechanics leave open, in all of a few poses."""
    name, source = "reaction.shared", "rank of J"
    model, poses = evidence.model, evidence.run.arrays["body_pose"]
    if not len(model.joints.name):
        return missing(name, why="there is no joint", source=source)
    few = np.unique(np.linspace(0, len(poses) - 1, min(len(poses), POSES)).astype(int))
    found = [shared_joints(model, poses[i]) for i in few]
    shared = [model.joints.name[j] for j in sorted(set.intersection(*(f.joints for f in found)))]
    asked = found[0].asked
    if not asked:
        return missing(name, source=source, why=f"more than {MOST} forces hang together")
    return judged(
        name, float(len(shared)), "", 0.0, source=source,
        why="joints that share their load with others, so that statics does not decide their "
            "reactions, which are the smallest that will do: " + (_named(shared, 6) or "none"))


def _named(items: list[str], most: int = 3) -> str:
    return "; ".join(items[:most]) + (f" and {len(items) - most} more" if len(items) > most else "")


def _momentum(evidence: Evidence) -> Iterator[Figure]:
    """What is left of m a - sum F and of I alpha - sum M on every body in every sample."""
    model, a = evidence.model, evidence.run.arrays
    names = ("momentum.force", "m a = Σ F"), ("momentum.moment", "I α = Σ M")
    if not evidence.vectors:
        for name, source in names:
            yield missing(name, why=OLDER, source=source)
        return
    loads, h = evidence.loads, evidence.h
    v = np.abs(loads.frames.velocity).max(axis=2, initial=0.0)
    for row, (name, source) in enumerate(names):
        left_over = Worst()
        for b in np.flatnonzero(model.bodies.free).tolist():
            force, moment = (float(loads.largest[k, b]) for k in (0, 1))
            mass = float(a["body_inertia" if row else "body_mass"][b])
            speed = STILL[row] + DIGITS * float(v[2, b] if row else np.hypot(v[0, b], v[1, b]))
            scale = max(moment, force * ROUNDING / EXACT) if row else force
            scale = max(scale, 1e-12)
            left = loads.left[:, b]
            error = np.abs(left[2]) if row else np.hypot(left[0], left[1])
            left_over.add(model.bodies.name[b], error / scale, EXACT + mass * speed / (h * scale))
        yield left_over.figure(
            name, "", source=source, none="nothing moves freely",
            why="left over, joints' reactions included, against the largest "
                f"{'moment' if row else 'force'} on the body, {{count}} bodies, worst: {{where}}")


# -- energy ---------------------------------------------------------------------------------


def energy_figures(evidence: Evidence) -> Iterator[Figure]:
    """Work of springs against their energy, and of all against the kinetic energy."""
    source = "ΔE = Σ W"
    unknown = _unrecorded(evidence)
    a = evidence.run.arrays
    kinetic = kinetic_energy(evidence)
    works = np.abs(a["drive_work"]).sum(axis=1) + np.abs(a["spring_work"]).sum(axis=1)
    if any(evidence.model.mechanism.gravity):
        works = works + np.abs(_work_of_weight(evidence))
    scale = max(float((works + kinetic).max(initial=0.0)), 1e-15)
    allowed = ENERGY * (evidence.h / REFERENCE_STEP) ** 2
    yield _spring_energy(evidence, scale, allowed)
    if unknown:
        for name in ("energy.created", "energy.lost"):
            yield missing(name, why=unknown, source=source)
        return
    left = kinetic - kinetic_at_start(evidence) - _work_of_loads(evidence)
    weight = float(np.hypot(*evidence.model.mechanism.gravity)
                   * a["body_mass"][evidence.model.bodies.free].sum())
    lifted = 0.0 if evidence.every_step or not weight else weight * float(_moved(evidence)[-1])
    yield _created(left, scale, allowed + lifted / scale)
    yield _lost(evidence, left, scale, allowed)


def kinetic_energy(evidence: Evidence) -> Array:
    """Mean of the energies before and after the step [J], [n]: m (v^2 + (h a / 2)^2) / 2."""
    a, free = evidence.run.arrays, evidence.model.bodies.free
    count = len(evidence.run)
    v, change = (a[key].reshape(count, -1) for key in ("body_velocity", "body_acceleration"))
    weight = np.stack([a["body_mass"], a["body_mass"], a["body_inertia"]], axis=1)
    weight = np.where(free[:, None], weight, 0.0).ravel()
    moving = np.einsum("ni,ni,i->n", v, v, weight)
    return np.asarray(moving + (evidence.h / 2)**2
                      * np.einsum("ni,ni,i->n", change, change, weight)) / 2


def kinetic_at_start(evidence: Evidence) -> float:
    """At t = 0 [J], from the scene."""
    total, bodies = 0.0, evidence.model.mechanism.bodies
    for i in np.flatnonzero(evidence.model.bodies.free):
        m, inertia = (float(evidence.run.arrays[key][i]) for key in ("body_mass", "body_inertia"))
        (vx, vy), omega = bodies[i].velocity, bodies[i].angular_velocity
        total += (m * (vx**2 + vy**2) + inertia * omega**2) / 2
    return total


def _unrecorded(evidence: Evidence) -> str:
    bodies, drives = evidence.model.bodies, evidence.model.drives
    if len(moved := np.flatnonzero(bodies.scheduled)):
        return f"the work of what moves {bodies.name[moved[0]]!r} by a schedule is not recorded"
    if len(grown := drives.giving("radius")):
        return f"the work of {drives.name[grown[0]]!r}, which changes a radius, is not recorded"
    return ""


def _work_of_loads(evidence: Evidence) -> Array:
    """All but joints and contacts: tendons, drives, springs, dampers, weight [J], [n]."""
    a, model = evidence.run.arrays, evidence.model
    # the work of a pull is its tendon's
    own = np.delete(a["drive_work"], model.drives.giving("tension"), axis=1)
    total = a["tendon_work"].sum(axis=1) + a["spring_work"].sum(axis=1)
    total = total + own.sum(axis=1)
    total = total + np.nan_to_num(a["joint_damping_work"]).sum(axis=1)
    if any(model.mechanism.gravity):
        total = total + _work_of_weight(evidence)
    return np.asarray(total)


def _work_of_weight(evidence: Evidence) -> Array:
    """M g . (c - c_0 + h^2 a / 4): the displacement by mean velocities, as works are added up.

    Where every step was recorded, the velocities themselves: poses are also
    moved, without work, to take overlaps apart.
    """
    frames, h = evidence.loads.frames, evidence.h
    g = np.array(evidence.model.mechanism.gravity)
    if evidence.every_step:
        free = np.flatnonzero(evidence.model.bodies.free)
        m = evidence.run.arrays["body_mass"][free]
        each = h * (m @ (g[0] * frames.velocity[0, free] + g[1] * frames.velocity[1, free]))
        return np.asarray(np.cumsum(each) - each / 2)
    total = np.zeros(frames.samples)
    for i in np.flatnonzero(evidence.model.bodies.free):
        own = float(evidence.run.arrays["body_mass"][i])
        cx, cy = evidence.run.arrays["body_centre"][i]
        x, y, angle = evidence.model.bodies.pose[i]
        c, s = np.cos(angle), np.sin(angle)
        dx = frames.centre_x[i] - (x + c * cx - s * cy)
        dy = frames.centre_y[i] - (y + s * cx + c * cy)
        dx, dy = (d + h * h / 4 * frames.acceleration[k, i] for k, d in enumerate((dx, dy)))
        total += own * (g[0] * dx + g[1] * dy)
    return total


def _spring_energy(evidence: Evidence, scale: float, allowed: float) -> Figure:
    """Work of springs without dampers against what they store, k x^2 / 2."""
    worst, a = Worst(), evidence.run.arrays
    moved, springs, drives = _moved(evidence), evidence.model.springs, evidence.model.drives
    # a rotary spring's damper is its hinge's, and works there
    damped = springs.straight & (springs.damping > 0)
    for i in np.flatnonzero(~damped & (springs.drive == NONE)):
        k, rest, start = (float(of[i]) for of in (springs.stiffness, springs.rest, springs.start))
        force = float(np.abs(a["spring_force"][:, i]).max(initial=0.0))
        stored = k * (a["spring_length"][:, i] - rest) ** 2 / 2
        balance = stored + a["spring_work"][:, i] - k * (start - rest) ** 2 / 2
        worst.add(springs.name[i], np.abs(balance) / scale, allowed + force * moved / scale)
    driven = [springs.name[i] for i in drives.target[drives.giving("stiffness")]]
    changed = (f"; left out: {_named(driven)}, whose stiffness a drive sets, so that the energy "
               "held is no function of the pose") if driven else ""
    return worst.figure(
        "energy.springs", "", source="W = -Δ k x² / 2",
        none=f"no spring is without a damper{changed}",
        why="work added up step by step against the energy held, shares of the energy turned "
            "over, {count} springs, worst: {where}; "
            f"0.1 % at 0.5 ms, falling with h²{changed}")


def _moved(evidence: Evidence) -> Array:
    """How far taking overlaps apart has moved bodies so far, without work [m], [n].

    A quarter of the overlap each step, and four times that at a far end.
    """
    time = evidence.run.time
    steps = float(time[1] - time[0]) / evidence.h if len(time) > 1 else 1.0
    return np.asarray(np.cumsum(evidence.shift) * steps)


def _created(left: Array, scale: float, allowed: float) -> Figure:
    """Joints and contacts take energy or none: what they do may not grow."""
    lowest = np.minimum.accumulate(np.minimum(left, 0.0)) if len(left) else left
    rise = float((left - lowest).max(initial=0.0)) / scale
    return judged(
        "energy.created", rise, "", allowed, source="ΔE = Σ W",
        why="most that joints and contacts gave back, against the energy turned over; kinetic "
            "energy less the work of drives, tendons, springs, dampers and weight; 0.1 % at "
            "0.5 ms, falling with h²")


def _lost(evidence: Evidence, left: Array, scale: float, allowed: float) -> Figure:
    """What joints and contacts took, against the contacts' and stops' own work."""
    a, source = evidence.run.arrays, "ΔE = Σ W"
    touched = len(a["contact_gap"]) > 0 or bool(np.nan_to_num(a["joint_stop"]).any())
    if touched and not evidence.every_step:
        return missing(
            "energy.lost", source=source,
            why="contacts and stops work in every step, and not every step was recorded; "
                "run.sample_rate = 1 / run.step records them all")
    if not touched:
        return judged(
            "energy.lost", float(np.abs(left).max(initial=0.0)) / scale, "", allowed, source=source,
            why="work of the joints, which should do none, against the energy turned over; 0.1 % "
                "at 0.5 ms, falling with h²")
    left = left - _work_of_contacts(evidence) - _work_of_joints(evidence)
    return judged(
        "energy.lost", float(np.abs(left).max(initial=0.0)) / scale, "", allowed, source=source,
        why="kinetic energy less all work, that of contacts, stops and joints added up from every "
            "step, against the energy turned over; 0.1 % at 0.5 ms, falling with h²")


def _work_of_joints(evidence: Evidence) -> Array:
    """Sum of R . v over the joints and steps, up to the middle of each [J].

    Ideal joints do none; an impact turns arms under a joint in the middle of a
    step, and closing what that opened takes work.
    """
    joints, v = evidence.loads.joints, evidence.loads.frames.velocity[:, evidence.loads.joints.body]
    power = joints.x * v[0] + joints.y * v[1] + joints.moment * v[2]
    step = evidence.h * np.nan_to_num(power).sum(axis=0)
    return np.asarray(np.cumsum(step) - step / 2)


def _work_of_contacts(evidence: Evidence) -> Array:
    """Sum of F . v over the contacts and stops of every step, up to the middle of each [J]."""
    a, frames = evidence.run.arrays, evidence.loads.frames
    sides = evidence.loads.contact_sides
    v = frames.velocity[:, sides.body, sides.sample]
    power = (sides.force[:, 0] * v[0] + sides.force[:, 1] * v[1] + sides.moment * v[2])
    power = np.where(evidence.model.bodies.free[sides.body], power, 0.0)
    step = np.bincount(sides.sample, weights=power, minlength=frames.samples)
    step = evidence.h * (step + np.nan_to_num(a["joint_stop"] * a["joint_rate"]).sum(axis=1))
    return np.asarray(np.cumsum(step) - step / 2)
