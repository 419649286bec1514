"""Underactuated statics: the contact forces of Set G on discs, the rotations of Set A."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.mechanics.grasp import DiscGrasp, disc_centre, disc_grasp
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.statics import contact_forces, contact_jacobian, joint_torques
from sandbox.mechanics.tendon import route
from sandbox.numeric import Array
from sandbox.study.plain_mechanisms import BODIES, finger
from sandbox.study.reference_fingers import SET_A, SET_G, SET_G_TABLE, DiscRow, FingerSet
from sandbox.verification.cases.case import Case, Check, Findings
from sandbox.verification.cases.closing import angles

NAMES = ("proximal", "middle", "distal")
CLOSED = 1e-10
"""A gap that a joint or a contact may be left with [m]."""
SHARPER = 1e-6
"""Share of a force by which gaps of 0.1 nm could change it: arms of 7 mm by 1e-7, and what depends
on a difference of two of them by some times that."""
SET_A_PULLS = (2.0, 4.68, 8.0)


def _exact(row: DiscRow) -> DiscRow:
    """The row with its centre unrounded: k_1 = 31 mm at theta_1 = 35 deg."""
    at = disc_centre(np.radians(35.0), 0.031, row.disc_radius, SET_G.radii[0])
    return DiscRow(row.disc_radius, (float(at[0]), float(at[1])), row.tension, row.degrees,
                   row.forces)


def statics_of(numbers: FingerSet, tension: ArrayLike, theta: Array) -> Array:
    """Moments that tendon and springs leave at the joints [N m], shape [..., 3]."""
    cord = route(numbers.guides, numbers.lengths)
    springs = spring_set(numbers.before, numbers.after)
    return joint_torques(np.asarray(tension), cord.arms(theta), numbers.stiffness,
                         springs.elongations(theta), springs.arms(theta))


def _grasp(row: DiscRow) -> tuple[DiscGrasp, Array]:
    """Pose and contact forces of a frictionless grasp by the closed forms."""
    pose = disc_grasp(row.centre, row.disc_radius, SET_G.lengths, SET_G.radii)
    jacobian = contact_jacobian(pose.theta, SET_G.lengths, pose.distances)
    return pose, contact_forces(jacobian, statics_of(SET_G, row.tension, pose.theta))


def _set_g() -> Findings:
    checks, curves = [], []
    for number, row in enumerate(map(_exact, SET_G_TABLE), start=1):
        run = simulate(finger(SET_G, pull=row.tension, duration=1.5, step=5e-4, disc=row))
        pose, forces = _grasp(row)
        reached = angles(run)[-1]
        for i in range(3):
            # its own gap at its distance from the hinge, and those of the contacts before
            allowed = float((2 * CLOSED / pose.distances[:i + 1]).sum())
            checks.append(Check(f"row {number}: angle of joint {i + 1}", "rad",
                                float(pose.theta[i]), float(reached[i]), allowed,
                                "gaps of up to 0.1 nm, k_i from their hinges, on both sides of a "
                                "joint"))
        for i, name in enumerate(NAMES):
            found = run[f"{BODIES[i]}.contact.normal"]
            checks += [
                Check(f"row {number}: force on the {name} phalanx", "N", float(forces[i]),
                      float(found[-1]), SHARPER * float(forces[i]),
                      "gaps of 0.1 nm change arms of 7 mm, and their differences, by less"),
                Check(f"row {number}: the closed form against the published digits, {name}", "N",
                      row.forces[i], float(forces[i]), 0.5e-4, "half of the last digit given")]
            if number == 1:
                early = run.time < 0.25
                curves += [Curve(f"{name}, engine", run.time[early], found[early]),
                           Curve(f"{name}, f = J⁻ᵀ τ", run.time[early],
                                 np.full(early.sum(), forces[i]), "dashed")]
    return Findings(checks, [Panel("Row 1: contact forces (peaks of the touches cut off)",
                                   "time [s]", "normal force [N]", curves, top=3.0)])


def rest_angles(numbers: FingerSet, tension: ArrayLike) -> Array:
    """Joint angles [rad], [..., 3], at which T h_i = k_i dlm_i hm_i, or the stop; by bisection.

    Each joint depends on its own angle alone, and what closes it falls with the angle.
    """
    pull = np.asarray(tension, dtype=np.float64)
    low = np.zeros((*pull.shape, 3))
    high = np.broadcast_to(np.array(numbers.limits), low.shape)
    for _ in range(60):
        middle = (low + high) / 2
        closes = statics_of(numbers, pull, middle) > 0
        low, high = np.where(closes, middle, low), np.where(closes, high, middle)
    return np.asarray((low + high) / 2)


def _set_a() -> Findings:
    checks, found = [], []
    for pull in SET_A_PULLS:
        run = simulate(finger(SET_A, pull={"ramp": {"to": pull, "over": 0.2}}, duration=1.2,
                              step=2e-4))
        expected, reached = rest_angles(SET_A, pull), angles(run)[-1]
        found.append(reached)
        checks += [Check(f"T = {pull:g} N: angle of joint {i + 1}", "deg",
                         float(np.degrees(expected[i])), float(np.degrees(reached[i])), 1e-4,
                         "at rest but for what dampers leave; four digits of the angle")
                   for i in range(3)]
        if pull == 4.68:
            short = float(route(SET_A.guides, SET_A.lengths).shortening(expected))
            checks.append(Check("T = 4.68 N: shortening", "m", short,
                                float(run["finger.tendon.shortening"][-1]), 1e-8,
                                "the same four digits"))
            last = np.degrees(rest_angles(SET_A, pull + 0.005) - expected) + 0.005
            checks += [Check(f"T = 4.68 N: the closed form against the published angle {i + 1}",
                             "deg", (1.49, 5.10, 22.21)[i], float(np.degrees(expected[i])),
                             float(last[i]), "half of the last digits given, of T and of the angle")
                       for i in range(3)]
    fine = np.linspace(0.2, 9.0, 45)
    curve = np.degrees(rest_angles(SET_A, fine))
    shown = np.degrees(found)
    return Findings(checks, [Panel("Set A at rest under a constant pull", "tension [N]",
                                   "rotation [deg]", [
        c for i in range(3) for c in (
            Curve(f"joint {i + 1}, statics", fine, curve[:, i]),
            Curve(f"joint {i + 1}, engine", np.array(SET_A_PULLS), shown[:, i], "points"))])])


CASES = (
    Case("grasp_forces", "Contact forces of a finger on a disc", "f = J⁻ᵀ τ",
         "finger of Set G closing on a fixed disc without friction, three rows of the table, "
         "h = 0.5 ms", "angles with the geometry of tangency, forces with underactuated statics",
         _set_g),
    Case("rest_angles", "Rotations under a constant pull", "T hᵢ = kᵢ Δlmᵢ hmᵢ",
         "finger of Set A under 2, 4.68 and 8 N, h = 0.2 ms",
         "rotations at rest with the balance of tendon and spring", _set_a),
)
