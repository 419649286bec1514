"""Contacts without a force in one sample, which have no row in a recording.

Such a contact may carry a force in another set of forces that balances the same pose. It follows
from poses and shapes: outlines of bodies that may touch, within the gap that a step may leave, that
neither approach nor separate.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import DIGITS
from sandbox.audit.outlines import from_faces
from sandbox.elements.arrays import CONTACT, Arrays
from sandbox.model.joints import rotated
from sandbox.model.pairs import allowed_pairs
from sandbox.numeric import Array, Integers
from sandbox.samples import nearby
from sandbox.samples.nearby import PlacedPiece, apart, pieces_of

ASKEW, ALIKE = 1e-6, 1e-3
"""Angle between a normal and those of a surface; and between normals of the same contact."""


class Touch(NamedTuple):
    """Where two bodies touch, as a contact row has it."""

    body: int
    other: int
    normal: Array
    """Into the body."""
    at: Array
    gap: float


def touched(evidence: Evidence, least: float = -np.inf) -> Evidence:
    """A single sample with a row of zero force for each contact without a row.

    Rows with a normal force of no more than ``least`` [N] are removed first.
    """
    a = evidence.run.arrays
    kept = np.flatnonzero(evidence.run.contacts.normal > least)
    rows = {key: a[key][kept] for key in CONTACT}
    blurred = [pressed(evidence, row) is None for row in kept.tolist()]
    found = _new(touches(evidence), rows, blurred, evidence.near)
    if not found and len(kept) == len(a["contact_gap"]):
        return evidence
    more: Arrays = {
        "contact_body": np.array([one.body for one in found], dtype=np.int64),
        "contact_other": np.array([one.other for one in found], dtype=np.int64),
        "contact_normal": np.array([one.normal for one in found]).reshape(-1, 2),
        "contact_point": np.array([one.at for one in found]).reshape(-1, 2),
        "contact_gap": np.array([one.gap for one in found]),
        "contact_merged": np.ones(len(found)), "contact_twist": np.zeros(len(found))}
    for key, values in rows.items():
        none = np.zeros((len(found), *values.shape[1:]), dtype=values.dtype)
        rows[key] = np.concatenate([values, more.get(key, none)])
    return Evidence(evidence.run.with_contacts(rows), alone=True, near=evidence.near)


def touches(evidence: Evidence) -> Iterator[Touch]:
    """All outlines that touch in a single sample; the nearest of a pair comes first."""
    found: dict[tuple[int, int], list[Touch]] = {}
    for touch, parts in _near(evidence):
        if abs(parts) * evidence.h <= evidence.open:
            found.setdefault((touch.body, touch.other), []).append(touch)
    for pair in sorted(found):
        yield from sorted(found[pair], key=lambda touch: touch.gap)


def overlaps(evidence: Evidence) -> Iterator[tuple[tuple[int, int], float]]:
    """Near pairs without a contact row in a single sample.

    With the largest overlap of outlines that still approach [m], or 0.
    """
    a, deepest = evidence.run.arrays, dict[tuple[int, int], float]()
    rows = {tuple(sorted(pair)) for pair in zip(
        a["contact_body"].tolist(), a["contact_other"].tolist(), strict=True)}
    for touch, parts in _near(evidence):
        pair = touch.body, touch.other
        if pair not in rows:
            depth = -touch.gap if parts * evidence.h < -evidence.open else 0.0
            deepest[pair] = max(deepest.get(pair, 0.0), depth)
    yield from deepest.items()


def _near(evidence: Evidence) -> Iterator[tuple[Touch, float]]:
    """Where outlines are near or overlap, and their rate of separation there [m/s]."""
    for one, two, pieces in _close(evidence, evidence.near):
        here = apart(*pieces)
        if here is None or here.gap > evidence.near or not (
                _surface(evidence, one, pieces[0], here.normal)
                and _surface(evidence, two, pieces[1], -here.normal)):
            continue
        yield (Touch(one, two, -here.normal, here.at, here.gap),
               _parts(evidence, one, two, here.at, here.normal))


def _new(
    candidates: Iterator[Touch], rows: Arrays, blurred: list[bool], near: float,
) -> list[Touch]:
    """Candidates without a row, one for each plane between two bodies.

    A ``blurred`` row has several normals: it covers all candidates between its two bodies.
    """
    known: dict[tuple[int, int], list[tuple[Array, Array]]] = {}
    whole = set()
    for row, several in enumerate(blurred):
        pair = int(rows["contact_body"][row]), int(rows["contact_other"][row])
        sign = 1.0 if pair[0] < pair[1] else -1.0
        pair = min(pair), max(pair)
        known.setdefault(pair, []).append(
            (sign * rows["contact_normal"][row], rows["contact_point"][row]))
        if several:
            whole.add(pair)
    found = []
    for touch in candidates:
        pair = touch.body, touch.other
        planes = known.setdefault(pair, [])
        if pair in whole or any(
                np.hypot(*(normal - touch.normal)) <= ALIKE
                and abs((touch.at - at) @ normal) <= 2 * near for normal, at in planes):
            continue
        planes.append((touch.normal, touch.at))
        found.append(touch)
    return found


def _close(
    evidence: Evidence, near: float,
) -> Iterator[tuple[int, int, tuple[PlacedPiece, PlacedPiece]]]:
    """Pieces of bodies that may touch and whose bounding boxes overlap, the lower body first."""
    allowed, pieces, owner = allowed_pairs(evidence.model), list[PlacedPiece](), list[int]()
    for body in np.flatnonzero(allowed.any(axis=1)).tolist():
        own = list(pieces_of(evidence.run, 0, body))
        pieces += own
        owner += [body] * len(own)
    of: Integers = np.array(owner, dtype=np.int64)
    low = np.array([p.corners.min(axis=0) - p.grown for p in pieces]).reshape(-1, 2)
    high = np.array([p.corners.max(axis=0) + p.grown for p in pieces]).reshape(-1, 2)
    reach = near + 8 * DIGITS * float(np.abs(low).max(initial=0.0))
    for i in range(len(pieces) - 1):
        beside = ((low[i + 1:] <= high[i] + reach) & (high[i + 1:] >= low[i] - reach)).all(axis=1)
        for j in (i + 1 + np.flatnonzero(beside & allowed[of[i], of[i + 1:]])).tolist():
            yield int(of[i]), int(of[j]), (pieces[i], pieces[j])


def _surface(evidence: Evidence, body: int, piece: PlacedPiece, out: Array) -> bool:
    """Whether ``out`` is a normal of the outline's surface on this piece."""
    if piece.faces is None:
        return True
    own = rotated(out, -evidence.run.arrays["body_pose"][0, body, 2])
    return bool(from_faces(own[None], piece.faces)[0] <= ASKEW)


def pressed(evidence: Evidence, row: int) -> Array | None:
    """The points between which a contact row of the single sample may press.

    As :func:`sandbox.samples.nearby.pressed`, with the gap that the engine may leave.
    """
    a, h = evidence.run.arrays, evidence.h
    pair = int(a["contact_body"][row]), int(a["contact_other"][row])
    pose, velocity = a["body_pose"][0, pair], a["body_velocity"][0, pair]
    size = float(np.abs(pose[:, :2]).max())
    near = evidence.near + 8 * DIGITS * size + h * float(np.hypot(*velocity[:, :2].T).sum())
    return nearby.pressed(evidence.run, row, near)


def _parts(evidence: Evidence, one: int, two: int, at: Array, normal: Array) -> float:
    """Rate of separation of two bodies at a point at the end of the step [m/s]."""
    frames, velocity = evidence.loads.frames, evidence.velocity_after[:, :, 0]

    def along(body: int) -> float:
        x, y = at[0] - frames.centre_x[body, 0], at[1] - frames.centre_y[body, 0]
        vx, vy, omega = velocity[:, body]
        return float((vx - omega * y) * normal[0] + (vy + omega * x) * normal[1])

    return along(two) - along(one)
