"""The figure of drives that go to a place: servos and lengths of actuators."""

from __future__ import annotations

import numpy as np

from sandbox.audit.driven import SOLVED, held_off, still_held
from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import DIGITS, EXACT, ROUNDING, STILL, Figure, Worst, peak
from sandbox.numeric import Array


def servos(evidence: Evidence) -> Figure:
    """Drives with a stiffness give what its law says; rigid ones come nearer to their targets."""
    drives, worst = evidence.model.drives, Worst()
    shared = np.bincount([int(drives.target[i]) for i, kind in enumerate(drives.kind)
                          if kind.limited], minlength=len(evidence.model.joints.name))
    for i, kind in enumerate(drives.kind):
        if not kind.places:
            continue
        if np.isfinite(drives.stiffness[i]):
            worst.add(drives.name[i], *_sprung(evidence, i))
        elif evidence.every_step and shared[drives.target[i]] == 1:
            worst.add(drives.name[i], *_approach(evidence, i))
    return worst.figure(
        "drive.place", "", source="τ = k (u − q) − c q′ or q → u",
        none="no drive with a stiffness goes to a place, or not every step was recorded",
        why="efforts of {count:servo} against k (u - q) - c q', share of the "
            "most that they can; of rigid ones by how much they moved away from their targets with "
            "effort to spare, share of the way; worst: {where}")


def _sprung(evidence: Evidence, drive: int) -> tuple[Array, Array]:
    """By how much the law is missed and may be, shares of the limit, [n] each.

    The law is taken evenly about the pose, or at the step's end where it is too stiff for the
    step: as one of the two all samples have to be.
    """
    drives, a, h = evidence.model.drives, evidence.run.arrays, evidence.h
    j, most = int(drives.target[drive]), float(drives.most[drive])
    k, c = float(drives.stiffness[drive]), float(drives.damping[drive])
    rate, after = evidence.rates[j], evidence.rates_after[j]
    missing = k * (a["drive_value"][:, drive] - evidence.angles[j])
    evenly = missing - c * rate - k * h / 2 * (after - rate)
    at_end = missing - (c + h * k) * after
    given = a["drive_torque"][:, drive]
    holds = still_held(evidence, j)
    off = min((holds * np.abs(np.clip(law, -most, most) - given) for law in (evenly, at_end)),
              key=peak)
    held = held_off(evidence, drive, np.full(len(given), h * most))
    wrong = (c + h * k) * (SOLVED * (1 + peak(after)) + STILL[1] + DIGITS / h + held)
    wrong += k * ROUNDING * (1 + np.abs(evidence.angles[j]))
    return off / most, EXACT + wrong / most


def _approach(evidence: Evidence, drive: int) -> tuple[Array, Array]:
    """By how much a rigid drive moves away from its target, and may, shares of the way, [n - 1].

    Where its speed is limited it may fall behind a target that moves.
    """
    drives, a, h = evidence.model.drives, evidence.run.arrays, evidence.h
    j, most, place = int(drives.target[drive]), float(drives.most[drive]), evidence.angles[
        int(drives.target[drive])]
    value = a["drive_value"][:, drive]
    short = np.abs(value[:-1] - place[1:])
    before, moved = np.concatenate([[np.inf], short[:-1]]), np.abs(np.diff(value, prepend=value[0]))
    spare = np.abs(a["drive_torque"][:-1, drive]) < most * (1 - EXACT)
    holds = still_held(evidence, j)
    spare &= holds[:-1] & holds[1:]
    spare &= (moved[:-1] == 0) | np.isinf(drives.fastest[drive])
    span = float(np.ptp(place)) + peak(short) + ROUNDING
    held = held_off(evidence, drive, np.full(len(value), h * most))[:-1]
    slack = evidence.joint_slack[j, 1:] + 2 * h * (
        STILL[1] + held + SOLVED * (1 + peak(evidence.rates_after[j]))) + ROUNDING * (
        1 + np.abs(place[1:]))
    return np.where(spare, np.maximum(short - before, 0.0), 0.0) / span, slack / span
