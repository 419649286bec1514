"""Equilibrium at rest: moments about every hinge, contact forces against f = J^-T tau."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.audit.evidence import Check, Evidence, NotComputed, Worst, peak
from sandbox.audit.outlines import touched
from sandbox.mechanics.statics import contact_forces, determined_forces, point_jacobian
from sandbox.model.model import Model
from sandbox.model.supports import components
from sandbox.numeric import Array
from sandbox.samples.contacts import TOUCH
from sandbox.scene.settings import Group
from sandbox.wording import counted

LAST = 0.05  # Fraction of the run at its end that has to be at rest
SPEED, RATE = 1e-3, 2e-2  # Largest speeds at rest [m/s, rad/s]; equal at arms of 50 mm
MOMENT = 1e-4  # Residual moment at rest, relative to the largest moment about a hinge


def _at_rest(evidence: Evidence) -> Evidence:
    """The last sample, if the run is at rest over its last part."""
    run, model = evidence.run, evidence.model
    if not run.complete:
        raise NotComputed("the run stopped early")
    if not model.bodies.free.any():
        raise NotComputed("nothing moves freely")
    if (gone := np.flatnonzero(run.arrays["held"][-1] == 0)).size:
        raise NotComputed(f"{model.bonds.name[gone[0]]!r} is released")
    first = min(len(run) - 1, int(len(run) * (1 - LAST)))
    moving = np.flatnonzero(~model.bodies.fixed)
    v = run.arrays["body_velocity"][first:, moving]
    speed, omega = np.hypot(v[..., 0], v[..., 1]).max(axis=0), np.abs(v[..., 2]).max(axis=0)
    at = int(np.argmax(speed / SPEED + omega / RATE))
    if speed.max() <= SPEED and omega.max() <= RATE:
        return evidence.last
    name = model.bodies.name[moving[at]]
    raise NotComputed(f"not at rest: in the last {100 * LAST:.0f} % of the run {name} moves at up "
                      f"to {speed[at]:.2g} m/s and {omega[at]:.2g} rad/s")


class _About(NamedTuple):
    """Moments about one hinge of all loads beyond it, counter-clockwise [N m]."""

    contacts: float
    others: float
    largest: float  # Of any single load
    inertia: float  # Of the bodies beyond it [kg m^2]


def _about(final: Evidence, joint: int, beyond: set[int]) -> _About:
    """The moments: the power of all loads while the bodies ``beyond`` turn about it at 1 rad/s."""
    loads, bodies, anchor = final.loads, list(beyond), final.frames.anchors[1]
    x, y = final.frames.centre[:2, bodies]
    turning = np.zeros((3, len(final.model.bodies.name), 1))
    turning[:, bodies] = anchor.y[joint] - y, x - anchor.x[joint], np.ones_like(x)
    sides = loads.contact_sides  # both sides of a contact between bodies beyond the hinge cancel
    contacts = (sides.wrench.T * turning[:, sides.body, 0]).sum(axis=0).reshape(2, -1).sum(axis=0)
    others = np.concatenate([np.zeros(0), *(
        batch.rates(int(batch.element.max(initial=-1)) + 1, turning)[:, 0]
        for batch in loads.batches)])
    return _About(float(contacts.sum()), float(others.sum()), peak(np.append(contacts, others)),
                  float((loads.weights.T * turning[:, :, 0]**2).sum()))


def beyond_joint(model: Model, joint: int) -> set[int]:
    """Free bodies that only this joint connects to the other bodies; empty in a loop."""
    pairs, free = model.joints.bodies, model.bodies.free
    group = np.array(components(len(free), np.delete(pairs, joint, axis=0)))
    one, two = group[pairs[joint]]
    for own in (group == two, group == one) if one != two else ():
        if free[own].all():
            return set(np.flatnonzero(own).tolist())
    return set()


@Check("rest.moments", source="Σ M = 0", asks="at rest, do the moments about every hinge balance?",
       compared="sum of moments at the end, relative to the largest, about {count:hinge}: tendons, "
                "springs, contacts, weight, stops, dampers; worst: {where}",
       none="there is no hinge that carries a load")
def _moments(evidence: Evidence, worst: Worst) -> None:
    final, model, window = _at_rest(evidence), evidence.model, LAST * evidence.run.time[-1]
    for j in model.joints.hinges.tolist():
        name, beyond = model.joints.name[j], beyond_joint(model, j)
        if not beyond:
            worst.left_out.append(f"{name} is one of several supports")
            continue
        moment = _about(final, j, beyond)
        # a hinge with less carries no load: bodies beyond it may still come to rest
        if moment.largest > 2 * RATE / window * moment.inertia:
            worst.add(name, np.array([abs(moment.contacts + moment.others) / moment.largest]),
                      MOMENT)


class Grip(NamedTuple):
    """A finger's hinges, the external contacts on it in one sample, and their Jacobian."""

    hinges: list[int]
    jacobian: Array  # Of the normals, counter-clockwise [m], [contacts, hinges]
    tangents: Array  # Of the tangents of rough contacts
    normal: Array  # Recorded normal forces [N]


def grip_of(final: Evidence, group: Group, least: float = TOUCH) -> Grip | None:
    """The contacts of a finger that press with more than ``least`` [N]; None if it is no chain."""
    model, loads = final.model, final.loads
    members = [model.names.body[name] for name in group.bodies if name in model.names.body]
    pivots = model.joints.hinges
    pins = [pivots[model.joints.bodies[pivots, 1] == body].tolist() for body in members]
    hinges = [each[0] for each in pins if len(each) == 1]
    if not hinges or len(hinges) < len(members) or (
            model.joints.bodies[hinges[1:], 0].tolist() != members[:-1]):
        return None
    a, normal, anchor = loads.run.arrays, loads.run.contacts.normal, loads.frames.anchors[1]
    pair = np.stack([a["contact_body"], a["contact_other"]])
    inside = np.isin(pair, members)
    rows = np.flatnonzero((inside[0] != inside[1]) & (normal > least))
    rows = np.concatenate([rows[inside[0, rows]], rows[inside[1, rows]]])
    own = np.where(inside[0, rows], pair[0, rows], pair[1, rows])
    normals = np.where(inside[0, rows], 1.0, -1.0)[:, None] * a["contact_normal"][rows]
    tangents, points = np.column_stack([-normals[:, 1], normals[:, 0]]), a["contact_point"][rows]
    phalanx = np.array([members.index(b) for b in own.tolist()], dtype=np.int64)
    at = np.column_stack([anchor.x[hinges, 0], anchor.y[hinges, 0]])
    rough = loads.run.contacts.laws[0, rows] > 0
    return Grip(hinges, point_jacobian(points, normals, at, phalanx),
                point_jacobian(points[rough], tangents[rough], at, phalanx[rough]), normal[rows])


def _fingers(model: Model) -> list[Group]:
    return [group for group in model.mechanism.groups if group.kind == "finger"]


@Check("rest.contacts", source="f = J⁻ᵀ τ",
       asks="at rest, do contact forces balance the tendon tension?",
       compared="contact forces from tensions, springs and geometry against the recorded ones, "
                "{count:finger}, worst: {where}")
def _contacts(evidence: Evidence, worst: Worst) -> None:
    """Forces f = J^-T tau of fingers with as many frictionless contacts as joints."""
    final = _at_rest(evidence)
    for group in _fingers(final.model):
        grip = grip_of(final, group)
        reason = _no_closed_form(final.model, grip)
        if grip is None or reason:
            worst.left_out.append(f"{group.name}: {reason}")
            continue
        about = [_about(final, j, beyond_joint(final.model, j)) for j in grip.hinges]
        force = contact_forces(grip.jacobian, [-each.others for each in about])
        inverse = np.linalg.norm(np.linalg.inv(grip.jacobian.T), ord=np.inf)
        scale = float(grip.normal.max())
        error = float(np.abs(force - grip.normal).max())
        worst.add(group.name, np.array([error / scale]),
                  MOMENT * float(inverse) * max(each.largest for each in about) / scale)


def _no_closed_form(model: Model, grip: Grip | None) -> str:
    """Why f = J^-T tau does not give a finger's contact forces; empty if it does."""
    if grip is None:
        return "not a chain of hinges"
    count = len(grip.normal)
    if len(grip.tangents):
        return "its contacts have friction"
    if count != len(grip.hinges):
        return f"{counted(count, 'contact')} for {counted(len(grip.hinges), 'hinge')}"
    if any(not beyond_joint(model, j) for j in grip.hinges):
        return "something else holds it"
    values = np.linalg.svd(grip.jacobian, compute_uv=False)
    if values[-1] < 1e-9 * values[0]:
        return "a contact has no arm"
    return ""


@Check("contact.shared", source="rank of J", asks="does statics determine every contact force?",
       compared="contact forces at the end that statics does not determine: {note}")
def _determined(evidence: Evidence, worst: Worst) -> str:
    """Contacts without a force count: they may carry one in another set of forces."""
    final = touched(evidence.last, least=TOUCH)
    if not _fingers(final.model):
        raise NotComputed("there is no finger")
    shared, states = 0, []
    for group in _fingers(final.model):
        grip = grip_of(final, group, least=-np.inf)
        if grip is None:
            states.append(f"{group.name} is no chain of hinges")
            continue
        stop = final.arrays["joint_stop"][-1, grip.hinges]
        rows = np.concatenate([grip.jacobian, grip.tangents])
        known = determined_forces(rows, upper=np.abs(np.nan_to_num(stop)) > 0)[:len(grip.normal)]
        shared += int(np.count_nonzero(~known))
        states.append(f"{group.name} touches nothing" if not len(known) else
                      f"{np.count_nonzero(~known) or 'none'} of {len(known)} on {group.name}")
    worst.judge(shared, 0.0)
    return "; ".join(states[:6])
